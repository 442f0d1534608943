"""Stiffness and mass matrices of solids against scikit-fem and a manufactured solution."""

from itertools import permutations

import numpy as np
import pytest
import skfem
from scipy.sparse.linalg import cg
from skfem.helpers import ddot, sym_grad, trace
from skfem.helpers import eye as identity
from support.robots.paper_legs import CUBIC, STEEL

from fem.elasticity import on_three_components, stiffness, stiffness_and_mass
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.elements import ELEMENTS
from meshes.solid_mesh import VolumeMesh

# Mesh and element classes of scikit-fem, and quadrature degrees that are exact for the stiffness of
# straight elements and for the mass of all elements.
SKFEM = {
    "hex8": (skfem.MeshHex1, skfem.ElementHex1(), 3, 4),
    "hex20": (skfem.MeshHex2, skfem.ElementHexS2(), 5, 9),
    "hex27": (skfem.MeshHex2, skfem.ElementHex2(), 5, 9),
    "tet4": (skfem.MeshTet1, skfem.ElementTetP1(), 1, 2),
    "tet10": (skfem.MeshTet2, skfem.ElementTetP2(), 2, 7),
}


@skfem.BilinearForm
def elasticity(u, v, _):
    """Return the cubic strain energy density from c11, c12 and c44, written independently."""
    factor = CUBIC.E / ((1.0 + CUBIC.nu) * (1.0 - 2.0 * CUBIC.nu))
    c11, c12, c44 = factor * (1.0 - CUBIC.nu), factor * CUBIC.nu, CUBIC.G
    strain, test = sym_grad(u), sym_grad(v)
    stress = 2.0 * c44 * strain + c12 * trace(strain) * identity(1.0 + 0.0 * trace(strain), 3)
    normal = sum(strain[i, i] * test[i, i] for i in range(3))
    return ddot(stress, test) + (c11 - c12 - 2.0 * c44) * normal


@skfem.BilinearForm
def inertia(u, v, _):
    return CUBIC.rho * u * v


@pytest.mark.parametrize("name", SKFEM)
def test_matrices_equal_scikit_fem(name):
    """Stiffness and mass of one bent element of each type, for a cubic material."""
    kind, element, *degrees = SKFEM[name]
    cell = skfem.MeshHex1 if name.startswith("hex") else skfem.MeshTet1
    straight = kind.from_mesh(cell.init_refdom())
    # A quadratic mapping, which all elements of second order represent exactly.
    x, y, z = straight.doflocs
    bent = [y * z + 0.5 * y**2, z**2 - 0.7 * x * z, 0.8 * x**2 + x * y]
    mesh = kind(straight.doflocs + 0.2 * np.array(bent), straight.t)
    scalar = skfem.Basis(mesh, element, intorder=1)
    nodes = scalar.doflocs.T[scalar.element_dofs[:, 0]]
    distances = np.abs(ELEMENTS[name].nodes[:, None] - np.asarray(element.doflocs)).sum(axis=2)
    assert distances.min(axis=1).max() == 0.0
    order = distances.argmin(axis=1)
    single = VolumeMesh(nodes[order], np.arange(len(order))[None], name)
    forms = (elasticity, skfem.ElementVector(element), 3), (inertia, element, 1)
    compared = zip(stiffness_and_mass(single, CUBIC), forms, degrees, strict=True)
    for matrix, (form, kind_of_field, components), degree in compared:
        basis = skfem.Basis(mesh, kind_of_field, intorder=degree)
        unknowns = basis.element_dofs[:, 0].reshape(-1, components)[order].ravel()
        expected = form.assemble(basis).toarray()[np.ix_(unknowns, unknowns)]
        # Rounding error of sums in another order: 2e-15 with five kernels of OpenBLAS.
        assert np.abs(matrix.toarray() - expected).max() <= 1e-13 * np.abs(expected).max()


