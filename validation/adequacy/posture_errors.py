"""Compliances and frequencies of all models in given postures, with their errors, for curves.

Input: a robot in postures. Output: `Compared`, which has values and relative differences by name of
the model, for tables and curves. Rule: the reference is the model of solids under its first
interpretation; the other interpretations are compared with it like models. The differences are
those of `ModelErrors`, on which verdicts are based.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from lumped.acceptance.quantities import AXES, FREQUENCIES, UNIT_LOADS, Quantity
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.judged_models import JUDGED, judged_models, judged_models_of
from validation.adequacy.model_errors import ModelErrors
from validation.adequacy.robot_verdicts import subject_of
from validation.models.options import STATIC
from validation.references.modal_reference import dynamic_reference
from validation.references.model_ladder import SOLID
from validation.references.reference import Interpretation, Reference, Source
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import NOMINAL, Reading, RobotOnPath
from validation.references.static_reference import static_reference
from validation.responses.mode_partners import frequency_changes
from validation.responses.statics_and_modes import PathModes

# Models in display order, from the bottom of a stack of curves to its top.
_STATIC_STACK = tuple(name for name, model in JUDGED.items() if model.plotted)
_DYNAMIC_STACK = tuple(name for name in _STATIC_STACK if JUDGED[name].kind not in STATIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """Values of k quantities in P postures: first those of the models, then of the reference.

    `values` (P×k, SI units), by name of the model or, for the reference, of its interpretation.
    `against`: name of the first interpretation of the reference. `differences` (P×k): relative
    differences from this interpretation, of all models and other interpretations; NaN if there is
    no number to compare. `objectives` (P×j): values whose extreme over the path decides between
    designs: lengths (m/N) of the displacements under unit forces along x, y and z, or the first
    frequency (Hz). `uncertainties`: relative half-widths of the reference by name of the
    interpretation, of which the first j columns belong to the objectives. If legs are specified by
    their 6×6 compliance, those of frequencies cover every plausible mass distribution and stiffness
    inside the legs.
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str
    objectives: Mapping[str, Array] = field(default_factory=dict)
    uncertainties: Mapping[str, Array] = field(default_factory=dict)


