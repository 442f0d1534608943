"""Every number of the biglide's first screen by polynomials along its legs, or by hand.

The numbers are those that the models are judged by, at the postures that they are judged at; what
they are held against shares the robot's data with them and nothing else.
"""

from math import hypot, inf, pi, sqrt

import numpy as np

from lumped.acceptance.requirement import AXES
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import Theory
from validation.adequacy.biglide.dynamics import model_vibration
from validation.adequacy.biglide.statics import compliances
from validation.adequacy.biglide.subject import CANDIDATES, POSTURES
from validation.case import Allowance, Elsewhere, Measurement, Relative, Skip, others
from validation.case_group import numbered
from validation.cases.anchors.quantities import (
    EXACT,
    RITZ,
    SHOWN,
    TITLE,
    in_shown_units,
    rounding,
    statics,
)
from validation.cases.anchors.robot import yielding_drives
from validation.cases.robot.stroke import BEYOND_ROUNDING, at_stations
from validation.context import Context
from validation.exhibits import STROKE
from validation.models.biglide import rounded_compliance
from validation.studies.quantities import farthest, rounded_frequencies
from validation.studies.ritz import biglide as ritz
from validation.studies.ritz import segments

_BY_HAND = "virtual power of two drives, by hand"
# As many frequencies as drives has the simplified model.
_DRIVES = 2
_DYNAMIC = {
    "beam": (Relative(1e-4), "fourth order in 1/n: below 1e-5 with 20 elements"),
    "segments": (segments.TOLERANCE, segments.REASON),
    "simplified": (Relative(1e-9), "two by two numbers: rounding alone"),
}
# Where a leg lies across the drives one direction is rigid: rounding alone yields in it.
_RIGID = 1e-12


def _entries(model: str) -> tuple[tuple[str, str, str], ...]:
    """The simplified model says something of the plane alone."""
    return SHOWN[:2] if model == "simplified" else SHOWN


def _by(model: str) -> str:
    return _BY_HAND if model == "simplified" else RITZ


cases = statics.like(citation=_by, section=STROKE, group="robot.anchor")


def shown_statics(robot: Biglide, model: str) -> Array:
    """Diagonal of the 6×6 (postures × 6, SI) as the first screen has it."""
    kind, _, options = CANDIDATES[model]
    found = compliances(robot, robot.stations(POSTURES), kind, options)
    return np.diagonal(found, axis1=1, axis2=2)


def expected_statics(robot: Biglide, legs: ritz.Legs, degree: int) -> Array:
    """The same by polynomials of `degree`."""
    x = robot.stations(POSTURES).tolist()
    return np.array([np.diag(ritz.compliance(robot, at, legs, degree)) for at in x])


def expected_frequencies(robot: Biglide, theory: Theory, count: int, degree: int) -> Array:
    """The same by polynomials of `degree`."""
    return np.array(
        [
            ritz.frequencies(robot, x, count, theory, degree)
            for x in robot.stations(POSTURES).tolist()
        ]
    )


def yielding(robot: Biglide) -> Array:
    """Compliances along x and y (postures × 2, m/N) of rigid legs on elastic drives."""
    return np.array(
        [
            [yielding_drives(robot, x, (1.0, 0.0))[0], yielding_drives(robot, x, (0.0, 1.0))[1]]
            for x in robot.stations(POSTURES).tolist()
        ]
    )


def swinging(robot: Biglide) -> Array:
    """Both frequencies (postures × 2, Hz) of the platform's mass on them, inf where rigid."""
    return np.array([_two_frequencies(robot, x) for x in robot.stations(POSTURES).tolist()])


def _two_frequencies(robot: Biglide, x: float) -> tuple[float, float]:
    """1/ω² = m c of both principal compliances c, from trace and determinant of the 2×2."""
    xx, yx = yielding_drives(robot, x, (1.0, 0.0))
    xy, yy = yielding_drives(robot, x, (0.0, 1.0))
    middle, product = 0.5 * (xx + yy), max(xx * yy - xy * yx, 0.0)
    softest = middle + sqrt(max(middle**2 - product, 0.0))
    stiffest = product / softest
    mass = robot.platform_mass
    rigid = stiffest <= _RIGID * softest
    return (
        1.0 / (2.0 * pi * sqrt(mass * softest)),
        inf if rigid else 1.0 / (2.0 * pi * sqrt(mass * stiffest)),
    )


# Models that the paper's table has numbers of, with the headline number that these are.
_IN_PAPER = {"vjm": ("paper.vjm",), "vjm-equivalent": ("paper.vjm",)}


