"""Section constants by boundary elements on the outline, against finite elements inside it."""

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
    # An oblique outline with a hole: re-entrant corners that are no right angles.
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
    computed = section_constants(section_mesh(section, divisions), nu)
    return np.array(
        [
            computed.area,
            computed.second_moment_y,
            computed.second_moment_z,
            computed.product_moment,
            computed.torsion_constant,
            *np.subtract(computed.shear_centre, computed.centroid),
            *computed.shear_coefficients,
            computed.shear_coupling,
        ]
    )


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_constants_equal_boundary_elements(section):
    """Finite elements converge to the boundary elements.

    At re-entrant right angles finite elements converge with h^(4/3): each refinement removes at
    least half of the difference, and at most 1 % remains. Boundary elements have an error of 5e-5.
    Constants that vanish are compared relative to the section's size.
    """
    nu, size = 0.3, max(section.extent)
    rim = by_rim(section, nu)
    scale = np.abs(rim)
    scale[3] = section.second_moment_y + section.second_moment_z
    scale[5:7], scale[9] = size, 1.0
    coarse, fine = (
        np.abs(by_elements(section, nu, divisions) - rim) / scale for divisions in (8, 16)
    )
    # Area and second moments of area are integrated exactly.
    assert (fine[:4] < 1e-10).all()
    assert (fine < np.maximum(0.55 * coarse, 5e-5)).all()
    assert (fine < 1e-2).all()


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_outline_mesh_is_centred_and_valid(section):
    """Each refinement gives four times the cells; all are well shaped, centroid at the origin."""
    coarse, fine = (section_mesh(section, divisions) for divisions in (4, 8))
    assert len(fine.cells) == 4 * len(coarse.cells)
    jacobians, aspects = quality(fine)
    assert jacobians.min() > 0.2
    assert aspects.max() < 10.0
    constants = section_constants(fine, 0.3)
    assert np.allclose(constants.centroid, 0.0, atol=1e-12)
