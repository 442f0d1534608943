"""Probability of a verdict if inputs of the robot are uncertain, and the inputs that decide it.

Input: `ErrorOfInputs`, made in `validation.adequacy.uncertain_inputs` of the errors of robots with
changed inputs. Output: the probability that the error is within the limit, the probability that it
is beyond the limit, the half-width of the error due to inputs, and the share of each input. Rule: a
verdict less probable than 95 % becomes undecided.

An input x with relative standard uncertainty v is x₀ (1 + v ξ). The changes ξ of different inputs
are independent and have a standard normal distribution. The change of an error with each ξ alone is
g ξ/(1 + c ξ) or g ξ + h ξ²/2, fitted to the two robots with that input changed; changes by
different inputs are added. For frequencies, the curves are fitted to the signed error, for
displacements to the vectors u of the model and u* of the reference, from which the error |u −
u*|/|u*| follows. The length of a vector has no derivative at zero, while its components have one.
For the quantity "any force", the largest error under several fixed forces counts; each of them is
the force of largest error of one of the robots. The root mean square deviation from the robots with
all inputs changed (`misfit`) widens the interval. A robot that has no such error, because it lacks
the mode, counts against both verdicts.

With one uncertain input the probability is exact: the limits of ξ between which the verdict holds
are found by bisection between 4096 points. With several inputs it is the share of 4096 Sobol'
points (scipy.stats.qmc), accurate to 0.004 for two to six inputs and 0.008 for ten. If each term of
a sum depends on one input, the variance of the sum is the sum of the terms' variances, whose shares
are the first-order indices of Sobol' (Math. Comput. Simulat. 55 (2001) 271); for vectors, variances
are summed over the components (Gamboa et al., Electron. J. Stat. 8 (2014) 575).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from lumped.arrays import Array
from lumped.memo import memo
from validation.adequacy.errors import first_largest
from validation.responses.displacement import nearest_between
from validation.uncertainty.half_widths import Combiner, combined
from validation.verdicts import Adequacy

# Half-width of the two-sided 95 % interval of a normal distribution, in standard deviations.
COVERAGE = 1.959964
# Smallest probability with which a verdict stands. Below it the verdict becomes undecided.
CONFIDENCE = 0.95
# Binary logarithm of the number of Sobol' points: with 4096, probabilities of several seeds differ
# by 0.002.
_POWER = 12
# Smallest share of the variance for which an input is listed.
_NAMED_SHARE = 0.01
# If an error exists at ξ = 0 and is missing at |ξ| = 1, it counts as missing beyond this |ξ|: the
# point at which it is lost is unknown, so half is assumed.
_LOST_FROM = 0.5
# Largest |c| of g ξ/(1 + c ξ): the pole is then at least five standard uncertainties away.
_LARGEST_BEND = 0.2
# Number of bisections of an interval between two of 4096 points, enough to reach round-off.
_HALVINGS = 50
# Largest size of an array (in numbers) that is computed at once.
_MOST_NUMBERS = 4_000_000


@dataclass(frozen=True, eq=False)
class Slope:
    """Errors of a quantity if one input is one standard uncertainty lower, or higher.

    `key`: key of the input in the robot file. `relative`: relative standard uncertainty of it.
    `below`, `above`: components of the errors with the lower and with the higher input, in the
    shape of `ErrorOfInputs.nominal`; NaN if the error is missing. `values` (2×P): the model's value
    of the quantity with the lower and with the higher input. Shapes: P poses.
    """

    key: str
    relative: float
    below: Array
    above: Array
    values: Array


@dataclass(frozen=True, eq=False)
class ErrorOfInputs:
    """Errors with the inputs of the robot file, and their dependence on each uncertain input.

    `nominal` (R×P×f×k): components of the errors, for R interpretations of the reference in P poses
    under f forces. If `signed` (frequencies), k = 2: the error and its half-width. Otherwise k = 8:
    displacement of the model (3) and of the reference (3), the smallest length by which the
    difference is divided, and its half-width. `slopes`: the errors with one input changed at a
    time, through which curves are fitted. `misfit`: root mean square deviation of the sum of these
    curves from the errors of robots with all inputs changed. `lost`: share of these robots in which
    the error does not exist although the curves predict one.
    """

    nominal: Array
    slopes: Sequence[Slope]
    signed: bool
    misfit: float = 0.0
    lost: float = 0.0

    def intervals(self, draws: Array) -> Array:
        """Lowest and highest error (n×2×P) for n samples of the inputs.

        `draws` (n×inputs): changes ξ of the inputs, in units of their standard uncertainties. NaN
        if there is no error. Shapes: P poses.
        """
        rows = max(1, _MOST_NUMBERS // max(self.nominal.size, 1))
        pieces = np.split(draws, range(rows, len(draws), rows))
        return np.concatenate(
            [self._interval(_components_at(self.nominal, *self._ends, piece)) for piece in pieces]
        )

    def probabilities(
        self, limit: float | Array, reductions: Mapping[str, float] | None = None
    ) -> Array:
        """Probabilities (2): errors within the limit in all poses; an error beyond it in any pose.

        `reductions`: factors on the standard uncertainties of inputs, by key.
        """
        factors = np.array([(reductions or {}).get(slope.key, 1.0) for slope in self.slopes])

        def verdicts(draws: Array) -> NDArray[np.bool_]:
            low, high = np.moveaxis(self.intervals(draws * factors), 1, 0)
            within = ((low >= -limit) & (high <= limit)).all(axis=1)
            beyond = ((low > limit) | (high < -limit)).any(axis=1)
            return np.array([within, beyond])

        if len(factors) == 1:
            shares = _normal_shares(verdicts)
        else:
            shares = verdicts(_draws(len(factors))).mean(axis=1)
        return np.asarray((1.0 - self.lost) * shares)

    def half_width(self, pose: int) -> float:
        """Half-width (95 %) of the error in a pose due to uncertain inputs.

        For a displacement vector, it is the radius that contains 95 % of the vector's changes.
        """
        nominal, below, above = self._largest_components(pose)
        components = _components_at(nominal, below, above, _draws(len(self.slopes)))
        sizes = np.linalg.norm(self._vectors(components) - self._vectors(nominal), axis=-1)
        return float(np.nanquantile(sizes, CONFIDENCE))

    def _interval(self, components: Array) -> Array:
        """Lowest and highest error (n×2×P) from components (n×R×P×f×k) of n samples.

        Shapes: R interpretations of the reference, P poses, f forces, k components.
        """
        half_width, vectors = components[..., 0, -1], self._vectors(components)
        error = np.linalg.norm(vectors, axis=-1).max(axis=-1)
        error = vectors[..., 0, 0] if self.signed else error
        low, high = (error - half_width).min(axis=1), (error + half_width).max(axis=1)
        if not self.signed:
            model, reference = components[..., :3], components[..., 3:6]
            length = np.maximum(np.linalg.norm(reference, axis=-1), components[..., 6])
            between = nearest_between(
                *(np.moveaxis(rows, 1, 0) for rows in (model - reference, length))
            )
            low = np.minimum(low, between.max(axis=-1) - half_width.max(axis=1))
            low = np.maximum(low, 0.0)
        return np.stack([low - self.misfit, high + self.misfit], axis=1)

    def _vectors(self, components: Array) -> Array:
        """Errors from their components: vectors (…×3), or signed numbers (…×1) for frequencies."""
        if self.signed:
            return components[..., :1]
        model, reference, least = components[..., :3], components[..., 3:6], components[..., 6]
        length = np.maximum(np.linalg.norm(reference, axis=-1), least)[..., None]
        vectors = np.divide(
            model - reference, length, out=np.zeros_like(reference), where=length != 0.0
        )
        return np.asarray(vectors)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Components of errors with one of m inputs lower, and with it higher (m×R×P×f×k each).

        Shapes: R interpretations of the reference, P poses, f forces, k components.
        """
        below, above = zip(*((slope.below, slope.above) for slope in self.slopes), strict=True)
        return np.array(below), np.array(above)

    @property
    def losing_inputs(self) -> list[str]:
        """Keys of the inputs whose change alone removes the mode, so that it has no error."""
        sides = {slope.key: np.array([slope.below, slope.above]) for slope in self.slopes}
        return [key for key, ends in sides.items() if np.isnan(ends).any()]

    def shares(self, pose: int) -> dict[str, float]:
        """Share of each input in the variance of the error of a pose, by key, in descending order.

        The shares are first-order Sobol' indices.
        """
        nominal, below, above = (
            self._vectors(components) for components in self._largest_components(pose)
        )
        linear, square = _derivatives(below - nominal, above - nominal)
        parts = (linear**2 + 0.5 * square**2).sum(axis=1)
        if not parts.sum() > 0.0:
            return {}
        shares_by_key = zip((slope.key for slope in self.slopes), parts / parts.sum(), strict=True)
        ranked = sorted(((float(share), key) for key, share in shares_by_key), reverse=True)
        return {key: share for share, key in ranked if share >= _NAMED_SHARE}

    def _largest_components(self, pose: int) -> tuple[Array, Array, Array]:
        """Components of the largest error in a pose (k), and with one of m inputs changed (m×k).

        The first array has the inputs of the file; the second and third have one input lower, and
        higher, by one standard uncertainty. The k components are those of `nominal`. The error is
        the largest over all interpretations and forces with the inputs of the robot file, the first
        of those that are equal up to round-off.
        """
        sizes = np.linalg.norm(self._vectors(self.nominal[:, pose]), axis=-1)
        interpretation, force = np.unravel_index(first_largest(sizes.ravel()), sizes.shape)
        position = interpretation, pose, force
        below, above = (ends[:, *position] for ends in self._ends)
        return self.nominal[position], below, above


