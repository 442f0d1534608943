"""How probable a verdict is where inputs of the robot are uncertain, and which of them decide it.

An input x with relative standard uncertainty v is x₀ (1 + v ξ), ξ normal, all independent. Robots
with one input alone one standard uncertainty below and above show how each ξ by itself changes what
an error is made of, by g ξ/(1 + c ξ) or g ξ + h ξ²/2: of frequencies the error with its sign, of
displacements the vectors u and u*, from which the error is |u − u*|/|u*|. That has no derivative
where it is zero, while the vectors have theirs, and those of parts in series add. Of any force the
longest error under several fixed forces counts, the worst ones of all these robots. By how much all
this misses some robots with all inputs off at once (`misfit`, root mean square) is added to the
interval. Where one of these robots has no such error (its modes are other ones) that counts against
both verdicts.

The probability of one input is exact: the normal distribution between the ξ at which the verdict
changes, found by bisection between neighbours of 4096 points. Of several inputs it is the share of
4096 Sobol' points (scipy.stats.qmc): within 0.004 of two to six inputs, 0.008 of ten. The variance
of a sum of terms in one input each is the sum of theirs, whose shares are the first-order indices
of Sobol' (Math. Comput. Simulat. 55 (2001) 271), of vectors summed over components (Gamboa et al.,
Electron. J. Stat. 8 (2014) 575).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, Quantity
from lumped.arrays import Array
from lumped.memo import memo
from validation.adequacy.errors import Errors, ModelErrors
from validation.references.reference import InputUncertainties
from validation.references.responses import Model
from validation.responses.displacement import FLOOR, nearest_between
from validation.responses.statics_and_modes import Statics
from validation.uncertainty.combiners import Combiner, combined
from validation.verdicts import Adequacy

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
_SIDES = ("below", "above")
# Of g ξ/(1 + c ξ): up to this |c| its pole is five standard uncertainties away, or farther.
_LARGEST_BEND = 0.2
# Directions of force under which errors of any force are followed from robot to robot.
_FORCES = 8
# Halvings of an interval between two of 4096 points: to rounding.
_HALVINGS = 50
# Numbers that are held at once.
_AT_ONCE = 4_000_000


@dataclass(frozen=True, eq=False)
class Slope:
    """The errors of a quantity with one input a standard uncertainty below and above.

    `key` of the input in the robot file, `relative` its standard uncertainty; `below` and `above`
    as `ErrorOfInputs.own`, NaN where there is no such error; `values` (2×p) the model's own number.
    """

    key: str
    relative: float
    below: Array
    above: Array
    values: Array


@dataclass(frozen=True, eq=False)
class ErrorOfInputs:
    """Errors as they are with the inputs of the file, and how these change them.

    `own` (a×p×f×k): what errors are made of, by a interpretations of the reference in p poses
    under f forces. If `signed`, k is two, the error and its half-width; else eight: displacements
    of the model (3) and of the reference (3), the least length that the error is relative to, and
    its half-width. `lost`: share of robots with all inputs off that have no such error although the
    slopes do.
    """

    own: Array
    slopes: Sequence[Slope]
    signed: bool
    misfit: float = 0.0
    lost: float = 0.0

    def at(self, draws: Array) -> Array:
        """The interval (n×2×p, lowest and highest) for draws (n×inputs) of ξ.

        NaN where there is no such error.
        """
        rows = max(1, _AT_ONCE // max(self.own.size, 1))
        pieces = np.split(draws, range(rows, len(draws), rows))
        return np.concatenate(
            [self._interval(_followed(self.own, *self._ends, piece)) for piece in pieces]
        )

    def probabilities(
        self, limit: float | Array, known: Mapping[str, float] | None = None
    ) -> Array:
        """Of being within the limit in all poses, and of being beyond it in one.

        `known`: factors by which inputs are known better than the file says.
        """
        factors = np.array([(known or {}).get(slope.key, 1.0) for slope in self.slopes])

        def verdicts(draws: Array) -> NDArray[np.bool_]:
            low, high = np.moveaxis(self.at(draws * factors), 1, 0)
            within = ((low >= -limit) & (high <= limit)).all(axis=1)
            beyond = ((low > limit) | (high < -limit)).any(axis=1)
            return np.array([within, beyond])

        if len(factors) == 1:
            shares = _normal_shares(verdicts)
        else:
            shares = verdicts(_draws(len(factors))).mean(axis=1)
        return np.asarray((1.0 - self.lost) * shares)

    def half_width(self, pose: int) -> float:
        """Half-width (95 %) that inputs leave open of the error of a pose, about that of the file.

        Of a vector it is the radius that holds 95 % of its changes.
        """
        own, below, above = self._of_largest(pose)
        followed = _followed(own, below, above, _draws(len(self.slopes)))
        sizes = np.linalg.norm(self._vectors(followed) - self._vectors(own), axis=-1)
        return float(np.nanquantile(sizes, CONFIDENCE))

    def _interval(self, found: Array) -> Array:
        """Lowest and highest error (n×2×p) of what they are made of (n×a×p×f×k)."""
        half, vectors = found[..., 0, -1], self._vectors(found)
        error = np.linalg.norm(vectors, axis=-1).max(axis=-1)
        error = vectors[..., 0, 0] if self.signed else error
        low, high = (error - half).min(axis=1), (error + half).max(axis=1)
        if not self.signed:
            moved, due = found[..., :3], found[..., 3:6]
            length = np.maximum(np.linalg.norm(due, axis=-1), found[..., 6])
            between = nearest_between(*(np.moveaxis(one, 1, 0) for one in (moved - due, length)))
            low = np.minimum(low, between.max(axis=-1) - half.max(axis=1))
            low = np.maximum(low, 0.0)
        return np.stack([low - self.misfit, high + self.misfit], axis=1)

    def _vectors(self, found: Array) -> Array:
        """Errors as vectors (…×3), of frequencies as numbers (…×1)."""
        if self.signed:
            return found[..., :1]
        moved, due, least = found[..., :3], found[..., 3:6], found[..., 6]
        length = np.maximum(np.linalg.norm(due, axis=-1), least)[..., None]
        vectors = np.divide(moved - due, length, out=np.zeros_like(due), where=length != 0.0)
        return np.asarray(vectors)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """What errors are made of with each input below and above (m×a×p×f×k each)."""
        below, above = ([getattr(slope, side) for slope in self.slopes] for side in _SIDES)
        return np.array(below), np.array(above)

    @property
    def losing(self) -> list[str]:
        """Inputs that alone can leave the model without such an error."""
        sides = {slope.key: np.array([slope.below, slope.above]) for slope in self.slopes}
        return [key for key, ends in sides.items() if np.isnan(ends).any()]

    def shares(self, pose: int) -> dict[str, float]:
        """First-order indices of Sobol' of the error of a pose, the largest first."""
        own, below, above = (self._vectors(one) for one in self._of_largest(pose))
        linear, square = _derivatives(below - own, above - own)
        parts = (linear**2 + 0.5 * square**2).sum(axis=1)
        if not parts.sum() > 0.0:
            return {}
        named = zip((slope.key for slope in self.slopes), parts / parts.sum(), strict=True)
        found = sorted(((float(share), key) for key, share in named), reverse=True)
        return {key: share for share, key in found if share >= _WORTH_NAMING}

    def _of_largest(self, pose: int) -> tuple[Array, Array, Array]:
        """What the largest error of a pose is made of (k), and each input off (m×k, below, above).

        The largest with the inputs of the file, of all interpretations and forces.
        """
        sizes = np.linalg.norm(self._vectors(self.own[:, pose]), axis=-1)
        alternative, force = np.unravel_index(np.argmax(sizes), sizes.shape)
        place = alternative, pose, force
        below, above = (ends[:, *place] for ends in self._ends)
        return self.own[place], below, above


