"""Likely causes of a mechanism that cannot move: a joint axis of wrong direction, legs in one line.

To test a joint, the constraints that depend on its axis are omitted: a revolute joint becomes a
spherical joint, a prismatic joint can slide in all directions. If the tool can then move as
prescribed, the direction of the relative motion at the joint is the axis that the joint should
have. The joint is reported only if the mechanism with this axis can move in the reference posture
and near it.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import Joint
from lumped.mechanism.kinematics.closure import Closure, closure_of
from lumped.mechanism.kinematics.mobility import (
    Mobility,
    generic_mobility,
    mobility,
    null_space,
    row_space,
)
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import Mechanism

# Components of unit vectors below this count as zero: axes are typed with four digits.
_NOTHING = 1e-4
# Angle (rad) below which an axis counts as right: typed directions have five digits.
_SMALLEST_ANGLE = 1e-5
# All joints whose angle is within this factor of the smallest angle are reported.
_COMPARABLE = 1.5
# Sine of the angle below which two legs lie in one line.
_IN_LINE = 1e-3


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


def legs_in_line(mechanism: Mechanism) -> list[tuple[str, str, bool]]:
    """Pairs of legs in the reference posture that lie in one line at a joint between them.

    A leg is here a body with two points, and the joint must let it rotate. Each entry contains the
    names of both bodies, and True if the legs are stretched out or False if they are folded.
    """
    pairs = []
    for joint in mechanism.joints:
        if joint.kind not in {"revolute", "universal", "spherical"}:
            continue
        vectors = []
        for side in (joint.first, joint.second):
            body = mechanism.bodies[side.body]
            other_ends = [frame for point, frame in body.interfaces.items() if point != side.point]
            if len(other_ends) == 1:
                vector = other_ends[0].position - body.interfaces[side.point].position
                vectors.append(mechanism.reference[side.body].rotation @ vector)
        if len(vectors) == 2:
            first, second = (vector / np.linalg.norm(vector) for vector in vectors)
            if np.linalg.norm(np.cross(first, second)) < _IN_LINE:
                pairs.append((joint.first.body, joint.second.body, bool(first @ second < 0.0)))
    return pairs
