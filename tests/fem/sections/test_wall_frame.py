"""Frame stiffness of rectangular tubes by finite elements, against that of thin walls."""

import pytest

from fem.sections.wall_frame import formula_frame_stiffness, mesh_frame_stiffness
from lumped.legs import ConstantLeg, Material
from lumped.sections import HollowRectangle
from meshes.section.section_mesh import section_mesh

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)


@pytest.mark.parametrize("height", [0.1, 0.05])
def test_thin_frame_on_mesh_has_stiffness_of_formula(height):
    """Corners are between rigid and flexible: 24 D/(b* + h*) is exact within t/(b + h)."""
    section = HollowRectangle(0.1, height, 0.004)
    mesh = section_mesh(section, 16)
    formula = formula_frame_stiffness(ConstantLeg(1.0, section, ALLOY))
    assert mesh_frame_stiffness(mesh, ALLOY) == pytest.approx(formula, rel=0.01)


def test_frame_with_one_element_across_walls_is_too_stiff():
    section = HollowRectangle(0.1, 0.08, 0.002)
    formula = formula_frame_stiffness(ConstantLeg(1.0, section, ALLOY))
    assert mesh_frame_stiffness(section_mesh(section, 1), ALLOY) / formula == pytest.approx(
        1.052, abs=1e-3
    )
