import numpy as np
import pytest

from fem.couplings.grips import unknowns
from fem.elements.elasticity import on_three_components, stiffness_and_mass
from lumped.legs import Material
from lumped.sections import Rectangle
from meshes.prism.hexahedra import extrude, stations
from meshes.section.section_mesh import section_mesh


@pytest.fixture(scope="session")
def short_leg():
    """Stiffness and mass of a hexahedral leg without the nodes of its root."""
    material = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
    mesh = extrude(section_mesh(Rectangle(0.04, 0.06), 2), stations(0.3, 4))
    free = unknowns(np.setdiff1d(np.arange(len(mesh.nodes)), mesh.root.nodes))
    K, M = stiffness_and_mass(mesh, material)
    return K[free][:, free], on_three_components(M)[free][:, free]
