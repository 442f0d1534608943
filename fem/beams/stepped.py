"""A leg of prismatic pieces along the centre line of a part, each with the part's section there.

The pieces begin and end where the part leaves what is held at its interfaces; what lies before and
behind is rigid, with the mass that it has. Sections are taken in the middle of the pieces: second
order in 1/k.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_array, eye_array, lil_array, vstack

from lumped.arrays import Array, SparseMatrix
from lumped.legs import BeamProperties
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import shift, turn


@dataclass(frozen=True, eq=False)
class Piece:
    """A prism from `start` to `end` (3, m, leg axes), where the centroids of its end sections are.

    `properties` in its own `axes` (3×3, columns), the first along it.
    """

    start: Array
    end: Array
    axes: Array
    properties: BeamProperties

    @property
    def length(self) -> float:
        """From start to end (m)."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True, eq=False)
class SteppedLeg:
    """Pieces from root to tip, which are `length` (m) apart along x.

    `root_mass`, `tip_mass` (6×6, SI, leg axes, at root and tip): of what is rigid there.
    """

    length: float
    pieces: tuple[Piece, ...]
    root_mass: Array
    tip_mass: Array


def stepped_leg(leg: SteppedLeg, build: Callable[[Piece], LegMatrices]) -> LegMatrices:
    """The pieces, each as `build` makes it in its own axes, on (root 6, tip 6, inner) unknowns."""
    made = [build(piece) for piece in leg.pieces]
    count = len(made)
    inner = [one.size - 12 for one in made]
    nodes = 12 + 6 * (count - 1)
    size = nodes + sum(inner)
    maps, begun = [], nodes
    for k, (piece, one) in enumerate(zip(leg.pieces, made, strict=True)):
        back = turn(piece.axes).T
        rows = lil_array((one.size, size))
        for end, (node, place) in enumerate(((k, piece.start), (k + 1, piece.end))):
            first, origin = _node(node, count, leg.length)
            arm = np.eye(6) if origin is None else shift(place - origin)
            rows[6 * end : 6 * end + 6, first : first + 6] = back @ arm
        rows[12:, begun : begun + inner[k]] = eye_array(inner[k])
        begun += inner[k]
        maps.append(csr_array(rows))
    stiffness = sum(m.T @ csr_array(one.stiffness) @ m for m, one in zip(maps, made, strict=True))
    mass = sum(m.T @ csr_array(one.mass) @ m for m, one in zip(maps, made, strict=True))
    ends = block_diag([leg.root_mass, leg.tip_mass, csr_array((size - 12, size - 12))])

    def centreline(stations: Array) -> SparseMatrix:
        return _twists(leg, made, maps, np.atleast_1d(np.asarray(stations, dtype=float)))

    return LegMatrices(
        model=f"{made[0].model}, stepped",
        length=leg.length,
        stiffness=csr_array(stiffness),
        mass=csr_array(mass + ends),
        centreline=centreline,
    )


def _node(node: int, count: int, length: float) -> tuple[int, Array | None]:
    """First unknown of a node, and where its twist is referred to if not to the node itself."""
    if node == 0:
        return 0, np.zeros(3)
    if node == count:
        return 6, np.array([length, 0.0, 0.0])
    return 12 + 6 * (node - 1), None


def _twists(
    leg: SteppedLeg, made: Sequence[LegMatrices], maps: Sequence[SparseMatrix], stations: Array
) -> SparseMatrix:
    """Twists (6m×n) at stations of the straight line from root to tip, sections moving with it."""
    size = maps[0].shape[1]
    starts = np.array([piece.start[0] for piece in leg.pieces])
    rows = []
    for station in stations:
        k = max(int(np.searchsorted(starts, station, side="right")) - 1, 0)
        piece = leg.pieces[k]
        along = piece.end[0] - piece.start[0]
        share = (station - piece.start[0]) / along if along else 0.0
        place = np.array([station, 0.0, 0.0])
        if share < 0.0 or share > 1.0:
            first, origin = (0, np.zeros(3)) if share < 0.0 else (6, np.array([leg.length, 0, 0]))
            rigid = lil_array((6, size))
            rigid[:, first : first + 6] = shift(place - origin)
            rows.append(csr_array(rigid))
            continue
        on_line = piece.start + share * (piece.end - piece.start)
        local = made[k].centreline(np.array([share * piece.length])) @ maps[k]
        rows.append(csr_array(csr_array(shift(place - on_line) @ turn(piece.axes)) @ local))
    return csr_array(vstack(rows, format="csr"))
