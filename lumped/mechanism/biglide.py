"""The PRRRP biglide as a mechanism (paper §2.1, Figs 1 and 2).

Slide A moves along y on the line x = 0, slide C along y on the line x = a. Leg 1 = AB and leg 2 =
CB lie on the same side and meet at B = (x, y). Nothing depends on y, so that B is used as the
origin of y and a pose consists of the coordinate x of B alone. The compliances of the feet are
those of the revolute joints between slides and legs. Leg 2 is hinged to leg 1 at B, and leg 1
carries the platform.
"""

from dataclasses import dataclass, replace
from math import fsum, sqrt

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import Leg
from lumped.mechanism.body import Frame
from lumped.mechanism.joint import Drive, Joint, JointKind, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import place_leg, place_rigid_body
from lumped.screws import rotation_z

# Tolerance, relative to a, for a position x at the end of the stroke.
_ROUNDING = 1e-12
_POSES = 9
_, _Y, _Z = np.eye(3)


@dataclass(frozen=True)
class Stroke:
    """Stroke of the biglide, from the distance `a` (m) of its slides and its two leg lengths (m).

    B moves from x = a − L2, where leg 2 is horizontal, to x = L1, where leg 1 is horizontal. Both
    are type 1 singularities.
    """

    a: float
    length1: float
    length2: float

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest coordinate x (m) of point B."""
        return self.a - self.length2, self.length1

    @property
    def centre(self) -> float:
        """Coordinate x (m) of B in the middle of the stroke."""
        return 0.5 * sum(self.ends)

    @property
    def length(self) -> float:
        """Length d = L1 + L2 − a (m) of the stroke."""
        return self.length1 + self.length2 - self.a

    def legs_at(self, x: float) -> tuple[Frame, Frame]:
        """Frames (base axes) of leg 1 at A and of leg 2 at C, with B at `x` (m).

        Raises InputError if `x` is outside the stroke.
        """
        first, last = self.ends
        slack = _ROUNDING * self.a
        if not first - slack <= x <= last + slack:
            excess = f", by {max(x - last, first - x):.3g} m" if np.isfinite(x) else ""
            raise InputError(
                f"x = {x:.10g} m is outside the stroke {first:g} m to {last:g} m{excess}"
            )
        s1, s2 = _height(self.length1, (x,)), _height(self.length2, (self.a, -x))
        return (
            Frame(np.array([0.0, -s1, 0.0]), rotation_z(float(np.arctan2(s1, x)))),
            Frame(np.array([self.a, -s2, 0.0]), rotation_z(float(np.arctan2(s2, x - self.a)))),
        )

    def faults(self) -> list[str]:
        """Reasons why the legs cannot meet, or why one of them never becomes horizontal."""
        l1, l2, a = self.length1, self.length2, self.a
        faults = []
        if not a > 0.0:
            faults.append(f"a = {a:g} m: the slides must be apart, a > 0")
        if l1 + l2 <= a:
            faults.append(
                f"leg lengths {l1:g} m + {l2:g} m do not reach over a = {a:g} m: "
                "the legs cannot meet"
            )
        if a > 0.0 and (l1 >= l2 + a or l2 >= l1 + a):
            faults.append(
                f"leg lengths {l1:g} m and {l2:g} m differ by a = {a:g} m or more: "
                "the shorter leg never becomes horizontal, so the stroke has no end"
            )
        return faults


def _height(length: float, base: tuple[float, ...]) -> float:
    """Extent √(L² − b²) (m) along y of a leg of `length` L (m) whose extent along x is b.

    b is given by its terms `base` (m), which add up to b. The result is computed as
    √((L − b)(L + b)), and both factors are rounded only once. A difference of squares would lose
    half of the digits near the ends of the stroke. The result is zero if b equals L within
    round-off.
    """
    short = fsum((length, *(-term for term in base)))
    if short <= np.spacing(max(length, *map(abs, base))):
        return 0.0
    return sqrt(short * fsum((length, *base)))


@dataclass(frozen=True)
class _InverseKinematics:
    """Function that computes the frames of all bodies for a pose (x of B, in m) in closed form.

    `offset` (m, base axes) is the vector from B to the loaded point. `platform_turns` is True if
    the platform rotates with leg 1, and False if it keeps its orientation. Iterative loop closure
    would lose half of the digits at both ends of the stroke.
    """

    stroke: Stroke
    offset: tuple[float, float, float]
    platform_turns: bool

    def __call__(self, pose: Array) -> dict[str, Frame]:
        leg1, leg2 = self.stroke.legs_at(float(pose[0]))
        tip = np.array([pose[0], 0.0, 0.0])
        reference, _ = self.stroke.legs_at(self.stroke.centre)
        turn = leg1.rotation @ reference.rotation.T if self.platform_turns else np.eye(3)
        return {
            GROUND: Frame(),
            "slide1": Frame(leg1.position),
            "slide2": Frame(leg2.position),
            "leg1": leg1,
            "leg2": leg2,
            "platform": Frame(tip, turn),
            "tool": Frame(tip + np.array(self.offset), turn),
        }


def biglide(
    name: str,
    a: float,
    leg1: Leg,
    leg2: Leg,
    *,
    platform_mass: float,
    drive_stiffness: float,
    tool_offset: Array | None = None,
    foot_compliance: Array | None = None,
    tool_compliance: Array | None = None,
) -> Mechanism:
    """Biglide with two legs on slides `a` (m) apart.

    Its reference posture is the middle of the stroke. `tool_offset` (3, in m, base axes) is the
    vector from B to the loaded point P, at which `platform_mass` (kg) is located. `foot_compliance`
    (6×6, SI, base axes) acts in both revolute joints of the feet, `tool_compliance` (6×6, SI, base
    axes) in series at P. A compliance of None stands for rigid. The drives are rigid except in the
    simplified model, in which `drive_stiffness` (N/m) represents all compliance. Raises InputError
    if the legs cannot meet.
    """
    stroke = Stroke(a, leg1.length, leg2.length)
    if faults := stroke.faults():
        raise InputError(faults)
    offset = np.zeros(3) if tool_offset is None else np.asarray(tool_offset, dtype=float)
    first, second = stroke.legs_at(stroke.centre)
    tip = np.array([stroke.centre, 0.0, 0.0])
    points = {"A": first.position, "C": second.position, "B": tip, "P": tip + offset}
    placed = [
        place_rigid_body(GROUND, ("A", "C"), points, origin=np.zeros(3)),
        place_rigid_body("slide1", "A", points),
        place_rigid_body("slide2", "C", points),
        place_leg("leg1", leg1, ("A", "B"), points),
        place_leg("leg2", leg2, ("C", "B"), points),
        place_rigid_body("platform", ("B", "P"), points),
    ]
    # The paper gives tool offset and tool compliance in the robot's axes. A platform with one of
    # them therefore keeps its orientation in all poses.
    platform_turns = tool_compliance is None and not offset[:2].any()
    datum = (float(offset[0]), float(offset[1]), float(offset[2]))
    drive = Drive(simplified=drive_stiffness)
    seat = _joint("seat", "fixed", ("leg1", "platform"), "B")
    if not platform_turns:
        # A rigid drive at B compensates the rotation of leg 1, so that the platform does not turn.
        seat = _joint("seat", "revolute", ("leg1", "platform"), "B", _Z, drive=Drive())
    joints = [
        _joint("drive1", "prismatic", (GROUND, "slide1"), "A", _Y, drive=drive),
        _joint("drive2", "prismatic", (GROUND, "slide2"), "C", _Y, drive=drive),
        _joint("foot1", "revolute", ("slide1", "leg1"), "A", _Z, compliance=foot_compliance),
        _joint("foot2", "revolute", ("slide2", "leg2"), "C", _Z, compliance=foot_compliance),
        _joint("hinge", "revolute", ("leg1", "leg2"), "B", _Z),
        seat,
    ]
    loaded_body = "platform"
    if tool_compliance is not None:
        loaded_body = "tool"
        placed.append(place_rigid_body(loaded_body, "P", points))
        joints.append(
            _joint("spring", "fixed", ("platform", loaded_body), "P", compliance=tool_compliance)
        )
    constant_moves = (("y", 0.0),) if platform_turns else (("y", 0.0), ("phi_z", 0.0))
    return Mechanism(
        name=name,
        bodies={body.name: body for body, _ in placed},
        joints=tuple(joints),
        tool=Tool(loaded_body, "P", ("x",), platform_mass, constant_moves, datum),
        reference={body.name: frame for body, frame in placed},
        poses=np.linspace(*stroke.ends, _POSES)[:, None],
        inverse_kinematics=_InverseKinematics(stroke, datum, platform_turns),
    )


def family_member(a: float, leg1: Leg, leg2: Leg, alpha: float) -> tuple[float, Leg, Leg]:
    """Distance a (m) of the slides, and both legs, of a robot with legs `alpha` times as long.

    Its stroke is the same as that of the given robot.

    Eqs (10) and (11) of the paper: a = α (L10 + L20) − d with the stroke d and the lengths
    L10 and L20 of `leg1` and `leg2`. A leg given by a 6×6 compliance is replaced by its equivalent
    leg of constant section. Sections do not change with α.
    """
    stroke = Stroke(a, leg1.length, leg2.length)
    first, second = equivalent_leg(leg1), equivalent_leg(leg2)
    return (
        alpha * (first.length + second.length) - stroke.length,
        replace(first, length=alpha * first.length),
        replace(second, length=alpha * second.length),
    )


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
