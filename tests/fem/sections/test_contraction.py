"""Bending of meshes with curved cells, which cannot contract: against elasticity on the prism."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from prismatic_legs import STEEL

from fem.sections.contraction import held_contraction
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import assembled, elasticity, strains
from lumped.legs import Material
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import section_mesh

AUXETIC = Material.isotropic(2.1e11, -0.9, 7850.0)
CUBIC = Material(E=1.0, G=2.0, nu=0.25, rho=1.0)


@pytest.mark.parametrize(
    ("section", "nu"),
    [
        (Rectangle(0.1, 0.16), 0.3),
        (HollowRectangle(0.1, 0.16, 0.01), 0.3),
        (ISection(0.1, 0.16, 0.012, 0.008), 0.3),
        (Circle(0.1), 0.0),
    ],
)
def test_straight_cells_and_all_without_poissons_ratio_contract_as_asked(section, nu):
    quad = section_quadrature(section_mesh(section, 2))
    assert not held_contraction(quad, nu, 0.4).any()


@pytest.mark.parametrize("material", [STEEL, AUXETIC, CUBIC])
@pytest.mark.parametrize("section", [Circle(0.1), Tube(0.1, 0.02)])
def test_energy_is_the_least_of_plane_displacements_beside_plane_sections(section, material):
    """Dense generalised plane strain, all of C on all unknowns: f₀ − fᵀK⁺f over E, with εxx = s."""
    quad = section_quadrature(section_mesh(section, 4))
    moduli, field = elasticity(material), strains(quad, 0.0)
    local = np.einsum("mqsi,st,mqtj,mq->mij", field, moduli, field, quad.weights, optimize=True)
    cells = 3 * quad.mesh.cells[:, :, None] + np.arange(3)
    expected = np.zeros((2, 2))
    loads = np.zeros((3 * len(quad.mesh.nodes), 2))
    for i, s in enumerate(quad.points):
        by_cell = np.einsum("mqsi,s,mq->mi", field, moduli[:, 0], s * quad.weights)
        np.add.at(loads[:, i], cells.reshape(len(local), -1), by_cell)
        for j, other in enumerate(quad.points):
            expected[i, j] = moduli[0, 0] * quad.integral(s * other)
    relaxed = np.linalg.lstsq(assembled(quad, local), loads, rcond=1e-11)[0]
    expected -= loads.T @ relaxed
    moments = np.array([[quad.integral(a * b) for b in quad.points] for a in quad.points])
    found = moments + held_contraction(quad, material.nu, material.G / material.E)
    # Rounding of the pseudoinverse, with stiffnesses 40 times apart for ν = −0.9.
    assert_allclose(found, expected / material.E, rtol=0.0, atol=1e-9 * moments[0, 0])
    assert found[0, 0] > moments[0, 0] * (1.0 + 1e-6)