@cases.case(
    "robot.anchor.statics[{model}, {entry}]",
    TITLE,
    over={"of": ("The robot",), "model": CANDIDATES, "entry, said, unit": _entries},
    headlines=lambda model: (f"robot.statics.{model}", *_IN_PAPER.get(model, ())),
    quantity="{said}, posture of the largest difference",
)
def _static(context: Context, model: str, entry: str) -> Measurement:
    robot, index = context.robot, AXES.index(entry)
    kind, _, options = CANDIDATES[model]
    found = context.get(shown_statics, robot, model)[:, index]
    if model == "simplified":
        on_drives = context.get(yielding, robot)
        expected = other = on_drives[:, index]
        softest = on_drives.max()
    else:
        legs: ritz.Legs = "given" if model == "vjm" else options.theory
        expected, other = (
            context.get(expected_statics, robot, legs, degree)[:, index] for degree in EXACT
        )
        softest = expected.max()
    # At an end of the stroke rigid legs do not let B move along x: rounding is compared with none.
    if not (known := expected > _RIGID * softest).any():
        raise Skip(f"{model}: legs and drives do not let B move so")
    at = farthest(found, expected, known)
    x = float(robot.stations(POSTURES)[at])
    left_open = 0.0
    if model != "simplified":
        left_open = context.get(rounded_compliance, kind, robot, x, options)[index, index]
    return Measurement(
        in_shown_units(found[at], entry),
        in_shown_units(expected[at], entry),
        value_uncertainty=in_shown_units(left_open, entry),
        reference_uncertainty=in_shown_units(rounding(expected[at], other[at]), entry),
        decides=BEYOND_ROUNDING,
        pose=(x,),
    )


@cases.case(
    "robot.anchor.frequencies[{model}, {mode}]",
    "The robot: frequency {mode} by {model}, obtained once more without its code",
    over={
        "model, tolerance, tolerance_reason": tuple(
            (model, *_DYNAMIC[kind])
            for model, (kind, _, _) in CANDIDATES.items()
            if kind in _DYNAMIC
        ),
        "index, mode": lambda model, modes: numbered(
            min(modes, _DRIVES) if model == "simplified" else modes
        ),
    },
    headlines=lambda model: (
        f"robot.frequencies.{model}",
        *(("paper.simplified",) if model == "simplified" else ()),
    ),
    quantity="natural frequency {mode}, posture of the largest difference",
    unit="Hz",
    row="The robot, first screen",
    # Of the models' modes, which the assessment needs as well.
    group="robot.solid.modes",
    effort=0.3,
    figure="frequency.stroke",
)
def _frequency(context: Context, model: str, index: int, modes: int) -> Measurement:
    robot, (kind, _, options) = context.robot, CANDIDATES[model]
    x = robot.stations(POSTURES).tolist()
    asked = context, robot, POSTURES, kind, options
    found = model_vibration(*asked).frequencies[:, index]
    if kind == "simplified":
        expected = rougher = context.get(swinging, robot)[:, index]
    else:
        expected, rougher = (
            context.get(expected_frequencies, robot, options.theory, modes, degree)[:, index]
            for degree in (ritz.DEGREE, ritz.DEGREE - 2)
        )
    at = farthest(found, expected, np.isfinite(expected))

    def left_open(posture: int) -> float:
        by_polynomials = rounding(float(expected[posture]), float(rougher[posture]))
        if kind == "simplified":
            return by_polynomials
        _, own = context.get(rounded_frequencies, kind, robot, x[posture], modes, options)
        return hypot(by_polynomials, own[index])

    explained: tuple[Allowance, ...] = ()
    elsewhere: tuple[Elsewhere, ...] = ()
    if kind == "segments":
        by_theory = options.theory
        missed = [
            context.get(ritz.missed_by_segments, robot, p, modes, by_theory)[index] for p in x
        ]
        explained = (segments.explained(missed[at]),)
        # The largest difference may be the best explained one.
        uncertain = [left_open(posture) for posture in range(len(x))]
        elsewhere = others(at_stations(x), found, expected, uncertain, at, missed)
    return Measurement(
        float(found[at]),
        float(expected[at]),
        # What 20 elements leave is what is judged: rounding alone leaves it uncertain.
        judged_uncertainty=left_open(at),
        allowances=explained,
        decides=BEYOND_ROUNDING,
        pose=(x[at],),
        elsewhere=elsewhere,
    )
