"""Numerical uncertainty of what `solve` says of the biglide's solids, from one more mesh."""

from collections.abc import Sequence
from dataclasses import replace
from math import cbrt, sqrt

import numpy as np

from lumped.errors import InputError
from lumped.legs import Leg, equivalent_leg
from lumped.sections import Section
from meshes.section.section_blocks import element_count
from validation.agreement.convergence import step_factor
from validation.models.options import ModelOptions
from validation.solids.legs import formal_order
from validation.solve.answer import Answer, MeshUncertainty

# Elements of one mesh to those of the other, in size: walls of one element across keep that one,
# so that half the divisions come to 1.3.
_RATIO = 1.25


def beside(options: ModelOptions, legs: Sequence[Leg]) -> ModelOptions:
    """The same on another mesh: half the divisions, or a multiple where those change too little.

    Round and thin-walled sections need so many elements as they are that fewer divisions often give
    them the same mesh, whose answer would be called exact.
    """
    own = options.divisions
    others = (own // 2, *(own * factor for factor in (2, 4, 8)))
    sections = [equivalent_leg(leg, options.equivalent).section for leg in legs]
    chosen = next(
        other
        for other in others
        if other and all(_ratio(section, own, other) >= _RATIO for section in sections)
    )
    return replace(options, divisions=chosen)


def _ratio(section: Section, one: int, other: int) -> float:
    """Of the sizes of elements of two meshes of a section, at least 1."""
    try:
        coarse, fine = sorted(element_count(section, divisions) for divisions in (one, other))
    except InputError:
        # A shape that a user has added: as its divisions say.
        return max(one, other) / min(one, other)
    return sqrt(fine / coarse)


def with_uncertainty(
    answers: Sequence[Answer],
    others: Sequence[Answer],
    legs: Sequence[Leg],
    options: ModelOptions,
) -> list[Answer]:
    """The answers with half-widths of 95 % intervals, `others` being those of `beside`.

    The step between both meshes times Roache's factor, r³ the ratio of their elements (Celik et
    al., J. Fluids Eng. 130 (2008) 078001). The coarser one's error is rᵖ times the finer one's.
    """
    own, other = options.divisions, beside(options, legs).divisions
    solid = [equivalent_leg(leg, options.equivalent) for leg in legs]
    order = min(formal_order(leg, options.ends) for leg in solid)
    along = max(own, other) / min(own, other)
    ratio = min(cbrt(along * _ratio(leg.section, own, other) ** 2) for leg in solid)
    factor = step_factor(ratio, order) * (1.0 if own > other else ratio**order)
    return [
        replace(
            one,
            uncertainty=MeshUncertainty(
                divisions=other,
                compliance=factor * np.abs(np.diag(one.compliance) - np.diag(two.compliance)),
                frequencies=factor * np.abs(one.frequencies - two.frequencies),
            ),
        )
        for one, two in zip(answers, others, strict=True)
    ]


def without_uncertainty(answers: Sequence[Answer], divisions: int) -> list[Answer]:
    """The answers, nothing being known of their meshes, since that of `divisions` is too large."""
    return [
        replace(
            one,
            uncertainty=MeshUncertainty(
                divisions=divisions,
                compliance=np.full(len(one.compliance), np.inf),
                frequencies=np.full(len(one.frequencies), np.inf),
            ),
        )
        for one in answers
    ]
