"""Sections within outlines: boundary elements on the rim against finite elements inside."""

import numpy as np
import pytest

from fem.sections.section_constants import section_constants
from lumped.sections import Angle, Channel, Polygon, Tee
from meshes.quality import quality
from meshes.section.section_mesh import section_mesh

SECTIONS = [
    Channel(0.05, 0.1, 0.02, 0.015),
    Angle(0.06, 0.1, 0.02, 0.02),
    Tee(0.06, 0.1, 0.02, 0.015),
    Polygon(((0.0, 0.0), (0.1, 0.0), (0.03, 0.08))),
    # A sloping wall with a hole of its own: inward corners that are no right angles.
    Polygon(
        ((0.0, 0.0), (0.1, 0.0), (0.1, 0.06), (0.03, 0.09)),
        (((0.03, 0.02), (0.08, 0.02), (0.08, 0.045), (0.04, 0.06)),),
    ),
]


def by_rim(section, nu):
    return np.array(
        [
            section.area,
            section.second_moment_y,
            section.second_moment_z,
            section.product_moment,
            section.torsion_constant,
            *section.shear_centre,
            *section.shear_coefficients(nu),
            section.shear_coupling(nu),
        ]
    )


def by_elements(section, nu, divisions):
    found = section_constants(section_mesh(section, divisions), nu)
    return np.array(
        [
            found.area,
            found.second_moment_y,
            found.second_moment_z,
            found.product_moment,
            found.torsion_constant,
            *np.subtract(found.shear_centre, found.centroid),
            *found.shear_coefficients,
            found.shear_coupling,
        ]
    )


@pytest.mark.parametrize("section", SECTIONS, ids=lambda one: one.shape)
def test_section_constants_converge_to_rim_solution(section):
    """Two formulations, each of its own mesh; scales are the section's size where one vanishes.

    Finite elements converge with h^(4/3) at inward right angles: half the distance at least is
    gone with every doubling, and 1 % is left on the finest mesh. Boundary elements leave 5e-5.
    """
    nu, size = 0.3, max(section.extent)
    rim = by_rim(section, nu)
    scale = np.abs(rim)
    scale[3] = section.second_moment_y + section.second_moment_z
    scale[5:7], scale[9] = size, 1.0
    coarse, fine = (
        np.abs(by_elements(section, nu, divisions) - rim) / scale for divisions in (8, 16)
    )
    # Polynomials of second degree are integrated exactly.
    assert (fine[:4] < 1e-10).all()
    assert (fine < np.maximum(0.55 * coarse, 5e-5)).all()
    assert (fine < 1e-2).all()


@pytest.mark.parametrize("section", SECTIONS, ids=lambda one: one.shape)
def test_mesh_of_an_outline_is_centred_and_sound(section):
    coarse, fine = (section_mesh(section, divisions) for divisions in (4, 8))
    assert len(fine.cells) == 4 * len(coarse.cells)
    jacobians, aspects = quality(fine)
    assert jacobians.min() > 0.2
    assert aspects.max() < 10.0
    constants = section_constants(fine, 0.3)
    assert np.allclose(constants.centroid, 0.0, atol=1e-12)