def box(name, count, amount):
    """Return a mesh of a unit box, and for each unknown whether it is inside.

    The box consists of `count`³ cubes. If the element `name` is a tetrahedron, each cube is cut
    into six.
    All nodes are moved by up to `amount`, so that the elements are curved.
    """
    kind, sides = ELEMENTS[name], np.eye(3)
    ways = [sides] if name.startswith("hex") else np.cumsum(list(permutations(sides)), axis=1)
    grid = np.indices((count,) * 3).reshape(3, -1).T
    # Elements are made right-handed.
    cells = [
        kind.nodes @ (corner_axes if np.linalg.det(corner_axes) > 0 else corner_axes[[1, 0, 2]])
        for corner_axes in ways
    ]
    positions = np.concatenate([np.rint(2 * (grid[:, None] + cell)).astype(int) for cell in cells])
    numbers = np.ravel_multi_index(np.moveaxis(positions, -1, 0), (2 * count + 1,) * 3)
    _, first, index = np.unique(numbers, return_index=True, return_inverse=True)
    straight = positions.reshape(-1, 3)[first] / (2 * count)
    x, y, z = straight.T
    moves = [np.sin(3.0 * y + z), np.sin(2.0 * z - 1.5 * x), np.cos(2.5 * x + y)]
    inside = (np.abs(straight - 0.5) < 0.499).all(axis=1)
    mesh = VolumeMesh(
        straight + amount * np.column_stack(moves), index.reshape(numbers.shape), name
    )
    return mesh, np.repeat(inside, 3)


# Element, divisions, order of convergence in L2 (Ciarlet: p + 1) and bound of the finest mesh's
# error: a few times h^{p+1}, for a solution whose derivatives are of order one to ten.
@pytest.mark.parametrize(
    ("name", "divisions", "order", "cap"),
    [
        ("hex8", (3, 6, 9), 2, 1e-2),
        ("hex20", (2, 3, 4), 3, 2e-3),
        ("hex27", (2, 3, 4), 3, 2e-3),
        ("tet4", (6, 9, 12), 2, 2.5e-2),
        ("tet10", (2, 4, 6), 3, 1e-3),
    ],
)
def test_manufactured_solution_has_full_order(name, divisions, order, cap):
    """u = a sin(k·x) with its body force (λ + G) k (k·a) sin(k·x) + G k² a sin(k·x), λ = G = 1."""
    material = Material.isotropic(E=2.5, nu=0.25, rho=1.0)
    a, k = np.array([1.0, -0.7, 0.5]), np.array([1.3, 2.1, -1.7])
    errors = []
    for n in divisions:
        mesh, free = box(name, n, 0.04)
        K, M = stiffness_and_mass(mesh, material)
        wave = np.sin(mesh.nodes @ k)[:, None]
        load, exact = (M @ (wave * (2.0 * k * (k @ a) + k @ k * a))).ravel(), (wave * a).ravel()
        # Solved by conjugate gradients, independently of flexproof's factorisation.
        error = np.zeros_like(exact)
        error[free], info = cg(K[free][:, free], (load - K @ exact)[free], rtol=1e-9, maxiter=3000)
        assert info == 0
        errors.append(np.sqrt(error @ (on_three_components(M) @ error)))
    # Errors at nodes may fall faster than those between them; a defect would lower the order by 1.
    assert -np.polyfit(np.log(divisions), np.log(errors), 1)[0] > order - 0.25
    assert errors[-1] < cap
    assert (stiffness(mesh, material) != K).nnz == (K != K.T).nnz == 0
    assert K.has_sorted_indices


def test_folded_element_is_reported():
    """An element whose nodes are listed inside out: type and number in the message."""
    mesh, _ = box("hex8", 2, 0.0)
    mesh.cells[1] = mesh.cells[1, [4, 5, 6, 7, 0, 1, 2, 3]]
    with pytest.raises(ComputationError, match="hex8 element 1 is folded"):
        stiffness(mesh, STEEL)
