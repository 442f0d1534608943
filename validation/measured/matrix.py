"""Verdicts on the models of a robot against measured values.

Input: measured values D with standard uncertainties, and values S of each model in the same poses.
Output: a matrix of verdicts. Rule (ASME V&V 20-2009, sections 1-5 and 6): the comparison error is E
= S − D, and u_val² = u_num² + u_input² + u_D² of three independent standard uncertainties. The
error of the model lies within E ± k u_val. The model is adequate if that interval is within the
limit, inadequate if it is beyond it on one side, otherwise undecided.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot, isfinite
from typing import Any, NamedTuple

import numpy as np
from msgspec import structs

from lumped.acceptance.measured import Measured, ModalTest
from lumped.acceptance.quantities import AXES, Quantity
from lumped.acceptance.requirement import Requirement
from lumped.errors import ComputationError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from validation.adequacy.judged_models import JudgedModel, judged_models
from validation.adequacy.probability import COVERAGE, propagated
from validation.case import failure_reason
from validation.context import Context
from validation.measured.modes import Partner, modal_prediction
from validation.models.leg_models import leg_compliance
from validation.models.options import OF_ELEMENTS, STATIC, ModelName, ModelOptions
from validation.references.model_ladder import formulation, with_elements
from validation.references.responses import UNSOLVED, Model, Responses
from validation.references.robot_on_path import (
    NOMINAL,
    Reading,
    coordinates,
    robot_at,
    why_not_serial,
)
from validation.uncertainty.half_widths import MeshPolicy
from validation.verdicts import Adequacy, Entry, Matrix, ModelNote, worst_of

# Second order in the element count n: the error of n elements is 4/3 of the change to 2n.
_DOUBLING = MeshPolicy.of_order(0.5, 2.0, safety=1.0)
# Ratio to the measured value beyond which a wrong unit (g, millimetres) is more likely than an
# error of the model.
_WRONG_UNIT_RATIO = 5.0


@dataclass(frozen=True)
class Comparison:
    """A model's value S and a measured value D, with standard uncertainties, all in one unit.

    `value`: S. `measured`: D. `numerical`: standard uncertainty of S due to the model's
    discretisation. `inputs`: standard uncertainty of S due to uncertain inputs of the robot.
    `measurement`: standard uncertainty of D. All properties are relative to |D|.
    """

    value: float
    measured: float
    numerical: float
    inputs: float
    measurement: float

    @property
    def error(self) -> float:
        """Comparison error E = S − D, relative to |D|."""
        return (self.value - self.measured) / abs(self.measured)

    @property
    def uncertainties(self) -> dict[str, float]:
        """Half-widths of 95 % intervals by source of uncertainty, relative to |D|."""
        parts = {
            "numerics": self.numerical,
            "inputs": self.inputs,
            "measurement": self.measurement,
        }
        return {name: COVERAGE * part / abs(self.measured) for name, part in parts.items()}

    @property
    def uncertainty(self) -> float:
        """Half-width k u_val relative to |D|: the error lies within E ± k u_val (95 %)."""
        return hypot(*self.uncertainties.values())

    @property
    def low(self) -> float:
        """Lower end of the interval of the error."""
        return self.error - self.uncertainty

    @property
    def high(self) -> float:
        """Upper end of the interval of the error."""
        return self.error + self.uncertainty

    def verdict(self, limit: float) -> Adequacy:
        """Verdict for a relative `limit`.

        Adequate if the whole interval lies within ± the limit, inadequate if all of it lies beyond
        the limit on one side, otherwise undecided.
        """
        size = abs(self.error)
        if size + self.uncertainty <= limit:
            return "adequate"
        return "inadequate" if size - self.uncertainty > limit else "undecided"


class _RobotInPose(NamedTuple):
    """Responses of the robot in one pose, and its models by name."""

    responses: Responses
    models: Mapping[str, Model]


@dataclass(frozen=True, eq=False)
class Predictions:
    """Values of a robot's models for the quantities that were measured.

    `judged_by_name`: the judged models. `inputs`: relative standard uncertainties of uncertain
    inputs, by key in the robot file.
    """

    context: Context
    judged_by_name: Mapping[str, JudgedModel]
    inputs: Mapping[str, float]
    _robots: dict[tuple[float, ...], _RobotInPose] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, context: Context) -> "Predictions":
        """Predictions of all judged models.

        Raises InputError if a change of an uncertain input makes the robot invalid.
        """
        robot_file = context.robot_file
        inputs = robot_file.uncertain_inputs
        for key, share in inputs.items():
            for direction in (-1, 1):
                robot_file.with_factors({key: direction * share})
        return cls(context, judged_models(robot_file.mechanism), inputs)

    def value(self, name: str, measured: Measured, reading: Reading = NOMINAL) -> float | None:
        """Value of a model for a measured quantity, in the unit of the measured value.

        None if the model does not define it. Raises InputError or ComputationError if it cannot be
        computed.
        """
        quantity = measured.quantity
        if measured.of_leg or measured.test is not None:
            return self._leg_or_test_value(self.judged_by_name[name], measured, reading)
        responses, models = self._robot_in(measured.pose)
        model = models[name]
        if quantity.static and model.statics:
            statics = responses.required_statics(model, reading)
            return measured.load * float(statics.compliances[0, quantity.column, quantity.column])
        if quantity.static or not model.modes or not responses.modes(model, reading):
            return None
        modes = responses.required_modes(model, reading)
        values = modes.peaks if quantity.harmonic else modes.frequencies
        number = float(values[0, quantity.column])
        return number if isfinite(number) else None

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of the models whose statics or modes ended with an error of the program."""
        return tuple(name for in_pose in self._robots.values() for name in in_pose.responses.faults)

    def _leg_or_test_value(
        self, judged_model: JudgedModel, measured: Measured, reading: Reading
    ) -> float | None:
        """Value of a model for an entry of a leg's 6×6, or for a quantity of a modal test.

        None if the model does not define it.
        """
        robot_file, options = self.context.robot_file, with_elements(judged_model.options, reading)
        robot = robot_file.mechanism
        if reading.factors:
            robot = robot_file.with_factors(dict(reading.factors))
        if measured.test is not None:
            return _test_value(judged_model.kind, robot, measured, measured.test, options)
        entry = divmod(measured.quantity.column, len(AXES))
        leg = legs_of(robot)[measured.quantity.leg]
        rigid = judged_model.kind == "simplified"
        return None if rigid else float(leg_compliance(judged_model.kind, leg, options)[entry])

    def _robot_in(self, pose: tuple[float, ...]) -> _RobotInPose:
        """The robot in a pose. Raises InputError if the pose is out of reach."""
        if pose not in self._robots:
            postures = [posture(self.context.robot_file.mechanism, np.array(pose))]
            robot = robot_at(self.context, postures)
            models = {
                name: _restricted(
                    postures,
                    formulation(name, judged_model.kind, judged_model.options),
                    judged_model,
                )
                for name, judged_model in self.judged_by_name.items()
            }
            self._robots[pose] = _RobotInPose(Responses(robot), models)
        return self._robots[pose]