def _components_at(nominal: Array, below: Array, above: Array, draws: Array) -> Array:
    """Components (n×…) of errors for n samples of m uncertain inputs.

    `draws` (n×m): changes ξ of the inputs, in units of their standard uncertainties. `nominal` (…):
    components with the inputs of the file. `below` and `above` (m×…): components with one of the
    inputs changed by one standard uncertainty, down and up.
    """
    components = np.repeat(nominal[None], len(draws), axis=0)
    for low, high, draw in zip(below - nominal, above - nominal, draws.T, strict=True):
        components += _change(low, high, draw.reshape(-1, *[1] * nominal.ndim))
    return components


def _change(below: Array, above: Array, draw: Array) -> Array:
    """Change of a number if an input changes by ξ = `draw` standard uncertainties.

    `below` and `above`: changes of the number at ξ = −1 and ξ = 1. Between them the change is g
    ξ/(1 + c ξ), the form of any linear response as a function of one spring's stiffness, or g ξ + h
    ξ²/2 if the pole ξ = −1/c is too near. If `below` or `above` is NaN, the change is NaN on that
    side, from |ξ| = `_LOST_FROM` on.
    """
    linear, square = _derivatives(below, above)
    bend = np.divide(-0.5 * square, linear, out=np.full_like(linear, np.inf), where=linear != 0.0)
    regular = np.abs(bend) <= _LARGEST_BEND
    bend = np.where(regular, bend, 0.0)
    # The change at ξ = 1 is linear + square/2.
    slope = np.where(regular, (linear + 0.5 * square) * (1.0 + bend), linear)
    change = slope * draw / (1.0 + bend * draw) + np.where(regular, 0.0, 0.5 * square) * draw**2
    lost = (draw < -_LOST_FROM) & np.isnan(below) | (draw > _LOST_FROM) & np.isnan(above)
    return np.where(lost, np.nan, change)


