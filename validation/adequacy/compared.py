"""What all models say of a mechanism in some postures, and how far they are from its solids."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.path import RobotOnPath
from validation.adequacy.mechanism.statics import model_statics, static_reference
from validation.adequacy.mechanism.vibration import modes_by_model
from validation.adequacy.models import JudgedModel, judged_models, why_unable
from validation.adequacy.partners import frequency_changes, partners
from validation.adequacy.response import Alternative, Reference
from validation.agreement.responses import PathModes, Statics
from validation.models.loads.leg_masses import MASSES

# From the bottom of a stack of curves to its top.
_DYNAMIC = ("segments", "segments-stepped", "segments-condensed", "beam", "beam-euler-bernoulli")
_STATIC_STACK = ("simplified", "vjm", "links", *_DYNAMIC)
_DYNAMIC_STACK = ("simplified", *_DYNAMIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """One quantity or several in p postures by all models and, last, by the alternatives.

    `values` maps their names to p×k numbers, `differences` all but `against`, the first
    alternative, to what they differ from it (p×k, relative, NaN where there is nothing to compare).
    `uncertainties` (p×k or more, relative) are those of the alternatives; of frequencies of legs
    known by their 6×6 they cover every plausible inside.
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str
    uncertainties: Mapping[str, Array] = field(default_factory=dict)


def compared_models(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The models that are compared in statics, and those that are in frequencies."""
    return tuple(_stacked(mechanism, _STATIC_STACK)), tuple(_stacked(mechanism, _DYNAMIC_STACK))


def compared_statics(robot: RobotOnPath) -> tuple[dict[str, Statics], dict[str, Array]]:
    """Statics by all models and, last, by the alternatives of the reference.

    Then the uncertainties of the alternatives (p×7, relative), of meshes and of the file's digits.
    Raises InputError or ComputationError without reference.
    """
    found = {
        name: model_statics(robot.postures, model, options)
        for name, (model, _, options) in _answering(robot, _STATIC_STACK).items()
    }
    uncertainties = {}
    for one in static_reference(robot).alternatives:
        solid = robot.prisms or robot.mechanism.parts
        name = f"solid, {one.name}" if solid else "legs' own 6×6"
        statics = one.response.solved_statics
        if statics is not None and one.static is not None:
            open_digits = 0.0 if one.digits is None else one.digits
            found[name], uncertainties[name] = statics, one.static + open_digits
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


def _by_hold(reference: Reference) -> dict[str, list[Alternative]]:
    """The alternatives that differ in the legs' insides alone, by the name of the first of them."""
    alike: dict[str, list[Alternative]] = {}
    for one in reference.alternatives:
        name = f"solid, {one.name}"
        if reference.supposed:
            name = ", ".join(filter(None, (one.ends, MASSES[0])))
        alike.setdefault(name, []).append(one)
    return alike


def compared_frequencies(robot: RobotOnPath) -> Compared:
    """The first frequencies (p×k, Hz), ascending; differences of modes of one shape.

    Raises InputError or ComputationError where there is no reference.
    """
    found = answering_modes(robot)
    reference = dynamic_reference(robot)
    uncertainties = {}
    judged = robot.judged
    for name, likewise in _by_hold(reference).items():
        shown, left_open = likewise[0].response.solved_modes, likewise[0].dynamic
        if shown is None or left_open is None:
            continue
        others = (other.response.solved_modes for other in likewise[1:])
        changes = [frequency_changes(shown, one, judged) for one in others if one]
        found[name] = shown
        uncertainties[name] = left_open + np.nanmax([np.zeros_like(left_open), *changes], axis=0)
    if not uncertainties:
        raise InputError(reference.decides)
    against = next(iter(uncertainties))
    first = found[against]
    own = first.frequencies[:, :judged]
    return Compared(
        {name: one.frequencies[:, :judged] for name, one in found.items()},
        {
            name: partners(first, one, judged).frequency / own - 1.0
            for name, one in found.items()
            if name != against
        },
        against,
        uncertainties,
    )


def answering_modes(robot: RobotOnPath) -> dict[str, PathModes]:
    """The modes of all models that have any."""
    return {
        name: modes
        for name, (model, _, options) in _answering(robot, _DYNAMIC_STACK).items()
        if (modes := modes_by_model(robot, model, options))
    }


def _answering(robot: RobotOnPath, stack: tuple[str, ...]) -> dict[str, JudgedModel]:
    models = _stacked(robot.mechanism, stack).items()
    return {name: model for name, model in models if not why_unable(robot.postures, model)}


def _stacked(mechanism: Mechanism, stack: tuple[str, ...]) -> dict[str, JudgedModel]:
    judged = judged_models(mechanism)
    return {name: judged[name] for name in stack if name in judged}