def _restricted(postures: Sequence[Posture], model: Model, judged_model: JudgedModel) -> Model:
    """Copy of `model` without statics or modes that are not defined for this robot."""
    if judged_model.kind == "vjm" and why_not_serial(postures):
        return replace(model, statics=None, modes=None)
    return replace(model, modes=None) if judged_model.kind in STATIC else model


def measured_matrix(context: Context) -> Matrix:
    """Verdicts on each model for each measured quantity, in the poses of the measurements."""
    robot_file, robot = context.robot_file, context.robot_file.mechanism
    predictions = Predictions.of(context)
    values = robot_file.measured
    quantities = tuple(dict.fromkeys(measured.quantity for measured in values))
    poses = tuple(sorted({measured.pose for measured in values if measured.pose}))
    entries, faults = [], []
    for name in predictions.judged_by_name:
        for quantity in quantities:
            same_quantity = [measured for measured in values if measured.quantity == quantity]
            comparisons: dict[Measured, Comparison] = {}
            pairs: dict[Measured, Partner | None] = {}
            reasons: dict[Measured, str] = {}
            for measured in same_quantity:
                try:
                    if comparison := _comparison(predictions, name, measured):
                        pairs[measured] = _partner(predictions, name, measured)
                        comparisons[measured] = comparison
                except UNSOLVED as error:
                    reasons[measured] = str(error)
                except Exception as error:  # noqa: BLE001  loses this value of one model alone
                    reasons[measured] = failure_reason(f"{quantity} by {name}", error)
                    faults.append(name)
            if comparisons:
                entry = _entry(name, quantity, comparisons, robot_file.requirement, poses, pairs)
                entries.append(_with_missing_values(entry, reasons))
            elif reasons:
                entries.append(
                    _entry_without_values(name, quantity, reasons, robot_file.requirement)
                )
    return Matrix(
        robot=robot.name,
        coordinates=coordinates(robot),
        poses=poses,
        models=tuple(
            ModelNote(name, judged_model.title)
            for name, judged_model in predictions.judged_by_name.items()
        ),
        quantities=quantities,
        entries=tuple(entries),
        faults=tuple(dict.fromkeys((*faults, *predictions.faults))),
    )