def _derivatives(below: Array, above: Array) -> tuple[Array, Array]:
    """First and second derivative of a number with respect to the change ξ of an input.

    ξ is in units of the input's standard uncertainty. The number changes by `below` at ξ = −1 and
    by `above` at ξ = 1. `below`, `above` and the results have one shape. If one of the two changes
    is NaN, the number is taken as linear in ξ; if both are, as constant.
    """
    below, above = (
        np.nan_to_num(np.where(np.isnan(change), -other, change))
        for change, other in ((below, above), (above, below))
    )
    return 0.5 * (above - below), above + below


@dataclass(frozen=True)
class Probability:
    """Probability of a verdict with uncertain inputs.

    `within`, `beyond`: probability that the whole interval of the error is within, or beyond, the
    limit. In the remaining cases the verdict is undecided even with exact inputs. `half_width` (95
    %) of the error, and `value_half_width` (95 %) of the model's own value in its unit, to first
    order; `value_half_width` is None if the value does not exist within one standard uncertainty.
    `shares`: share of each input in the error's variance, by key. `decides`: text on the inputs
    that must be known better.
    """

    within: float
    beyond: float
    half_width: float
    value_half_width: float | None
    shares: Mapping[str, float]
    decides: str = ""

    def settled(self, verdict: Adequacy) -> Adequacy:
        """The `verdict` if it is probable enough, otherwise "undecided"."""
        probabilities = {"adequate": self.within, "inadequate": self.beyond}
        return verdict if probabilities.get(verdict, 1.0) >= CONFIDENCE else "undecided"


