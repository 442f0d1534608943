"""What all models say of a mechanism in some postures, and how far they are from its solids."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism, Posture
from validation.adequacy.mechanism.dynamics import mechanism_dynamics
from validation.adequacy.mechanism.statics import mechanism_statics, unanswered
from validation.adequacy.mechanism.subject import mechanism_candidates
from validation.adequacy.partners import partners
from validation.adequacy.subject.dynamics import dynamic_reference
from validation.adequacy.subject.statics import static_reference
from validation.context import Context
from validation.models.options import ModelName, ModelOptions

# From the bottom of a stack of curves to its top.
_DYNAMIC = ("segments", "segments-stepped", "segments-condensed", "beam", "beam-euler-bernoulli")
_STATIC_STACK = ("simplified", "vjm", "links", *_DYNAMIC)
_DYNAMIC_STACK = ("simplified", *_DYNAMIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """One quantity or several in p postures by all models and, last, by the alternatives.

    `values` maps their names to p×k numbers, `differences` all but `against`, the first
    alternative, to what they differ from it (p×k, relative, NaN where there is nothing to compare).
    `uncertainties` (p×k or more, relative) are those of the alternatives.
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str
    uncertainties: Mapping[str, Array] = field(default_factory=dict)


class ComparedStatics(NamedTuple):
    """Compliances (p×6×6, SI) by all models and, last, by the alternatives of the reference.

    `uncertainties` of the alternatives (p×7, relative), of meshes and of the file's digits.
    """

    compliances: Mapping[str, Array]
    uncertainties: Mapping[str, Array]


def compared_models(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The models that are compared in statics, and those that are in frequencies."""
    judged = mechanism_candidates(mechanism)
    static, dynamic = (
        tuple(name for name in stack if name in judged) for stack in (_STATIC_STACK, _DYNAMIC_STACK)
    )
    return static, dynamic


def compared_statics(context: Context, postures: tuple[Posture, ...]) -> ComparedStatics:
    """All models and the alternatives; raises InputError or ComputationError without reference."""
    statics = mechanism_statics(context, postures)
    found = {
        name: statics.answer(model, options)
        for name, (model, options) in _answering(postures, _STATIC_STACK).items()
    }
    uncertainties = {}
    for one in static_reference(statics).alternatives:
        solid = statics.prisms or statics.parts
        name = f"solid, {one.name}" if solid else "legs' own 6×6"
        if one.response.compliance is not None and one.static is not None:
            open_digits = 0.0 if one.digits is None else one.digits
            found[name], uncertainties[name] = one.response.compliance, one.static + open_digits
    return ComparedStatics(found, uncertainties)


def compared_compliances(statics: ComparedStatics) -> Compared:
    """Compliance (p×6, SI) along and about each axis, under its own force and moment."""
    found = {
        name: np.diagonal(values, axis1=1, axis2=2) for name, values in statics.compliances.items()
    }
    against = next(iter(statics.uncertainties))
    reference = found[against]
    known = np.where(reference != 0.0, reference, np.nan)
    differences = {name: values / known - 1.0 for name, values in found.items() if name != against}
    return Compared(found, differences, against)


def compared_frequencies(context: Context, postures: tuple[Posture, ...], judged: int) -> Compared:
    """The first frequencies (p×`judged`, Hz), ascending; differences of modes of one shape.

    Raises InputError or ComputationError where there is no reference.
    """
    dynamics = mechanism_dynamics(context, postures, judged)
    found = {
        name: modes
        for name, (model, options) in _answering(postures, _DYNAMIC_STACK).items()
        if (modes := dynamics.answer(model, options))
    }
    reference = dynamic_reference(dynamics)
    uncertainties = {}
    for one in reference.alternatives:
        if one.response.vibration is not None and one.dynamic is not None:
            name = one.name if reference.bracket else f"solid, {one.name}"
            found[name], uncertainties[name] = one.response.vibration, one.dynamic
    if not uncertainties:
        raise InputError(reference.decides)
    against = next(iter(uncertainties))
    first, weights = found[against], dynamics.weights
    own = first.frequencies[:, :judged]
    return Compared(
        {name: one.frequencies[:, :judged] for name, one in found.items()},
        {
            name: partners(first, one, weights, judged).frequency / own - 1.0
            for name, one in found.items()
            if name != against
        },
        against,
        uncertainties,
    )


def _answering(
    postures: Sequence[Posture], stack: Sequence[str]
) -> dict[str, tuple[ModelName, ModelOptions]]:
    judged = mechanism_candidates(postures[0].mechanism)
    asked = {name: (judged[name].kind, judged[name].options) for name in stack if name in judged}
    return {name: model for name, model in asked.items() if not unanswered(postures, *model)}
