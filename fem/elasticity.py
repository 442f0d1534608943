"""Stiffness and mass matrices of solids, computed for many elements at once.

For a chunk of elements one batched matrix product gives D_ab = ∫ ∇N_a ⊗ ∇N_b dV (3×3 for each pair
of nodes). The material is constant in a body. It is therefore applied after summation, once per
pair of nodes: K_ab = C_ijkl D_ab,jl. Only pairs (a, b) with a ≤ b are summed and then mirrored, so
that the matrix is symmetric to the last bit.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array, eye_array, kron

from fem.machine import threads
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.elements import ElementName
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import VolumeMesh

# Degree of quadrature for the stiffness, by element type: the fewest points that integrate
# ∇N_a·∇N_b exactly on a cell with straight, parallel edges (degree 2 and 4 per coordinate on cubes,
# 0 and 2 on simplices). The rank of an element matrix is then full (no hourglass modes), and on
# curved cells the error is of the order of the element. These are also the points of C3D8, C3D4 and
# C3D10.
_STIFFNESS_DEGREE = {"hex8": 3, "hex20": 5, "hex27": 5, "tet4": 1, "tet10": 2}
# Degree of quadrature for the mass, by element type: N_a N_b det J is a polynomial on each cell,
# also on curved ones, and integrated exactly. N_a N_b has the degree 2p; det J adds 3p − 1 per
# coordinate on cubes and 3(p − 1) on simplices.
_MASS_DEGREE = {"hex8": 4, "hex20": 9, "hex27": 9, "tet4": 2, "tet10": 7}

# Largest ratio of largest to smallest modulus. On clamped legs with ν → −1 and ν → ½, the relative
# error of the compliance is 1e-13 (thin walls: 3e-11) times this ratio, so that four digits are
# exact.
_MOST_UNEVEN = 1e6

_CHUNK_BYTES = 16_000_000


@dataclass(frozen=True, eq=False)
class NodePairs:
    """Pairs of nodes that share an element, in a mesh of E elements with k nodes each.

    There are P pairs, sorted by (row, column), with row ≤ column. `rows` and `columns` (P) are
    their nodes. An element has T = k(k+1)/2 pairs. `summation` (P×(E·T)) adds up the contributions
    of the pairs of all elements. `upper` (E×k×k bool) selects the T pairs of an element out of its
    k² ordered pairs.
    """

    node_count: int
    rows: IntArray
    columns: IntArray
    summation: SparseMatrix
    upper: NDArray[np.bool_]

    @property
    def diagonal(self) -> IntArray:
        """Indices (N) of the pairs of a node with itself."""
        return np.flatnonzero(self.rows == self.columns)


def _stable_order(keys: NDArray[np.integer], bound: int) -> NDArray[np.integer]:
    """Stable sorting permutation of `keys` in [0, bound), by counting in linear time."""
    count = len(keys)
    pointers = np.arange(count + 1, dtype=np.int32)
    marks = csr_array((np.empty(count, dtype=np.int8), keys, pointers), shape=(count, bound))
    return np.asarray(marks.tocsc().indices)


def node_pairs(cells: IntArray, node_count: int) -> NodePairs:
    """Pairs of nodes of a mesh with connectivity `cells` (E×k) and `node_count` nodes."""
    nodes = cells.astype(np.int32)
    rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None, :])
    upper = rows <= columns
    rows, columns = rows[upper], columns[upper]

    by_column = _stable_order(columns, node_count)
    order = by_column[_stable_order(rows[by_column], node_count)]
    rows, columns = rows[order], columns[order]
    starts = np.flatnonzero(
        np.concatenate([[True], (rows[1:] != rows[:-1]) | (columns[1:] != columns[:-1])])
    )
    pointers = np.append(starts, len(order)).astype(np.int32)
    summation = csr_array((np.ones(len(order)), order, pointers), shape=(len(starts), len(order)))
    return NodePairs(node_count, rows[starts], columns[starts], summation, upper)


def symmetric_matrix(pairs: NodePairs, blocks: Array) -> SparseMatrix:
    """Symmetric matrix (csr, N·c × N·c) of N nodes with c unknowns each.

    `blocks` (P×c×c) are its blocks for the pairs of nodes, on and above the diagonal.
    """
    count, width = pairs.node_count, blocks.shape[1]
    above = np.flatnonzero(pairs.rows != pairs.columns)
    mirrored = above[_stable_order(pairs.columns[above], count)]
    per_row_below = np.bincount(pairs.columns[above], minlength=count)
    per_row_upper = np.bincount(pairs.rows, minlength=count)
    # In row a the mirrored pairs (columns < a) come first, so that columns are sorted.
    below_until_row = np.cumsum(per_row_below)
    upper_before_row = np.cumsum(per_row_upper) - per_row_upper
    place_upper = np.arange(len(blocks)) + below_until_row[pairs.rows]
    place_below = np.arange(len(mirrored)) + upper_before_row[pairs.columns[mirrored]]

    columns = np.empty(len(blocks) + len(mirrored), dtype=np.int32)
    columns[place_upper] = pairs.columns
    columns[place_below] = pairs.rows[mirrored]
    values = np.empty((len(columns), width, width))
    values[place_upper] = blocks
    values[place_below] = blocks[mirrored].transpose(0, 2, 1)
    pointers = np.concatenate([[0], np.cumsum(per_row_below + per_row_upper)]).astype(np.int32)
    shape = (count * width, count * width)
    matrix = bsr_array((values, columns, pointers), shape=shape).tocsr()
    matrix.has_canonical_format = True
    return matrix


@dataclass(frozen=True, eq=False)
class _Cubature:
    """Shape functions N (k×Q), their reference gradients (k×3×Q) and quadrature weights (Q)."""

    shapes: Array
    gradients: Array
    weights: Array


def _cubature(element: ElementName, degree: int) -> _Cubature:
    points, weights = quadrature(element, degree)
    return _Cubature(values(element, points), gradients(element, points), weights)


def _for_each_chunk(
    integrate: Callable[[slice], None], count: int, floats_per_element: int
) -> None:
    """Call `integrate` for all chunks into which `count` elements are divided, several at a time.

    `floats_per_element` is the number of floating-point numbers that an element needs, from which
    the size of a chunk follows. Each chunk fills entries of its own, so that the bits of the result
    do not depend on the number of threads. If chunks fail, the error of the first one is raised.
    """
    size = max(1, _CHUNK_BYTES // (8 * floats_per_element))
    chunks = [slice(start, min(start + size, count)) for start in range(0, count, size)]
    with ThreadPoolExecutor(min(threads(), max(1, len(chunks)))) as executor:
        for _ in executor.map(integrate, chunks):
            pass


def _jacobians(mesh: VolumeMesh, chunk: slice, reference_gradients: Array) -> tuple[Array, Array]:
    """Jacobians ∂x_i/∂ξ_j (e×Q×3×3) of the e elements in `chunk`, and their determinants (e×Q).

    `reference_gradients` (k×3×Q) are the gradients of the shape functions at Q points. Raises
    ComputationError if a determinant is not positive.
    """
    k, _, points = reference_gradients.shape
    corners = mesh.nodes[mesh.cells[chunk]].transpose(0, 2, 1)
    jacobian = corners @ reference_gradients.transpose(0, 2, 1).reshape(k, points * 3)
    jacobian = jacobian.reshape(-1, 3, points, 3).transpose(0, 2, 1, 3)
    determinant = np.einsum(
        "...i,...i->...", jacobian[..., 0], np.cross(jacobian[..., 1], jacobian[..., 2])
    )
    folded = np.flatnonzero(~(determinant > 0.0).all(axis=1))
    if folded.size:
        raise ComputationError(
            f"solid mesh: {mesh.element} element {chunk.start + folded[0]} is folded or flat "
            f"(Jacobian determinant {determinant[folded[0]].min():.3g} m³ at an integration "
            "point): the mesh is too coarse for the curvature of the section, or its nodes are "
            "numbered inside out"
        )
    return jacobian, determinant


def _inverse(jacobian: Array, determinant: Array) -> Array:
    """Inverses (…×3×3) of matrices `jacobian` (…×3×3) with known `determinant` (…), by cofactors.

    This is ten times as fast as calling LAPACK for each matrix.
    """
    first, second, third = jacobian[..., 0], jacobian[..., 1], jacobian[..., 2]
    rows = [np.cross(second, third), np.cross(third, first), np.cross(first, second)]
    return np.stack(rows, axis=-2) / determinant[..., None, None]


def _gradient_products(mesh: VolumeMesh, pairs: NodePairs) -> Array:
    """Integrals D_ab = ∫ ∂_j N_a ∂_l N_b dV (E·T×3×3, in m) over each element.

    They are computed for the T pairs of nodes (a, b) of each of E elements.
    """
    cubature = _cubature(mesh.element, _STIFFNESS_DEGREE[mesh.element])
    k, _, points = cubature.gradients.shape
    reference = cubature.gradients.transpose(2, 0, 1)
    count, per_element = len(mesh.cells), k * (k + 1) // 2
    products = np.empty((count * per_element, 3, 3))

    def integrate(chunk: slice) -> None:
        jacobian, determinant = _jacobians(mesh, chunk, cubature.gradients)
        gradient = reference @ _inverse(jacobian, determinant)
        weights = cubature.weights * determinant
        gradient *= np.sqrt(weights)[:, :, None, None]
        gradient = gradient.reshape(-1, points, 3 * k)
        product = gradient.transpose(0, 2, 1) @ gradient
        product = product.reshape(-1, k, 3, k, 3).transpose(0, 1, 3, 2, 4)
        rows = slice(chunk.start * per_element, chunk.stop * per_element)
        products[rows] = product[pairs.upper[chunk]]

    _for_each_chunk(integrate, count, 2 * (3 * k) ** 2 + 2 * points * 3 * k)
    return products


def _summed(pairs: NodePairs, blocks: Array) -> Array:
    """Sums (P×3×3) of the elements' blocks (E·T×3×3) for each pair of nodes.

    The block of a node with itself is made symmetric.
    """
    summed: Array = (pairs.summation @ blocks.reshape(-1, 9)).reshape(-1, 3, 3)
    diagonal = pairs.diagonal
    summed[diagonal] = (summed[diagonal] + summed[diagonal].transpose(0, 2, 1)) / 2.0
    return summed


def _node_blocks(products: Array, material: Material) -> Array:
    """Stiffness blocks (n×3×3) of n pairs of nodes, for a material with cubic symmetry.

    `products` (n×3×3) are the integrals D. K_ii = C11 D_ii + C44 (D_jj + D_kk), K_ij = C12 D_ij +
    C44 D_ji, with C11 = E(1−ν)/(1+ν)(1−2ν), C12 = C11 ν/(1−ν), C44 = G.
    """
    _require_resolvable(material)
    nu = material.nu
    C12 = material.E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C11 = material.E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C44 = material.G
    blocks = C12 * products
    blocks += C44 * products.transpose(0, 2, 1)
    trace = products[:, 0, 0] + products[:, 1, 1] + products[:, 2, 2]
    for i in range(3):
        blocks[:, i, i] = (C11 - C44) * products[:, i, i] + C44 * trace
    return blocks


def _require_resolvable(material: Material) -> None:
    """Raise ComputationError if the moduli of a material differ by more than round-off allows.

    The moduli are the eigenvalues of the elasticity matrix: E/(1−2ν) for changes of volume, E/(1+ν)
    for changes of shape, and 2G for shear.
    """
    moduli = {
        "changes of volume": material.E / (1.0 - 2.0 * material.nu),
        "changes of shape": material.E / (1.0 + material.nu),
        "shear": 2.0 * material.G,
    }
    softest, stiffest = (choose(moduli, key=moduli.__getitem__) for choose in (min, max))
    if not 0.0 < moduli[softest] * _MOST_UNEVEN >= moduli[stiffest]:
        raise ComputationError(
            f"material with ν = {material.nu!r}: {stiffest} ({moduli[stiffest]:.3g} Pa) and "
            f"{softest} ({moduli[softest]:.3g} Pa) differ by a factor of more than "
            f"{_MOST_UNEVEN:g}, beyond which the smaller one is lost in rounding of the stiffness "
            "of solid elements"
        )


def _scalar_mass(
    mesh: VolumeMesh, rho: float, pairs: NodePairs, factors: Array | None = None
) -> SparseMatrix:
    """Mass matrix ∫ ρ N_a N_b dV (csr N×N, in kg).

    `factors` (E) are factors on the density `rho` (kg/m³) in each element. None if all are 1.
    """
    cubature = _cubature(mesh.element, _MASS_DEGREE[mesh.element])
    k, points = cubature.shapes.shape
    table = np.einsum("aq,bq,q->qab", cubature.shapes, cubature.shapes, rho * cubature.weights)
    count, per_element = len(mesh.cells), k * (k + 1) // 2
    entries = np.empty(count * per_element)

    def integrate(chunk: slice) -> None:
        _, determinant = _jacobians(mesh, chunk, cubature.gradients)
        if factors is not None:
            determinant = determinant * factors[chunk, None]
        element_masses = (determinant @ table.reshape(points, k * k)).reshape(-1, k, k)
        rows = slice(chunk.start * per_element, chunk.stop * per_element)
        entries[rows] = element_masses[pairs.upper[chunk]]

    _for_each_chunk(integrate, count, k * k + 16 * points)
    return symmetric_matrix(pairs, (pairs.summation @ entries).reshape(-1, 1, 1))


def stiffness(mesh: VolumeMesh, material: Material) -> SparseMatrix:
    """Stiffness matrix (csr 3N×3N, in N/m) of a solid. Unknowns: 3·node + component (x, y, z).

    It is symmetric to the last bit. Each pair of nodes that share an element has its nine entries,
    including zeros, in sorted columns. The material is isotropic if material.G = E/2(1+ν),
    otherwise cubic along the axes of the mesh. Raises ComputationError, with the number of the
    first faulty element, if a Jacobian is not positive.
    """
    pairs = node_pairs(mesh.cells, len(mesh.nodes))
    return symmetric_matrix(
        pairs, _node_blocks(_summed(pairs, _gradient_products(mesh, pairs)), material)
    )


def stiffness_and_mass(mesh: VolumeMesh, material: Material) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness matrix (csr 3N×3N, in N/m) and consistent mass matrix of a solid.

    The mass matrix ∫ ρ N_a N_b dV (csr N×N, in kg) applies to each displacement component. It has a
    ninth of the entries of the stiffness matrix. Its product with displacements x (3N) is `mass @
    x.reshape(N, 3)`.
    """
    pairs = node_pairs(mesh.cells, len(mesh.nodes))
    K = symmetric_matrix(
        pairs, _node_blocks(_summed(pairs, _gradient_products(mesh, pairs)), material)
    )
    return K, _scalar_mass(mesh, material.rho, pairs)


