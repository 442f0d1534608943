"""Prisms of polygons with holes as surfaces."""

import numpy as np
import pytest

from lumped.sections import Angle, Channel, Polygon, Tee
from validation.drawing.walls import end_triangles, walled

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
HOLES = (
    ((0.1, 0.1), (0.4, 0.1), (0.4, 0.9), (0.1, 0.9)),
    ((0.6, 0.2), (0.9, 0.3), (0.7, 0.8)),
)
SECTIONS = [
    Channel(0.05, 0.1, 0.006, 0.005),
    Angle(0.06, 0.1, 0.006, 0.005),
    Tee(0.06, 0.1, 0.006, 0.005),
    Polygon(SQUARE, HOLES),
]


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_end_triangles_fill_section(section):
    """Their areas are positive, and sum to that of the section."""
    loops = section.centred_loops
    a, b, c = (np.vstack(loops)[end_triangles(loops)[:, k]] for k in range(3))
    (uy, uz), (vy, vz) = (b - a).T, (c - a).T
    areas = 0.5 * (uy * vz - uz * vy)
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(section.area, rel=1e-12)


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_hollow_prism_surface_is_closed(section):
    """Volume by Gauss's theorem: a third of the sum of x·n dA with outward normals."""
    surface = walled(section.centred_loops, np.array([0.0, 0.3, 2.0]))
    first, second, third, fourth = (surface.points[surface.faces[:, k]] for k in range(4))
    triangles = [(first, second, third), (first, third, fourth)]
    volume = sum(np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0 for a, b, c in triangles)
    assert volume == pytest.approx(2.0 * section.area, rel=1e-12)
