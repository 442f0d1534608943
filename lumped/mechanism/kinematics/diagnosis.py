"""Likely causes of a mechanism that cannot move: a joint axis of wrong direction, legs in one line.

To test a joint, the constraints that depend on its axis are omitted: a revolute joint becomes a
spherical joint, a prismatic joint can slide in all directions. If the tool can then move as
prescribed, the direction of the relative motion at the joint is the axis that the joint should
have. The joint is reported only if the mechanism with this axis can move in the reference posture
and near it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import Joint, JointKind, Side
from lumped.mechanism.kinematics.closure import Closure, closure_of
from lumped.mechanism.kinematics.mobility import (
    Mobility,
    generic_mobility,
    mobility,
    null_space,
    row_space,
)
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism

# Components of unit vectors below this count as zero: axes are typed with four digits.
_NOTHING = 1e-4
# Angle (rad) below which an axis counts as right: typed directions have five digits.
_SMALLEST_ANGLE = 1e-5
# All joints whose angle is within this factor of the smallest angle are reported.
_COMPARABLE = 1.5
# Sine of the angle below which legs lie in one line. Cosine below which they are at right angles.
_IN_LINE = 1e-3
# Joints that let a leg turn.
_ROTATING: frozenset[JointKind] = frozenset({"revolute", "cylindrical", "universal", "spherical"})


class OffAxis(NamedTuple):
    """A joint with a wrong axis, and the `axis` with which the tool could move as prescribed.

    `angle` (rad) is the angle between the two axes.
    """

    joint: Joint
    axis: Array
    angle: float


def off_axes(mechanism: Mechanism) -> list[OffAxis]:
    """Joints that may have a wrong axis: with another one the tool could move as prescribed.

    Each joint is tested alone. Joints whose axis would have to rotate by more than 1.5 times the
    smallest such angle are left out. The joints are sorted by the number of axes of other joints
    that are parallel to the required axis, largest number first.
    """
    closure = closure_of(mechanism)
    jacobian = closure.jacobian(closure.reference)
    candidates = (
        _candidate(closure, jacobian, number)
        for number, joint in enumerate(mechanism.joints)
        if joint.kind in {"revolute", "prismatic"} and joint.first.point == joint.second.point
    )
    causes = [cause for cause in candidates if cause is not None and _moves_with(mechanism, cause)]
    smallest = min((cause.angle for cause in causes), default=0.0)
    comparable = (cause for cause in causes if cause.angle <= _COMPARABLE * smallest)
    return sorted(comparable, key=lambda cause: -_parallel_axes(mechanism, cause))


def _candidate(closure: Closure, jacobian: Array, number: int) -> OffAxis | None:
    """Axis with which the joint with the index `number` would allow the prescribed motions.

    `jacobian` contains the derivatives of all joint constraints. None if no axis would be
    sufficient, or if the axis of the joint is right.
    """
    joint = closure.mechanism.joints[number]
    slides = joint.kind == "prismatic"
    joint_rows = (closure.joint_of == number) & (closure.is_sliding == slides)
    free = null_space(jacobian[~joint_rows])
    moves = closure.pose_jacobian(closure.reference) @ free
    if len(row_space(moves)) < len(moves):
        return None
    relative = closure.relative_motion(closure.reference, number, slides=slides) @ free
    # Motions that do not move the tool may also turn the joint. They are removed.
    idle = row_space((relative @ null_space(moves)).T)
    across = relative - idle.T @ (idle @ relative)
    axis = joint.axes[0]
    needed = row_space(across.T)
    if len(needed) != 1:
        return None
    plane = np.vstack([needed, idle])
    nearest = plane.T @ (plane @ axis)
    size = float(np.linalg.norm(nearest))
    if size <= _NOTHING:
        return None
    direction = nearest / size
    angle = float(np.arctan2(np.linalg.norm(np.cross(axis, direction)), axis @ direction))
    return OffAxis(joint, direction, angle) if angle > _SMALLEST_ANGLE else None


def _parallel_axes(mechanism: Mechanism, cause: OffAxis) -> int:
    """Number of axes of other joints that are parallel to the axis in `cause`."""
    axes = np.vstack([joint.axes for joint in mechanism.joints if joint is not cause.joint])
    return int(np.count_nonzero(np.linalg.norm(np.cross(axes, cause.axis), axis=1) < _NOTHING))


def _moves_with(mechanism: Mechanism, cause: OffAxis) -> bool:
    """True if the tool can move as prescribed with the axis in `cause`.

    It must be able to do so in the reference posture and in a posture near it.
    """
    joints = tuple(
        replace(joint, axes=cause.axis[None]) if joint is cause.joint else joint
        for joint in mechanism.joints
    )
    changed = replace(mechanism, joints=joints)
    return _moves(mobility(reference_posture(changed))) and _moves(generic_mobility(changed))


def _moves(result: Mobility) -> bool:
    return not (result.barred or result.at_limit)


class SpecialPosture(NamedTuple):
    """Names of `legs`, and the `posture` that they have in common: "folded into one line"."""

    legs: tuple[str, ...]
    posture: str


def special_postures(mechanism: Mechanism) -> list[SpecialPosture]:
    """Legs in postures that can make the reference posture singular.

    A leg is here a body with two points. If its line passes through the axis of another joint of
    its neighbour, it is stretched out or folded, and if it is at right angles to a slide of its
    neighbour, its force cannot drive that slide. The neighbour may be several bodies that fixed
    joints connect. The ground counts as no neighbour. Legs with the same posture relative to the
    same joint are one entry.
    """
    rigid = _rigid_groups(mechanism)
    entries: dict[SpecialPosture, list[str]] = {}
    for joint in mechanism.joints:
        for leg_side, side in ((joint.second, joint.first), (joint.first, joint.second)):
            if joint.kind not in _ROTATING or GROUND in (leg_side.body, rigid[side.body]):
                continue
            if _is_leg(mechanism, leg_side.body):
                for legs, posture in _leg_postures(mechanism, joint, leg_side, side, rigid):
                    # Two legs that lie in one line with each other are an entry of their own.
                    key = SpecialPosture(legs if len(legs) == 2 else (), posture)
                    entries.setdefault(key, []).extend(legs)
    return [
        SpecialPosture(tuple(dict.fromkeys(legs)), key.posture) for key, legs in entries.items()
    ]


def _is_leg(mechanism: Mechanism, body: str) -> bool:
    return len(mechanism.bodies[body].interfaces) == 2


def _rigid_groups(mechanism: Mechanism) -> dict[str, str]:
    """Name of one body of the group that fixed joints connect, for each body.

    It is "ground" for bodies that are fixed to the ground.
    """
    representatives = {body: body for body in mechanism.bodies}
    for joint in mechanism.joints:
        if joint.kind == "fixed":
            pair = {representatives[joint.first.body], representatives[joint.second.body]}
            kept = GROUND if GROUND in pair else min(pair)
            representatives = {
                body: kept if name in pair else name for body, name in representatives.items()
            }
    return representatives


def _leg_postures(
    mechanism: Mechanism, joint: Joint, leg_side: Side, side: Side, rigid: Mapping[str, str]
) -> Iterator[SpecialPosture]:
    """Special postures of one leg with respect to each other joint of its neighbour at `joint`.

    Both are named if the neighbour is a leg between the two joints. There are none if the points of
    the leg coincide. `leg_side` and `side` are
    the sides of `joint` that belong to the leg and to the neighbour. `rigid` contains the
    representative of each body's rigid group.
    """
    start, leg = _position(mechanism, leg_side), leg_side.body
    (other,) = set(mechanism.bodies[leg].interfaces) - {leg_side.point}
    along = _position(mechanism, Side(leg, other)) - start
    if not along.any():
        return
    along /= np.linalg.norm(along)
    for pivot in mechanism.joints:
        pivot_side = next(
            (end for end in (pivot.first, pivot.second) if rigid[end.body] == rigid[side.body]),
            None,
        )
        if pivot is joint or pivot_side is None or leg in (pivot.first.body, pivot.second.body):
            continue
        if pivot.kind == "prismatic" and abs(pivot.axes[0] @ along) < _IN_LINE:
            yield SpecialPosture((leg,), f"at right angles to the slide of {pivot.name}")
        elif pivot.kind in _ROTATING:
            lever = start - _position(mechanism, pivot_side)
            stretched = _stretched(lever, along, pivot)
            if stretched is None:
                continue
            posture = f"{'stretched out in' if stretched else 'folded into'} one line"
            if pivot_side.body == side.body and _is_leg(mechanism, side.body):
                yield SpecialPosture((joint.first.body, joint.second.body), posture)
            else:
                yield SpecialPosture((leg,), f"{posture} with the axis of {pivot.name}")


def _stretched(lever: Array, along: Array, pivot: Joint) -> bool | None:
    """True if a leg is stretched out in one line with a joint `pivot`, False if it is folded.

    None if its line does not pass through the axis of the joint. `lever` (3) leads from the joint
    to the leg's start, `along` (3) is the direction of the leg from there. For joints with several
    axes the line has to pass through the point of the joint.
    """
    if len(pivot.axes) == 1:
        axis = pivot.axes[0]
        lever, along = (vector - axis * (axis @ vector) for vector in (lever, along))
    size = float(np.linalg.norm(lever) * np.linalg.norm(along))
    if size <= _IN_LINE * float(np.linalg.norm(lever)) or size == 0.0:
        return None
    sine = float(np.linalg.norm(np.cross(lever, along))) / size
    return bool(lever @ along > 0.0) if sine < _IN_LINE else None


def _position(mechanism: Mechanism, side: Side) -> Array:
    """Position (m, base axes) of one side of a joint in the reference posture."""
    frame = mechanism.reference[side.body]
    return np.asarray((frame @ mechanism.bodies[side.body].interfaces[side.point]).position)
