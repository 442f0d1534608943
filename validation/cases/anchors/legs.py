"""Every number of a leg alone on the first screen by polynomials along it."""

import numpy as np

from lumped.acceptance.requirement import AXES
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import Leg
from validation.adequacy.biglide.leg import MODELS
from validation.adequacy.models import JUDGED
from validation.case import Measurement
from validation.cases.anchors.quantities import (
    EXACT,
    SHOWN,
    TITLE,
    in_shown_units,
    rounding,
    statics,
)
from validation.context import Context
from validation.models.legs import leg_compliance
from validation.studies.ritz import biglide as ritz

cases = statics.like(section="Leg {number}", group="leg{number}.lumped")


def shown(leg: Leg, model: str) -> Array:
    """Diagonal of the 6×6 (SI, leg axes) as the first screen has it."""
    kind, _, options = JUDGED[model]
    return np.diag(leg_compliance(kind, leg, options))


def expected(leg: Leg, legs: ritz.Legs, degree: int) -> Array:
    """The same by polynomials of `degree`."""
    return np.diag(ritz.clamped_leg(leg, legs, degree))


def _leg(robot: Biglide, number: int) -> Leg:
    return robot.leg1 if number == 1 else robot.leg2


@cases.case(
    "leg{number}.anchor[{model}, {entry}]",
    TITLE,
    over={
        "number, of": tuple((number, f"Leg {number}, root clamped") for number in (1, 2)),
        "model": MODELS,
        "entry, said, unit": SHOWN,
    },
    headlines=("leg{number}.statics.{model}",),
)
def _entry(context: Context, number: int, model: str, entry: str) -> Measurement:
    leg, index = _leg(context.robot, number), AXES.index(entry)
    legs: ritz.Legs = "given" if model == "vjm" else JUDGED[model].options.theory
    by_ritz, other = (
        in_shown_units(context.get(expected, leg, legs, degree)[index], entry) for degree in EXACT
    )
    return Measurement(
        in_shown_units(context.get(shown, leg, model)[index], entry),
        by_ritz,
        reference_uncertainty=rounding(by_ritz, other),
    )
