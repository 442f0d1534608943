"""Sharp re-entrant edges of solids, at mitres and steps; curved surfaces have none."""

import numpy as np
import pytest

from fem.sections.stresses import reentrant_corners
from lumped.centre_line import CentreLine, LinePiece, straight_line
from lumped.legs import LineLeg, Material
from lumped.sections import Channel, Rectangle, Section, Tube
from meshes.loft import loft
from meshes.part.boundary import CREASE
from meshes.prism import extrude, stations
from meshes.reentrant_edges import reentrant_nodes
from meshes.section.section_mesh import section_mesh

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
UP = (0.0, 0.0, 1.0)


def of_one_section(line: CentreLine, section: Section) -> LineLeg:
    return LineLeg(line, ((0.0, section), (line.length, section)), STEEL)


def test_channel_has_both_inner_edges():
    """The web of 20 mm and flanges of 20 mm meet at y = 20 mm − c and z = ±30 mm."""
    face = section_mesh(Channel(0.05, 0.1, 0.02, 0.02), 1)
    mesh = extrude(face, stations(0.3, 4))
    x, y, z = mesh.nodes[reentrant_nodes(mesh)].T
    corners = reentrant_corners(face)
    assert len(x) == 2 * 9
    assert np.unique(np.round(np.column_stack([y, z]), 9), axis=0) == pytest.approx(
        corners[np.argsort(corners[:, 1])], abs=1e-9
    )
    assert np.abs(z) == pytest.approx(0.03)
    assert (x.min(), x.max()) == (0.0, 0.3)
    # The corners of 90° are also creases of a part.
    assert len(reentrant_nodes(mesh, CREASE)) == len(x)


def test_mitre_has_inner_edge():
    """A corner of 30° of a bar of 60 mm: the inner edge lies 30 mm/cos 15° from the line."""
    half = np.radians(15.0)
    middle = (0.3 * np.cos(half), 0.3 * np.sin(half), 0.0)
    end = (2.0 * middle[0], 0.0, 0.0)
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), middle), LinePiece(middle, end)), UP)
    mesh = loft(of_one_section(line, Rectangle(0.06, 0.06)), 2, 12)
    x, y, z = mesh.nodes[reentrant_nodes(mesh)].T
    assert len(z) == 5
    assert x == pytest.approx(middle[0])
    assert y == pytest.approx(middle[1] - 0.03 / np.cos(half))


def test_step_has_edges_of_thin_section():
    """A step from 80 to 40 mm of width at 0.2 m: both edges of the thin section there."""
    thick, thin = Rectangle(0.08, 0.06), Rectangle(0.04, 0.06)
    step = ((0.0, thick), (0.2, thick), (0.2, thin), (0.5, thin))
    mesh = loft(LineLeg(straight_line(0.5), step, STEEL), 1, 10)
    x, y, _ = mesh.nodes[reentrant_nodes(mesh)].T
    assert len(x) > 0
    assert x == pytest.approx(0.2)
    assert np.abs(y) == pytest.approx(0.02)


@pytest.mark.parametrize("section", [Rectangle(0.15, 0.05), Tube(0.1, 0.01)])
def test_arc_has_no_reentrant_edge(section):
    """Half a circle of four slices: the inside of the arc and the bore are smooth."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.1, 0.1, 0.0)),), UP)
    mesh = loft(of_one_section(line, section), 1, 4)
    assert reentrant_nodes(mesh).tolist() == []


def test_bore_of_coarse_tube_is_smooth():
    """Eight cells about a tube, between which the normal turns by 0.03 rad."""
    assert len(reentrant_corners(section_mesh(Tube(0.06, 0.004), 1))) == 0
