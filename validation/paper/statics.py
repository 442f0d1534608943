"""Cases on the paper's statements about deflections over the stroke (§2.1 and §2.2).

Input: deflections of the paper's robot under 1000 N over its stroke. Output: a verdict on each
statement.
"""

from dataclasses import replace

import numpy as np

from lumped.robot_file import RobotFile
from validation.case import Absolute, Measurement, Relation
from validation.context import Context
from validation.models.options import ModelName, ModelOptions
from validation.paper.robot import Deflections, deflections, foot_compliances, over_stroke
from validation.paper.statement import PAPER, POSTURES, Statements, sampled

# Distance (m) from point B to the tool's point P: L_Tool of the appendix.
_TOOL_LENGTH = 0.155
# Distance between neighbouring postures in % of the stroke, which is the uncertainty of the
# position of a posture.
_STEP = 100.0 / (POSTURES - 1)
_EXTREMA = {"peak": np.argmax, "trough": np.argmin}
statements = Statements(**PAPER)


def _stroke_deflections(
    context: Context,
    model: ModelName,
    postures: int = POSTURES,
    robot_file: RobotFile | None = None,
) -> Deflections:
    """Deflections over the stroke of the paper's robot, or of another `robot_file`."""
    robots = over_stroke((robot_file or context.robot_file).mechanism, postures)
    return context.get(deflections, model, robots)


@statements.statement(
    "foot-stiffness",
    "§2.1",
    "The feet's stiffness along y is about 1e9 N/m",
    quantity="(k_Foot⁻¹)₂₂",
    unit="GN/m",
    tolerance=Absolute(0.1),
    tolerance_reason="half a unit in the second digit, which 'about' leaves open",
    corrections="k_Foot(6,6)",
    circular="it decided the correction of k_Foot(6,6)",
)
def _foot_stiffness(context: Context, variant: ModelOptions) -> Measurement:
    robot_file = context.robot_file
    printed, used = foot_compliances(robot_file)
    if variant.release == "printed":
        return Measurement(float(np.linalg.inv(printed)[1, 1]) / 1e9, reference=1.0, exact=True)
    softer_foot = robot_file.with_values({"foot.compliance[6,6]": 2.0 * float(used[5, 5])})
    softer = _stroke_deflections(context, "vjm", robot_file=softer_foot).largest_planar
    change = softer / _stroke_deflections(context, "vjm").largest_planar - 1.0
    return Measurement(
        float(np.linalg.inv(used)[1, 1]) / 1e9,
        reference=1.0,
        exact=True,
        notes=(
            "This number decided the correction of k66 and therefore proves nothing. The joint "
            "next to the foot transmits no moment about z: with k66 twice as large the largest "
            f"planar deflection changes by {100.0 * change:.1g} %. Only eq. (25) as printed "
            "depends on k66.",
        ),
    )


simplified = statements.family(figure="deflection.stroke")


@simplified.statement(
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
        return _stroke_deflections(context, "simplified", postures).largest_planar

    return sampled(largest, reference=1.1)


@simplified.statement(
    "simplified.x-zero-at-ends",
    "§2.1, Fig. 3",
    "Simplified model: a force along x causes no deflection at both ends of the stroke",
    quantity="larger of the two deflections",
    unit="µm",
    tolerance=Absolute(1e-6),
    tolerance_reason="a millionth of the largest deflection: s = √(L² − x²) amplifies rounding to "
    "1e-8",
)
def _x_at_the_ends(context: Context) -> Measurement:
    planar = _stroke_deflections(context, "simplified").planar_x
    return Measurement(max(planar[0], planar[-1]), reference=0.0, exact=True)


@simplified.statement(
    "simplified.y-largest-at-ends",
    "§2.1, Fig. 3",
    "Simplified model: the deflection under a force along y is largest at the ends of the stroke",
    quantity="distance of the maximum of each half from its end, in % of the stroke",
    unit="%",
    tolerance=Absolute(_STEP),
    tolerance_reason=f"one of the {POSTURES - 1} steps of the stroke",
)
def _y_largest_at_the_ends(context: Context) -> Measurement:
    planar = _stroke_deflections(context, "simplified").planar_y
    half = POSTURES // 2
    steps_to_left = int(np.argmax(planar[: half + 1]))
    steps_to_right = half - int(np.argmax(planar[half:]))
    distance = _STEP * max(steps_to_left, steps_to_right)
    return Measurement(distance, reference=0.0, value_uncertainty=_STEP)


refined = statements.family(figure="deflection.stroke")


@refined.statement(
    "refined.planar-ratio",
    "§2.2, Figs 3 and 5",
    "Virtual joints: planar deflections are about 10 times those of the simplified model",
    quantity="ratio of the largest planar deflections",
    tolerance=Absolute(2.9),
    tolerance_reason="'about 10' on a scale of 5, 10, 20 covers 7.1 to 14: 10 − 10/√2 below it",
)
def _refined_over_simplified(context: Context) -> Measurement:
    def ratio(postures: int) -> float:
        refined = _stroke_deflections(context, "vjm", postures).largest_planar
        return refined / _stroke_deflections(context, "simplified", postures).largest_planar

    return sampled(ratio, reference=10.0)


@refined.statement(
    "refined.z-ratio",
    "§2.2, Fig. 5",
    "Virtual joints: deflections along z are 3 times larger than planar ones",
    quantity="ratio of the largest deflections",
    tolerance=Absolute(0.5),
    tolerance_reason="half a unit in the printed digit",
)
def _z_over_planar(context: Context) -> Measurement:
    loaded_at_tool = context.robot_file.with_values({"geometry.tool_offset[3]": _TOOL_LENGTH})

    def ratio(postures: int, robot_file: RobotFile | None = None) -> float:
        deflection = _stroke_deflections(context, "vjm", postures, robot_file)
        return float(deflection.along_z.max()) / deflection.largest_planar

    return replace(
        sampled(ratio, reference=3.0),
        notes=(
            f"Loads act at B. At the tool's point P, {_TOOL_LENGTH:g} m along z, the ratio is "
            f"{ratio(POSTURES, loaded_at_tool):.2f}. 'The extremity of the robot' in §2.2 is "
            "therefore B.",
        ),
    )


@refined.statement(
    "refined.profile-{axis}",
    "§2.2, Figs 3 and 5",
    "Virtual joints keep the simplified curve's profile: the {extremum} under a force along {axis}",
    over={
        "axis, extremum, tolerance, tolerance_reason": (
            (
                "x",
                "peak",
                Absolute(10.0),
                "a tenth of the stroke: two curves with one peak look different if their peaks are "
                "further apart",
            ),
            (
                "y",
                "trough",
                Absolute(15.0),
                "the trough is flat, so that its position is less certain than a peak's: 15 % of "
                "the stroke",
            ),
        )
    },
    quantity="position of the {extremum}, in % of the stroke",
    unit="%",
    sentence="Virtual joints keep the profile of the simplified model's curves",
    curves={"{extremum} under a force along {axis}": {}},
)
def _profile(context: Context, axis: str, extremum: str) -> Measurement:
    def position(model: ModelName) -> float:
        curve = getattr(_stroke_deflections(context, model), f"planar_{axis}")
        return _STEP * int(_EXTREMA[extremum](curve))

    refined, simplified = position("vjm"), position("simplified")
    return Measurement(refined, simplified, value_uncertainty=_STEP, reference_uncertainty=_STEP)