def _entry_without_values(
    model: str, quantity: Quantity, reasons: Mapping[Measured, str], requirement: Requirement
) -> Entry:
    """Undecided entry for a quantity of which a model computed no value, with the `reasons`."""
    measured, reason = next(iter(reasons.items()))
    return Entry(
        model=model,
        quantity=quantity,
        limit=requirement.limit(quantity),
        verdict="undecided",
        pose=measured.pose,
        reference=f"measured: {measured.source}",
        reason=f"{model} has no solution: {reason}",
        measured=True,
    )


def _with_missing_values(entry: Entry, reasons: Mapping[Measured, str]) -> Entry:
    """Entry changed to undecided if the model could not compute some values that were measured.

    `reasons`: reason why the model has no value, for each measured value concerned. The entry is
    unchanged if `reasons` is empty, or if the entry is inadequate.
    """
    if not reasons or entry.verdict == "inadequate":
        return entry
    reason = f"{entry.model} has no solution for some values: {next(iter(reasons.values()))}"
    return structs.replace(entry, verdict="undecided", reason=reason)


def _test_value(
    model: ModelName, robot: Mechanism, measured: Measured, test: ModalTest, options: ModelOptions
) -> float | None:
    """Value of a model for a modal test: frequency of a mode, or magnitude of a response.

    The magnitude is the part of the model's complex response that is in phase with the measured
    response. None if the model has no such value.
    """
    prediction = modal_prediction(model, robot, test, options)
    frequency = measured.frequency
    if frequency is None and (partner := prediction.partners[measured.column]):
        frequency = partner.frequency
    if measured.response is None or frequency is None or not prediction.responses:
        return frequency if measured.response is None else None
    with np.errstate(divide="ignore", invalid="ignore"):
        (value,) = prediction.responses[measured.response].receptance(np.array([frequency]))
    in_phase = float((value * np.exp(-1j * measured.phase)).real)
    return in_phase if isfinite(in_phase) else None


def _partner(predictions: Predictions, name: str, measured: Measured) -> Partner | None:
    """Mode of the model that is the partner of a measured mode. None if there is none."""
    if measured.test is None or measured.frequency is not None:
        return None
    judged_model, robot = predictions.judged_by_name[name], predictions.context.robot_file.mechanism
    prediction = modal_prediction(judged_model.kind, robot, measured.test, judged_model.options)
    return prediction.partners[measured.column]


