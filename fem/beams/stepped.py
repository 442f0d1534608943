"""A leg of prismatic pieces along the centre line of a part.

Each piece has the section of the part in its middle, so that the error is of second order in 1/k
for k pieces. The pieces extend between the two interfaces. The regions of the part at the
interfaces are rigid and have their own mass.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_array, eye_array, lil_array, vstack

from lumped.arrays import Array, SparseMatrix
from lumped.beam_properties import BeamProperties
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import shift, turn


@dataclass(frozen=True, eq=False)
class Piece:
    """A prismatic piece of a stepped leg, between the centroids of two sections of the part.

    `start` and `end` (3, in m) are these centroids in leg axes. `axes` (3×3, columns) are the axes
    of the piece, the first of which is along the piece. `properties` are given in these axes.
    """

    start: Array
    end: Array
    axes: Array
    properties: BeamProperties

    @property
    def length(self) -> float:
        """Length (m) of the piece from start to end."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True, eq=False)
class SteppedLeg:
    """Prismatic pieces of a leg from root to tip, with `length` (m) from root to tip along x.

    `root_mass` and `tip_mass` (6×6, SI, leg axes) are the mass matrices of the rigid regions at
    root and tip.
    """

    length: float
    pieces: tuple[Piece, ...]
    root_mass: Array
    tip_mass: Array


def stepped_leg(leg: SteppedLeg, build: Callable[[Piece], LegMatrices]) -> LegMatrices:
    """Stiffness and mass of a leg of prismatic pieces, assembled from those of the pieces.

    `build` is a function that returns the free beam or solid model of a piece. The unknowns are the
    twists of root (6) and tip (6), the twists of the nodes between pieces (6 each), then the
    unknowns inside the pieces.
    """
    models = [build(piece) for piece in leg.pieces]
    count = len(models)
    inner = [model.size - 12 for model in models]
    nodes = 12 + 6 * (count - 1)
    size = nodes + sum(inner)
    maps, inner_start = [], nodes
    for k, (piece, model) in enumerate(zip(leg.pieces, models, strict=True)):
        back = turn(piece.axes).T
        rows = lil_array((model.size, size))
        for end, (node, end_point) in enumerate(((k, piece.start), (k + 1, piece.end))):
            first, origin = _node(node, count, leg.length)
            arm = np.eye(6) if origin is None else shift(end_point - origin)
            rows[6 * end : 6 * end + 6, first : first + 6] = back @ arm
        rows[12:, inner_start : inner_start + inner[k]] = eye_array(inner[k])
        inner_start += inner[k]
        maps.append(csr_array(rows))
    stiffness = sum(
        m.T @ csr_array(model.stiffness) @ m for m, model in zip(maps, models, strict=True)
    )
    mass = sum(m.T @ csr_array(model.mass) @ m for m, model in zip(maps, models, strict=True))
    ends = block_diag([leg.root_mass, leg.tip_mass, csr_array((size - 12, size - 12))])

    def centreline(stations: Array) -> SparseMatrix:
        return _twists(leg, models, maps, np.atleast_1d(np.asarray(stations, dtype=float)))

    return LegMatrices(
        model=f"{models[0].model}, stepped",
        length=leg.length,
        stiffness=csr_array(stiffness),
        mass=csr_array(mass + ends),
        centreline=centreline,
    )


def _node(node: int, count: int, length: float) -> tuple[int, Array | None]:
    """Index of the first unknown of a node, and the point to which the node's twist is referred.

    Nodes are numbered from 0 at the root to `count` at the tip. The twists of the root and of the
    tip are referred to the ends of the straight line of `length` (m). For other nodes the point is
    None: the twist is referred to the node itself.
    """
    if node == 0:
        return 0, np.zeros(3)
    if node == count:
        return 6, np.array([length, 0.0, 0.0])
    return 12 + 6 * (node - 1), None


def _twists(
    leg: SteppedLeg, models: Sequence[LegMatrices], maps: Sequence[SparseMatrix], stations: Array
) -> SparseMatrix:
    """6k × n matrix that maps the n unknowns to the twists at k `stations` of the line.

    `stations` are distances (m) along the straight line from root to tip. Points of the line move
    with the section of the piece in which they lie. `models` are the matrices of the pieces, `maps`
    the matrices from the n unknowns to the unknowns of each piece.
    """
    size = maps[0].shape[1]
    starts = np.array([piece.start[0] for piece in leg.pieces])
    rows = []
    for station in stations:
        k = max(int(np.searchsorted(starts, station, side="right")) - 1, 0)
        piece = leg.pieces[k]
        along = piece.end[0] - piece.start[0]
        share = (station - piece.start[0]) / along if along else 0.0
        point = np.array([station, 0.0, 0.0])
        if share < 0.0 or share > 1.0:
            first, origin = (0, np.zeros(3)) if share < 0.0 else (6, np.array([leg.length, 0, 0]))
            rigid = lil_array((6, size))
            rigid[:, first : first + 6] = shift(point - origin)
            rows.append(csr_array(rigid))
            continue
        on_line = piece.start + share * (piece.end - piece.start)
        local = models[k].centreline(np.array([share * piece.length])) @ maps[k]
        rows.append(csr_array(csr_array(shift(point - on_line) @ turn(piece.axes)) @ local))
    return csr_array(vstack(rows, format="csr"))