def probability(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, pose: int
) -> Probability:
    """Probability of a `verdict` that was made with the inputs of the file.

    `limit` is the accepted error, one number or one for each pose. `pose` is the index of the
    deciding pose, which determined the verdict.
    """
    within, beyond = map(float, error.probabilities(limit))
    shares = error.shares(pose)
    value_uncertainty = propagated(slope.values[:, pose] for slope in error.slopes)
    chances = Probability(
        within,
        beyond,
        error.half_width(pose),
        COVERAGE * value_uncertainty if np.isfinite(value_uncertainty) else None,
        shares,
    )
    if chances.settled(verdict) == verdict:
        return chances
    keys = list(dict.fromkeys([*error.losing_inputs, *shares]))
    return replace(chances, decides=_deciding_inputs(error, verdict, limit, keys))


def _deciding_inputs(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, keys: Sequence[str]
) -> str:
    """Text on the inputs that must be known better to reach the verdict `verdict`.

    The verdict is undecided as yet. The text names one input, or several. `limit` is the accepted
    error, one number or one for each pose. `keys` are the inputs in descending order of their share
    of the variance. "" if even all inputs together do not decide the verdict.
    """
    relative = {slope.key: slope.relative for slope in error.slopes}
    column = 0 if verdict == "adequate" else 1

    def lacking(reductions: Mapping[str, float]) -> float:
        return CONFIDENCE - float(error.probabilities(limit, reductions)[column])

    for key in keys:
        if lacking({key: 0.0}) > 0.0:
            continue
        # The probability is a step function. The root is accurate to 0.01, by which it is lowered.
        factor = scipy.optimize.brentq(
            lambda reduction, key=key: lacking({key: reduction}), 0.0, 1.0, xtol=0.005
        )
        required = max(factor - 0.01, 0.0) * relative[key]
        return (
            "undecided because of uncertain inputs; reduce the standard uncertainty of "
            f"{key} to {100.0 * required:.2g} % (now {100.0 * relative[key]:.2g} %)"
        )
    for count in range(2, len(keys) + 1):
        if lacking(dict.fromkeys(keys[:count], 0.0)) <= 0.0:
            return (
                "undecided because of uncertain inputs; reduce the uncertainty of "
                f"{' and '.join(keys[:count])} together"
            )
    return ""


def _normal_shares(verdicts: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Probability that each of m conditions on a standard normal variable holds (m).

    `verdicts` returns the conditions (m×n) for n values (n×1) of the variable. If a condition
    changes between two of 4096 points, the value at which it does is found by bisection.
    """
    count = 2**_POWER
    points = scipy.special.ndtri((np.arange(count) + 0.5) / count)
    probabilities = []
    for row, holds in enumerate(verdicts(points[:, None])):
        changes = np.flatnonzero(holds[1:] != holds[:-1])
        left, right = points[changes], points[changes + 1]
        for _ in range(_HALVINGS):
            middle = 0.5 * (left + right)
            equal_left = verdicts(middle[:, None])[row] == holds[changes]
            left, right = np.where(equal_left, middle, left), np.where(equal_left, right, middle)
        ends = np.concatenate([[0.0], scipy.special.ndtr(0.5 * (left + right)), [1.0]])
        # The condition holds in every second interval between the values at which it changes.
        probabilities.append(np.diff(ends)[0 if holds[0] else 1 :: 2].sum())
    return np.array(probabilities)


@memo(8)
def _draws(inputs: int) -> Array:
    """Standard normal samples (n×inputs), from n points of a Sobol' sequence."""
    points = scipy.stats.qmc.Sobol(inputs, seed=0).random_base2(_POWER)
    # Scrambled by default: an unscrambled sequence starts at a corner, where ξ is infinite.
    return np.asarray(scipy.special.ndtri(points), dtype=float)


def propagated(changes: Iterable[Sequence[float] | Array]) -> float:
    """Standard uncertainty of a value, combined from independent inputs (GUM, eq. (10)).

    `changes`: for each input, the model's value with the input one standard uncertainty below and
    above its value in the file.
    """
    slopes = np.array([0.5 * (above - below) for below, above in changes])
    return float(combined(slopes, np.abs, Combiner.ROOT_OF_SQUARES))
