"""Guards of the whole robot: the same once more as a frame of beams placed by coordinates.

Masses and stiffnesses are taken from the robot file again, and so are the members of the family.
"""

from collections.abc import Callable
from dataclasses import replace
from math import sqrt

import numpy as np
from scipy.sparse import csr_array

from fem.beams.frame import (
    AssembledFrame,
    Frame,
    Member,
    PointMass,
    Spring,
    assemble,
    displacements,
)
from fem.beams.frame import modes as frame_modes
from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide, scaled
from lumped.legs import ConstantLeg, Material, equivalent_leg
from lumped.sections import ISection
from validation.agreement.differences import farthest_off, scaled_difference
from validation.case import Absolute, Measurement, Relative
from validation.case_group import CaseGroup
from validation.context import Context
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import ModelName, ModelOptions

SECTION = "Guards"
ELEMENTS = 12
MODES = 6
_UPWARDS = (0.0, 0.0, 1.0)
_SAME = 1e-7
_SAME_REASON = (
    "one statics and one set of elements, assembled twice: rounding, grown by the condition of "
    "slender legs and of long lever arms"
)
_OFFSET = np.array([0.05, -0.08, 0.155])
_TOOL = np.diag([2e-9, 3e-9, 1e-9, 4e-7, 3e-7, 5e-7])
_FRAME = "the same robot as a frame of Timoshenko beams, placed by coordinates (fem.beams.frame)"


def with_offset(robot: Biglide) -> Biglide:
    """The robot with its loaded point beside B."""
    return replace(robot, tool_offset=_OFFSET, tool_compliance=None)


def with_tool_spring(robot: Biglide) -> Biglide:
    """The robot with a tool spring at a loaded point beside B."""
    return replace(robot, tool_offset=_OFFSET, tool_compliance=_TOOL)


def with_rigid_feet(robot: Biglide) -> Biglide:
    """The robot with rigid feet."""
    return replace(robot, foot_compliance=None)


def with_i_leg(robot: Biglide) -> Biglide:
    """The robot with a leg whose planes of bending differ in every constant."""
    section = ISection(width=0.16, height=0.24, flange=0.02, web=0.012)
    material = Material.isotropic(2.1e11, 0.3, 7850.0)
    return replace(robot, leg1=ConstantLeg(robot.leg1.length, section, material))


def as_it_is(robot: Biglide) -> Biglide:
    """The run's robot."""
    return robot


_ALPHA = 1.4
VARIANTS: dict[str, Callable[[Biglide], Biglide]] = {
    "as it is": as_it_is,
    "tool offset": with_offset,
    "tool spring": with_tool_spring,
    "rigid feet": with_rigid_feet,
    "I-section": with_i_leg,
}

cases = CaseGroup(
    section=SECTION, group="guard.robot", unit="1", reference_kind="independent-solver"
)


def frame_of(robot: Biglide, x: float, elements: int) -> AssembledFrame:
    """The robot with B at `x` (m) as a frame; nodes B, P, root and tip of each leg.

    Only what the robot file says goes in: lengths, a, offset, matrices. A foot and the joint on it
    are the spring condensed in φz; the joint at B, a rigid tool and rigid feet are constraints.
    """
    places = _places(robot, x)
    legs = [equivalent_leg(leg) for leg in (robot.leg1, robot.leg2)]
    nodes = np.array([places["B"], places["P"], places["A"], places["C"], places["B"]])
    members = (
        Member(2, 0, legs[0].timoshenko, _UPWARDS, elements),
        Member(3, 4, legs[1].timoshenko, _UPWARDS, elements),
    )
    springs: list[Spring] = []
    if robot.foot_compliance is not None:
        springs += [Spring(node, _released(robot.foot_compliance)) for node in (2, 3)]
    if robot.tool_compliance is not None:
        springs.append(Spring(1, _inverse(robot.tool_compliance), other=0))
    free = assemble(
        Frame(
            f"{robot.name} as a frame",
            nodes,
            members,
            springs=tuple(springs),
            masses=(PointMass(1, robot.platform_mass),),
        )
    )
    motion = _joined(robot, free.stiffness.shape[0])
    return replace(
        free,
        stiffness=motion.T @ free.stiffness @ motion,
        mass=motion.T @ free.mass @ motion,
        twists=free.twists @ motion,
        members=(),
    )


def _joined(robot: Biglide, size: int) -> SparseMatrix:
    """Free unknowns of the frame (`size`) from those that joints and rigid bodies leave."""
    motion = np.eye(size)
    dependent = [24, 25, 26, 27, 28]
    # Leg 2's tip moves with B and turns with it about x and y.
    motion[dependent] = motion[[0, 1, 2, 3, 4]]
    if robot.tool_compliance is None:
        motion[6:12] = motion[0:6]
        for axis in range(3):
            motion[6:9, 3 + axis] = np.cross(np.eye(3)[axis], robot.tool_offset)
        dependent += range(6, 12)
    if robot.foot_compliance is None:
        dependent += [12, 13, 14, 15, 16, 18, 19, 20, 21, 22]
    return csr_array(np.delete(motion, dependent, axis=1))


def _inverse(compliance: Array) -> Array:
    return np.asarray(np.linalg.inv(compliance), dtype=np.float64)


def _released(foot: Array) -> Array:
    """Stiffness of foot and joint about z in series."""
    stiffness = _inverse(foot)
    column = stiffness[:, 5]
    return np.asarray(stiffness - np.outer(column, column) / stiffness[5, 5])


