import numpy as np
import pytest
import skfem
from prismatic_legs import STEEL
from scipy.sparse.linalg import cg
from skfem.helpers import ddot, dot, sym_grad, trace
from skfem.helpers import eye as identity

from fem.elements.elasticity import on_three_components, stiffness, stiffness_and_mass
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.elements import ELEMENTS
from meshes.shape_functions import gradients
from meshes.solid_mesh import VolumeMesh

CUBIC = Material(E=1.9e11, G=1.2e11, nu=0.22, rho=7850.0)
NAMES = ("hex8", "hex27", "tet4", "tet10")
SKFEM = {
    "hex8": (skfem.MeshHex1, skfem.MeshHex1, skfem.ElementHex1),
    "hex27": (skfem.MeshHex1, skfem.MeshHex2, skfem.ElementHex2),
    "tet4": (skfem.MeshTet1, skfem.MeshTet1, skfem.ElementTetP1),
    "tet10": (skfem.MeshTet1, skfem.MeshTet2, skfem.ElementTetP2),
}
# Exact for straight cells (stiffness) and for all cells (mass), by counting degrees by hand.
STIFFNESS_DEGREE = {"hex8": 3, "hex27": 5, "tet4": 1, "tet10": 2}
MASS_DEGREE = {"hex8": 4, "hex27": 9, "tet4": 2, "tet10": 7}


def skfem_box(name, divisions):
    linear, mesh_type, _ = SKFEM[name]
    grids = [np.linspace(0.0, 1.0, n + 1) for n in divisions]
    mesh = linear.init_tensor(*grids)
    return mesh if mesh_type is linear else mesh_type.from_mesh(mesh)


def local_numbers(name, mirrored):
    """Our local numbers expressed in scikit-fem's, by place; mirrored swaps the first two axes."""
    theirs = np.asarray(SKFEM[name][2]().doflocs)
    ours = ELEMENTS[name].nodes[:, [1, 0, 2]] if mirrored else ELEMENTS[name].nodes
    distance = np.abs(theirs[None] - ours[:, None]).sum(axis=2)
    assert distance.min(axis=1).max() == 0.0
    return distance.argmin(axis=1)


def from_skfem(mesh, name):
    """The same mesh in our node order, right-handed."""
    element_dofs = skfem.Basis(mesh, SKFEM[name][2](), intorder=1).element_dofs.T
    nodes = mesh.doflocs.T.copy()
    cells = element_dofs[:, local_numbers(name, mirrored=False)]
    centre = ELEMENTS[name].nodes.mean(axis=0)[:, None]
    slopes = gradients(name, centre)[:, :, 0]
    jacobian = np.einsum("eki,kj->eij", nodes[cells], slopes)
    left = np.linalg.det(jacobian) < 0.0
    cells[left] = element_dofs[left][:, local_numbers(name, mirrored=True)]
    return VolumeMesh(nodes, cells.astype(np.int64), name)


def distorted(name, divisions=(3, 2, 2), amount=0.06):
    """A box with every node moved: cells with curved edges and faces that are not plane."""
    mesh = skfem_box(name, divisions)
    x, y, z = mesh.doflocs
    moved = mesh.doflocs + amount * np.array(
        [np.sin(3.0 * y + z), np.sin(2.0 * z - 1.5 * x), np.cos(2.5 * x + y)]
    )
    return type(mesh)(moved, mesh.t)


