"""How probable a verdict is where inputs of the robot are uncertain, and which of them decide it.

An input x with relative standard uncertainty u is x₀ (1 + u ξ), ξ normal, all independent. The ends
of the interval of an error are taken quadratic in each ξ by itself, e₀ + g ξ + h ξ²/2, from the
robots with that input alone one standard uncertainty below and above; by how much this misses some
robots with all inputs off at once (`misfit`, root mean square) is added to the interval. Where one
of these robots has no such error (its modes are other ones) that counts against both verdicts.
Probabilities are shares of Sobol' points (scipy.stats.qmc); the variance of such a sum is the sum
of its terms, whose shares are the first-order indices of Sobol' (Math. Comput. Simulat. 55 (2001)
271).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot

import numpy as np
import scipy

from lumped.arrays import Array
from lumped.memo import memo
from validation.adequacy.errors import Errors, Scale
from validation.adequacy.matrix import Adequacy
from validation.adequacy.response import InputsOff

# Of a normal distribution, two-sided 95 %.
COVERAGE = 1.959964
# A verdict that is less probable than this is none.
CONFIDENCE = 0.95
# 4096 points of Sobol': probabilities of several seeds differ by 0.002.
_POWER = 12
# A share of the variance below which an input is not named.
_WORTH_NAMING = 0.01
# Standard uncertainties from which on there is no error where at one there is none: at zero there
# is one, what lies between nobody knows.
_LOST_FROM = 0.5


@dataclass(frozen=True, eq=False)
class Slope:
    """An error's interval (2×p, lowest and highest) with one input a standard uncertainty off.

    `key` of the input in the robot file, `relative` its standard uncertainty; `values` (2×p) are
    the model's own number below and above. NaN where there is no such error.
    """

    key: str
    relative: float
    below: Array
    above: Array
    values: Array


@dataclass(frozen=True, eq=False)
class ErrorOfInputs:
    """An error's interval (2×p) as it is with the inputs of the file, and how they change it.

    `lost`: share of robots with all inputs off that have no such error although the slopes do.
    """

    own: Array
    slopes: Sequence[Slope]
    misfit: float = 0.0
    lost: float = 0.0

    def at(self, draws: Array) -> Array:
        """The interval (n×2×p) for draws (n×inputs) of ξ; NaN where there is no such error."""
        linear, square = self._terms
        found = np.tensordot(draws, linear, axes=1)
        found += np.tensordot(0.5 * draws**2, square, axes=1)
        found += self.own + self.misfit * np.array([-1.0, 1.0])[:, None]
        for slope, draw in zip(self.slopes, draws.T, strict=True):
            for end, side in ((slope.below, -draw), (slope.above, draw)):
                gone = (side > _LOST_FROM)[:, None, None] & np.isnan(end)
                found = np.where(gone, np.nan, found)
        return np.asarray(found)

    def probabilities(
        self, limit: float | Array, known: Mapping[str, float] | None = None
    ) -> Array:
        """Of being within the limit in all poses, and of being beyond it in one.

        `known`: factors by which inputs are known better than the file says.
        """
        factors = [(known or {}).get(slope.key, 1.0) for slope in self.slopes]
        low, high = np.moveaxis(self.at(_draws(len(factors)) * np.array(factors)), 1, 0)
        within = ((low >= -limit) & (high <= limit)).all(axis=1)
        beyond = ((low > limit) | (high < -limit)).any(axis=1)
        return (1.0 - self.lost) * np.array([within.mean(), beyond.mean()])

    @cached_property
    def _terms(self) -> tuple[Array, Array]:
        """Linear where the error is known on one side alone, constant where on none."""
        off = np.array([[slope.below, slope.above] for slope in self.slopes]) - self.own
        mirrored = np.where(np.isnan(off), -off[:, ::-1], off)
        below, above = np.moveaxis(np.nan_to_num(mirrored), 1, 0)
        return 0.5 * (above - below), above + below

    @property
    def losing(self) -> list[str]:
        """Inputs that alone can leave the model without such an error."""
        sides = {slope.key: np.array([slope.below, slope.above]) for slope in self.slopes}
        return [key for key, ends in sides.items() if np.isnan(ends).any()]

    def shares(self, pose: int) -> dict[str, float]:
        """First-order indices of Sobol' of the middle of the interval in a pose, largest first."""
        linear, square = (term[:, :, pose].mean(axis=1) for term in self._terms)
        parts = linear**2 + 0.5 * square**2
        if not parts.sum() > 0.0:
            return {}
        named = zip((slope.key for slope in self.slopes), parts / parts.sum(), strict=True)
        found = sorted(((float(share), key) for key, share in named), reverse=True)
        return {key: share for share, key in found if share >= _WORTH_NAMING}


@dataclass(frozen=True)
class Probability:
    """What uncertain inputs make of a verdict.

    `within` and `beyond` the limit, wherever in its interval the error is; what is left of one is
    open however well the inputs are known. Half-widths (95 %): `half_width` of the middle of the
    error, `of_value` of the model's own number (its unit), to first order, None where it is lost
    within a standard uncertainty. `shares` are the first-order indices of the error's inputs,
    `decides` is what to know better.
    """

    within: float
    beyond: float
    half_width: float
    of_value: float | None
    shares: Mapping[str, float]
    decides: str = ""

    def settled(self, verdict: Adequacy) -> Adequacy:
        """A verdict by the inputs of the file; undecided where these leave too little of it."""
        own = {"adequate": self.within, "inadequate": self.beyond}
        return verdict if own.get(verdict, 1.0) >= CONFIDENCE else "undecided"


