"""Absolute numbers of the biglide, in µm and Hz, by ways that share the robot's data alone.

Other comparisons hold models against each other, at the posture where they differ most; these hold
one number of each kind, at a fixed posture, against geometry or polynomials along the legs.
"""

from decimal import Decimal
from itertools import pairwise
from math import hypot

import numpy as np
from scipy.optimize import minimize_scalar

from lumped.biglide import Biglide
from validation.agreement.convergence import step_factor
from validation.case import Allowance, Measurement, Relative
from validation.case_group import CaseGroup, numbered
from validation.cases.anchors.quantities import EXACT, RITZ, rounding
from validation.cases.robot.stroke import BEYOND_ROUNDING, CURVES, rounded_deflections
from validation.context import Context
from validation.exhibits import STROKE
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import BEAM_ORDER, SEGMENT_ORDER, ModelName, ModelOptions
from validation.studies.quantities import (
    deflections_of,
    rounded_frequencies,
    stroke_deflections,
)
from validation.studies.ritz import biglide as ritz
from validation.studies.ritz import segments

_EQUIVALENT = ModelOptions(legs="equivalent")
_DYNAMIC = (
    ("beam", BEAM_ORDER, Relative(1e-4), "fourth order in 1/n: below 1e-5 with 20 elements"),
    ("segments", SEGMENT_ORDER, segments.TOLERANCE, segments.REASON),
)
_FREQUENCIES = 4
# Over the stroke: the first number is judged, the others show what it misses.
_POSTURES = (81, 71, 61)
FORCE, _MICROMETRE = 1000.0, 1e-6

cases = CaseGroup(
    reference_kind="independent-solver",
    citation=RITZ,
    section=STROKE,
    group="robot.anchor",
)
# What the paper prints as its model: joints released by zeros, eq. (25).
paper_cases = cases.like()


@cases.case(
    "robot.anchor.simplified",
    "The simplified model's largest planar deflection follows from geometry",
    quantity="largest planar deflection under 1000 N over the stroke",
    headlines=("paper.simplified",),
    unit="µm",
    reference_kind="closed-form",
    citation="eqs (1), (2) by hand: virtual power of two drives; Brent's method along x",
    tolerance=Relative(2e-3),
    tolerance_reason=f"{_POSTURES[0]} postures miss the peak by the square of half a step",
    model="simplified",
    figure="deflection.simplified",
)
def _simplified(context: Context) -> Measurement:
    robot = context.robot
    found = [
        context.get(stroke_deflections, "simplified", robot, number).largest_planar
        for number in _POSTURES
    ]
    return Measurement(
        found[0],
        context.get(largest_on_drives, robot),
        # Postures that do not meet miss the peak by more or by less.
        value_uncertainty=float(np.ptp(found)),
    )


def largest_on_drives(robot: Biglide) -> float:
    """Largest planar deflection (µm) of B under 1000 N along x or y: legs rigid, drives elastic."""
    first, last = robot.stroke
    brackets = np.linspace(first, last, 12)
    return max(
        _on_drives(robot, place, load)
        for load in ("x", "y")
        for low, high in pairwise(brackets.tolist())
        for place in (low, high, _peak(robot, low, high, load))
    )


