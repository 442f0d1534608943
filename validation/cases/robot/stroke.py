"""The whole robot over its stroke: virtual joints, segments and beams against each other."""

from collections.abc import Sequence

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import Theory
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Measurement, Relative, others
from validation.case_group import CaseGroup, numbered
from validation.context import Context
from validation.exhibits import STROKE, Study
from validation.models.biglide import rounded_compliance
from validation.models.options import BEAM_ORDER, SEGMENT_ORDER, ModelName, ModelOptions
from validation.studies.quantities import (
    Deflections,
    deflections_of,
    farthest,
    rounded_frequencies,
    stroke_compliances,
    stroke_deflections,
    stroke_frequencies,
)
from validation.studies.ritz import biglide as ritz
from validation.studies.ritz import segments

POSTURES = 9
# Where cases compare, so that runs can be compared; the other postures are judged beside it.
MIDDLE = POSTURES // 2
FREQUENCIES = 4
# What a comparison says whose uncertainties are those of rounding alone.
BEYOND_ROUNDING = (
    "double precision leaves so much open where stiffnesses differ widely or legs nearly align, "
    "and no finer model narrows it"
)
_JOINTS: ModelName = "vjm"
# Name, attribute of `Deflections`, and meaning.
CURVES = (
    ("planar-x", "planar_x", "planar deflection under 1000 N along x"),
    ("planar-y", "planar_y", "planar deflection under 1000 N along y"),
    ("along-z", "along_z", "deflection along z under 1000 N along z"),
)
THEORIES: tuple[Theory, ...] = ("euler-bernoulli", "timoshenko")
_NAMES: dict[Theory, str] = {"euler-bernoulli": "Euler–Bernoulli", "timoshenko": "Timoshenko"}
# What a model's name has behind it where its theory is not the usual one.
_OTHER_THEORY: dict[Theory, str] = {"timoshenko": "", "euler-bernoulli": "-euler-bernoulli"}
# A finer beam model for the discretisation error of the frequencies.
_FINE, _COARSE = 40, 20

cases = CaseGroup(section=STROKE, group="robot.statics")


def _deflections(context: Context, model: ModelName, theory: Theory) -> Deflections:
    options = ModelOptions(legs="equivalent", theory=theory)
    return context.get(stroke_deflections, model, context.robot, POSTURES, options)


@cases.case(
    "robot.statics.{model}-vjm.{name}[{theory}]",
    "The {model} model gives the virtual joints' {meaning} ({theory} legs)",
    over={"model": ("segments", "beam"), "theory": THEORIES, "name, curve, meaning": CURVES},
    headlines=lambda model, theory: (f"robot.statics.{model}{_OTHER_THEORY[theory]}",),
    quantity="{meaning}, middle of the stroke",
    unit="µm",
    reference_kind="independent-solver",
    citation="virtual joint method, eqs (3) to (9), same equivalent legs",
    tolerance=Relative(1e-7),
    tolerance_reason="three formulations of one statics: rounding alone may differ, grown by the "
    "robot's condition, 1e8 with slender open legs (EA L² over GJ) or legs in line",
    row="{theory}",
    figure="deflection.stroke",
)
def _static(
    context: Context, model: ModelName, theory: Theory, curve: str, meaning: str
) -> Measurement:
    found: Array = getattr(_deflections(context, model, theory), curve)
    reference: Array = getattr(_deflections(context, "vjm", theory), curve)
    stations = tuple(context.robot.stations(POSTURES).tolist())
    sweep = Study(
        id=f"robot.statics.{curve}.{model}.{theory}",
        kind="sweep",
        title=f"{curve.replace('_', ' ')}: {model} and virtual joints ({_NAMES[theory]})",
        x_label="x (m)",
        y_label="deflection (µm)",
        unit="µm",
        x=stations,
        series={"vjm": tuple(reference.tolist()), model: tuple(found.tolist())},
        family=f"robot.statics.{curve}",
        family_title=f"{meaning}: models of equivalent legs",
        variant=_NAMES[theory],
    )
    open_of_value, open_of_reference = (
        np.array([float(getattr(_rounding(context, name, theory, x), curve)[0]) for x in stations])
        for name in (model, _JOINTS)
    )
    uncertain = np.hypot(open_of_value, open_of_reference)
    return Measurement(
        float(found[MIDDLE]),
        float(reference[MIDDLE]),
        value_uncertainty=float(open_of_value[MIDDLE]),
        reference_uncertainty=float(open_of_reference[MIDDLE]),
        notes=(largest_difference(stations, found, reference),),
        decides=BEYOND_ROUNDING,
        pose=(stations[MIDDLE],),
        elsewhere=others(at_stations(stations), found, reference, uncertain, MIDDLE),
        studies=(sweep,),
    )


def at_stations(stations: Sequence[float]) -> list[str]:
    """The postures of a stroke by the place of B (m), for messages."""
    return [f"x = {x:.4g} m" for x in stations]