def vector_matrix(form, mesh, name, degree):
    """A vector form of scikit-fem with unknowns renumbered to 3·node + component."""
    element = SKFEM[name][2]()
    basis = skfem.Basis(mesh, skfem.ElementVector(element), intorder=degree)
    scalar = skfem.Basis(mesh, element, intorder=1).element_dofs
    new = np.empty(basis.N, dtype=np.int64)
    for i, dofs in enumerate(basis.element_dofs):
        new[dofs] = 3 * scalar[i // 3] + i % 3
    matrix = form.assemble(basis).tocoo()
    return np.bincount(
        new[matrix.row] * basis.N + new[matrix.col], matrix.data, basis.N**2
    ).reshape(basis.N, basis.N)


def elastic_form(material):
    """Cubic elasticity by Voigt's three constants, written without our D_ab."""
    factor = material.E / ((1.0 + material.nu) * (1.0 - 2.0 * material.nu))
    c11, c12, c44 = factor * (1.0 - material.nu), factor * material.nu, material.G

    @skfem.BilinearForm
    def form(u, v, _):
        strain, test = sym_grad(u), sym_grad(v)
        stress = 2.0 * c44 * strain + c12 * trace(strain) * identity(1.0 + 0.0 * trace(strain), 3)
        normal = sum(strain[i, i] * test[i, i] for i in range(3))
        return ddot(stress, test) + (c11 - c12 - 2.0 * c44) * normal

    return form


@pytest.mark.parametrize("name", NAMES)
def test_stiffness_and_mass_are_scikit_fems_on_curved_cells(name):
    mesh = distorted(name)
    ours = from_skfem(mesh, name)
    K, M = stiffness_and_mass(ours, CUBIC)
    assert (stiffness(ours, CUBIC) != K).nnz == 0
    mass_form = skfem.BilinearForm(lambda u, v, _: CUBIC.rho * dot(u, v))
    for found, form, degree in (
        (K, elastic_form(CUBIC), STIFFNESS_DEGREE[name]),
        (on_three_components(M), mass_form, MASS_DEGREE[name]),
    ):
        expected, dense = vector_matrix(form, mesh, name, degree), found.toarray()
        # Sums of some hundred products in another order: a few units in the fifteenth digit.
        assert np.abs(dense - expected).max() <= 1e-14 * np.abs(expected).max()
        assert (dense == dense.T).all()
        assert found.has_sorted_indices


# Element, divisions, order in L2 (Ciarlet: p + 1) and the cap on the finest mesh's error: a few
# times h^{p+1} of a solution whose derivatives are of order one to ten.
@pytest.mark.parametrize(
    ("name", "divisions", "order", "cap"),
    [
        ("hex8", (3, 6, 9), 2, 1e-2),
        ("hex27", (2, 3, 4), 3, 2e-3),
        ("tet4", (6, 9, 12), 2, 2.5e-2),
        ("tet10", (2, 4, 6), 3, 1e-3),
    ],
)
def test_manufactured_solution_converges_at_the_elements_order(name, divisions, order, cap):
    """u = a sin(k·x) under −div σ = (λ + G) k (k·a) sin + G k² a sin; λ = G = 1 for ν = 0.25."""
    material = Material.isotropic(E=2.5, nu=0.25, rho=1.0)
    a, k = np.array([1.0, -0.7, 0.5]), np.array([1.3, 2.1, -1.7])
    errors = []
    for n in divisions:
        box = skfem_box(name, (n, n, n))
        mesh = from_skfem(distorted(name, (n, n, n), amount=0.04), name)
        K, M = stiffness_and_mass(mesh, material)
        wave = np.sin(mesh.nodes @ k)[:, None]
        load, exact = (M @ (wave * (2.0 * k * (k @ a) + k @ k * a))).ravel(), (wave * a).ravel()
        free = np.repeat((np.abs(box.doflocs.T - 0.5) < 0.499).all(axis=1), 3)
        # Conjugate gradients, not our factorisation, so that each is tested by itself.
        error = np.zeros_like(exact)
        error[free], info = cg(K[free][:, free], (load - K @ exact)[free], rtol=1e-9, maxiter=3000)
        assert info == 0
        errors.append(np.sqrt(error @ (on_three_components(M) @ error)))
    # Nodes may converge faster than what is between them; a lost order would show as −1.
    assert -np.polyfit(np.log(divisions), np.log(errors), 1)[0] > order - 0.25
    assert errors[-1] < cap


def test_folded_element_is_named():
    mesh = from_skfem(skfem_box("hex8", (3, 1, 1)), "hex8")
    cells = mesh.cells.copy()
    cells[1] = cells[1, [4, 5, 6, 7, 0, 1, 2, 3]]
    folded = VolumeMesh(mesh.nodes, cells, "hex8")
    with pytest.raises(ComputationError, match="hex8 element 1 is folded"):
        stiffness(folded, STEEL)
