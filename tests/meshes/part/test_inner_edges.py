"""Meshes cut at re-entrant edges: which those are, why, and that the shape stays."""

from functools import cache

import numpy as np
import pytest
from prismatic_legs import STEEL

from fem.bodies.part import meshed_part
from meshes.part import volume
from meshes.part.boundary import Facets, PartMesh, area_vectors, boundary
from meshes.part.inner_edges import cut_at_inner_edges, inner_edges, second_order_unknowns
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes

pytestmark = pytest.mark.usefixtures("in_this_process")


def box_tube(occ, s):
    outer, inner = (
        (3, occ.addBox(0.0, -y * s, -z * s, 200.0 * s, 2.0 * y * s, 2.0 * z * s))
        for y, z in ((50.0, 80.0), (37.5, 67.5))
    )
    occ.cut([outer], [inner])


def with_boss(occ, s):
    """A plate with a round boss: its edge is re-entrant and curved; a bore's are not."""
    plate = (3, occ.addBox(-50.0 * s, -40.0 * s, 0.0, 100.0 * s, 80.0 * s, 15.0 * s))
    boss = (3, occ.addCylinder(0.0, 0.0, 10.0 * s, 0.0, 0.0, 30.0 * s, 25.0 * s))
    bore = (3, occ.addCylinder(0.0, 0.0, -10.0 * s, 0.0, 0.0, 60.0 * s, 12.0 * s))
    solid, _ = occ.fuse([plate], [boss])
    occ.cut(solid, [bore])


def rounded_corner(occ, s):
    """An L whose inner corner is rounded."""
    outline = [(0, 0), (80, 0), (80, 20), (35, 20), (20, 35), (20, 80), (0, 80)]
    points = [occ.addPoint(x * s, y * s, 0.0) for x, y in outline]
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    arc = occ.addCircleArc(points[3], occ.addPoint(35.0 * s, 35.0 * s, 0.0), points[4])
    lines = [arc if side == 3 else occ.addLine(*ends) for side, ends in enumerate(sides)]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0.0, 0.0, 30.0 * s)


@pytest.fixture(scope="module")
def meshed(part_file):
    """Meshes of parts by what builds them, made once."""

    @cache
    def of(build):
        part = read_part(part_file(f"{build.__name__}.step", build))
        return volume.volume_mesh(part, (), volume.Grading(0.03))

    return of


def test_edges_are_those_with_more_than_half_a_turn_of_material(meshed):
    mesh = meshed(box_tube)
    _, y, z = np.abs(mesh.nodes[inner_edges(mesh)]).T
    assert y == pytest.approx(0.0375, abs=1e-9)
    assert z == pytest.approx(0.0675, abs=1e-9)
    mesh = meshed(with_boss)
    x, y, z = mesh.nodes[inner_edges(mesh)].T
    assert len(x) >= 12
    assert np.hypot(x, y) == pytest.approx(0.025, abs=1e-9)
    assert z == pytest.approx(0.015, abs=1e-9)


def test_a_part_without_sharp_ones_keeps_its_mesh(meshed):
    mesh = meshed(rounded_corner)
    assert cut_at_inner_edges(mesh) is mesh


@pytest.mark.parametrize("shape", [box_tube, with_boss])
def test_cut_meshes_fit_together_and_have_the_shape_of_the_whole(meshed, shape):
    mesh = meshed(shape)
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
        ours, theirs = (
            area_vectors(m.nodes, f) for m, f in ((cut, cut.faces[number]), (mesh, facets))
        )
        assert ours.sum(axis=0) == pytest.approx(theirs.sum(axis=0), abs=2e-3 * 0.1**2)
    corners, numbers = np.unique(mesh.cells[:, :4], return_inverse=True)
    faces = {
        number: Facets(np.searchsorted(corners, facets.corners), "tri3")
        for number, facets in mesh.faces.items()
    }
    straight = PartMesh(mesh.nodes[corners], numbers.reshape(-1, 4), "tet4", faces)
    assert second_order_unknowns(straight, cut=True) == cut.unknowns
    assert second_order_unknowns(straight, cut=False) == mesh.unknowns