def largest_difference(stations: Sequence[float], found: Array, reference: Array) -> str:
    """Where over the stroke a difference is largest, relatively: for the reader alone."""
    worst = farthest(found, reference)
    percent = 100.0 * abs(float(found[worst] / reference[worst]) - 1.0)
    return f"largest difference over the stroke at x = {stations[worst]:.4g} m: {percent:.2g} %"


def _rounding(context: Context, model: ModelName, theory: Theory, x: float) -> Deflections:
    options = ModelOptions(legs="equivalent", theory=theory)
    return context.get(rounded_deflections, model, context.robot, x, options)


def rounded_deflections(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions
) -> Deflections:
    """What rounding leaves open of a model's deflections with B at `x` (m)."""
    return deflections_of(rounded_compliance(model, robot, x, options)[np.newaxis])


@cases.case(
    "robot.frequency.segments-beam[{mode}]",
    "Frequency {mode} of the robot in segments is that of the beam model",
    over={"index, mode": numbered(FREQUENCIES)},
    quantity="natural frequency {mode}, middle of the stroke",
    unit="Hz",
    reference_kind="finer-model",
    citation=f"Timoshenko beams, {_FINE} elements per leg, consistent mass",
    tolerance=segments.TOLERANCE,
    tolerance_reason=segments.REASON,
    model="segments",
    headlines=("robot.frequencies.segments",),
    group="robot.frequencies",
    figure="frequency.stroke",
    effort=0.3,
)
def _frequency(context: Context, index: int) -> Measurement:
    robot, x = context.robot, context.robot.stations(POSTURES).tolist()
    found, halved = (
        context.get(stroke_frequencies, "segments", robot, POSTURES, FREQUENCIES, options)
        for options in (ModelOptions(), ModelOptions(elements=_COARSE // 2))
    )
    coarse = context.get(
        stroke_frequencies, "beam", robot, POSTURES, FREQUENCIES, ModelOptions(elements=_COARSE)
    )
    _, open_of_value = _swung(context, "segments", ModelOptions(), index)
    reference, open_of_reference = _swung(context, "beam", ModelOptions(elements=_FINE), index)
    value = found[:, index]
    missed = np.array(
        [context.get(ritz.missed_by_segments, robot, at, FREQUENCIES)[index] for at in x]
    )
    of_segments, of_beams = (step_factor(2.0, order) for order in (SEGMENT_ORDER, BEAM_ORDER))
    uncertain = np.hypot(of_beams * np.abs(reference - coarse[:, index]), open_of_reference)
    # Of what 20 segments leave the second order is explained, the rest is what is judged: beams
    # and rounding alone leave it uncertain.
    judged = np.hypot(uncertain, open_of_value)
    return Measurement(
        float(value[MIDDLE]),
        float(reference[MIDDLE]),
        value_uncertainty=of_segments * float(abs(value - halved[:, index])[MIDDLE]),
        reference_uncertainty=float(uncertain[MIDDLE]),
        judged_uncertainty=float(judged[MIDDLE]),
        allowances=(segments.explained(missed[MIDDLE]),),
        notes=(largest_difference(x, value, reference),),
        decides=BEYOND_ROUNDING,
        pose=(x[MIDDLE],),
        elsewhere=others(at_stations(x), value, reference, judged, MIDDLE, missed),
    )


def _swung(
    context: Context, model: ModelName, options: ModelOptions, index: int
) -> tuple[Array, Array]:
    """A frequency (Hz) over the stroke, and what rounding leaves open of it."""
    robot = context.robot
    found = [
        context.get(rounded_frequencies, model, robot, x, FREQUENCIES, options)
        for x in robot.stations(POSTURES)
    ]
    frequencies, left_open = np.array(found)[..., index].T
    return frequencies, left_open


@cases.case(
    "robot.statics.vjm-symmetric",
    "The virtual joints' compliance with the legs as given is symmetric and positive",
    quantity="asymmetry of the 6×6 in units of √(c_ii c_jj), or the negative eigenvalue",
    unit="1",
    reference_kind="closed-form",
    citation="Maxwell and Betti: the work of two loads does not depend on their order",
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding alone",
    model="vjm",
)
def _symmetry(context: Context) -> Measurement:
    compliances = context.get(stroke_compliances, "vjm", context.robot, POSTURES)
    worst = 0.0
    for compliance in compliances:
        scale = 1.0 / np.sqrt(np.diag(compliance))
        scaled = compliance * scale[:, None] * scale
        lowest = float(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0])
        worst = max(worst, float(np.abs(scaled - scaled.T).max()), 0.0, -lowest)
    largest = deflections_of(compliances)
    return Measurement(
        worst,
        reference=0.0,
        exact=True,
        notes=(
            f"largest planar deflection {largest.largest_planar:.3g} µm, along z "
            f"{largest.along_z.max():.3g} µm at 1000 N",
        ),
    )
