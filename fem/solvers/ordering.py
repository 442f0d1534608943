"""Elimination of the unknowns by nested dissection of the graph of their blocks."""

from dataclasses import dataclass

import numpy as np
import pymetis
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from lumped.arrays import IntArray, SparseMatrix

# Measured on 290k blocks: more separators tried and refined cost 9 s of ordering and save 3 to 4 %
# of the factor's memory and 6 % of its flops; on a small graph they are not worth their time.
_LARGE = 100_000
_THOROUGH = {"nseps": 4, "niter": 20}


@dataclass(frozen=True, eq=False)
class Elimination:
    """Order (n) in which unknowns are eliminated: order[i] in place i.

    `halves`: sizes of two parts that come first and are coupled by the rest alone, their
    separator; empty where the matrix is eliminated as a whole.
    """

    order: IntArray
    halves: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class BlockGraph:
    """Blocks of unknowns that stay together, and which of them are coupled.

    `starts`, `sizes` (B): the unknowns of each block; `couplings`: symmetric pattern (csr B×B)
    without its diagonal.
    """

    starts: IntArray
    sizes: IntArray
    couplings: SparseMatrix

    def unknowns(self, blocks: IntArray) -> IntArray:
        """Unknowns of the given blocks, block by block."""
        sizes = self.sizes[blocks]
        first_places = np.cumsum(sizes) - sizes
        return np.repeat(self.starts[blocks] - first_places, sizes) + np.arange(sizes.sum())


def adjacency(graph: SparseMatrix) -> pymetis.CSRAdjacency:
    """A graph (csr, no diagonal) as METIS wants it."""
    return pymetis.CSRAdjacency(graph.indptr.astype(np.int32), graph.indices.astype(np.int32))


def block_graph(matrix: SparseMatrix, leading: tuple[int, ...] = ()) -> BlockGraph:
    """Graph of the blocks of a symmetric matrix (csr n×n), of which one triangle is enough.

    First come blocks of the sizes `leading` (the six motions of each rigid end), then nodes of
    three unknowns. Raises ValueError where the rest does not come in threes.
    """
    nodes, remainder = divmod(matrix.shape[0] - sum(leading), 3)
    if remainder:
        raise ValueError("unknowns after the leading blocks do not come in threes")
    sizes = np.concatenate([np.array(leading, dtype=np.int64), np.full(nodes, 3)])
    starts = np.cumsum(sizes) - sizes
    block_of = np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
    rows = np.repeat(block_of, np.diff(matrix.indptr))
    # Neighbouring entries mostly repeat a pair of blocks: dropping those repeats first keeps the
    # graph small while it is made.
    columns = block_of[matrix.indices]
    new = (rows != columns) & np.concatenate(
        [[True], (rows[1:] != rows[:-1]) | (columns[1:] != columns[:-1])]
    )
    rows, columns = rows[new], columns[new]
    shape = (len(sizes), len(sizes))
    graph = csr_array((np.ones(len(rows), dtype=np.int32), (rows, columns)), shape=shape)
    return BlockGraph(starts, sizes, (graph + graph.T).tocsr())


def nested_dissection(graph: BlockGraph) -> Elimination:
    """Fill-reducing elimination of the unknowns by METIS.

    Ordering the blocks, a ninth as large a graph, is faster than ordering unknowns and no worse.
    """
    blocks = np.arange(len(graph.sizes))
    if graph.couplings.nnz:
        options = pymetis.Options(**(_THOROUGH if len(graph.sizes) > _LARGE else {}))
        found, _ = pymetis.nested_dissection(adjacency(graph.couplings), options=options)
        blocks = np.asarray(found, dtype=np.int64)
    return Elimination(graph.unknowns(blocks))


def bisection(graph: BlockGraph) -> Elimination:
    """Elimination in two halves, each by nested dissection, and then what separates them."""
    left, right, between = separate(graph.couplings)
    orders = []
    for half in map(np.sort, (left, right)):
        couplings = graph.couplings[half][:, half].tocsr()
        own = BlockGraph(graph.starts[half], graph.sizes[half], couplings)
        orders.append(nested_dissection(own).order)
    order = np.concatenate([*orders, graph.unknowns(np.sort(between))])
    return Elimination(order, (len(orders[0]), len(orders[1])))


def separate(couplings: SparseMatrix) -> tuple[IntArray, IntArray, IntArray]:
    """Split a graph (csr, no diagonal) into two halves and the blocks between them."""
    _, membership = pymetis.part_graph(2, adjacency=adjacency(couplings))
    side = np.asarray(membership)
    left, right = np.flatnonzero(side == 0), np.flatnonzero(side == 1)
    left_cut, right_cut = _vertex_cover(couplings[left][:, right].tocsr())
    between = np.concatenate([left[left_cut], right[right_cut]])
    return left[~left_cut], right[~right_cut], between


def _vertex_cover(edges: SparseMatrix) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Smallest set of rows and columns that touches every entry of a pattern (König's theorem)."""
    partner = maximum_bipartite_matching(edges, perm_type="column")
    matched = np.flatnonzero(partner >= 0)
    row_reached = partner < 0
    transposed = edges.T.tocsr()
    while True:
        column_reached = (transposed @ row_reached.astype(np.int32)) > 0
        grown = row_reached.copy()
        grown[matched] |= column_reached[partner[matched]]
        if (grown == row_reached).all():
            return ~row_reached, column_reached
        row_reached = grown
