"""Every number of a leg alone on the first screen by polynomials along it."""

from functools import partial

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import Leg
from validation.adequacy.biglide.leg import MODELS
from validation.case import Case, Measurement
from validation.cases.anchors.quantities import RITZ, in_shown_units, static_case
from validation.context import Context
from validation.models.legs import leg_compliance
from validation.studies.ritz import biglide as ritz


def cases() -> tuple[Case, ...]:
    """Deflections and rotations of both legs by every model."""
    return tuple(
        static_case(
            f"leg{number}.anchor[{model}, {quantity}]",
            quantity,
            model=model,
            of=f"Leg {number}, root clamped",
            places="",
            citation=RITZ,
            compute=partial(_entry, number=number, model=model, quantity=quantity),
            section=f"Leg {number}",
            group=f"leg{number}.lumped",
        )
        for number in (1, 2)
        for model in MODELS
        for quantity in STATIC_QUANTITIES
    )


def shown(leg: Leg, model: str) -> Array:
    """Diagonal of the 6×6 (SI, leg axes) as the first screen has it."""
    kind, options = MODELS[model]
    return np.diag(leg_compliance(kind, leg, options))


def expected(leg: Leg, legs: ritz.Legs) -> Array:
    """The same by polynomials."""
    return np.diag(ritz.clamped_leg(leg, legs))


def _leg(robot: Biglide, number: int) -> Leg:
    return robot.leg1 if number == 1 else robot.leg2


def _entry(context: Context, number: int, model: str, quantity: str) -> Measurement:
    leg, index = _leg(context.robot, number), STATIC_QUANTITIES.index(quantity)
    legs: ritz.Legs = "given" if model == "vjm" else MODELS[model][1].theory
    return Measurement(
        in_shown_units(context.get(shown, leg, model)[index], quantity),
        in_shown_units(context.get(expected, leg, legs)[index], quantity),
        exact=True,
    )
