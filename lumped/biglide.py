"""The PRRRP biglide: its data and its postures (paper §2.1, Figs 1 and 2).

A slides along y on the line x = 0, C along y on the line x = a; leg 1 = AB, leg 2 = CB, both on
the same side; B = (x, y). Nothing depends on y, so B is the origin of y. As a mechanism: slides on
drives, feet as the give of the revolute joints between slides and legs, leg 2 hinged to leg 1 at B,
the platform rigid with leg 1.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, naming
from lumped.legs import EquivalentBy, Leg, equivalent_leg
from lumped.mechanism.biglide import Stroke, lengthened
from lumped.mechanism.body import Frame, leg_shape
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.joint import Drive, Joint, JointKind, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture, Tool
from lumped.mechanism.placing import leg_on, rigid_on
from lumped.system.assembly import System, assemble
from lumped.system.joint_motion import Portion, printed_release

_POSES = 9
_, _Y, _Z = np.eye(3)


@dataclass(frozen=True)
class Places:
    """Where the joints are when B is at `x` (m, base axes, B as origin of y and z).

    `root1` = A, `root2` = C, `tip` = B; `rotation1`, `rotation2` are 3×3 with the axes of leg 1
    and leg 2 as columns; `s1`, `s2` (m) are the legs' extents along y.
    """

    x: float
    root1: Array
    root2: Array
    tip: Array
    rotation1: Array
    rotation2: Array
    s1: float
    s2: float


@dataclass(frozen=True)
class Biglide:
    """A biglide robot, SI units.

    Distance `a` (m) between the slides; `tool_offset` (m, base axes) from B to the loaded point P
    where the platform's mass (kg) sits; `actuator_stiffness` (N/m) of the simplified model;
    `foot_compliance` 6×6 at the revolute joint in robot axes, None for rigid feet;
    `tool_compliance` 6×6 in robot axes, a spring in series at P, None for a rigid platform.
    """

    name: str
    a: float
    platform_mass: float
    actuator_stiffness: float
    leg1: Leg
    leg2: Leg
    tool_offset: Array = field(default_factory=lambda: np.zeros(3))
    foot_compliance: Array | None = None
    tool_compliance: Array | None = None

    @property
    def stroke(self) -> tuple[float, float]:
        """First and last x of B (m): leg 2 horizontal, leg 1 horizontal (type 1 singularities)."""
        return self._legs.ends

    @property
    def stroke_length(self) -> float:
        """Length d = L1 + L2 − a (m)."""
        return self._legs.length

    def posture(self, x: float) -> Places:
        """Where the joints are with B at `x` (m); raises InputError outside the stroke."""
        with naming(self.name):
            leg1, leg2 = self._legs.legs_at(x)
        return Places(
            x=x,
            root1=leg1.position,
            root2=leg2.position,
            tip=np.array([x, 0.0, 0.0]),
            rotation1=leg1.rotation,
            rotation2=leg2.rotation,
            s1=-float(leg1.position[1]),
            s2=-float(leg2.position[1]),
        )

    def stations(self, count: int) -> Array:
        """`count` x positions (m), evenly spread over the stroke, both ends included."""
        return np.linspace(*self.stroke, count)

    @property
    def centre(self) -> float:
        """Middle of the stroke (m)."""
        return self._legs.centre

    @property
    def _legs(self) -> Stroke:
        return Stroke(self.a, self.leg1.length, self.leg2.length)


def with_equivalent_legs(robot: Biglide, by: EquivalentBy = "stiffness") -> Biglide:
    """The same robot with constant-section legs (paper §2.3)."""
    return replace(robot, leg1=equivalent_leg(robot.leg1, by), leg2=equivalent_leg(robot.leg2, by))


def scaled(robot: Biglide, alpha: float, by: EquivalentBy = "stiffness") -> Biglide:
    """Member `alpha` of the family of eqs (10), (11): legs α times as long, the same stroke d.

    The legs keep their (equivalent) constant section; a = α (L10 + L20) − d. Raises InputError
    for an α at which the legs cannot meet.
    """
    a, leg1, leg2 = lengthened(robot.a, robot.leg1, robot.leg2, alpha, by)
    member = replace(robot, name=f"{robot.name}, α = {alpha:g}", a=a, leg1=leg1, leg2=leg2)
    if faults := geometry_faults(member):
        raise InputError(f"α = {alpha:g}: {fault}" for fault in faults)
    return member


def geometry_faults(robot: Biglide) -> list[str]:
    """Why the legs cannot meet or pass their singular postures; empty if the geometry is sound."""
    return Stroke(robot.a, robot.leg1.length, robot.leg2.length).faults()


def mechanism(robot: Biglide) -> Mechanism:
    """The biglide as a mechanism, described with B in the middle of its stroke.

    Tool offset and tool spring turn with the platform from there; `postures` keeps them in base
    axes, as the paper has them. The drives are rigid but for the simplified model, where their
    stiffness stands for all that gives way.
    """
    at = robot.posture(robot.centre)
    points = {"A": at.root1, "C": at.root2, "B": at.tip, "P": at.tip + robot.tool_offset}
    loaded = "platform" if robot.tool_compliance is None else "tool"
    placed = [
        rigid_on(GROUND, ("A", "C"), points, origin=np.zeros(3)),
        rigid_on("slide1", "A", points),
        rigid_on("slide2", "C", points),
        leg_on("leg1", leg_shape(robot.leg1), ("A", "B"), points),
        leg_on("leg2", leg_shape(robot.leg2), ("C", "B"), points),
        rigid_on("platform", ("B", "P"), points),
    ]
    drive, foot = Drive(simplified=robot.actuator_stiffness), robot.foot_compliance
    joints = [
        _joint("drive1", "prismatic", (GROUND, "slide1"), "A", _Y, drive=drive),
        _joint("drive2", "prismatic", (GROUND, "slide2"), "C", _Y, drive=drive),
        _joint("foot1", "revolute", ("slide1", "leg1"), "A", _Z, compliance=foot),
        _joint("foot2", "revolute", ("slide2", "leg2"), "C", _Z, compliance=foot),
        _joint("hinge", "revolute", ("leg1", "leg2"), "B", _Z),
        _joint("seat", "fixed", ("leg1", "platform"), "B"),
    ]
    if robot.tool_compliance is not None:
        placed.append(rigid_on("tool", "P", points))
        spring = robot.tool_compliance
        joints.append(_joint("spring", "fixed", ("platform", "tool"), "P", compliance=spring))
    return Mechanism(
        name=robot.name,
        bodies={body.name: body for body, _ in placed},
        joints=tuple(joints),
        tool=Tool(loaded, "P", ("x", "y"), robot.platform_mass),
        reference={body.name: frame for body, frame in placed},
        poses=np.array([_loaded_point(robot, at, station) for station in robot.stations(_POSES)]),
    )


def postures(robot: Biglide, positions: Iterable[float]) -> list[Posture]:
    """The mechanism with B at each of `positions` (m), the platform's axes along those of the base.

    The platform is seated on leg 1 in every posture anew: offset and spring of the tool do not
    turn. Raises InputError for positions outside the stroke.
    """
    described, centre = mechanism(robot), robot.posture(robot.centre)
    found = []
    for x in positions:
        at = robot.posture(x)
        loaded = at.tip + robot.tool_offset
        frames = {
            GROUND: Frame(),
            "slide1": Frame(at.root1),
            "slide2": Frame(at.root2),
            "leg1": Frame(at.root1, at.rotation1),
            "leg2": Frame(at.root2, at.rotation2),
            "platform": Frame(at.tip),
        }
        if robot.tool_compliance is not None:
            frames["tool"] = Frame(loaded)
        slides = at.root1[1:2] - centre.root1[1:2], at.root2[1:2] - centre.root2[1:2]
        turns = _turned(centre.rotation1, at.rotation1), _turned(centre.rotation2, at.rotation2)
        coordinates = {
            "drive1": slides[0],
            "drive2": slides[1],
            "foot1": turns[0],
            "foot2": turns[1],
            "hinge": turns[1] - turns[0],
            "seat": np.zeros(0),
            "spring": np.zeros(0),
        }
        found.append(Posture(described, loaded[:2], frames, coordinates))
    return found


def system(robot: Biglide, x: float, leg1: BodyModel, leg2: BodyModel) -> System:
    """The robot with B at `x` (m), from models of its two legs in their own axes.

    Raises InputError outside the stroke.
    """
    (at,) = postures(robot, (x,))
    return assemble(at, {"leg1": leg1, "leg2": leg2})


def printed(mechanism: Mechanism) -> Mechanism:
    """The joints at A, C and B as eq. (25) prints their release.

    Row and column of φz of a foot's stiffness are zeroed, which is a joint in series with a foot
    whose φz is uncoupled. At B all is shared: leg 2 carries the printed joint itself
    (`segments.with_printed_tip_joint`).
    """
    return replace(mechanism, joints=tuple(_printed(joint) for joint in mechanism.joints))


def _printed(joint: Joint) -> Joint:
    if joint.name == "hinge":
        return replace(joint, kind="fixed", axes=np.zeros((0, 3)))
    if joint.compliance is None or joint.kind != "revolute":
        return joint
    stiffness: Array = np.linalg.inv(joint.compliance).astype(float)
    uncoupled = printed_release(stiffness)
    uncoupled[5, 5] = stiffness[5, 5]
    return replace(joint, compliance=np.linalg.inv(uncoupled).astype(float))


# Bodies and joints of the mechanism in the paper's words.
_JOINTS = {
    Portion("foot1", "compliance"): Portion("foot 1"),
    Portion("foot2", "compliance"): Portion("foot 2"),
    Portion("spring", "compliance"): Portion("tool"),
}
_LEGS = {"leg1": "leg 1", "leg2": "leg 2"}


def in_words(part: Portion) -> Portion:
    """What a part of the mechanism is called: "leg 1", "foot 1", "tool"."""
    return _JOINTS.get(part, replace(part, of=_LEGS.get(part.of, part.of)))


def _turned(before: Array, after: Array) -> Array:
    """Angle (1, rad) about z from one rotation to another."""
    turn = before.T @ after
    return np.atleast_1d(np.arctan2(turn[1, 0], turn[0, 0]))


def _joint(
    name: str,
    kind: JointKind,
    between: tuple[str, str],
    point: str,
    *axes: Array,
    drive: Drive | None = None,
    compliance: Array | None = None,
) -> Joint:
    first, second = (Side(body, point) for body in between)
    return Joint(name, kind, first, second, np.reshape(axes, (-1, 3)), drive, compliance)


def _loaded_point(robot: Biglide, reference: Places, x: float) -> Array:
    """Coordinates x and y (m) of the loaded point with B at `x`; its offset turns with leg 1."""
    at = robot.posture(x)
    place = at.tip + at.rotation1 @ reference.rotation1.T @ robot.tool_offset
    return place[:2]
