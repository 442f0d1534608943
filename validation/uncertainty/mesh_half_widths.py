"""Half-widths of numbers due to their mesh, from changes between successive meshes.

One formula for all meshes and element counts, s max(Δ, Δ₋₁/rᵖ)/|rᵖ − 1|: the error of the finest
mesh if errors fall by rᵖ from mesh to mesh, times a safety factor s. Δ is the last change. It
is taken as at least Δ₋₁/rᵖ, the share of the change before, Δ₋₁, that remains with the order p. A
`MeshPolicy` states r, s and which orders are assumed (Roache, J. Fluids Eng. 116 (1994) 405).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from lumped.arrays import Array

A = TypeVar("A")
# Safety factors of ASME V&V 20: 1.25 if the observed order is near the formal one, otherwise 3.
PROVEN, UNPROVEN = 1.25, 3.0


@dataclass(frozen=True)
class MeshPolicy:
    """Rule for half-widths from changes between similar meshes.

    `ratio`: size of the elements of a mesh over that of the next one; below one if the other mesh
    is the finer one, 0 if its elements are infinitely fine. `orders`: lowest and highest order of
    convergence. With two meshes the lowest order is used; with three the order is that of the
    sums of all changes, limited to both. `safety`: factor over the estimated error. `round_off`:
    least relative half-width.
    """

    ratio: float
    orders: tuple[float, float]
    safety: float = UNPROVEN
    round_off: float = 0.0

    @classmethod
    def of_order(cls, ratio: float, order: float, safety: float = UNPROVEN) -> "MeshPolicy":
        """Policy for two meshes and a known order."""
        return cls(ratio, (order, order), safety)

    @classmethod
    def to_limit(cls, safety: float = UNPROVEN) -> "MeshPolicy":
        """Policy for changes from the limit of infinitely fine elements, which equal the error."""
        return cls(0.0, (1.0, 1.0), safety)

    def order(self, before: float, after: float) -> float:
        """Order of convergence by the sums of two successive changes."""
        lowest, highest = self.orders
        if before > after > 0.0:
            return float(np.clip(np.log(before / after) / np.log(self.ratio), lowest, highest))
        return highest if after == 0.0 else lowest


def mesh_half_widths(changes: Sequence[Array], policy: MeshPolicy) -> Array:
    """Half-widths on the finest mesh from sizes of `changes` (any shape each, coarse to fine).

    In the unit of the changes. NaN stays NaN.
    """
    *earlier, last = changes
    order = policy.orders[0]
    if earlier:
        order = policy.order(float(np.nansum(earlier[-1])), float(np.nansum(last)))
    reduction = policy.ratio**order
    for previous in earlier[-1:]:
        last = np.maximum(last, previous / reduction)
    return np.asarray(policy.safety * last / abs(reduction - 1.0) + policy.round_off)


def half_widths_on(
    levels: Sequence[int],
    policy: MeshPolicy | float,
    solve: Callable[[int], A],
    change: Callable[[A, A, A], Array],
) -> Array:
    """Half-widths of answers that `solve` returns on meshes by their level, coarse to fine.

    `change` is the size of the difference of two answers, relative to the finest one. A number as
    `policy` is the half-width itself, known without solving anything.
    """
    if not isinstance(policy, MeshPolicy):
        return np.asarray(policy)
    answers = [solve(level) for level in levels]
    changes = [change(coarse, fine, answers[-1]) for coarse, fine in pairwise(answers)]
    return mesh_half_widths(changes, policy)
