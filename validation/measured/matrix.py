"""What every model of a robot says of the measured values, and how they compare.

By comparison error and validation uncertainty (ASME V&V 20-2009, sections 1-5 and 6): the model's
error δ lies within E ± k u_val, where E = S − D is what the model gives less what was measured and
u_val² = u_num² + u_input² + u_D², three independent standard uncertainties.
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
from validation.measured.modes import Partner, modal_answer
from validation.models.leg_models import leg_compliance
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.references.model_ladder import formulation, with_elements
from validation.references.responses import UNSOLVED, Model, Responses
from validation.references.robot_on_path import (
    NOMINAL,
    Reading,
    coordinates,
    robot_at,
    why_not_serial,
)
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths
from validation.verdicts import Adequacy, Entry, Matrix, ModelNote, worst_of

# Models of elements; the others have none and no discretisation.
_OF_ELEMENTS = ("segments", "beam")
# Second order in the number of elements: the error of n of them is 4/3 of what 2n change.
_DOUBLED = MeshPolicy.of_order(0.5, 2.0, safety=1.0)
# No model is off by so much: accelerations in g are, and millimetres.
_OF_UNITS = 5.0


@dataclass(frozen=True)
class Comparison:
    """A model's value S and a measured one D with standard uncertainties, all in one unit.

    `numerical` is that of the model's discretisation, `inputs` what the uncertain inputs of the
    robot make of it, `measurement` that of D. What they say of the model is relative to |D|.
    """

    value: float
    measured: float
    numerical: float
    inputs: float
    measurement: float

    @property
    def error(self) -> float:
        """E = S − D."""
        return (self.value - self.measured) / abs(self.measured)

    @property
    def uncertainties(self) -> dict[str, float]:
        """Half-widths of 95 % intervals by where they come from."""
        parts = {
            "numerics": self.numerical,
            "inputs": self.inputs,
            "measurement": self.measurement,
        }
        return {name: COVERAGE * part / abs(self.measured) for name, part in parts.items()}

    @property
    def uncertainty(self) -> float:
        """K u_val: the model's error lies within E ± this with 95 % confidence."""
        return hypot(*self.uncertainties.values())

    def verdict(self, limit: float) -> Adequacy:
        """By the relative `limit`.

        Adequate where the whole interval lies within it, inadequate where all of it lies without,
        on one side; else undecided.
        """
        size = abs(self.error)
        if size + self.uncertainty <= limit:
            return "adequate"
        return "inadequate" if size - self.uncertainty > limit else "undecided"


class _Place(NamedTuple):
    """The robot in one pose, and its models by name."""

    responses: Responses
    models: Mapping[str, Model]


@dataclass(frozen=True, eq=False)
class Predictions:
    """Numbers of a robot's models for its measured values.

    `recipes` of the models by name; `inputs`: relative standard uncertainties of uncertain inputs.
    """

    context: Context
    recipes: Mapping[str, JudgedModel]
    inputs: Mapping[str, float]
    _places: dict[tuple[float, ...], _Place] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, context: Context) -> "Predictions":
        """Predictions of all models that are judged; InputError if an input leads to no robot."""
        robot_file = context.robot_file
        inputs = robot_file.uncertain_inputs
        for key, share in inputs.items():
            for direction in (-1, 1):
                robot_file.with_factors({key: direction * share})
        return cls(context, judged_models(robot_file.mechanism), inputs)

    def value(self, name: str, one: Measured, reading: Reading = NOMINAL) -> float | None:
        """Number of a model for a measured value, in its unit. None if the model has none.

        Raises InputError or ComputationError if it cannot be computed.
        """
        quantity = one.quantity
        if one.of_leg or one.test is not None:
            return self._of_mechanism(self.recipes[name], one, reading)
        responses, models = self._place(one.pose)
        model = models[name]
        if quantity.static and model.statics:
            statics = responses.required_statics(model, reading)
            return one.load * float(statics.compliances[0, quantity.column, quantity.column])
        if quantity.static or not model.modes or not responses.modes(model, reading):
            return None
        modes = responses.required_modes(model, reading)
        values = modes.peaks if quantity.harmonic else modes.frequencies
        number = float(values[0, quantity.column])
        return number if isfinite(number) else None

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of the models with a response that ended with an error of the program."""
        return tuple(name for place in self._places.values() for name in place.responses.faults)

    def _of_mechanism(self, recipe: JudgedModel, one: Measured, reading: Reading) -> float | None:
        """Number for an entry of a leg's 6×6 or for a modal test."""
        robot_file, options = self.context.robot_file, with_elements(recipe.options, reading)
        robot = robot_file.mechanism
        if reading.factors:
            robot = robot_file.with_factors(dict(reading.factors))
        if one.test is not None:
            return _of_test(recipe.kind, robot, one, one.test, options)
        place = divmod(one.quantity.column, len(AXES))
        leg = legs_of(robot)[one.quantity.leg]
        rigid = recipe.kind == "simplified"
        return None if rigid else float(leg_compliance(recipe.kind, leg, options)[place])

    def _place(self, pose: tuple[float, ...]) -> _Place:
        """The robot in a pose; raises InputError if it cannot take it."""
        if pose not in self._places:
            at = [posture(self.context.robot_file.mechanism, np.array(pose))]
            robot = robot_at(self.context, at)
            models = {
                name: _defined(at, formulation(name, recipe.kind, recipe.options), recipe)
                for name, recipe in self.recipes.items()
            }
            self._places[pose] = _Place(Responses(robot), models)
        return self._places[pose]


