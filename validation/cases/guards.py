"""Guards: what the models must say whatever the robot, where comparisons elsewhere are blind.

Two models that share a mistake agree. Each guard holds a part that several models share against
data put in again from the beginning: the robot as a frame of beams placed by coordinates, masses
and stiffnesses from the robot file, energies of uniform strains, moments of area of meshes.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import pi, sqrt

import numpy as np

from fem.frame import AssembledFrame, Frame, Member, PointMass, Spring, assemble, displacements
from fem.frame import modes as frame_modes
from lumped import vjm
from lumped.arrays import Array
from lumped.biglide import Biglide, scaled
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material, equivalent_leg
from lumped.modes import dense
from lumped.sections import ISection
from validation.case import Absolute, Case, Measurement, Relative
from validation.cases.legs import constant_leg_of
from validation.context import Context
from validation.models import (
    ModelName,
    ModelOptions,
    leg_matrices,
    robot_compliance,
    robot_frequencies,
)

SECTION = "Guards"
ELEMENTS = 12
MODES = 6
_LUMPED: tuple[ModelName, ...] = ("segments", "beam")
_STATIC: tuple[ModelName, ...] = ("vjm", "segments", "beam")
# Joints of the frame: stiffer than the leg by this factor in the five components they hold.
_JOINT = 1e6
_OFFSET = np.array([0.05, -0.08, 0.155])
_TOOL = np.diag([2e-9, 3e-9, 1e-9, 4e-7, 3e-7, 5e-7])
_FRAME = "the same robot as a frame of Timoshenko beams, placed by coordinates (fem.frame)"


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


def member_of_family(robot: Biglide) -> Biglide:
    """The robot whose legs are 1.4 times as long, the stroke as before (eqs 10, 11)."""
    return scaled(robot, _ALPHA)


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


def cases() -> tuple[Case, ...]:
    """All guards."""
    return (
        *(_compliance_case(model, name) for name in VARIANTS for model in _STATIC),
        *(_frequency_case(name) for name in VARIANTS),
        *_family_cases(),
        *_simplified_cases(),
        *(_mass_case(number, model) for number in (1, 2) for model in _LUMPED),
        *(_equivalent_case(number) for number in (1, 2)),
    )


def frame_of(robot: Biglide, x: float, elements: int) -> Frame:
    """The robot with B at `x` (m) as a frame; nodes B, P, root and tip of each leg, and B's foot.

    Only what the robot file says goes in: lengths, a, offset, matrices. A foot and the joint on it
    are the spring condensed in φz; the joint at B and rigid feet are stiff springs.
    """
    places = _places(robot, x)
    legs = [equivalent_leg(leg) for leg in (robot.leg1, robot.leg2)]
    nodes = np.array([places["B"], places["P"], places["A"], places["C"], places["B"]])
    members = (
        Member(2, 0, legs[0].timoshenko, (0.0, 0.0, 1.0), elements),
        Member(3, 4, legs[1].timoshenko, (0.0, 0.0, 1.0), elements),
    )
    # A rigid body is a spring far stiffer than what it holds.
    joint = _JOINT * max(leg.material.E * leg.section.area / leg.length for leg in legs)
    rigid = np.diag([joint] * 3 + [joint * robot.a**2] * 3)
    pivot = np.diag([*np.diag(rigid)[:5], 0.0])
    foot = pivot if robot.foot_compliance is None else _released(robot.foot_compliance)
    tool = rigid if robot.tool_compliance is None else _inverse(robot.tool_compliance)
    return Frame(
        f"{robot.name} as a frame",
        nodes,
        members,
        springs=(
            Spring(2, foot),
            Spring(3, foot),
            Spring(4, pivot, other=0),
            Spring(1, tool, other=0),
        ),
        masses=(PointMass(1, robot.platform_mass),),
    )


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


def scaled_difference(found: Array, reference: Array) -> float:
    """Largest |Δc_ij| of two compliances in units of √(c_ii c_jj) of the reference."""
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((found - reference) * unit[:, None] * unit).max())


def _posture(robot: Biglide) -> float:
    # Not the middle, where legs of like length stand like mirror images.
    first, last = robot.a - robot.leg2.length, robot.leg1.length
    return first + 0.35 * (last - first)


def robot_frame(robot: Biglide) -> AssembledFrame:
    """The assembled frame in the guards' posture."""
    return assemble(frame_of(robot, _posture(robot), ELEMENTS))


def _compliance_case(model: ModelName, name: str) -> Case:
    return Case(
        id=f"guard.robot.compliance.{model}[{name}]",
        title=f"The robot's compliance by {model} is that of a frame of beams ({name})",
        quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
        unit="1",
        reference_kind="independent-solver",
        citation=_FRAME,
        tolerance=Absolute(1e-4),
        tolerance_reason="the frame's joints are springs a million times stiffer than the legs; "
        "two of them in a chain whose lever arms may be ten times the joint",
        compute=partial(_compliance, model=model, name=name),
        section=SECTION,
        group="guard.robot",
    )


