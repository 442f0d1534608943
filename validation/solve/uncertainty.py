"""Numerical uncertainty of what `solve` says of the biglide's solids, from one more mesh."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lumped.legs import Leg, equivalent_leg
from validation.convergence import step_factor
from validation.leg_solids import formal_order
from validation.models.options import ModelOptions
from validation.solve.answer import Answer, MeshUncertainty


def beside(options: ModelOptions) -> ModelOptions:
    """The same with half the divisions, or two in place of a single one."""
    own = options.divisions
    return replace(options, divisions=own // 2 if own > 1 else 2)


def with_uncertainty(
    answers: Sequence[Answer],
    others: Sequence[Answer],
    legs: Sequence[Leg],
    options: ModelOptions,
) -> list[Answer]:
    """The answers with half-widths of 95 % intervals, `others` being those of `beside`.

    The step between both meshes times Roache's factor. A single division is the coarser of two
    meshes, whose error is rᵖ times that of the finer one.
    """
    own, other = options.divisions, beside(options).divisions
    order = min(formal_order(equivalent_leg(leg, options.equivalent), options.ends) for leg in legs)
    ratio = max(own, other) / min(own, other)
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
