"""Half-width of a number from its changes: by perturbations of one source, or between meshes.

Input: changes by perturbations and a `Combiner`, or magnitudes of changes between meshes
and a `MeshPolicy` with the ratio r of element sizes, the possible orders p and a safety factor s.
Output: the half-width, for meshes on one of them, usually the finest. Rule for meshes: s max(Δ,
Δ₋₁/rᵖ)/|rᵖ − 1| plus round-off. Without s, this is the error on that mesh if errors fall by rᵖ from
mesh to mesh. Δ is the last change and Δ₋₁ the change before. Δ may be small by chance; therefore
the value Δ₋₁/rᵖ that order p predicts is used if it is larger (Roache, J. Fluids Eng. 116 (1994)
405).
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import TypeVar

import numpy as np
import scipy

from lumped.arrays import Array
from lumped.memo import memo

A = TypeVar("A")
R = TypeVar("R")
# Binary logarithm of the number of Sobol' points: with 512, half-widths computed with two random
# seeds differ by 1 to 2 %.
_POWER = 9
_CONFIDENCE = 0.95
# Safety factors of ASME V&V 20: 1.25 if the observed order is near the formal one, otherwise 3.
PROVEN, UNPROVEN = 1.25, 3.0


class Combiner(Enum):
    """Rule that combines the changes of a number due to several perturbations of one source.

    HULL: the largest change, for perturbations that exclude each other. LINEAR_SUM: the sum of all
    magnitudes, an upper bound. ROOT_OF_SQUARES: for independent standard uncertainties.
    PROBABILITY: 95 % quantile of the sum of changes, each multiplied by an independent number
    uniformly distributed between −1 and 1.
    """

    HULL = "hull"
    LINEAR_SUM = "linear sum"
    ROOT_OF_SQUARES = "root of squares"
    PROBABILITY = "probability"


def combined(changes: Array, size: Callable[[Array], Array], combiner: Combiner) -> Array:
    """Half-width of a number from its `changes` (R×…) due to each of R perturbations.

    `size` maps n changes (n×…) to their magnitudes (n×…, of another shape if changes are vectors).
    """
    if combiner is Combiner.PROBABILITY:
        sums = np.tensordot(_uniform(len(changes)), changes, axes=1)
        return np.asarray(np.quantile(size(sums), _CONFIDENCE, axis=0))
    sizes = size(changes)
    if combiner is Combiner.HULL:
        return np.asarray(sizes.max(axis=0))
    if combiner is Combiner.LINEAR_SUM:
        return np.asarray(sizes.sum(axis=0))
    return np.asarray(np.sqrt(np.square(sizes).sum(axis=0)))


def half_widths_by(
    nominal: R,
    perturbed: Iterable[tuple[float, R]],
    numbers: Callable[[R], Array],
    size: Callable[[Array], Array],
    combiner: Combiner,
) -> Array:
    """Half-widths (…) of the results `numbers` (…) of a model due to perturbed inputs.

    `numbers` is a function of the inputs. `nominal`: inputs without a perturbation. `perturbed`:
    pairs of a factor and inputs with one perturbation. The factor multiplies the change of the
    numbers that the perturbation causes. `size` is that of `combined`.
    """
    unperturbed = numbers(nominal)
    changes = [factor * (numbers(inputs) - unperturbed) for factor, inputs in perturbed]
    return combined(np.array(changes), size, combiner)


def relative_sizes(changes: Array, values: Array) -> Array:
    """Magnitudes of changes (…×n) relative to the values (n). 0 if a value is zero."""
    shares = np.zeros_like(changes)
    return np.divide(np.abs(changes), np.abs(values), out=shares, where=values != 0.0)


@memo(8)
def _uniform(count: int) -> Array:
    """Samples (n×count) uniformly distributed between −1 and 1, from a Sobol' sequence."""
    points = scipy.stats.qmc.Sobol(count, seed=0).random_base2(_POWER)
    return np.asarray(2.0 * points - 1.0)


@dataclass(frozen=True)
class MeshPolicy:
    """Rule that converts changes between geometrically similar meshes into a half-width.

    `ratio`: element size of the other mesh over that of the mesh whose half-width is needed: above
    one if the other mesh is coarser, below one if it is finer, 0 if it is infinitely fine.
    `orders`: lowest and highest order of convergence. With two meshes the lowest is used. With
    three meshes a common order of all numbers is observed (`order`), limited to this range.
    `safety`: factor on the estimated error. `round_off`: half-width that is added to the result.
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

    def order(self, before: Array, last: Array) -> float:
        """Order of convergence observed from two successive changes of the same numbers.

        It is the lower one of two orders. One is that of the sums of changes, which depends on the
        numbers that change most. The other is that of changes relative to the larger one of the two
        changes of each number, so that all numbers count alike. NaN does not count.
        """
        largest = np.maximum(np.maximum(before, last), self.round_off)
        weights = np.divide(1.0, largest, out=np.zeros_like(largest), where=largest > 0.0)
        orders = [
            self._order(float(np.nansum(factor * before)), float(np.nansum(factor * last)))
            for factor in (1.0, weights)
        ]
        return min(orders)

    def _order(self, before: float, after: float) -> float:
        lowest, highest = self.orders
        if before > after > 0.0:
            return float(np.clip(np.log(before / after) / np.log(self.ratio), lowest, highest))
        return highest if after == 0.0 else lowest

    def half_widths(self, last: Array, before: Array | None = None) -> Array:
        """Half-widths on a mesh, from the magnitudes of changes between successive meshes.

        `last` is the change to this mesh, or from it if the policy's ratio is below one. `before`,
        of the same shape, is the change between the two meshes before; None if there are two
        meshes. The result has the shape and unit of a change. NaN stays NaN.
        """
        order = self.orders[0]
        if before is not None:
            order = self.order(before, last)
        reduction = self.ratio**order
        if before is not None:
            last = np.maximum(last, before / reduction)
        return np.asarray(self.safety * last / abs(reduction - 1.0) + self.round_off)

    def half_width(self, change: float) -> float:
        """Half-width of one number from its signed change between two meshes."""
        return float(self.half_widths(np.abs(np.asarray(change))))


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
    *earlier, last = (change(coarse, fine, solutions[-1]) for coarse, fine in pairwise(solutions))
    return policy.half_widths(last, earlier[-1] if earlier else None)
