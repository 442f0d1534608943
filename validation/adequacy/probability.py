"""Probability of a verdict under uncertain inputs of the robot, and the inputs that decide it.

An input x with relative standard uncertainty v is x₀ (1 + v ξ), ξ normal, all independent. Robots
with a single input one standard uncertainty below and above give the change of the components of an
error with each ξ alone, as g ξ/(1 + c ξ) or g ξ + h ξ²/2. The component of a frequency is its error
with sign. Those of displacements are the vectors u and u*, from which the error is |u − u*|/|u*|:
this has no derivative at zero, while the vectors have one, and vectors of parts in series add. For
any force, the longest error under several fixed forces counts, the worst ones of all these robots.
The deviation from some robots with all inputs perturbed at once (`misfit`, root mean square) is
added to the interval. A robot without such an error (its modes are other ones) counts against both
verdicts.

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
# Smallest probability of a verdict; a less probable one becomes undecided.
CONFIDENCE = 0.95
# 2¹² = 4096 points of Sobol': probabilities of several seeds differ by 0.002.
_POWER = 12
# Smallest share of the variance from which on an input is named.
_NAMED_SHARE = 0.01
# Standard uncertainties from which on an error that is missing at one counts as missing. At zero it
# exists; between, the point at which it is lost is unknown, so half is assumed.
_LOST_FROM = 0.5
_SIDES = ("below", "above")
# Largest |c| of g ξ/(1 + c ξ): its pole is at least five standard uncertainties away.
_LARGEST_BEND = 0.2
# Fixed directions of force under which errors of any force are evaluated for all robots.
_FORCES = 8
# Halvings of an interval between two of 4096 points, down to rounding.
_HALVINGS = 50
# Most numbers of an array in memory.
_MOST_NUMBERS = 4_000_000


@dataclass(frozen=True, eq=False)
class Slope:
    """Errors of a quantity with one input a standard uncertainty below and above.

    `key` of the input in the robot file, `relative` its standard uncertainty. `below` and `above`
    have the shape of `ErrorOfInputs.nominal`, and NaN if the error is missing. `values` (2×P) are
    the model's value of the quantity below and above.
    """

    key: str
    relative: float
    below: Array
    above: Array
    values: Array


@dataclass(frozen=True, eq=False)
class ErrorOfInputs:
    """Errors with the inputs of the file, and their change with each input.

    `nominal` (R×P×f×k): components of errors, by R interpretations of the reference in P poses
    under f forces. If `signed`, k is two: the error and its half-width. Otherwise k is eight:
    displacements of the model (3) and of the reference (3), the smallest length to which the error
    is relative, and its half-width. `misfit`: root mean square deviation from robots with all
    inputs perturbed. `lost`: share of these robots without such an error although the slopes have
    one.
    """

    nominal: Array
    slopes: Sequence[Slope]
    signed: bool
    misfit: float = 0.0
    lost: float = 0.0

    def intervals(self, draws: Array) -> Array:
        """Lowest and highest error (n×2×P) for draws (n×inputs) of ξ. NaN if there is none."""
        rows = max(1, _MOST_NUMBERS // max(self.nominal.size, 1))
        pieces = np.split(draws, range(rows, len(draws), rows))
        return np.concatenate(
            [self._interval(_components_at(self.nominal, *self._ends, piece)) for piece in pieces]
        )

    def probabilities(
        self, limit: float | Array, reductions: Mapping[str, float] | None = None
    ) -> Array:
        """Probability of errors within the limit in all poses, and of one beyond it in some pose.

        `reductions`: factors on the inputs' standard uncertainties of the file, by key.
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
        """Half-width (95 %) of a pose's error due to inputs, about the error of the file.

        For a vector it is the radius that contains 95 % of its changes.
        """
        nominal, below, above = self._largest_components(pose)
        components = _components_at(nominal, below, above, _draws(len(self.slopes)))
        sizes = np.linalg.norm(self._vectors(components) - self._vectors(nominal), axis=-1)
        return float(np.nanquantile(sizes, CONFIDENCE))

    def _interval(self, components: Array) -> Array:
        """Lowest and highest error (n×2×P) from components (n×R×P×f×k)."""
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
        """Errors from components: vectors (…×3), or signed numbers (…×1) for frequencies."""
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
        """Components of errors with each input below and above (m×R×P×f×k each)."""
        below, above = ([getattr(slope, side) for slope in self.slopes] for side in _SIDES)
        return np.array(below), np.array(above)

    @property
    def losing_inputs(self) -> list[str]:
        """Inputs whose perturbation alone can remove the error (its mode is lost)."""
        sides = {slope.key: np.array([slope.below, slope.above]) for slope in self.slopes}
        return [key for key, ends in sides.items() if np.isnan(ends).any()]

    def shares(self, pose: int) -> dict[str, float]:
        """First-order Sobol' indices of the error of a pose, the largest first."""
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
        """Components (k) of a pose's largest error, and with each input below and above (m×k each).

        The largest error with the inputs of the file, of all interpretations and forces.
        """
        sizes = np.linalg.norm(self._vectors(self.nominal[:, pose]), axis=-1)
        interpretation, force = np.unravel_index(np.argmax(sizes), sizes.shape)
        position = interpretation, pose, force
        below, above = (ends[:, *position] for ends in self._ends)
        return self.nominal[position], below, above


