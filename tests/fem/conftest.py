import numpy as np
import pytest
from scipy.sparse import csr_array, eye_array, kron

from fem.elasticity import stiffness_and_mass
from lumped.legs import Material
from lumped.sections import Rectangle
from meshes.extrude import extrude, stations
from meshes.section_mesh import section_mesh


@pytest.fixture(scope="session")
def short_leg():
    """Stiffness and mass of a short hexahedral leg without the nodes of its root."""
    mesh = extrude(section_mesh(Rectangle(0.04, 0.06), 2, "quad9"), stations(0.3, 6))
    K, M = stiffness_and_mass(mesh, Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0))
    free = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.root.nodes)
    unknowns = (3 * free[:, None] + np.arange(3)).ravel()
    M = csr_array(kron(M, eye_array(3), format="csr"))
    return K[unknowns][:, unknowns], M[unknowns][:, unknowns]
