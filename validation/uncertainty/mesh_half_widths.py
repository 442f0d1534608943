"""Discretisation half-width of a number from its changes between successive meshes.

Input: magnitudes of the changes between two or three meshes, and a `MeshPolicy` with the ratio r of
element sizes, the possible orders p and a safety factor s. Output: the half-width on one of the
meshes, usually the finest. Rule: s max(Δ, Δ₋₁/rᵖ)/|rᵖ − 1| plus round-off. Without s, this is the
error on that mesh if errors fall by rᵖ from mesh to mesh. Δ is the last change and Δ₋₁ the change
before. Δ may be small by chance; therefore the value Δ₋₁/rᵖ that order p predicts is used if it is
larger (Roache, J. Fluids Eng. 116 (1994) 405).
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
    """Rule that converts changes between geometrically similar meshes into a half-width.

    `ratio`: element size of the other mesh over that of the mesh whose half-width is needed: above
    one if the other mesh is coarser, below one if it is finer, 0 if it is infinitely fine.
    `orders`: lowest and highest order of convergence. With two meshes the lowest is used. With
    three meshes the order is observed, from the earlier changes and the last changes, each summed
    over all numbers, and limited to this range. `safety`: factor on the estimated error.
    `round_off`: half-width that is added to the result.
    """

    ratio: float
    orders: tuple[float, float]
    safety: float = UNPROVEN
    round_off: float = 0.0

    @classmethod
    def of_order(cls, ratio: float, order: float, safety: float = UNPROVEN) -> "MeshPolicy":
        """Policy for two meshes with a known order of convergence. Arguments as in `MeshPolicy`."""
        return cls(ratio, (order, order), safety)

    @classmethod
    def to_limit(cls, safety: float = UNPROVEN) -> "MeshPolicy":
        """Policy for changes to the limit (exact or extrapolated), which equal the errors."""
        return cls(0.0, (1.0, 1.0), safety)

    def order(self, before: float, after: float) -> float:
        """Order of convergence observed from two successive changes, `before` and `after`.

        Each is a sum of magnitudes over all numbers.
        """
        lowest, highest = self.orders
        if before > after > 0.0:
            return float(np.clip(np.log(before / after) / np.log(self.ratio), lowest, highest))
        return highest if after == 0.0 else lowest


def mesh_half_widths(changes: Sequence[Array], policy: MeshPolicy) -> Array:
    """Half-widths on a mesh, from the magnitudes of `changes` between successive meshes.

    There are one or two changes, of the same, arbitrary shape; the last one is the change to this
    mesh, or from it if the policy's ratio is below one. The result has the shape and unit of a
    change. NaN stays NaN.
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
    """Relative half-widths of a solution on one of several meshes, given by their `levels`.

    `solve` returns the solution on the mesh of a level. `change` returns the magnitude of the
    difference of two solutions, relative to its third argument, the solution on the last mesh. The
    half-widths are those on the last mesh, or on the one before if the policy's ratio is below one.
    If `policy` is a number, it is the half-width itself, and nothing is solved.
    """
    if not isinstance(policy, MeshPolicy):
        return np.asarray(policy)
    solutions = [solve(level) for level in levels]
    changes = [change(coarse, fine, solutions[-1]) for coarse, fine in pairwise(solutions)]
    return mesh_half_widths(changes, policy)