def probability(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, pose: int
) -> Probability:
    """Of a verdict by the inputs of the file; `pose` (its index) is the one that decides it."""
    within, beyond = map(float, error.probabilities(limit))
    middle = error.at(_draws(len(error.slopes)))[:, :, pose].mean(axis=1)
    low, high = np.nanquantile(middle, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE])
    shares = error.shares(pose)
    of_value = propagated(slope.values[:, pose] for slope in error.slopes)
    found = Probability(
        within,
        beyond,
        float(high - low) / 2.0,
        COVERAGE * of_value if np.isfinite(of_value) else None,
        shares,
    )
    if found.settled(verdict) == verdict:
        return found
    keys = list(dict.fromkeys([*error.losing, *shares]))
    return replace(found, decides=_decided_by(error, verdict, limit, keys))


@dataclass(frozen=True, eq=False)
class UncertainInputs:
    """The errors of a robot's models with its inputs off, by the same rules as with these as given.

    `off` the robots, `modes` the number of frequencies that are judged.
    """

    off: InputsOff
    modes: int

    def error(self, model: str, quantity: str, own: Errors) -> ErrorOfInputs | None:
        """How inputs change a model's error of a quantity; None where there is none to change.

        The order of modes has none: it jumps.
        """
        if own.numbers is not None or own.missing.any():
            return None
        below, above, together = (
            [_errors(scale, model, quantity, own) for scale in scales] for scales in self._scales
        )
        slopes = [
            Slope(one.key, one.relative, low[:2], high[:2], np.stack([low[2], high[2]]))
            for one, low, high in zip(self.off.alone, below, above, strict=True)
        ]
        found = ErrorOfInputs(_ends(own), slopes)
        foreseen = found.at(self.off.draws)
        missed = np.array(together)[:, :2] - foreseen
        lost = np.isnan(missed) & ~np.isnan(foreseen)
        squared = np.ma.masked_invalid(missed**2).mean(axis=0).filled(0.0)
        return replace(
            found,
            misfit=float(np.sqrt(squared.max())),
            lost=float(lost.any(axis=(1, 2)).mean()),
        )

    @cached_property
    def _scales(self) -> tuple[list[Scale], ...]:
        alone = self.off.alone
        robots = [one.below for one in alone], [one.above for one in alone], self.off.together
        return tuple([Scale(one, self.modes) for one in kind] for kind in robots)


def _errors(scale: Scale, model: str, quantity: str, own: Errors) -> Array:
    """Lowest and highest error, and the model's own number (3×p); NaN where there is none."""
    (response,) = (one.response for one in scale.subject.candidates if one.model == model)
    found = scale.errors([response] * len(scale.reference(quantity).alternatives), quantity)
    if found is None:
        return np.full((3, own.error.shape[1]), np.nan)
    return np.stack([*found.interval, found.value[0]])


def _ends(errors: Errors) -> Array:
    """Lowest and highest error (2×p)."""
    return np.stack(errors.interval)


def _decided_by(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, keys: Sequence[str]
) -> str:
    """What has to be known better for a verdict: the one input that can do it, else the first few.

    `keys` in the order of their shares.
    """
    relative = {slope.key: slope.relative for slope in error.slopes}
    column = 0 if verdict == "adequate" else 1

    def lacking(known: Mapping[str, float]) -> float:
        return CONFIDENCE - float(error.probabilities(limit, known)[column])

    for key in keys:
        if lacking({key: 0.0}) > 0.0:
            continue
        # A share of points is a staircase: to a hundredth of the uncertainty, on the safe side.
        factor = scipy.optimize.brentq(
            lambda one, key=key: lacking({key: one}), 0.0, 1.0, xtol=0.005
        )
        known = max(factor - 0.01, 0.0) * relative[key]
        return (
            f"{key} known to a standard uncertainty of {100.0 * known:.2g} % (now "
            f"{100.0 * relative[key]:.2g} %) would decide it"
        )
    for count in range(2, len(keys) + 1):
        if lacking(dict.fromkeys(keys[:count], 0.0)) <= 0.0:
            return f"better values of {' and '.join(keys[:count])} together would decide it"
    return ""


@memo(8)
def _draws(inputs: int) -> Array:
    """Points of Sobol' (n×inputs), normal."""
    points = scipy.stats.qmc.Sobol(inputs, seed=0).random_base2(_POWER)
    # The first point of the unscrambled sequence is the corner; the scrambled one has none.
    return np.asarray(scipy.special.ndtri(points), dtype=float)


def propagated(changes: Iterable[Sequence[float] | Array]) -> float:
    """Standard uncertainty from independent inputs, to first order (GUM, eq. (10)).

    `changes` are the model's values with one input at a time a standard uncertainty below and
    above what the file says.
    """
    return hypot(*(0.5 * (above - below) for below, above in changes), 0.0)
