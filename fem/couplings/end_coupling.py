"""How a solid leg is held and loaded: rigid end faces, or ends free to warp and to contract.

Both couplings are congruences of the solid's own matrices, so energy is conserved, rotations
included. Reference points are (0, 0, 0) at the root and (L, 0, 0) at the tip.

rigid  u = T q: the nodes of a face move with its twist. K̂ = TᵀKT, M̂ = TᵀMT, f̂ = Tᵀf.
free   the face carries the tractions of Saint-Venant's solution; its twist is the work conjugate
       q = Bᵀu of these, with BᵀR = I for the rigid motions R, and the root is held by
       B_rootᵀu = 0: no restraint on warping or on Poisson's contraction.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_array, csr_array, diags_array, hstack, vstack
from scipy.sparse.linalg import LinearOperator

from fem.sections.saint_venant import saint_venant
from fem.sections.section_constants import poisson_shear_ratio
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.solid_mesh import EndFace, SolidMesh


def unknowns(nodes: IntArray) -> IntArray:
    """Unknowns 3·node + component (3n) of `nodes` (n), node by node."""
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()


def rigid_motions(points: Array, reference: Array) -> Array:
    """Displacements (3n×6) of `points` (n×3, m) for unit twists at `reference` (3, m)."""
    x, y, z = (np.asarray(points) - reference).T
    motions = np.zeros((len(points), 3, 6))
    motions[:, :, :3] = np.eye(3)
    motions[:, 0, 4], motions[:, 0, 5] = z, -y
    motions[:, 1, 3], motions[:, 1, 5] = -z, x
    motions[:, 2, 3], motions[:, 2, 4] = y, -x
    return motions.reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class RigidEnds:
    """Both end faces rigid; unknowns q = (root twist 6, tip twist 6, interior nodes 3 each).

    `root`, `tip`, `interior` are node numbers of the solid; `root_motion` (3n×6), `tip_motion` the
    displacements of the faces' nodes for unit twists at their reference points.
    """

    root: IntArray
    tip: IntArray
    interior: IntArray
    root_motion: Array
    tip_motion: Array

    # Sizes of the blocks of unknowns of the held leg before its nodes of three.
    leading_blocks: ClassVar[tuple[int, ...]] = (6,)

    @property
    def size(self) -> int:
        """Number of unknowns q."""
        return 12 + 3 * len(self.interior)

    @cached_property
    def transformation(self) -> SparseMatrix:
        """T (csr, 3N × size) with u = T q."""
        columns = [self._ends_transformation(), self._interior_transformation()]
        return csr_array(hstack(columns, format="csr"))

    def reduced(self, matrix: SparseMatrix) -> SparseMatrix:
        """TᵀAT (csr, size × size) of a symmetric solid matrix A (csr, 3N × 3N)."""
        return self._reduced(matrix, self._ends_transformation())

    def clamped_stiffness(self, stiffness: SparseMatrix) -> SparseMatrix:
        """TᵀKT with the root held: unknowns (tip twist 6, interior), csr."""
        return self._reduced(stiffness, self._ends_transformation()[:, 6:])

    def clamped_mass(self, mass: SparseMatrix) -> SparseMatrix:
        """TᵀMT with the root held: unknowns (tip twist 6, interior), csr."""
        return self._reduced(mass, self._ends_transformation()[:, 6:])

    def expanded(self, clamped_unknowns: Array) -> Array:
        """Displacements u (3N×m) of a leg whose root is held, from its unknowns (n×m)."""
        return np.asarray(self.transformation[:, 6:] @ clamped_unknowns)

    def tip_loads(self) -> Array:
        """Unit wrenches at the tip on the unknowns (tip twist, interior) of the held leg (n×6)."""
        return np.eye(self.size - 6, 6)

    def _reduced(self, matrix: SparseMatrix, ends: SparseMatrix) -> SparseMatrix:
        # Only the few columns of the ends are multiplied; the interior, nearly all of the matrix,
        # is copied once.
        inner = unknowns(self.interior).astype(matrix.indices.dtype)
        product = csr_array(matrix @ ends)
        own = ends.T @ product
        coupling = product[inner]
        coupling.sort_indices()
        # Stacked in two steps, each of which scipy does without sorting the entries anew.
        upper = hstack([csr_array((own + own.T) / 2.0), csr_array(coupling.T)], format="csr")
        lower = hstack([coupling, matrix[inner][:, inner]], format="csr")
        return csr_array(vstack([upper, lower], format="csr"))

    def _ends_transformation(self) -> SparseMatrix:
        size = 3 * (len(self.root) + len(self.tip) + len(self.interior))
        rows = np.concatenate([unknowns(self.root), unknowns(self.tip)])
        motion = np.zeros((len(rows), 12))
        motion[: len(self.root_motion), :6] = self.root_motion
        motion[len(self.root_motion) :, 6:] = self.tip_motion
        row, column = np.nonzero(motion)
        # Indices as narrow as the matrices': scipy widens what they are multiplied with.
        places = rows[row].astype(np.int32), column.astype(np.int32)
        return csc_array((motion[row, column], places), shape=(size, 12))

    def _interior_transformation(self) -> SparseMatrix:
        inner = unknowns(self.interior)
        size = 3 * (len(self.root) + len(self.tip) + len(self.interior))
        return csc_array(
            (np.ones(len(inner)), (inner, np.arange(len(inner)))), shape=(size, len(inner))
        )


def rigid_ends(mesh: SolidMesh) -> RigidEnds:
    """Rigid end faces of a leg; interior nodes keep their order."""
    is_interior = np.ones(len(mesh.nodes), dtype=bool)
    is_interior[mesh.root.nodes] = is_interior[mesh.tip.nodes] = False
    return RigidEnds(
        root=mesh.root.nodes,
        tip=mesh.tip.nodes,
        interior=np.flatnonzero(is_interior),
        root_motion=rigid_motions(mesh.nodes[mesh.root.nodes], np.zeros(3)),
        tip_motion=rigid_motions(mesh.nodes[mesh.tip.nodes], _tip_point(mesh)),
    )


def saint_venant_loads(face: EndFace, points: Array, reference: Array, material: Material) -> Array:
    """Consistent nodal loads (3n×6) of unit wrenches at `reference` (3, m) on an end face.

    Tractions of Saint-Venant's solution: uniform for Fx, flexural shear for Fy and Fz, torsion's
    shear for Mx, linear σxx for My and Mz. `points` (n×3, m) are the face's nodes, rows of the
    result 3·(place in face.nodes) + component. BᵀR = I to rounding for the rigid motions R.
    """
    ratio = poisson_shear_ratio(material.nu, material.G / material.E)
    section = saint_venant(face.mesh, ratio)
    quad = section.quadrature
    y, z = quad.points
    # σxx = M·(c·s) with the bending moments Mz = −∫y σxx and My = +∫z σxx.
    along_y, along_z = (slope[0] * y + slope[1] * z for slope in section.slopes)
    loads = np.zeros((len(points), 3, 6))
    axial = {0: np.full_like(y, 1.0 / section.area), 4: along_z, 5: -along_y}
    for wrench, traction in axial.items():
        loads[:, 0, wrench] = quad.load(traction)
    force_y, force_z = section.centroid_force_stress()
    for wrench, tractions in {1: force_y, 2: force_z, 3: section.torsion_stress()}.items():
        for component, traction in enumerate(tractions, start=1):
            loads[:, component, wrench] = quad.load(traction)
    at_centroid = loads.reshape(-1, 6)
    # Moves the wrenches from the mesh's own centroid to the reference point.
    work = at_centroid.T @ rigid_motions(points, reference)
    return np.asarray(np.linalg.solve(work, at_centroid.T).T)


@dataclass(frozen=True, eq=False)
class FreeEnds:
    """Ends free to warp and contract; root held by its work-conjugate twist alone.

    `root_loads`, `free_tip_loads` (B, 3N×6) are nodal loads of unit wrenches at the two reference
    points, `motions` (R, 3N×6) the rigid motions about the root's: B_rootᵀR = I. `springs` (3N,
    N/m) hold six statically determinate unknowns: loads in equilibrium leave them without force,
    so they make K positive definite and change nothing. P = I − R B_rootᵀ takes off the motion
    that the root must not have, Pᵀ adds the root's reaction to a load. Unknowns x are those of
    all nodes, and u = P x.
    """

    root_loads: Array
    free_tip_loads: Array
    motions: Array
    springs: Array

    # All unknowns are nodes of three.
    leading_blocks: ClassVar[tuple[int, ...]] = ()

    def clamped_stiffness(self, stiffness: SparseMatrix) -> SparseMatrix:
        """K of the solid (csr 3N×3N) with the springs: positive definite."""
        return csr_array(stiffness + diags_array(self.springs, format="csr"))

    def clamped_mass(self, mass: SparseMatrix) -> LinearOperator:
        """PᵀMP of the solid's mass matrix M (csr 3N×3N).

        With `clamped_stiffness` it has the modes that satisfy B_rootᵀu = 0, and these alone: the
        springs' six have no mass.
        """

        def apply(x: Array) -> Array:
            forces = mass @ self.expanded(x.reshape(len(self.springs), -1))
            return self.equilibrated(forces).reshape(x.shape)

        return LinearOperator(mass.shape, matvec=apply, matmat=apply, dtype=np.float64)

    def expanded(self, x: Array) -> Array:
        """Displacements u = P x (3N×m), which satisfy B_rootᵀu = 0, from the unknowns x (3N×m)."""
        return np.asarray(x - self.motions @ (self.root_loads.T @ x))

    def equilibrated(self, forces: Array) -> Array:
        """Pᵀf (3N×m): forces together with the reaction of the root."""
        return np.asarray(forces - self.root_loads @ (self.motions.T @ forces))

    def tip_loads(self) -> Array:
        """Unit wrenches at the tip together with the root's reaction (3N×6)."""
        return self.equilibrated(self.free_tip_loads)


