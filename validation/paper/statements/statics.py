"""Statements about deflections over the stroke (paper §2.1 and §2.2)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.robot_file import RobotFile
from validation.case import Absolute, Measurement, Relation, Sides
from validation.context import Context
from validation.models.options import ModelOptions
from validation.paper.robot import (
    Deflections,
    deflections,
    foot_compliances,
    over_stroke,
)
from validation.paper.statements.statement import (
    POSTURES,
    SIMPLIFIED,
    VJM,
    Compute,
    Statement,
    sampled,
)

# L_Tool of the appendix (m): from B to the tool's point P.
_TOOL_LENGTH = 0.155
# One step of the stroke (%): a place on it is known no better.
_PLACE = 100.0 / (POSTURES - 1)


def _simplified(context: Context, postures: int = POSTURES) -> Deflections:
    places = over_stroke(context.robot_file.mechanism, postures)
    return context.get(deflections, "simplified", places)


def _refined(
    context: Context, postures: int = POSTURES, other: RobotFile | None = None
) -> Deflections:
    """By virtual joints, of the paper's robot or another."""
    robot_file = other or context.robot_file
    return context.get(deflections, "vjm", over_stroke(robot_file.mechanism, postures))


def _largest_simplified(context: Context, _reading: ModelOptions) -> Measurement:
    return sampled(lambda postures: _simplified(context, postures).largest_planar, reference=1.1)


def _x_at_the_ends(context: Context, _reading: ModelOptions) -> Measurement:
    planar = _simplified(context).planar_x
    return Measurement(max(planar[0], planar[-1]), reference=0.0, exact=True)


def _y_largest_at_the_ends(context: Context, _reading: ModelOptions) -> Measurement:
    planar = _simplified(context).planar_y
    half = POSTURES // 2
    left = int(np.argmax(planar[: half + 1]))
    right = half - int(np.argmax(planar[half:]))
    return Measurement(_PLACE * max(left, right), reference=0.0, value_uncertainty=_PLACE)


def _refined_over_simplified(context: Context, _reading: ModelOptions) -> Measurement:
    def ratio(postures: int) -> float:
        refined, simplified = _refined(context, postures), _simplified(context, postures)
        return refined.largest_planar / simplified.largest_planar

    return sampled(ratio, reference=10.0)


def _z_over_planar(context: Context, _reading: ModelOptions) -> Measurement:
    at_tool = context.robot_file.with_values({"geometry.tool_offset[3]": _TOOL_LENGTH})
    there = _refined(context, other=at_tool)

    def ratio(postures: int) -> float:
        found = _refined(context, postures)
        return float(found.along_z.max()) / found.largest_planar

    return replace(
        sampled(ratio, reference=3.0),
        notes=(
            f"Loads act at B. At the tool's point P, {_TOOL_LENGTH:g} m along z, the ratio is "
            f"{float(there.along_z.max()) / there.largest_planar:.2f}: 'the extremity of the "
            "robot' of §2.2 is B.",
        ),
    )


def _profile(curve: str, extremum: Callable[[Array], np.intp]) -> Compute:
    def compute(context: Context, _reading: ModelOptions) -> Measurement:
        place = [
            _PLACE * int(extremum(getattr(found, curve)))
            for found in (_refined(context), _simplified(context))
        ]
        return Measurement(
            value=place[0],
            reference=place[1],
            value_uncertainty=_PLACE,
            reference_uncertainty=_PLACE,
        )

    return compute


def _foot_stiffness(context: Context, reading: ModelOptions) -> Measurement:
    robot_file = context.robot_file
    printed, used = foot_compliances(robot_file)
    if reading.release == "printed":
        return Measurement(float(np.linalg.inv(printed)[1, 1]) / 1e9, reference=1.0, exact=True)
    softer = robot_file.with_values({"foot.compliance[6,6]": 2.0 * float(used[5, 5])})
    moved = _refined(context, other=softer).largest_planar / _refined(context).largest_planar - 1.0
    return Measurement(
        float(np.linalg.inv(used)[1, 1]) / 1e9,
        reference=1.0,
        exact=True,
        notes=(
            "This very number chose the correction of k66, so that it bears nothing out. The "
            "joint beside the foot lets no moment about z through: with k66 twice as large the "
            f"largest planar deflection moves by {100.0 * moved:.1g} %, and only eq. (25) as "
            "printed depends on it.",
        ),
    )


_PROFILE = "Virtual joints keep the profile of the simplified model's curves"
STATEMENTS = (
    Statement(
        "foot-stiffness",
        "§2.1",
        "The feet's stiffness along y is about 1e9 N/m",
        "(k_Foot⁻¹)₂₂",
        "GN/m",
        Absolute(0.1),
        "half a unit in the second digit that 'about' leaves open",
        _foot_stiffness,
        Sides((foot_compliances,)),
        differs="k_Foot(6,6)",
        circular="it chose the correction of k_Foot(6,6)",
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
        SIMPLIFIED,
        Relation.AT_MOST,
        figure="deflection.simplified",
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
        SIMPLIFIED,
        figure="deflection.simplified",
    ),
    Statement(
        "simplified.y-largest-at-ends",
        "§2.1, Fig. 3",
        "Simplified model: a force along y deflects most at the ends of the stroke",
        "distance of the maximum of each half from its end, of the stroke",
        "%",
        Absolute(_PLACE),
        f"one of the {POSTURES - 1} steps of the stroke",
        _y_largest_at_the_ends,
        SIMPLIFIED,
        figure="deflection.simplified",
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
        Sides(VJM.value, SIMPLIFIED.value),
        figure="deflection.stroke",
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
        VJM,
        figure="deflection.stroke",
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
        Sides(VJM.value, SIMPLIFIED.value),
        sentence=_PROFILE,
        curves={"peak under a force along x": _profile("planar_x", np.argmax)},
        figure="deflection.stroke",
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
        Sides(VJM.value, SIMPLIFIED.value),
        sentence=_PROFILE,
        curves={"trough under a force along y": _profile("planar_y", np.argmin)},
        figure="deflection.stroke",
    ),
)
