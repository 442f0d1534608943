"""Statements about deflections over the stroke (paper §2.1 and §2.2)."""

from dataclasses import replace

import numpy as np

from lumped.robot_file import RobotFile
from validation.case import Absolute, Measurement, Relation
from validation.context import Context
from validation.models.options import ModelName, ModelOptions
from validation.paper.robot import Deflections, deflections, foot_compliances, over_stroke
from validation.paper.statement import PAPER, POSTURES, Statements, sampled

# L_Tool of the appendix (m): from B to the tool's point P.
_TOOL_LENGTH = 0.155
# One step of the stroke (%): a place on it is known no better.
_PLACE = 100.0 / (POSTURES - 1)
_EXTREMA = {"peak": np.argmax, "trough": np.argmin}
statements = Statements(**PAPER)


def _deflected(
    context: Context, model: ModelName, postures: int = POSTURES, other: RobotFile | None = None
) -> Deflections:
    """Over the stroke, of the paper's robot or another."""
    places = over_stroke((other or context.robot_file).mechanism, postures)
    return context.get(deflections, model, places)


@statements.says(
    "foot-stiffness",
    "§2.1",
    "The feet's stiffness along y is about 1e9 N/m",
    quantity="(k_Foot⁻¹)₂₂",
    unit="GN/m",
    tolerance=Absolute(0.1),
    tolerance_reason="half a unit in the second digit that 'about' leaves open",
    differs="k_Foot(6,6)",
    circular="it chose the correction of k_Foot(6,6)",
)
def _foot_stiffness(context: Context, reading: ModelOptions) -> Measurement:
    robot_file = context.robot_file
    printed, used = foot_compliances(robot_file)
    if reading.release == "printed":
        return Measurement(float(np.linalg.inv(printed)[1, 1]) / 1e9, reference=1.0, exact=True)
    softer = robot_file.with_values({"foot.compliance[6,6]": 2.0 * float(used[5, 5])})
    there, here = (_deflected(context, "vjm", other=one) for one in (softer, robot_file))
    moved = there.largest_planar / here.largest_planar - 1.0
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


simplified = statements.family(figure="deflection.stroke")


@simplified.says(
    "simplified.largest-deflection",
    "§2.1, Fig. 3",
    "Simplified model: planar deflections stay below 1.1 µm at 1000 N",
    quantity="largest planar deflection over the stroke",
    unit="µm",
    tolerance=Absolute(0.05),
    tolerance_reason="half a unit in the last printed digit",
    relation=Relation.AT_MOST,
)
def _largest_simplified(context: Context) -> Measurement:
    def largest(postures: int) -> float:
        return _deflected(context, "simplified", postures).largest_planar

    return sampled(largest, reference=1.1)


@simplified.says(
    "simplified.x-zero-at-ends",
    "§2.1, Fig. 3",
    "Simplified model: a force along x deflects nothing at both ends of the stroke",
    quantity="larger of the two deflections",
    unit="µm",
    tolerance=Absolute(1e-6),
    tolerance_reason="a millionth of the largest deflection: s = √(L² − x²) amplifies rounding to "
    "1e-8",
)
def _x_at_the_ends(context: Context) -> Measurement:
    planar = _deflected(context, "simplified").planar_x
    return Measurement(max(planar[0], planar[-1]), reference=0.0, exact=True)


@simplified.says(
    "simplified.y-largest-at-ends",
    "§2.1, Fig. 3",
    "Simplified model: a force along y deflects most at the ends of the stroke",
    quantity="distance of the maximum of each half from its end, of the stroke",
    unit="%",
    tolerance=Absolute(_PLACE),
    tolerance_reason=f"one of the {POSTURES - 1} steps of the stroke",
)
def _y_largest_at_the_ends(context: Context) -> Measurement:
    planar = _deflected(context, "simplified").planar_y
    half = POSTURES // 2
    left = int(np.argmax(planar[: half + 1]))
    right = half - int(np.argmax(planar[half:]))
    return Measurement(_PLACE * max(left, right), reference=0.0, value_uncertainty=_PLACE)


refined = statements.family(figure="deflection.stroke")


@refined.says(
    "refined.planar-ratio",
    "§2.2, Figs 3 and 5",
    "Virtual joints: planar deflections are about 10 times those of the simplified model",
    quantity="ratio of the largest planar deflections",
    tolerance=Absolute(2.9),
    tolerance_reason="'about 10' on a scale of 5, 10, 20 covers 7.1 to 14: 10 − 10/√2 below it",
)
def _refined_over_simplified(context: Context) -> Measurement:
    def ratio(postures: int) -> float:
        by_both = (_deflected(context, model, postures) for model in ("vjm", "simplified"))
        by_joints, by_drives = (found.largest_planar for found in by_both)
        return by_joints / by_drives

    return sampled(ratio, reference=10.0)


@refined.says(
    "refined.z-ratio",
    "§2.2, Fig. 5",
    "Virtual joints: deflections along z are 3 times larger than planar ones",
    quantity="ratio of the largest deflections",
    tolerance=Absolute(0.5),
    tolerance_reason="half a unit in the printed digit",
)
def _z_over_planar(context: Context) -> Measurement:
    at_tool = context.robot_file.with_values({"geometry.tool_offset[3]": _TOOL_LENGTH})

    def ratio(postures: int, other: RobotFile | None = None) -> float:
        found = _deflected(context, "vjm", postures, other)
        return float(found.along_z.max()) / found.largest_planar

    return replace(
        sampled(ratio, reference=3.0),
        notes=(
            f"Loads act at B. At the tool's point P, {_TOOL_LENGTH:g} m along z, the ratio is "
            f"{ratio(POSTURES, at_tool):.2f}: 'the extremity of the robot' of §2.2 is B.",
        ),
    )


@refined.says(
    "refined.profile-{axis}",
    "§2.2, Figs 3 and 5",
    "Virtual joints keep the simplified curve's profile: the {what} under a force along {axis}",
    over={
        "axis, what, tolerance, tolerance_reason": (
            (
                "x",
                "peak",
                Absolute(10.0),
                "a tenth of the stroke: further apart, two curves of one hump look different",
            ),
            (
                "y",
                "trough",
                Absolute(15.0),
                "the trough is flat: its place is softer than a peak's, 15 % of the stroke",
            ),
        )
    },
    quantity="place of the {what}, of the stroke",
    unit="%",
    sentence="Virtual joints keep the profile of the simplified model's curves",
    curves={"{what} under a force along {axis}": {}},
)
def _profile(context: Context, axis: str, what: str) -> Measurement:
    both = (getattr(_deflected(context, by), f"planar_{axis}") for by in ("vjm", "simplified"))
    refined, simplified = (_PLACE * int(_EXTREMA[what](curve)) for curve in both)
    return Measurement(refined, simplified, value_uncertainty=_PLACE, reference_uncertainty=_PLACE)