def _places(robot: Biglide, x: float) -> dict[str, Array]:
    """A, B, C and P (m) from the lengths alone: circles about B meet the slides."""
    l1, l2 = robot.leg1.length, robot.leg2.length
    return {
        "A": np.array([0.0, -sqrt(max(l1**2 - x**2, 0.0)), 0.0]),
        "B": np.array([x, 0.0, 0.0]),
        "C": np.array([robot.a, -sqrt(max(l2**2 - (robot.a - x) ** 2, 0.0)), 0.0]),
        "P": np.array([x, 0.0, 0.0]) + robot.tool_offset,
    }


def frame_compliance(frame: AssembledFrame) -> Array:
    """6×6 compliance (SI) at P."""
    wrenches = np.zeros((frame.twists.shape[0], 6))
    wrenches[6:12] = np.eye(6)
    return displacements(frame, wrenches)[6:12]


def guarded_posture(robot: Biglide) -> float:
    """Position x of B (m) in which the guards look at the robot."""
    # Not the middle, where legs of like length stand like mirror images.
    first, last = robot.a - robot.leg2.length, robot.leg1.length
    return first + 0.35 * (last - first)


def robot_frame(robot: Biglide) -> AssembledFrame:
    """The assembled frame in the guards' posture."""
    return frame_of(robot, guarded_posture(robot), ELEMENTS)


@cases.case(
    "guard.robot.compliance.{model}[{name}]",
    "The robot's compliance by {model} is that of a frame of beams ({name})",
    over={"name": VARIANTS, "model": ("vjm", "segments", "beam")},
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    citation=_FRAME,
    tolerance=Absolute(_SAME),
    tolerance_reason=_SAME_REASON,
    row="{name}",
    effort=0.03,
)
def _compliance(context: Context, model: ModelName, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    frame = context.get(robot_frame, robot)
    options = ModelOptions(legs="equivalent")
    found = robot_compliance(model, robot, guarded_posture(robot), options)
    return farthest_off(scaled_difference(found, frame_compliance(frame)))


@cases.case(
    "guard.robot.tool-spring[{model}]",
    "A tool spring gives way by itself, whatever carries it ({model})",
    over={"model": ("vjm", "segments", "beam")},
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj) of the spring",
    reference_kind="closed-form",
    citation="springs in series at one point: the robot's compliance with it less that without",
    tolerance=Absolute(_SAME),
    tolerance_reason=_SAME_REASON,
    model="{model}",
)
def _in_series(context: Context, model: ModelName) -> Measurement:
    options, x = ModelOptions(legs="equivalent"), guarded_posture(context.robot)
    carried, bare = (
        robot_compliance(model, with_it(context.robot), x, options)
        for with_it in (with_tool_spring, with_offset)
    )
    return farthest_off(scaled_difference(carried - bare, _TOOL))


@cases.case(
    "guard.robot.frequency[{name}]",
    "The robot's first frequencies by beams are those of a frame of beams ({name})",
    over={"name": VARIANTS},
    quantity=f"largest relative difference of the first {MODES}",
    citation=_FRAME,
    tolerance=Absolute(_SAME),
    tolerance_reason=_SAME_REASON,
    effort=0.03,
)
def _frequencies(context: Context, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    frame = context.get(robot_frame, robot)
    options = ModelOptions(elements=ELEMENTS)
    found = robot_frequencies("beam", robot, guarded_posture(robot), MODES, options)
    reference = frame_modes(frame, MODES).frequencies
    return farthest_off(found / reference - 1.0)


_family = cases.family(group="guard.family")
_LONGER = "eqs (10), (11): legs α times as long, d = L1 + L2 − a and everything else kept"


@_family.case(
    "guard.family.stroke",
    f"The stroke does not change with α ({_ALPHA:g})",
    quantity="stroke length d",
    unit="m",
    reference_kind="closed-form",
    citation=_LONGER,
    tolerance=Relative(1e-9),
    tolerance_reason="rounding",
)
def _stroke(context: Context) -> Measurement:
    robot = context.robot
    member = scaled(robot, _ALPHA)
    first, last = member.stroke
    return Measurement(last - first, robot.leg1.length + robot.leg2.length - robot.a, exact=True)


def _longer_by_hand(robot: Biglide) -> Biglide:
    legs = [equivalent_leg(leg) for leg in (robot.leg1, robot.leg2)]
    leg1, leg2 = (replace(leg, length=_ALPHA * leg.length) for leg in legs)
    a = leg1.length + leg2.length - (robot.leg1.length + robot.leg2.length - robot.a)
    return replace(robot, a=a, leg1=leg1, leg2=leg2)


@_family.case(
    "guard.family.compliance",
    f"Member α = {_ALPHA:g} of the family is the frame with longer legs",
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    citation=f"{_LONGER}; {_FRAME}",
    tolerance=Absolute(_SAME),
    tolerance_reason=_SAME_REASON,
)
def _longer(context: Context) -> Measurement:
    by_hand = _longer_by_hand(context.robot)
    x = guarded_posture(by_hand)
    reference = frame_compliance(frame_of(by_hand, x, ELEMENTS))
    member = scaled(context.robot, _ALPHA)
    found = robot_compliance("beam", member, x, ModelOptions(elements=ELEMENTS))
    return farthest_off(scaled_difference(found, reference))