def _comparison(predictions: Predictions, name: str, measured: Measured) -> Comparison | None:
    value = predictions.value(name, measured)
    if value is None:
        return None

    def perturbed(change: str, **changes: Any) -> float:
        return _required(predictions.value(name, measured, replace(NOMINAL, **changes)), change)

    changes = [
        [
            perturbed(
                f"{key} changed by one standard deviation", factors=((key, direction * share),)
            )
            for direction in (-1, 1)
        ]
        for key, share in predictions.inputs.items()
    ]
    numerical = 0.0
    if (judged_model := predictions.judged_by_name[name]).kind in OF_ELEMENTS:
        finer = perturbed(f"{2 * judged_model.options.elements} elements", elements=2)
        # The estimate is the half-width of a 95 % interval.
        numerical = _DOUBLING.half_width(value - finer) / COVERAGE
    return Comparison(value, measured.value, numerical, propagated(changes), measured.uncertainty)


def _required(value: float | None, changed: str) -> float:
    """Value of a model after a change. Raises ComputationError if `value` is None.

    `changed`: text on the change, for the message. Without this check, a missing value would count
    as an uncertainty of zero or of 100 %.
    """
    if value is None:
        raise ComputationError(f"uncertainty unknown: the model has no solution with {changed}")
    return value


def _entry(
    model: str,
    quantity: Quantity,
    comparisons: Mapping[Measured, Comparison],
    requirement: Requirement,
    poses: Sequence[tuple[float, ...]],
    pairs: Mapping[Measured, Partner | None],
) -> Entry:
    limit = requirement.limit(quantity)
    verdict = worst_of([comparison.verdict(limit) for comparison in comparisons.values()])
    # The largest error decides, over all values and over several values in one pose.
    ordered = sorted(comparisons.items(), key=lambda item: abs(item[1].error), reverse=True)
    worst, deciding = next(item for item in ordered if item[1].verdict(limit) == verdict)
    by_pose = [
        next((comparison for measured, comparison in ordered if measured.pose == pose), None)
        for pose in poses
    ]
    mode_partner = pairs[worst]
    reason = mode_partner.reason if mode_partner else ""
    ratio = deciding.value / worst.value
    if worst.response is not None and ratio < 0.0:
        reason = reason or (
            "the response has the opposite sign of the measurement; check sign and "
            "direction in the test"
        )
    entry = Entry(
        model=model,
        quantity=quantity,
        limit=limit,
        verdict="undecided",
        pose=worst.pose,
        reference=f"measured: {worst.source}",
        reason=reason,
        expected=worst.value,
        measured=True,
        mac=mode_partner and mode_partner.mac,
        computed_by=("validation.measured.matrix.Predictions.value", "validation.measured.matrix"),
    )
    if reason:
        # Modes of different shape and values of opposite sign cannot be compared.
        return entry
    if worst.response is not None and not 1.0 / _WRONG_UNIT_RATIO < ratio < _WRONG_UNIT_RATIO:
        reason = f"{ratio:.3g} times the measured value; check the unit"
    elif verdict == "undecided":
        reason = (
            "undecided because of the uncertainties of measurement and model; reduce the "
            "largest one"
        )
    return structs.replace(
        entry,
        verdict=verdict,
        reason=reason,
        error=deciding.error,
        uncertainty=deciding.uncertainty,
        low=deciding.low,
        high=deciding.high,
        value=deciding.value,
        uncertainties=deciding.uncertainties,
        errors=tuple(comparison and comparison.error for comparison in by_pose),
        lows=tuple(comparison and comparison.low for comparison in by_pose),
        highs=tuple(comparison and comparison.high for comparison in by_pose),
        values=tuple(comparison and comparison.value for comparison in by_pose),
    )
