"""Posture of a mechanism for a pose of its tool, approached from its reference posture.

The path to the pose is divided until the iteration that closes all loops
(`lumped.mechanism.kinematics.closure`) converges on each part with steps of decreasing length, so
that the robot keeps its assembly mode.
"""

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError, naming
from lumped.mechanism.joint import FREEDOMS
from lumped.mechanism.kinematics.closure import CLOSED, Closure, Placement, closure_of
from lumped.mechanism.kinematics.mobility import indeterminacy, mobility, mobility_at
from lumped.mechanism.mechanism import LENGTHS, Mechanism, Posture
from lumped.memo import memo
from lumped.text import counted

# Largest allowed coordinate (m or rad) of a pose. Squares of much larger ones overflow.
_FARTHEST = 100.0
# Smallest part of the path to a pose that is tried.
_SMALLEST_PART = 2.0**-12
# Largest gap of a joint, as a fraction of the size, whose likely cause is rounded input. Larger
# gaps are due to limited reach.
_INEXACT = 1e-6


def reference_posture(mechanism: Mechanism) -> Posture:
    """Posture in which the robot file describes the mechanism. All joint coordinates are zero."""
    return Posture(
        mechanism,
        mechanism.reference_pose,
        mechanism.reference,
        {joint.name: np.zeros(FREEDOMS[joint.kind]) for joint in mechanism.joints},
    )


class PoseError(InputError):
    """Error: a robot cannot take a pose. `pose` is the pose as text, `reason` is the cause."""

    def __init__(self, robot: str, pose: str, reason: str) -> None:
        super().__init__(f"{robot}, pose {pose}: {reason}")
        self.pose, self.reason = pose, reason


def posture(mechanism: Mechanism, pose: Array, start: Posture | None = None) -> Posture:
    """Posture of a mechanism for `pose` (m and rad, in the order of the tool's moves).

    The pose is approached from `start`, by default the reference posture, along a straight line of
    intermediate poses. Raises InputError if the joints do not close in the reference posture.
    Raises PoseError if the pose cannot be reached (the message names the joint that opens and the
    part of the path that is possible), if the drives do not fix the tool, or if the moves of the
    tool do not determine the posture.
    """
    target = _checked(mechanism, pose)
    if start is None:
        return _from_reference(mechanism, tuple(target.tolist()))
    return _posture_from(mechanism, start, target)


@memo(256)
def _from_reference(mechanism: Mechanism, pose: tuple[float, ...]) -> Posture:
    """Posture for `pose`, approached from the reference posture.

    It is memoised: the poses of later computations are computed already when a robot file is read
    and checked.
    """
    return _posture_from(mechanism, reference_posture(mechanism), np.array(pose))


def _posture_from(mechanism: Mechanism, start: Posture, target: Array) -> Posture:
    if mechanism.inverse_kinematics is None:
        target_posture = _continued(start, target)
    else:
        with naming(mechanism.name):
            frames = mechanism.inverse_kinematics(target)
        target_posture = _verified(Posture(mechanism, target, frames, {}))
    result = mobility(target_posture)
    if fault := indeterminacy(result, mechanism.size):
        key = (
            ""
            if len(result.uncontrolled_twists)
            else f"tool.moves = {list(mechanism.tool.moves)}: "
        )
        raise PoseError(mechanism.name, shown_pose(mechanism, target), f"{key}{fault}")
    return target_posture


def _verified(candidate: Posture) -> Posture:
    """Posture with the coordinates of all joints, after a check of its frames.

    Raises ComputationError if a joint is open or the tool is not at the pose. No comparison of
    models would reveal such an error of the kinematics, because it would affect all models alike.
    """
    mechanism, pose = candidate.mechanism, candidate.pose
    closure = closure_of(mechanism)
    placement = closure.placement(candidate)
    deviation = np.abs(closure.residual_at(placement, pose)).max()
    if not deviation <= CLOSED * closure.size:
        raise ComputationError(
            f"{mechanism.name}, pose {shown_pose(mechanism, pose)}: the inverse kinematics of the "
            f"mechanism leaves the joints open or misses the pose by {deviation:.2g} m"
        )
    return closure.posture(placement, pose, closure.coordinates(placement))


def _continued(begin: Posture, target: Array) -> Posture:
    """Posture for the pose `target`, which is approached from the posture `begin`.

    Raises InputError under the conditions of `posture`.
    """
    mechanism = begin.mechanism
    closure = closure_of(mechanism)
    placement = closure.placement(begin)
    closure.require_closed_reference()
    coordinates = [begin.coordinates[joint.name] for joint in mechanism.joints]
    progress, part = 0.0, 1.0
    while progress < 1.0:
        goal = begin.pose + (progress + part) * (target - begin.pose)
        closed = closure.closed_at(placement, goal)
        if closed is not None:
            placement, progress = closed, progress + part
            coordinates = closure.coordinates_after(placement, coordinates)
            part = min(2.0 * part, 1.0 - progress)
        elif part > _SMALLEST_PART:
            part *= 0.5
        else:
            raise PoseError(
                mechanism.name,
                shown_pose(mechanism, target),
                _out_of_reach(closure, placement, target, progress),
            )
    return closure.posture(placement, target, coordinates)


def shown_pose(mechanism: Mechanism, pose: Array) -> str:
    """Text of a pose in the length unit of the robot file, such as "x = 0.2 m, phi_z = 0.1 rad"."""
    return ", ".join(
        f"{move} = {mechanism.lengths.shown(value) if move in LENGTHS else f'{value:.6g} rad'}"
        for move, value in zip(mechanism.tool.moves, pose, strict=True)
    )


def _checked(mechanism: Mechanism, pose: Array) -> Array:
    target = np.asarray(pose, dtype=float)
    moves = mechanism.tool.moves
    if target.shape != (len(moves),) or not (np.abs(target) <= _FARTHEST).all():
        raise InputError(
            f"{mechanism.name}: a pose must be {counted(len(moves), 'finite number')} "
            f"up to {mechanism.lengths.shown(_FARTHEST)} or {_FARTHEST:g} rad "
            f"({', '.join(moves) or 'none, the tool has no moves'})"
        )
    return target


def _out_of_reach(closure: Closure, placement: Placement, pose: Array, progress: float) -> str:
    """Reason why a pose cannot be reached: the open joint, its gap, and the last reachable pose.

    `placement` contains the positions of all bodies in the last reachable pose. `progress` (0 to 1)
    is the part of the path to `pose` that was covered.
    """
    widths = closure.gap_widths(closure.nearest_to(placement, pose))
    last_pose = closure.pose(placement)[: len(pose)]
    joint = closure.mechanism.joints[int(np.argmax(widths))]
    reason = (
        f'cannot be reached: joint "{joint.name}" stays open by '
        f"{closure.mechanism.lengths.shown(widths.max(), 3)}; on the way from the "
        f"reference posture the last reachable pose, after {100.0 * progress:.0f} %, is "
        f"{shown_pose(closure.mechanism, last_pose)}"
    )
    result = mobility_at(closure, placement)
    if progress == 0.0 and result.at_limit:
        return f"{reason}, where drives {', '.join(result.stirring)} move without the tool"
    if result.redundant and widths.max() < _INEXACT * closure.size:
        return (
            f"{reason}; {result.redundant} redundant constraints contradict the others by "
            "this amount: give points and directions with all their digits"
        )
    if progress == 0.0 and result.barred:
        return f"{reason}; the joints do not let the tool move along {', '.join(result.barred)}"
    return reason