def _followed(own: Array, below: Array, above: Array, draws: Array) -> Array:
    """What is `own` (…) with the inputs of the file, for draws (n×m) of ξ (n×…).

    `below` and `above` (m×…) have one input a standard uncertainty off.
    """
    found = np.repeat(own[None], len(draws), axis=0)
    for low, high, draw in zip(below - own, above - own, draws.T, strict=True):
        found += _change(low, high, draw.reshape(-1, *[1] * own.ndim))
    return found


def _change(below: Array, above: Array, draw: Array) -> Array:
    """Change at ξ = `draw` of what changes by `below` and `above` at −1 and 1.

    By g ξ/(1 + c ξ), as everything linear changes with one stiffness; where its pole is too near,
    by g ξ + h ξ²/2. NaN on the side of a NaN, from `_LOST_FROM` on.
    """
    linear, square = _derivatives(below, above)
    bend = np.divide(-0.5 * square, linear, out=np.full_like(linear, np.inf), where=linear != 0.0)
    far = np.abs(bend) <= _LARGEST_BEND
    bend = np.where(far, bend, 0.0)
    # At 1 it is linear + square/2.
    slope = np.where(far, (linear + 0.5 * square) * (1.0 + bend), linear)
    change = slope * draw / (1.0 + bend * draw) + np.where(far, 0.0, 0.5 * square) * draw**2
    gone = (draw < -_LOST_FROM) & np.isnan(below) | (draw > _LOST_FROM) & np.isnan(above)
    return np.where(gone, np.nan, change)