def free_ends(mesh: SolidMesh, material: Material) -> FreeEnds:
    """Saint-Venant ends of a leg; raises ComputationError where its nodes cannot be held."""
    size = 3 * len(mesh.nodes)
    loads = []
    for face, point in ((mesh.root, np.zeros(3)), (mesh.tip, _tip_point(mesh))):
        full = np.zeros((size, 6))
        full[unknowns(face.nodes)] = saint_venant_loads(
            face, mesh.nodes[face.nodes], point, material
        )
        loads.append(full)
    springs = np.zeros(size)
    # Of the size of a node's own stiffness, so that the matrix is no worse conditioned for them.
    springs[_statically_determinate(mesh)] = material.E * mesh.length / len(mesh.nodes) ** (1 / 3)
    return FreeEnds(
        root_loads=loads[0],
        free_tip_loads=loads[1],
        motions=rigid_motions(mesh.nodes, np.zeros(3)),
        springs=springs,
    )


def _tip_point(mesh: SolidMesh) -> Array:
    return np.array([mesh.length, 0.0, 0.0])


def _statically_determinate(mesh: SolidMesh) -> IntArray:
    """Six unknowns of the end faces that hold every rigid motion, as far apart as can be."""
    held = np.concatenate([mesh.root.nodes, mesh.tip.nodes])
    middle = np.array([mesh.length / 2.0, 0.0, 0.0])
    scaled = rigid_motions((mesh.nodes[held] - middle) / mesh.length, np.zeros(3))
    _, triangle, order = qr(scaled.T, mode="economic", pivoting=True)
    if abs(triangle[5, 5]) <= 1e-9 * abs(triangle[0, 0]):
        raise ComputationError("solid mesh: the nodes of the end faces lie on one line")
    return np.sort(unknowns(held)[order[:6]])
