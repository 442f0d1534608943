"""What all models say of a mechanism in some postures, and how far they are from its solids."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.mechanism import Posture
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
_STACK = ("simplified", "vjm", "links", *_DYNAMIC)


@dataclass(frozen=True, eq=False)
class Compared:
    """One quantity or several in p postures by all models and, last, by the alternatives.

    `values` maps their names to p×k numbers, `differences` all but `against`, the first
    alternative, to what they differ from it (p×k, relative, NaN where there is nothing to compare).
    """

    values: Mapping[str, Array]
    differences: Mapping[str, Array]
    against: str


def compared_compliances(context: Context, postures: tuple[Posture, ...]) -> Compared:
    """Compliance (p×6, SI) along and about each axis, under its own force and moment.

    Raises InputError or ComputationError where there is no reference.
    """
    statics = mechanism_statics(context, postures)
    found = {
        name: _own(statics.answer(model, options))
        for name, (model, options) in _answering(postures, _STACK).items()
    }
    against = ""
    for one in static_reference(statics).alternatives:
        solid = statics.prisms or statics.parts
        name = f"solid, {one.name}" if solid else "legs' own 6×6"
        if one.response.compliance is not None:
            found[name] = _own(one.response.compliance)
        against = against or name
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
        for name, (model, options) in _answering(postures, ("simplified", *_DYNAMIC)).items()
        if (modes := dynamics.answer(model, options))
    }
    reference = dynamic_reference(dynamics)
    against = ""
    for one in reference.alternatives:
        if one.response.vibration is not None:
            name = one.name if reference.bracket else f"solid, {one.name}"
            found[name] = one.response.vibration
            against = against or name
    if not against:
        raise ComputationError(reference.decides)
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
    )


def _answering(
    postures: Sequence[Posture], stack: Sequence[str]
) -> dict[str, tuple[ModelName, ModelOptions]]:
    judged = mechanism_candidates(postures[0].mechanism)
    asked = {name: (judged[name].kind, judged[name].options) for name in stack if name in judged}
    return {name: model for name, model in asked.items() if not unanswered(postures, *model)}


def _own(compliance: Array) -> Array:
    return np.diagonal(compliance, axis1=1, axis2=2)
