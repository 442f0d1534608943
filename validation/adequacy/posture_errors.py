"""Compliances and frequencies of all models in given postures, compared with solid models.

Input: a robot in postures. Output: `Compared`, which has values and relative differences by name of
the model, for tables and curves. Rule: the reference is the model of solids under its first
interpretation; frequencies are compared between modes of the same shape.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.judged_models import JUDGED, judged_models, judged_models_of
from validation.models.options import STATIC
from validation.references.modal_reference import dynamic_reference
from validation.references.model_ladder import SOLID
from validation.references.reference import Interpretation, Reference, Source
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import NOMINAL, Reading, RobotOnPath
from validation.references.static_reference import static_reference
from validation.responses.mode_partners import frequency_changes, partners
from validation.responses.statics_and_modes import PathModes, Statics

# Models in display order, from the bottom of a stack of curves to its top.
_STATIC_STACK = tuple(name for name, model in JUDGED.items() if model.plotted)
_DYNAMIC_STACK = tuple(name for name in _STATIC_STACK if JUDGED[name].kind not in STATIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """Values of k quantities in P postures: first those of the models, then of the reference.

    `values` (P×k, SI units), by name of the model or, for the reference, of its interpretation.
    `against`: name of the first interpretation of the reference. `differences` (P×k): relative
    differences from this interpretation, of all models and other interpretations; NaN if there is
    no number to compare. `uncertainties` (P×k, relative): half-widths of the reference's
    frequencies by name of the interpretation; empty for compliances. If legs are specified by their
    6×6 compliance, these half-widths cover every plausible mass distribution and stiffness inside
    the legs.
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str
    uncertainties: Mapping[str, Array] = field(default_factory=dict)


def compared_models(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the models compared in statics, and of those compared in frequencies."""
    judged = judged_models(mechanism)
    static, dynamic = (
        tuple(name for name in stack if name in judged) for stack in (_STATIC_STACK, _DYNAMIC_STACK)
    )
    return static, dynamic


def compared_statics(robot: RobotOnPath) -> tuple[dict[str, Statics], dict[str, Array]]:
    """Statics by name of model or interpretation, and half-widths of the reference.

    The half-widths (P×7, relative), by name of the interpretation, are due to the meshes and to the
    digits of the robot file. Raises InputError or ComputationError if there is no reference. Array
    sizes: P postures.
    """
    responses = Responses(robot)
    statics = {
        name: responses.required_statics(model, NOMINAL)
        for name, model in _models_of_stack(robot, _STATIC_STACK).items()
        if model.statics
    }
    uncertainties = {}
    for interpretation in static_reference(responses).interpretations:
        name = f"solid, {interpretation.name}" if robot.has_solids else "specified 6×6 of the legs"
        sources = (interpretation.budget.get(source) for source in (Source.MESHES, Source.DIGITS))
        half_widths = [
            half_width.displacements
            for half_width in sources
            if half_width and half_width.displacements is not None
        ]
        statics[name] = responses.required_statics(SOLID, interpretation.reading)
        uncertainties[name] = np.asarray(np.sum(half_widths, axis=0))
    return statics, uncertainties


def compared_compliances(
    statics: Mapping[str, Statics], uncertainties: Mapping[str, Array]
) -> Compared:
    """Compliances of all models and of the reference: the diagonals of the 6×6 matrices (P×6, SI).

    They are displacements along, and rotations about, each base axis under a unit load along or
    about the same axis. The arguments are the results of `compared_statics`. Array sizes: P
    postures.
    """
    compliances = {
        name: np.diagonal(model_statics.compliances, axis1=1, axis2=2)
        for name, model_statics in statics.items()
    }
    against = next(iter(uncertainties))
    reference = compliances[against]
    nonzero = np.where(reference != 0.0, reference, np.nan)
    differences = {
        name: values / nonzero - 1.0 for name, values in compliances.items() if name != against
    }
    return Compared(compliances, differences, against)


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


def compared_frequencies(robot: RobotOnPath) -> Compared:
    """First natural frequencies (P×k, Hz, ascending) of all models and of the reference.

    Each difference is between modes of the same shape. Raises InputError or ComputationError if
    there is no reference. Array sizes: P postures, k judged frequencies.
    """
    responses = Responses(robot)
    modes_by_name = solved_modes(responses)
    reference = dynamic_reference(responses)
    uncertainties = {}
    judged = robot.judged_count
    for name, (first, *further) in _grouped_by_ends(reference).items():
        first_modes = responses.required_modes(SOLID, first.reading)
        half_widths = first.frequency_half_widths(judged)
        if half_widths is None:
            continue
        changes = [
            frequency_changes(first_modes, modes, judged)
            for other in further
            if (modes := responses.known_modes(SOLID, other.reading))
        ]
        modes_by_name[name] = first_modes
        uncertainties[name] = half_widths + np.nanmax(
            [np.zeros_like(half_widths), *changes], axis=0
        )
    if not uncertainties:
        raise InputError(reference.decides)
    against = next(iter(uncertainties))
    reference_modes = modes_by_name[against]
    reference_frequencies = reference_modes.frequencies[:, :judged]
    return Compared(
        {name: modes.frequencies[:, :judged] for name, modes in modes_by_name.items()},
        {
            name: partners(reference_modes, modes, judged).frequency / reference_frequencies - 1.0
            for name, modes in modes_by_name.items()
            if name != against
        },
        against,
        uncertainties,
    )


def solved_modes(responses: Responses) -> dict[str, PathModes]:
    """Modes of all models that define modes, by name.

    Raises ComputationError if one of these models is unsolved.
    """
    models = _models_of_stack(responses.robot, _DYNAMIC_STACK)
    return {
        name: responses.required_modes(model, NOMINAL)
        for name, model in models.items()
        if responses.modes(model, NOMINAL)
    }


def _models_of_stack(robot: RobotOnPath, stack: tuple[str, ...]) -> dict[str, Model]:
    recipes = judged_models(robot.mechanism)
    return judged_models_of(robot, {name: recipes[name] for name in stack if name in recipes})