def _defined(at: Sequence[Posture], model: Model, recipe: JudgedModel) -> Model:
    """The model without the halves that it does not define."""
    if recipe.kind == "vjm" and why_not_serial(at):
        return replace(model, statics=None, modes=None)
    return replace(model, modes=None) if recipe.kind in STATIC else model


def measured_matrix(context: Context) -> Matrix:
    """Every model by every measured quantity; the poses are those of the measurements."""
    robot_file, robot = context.robot_file, context.robot_file.mechanism
    predictions = Predictions.of(context)
    ones = robot_file.measured
    quantities = tuple(dict.fromkeys(one.quantity for one in ones))
    poses = tuple(sorted({one.pose for one in ones if one.pose}))
    entries, faults = [], []
    for name in predictions.recipes:
        for quantity in quantities:
            alike = [one for one in ones if one.quantity == quantity]
            found: dict[Measured, Comparison] = {}
            pairs: dict[Measured, Partner | None] = {}
            refused: dict[Measured, str] = {}
            for one in alike:
                try:
                    if comparison := _compared(predictions, name, one):
                        pairs[one] = _partner(predictions, name, one)
                        found[one] = comparison
                except UNSOLVED as error:
                    refused[one] = str(error)
                except Exception as error:  # noqa: BLE001  loses this value of one model alone
                    refused[one] = failure_reason(f"{quantity} by {name}", error)
                    faults.append(name)
            if found:
                entry = _entry(name, quantity, found, robot_file.requirement, poses, pairs)
                entries.append(_with_refusals(entry, refused))
            elif refused:
                entries.append(_refused(name, quantity, refused, robot_file.requirement))
    return Matrix(
        robot=robot.name,
        coordinates=coordinates(robot),
        poses=poses,
        models=tuple(ModelNote(name, one.title) for name, one in predictions.recipes.items()),
        quantities=quantities,
        entries=tuple(entries),
        faults=tuple(dict.fromkeys((*faults, *predictions.faults))),
    )


def _refused(
    model: str, quantity: Quantity, refused: Mapping[Measured, str], requirement: Requirement
) -> Entry:
    """The entry of a quantity of which a model computes no value: undecided, and why."""
    one, reason = next(iter(refused.items()))
    return Entry(
        model=model,
        quantity=quantity,
        limit=requirement.limit(quantity),
        verdict="undecided",
        pose=one.pose,
        reference=f"measured: {one.source}",
        reason=f"{model} cannot be computed: {reason}",
        measured=True,
    )


def _with_refusals(entry: Entry, refused: Mapping[Measured, str]) -> Entry:
    """The entry as it is if some of its measured values cannot be computed: not adequate."""
    if not refused or entry.verdict == "inadequate":
        return entry
    reason = f"{entry.model} cannot be computed for all values: {next(iter(refused.values()))}"
    return structs.replace(entry, verdict="undecided", reason=reason)


