"""Which pairs of nodes share an element: the pattern of a finite element matrix, and its summation.

Only pairs (a, b) with a ≤ b are summed; the other half is mirrored, so that a matrix of symmetric
element matrices comes out symmetric to the last bit.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array

from lumped.arrays import Array, IntArray, SparseMatrix


@dataclass(frozen=True, eq=False)
class NodePairs:
    """Pairs of nodes that share an element, sorted by (row, column), row ≤ column.

    `rows`, `columns` (P); `summation` (P×(E·T)) sums the element pairs, T = k(k+1)/2 per element,
    that fall on one node pair; `upper` (E×k×k bool) picks those T out of an element's k² pairs.
    """

    node_count: int
    rows: IntArray
    columns: IntArray
    summation: SparseMatrix
    upper: NDArray[np.bool_]

    @property
    def diagonal(self) -> IntArray:
        """Positions of the pairs (a, a)."""
        return np.flatnonzero(self.rows == self.columns)


def _stable_order(keys: NDArray[np.integer], bound: int) -> NDArray[np.integer]:
    """Stable sorting permutation of `keys` in [0, bound) by counting, in linear time."""
    count = len(keys)
    pointers = np.arange(count + 1, dtype=np.int32)
    marks = csr_array((np.empty(count, dtype=np.int8), keys, pointers), shape=(count, bound))
    return np.asarray(marks.tocsc().indices)


def node_pairs(cells: IntArray, node_count: int) -> NodePairs:
    """Pairs of nodes of a mesh with connectivity `cells` (E×k)."""
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
    """Symmetric matrix (csr, N·c × N·c) of the `blocks` (P×c×c) on and above the diagonal."""
    count, width = pairs.node_count, blocks.shape[1]
    above = np.flatnonzero(pairs.rows != pairs.columns)
    mirrored = above[_stable_order(pairs.columns[above], count)]
    per_row_below = np.bincount(pairs.columns[above], minlength=count)
    per_row_upper = np.bincount(pairs.rows, minlength=count)
    # Row a lists its mirrored pairs (columns < a) first: columns come out sorted.
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