def _derivatives(below: Array, above: Array) -> tuple[Array, Array]:
    """First and second derivative of what changes by `below` and `above` at −1 and 1.

    Linear where the change is known on one side alone, constant where on none.
    """
    below, above = (
        np.nan_to_num(np.where(np.isnan(one), -other, one))
        for one, other in ((below, above), (above, below))
    )
    return 0.5 * (above - below), above + below


@dataclass(frozen=True)
class Probability:
    """What uncertain inputs make of a verdict.

    `within` and `beyond` the limit, wherever in its interval the error is; what is left of one is
    open however well the inputs are known. Half-widths (95 %): `half_width` of the error,
    `of_value` of the model's own number (its unit), to first order, None where it is lost
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
    shares = error.shares(pose)
    of_value = propagated(slope.values[:, pose] for slope in error.slopes)
    found = Probability(
        within,
        beyond,
        error.half_width(pose),
        COVERAGE * of_value if np.isfinite(of_value) else None,
        shares,
    )
    if found.settled(verdict) == verdict:
        return found
    keys = list(dict.fromkeys([*error.losing, *shares]))
    return replace(found, decides=_decided_by(error, verdict, limit, keys))


@dataclass(frozen=True, eq=False)
class UncertainInputs:
    """Errors of a robot's models with its inputs perturbed, by the same rules as the nominal ones.

    `nominal` compares the robot of the file.
    """

    nominal: ModelErrors
    inputs: InputUncertainties

    def error(self, model: Model, quantity: Quantity, own: Errors) -> ErrorOfInputs | None:
        """Change of a model's error of a quantity by inputs. None if there is no such error.

        The order of modes has none: it jumps.
        """
        if own.numbers is not None or own.missing.any():
            return None
        below, above, together = (
            [_of_robot(one, model, quantity) for one in all_errors]
            for all_errors in self._model_errors
        )
        forces = None
        if quantity == ANY_FORCE:
            forces = _worst_forces([own, *(one.errors for one in (*below, *above))])
        slopes = [
            Slope(
                key,
                relative,
                low.components(own, forces),
                high.components(own, forces),
                np.stack([low.value(own), high.value(own)]),
            )
            for (key, relative), low, high in zip(
                self.inputs.relative.items(), below, above, strict=True
            )
        ]
        nominal = replace(_of_robot(self.nominal, model, quantity), errors=own)
        found = ErrorOfInputs(nominal.components(own, forces), slopes, own.displaced is None)
        foreseen = found.at(self.inputs.draws)
        missed = np.array([one.interval(own) for one in together]) - foreseen
        lost = np.isnan(missed) & ~np.isnan(foreseen)
        squared = np.ma.masked_invalid(missed**2).mean(axis=0).filled(0.0)
        return replace(
            found,
            misfit=float(np.sqrt(squared.max())),
            lost=float(lost.any(axis=(1, 2)).mean()),
        )

    @cached_property
    def _model_errors(self) -> tuple[list[ModelErrors], ...]:
        kinds = self.inputs.alone(-1), self.inputs.alone(1), self.inputs.together
        nominal = self.nominal
        return tuple(
            [ModelErrors(nominal.subject, nominal.modes, factors) for factors in kind]
            for kind in kinds
        )


@dataclass(frozen=True, eq=False)
class _OfRobot:
    """Errors of a model's quantity for one robot. None if it has none.

    `statics` of the reference and of the model, for each interpretation, are what they come from.
    """

    quantity: Quantity
    errors: Errors | None
    statics: Sequence[tuple[Statics, Statics]] = ()

    def components(self, own: Errors, forces: Array | None) -> Array:
        """As `ErrorOfInputs.own`; under fixed `forces` (p×f×6) if the quantity is any force."""
        errors, of_displacement = self.errors, own.displaced is not None
        count = 1 if forces is None else forces.shape[1]
        shape = (*own.error.shape, count, 8 if of_displacement else 2)
        if errors is None:
            return np.full(shape, np.nan)
        found = np.empty(shape)
        found[..., -1] = errors.farthest[..., None]
        if errors.displaced is None:
            found[..., 0] = errors.error[..., None]
            return found
        for k, (reference, model) in enumerate(self.statics):
            wrenches = errors.displaced.wrench[k, :, None] if forces is None else forces
            found[k, ..., :3] = model.displacements(self.quantity, wrenches)
            found[k, ..., 3:6] = reference.displacements(self.quantity, wrenches)
            least = FLOOR * np.linalg.norm(reference.compliances[:, :3, :3], 2, axis=(1, 2))
            found[k, ..., 6] = least[:, None] if forces is not None else 0.0
        return np.where(errors.missing[..., None, None], np.nan, found)

    def interval(self, own: Errors) -> Array:
        """Lowest and highest error (2×p)."""
        if self.errors is None:
            return np.full((2, own.error.shape[1]), np.nan)
        return np.stack(self.errors.interval)

    def value(self, own: Errors) -> Array:
        """The model's own number (p)."""
        if self.errors is None:
            return np.full(own.error.shape[1], np.nan)
        return np.asarray(self.errors.value[0])