def compared_models(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the models compared in statics, and of those compared in frequencies."""
    judged = judged_models(mechanism)
    static, dynamic = (
        tuple(name for name in stack if name in judged) for stack in (_STATIC_STACK, _DYNAMIC_STACK)
    )
    return static, dynamic


def compared_compliances(robot: RobotOnPath) -> Compared:
    """Compliances of all models and of the reference: the diagonals of the 6×6 matrices (P×6, SI).

    They are displacements along, and rotations about, each base axis under a unit load along or
    about the same axis. Half-widths are due to the meshes and to the digits of the robot file.
    Raises InputError or ComputationError if there is no reference, and ComputationError if a model
    is unsolved. Array sizes: P postures.
    """
    responses = Responses(robot)
    reference = static_reference(responses)
    models = [model for model in _models_of_stack(robot, _STATIC_STACK) if model.statics]
    uncertainties = {}
    for interpretation in reference.interpretations:
        name = f"solid, {interpretation.name}" if robot.has_solids else "specified 6×6 of the legs"
        models.append(_reference_model(responses, name, interpretation.reading))
        half_widths = [
            half_width.displacements
            for source in (Source.MESHES, Source.DIGITS)
            if (half_width := interpretation.budget.get(source))
            and half_width.displacements is not None
        ]
        uncertainties[name] = np.asarray(np.sum(half_widths, axis=0))
    compliances = {
        model.name: responses.required_statics(model, NOMINAL).compliances for model in models
    }
    subject = subject_of(responses, models, statics=_under_first_reading(reference))
    against = next(iter(uncertainties))
    return Compared(
        {name: np.diagonal(matrices, axis1=1, axis2=2) for name, matrices in compliances.items()},
        _differences(ModelErrors(subject, modes=0), UNIT_LOADS[: len(AXES)], against),
        against,
        {
            name: np.linalg.norm(matrices[:, :3, :3], axis=1)
            for name, matrices in compliances.items()
        },
        uncertainties,
    )


def compared_frequencies(robot: RobotOnPath) -> Compared:
    """First natural frequencies (P×k, Hz, ascending) of all models and of the reference.

    Each difference is between modes of the same shape. Raises InputError or ComputationError if
    there is no reference, and ComputationError if a model is unsolved. Array sizes: P postures, k
    judged frequencies.
    """
    responses, judged = Responses(robot), robot.judged_count
    modes_by_name = solved_modes(responses)
    reference = dynamic_reference(responses)
    if not reference.interpretations:
        raise InputError(reference.decides)
    models = [
        model for model in _models_of_stack(robot, _DYNAMIC_STACK) if model.name in modes_by_name
    ]
    uncertainties = {}
    for name, (first, *further) in _grouped_by_ends(reference).items():
        models.append(_reference_model(responses, name, first.reading))
        modes_by_name[name] = responses.required_modes(SOLID, first.reading)
        changes = [
            frequency_changes(
                modes_by_name[name], responses.required_modes(SOLID, other.reading), judged
            )
            for other in further
        ]
        half_widths = np.asarray(first.frequency_half_widths(judged))
        uncertainties[name] = half_widths + np.nanmax(
            [np.zeros_like(half_widths), *changes], axis=0
        )
    subject = subject_of(responses, models, dynamics=_under_first_reading(reference))
    against = next(iter(uncertainties))
    frequencies = {name: modes.frequencies[:, :judged] for name, modes in modes_by_name.items()}
    return Compared(
        frequencies,
        _differences(ModelErrors(subject, judged), FREQUENCIES[:judged], against),
        against,
        {name: values[:, :1] for name, values in frequencies.items()},
        uncertainties,
    )


def _grouped_by_ends(reference: Reference) -> dict[str, list[Interpretation]]:
    """Groups of interpretations that differ only in mass or stiffness inside the legs.

    The key is the name of the first interpretation of a group.
    """
    groups: dict[Reading, list[Interpretation]] = {}
    for interpretation in reference.interpretations:
        groups.setdefault(interpretation.reading.restricted(("ends",)), []).append(interpretation)
    return {
        first.name if reference.supposed else f"solid, {first.name}": [first, *further]
        for first, *further in groups.values()
    }


def _reference_model(responses: Responses, name: str, reading: Reading) -> Model:
    """The reference under one `reading` of the robot file, as a model compared like any other."""
    return Model(
        name,
        statics=lambda *_: responses.required_statics(SOLID, reading),
        modes=lambda *_: responses.required_modes(SOLID, reading),
    )


def _under_first_reading(reference: Reference) -> Reference:
    return replace(reference, interpretations=reference.interpretations[:1])


def _differences(
    errors: ModelErrors, quantities: Sequence[Quantity], against: str
) -> dict[str, Array]:
    """Relative differences (P×k) of k quantities, by name of each model except `against`.

    NaN if the reference has the value zero. Array sizes: P postures.
    """
    differences = {}
    for model in errors.subject.models:
        if model.name != against:
            compared = [errors.required_errors(model, quantity) for quantity in quantities]
            values, expected = (
                np.stack([getattr(quantity_errors, name)[0] for quantity_errors in compared], 1)
                for name in ("value", "expected")
            )
            differences[model.name] = values / np.where(expected != 0.0, expected, np.nan) - 1.0
    return differences


def solved_modes(responses: Responses) -> dict[str, PathModes]:
    """Modes of all models that define modes, by name.

    Raises ComputationError if one of these models is unsolved.
    """
    return {
        model.name: responses.required_modes(model, NOMINAL)
        for model in _models_of_stack(responses.robot, _DYNAMIC_STACK)
        if responses.modes(model, NOMINAL)
    }


def _models_of_stack(robot: RobotOnPath, stack: Sequence[str]) -> list[Model]:
    recipes = judged_models(robot.mechanism)
    by_name = judged_models_of(robot, {name: recipes[name] for name in stack if name in recipes})
    return list(by_name.values())
