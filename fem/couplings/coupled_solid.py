"""A free solid with its interfaces as unknowns, for any combination of couplings.

The unknowns x are those of each rigid or pinned interface (`fem.couplings.grips`), followed by
three displacements of each node that does not belong to a rigid interface. Nodal displacements are
u = T x, and K̂ = TᵀKT, M̂ = TᵀMT. The displacements of the nodes of a pin are in radial, tangential
and axial directions. The radial one is determined by the unknowns of the interface. It nevertheless
remains among the unknowns x, so that each node has a block of three: it has a stiffness of its own,
is not coupled to other unknowns, and does not affect u.

The twist of an interface is qᵢ = Bᵢᵀx for all couplings, with BᵢᵀR̂ = I for the rigid motions R̂
about its point. The loads Bᵢ are therefore work-conjugate and have exact resultants.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, hstack

from fem.couplings.grips import OWN, Grip, area_weights, rigid_motions, unknowns
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.screws import shift


@dataclass(frozen=True, eq=False)
class CoupledSolid:
    """A free solid with m interfaces, on n unknowns x. SI, body axes.

    `stiffness` and `mass` are csr n×n. The nodal displacements are u (3N) = `transformation` x.
    `twists` (n×6m) contains the matrices Bᵢ, so that Bᵢᵀx is the twist of interface i. `motions`
    (n×6) are the unknowns x in rigid motions about the point of the first interface. `points` (m×3,
    in m) are the reference points of the interfaces. The last unknowns are the displacements of N'
    nodes, three each, and `places` (N'×3, in m) are the positions of these nodes.
    """

    stiffness: SparseMatrix
    mass: SparseMatrix
    transformation: SparseMatrix
    twists: Array
    motions: Array
    points: Array
    places: Array

    @property
    def size(self) -> int:
        """Number n of unknowns of the solid."""
        return int(self.stiffness.shape[0])


def coupled_solid(
    stiffness: SparseMatrix, mass: SparseMatrix, nodes: Array, grips: Sequence[Grip]
) -> CoupledSolid:
    """Couple the matrices (csr 3N×3N) of a solid on `nodes` (N×3, in m) to its interfaces.

    `grips` are the faces and couplings of the interfaces. No two of them may have nodes in common.
    """
    numbering = _Numbering(nodes, grips)
    motions = numbering.motions()
    twists = [numbering.twist(k, motions) for k in range(len(grips))]
    return CoupledSolid(
        stiffness=numbering.reduced(stiffness, held=_mean_diagonal(stiffness)),
        mass=numbering.reduced(mass, held=0.0),
        transformation=numbering.transformation(),
        twists=np.hstack(twists),
        motions=motions,
        points=np.array([grip.point for grip in grips]),
        places=nodes[numbering.kept],
    )


def _mean_diagonal(matrix: SparseMatrix) -> float:
    return float(matrix.diagonal().mean())


def _bordered(
    solid_matrix: SparseMatrix, coupling: SparseMatrix, block: SparseMatrix
) -> SparseMatrix:
    """Symmetric matrix [`solid_matrix` `coupling`ᵀ; `coupling` `block`] (csr), from sparse blocks.

    The columns of the blocks must be sorted. The large `block` is copied once; `hstack` and
    `vstack` would copy it twice.
    """
    first = hstack([solid_matrix, csr_array(coupling.T)], format="csr")
    added = np.concatenate(
        [
            np.zeros(first.nnz, dtype=block.indptr.dtype),
            np.repeat(block.indptr[:-1], np.diff(coupling.indptr)),
        ]
    )
    shift, size = solid_matrix.shape[0], solid_matrix.shape[0] + block.shape[0]
    columns = np.concatenate([first.indices, coupling.indices])
    data = np.concatenate([first.data, coupling.data])
    pointers = np.concatenate([first.indptr, first.nnz + coupling.indptr[1:] + block.indptr[1:]])
    return csr_array(
        (
            np.insert(block.data, added, data),
            np.insert(block.indices + block.indices.dtype.type(shift), added, columns),
            pointers.astype(block.indptr.dtype),
        ),
        shape=(size, size),
    )


class _Numbering:
    """Numbering of the unknowns x of a coupled solid, and the matrix from x to displacements."""

    def __init__(self, nodes: Array, grips: Sequence[Grip]) -> None:
        self.nodes, self.grips = nodes, grips
        self.first = np.cumsum([0, *(OWN[grip.kind] for grip in grips)])
        is_kept = np.ones(len(nodes), dtype=bool)
        self.is_free = np.ones(3 * len(nodes), dtype=bool)
        for grip in grips:
            if grip.kind == "rigid":
                is_kept[grip.nodes] = False
                self.is_free[unknowns(grip.nodes)] = False
            elif grip.kind == "pin":
                self.is_free[3 * grip.nodes] = False
        self.kept: IntArray = np.flatnonzero(is_kept)
        self.inner = unknowns(self.kept).astype(np.int32)
        self.place = np.full(len(nodes), -1)
        self.place[self.kept] = np.arange(len(self.kept))
        self.turned = self._turned()
        self.dependent = self._dependent()

    @property
    def own(self) -> int:
        """Number of unknowns of the interfaces, which precede those of the nodes."""
        return int(self.first[-1])

    def _turned(self) -> SparseMatrix | None:
        """Rotation Q (csr 3N×3N) of nodal displacements from the local axes of pins to body axes.

        None if no interface is a pin.
        """
        pins = [grip for grip in self.grips if grip.kind == "pin"]
        if not pins:
            return None
        blocks = np.broadcast_to(np.eye(3), (len(self.nodes), 3, 3)).copy()
        for grip in pins:
            blocks[grip.nodes] = grip.local_axes(self.nodes)
        rows = 3 * np.arange(len(self.nodes))[:, None, None] + np.arange(3)[:, None]
        columns = 3 * np.arange(len(self.nodes))[:, None, None] + np.arange(3)
        rows, columns = np.broadcast_arrays(rows, columns)
        places = (rows.ravel(), columns.ravel())
        return csr_array((blocks.ravel(), places), shape=(3 * len(self.nodes),) * 2)

    def _dependent(self) -> SparseMatrix:
        """Matrix E (csc 3N×own) from the interfaces' unknowns to the displacements they determine.

        The displacements of nodes of a pin are in its local axes.
        """
        rows, columns, entries = [], [], []
        for grip, first in zip(self.grips, self.first, strict=False):
            if not OWN[grip.kind]:
                continue
            motion, rows_of_grip = grip.motions(self.nodes), unknowns(grip.nodes)
            if grip.kind == "pin":
                motion, rows_of_grip = grip.radial_motions(self.nodes), 3 * grip.nodes
            row, column = np.nonzero(motion)
            rows.append(rows_of_grip[row])
            columns.append(first + column)
            entries.append(motion[row, column])
        shape = (3 * len(self.nodes), self.own)
        if not rows:
            return csc_array(shape)
        # 32-bit indices, because scipy otherwise converts the matrices with which E is multiplied.
        places = (
            np.concatenate(rows).astype(np.int32),
            np.concatenate(columns).astype(np.int32),
        )
        return csc_array((np.concatenate(entries), places), shape=shape)

    def reduced(self, matrix: SparseMatrix, held: float) -> SparseMatrix:
        """Symmetric `matrix` (csr 3N×3N) of the nodes, transformed to the n unknowns of the solid.

        The radial displacements of the nodes of pins, which depend on other unknowns, remain
        unknowns. `held` is their diagonal entry.
        """
        if self.turned is not None:
            matrix = csr_array(self.turned.T @ matrix @ self.turned)
        if not self.own:
            return matrix
        if not matrix.has_sorted_indices:
            matrix = matrix.sorted_indices()
        product = csr_array(matrix @ self.dependent)
        interface_block = csr_array(self.dependent.T @ product)
        coupling, block = product[self.inner], self._block_of_nodes(matrix)
        free = self.is_free[self.inner].astype(float)
        if not free.all():
            mask = diags_array(free, format="csr")
            coupling = csr_array(mask @ coupling)
            block = csr_array(mask @ block @ mask + diags_array(held * (1.0 - free), format="csr"))
            block = csr_array((block + block.T) / 2.0)
        interface_block = csr_array((interface_block + interface_block.T) / 2.0)
        interface_block.sort_indices()
        coupling.sort_indices()
        return _bordered(interface_block, coupling, block)

    def _block_of_nodes(self, matrix: SparseMatrix) -> SparseMatrix:
        """Rows and columns of `matrix` for nodes that belong to no rigid interface (csr, sorted).

        The result equals `matrix[inner][:, inner]`. Only few columns are removed, in one pass.
        """
        rows = matrix[self.inner]
        new_columns = np.full(matrix.shape[1], -1, dtype=rows.indices.dtype)
        new_columns[self.inner] = np.arange(len(self.inner))
        columns, data, pointers = new_columns[rows.indices], rows.data, rows.indptr
        left_out = np.flatnonzero(columns < 0)
        if left_out.size:
            columns, data = np.delete(columns, left_out), np.delete(data, left_out)
            pointers = pointers - np.searchsorted(left_out, pointers).astype(pointers.dtype)
        return csr_array((data, columns, pointers), shape=(len(self.inner),) * 2)

    def transformation(self) -> SparseMatrix:
        """Matrix T (csr 3N×n) from the unknowns x to the nodal displacements u."""
        free = self.is_free[self.inner]
        columns = np.flatnonzero(free)
        shape = (3 * len(self.nodes), len(self.inner))
        selection = csc_array((np.ones(len(columns)), (self.inner[free], columns)), shape=shape)
        T = csr_array(hstack([self.dependent, selection], format="csr"))
        return T if self.turned is None else csr_array(self.turned @ T)

    def motions(self) -> Array:
        """Rigid motions R̂ (n×6) about the point of the first interface."""
        origin = self.grips[0].point
        interface_motions = [grip.own @ shift(grip.point - origin) for grip in self.grips]
        fields = rigid_motions(self.nodes, origin)
        if self.turned is not None:
            fields = self.turned.T @ fields
        inner = fields[self.inner] * self.is_free[self.inner][:, None]
        return np.vstack([*interface_motions, inner])

    def twist(self, index: int, motions: Array) -> Array:
        """Loads (n×6) on the unknowns x that are unit wrenches at interface number `index`.

        Their transpose maps x to the twist of the interface. `motions` (n×6) are the rigid motions
        R̂.
        """
        grip = self.grips[index]
        rows = np.zeros((6, self.own + len(self.inner)))
        own_columns = slice(int(self.first[index]), int(self.first[index + 1]))
        rows[: OWN[grip.kind], own_columns] = np.eye(OWN[grip.kind])
        if grip.kind != "rigid":
            node_rows = self.own + unknowns(self.place[grip.nodes]).reshape(-1, 3)
            if grip.kind == "pin":
                # Mean displacements along the axis and about it. The radii of all nodes are equal.
                shares = area_weights(self.nodes, grip.facets).sum(axis=0)
                rows[4, node_rows[:, 2]] = rows[5, node_rows[:, 1]] = shares / shares.sum()
            else:
                rows[:, node_rows.ravel()] = grip.loads(self.nodes).T
        about = motions @ shift(self.grips[0].point - grip.point)
        return np.asarray(np.linalg.solve(rows @ about, rows).T)