def _compliance(context: Context, model: ModelName, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    frame = context.get(robot_frame, robot)
    options = ModelOptions(legs="equivalent")
    found = robot_compliance(model, robot, _posture(robot), options)
    return Measurement(scaled_difference(found, frame_compliance(frame)), 0.0)


def _frequency_case(name: str) -> Case:
    return Case(
        id=f"guard.robot.frequency[{name}]",
        title=f"The robot's first frequencies by beams are those of a frame of beams ({name})",
        quantity=f"largest relative difference of the first {MODES}",
        unit="1",
        reference_kind="independent-solver",
        citation=_FRAME,
        tolerance=Absolute(1e-4),
        tolerance_reason="joints of the frame as stiff springs; same number of elements",
        compute=partial(_frequencies, name=name),
        section=SECTION,
        group="guard.robot",
    )


def _frequencies(context: Context, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    frame = context.get(robot_frame, robot)
    options = ModelOptions(elements=ELEMENTS)
    found = robot_frequencies("beam", robot, _posture(robot), MODES, options)
    reference = frame_modes(frame, MODES).frequencies
    return Measurement(float(np.abs(found / reference - 1.0).max()), 0.0)


def _family_cases() -> tuple[Case, ...]:
    citation = "eqs (10), (11): legs α times as long, d = L1 + L2 − a and everything else kept"
    return (
        Case(
            id="guard.family.stroke",
            title=f"The stroke does not change with α ({_ALPHA:g})",
            quantity="stroke length d",
            unit="m",
            reference_kind="closed-form",
            citation=citation,
            tolerance=Relative(1e-9),
            tolerance_reason="rounding",
            compute=_stroke,
            section=SECTION,
            group="guard.family",
        ),
        Case(
            id="guard.family.compliance",
            title=f"Member α = {_ALPHA:g} of the family is the frame with longer legs",
            quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
            unit="1",
            reference_kind="independent-solver",
            citation=f"{citation}; {_FRAME}",
            tolerance=Absolute(1e-4),
            tolerance_reason="joints of the frame as stiff springs",
            compute=_family,
            section=SECTION,
            group="guard.family",
        ),
    )


def _stroke(context: Context) -> Measurement:
    robot = context.robot
    member = scaled(robot, _ALPHA)
    first, last = member.stroke
    return Measurement(last - first, robot.leg1.length + robot.leg2.length - robot.a)


def _longer_by_hand(robot: Biglide) -> Biglide:
    legs = [equivalent_leg(leg) for leg in (robot.leg1, robot.leg2)]
    leg1, leg2 = (replace(leg, length=_ALPHA * leg.length) for leg in legs)
    a = leg1.length + leg2.length - (robot.leg1.length + robot.leg2.length - robot.a)
    return replace(robot, a=a, leg1=leg1, leg2=leg2)


def _family(context: Context) -> Measurement:
    by_hand = _longer_by_hand(context.robot)
    x = _posture(by_hand)
    reference = frame_compliance(assemble(frame_of(by_hand, x, ELEMENTS)))
    member = scaled(context.robot, _ALPHA)
    found = robot_compliance("beam", member, x, ModelOptions(elements=ELEMENTS))
    return Measurement(scaled_difference(found, reference), 0.0)


def _simplified_cases() -> tuple[Case, ...]:
    citation = "virtual joints with legs a million times stiffer than the drives, feet along y"
    return (
        Case(
            id="guard.simplified.compliance",
            title="The simplified model is the robot whose feet yield along y alone",
            quantity="largest difference of the 2×2 in units of its largest entry",
            unit="1",
            reference_kind="independent-solver",
            citation=citation,
            tolerance=Absolute(1e-4),
            tolerance_reason="the legs' own compliance, a millionth, by the square of lever arms",
            compute=_simplified_compliance,
            section=SECTION,
            group="guard.simplified",
        ),
        Case(
            id="guard.simplified.frequency",
            title="The simplified frequencies are those of the mass on that compliance",
            quantity="largest relative difference of both frequencies",
            unit="1",
            reference_kind="closed-form",
            citation=f"ω² = 1/(m c) for both principal compliances c; {citation}",
            tolerance=Absolute(1e-4),
            tolerance_reason="as for the compliance",
            compute=_simplified_frequencies,
            section=SECTION,
            group="guard.simplified",
        ),
    )


def drive_compliance_by_joints(robot: Biglide) -> Array:
    """2×2 compliance (m/N) at B by virtual joints: drives yield, all else a millionth of that."""
    drive = 1.0 / robot.actuator_stiffness
    stiff = 1e-6 * drive * np.diag([1.0, 1.0, 1.0, *[1.0 / robot.a**2] * 3])
    foot = stiff.copy()
    foot[1, 1] = drive
    plain = replace(robot, foot_compliance=foot, tool_compliance=None, tool_offset=np.zeros(3))
    return vjm.compliance(plain, _posture(robot), (stiff, stiff))[:2, :2]


def _simplified_compliance(context: Context) -> Measurement:
    robot = context.robot
    reference = context.get(drive_compliance_by_joints, robot)
    found = robot_compliance("simplified", robot, _posture(robot))
    return Measurement(float(np.abs(found - reference).max() / np.abs(reference).max()), 0.0)


def _simplified_frequencies(context: Context) -> Measurement:
    robot = context.robot
    principal = np.linalg.eigvalsh(context.get(drive_compliance_by_joints, robot))
    reference = 1.0 / (2.0 * pi * np.sqrt(robot.platform_mass * principal[::-1]))
    found = robot_frequencies("simplified", robot, _posture(robot), 2)
    return Measurement(float(np.abs(found / reference - 1.0).max()), 0.0)


def _mass_case(number: int, model: ModelName) -> Case:
    return Case(
        id=f"guard.leg{number}.mass[{model}]",
        title=f"Leg {number} by {model} weighs what the robot file says, about its middle",
        quantity="largest difference of mass, m L/2 and m L²/3 + ρI L in units of m, m L, m L²",
        unit="1",
        reference_kind="closed-form",
        citation="kinetic energy of a prism in its rigid motions, from mass, length, section",
        tolerance=Absolute(1e-9),
        tolerance_reason="consistent masses and rigid elements carry rigid motions exactly",
        compute=partial(_mass, number=number, model=model),
        section=SECTION,
        group="guard.legs",
    )


def _mass(context: Context, number: int, model: ModelName) -> Measurement:
    robot = context.robot
    given: Leg = robot.leg1 if number == 1 else robot.leg2
    leg = constant_leg_of(context, number)
    matrices = leg_matrices(model, leg, ModelOptions(elements=ELEMENTS))
    length = given.length
    mass = given.mass
    rigid = _rigid_motions(dense(matrices.stiffness), length)
    found = rigid.T @ dense(matrices.mass) @ rigid
    # The equivalent leg of a given matrix is a solid rectangle.
    gyration = (
        leg.section.extent[1] ** 2 / 12.0
        if isinstance(given, GivenLeg)
        else given.section.second_moment_y / given.section.area
    )
    wanted = {
        (0, 0): mass,
        (2, 4): -mass * length / 2.0,
        (1, 5): mass * length / 2.0,
        (4, 4): mass * (length**2 / 3.0 + gyration),
    }
    worst = max(
        abs(found[i, j] - value) / (mass * length ** ((i > 2) + (j > 2)))
        for (i, j), value in wanted.items()
    )
    return Measurement(float(worst), 0.0)


def _rigid_motions(stiffness: Array, length: float) -> Array:
    """Unknowns (n×6) of a free leg that moves rigidly with the twist of its root.

    The ends are prescribed, the inside follows without load.
    """
    motions = np.zeros((len(stiffness), 6))
    motions[:6] = np.eye(6)
    motions[6:12] = np.eye(6)
    motions[7, 5], motions[8, 4] = length, -length
    motions[12:] = -np.linalg.solve(stiffness[12:, 12:], stiffness[12:, :12] @ motions[:12])
    return motions


def _equivalent_case(number: int) -> Case:
    return Case(
        id=f"guard.leg{number}.equivalent",
        title=f"The equivalent leg {number} has the first four stiffnesses of the given one",
        quantity="largest relative difference of K11, K22, K33, K44 with the root clamped",
        unit="1",
        reference_kind="closed-form",
        citation="paper §2.3: the same first four diagonal terms of the stiffness matrix; "
        "one Euler–Bernoulli element",
        tolerance=Absolute(1e-9),
        tolerance_reason="rounding",
        compute=partial(_equivalent, number=number),
        section=SECTION,
        group="guard.legs",
    )


def _equivalent(context: Context, number: int) -> Measurement:
    robot = context.robot
    given: Leg = robot.leg1 if number == 1 else robot.leg2
    leg = constant_leg_of(context, number)
    if isinstance(given, GivenLeg):
        wanted = np.diag(np.linalg.inv(given.compliance))[:4]
    else:
        E, G, s, l = given.material.E, given.material.G, given.section, given.length
        bending = 12.0 * E / l**3
        wanted = np.array(
            [
                E * s.area / l,
                bending * s.second_moment_z,
                bending * s.second_moment_y,
                G * s.torsion_constant / l,
            ]
        )
    options = ModelOptions(elements=1, theory="euler-bernoulli")
    matrices = leg_matrices("beam", leg, options)
    stiffness = dense(matrices.stiffness)
    condensed = stiffness[6:12, 6:12] - stiffness[6:12, 12:] @ np.linalg.solve(
        stiffness[12:, 12:], stiffness[12:, 6:12]
    )
    return Measurement(float(np.abs(np.diag(condensed)[:4] / wanted - 1.0).max()), 0.0)
