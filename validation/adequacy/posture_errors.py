"""What all models say of a mechanism in some postures, and how far they are from its solids."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.judged_models import judged_model, judged_models
from validation.references.modal_reference import dynamic_reference
from validation.references.model_ladder import SOLID
from validation.references.reference import Interpretation, Reference, Source
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import NOMINAL, Reading, RobotOnPath
from validation.references.static_reference import static_reference
from validation.responses.mode_partners import frequency_changes, partners
from validation.responses.statics_and_modes import PathModes, Statics

# From the bottom of a stack of curves to its top.
_DYNAMIC = ("segments", "segments-stepped", "segments-condensed", "beam", "beam-euler-bernoulli")
_STATIC_STACK = ("simplified", "vjm", "links", *_DYNAMIC)
_DYNAMIC_STACK = ("simplified", *_DYNAMIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """One quantity or several in p postures by all models and, last, by the interpretations.

    `values` maps their names to p×k numbers, `differences` all names but `against`, the first
    interpretation, to the relative differences from it (p×k, NaN if there is nothing to compare).
    `uncertainties` (p×k or more, relative) are those of the interpretations; of frequencies of legs
    known by their 6×6 they cover every plausible inside.
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str
    uncertainties: Mapping[str, Array] = field(default_factory=dict)


def compared_models(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The models that are compared in statics, and those that are in frequencies."""
    judged = judged_models(mechanism)
    static, dynamic = (
        tuple(name for name in stack if name in judged) for stack in (_STATIC_STACK, _DYNAMIC_STACK)
    )
    return static, dynamic


def compared_statics(robot: RobotOnPath) -> tuple[dict[str, Statics], dict[str, Array]]:
    """Statics by all models and, last, by the interpretations of the reference.

    Then the half-widths of the interpretations (p×7, relative), of meshes and of the file's digits.
    Raises InputError or ComputationError without reference.
    """
    responses = Responses(robot)
    found = {
        name: responses.required_statics(model, NOMINAL)
        for name, model in _stacked(robot, _STATIC_STACK).items()
        if model.statics
    }
    uncertainties = {}
    for one in static_reference(responses).interpretations:
        solid = robot.prisms or robot.mechanism.parts
        name = f"solid, {one.name}" if solid else "legs' own 6×6"
        known = (one.budget.get(source) for source in (Source.MESHES, Source.DIGITS))
        half_widths = [of.displacements for of in known if of and of.displacements is not None]
        found[name] = responses.required_statics(SOLID, one.reading)
        uncertainties[name] = np.asarray(np.sum(half_widths, axis=0))
    return found, uncertainties


def compared_compliances(
    statics: Mapping[str, Statics], uncertainties: Mapping[str, Array]
) -> Compared:
    """Compliance (p×6, SI) along and about each axis, under its own force and moment.

    Arguments as `compared_statics` gives them.
    """
    found = {name: np.diagonal(one.compliances, axis1=1, axis2=2) for name, one in statics.items()}
    against = next(iter(uncertainties))
    reference = found[against]
    known = np.where(reference != 0.0, reference, np.nan)
    differences = {name: values / known - 1.0 for name, values in found.items() if name != against}
    return Compared(found, differences, against)


def _by_ends(reference: Reference) -> dict[str, list[Interpretation]]:
    """Interpretations that differ in the legs' insides alone, by the name of the first of them."""
    alike: dict[Reading, list[Interpretation]] = {}
    for one in reference.interpretations:
        alike.setdefault(one.reading.restricted(("ends",)), []).append(one)
    return {
        first.name if reference.supposed else f"solid, {first.name}": [first, *others]
        for first, *others in alike.values()
    }


def compared_frequencies(robot: RobotOnPath) -> Compared:
    """The first frequencies (p×k, Hz), ascending; differences of modes of one shape.

    Raises InputError or ComputationError without reference.
    """
    responses = Responses(robot)
    found = solved_modes(responses)
    reference = dynamic_reference(responses)
    uncertainties = {}
    judged = robot.judged
    for name, (first, *others) in _by_ends(reference).items():
        shown = responses.required_modes(SOLID, first.reading)
        half_widths = first.frequency_half_widths(judged)
        if half_widths is None:
            continue
        changes = [
            frequency_changes(shown, modes, judged)
            for other in others
            if (modes := responses.known_modes(SOLID, other.reading))
        ]
        found[name] = shown
        uncertainties[name] = half_widths + np.nanmax(
            [np.zeros_like(half_widths), *changes], axis=0
        )
    if not uncertainties:
        raise InputError(reference.decides)
    against = next(iter(uncertainties))
    reference_modes = found[against]
    own = reference_modes.frequencies[:, :judged]
    return Compared(
        {name: one.frequencies[:, :judged] for name, one in found.items()},
        {
            name: partners(reference_modes, one, judged).frequency / own - 1.0
            for name, one in found.items()
            if name != against
        },
        against,
        uncertainties,
    )


def solved_modes(responses: Responses) -> dict[str, PathModes]:
    """Modes of all models that have any. Raises ComputationError if one is not solved."""
    models = _stacked(responses.robot, _DYNAMIC_STACK)
    return {
        name: responses.required_modes(model, NOMINAL)
        for name, model in models.items()
        if responses.modes(model, NOMINAL)
    }


def _stacked(robot: RobotOnPath, stack: tuple[str, ...]) -> dict[str, Model]:
    recipes = judged_models(robot.mechanism)
    return {name: judged_model(robot, name, recipes[name]) for name in stack if name in recipes}