def _components_at(nominal: Array, below: Array, above: Array, draws: Array) -> Array:
    """Components (n×…) for draws (n×m) of ξ, from `nominal` ones (…) with the inputs of the file.

    `below` and `above` (m×…) have one input a standard uncertainty below and above.
    """
    components = np.repeat(nominal[None], len(draws), axis=0)
    for low, high, draw in zip(below - nominal, above - nominal, draws.T, strict=True):
        components += _change(low, high, draw.reshape(-1, *[1] * nominal.ndim))
    return components


def _change(below: Array, above: Array, draw: Array) -> Array:
    """Change at ξ = `draw` of a number that changes by `below` at ξ = −1 and by `above` at ξ = 1.

    By g ξ/(1 + c ξ), the dependence of any linear response on one stiffness, or by g ξ + h ξ²/2 if
    the pole is too near. NaN on the side of a NaN, from `_LOST_FROM` on.
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
    """First and second derivative in ξ of a number that changes by `below` at −1, `above` at 1.

    Linear if the change is known on one side only, constant if it is unknown on both.
    """
    below, above = (
        np.nan_to_num(np.where(np.isnan(change), -other, change))
        for change, other in ((below, above), (above, below))
    )
    return 0.5 * (above - below), above + below


@dataclass(frozen=True)
class Probability:
    """Probability of a verdict under uncertain inputs.

    `within` and `beyond`: probability that the whole interval of the error is within, or beyond,
    the limit. The rest to one stays open even with exact inputs. Half-widths (95 %): `half_width`
    of the error, `value_half_width` of the model's own value (its unit), to first order. None if
    the value is lost within a standard uncertainty. `shares` are the first-order indices of the
    error's inputs. `decides` names the inputs to be known better.
    """

    within: float
    beyond: float
    half_width: float
    value_half_width: float | None
    shares: Mapping[str, float]
    decides: str = ""

    def settled(self, verdict: Adequacy) -> Adequacy:
        """Return the `verdict` by the inputs of the file, or undecided if it is too improbable."""
        probabilities = {"adequate": self.within, "inadequate": self.beyond}
        return verdict if probabilities.get(verdict, 1.0) >= CONFIDENCE else "undecided"


def probability(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, pose: int
) -> Probability:
    """Probability of a verdict by the inputs of the file. `pose`: index of its deciding pose."""
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


@dataclass(frozen=True, eq=False)
class UncertainInputs:
    """Errors of a robot's models with inputs perturbed, by the rules of the nominal errors.

    `nominal` compares the robot of the file.
    """

    nominal: ModelErrors
    inputs: InputUncertainties

    def error(
        self, model: Model, quantity: Quantity, nominal_errors: Errors
    ) -> ErrorOfInputs | None:
        """Change of a model's error of a quantity by inputs. None if there is no such error.

        The order of modes has none: it jumps.
        """
        if nominal_errors.numbers is not None or nominal_errors.missing.any():
            return None
        below, above, together = (
            [_robot_errors(robot, model, quantity) for robot in all_errors]
            for all_errors in self._model_errors
        )
        forces = None
        if quantity == ANY_FORCE:
            forces = _worst_forces([nominal_errors, *(robot.errors for robot in (*below, *above))])
        slopes = [
            Slope(
                key,
                relative,
                low.components(nominal_errors, forces),
                high.components(nominal_errors, forces),
                np.stack([low.value(nominal_errors), high.value(nominal_errors)]),
            )
            for (key, relative), low, high in zip(
                self.inputs.relative.items(), below, above, strict=True
            )
        ]
        nominal_robot = replace(_robot_errors(self.nominal, model, quantity), errors=nominal_errors)
        error = ErrorOfInputs(
            nominal_robot.components(nominal_errors, forces),
            slopes,
            nominal_errors.displacement is None,
        )
        expected = error.intervals(self.inputs.draws)
        deviations = np.array([robot.interval(nominal_errors) for robot in together]) - expected
        lost = np.isnan(deviations) & ~np.isnan(expected)
        squared = np.ma.masked_invalid(deviations**2).mean(axis=0).filled(0.0)
        return replace(
            error,
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
class _RobotErrors:
    """Errors of a model's quantity for one robot. `errors` is None if there are none.

    `statics` of the reference and of the model, for each interpretation, are the errors' source.
    """

    quantity: Quantity
    errors: Errors | None
    statics: Sequence[tuple[Statics, Statics]] = ()

    def components(self, nominal: Errors, forces: Array | None) -> Array:
        """Components as in `ErrorOfInputs.nominal`, under `forces` (P×f×6) if they are given."""
        errors, vectorial = self.errors, nominal.displacement is not None
        count = 1 if forces is None else forces.shape[1]
        shape = (*nominal.error.shape, count, 8 if vectorial else 2)
        if errors is None:
            return np.full(shape, np.nan)
        components = np.empty(shape)
        components[..., -1] = errors.farthest[..., None]
        if errors.displacement is None:
            components[..., 0] = errors.error[..., None]
            return components
        for k, (reference, model) in enumerate(self.statics):
            wrenches = errors.displacement.wrench[k, :, None] if forces is None else forces
            components[k, ..., :3] = model.displacements(self.quantity, wrenches)
            components[k, ..., 3:6] = reference.displacements(self.quantity, wrenches)
            least = FLOOR * np.linalg.norm(reference.compliances[:, :3, :3], 2, axis=(1, 2))
            components[k, ..., 6] = least[:, None] if forces is not None else 0.0
        return np.where(errors.missing[..., None, None], np.nan, components)

    def interval(self, nominal: Errors) -> Array:
        """Lowest and highest error (2×P)."""
        if self.errors is None:
            return np.full((2, nominal.error.shape[1]), np.nan)
        return np.stack(self.errors.interval)

    def value(self, nominal: Errors) -> Array:
        """Value (P) of the quantity by the model."""
        if self.errors is None:
            return np.full(nominal.error.shape[1], np.nan)
        return np.asarray(self.errors.value[0])


def _robot_errors(model_errors: ModelErrors, model: Model, quantity: Quantity) -> _RobotErrors:
    errors = model_errors.errors(model, quantity)
    return _RobotErrors(quantity, errors, model_errors.statics(model) if quantity.static else ())


def _worst_forces(errors: Sequence[Errors | None]) -> Array:
    """Worst forces (P×f×6) of several robots, at most `_FORCES` of them.

    The first is that of the first robot's largest error. Each next one is the force least aligned
    with those before it.
    """
    first = errors[0]
    loads = [
        robot_errors.displacement.wrench
        for robot_errors in errors
        if robot_errors is not None and robot_errors.displacement
    ]
    all_forces = np.concatenate(loads).transpose(1, 0, 2)
    selected = []
    for pose, forces in enumerate(all_forces):
        start = 0 if first is None else int(first.largest[pose])
        order, alignments = [start], np.abs(forces @ forces[start])
        while len(order) < min(_FORCES, len(forces)):
            order.append(int(np.argmin(alignments)))
            alignments = np.maximum(alignments, np.abs(forces @ forces[order[-1]]))
        selected.append(forces[order])
    return np.array(selected)


def _deciding_inputs(
    error: ErrorOfInputs, verdict: Adequacy, limit: float | Array, keys: Sequence[str]
) -> str:
    """Text on the inputs to be known better for a verdict: a single one, otherwise the first few.

    `keys` in the order of their shares. "" if all of them together do not decide it.
    """
    relative = {slope.key: slope.relative for slope in error.slopes}
    column = 0 if verdict == "adequate" else 1

    def lacking(reductions: Mapping[str, float]) -> float:
        return CONFIDENCE - float(error.probabilities(limit, reductions)[column])

    for key in keys:
        if lacking({key: 0.0}) > 0.0:
            continue
        # A share of points is a step function: to 0.01 of the uncertainty, on the safe side.
        factor = scipy.optimize.brentq(
            lambda reduction, key=key: lacking({key: reduction}), 0.0, 1.0, xtol=0.005
        )
        required = max(factor - 0.01, 0.0) * relative[key]
        return (
            f"{key} known to a standard uncertainty of {100.0 * required:.2g} % (now "
            f"{100.0 * relative[key]:.2g} %) would decide it"
        )
    for count in range(2, len(keys) + 1):
        if lacking(dict.fromkeys(keys[:count], 0.0)) <= 0.0:
            return f"better values of {' and '.join(keys[:count])} together would decide it"
    return ""


def _normal_shares(verdicts: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Probabilities (m) that verdicts (m×n) hold for a normal number, with draws (n×1).

    If a verdict changes between two of the points, the number at which it changes is bisected.
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
        # Between the changes, the verdict holds and does not hold in turn.
        probabilities.append(np.diff(ends)[0 if holds[0] else 1 :: 2].sum())
    return np.array(probabilities)


@memo(8)
def _draws(inputs: int) -> Array:
    """Normally distributed points (n×inputs) from Sobol' points."""
    points = scipy.stats.qmc.Sobol(inputs, seed=0).random_base2(_POWER)
    # The first point of the unscrambled sequence is the corner; the scrambled one has none.
    return np.asarray(scipy.special.ndtri(points), dtype=float)


def propagated(changes: Iterable[Sequence[float] | Array]) -> float:
    """Standard uncertainty from independent inputs, to first order (GUM, eq. (10)).

    `changes` are the model's values with one input at a time a standard uncertainty below and
    above its value in the file.
    """
    slopes = np.array([0.5 * (above - below) for below, above in changes])
    return float(combined(slopes, np.abs, Combiner.ROOT_OF_SQUARES))