def _peak(robot: Biglide, low: float, high: float, load: str) -> float:
    found = minimize_scalar(
        lambda x: -_on_drives(robot, x, load),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return float(found.x)


def _on_drives(robot: Biglide, x: float, load: str) -> float:
    """Planar deflection (µm) under 1000 N along x or y."""
    force = (FORCE, 0.0) if load == "x" else (0.0, FORCE)
    return hypot(*yielding_drives(robot, x, force)) / _MICROMETRE


def yielding_drives(robot: Biglide, x: float, force: tuple[float, float]) -> tuple[float, float]:
    """Displacement (m) along x and y of B: rigid legs, elastic drives, by virtual power.

    With slopes tᵢ = Δxᵢ/sᵢ of the legs a slide moves by δyᵢ = tᵢ δx + δy: two equations for δx and
    δy; forces fᵢ of the drives balance the load, δyᵢ = fᵢ/K.
    """
    # In 28 digits: heights and base are small differences where legs nearly align.
    a, stiffness = Decimal(robot.a), Decimal(robot.actuator_stiffness)
    # Leg 2 is horizontal at the end that is meant; the nearest float misses that by √ε.
    at_end = x == robot.stroke[0]
    at = a - Decimal(robot.leg2.length) if at_end else Decimal(x)
    along, across = (Decimal(component) for component in force)
    beyond, none = a - at, Decimal(0)
    s1 = max(Decimal(robot.leg1.length) ** 2 - at**2, none).sqrt()
    s2 = max(Decimal(robot.leg2.length) ** 2 - beyond**2, none).sqrt()
    # s₂ x + s₁ (a − x) over s₁ s₂ is the difference of slopes: multiplied out, no end is singular.
    base = at * s2 + beyond * s1
    y1 = (along * s1 * s2 + across * s1 * beyond) / base / stiffness
    y2 = (across * s2 * at - along * s1 * s2) / base / stiffness
    return float(s1 * s2 * (y1 - y2) / base), float((s1 * beyond * y1 + s2 * at * y2) / base)


@cases.case(
    "robot.anchor.{model}.{name}",
    "At the centre {model} has Ritz's {meaning}",
    over={
        # On equivalent legs, which is a model of its own where virtual joints have the others.
        "model, headlines": (
            ("vjm", ("robot.statics.vjm-equivalent",)),
            ("beam", ("robot.statics.beam",)),
        ),
        "name, attribute, meaning": CURVES,
    },
    quantity="{meaning}, centre of the stroke",
    unit="µm",
    tolerance=Relative(1e-6),
    tolerance_reason="statics of Timoshenko's legs are polynomials: rounding alone, grown by the "
    "robot's condition",
    row="anchor",
    figure="deflection.stroke",
)
def _deflected(context: Context, model: ModelName, attribute: str) -> Measurement:
    robot, x = context.robot, context.robot.centre
    found = context.get(robot_compliance, model, robot, x, _EQUIVALENT)
    polynomials = (context.get(ritz.compliance, robot, x, "timoshenko", d) for d in EXACT)
    value, by_ritz, other = (
        float(getattr(deflections_of(matrix[None]), attribute)[0])
        for matrix in (found, *polynomials)
    )
    left_open = context.get(rounded_deflections, model, robot, x, _EQUIVALENT)
    return Measurement(
        value,
        by_ritz,
        value_uncertainty=float(getattr(left_open, attribute)[0]),
        reference_uncertainty=rounding(by_ritz, other),
        decides=BEYOND_ROUNDING,
        pose=(float(x),),
    )


@cases.case(
    "robot.anchor.{model}.frequency[{mode}]",
    "At the centre frequency {mode} by {model} is Ritz's",
    over={
        "model, order, tolerance, tolerance_reason": _DYNAMIC,
        "index, mode": numbered(_FREQUENCIES),
    },
    # Of beams the paper has no numbers.
    headlines=lambda model: (
        f"robot.frequencies.{model}",
        *(("paper.segments",) if model == "segments" else ()),
    ),
    quantity="natural frequency {mode}, centre of the stroke",
    unit="Hz",
    row="anchor",
    effort=0.3,
    figure="frequency.stroke",
)
def _swinging(context: Context, model: ModelName, order: float, index: int) -> Measurement:
    robot, x = context.robot, context.robot.centre
    (coarse, _), (fine, left_open) = (
        context.get(
            rounded_frequencies, model, robot, x, _FREQUENCIES, ModelOptions(elements=elements)
        )
        for elements in (10, 20)
    )
    reference, rougher = (
        float(context.get(ritz.frequencies, robot, x, _FREQUENCIES, "timoshenko", degree)[index])
        for degree in (ritz.DEGREE, ritz.DEGREE - 2)
    )
    uncertain = rounding(reference, rougher)
    explained: tuple[Allowance, ...] = ()
    if model == "segments":
        explained = (
            segments.explained(context.get(ritz.missed_by_segments, robot, x, _FREQUENCIES)[index]),
        )
    return Measurement(
        float(fine[index]),
        reference,
        value_uncertainty=step_factor(2.0, order) * float(abs(fine - coarse)[index]),
        reference_uncertainty=uncertain,
        # What 20 elements leave is what is judged: rounding alone leaves it uncertain.
        judged_uncertainty=hypot(uncertain, left_open[index]),
        allowances=explained,
        decides=BEYOND_ROUNDING,
        pose=(float(x),),
    )


@paper_cases.case(
    "robot.anchor.printed.frequency[{mode}]",
    "At the centre frequency {mode} in segments, eq. (25) printed, is Ritz's",
    over={"index, mode": numbered(_FREQUENCIES)},
    quantity="natural frequency {mode}, eq. (25) as printed, centre of the stroke",
    headlines=("paper.printed",),
    unit="Hz",
    tolerance=Relative(0.01),
    tolerance_reason="the paper's 1 % for 20 elements (§3.2)",
    model="segments",
    effort=0.3,
)
def _printed(context: Context, index: int) -> Measurement:
    robot, x = context.robot, context.robot.centre
    options = ModelOptions(release="printed")
    found = context.get(robot_frequencies, "segments", robot, x, _FREQUENCIES, options)
    reference, rougher = (
        float(context.get(ritz.frequencies_as_printed, robot, x, _FREQUENCIES, degree)[index])
        for degree in (ritz.DEGREE, ritz.DEGREE - 2)
    )
    return Measurement(
        float(found[index]),
        reference,
        # What 20 elements leave is what is judged: the reference alone leaves it uncertain.
        judged_uncertainty=rounding(reference, rougher),
        pose=(float(x),),
    )