def _of_robot(model_errors: ModelErrors, model: Model, quantity: Quantity) -> _OfRobot:
    errors = model_errors.errors(model, quantity)
    return _OfRobot(quantity, errors, model_errors.statics(model) if quantity.static else ())


def _worst_forces(found: Sequence[Errors | None]) -> Array:
    """The worst forces (p×f×6) of several robots, at most `_FORCES` of them.

    The first is that of the first robot's largest error, then those that differ most from it.
    """
    first = found[0]
    loads = [one.displaced.wrench for one in found if one is not None and one.displaced]
    all_forces = np.concatenate(loads).transpose(1, 0, 2)
    chosen = []
    for pose, forces in enumerate(all_forces):
        start = 0 if first is None else int(first.largest[pose])
        order, alike = [start], np.abs(forces @ forces[start])
        while len(order) < min(_FORCES, len(forces)):
            order.append(int(np.argmin(alike)))
            alike = np.maximum(alike, np.abs(forces @ forces[order[-1]]))
        chosen.append(forces[order])
    return np.array(chosen)


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


def _normal_shares(verdicts: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Probabilities (m) that verdicts (m×n) of a normal number hold, for draws (n×1).

    Where a verdict changes between two of the points, the number at which it does is bisected.
    """
    count = 2**_POWER
    points = scipy.special.ndtri((np.arange(count) + 0.5) / count)
    found = []
    for row, holds in enumerate(verdicts(points[:, None])):
        changes = np.flatnonzero(holds[1:] != holds[:-1])
        left, right = points[changes], points[changes + 1]
        for _ in range(_HALVINGS):
            middle = 0.5 * (left + right)
            as_left = verdicts(middle[:, None])[row] == holds[changes]
            left, right = np.where(as_left, middle, left), np.where(as_left, right, middle)
        ends = np.concatenate([[0.0], scipy.special.ndtr(0.5 * (left + right)), [1.0]])
        # Between the changes it holds and does not hold in turn.
        found.append(np.diff(ends)[0 if holds[0] else 1 :: 2].sum())
    return np.array(found)


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
    slopes = np.array([0.5 * (above - below) for below, above in changes])
    return float(combined(slopes, np.abs, Combiner.ROOT_OF_SQUARES))
