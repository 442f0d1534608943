"""Section meshes of circles and rectangles about one centre: areas, symmetry and quality."""

from math import pi

import numpy as np
import pytest

from meshes.quality import quality
from meshes.section.star_mesh import Outline, star_mesh
from meshes.shape_functions import gradients, quadrature
from meshes.shape_functions import values as shape_values


def circle(diameter):
    return Outline(diameter / 2.0, diameter / 2.0, is_round=True)


def rectangle(width, height):
    return Outline(width / 2.0, height / 2.0, is_round=False)


def areas(mesh):
    """Return the areas of all cells by quadrature."""
    points, weights = quadrature("quad9", 4)
    slopes = gradients("quad9", points)
    jacobians = np.einsum("mki,kjq->mqij", mesh.nodes[mesh.cells], slopes)
    return np.linalg.det(jacobians) @ weights


CASES = {
    "disc within square": (circle(0.048), rectangle(0.06, 0.06)),
    "disc across sides": (circle(0.066), rectangle(0.06, 0.06)),
    "disc through corners": (circle(0.05), rectangle(0.04, 0.03)),
    "disc around square": (circle(0.1), rectangle(0.06, 0.06)),
    "disc across strip": (circle(0.03), rectangle(0.06, 0.015)),
}


@pytest.mark.parametrize("case", CASES)
def test_cells_fill_disc_and_rectangle(case):
    """Each outline consists of mesh lines: the cells within have its area. The mesh is symmetric.

    Parabolas instead of arcs: halving the elements leaves 1/16 of the error.
    """
    disc, box = CASES[case]
    errors = []
    for refinement in (1, 2):
        mesh = star_mesh([disc, box], 0.015, refinement, has_core=True)
        jacobians, aspects = quality(mesh)
        assert jacobians.min() > 0.2
        assert aspects.max() < 25.0
        y, z = np.abs(mesh.nodes[mesh.cells[:, 8]]).T
        in_box, in_disc = (y < box.y) & (z < box.z), np.hypot(y, z) < disc.y
        assert areas(mesh)[in_box].sum() == pytest.approx(4.0 * box.y * box.z, rel=1e-3)
        errors.append(areas(mesh)[in_disc].sum() / (pi * disc.y**2) - 1.0)
        for mirror in ([-1.0, 1.0], [1.0, -1.0]):
            images = mesh.nodes * mirror
            assert len(np.unique(np.vstack([mesh.nodes, images]), axis=0)) == len(mesh.nodes)
    assert abs(errors[0]) < 2e-4
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)


@pytest.mark.parametrize("height", [0.06, 0.08])
def test_disc_that_touches_sides_keeps_area(height):
    """Round bar as wide as the rectangle beneath it: its area and second moments."""
    mesh = star_mesh([circle(0.06), rectangle(0.06, height)], 0.015, 2, has_core=True)
    assert quality(mesh)[0].min() > 0.05
    middles = mesh.nodes[mesh.cells[:, 8]]
    in_disc = np.hypot(*middles.T) < 0.03
    assert areas(mesh)[in_disc].sum() == pytest.approx(pi * 0.03**2, rel=1.5e-4)
    points, weights = quadrature("quad9", 6)
    slopes, values = gradients("quad9", points), shape_values("quad9", points)
    corners = mesh.nodes[mesh.cells[in_disc]]
    densities = np.linalg.det(np.einsum("mki,kjq->mqij", corners, slopes)) * weights
    squares = np.einsum("mki,kq->mqi", corners, values) ** 2
    moments = np.einsum("mq,mqi->i", densities, squares)
    error = 3e-4 if height == 0.06 else 7e-4
    assert moments == pytest.approx(pi * 0.03**4 / 4.0, rel=error)


def test_walls_of_tube_and_box_leave_hole():
    """A tube through the walls of a box: the areas of both, and nothing within both."""
    outlines = [*map(circle, (0.064, 0.056)), rectangle(0.06, 0.06), rectangle(0.052, 0.052)]
    mesh = star_mesh(outlines, 0.015, 1, has_core=False)
    y, z = np.abs(mesh.nodes[mesh.cells[:, 8]]).T
    radii, largest = np.hypot(y, z), np.maximum(y, z)
    in_box = (largest > 0.026) & (largest < 0.03)
    in_tube = (radii > 0.028) & (radii < 0.032)
    assert areas(mesh)[in_box].sum() == pytest.approx(0.06**2 - 0.052**2, rel=1e-3)
    assert areas(mesh)[in_tube].sum() == pytest.approx(pi * (0.032**2 - 0.028**2), rel=1e-3)
    assert np.hypot(*mesh.nodes.T).min() == pytest.approx(0.026, rel=1e-6)