def _of_test(
    model: ModelName, robot: Mechanism, one: Measured, test: ModalTest, options: ModelOptions
) -> float | None:
    """The model's frequency of a mode of a test, or its part of a response in phase with it."""
    answer = modal_answer(model, robot, test, options)
    where = one.frequency
    if where is None and (partner := answer.partners[one.column]):
        where = partner.frequency
    if one.response is None or where is None or not answer.responses:
        return where if one.response is None else None
    with np.errstate(divide="ignore", invalid="ignore"):
        (value,) = answer.responses[one.response].receptance(np.array([where]))
    size = float((value * np.exp(-1j * one.phase)).real)
    return size if isfinite(size) else None


def _partner(predictions: Predictions, name: str, one: Measured) -> Partner | None:
    """The mode of the model that a mode of a test is."""
    if one.test is None or one.frequency is not None:
        return None
    recipe, robot = predictions.recipes[name], predictions.context.robot_file.mechanism
    return modal_answer(recipe.kind, robot, one.test, recipe.options).partners[one.column]


def _compared(predictions: Predictions, name: str, one: Measured) -> Comparison | None:
    value = predictions.value(name, one)
    if value is None:
        return None

    def perturbed(what: str, **changes: Any) -> float:
        return _required(predictions.value(name, one, replace(NOMINAL, **changes)), what)

    changes = [
        [
            perturbed(f"{key} a standard deviation off", factors=((key, direction * share),))
            for direction in (-1, 1)
        ]
        for key, share in predictions.inputs.items()
    ]
    numerical = 0.0
    if (recipe := predictions.recipes[name]).kind in _OF_ELEMENTS:
        finer = perturbed(f"{2 * recipe.options.elements} elements", elements=2)
        # The estimate is a half-width of 95 %.
        numerical = float(mesh_half_widths([np.abs(value - finer)], _DOUBLED)) / COVERAGE
    return Comparison(value, one.value, numerical, propagated(changes), one.uncertainty)


def _required(value: float | None, changed: str) -> float:
    """The value of a changed model; raises ComputationError if it has none.

    A missing value would count as a part of the uncertainty that is zero, or all of the value.
    """
    if value is None:
        raise ComputationError(f"its uncertainty is not known: it has no value with {changed}")
    return value


def _entry(
    model: str,
    quantity: Quantity,
    found: Mapping[Measured, Comparison],
    requirement: Requirement,
    poses: Sequence[tuple[float, ...]],
    pairs: Mapping[Measured, Partner | None],
) -> Entry:
    limit = requirement.limit(quantity)
    verdict = worst_of([compared.verdict(limit) for compared in found.values()])
    # The farthest off decides, of the whole and of several in one pose.
    ordered = sorted(found.items(), key=lambda pair: abs(pair[1].error), reverse=True)
    worst, compared = next(pair for pair in ordered if pair[1].verdict(limit) == verdict)
    at = [next((own for one, own in ordered if one.pose == pose), None) for pose in poses]
    pair = pairs[worst]
    reason = pair.reason if pair else ""
    share = compared.value / worst.value
    if worst.response is not None and share < 0.0:
        reason = (
            reason or "moves the other way than measured: is a sign or direction of the test wrong?"
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
        mac=pair and pair.mac,
        computed_by=("validation.measured.matrix.predicted", "validation.measured.matrix"),
    )
    if reason:
        # Modes that are not alike, and signs that are not, cannot be compared.
        return entry
    if worst.response is not None and not 1.0 / _OF_UNITS < share < _OF_UNITS:
        reason = f"{share:.3g} times what was measured: is a unit wrong?"
    elif verdict == "undecided":
        reason = "needs a smaller validation uncertainty"
    return structs.replace(
        entry,
        verdict=verdict,
        reason=reason,
        error=compared.error,
        uncertainty=compared.uncertainty,
        low=compared.error - compared.uncertainty,
        high=compared.error + compared.uncertainty,
        value=compared.value,
        uncertainties=compared.uncertainties,
        errors=tuple(own.error if own else None for own in at),
        spreads=tuple(own.uncertainty if own else None for own in at),
        lows=tuple(own.error - own.uncertainty if own else None for own in at),
        highs=tuple(own.error + own.uncertainty if own else None for own in at),
        values=tuple(own.value if own else None for own in at),
    )
