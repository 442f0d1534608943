"""Statements about deflections over the stroke (paper §2.1 and §2.2)."""

from collections.abc import Callable

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement, Relation, Skip
from validation.cases.paper_statement import POSTURES, Statement
from validation.context import Context
from validation.quantities import Deflections, stroke_deflections


def _simplified(context: Context) -> Deflections:
    return context.get(stroke_deflections, "simplified", context.robot, POSTURES)


def _refined(context: Context) -> Deflections:
    return context.get(stroke_deflections, "vjm", context.robot, POSTURES)


def _largest_simplified(context: Context) -> Measurement:
    return Measurement(_simplified(context).largest_planar, reference=1.1)


def _x_at_the_ends(context: Context) -> Measurement:
    planar = _simplified(context).planar_x
    return Measurement(max(planar[0], planar[-1]), reference=0.0)


def _y_largest_at_the_ends(context: Context) -> Measurement:
    planar = _simplified(context).planar_y
    half = POSTURES // 2
    left = int(np.argmax(planar[: half + 1]))
    right = half - int(np.argmax(planar[half:]))
    return Measurement(100.0 * max(left, right) / (POSTURES - 1), reference=0.0)


def _refined_over_simplified(context: Context) -> Measurement:
    ratio = _refined(context).largest_planar / _simplified(context).largest_planar
    return Measurement(ratio, reference=10.0)


def _z_over_planar(context: Context) -> Measurement:
    refined = _refined(context)
    return Measurement(float(refined.along_z.max()) / refined.largest_planar, reference=3.0)


def _profile(curve: str, extremum: Callable[[Array], np.intp]) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        place = [
            100.0 * int(extremum(getattr(deflections, curve))) / (POSTURES - 1)
            for deflections in (_refined(context), _simplified(context))
        ]
        return Measurement(value=place[0], reference=place[1])

    return compute


def _foot_stiffness(context: Context) -> Measurement:
    foot = context.robot.foot_compliance
    if foot is None:
        raise Skip("the robot has rigid feet")
    return Measurement(float(np.linalg.inv(foot)[1, 1]) / 1e9, reference=1.0)


STATEMENTS = (
    Statement(
        "foot-stiffness",
        "§2.1",
        "The feet's stiffness along y is about 1e9 N/m",
        "(k_Foot⁻¹)₂₂ of the corrected matrix",
        "GN/m",
        Absolute(0.1),
        "half a unit in the second digit that 'about' leaves open",
        _foot_stiffness,
    ),
    Statement(
        "simplified.largest-deflection",
        "§2.1, Fig. 3",
        "Simplified model: planar deflections stay below 1.1 µm at 1000 N",
        "largest planar deflection over the stroke",
        "µm",
        Absolute(0.05),
        "half a unit in the last printed digit",
        _largest_simplified,
        Relation.AT_MOST,
    ),
    Statement(
        "simplified.x-zero-at-ends",
        "§2.1, Fig. 3",
        "Simplified model: a force along x deflects nothing at both ends of the stroke",
        "larger of the two deflections",
        "µm",
        Absolute(1e-6),
        "a millionth of the largest deflection: s = √(L² − x²) amplifies rounding to 1e-8",
        _x_at_the_ends,
    ),
    Statement(
        "simplified.y-largest-at-ends",
        "§2.1, Fig. 3",
        "Simplified model: a force along y deflects most at the ends of the stroke",
        "distance of the maximum of each half from its end, of the stroke",
        "%",
        Absolute(100.0 / (POSTURES - 1)),
        f"one of the {POSTURES - 1} steps of the stroke",
        _y_largest_at_the_ends,
    ),
    Statement(
        "refined.planar-ratio",
        "§2.2, Figs 3 and 5",
        "Virtual joints: planar deflections are about 10 times those of the simplified model",
        "ratio of the largest planar deflections",
        "1",
        Absolute(2.9),
        "'about 10' on a scale of 5, 10, 20 covers 7.1 to 14: 10 − 10/√2 below it",
        _refined_over_simplified,
    ),
    Statement(
        "refined.z-ratio",
        "§2.2, Fig. 5",
        "Virtual joints: deflections along z are 3 times larger than planar ones",
        "ratio of the largest deflections",
        "1",
        Absolute(0.5),
        "half a unit in the printed digit",
        _z_over_planar,
    ),
    Statement(
        "refined.profile-x",
        "§2.2, Figs 3 and 5",
        "Virtual joints keep the simplified curve's profile: the peak under a force along x",
        "place of the peak, of the stroke",
        "%",
        Absolute(10.0),
        "a tenth of the stroke: further apart, two curves of one hump look different",
        _profile("planar_x", np.argmax),
    ),
    Statement(
        "refined.profile-y",
        "§2.2, Figs 3 and 5",
        "Virtual joints keep the simplified curve's profile: the trough under a force along y",
        "place of the trough, of the stroke",
        "%",
        Absolute(15.0),
        "the trough is flat: its place is softer than a peak's, 15 % of the stroke",
        _profile("planar_y", np.argmin),
    ),
)
