"""Meshes cut at re-entrant edges: which those are, why, and that the shape stays."""

import numpy as np
import pytest
from drawn_parts import written
from prismatic_legs import STEEL

from fem.bodies.part import meshed_part
from meshes.part.boundary import Facets, PartMesh, area_vectors, boundary
from meshes.part.inner_edges import cut_at_inner_edges, inner_edges, second_order_unknowns
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes
from meshes.part.volume import Grading, volume_mesh


def box_tube(occ):
    outer, inner = (occ.addBox(0, -y, -z, 200, 2 * y, 2 * z) for y, z in ((50, 80), (37.5, 67.5)))
    occ.cut([(3, outer)], [(3, inner)])


def with_boss(occ):
    """A plate with a round boss: its edge is re-entrant and curved; a bore's are not."""
    plate, boss = occ.addBox(-50, -40, 0, 100, 80, 15), occ.addCylinder(0, 0, 10, 0, 0, 30, 25)
    solid, _ = occ.fuse([(3, plate)], [(3, boss)])
    occ.cut(solid, [(3, occ.addCylinder(0, 0, -10, 0, 0, 60, 12))])


def rounded_corner(occ):
    """An L whose inner corner is rounded."""
    outline = [(0, 0), (80, 0), (80, 20), (35, 20), (20, 35), (20, 80), (0, 80)]
    points = [occ.addPoint(x, y, 0) for x, y in outline]
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    arc = occ.addCircleArc(points[3], occ.addPoint(35, 35, 0), points[4])
    lines = [arc if side == 3 else occ.addLine(*ends) for side, ends in enumerate(sides)]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 0, 30)


@pytest.fixture
def meshed(tmp_path, in_this_process):  # noqa: ARG001
    def of(build):
        return volume_mesh(read_part(written(tmp_path / "part.step", build)), (), Grading(0.03))

    return of


def test_a_part_without_sharp_ones_keeps_its_mesh(meshed):
    mesh = meshed(rounded_corner)
    assert cut_at_inner_edges(mesh) is mesh


@pytest.mark.parametrize("shape", [box_tube, with_boss])
def test_cut_at_edges_of_more_than_half_a_turn_meshes_have_the_shape_of_the_whole(meshed, shape):
    mesh = meshed(shape)
    x, y, z = mesh.nodes[inner_edges(mesh)].T
    assert len(x) >= 12
    across, up = (np.abs(y), 0.0675) if shape is box_tube else (np.hypot(x, y), 0.015)
    assert across == pytest.approx(0.0375 if shape is box_tube else 0.025, abs=1e-9)
    assert np.abs(z) == pytest.approx(up, abs=1e-9)
    cut = cut_at_inner_edges(mesh)
    # Curved pieces as well: the piece of a quadratic element is one.
    masses = [meshed_part(m, STEEL).properties().mass for m in (mesh, cut)]
    assert masses[1] == pytest.approx(masses[0], rel=1e-12)
    assert cell_volumes(cut).min() > 0.0
    # No gap inside: what belongs to one element alone is what lies on the faces.
    on_faces = np.vstack([facets.corners for facets in cut.faces.values()])
    outside = boundary(cut).corners
    assert np.array_equal(*(np.unique(np.sort(c, axis=1), axis=0) for c in (on_faces, outside)))
    for number, facets in mesh.faces.items():
        ours = area_vectors(cut.nodes, cut.faces[number]).sum(axis=0)
        theirs = area_vectors(mesh.nodes, facets).sum(axis=0)
        assert ours == pytest.approx(theirs, abs=2e-3 * 0.1**2)
    corners, numbers = np.unique(mesh.cells[:, :4], return_inverse=True)
    faces = {
        number: Facets(np.searchsorted(corners, facets.corners), "tri3")
        for number, facets in mesh.faces.items()
    }
    straight = PartMesh(mesh.nodes[corners], numbers.reshape(-1, 4), "tet4", faces)
    assert second_order_unknowns(straight, cut=True) == cut.unknowns
    assert second_order_unknowns(straight, cut=False) == mesh.unknowns