def composite_stiffness_and_mass(
    mesh: VolumeMesh, regions: IntArray, materials: Sequence[Material]
) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness matrix (csr 3N×3N) and mass matrix (csr N×N) of a solid of several materials.

    `regions` (M) contains for each of the M elements the index of its material in `materials`. The
    matrices are those explained in `stiffness_and_mass`.
    """
    pairs = node_pairs(mesh.cells, len(mesh.nodes))
    blocks = _gradient_products(mesh, pairs)
    by_element = blocks.reshape(len(mesh.cells), -1, 3, 3)
    for region, material in enumerate(materials):
        in_region = regions == region
        products = by_element[in_region]
        by_element[in_region] = _node_blocks(products.reshape(-1, 3, 3), material).reshape(
            products.shape
        )
    densities = np.array([material.rho for material in materials])
    return symmetric_matrix(pairs, _summed(pairs, blocks)), _scalar_mass(
        mesh, 1.0, pairs, densities[regions]
    )


def anisotropic_stiffness_and_mass(
    mesh: VolumeMesh, moduli: Callable[[Array, IntArray], Array], densities: Array
) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness matrix (csr 3N×3N) and mass matrix (csr N×N) of a linear elastic solid.

    The material may be anisotropic. `moduli` is a function of points (e×Q×3, in m) in e elements
    and of the numbers (e) of these elements. It returns elasticity matrices (e×Q×6×6, in Pa) for
    strains (εxx, εyy, εzz, γyz, γxz, γxy). `densities` (E, in kg/m³) contains one density for each
    element. The matrices are those explained in `stiffness_and_mass`. Raises ComputationError if an
    elasticity matrix is not positive definite.
    """
    pairs = node_pairs(mesh.cells, len(mesh.nodes))
    cubature = _cubature(mesh.element, _STIFFNESS_DEGREE[mesh.element])
    k, _, points = cubature.gradients.shape
    reference = cubature.gradients.transpose(2, 0, 1)
    count, per_element = len(mesh.cells), k * (k + 1) // 2
    products = np.empty((count * per_element, 3, 3))

    def integrate(chunk: slice) -> None:
        jacobian, determinant = _jacobians(mesh, chunk, cubature.gradients)
        gradient = reference @ _inverse(jacobian, determinant)
        places = np.einsum("kq,eki->eqi", cubature.shapes, mesh.nodes[mesh.cells[chunk]])
        weighted = moduli(places, np.arange(chunk.start, chunk.stop))
        weighted = weighted * (cubature.weights * determinant)[..., None, None]
        try:
            factor = np.linalg.cholesky(weighted)
        except np.linalg.LinAlgError as error:
            raise ComputationError(
                "no material has these moduli: their elasticity matrix is not positive definite"
            ) from error
        strains = np.zeros((*gradient.shape[:2], 6, k, 3))
        for row, component in ((0, 0), (1, 1), (2, 2)):
            strains[:, :, row, :, component] = gradient[..., component]
        for row, (i, j) in ((3, (1, 2)), (4, (0, 2)), (5, (0, 1))):
            strains[:, :, row, :, i], strains[:, :, row, :, j] = gradient[..., j], gradient[..., i]
        root = np.swapaxes(factor, -1, -2) @ strains.reshape(*gradient.shape[:2], 6, 3 * k)
        root = root.reshape(-1, 6 * points, 3 * k)
        product = (root.transpose(0, 2, 1) @ root).reshape(-1, k, 3, k, 3).transpose(0, 1, 3, 2, 4)
        rows = slice(chunk.start * per_element, chunk.stop * per_element)
        products[rows] = product[pairs.upper[chunk]]

    _for_each_chunk(integrate, count, 2 * (3 * k) ** 2 + 2 * 6 * points * 3 * k)
    K = symmetric_matrix(pairs, _summed(pairs, products))
    return K, _scalar_mass(mesh, 1.0, pairs, densities)


def on_three_components(scalar: SparseMatrix) -> SparseMatrix:
    """Matrix scalar ⊗ I₃ (csr 3N×3N), which applies the matrix `scalar` (csr N×N) to x, y and z."""
    return csr_array(kron(scalar, eye_array(3), format="csr"))
