"""Saint-Venant's torsion and flexure of a prism, by finite elements on its section.

A prism along x has only the stresses σxx, τxy and τxz; its section contracts freely. With s = (y,
z) from the centroid, Σ = ∫ s sᵀ dA and c = Σ⁻¹F for a transverse force F at the tip (x = L):

    σxx = −(L − x) c·s        div τ = −c·s in the section,  τ·n = 0 on its boundary
    torsion   τ = Gθ′ (∇ω + (−z, y))
    flexure   τ = ∇Ψ − (νG/E) (c₁ (½(y² − z²), yz) + c₂ (yz, ½(z² − y²)))

The term with ν is the anticlastic bending that increases along x. For a material with cubic
symmetry along the axes of the leg the equations are the same: only the ratio νG/E occurs, which is
ν/2(1+ν) for an isotropic material (Timoshenko & Goodier, Theory of Elasticity, §§104–118; Love, ch.
XV, for the flexure functions).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from lumped.text import counted
from meshes.elements import ELEMENTS
from meshes.section.section_mesh import SectionMesh, require_one_material
from meshes.shape_functions import gradients, quadrature, values


@dataclass(frozen=True, eq=False)
class SectionQuadrature:
    """Quadrature points of a section mesh: N nodes, M cells, Q points and k nodes per cell.

    `shapes` (k×Q) are shape functions, `gradients` (M×k×2×Q, in 1/m) their gradients, `weights`
    (M×Q, in m²) sum up to the area. `points` (2×M×Q, in m) are y and z relative to the `centroid`
    (2, in m) of the section.
    """

    mesh: SectionMesh
    shapes: Array
    gradients: Array
    weights: Array
    points: Array
    centroid: Array

    def integral(self, field: Array) -> Array:
        """Integral (…) over the section of a `field` at the quadrature points (…×M×Q)."""
        return np.asarray((field * self.weights).sum(axis=(-2, -1)))

    def load(self, density: Array) -> Array:
        """Consistent nodal values ∫ N_i f dA (N values) of a density f (M×Q)."""
        return self._gather(np.einsum("kq,mq->mk", self.shapes, density * self.weights))

    def gradient_load(self, field: Array) -> Array:
        """Nodal values ∫ ∇N_i·g dA (N values) of a vector field g (2×M×Q)."""
        return self._gather(
            np.einsum("mkdq,dmq->mk", self.gradients, field * self.weights, optimize=True)
        )

    def value(self, nodal: Array) -> Array:
        """Values (M×Q) at the quadrature points, interpolated from the nodal values `nodal` (N)."""
        return np.asarray(nodal[self.mesh.cells] @ self.shapes)

    def gradient(self, nodal: Array) -> Array:
        """Gradient (2×M×Q) at the quadrature points, from the nodal values `nodal` (N)."""
        by_cell = nodal[self.mesh.cells]
        return np.asarray(np.einsum("mkdq,mk->dmq", self.gradients, by_cell, optimize=True))

    def _gather(self, by_cell: Array) -> Array:
        nodal = np.zeros(len(self.mesh.nodes))
        np.add.at(nodal, self.mesh.cells, by_cell)
        return nodal


def section_quadrature(mesh: SectionMesh) -> SectionQuadrature:
    """Quadrature points of a section mesh. Raises ComputationError for inverted cells."""
    # Exact for squared flexure stresses and warping on straight-sided cells. It is the rule used
    # for solids (`fem.elasticity`): on curved cells of a thin tube, another rule would differ by
    # 1e-5.
    degree = 2 * ELEMENTS[mesh.element].order + 1
    reference, weights = quadrature(mesh.element, degree)
    shapes = values(mesh.element, reference)
    corners = mesh.nodes[mesh.cells]
    local = gradients(mesh.element, reference)
    jacobian = np.einsum("mki,kjq->mqij", corners, local, optimize=True)
    area = np.linalg.det(jacobian)
    if wrong := int(np.any(~(area > 0.0), axis=1).sum()):
        raise ComputationError(
            f"section mesh: {counted(wrong, 'cell is', 'cells are')} turned inside out or flat; "
            "the section's walls are too thin for the mesh, or the nodes of its elements are in a "
            "wrong order"
        )
    dA = area * weights
    at_points = np.einsum("mki,kq->imq", corners, shapes)
    centroid = (at_points * dA).sum(axis=(1, 2)) / dA.sum()
    return SectionQuadrature(
        mesh=mesh,
        shapes=shapes,
        gradients=np.einsum("kjq,mqji->mkiq", local, np.linalg.inv(jacobian), optimize=True),
        weights=dA,
        points=at_points - centroid[:, None, None],
        centroid=centroid,
    )


@dataclass(frozen=True, eq=False)
class SaintVenant:
    """Stress fields of a section under unit loads, at the points of `quadrature`.

    `area` is in m², and `moments` (2×2, in m⁴) is Σ = ∫ s sᵀ dA. The fields of torsion are
    `warping` (N, in m²), which is ω for rotation about the centroid, with zero mean, and
    `twist_stress` (2×M×Q, in m), which is τ/Gθ′. `torsion_constant` is Saint-Venant's J (m⁴). The
    fields of flexure have a leading axis for the unit forces Fy and Fz. The rows of `slopes` (2×2,
    in m⁻⁴) are c = Σ⁻¹F. `flexure` (2×N, in m⁻¹) is Ψ. `flexure_stress` (2×2×M×Q, in m⁻²; second
    axis for τxy and τxz) is τ of unit forces through the shear centre, which do no work on twist.
    `flexure_torque` (2, in m) are the moments of these stresses about the centroid. For the forces
    to do no work on twist, multiples of ω were subtracted from Ψ, and the same multiples of τ/Gθ′
    from τ. `twist_shares` (2) are these multiples.
    """

    quadrature: SectionQuadrature
    area: float
    moments: Array
    slopes: Array
    warping: Array
    twist_stress: Array
    torsion_constant: float
    flexure: Array
    flexure_stress: Array
    flexure_torque: Array
    twist_shares: Array

    def torsion_stress(self) -> Array:
        """Shear stress τ (2×M×Q, in m⁻³) due to a unit torque."""
        return self.twist_stress / self.torsion_constant

    def centroid_force_stress(self) -> Array:
        """Shear stress τ (2×2×M×Q, in m⁻²) due to unit forces Fy and Fz through the centroid."""
        return self.flexure_stress - np.multiply.outer(self.flexure_torque, self.torsion_stress())


def saint_venant(mesh: SectionMesh, poisson_shear_ratio: float) -> SaintVenant:
    """Torsion and flexure of a section, for the ratio νG/E = `poisson_shear_ratio`.

    Raises ComputationError if the section is not connected.
    """
    require_one_material(mesh)
    quad = section_quadrature(mesh)
    y, z = quad.points
    area = float(quad.weights.sum())
    moments = np.array([[quad.integral(a * b) for b in (y, z)] for a in (y, z)])
    slopes = np.linalg.inv(moments)

    turning = np.stack([-z, y])
    anticlastic = np.stack(
        [np.stack([(y**2 - z**2) / 2.0, y * z]), np.stack([y * z, (z**2 - y**2) / 2.0])]
    )
    anticlastic = poisson_shear_ratio * np.einsum("fc,cdmq->fdmq", slopes, anticlastic)
    loads = [-quad.gradient_load(turning)]
    for slope, extra in zip(slopes, anticlastic, strict=True):
        loads.append(quad.load(slope[0] * y + slope[1] * z) + quad.gradient_load(extra))
    warping, *flexure = _poisson(quad, np.column_stack(loads)).T

    twist = quad.gradient(warping) + turning
    torsion_constant = float(quad.integral(_torque(quad, twist)))
    potentials, stresses, shares = [], [], []
    for potential, extra in zip(flexure, anticlastic, strict=True):
        stress = quad.gradient(potential) - extra
        share = quad.integral((stress * twist).sum(axis=0)) / torsion_constant
        shares.append(share)
        potentials.append(potential - share * warping)
        stresses.append(stress - share * twist)
    flexure_stress = np.stack(stresses)
    return SaintVenant(
        quadrature=quad,
        area=area,
        moments=moments,
        slopes=slopes,
        warping=warping,
        twist_stress=twist,
        torsion_constant=torsion_constant,
        flexure=np.stack(potentials),
        flexure_stress=flexure_stress,
        flexure_torque=np.array([quad.integral(_torque(quad, s)) for s in flexure_stress]),
        twist_shares=np.array(shares),
    )


def _torque(quad: SectionQuadrature, stress: Array) -> Array:
    """Moment density y τxz − z τxy (M×Q) about the centroid."""
    y, z = quad.points
    return np.asarray(y * stress[1] - z * stress[0])


def _poisson(quad: SectionQuadrature, loads: Array) -> Array:
    """Solutions v (N×m) of Poisson's equation, ∫∇N_i·∇v dA = load_i, with zero mean.

    `loads` (N×m) must be in equilibrium: the sum of each column is zero.
    """
    cells = quad.mesh.cells
    blocks = np.einsum(
        "mkdq,mldq,mq->mkl", quad.gradients, quad.gradients, quad.weights, optimize=True
    )
    laplacian = summed(blocks, cells, len(quad.mesh.nodes))
    if (
        scipy.sparse.csgraph.connected_components(laplacian, directed=False, return_labels=False)
        > 1
    ):
        raise ComputationError(
            "section mesh: no warping function, the section is not in one piece or has nodes "
            "without a cell"
        )
    solution = solved_with(laplacian, loads, fixed_rows=[0])
    mean = quad.load(np.ones_like(quad.weights)) @ solution / quad.weights.sum()
    return np.asarray(solution - mean)


def summed(blocks: Array, unknowns: IntArray, size: int) -> csc_matrix:
    """Sparse matrix (`size` × `size`) that is the sum of the matrices of M cells.

    `blocks` (M×k×k) are these matrices, which are symmetric. `unknowns` (M×k) are the indices of
    their rows and columns.
    """
    width = unknowns.shape[1]
    rows = np.repeat(unknowns, width, axis=1).ravel()
    columns = np.tile(unknowns, width).ravel()
    return csc_matrix(coo_matrix((blocks.ravel(), (rows, columns)), shape=(size, size)))


def solved_with(matrix: csc_matrix, loads: Array, fixed_rows: Sequence[int]) -> Array:
    """Solutions (n×m) for `loads` (n×m) with the unknowns `fixed_rows` kept at zero.

    SuperLU is used. It is fast enough, because the problem is two-dimensional with a few thousand
    unknowns.
    """
    free = np.setdiff1d(np.arange(len(loads)), fixed_rows)
    free_block = csc_matrix(matrix[free][:, free])
    factor = splu(free_block, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    solution = np.zeros(loads.shape)
    solution[free] = factor.solve(np.ascontiguousarray(loads[free]))
    return solution
