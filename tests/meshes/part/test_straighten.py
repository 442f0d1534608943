"""Curved tetrahedra of roundings stay curved; folded ones become straight, and these alone."""

import numpy as np
import pytest

from lumped.errors import ComputationError
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.elements import ELEMENTS
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.straighten import straightened
from meshes.part.volume import Grading, volume_mesh
from meshes.shape_functions import gradients, quadrature, values

pytestmark = pytest.mark.usefixtures("in_this_process")


def rounded(occ, s):
    """A bar 80 × 40 × 40 mm whose long edges are rounded with 8 mm."""
    bar = occ.addBox(0.0, -20.0 * s, -20.0 * s, 80.0 * s, 40.0 * s, 40.0 * s)
    occ.synchronize()
    boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    occ.fillet([bar], [tag for tag, box in boxes.items() if box[3] - box[0] > 50.0 * s], [8.0 * s])


def test_roundings_keep_their_volume(part_file):
    part = read_part(part_file("rounded.step", rounded))
    ends = {"A": PartInterface(ByPlane((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), "rigid")}
    mesh = volume_mesh(part, find_interfaces(part, ends), Grading(0.02))
    corners = mesh.nodes[mesh.cells[:, :4]]
    edges = corners[:, 1:] - corners[:, :1]
    chords = np.linalg.det(edges).sum() / 6.0 / part.exact.volume - 1.0
    assert chords < -3e-3
    assert mesh.straightened == 0
    # A parabola misses of a short arc less than a hundredth of what its chord misses.
    assert abs(_volume(mesh) / part.exact.volume - 1.0) < 0.01 * abs(chords)


def _volume(mesh):
    """By the divergence theorem over the faces, which has nothing in common with the elements."""
    points, weights = quadrature("tri6", 6)
    shapes, slopes = values("tri6", points), gradients("tri6", points)
    total = 0.0
    for facets in mesh.faces.values():
        nodes = mesh.nodes[facets.cells]
        places = np.einsum("fki,kq->fqi", nodes, shapes)
        tangents = np.einsum("fki,kjq->fqij", nodes, slopes)
        normals = np.cross(tangents[..., 0], tangents[..., 1])
        total += np.einsum("fqi,fqi,q->", places, normals, weights) / 3.0
    return abs(total)


def test_a_folded_element_becomes_straight_and_its_neighbour_follows():
    # Two tetrahedra on one face; a middle of their common edge pulled through the first one.
    tetrahedron = ELEMENTS["tet10"].nodes
    nodes = np.vstack([tetrahedron, tetrahedron])
    cells = np.arange(20).reshape(2, 10)
    mirrored = np.array([-1.0, 1.0, 1.0])
    nodes[10:] = (tetrahedron * mirrored)[[0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    nodes[4] += [0.0, 0.4, 0.4]
    found, count = straightened(nodes, cells)
    assert count == 1
    assert found[4] == pytest.approx([0.5, 0.0, 0.0], abs=1e-15)
    assert np.array_equal(np.delete(found, 4, axis=0), np.delete(nodes, 4, axis=0))


@pytest.mark.parametrize(
    ("height", "message"),
    [(1e-12, "1 tetrahedra are flat, the first"), (-1.0, "stay inverted, the first")],
)
def test_what_is_flat_or_stays_inverted_is_an_error_that_says_where(height, message):
    with pytest.raises(ComputationError, match=f"{message} at"):
        straightened(ELEMENTS["tet10"].nodes * [1.0, 1.0, height], np.arange(10)[None])
