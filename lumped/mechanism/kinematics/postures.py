"""Postures of given poses: Gauss–Newton on all loops at once, followed from the reference posture.

Every step is the shortest one that closes the joints to first order, so that motions which nothing
asks for do not occur and constraints that repeat each other do no harm. A way is divided until each
part of it converges at once: whoever walks in such steps does not change to another assembly of
the same parts.
"""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import lstsq

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError, naming
from lumped.mechanism.body import Frame
from lumped.mechanism.free_twists import turning
from lumped.mechanism.joint import FREEDOMS
from lumped.mechanism.kinematics.closure import Closure, Placement, closure_of
from lumped.mechanism.kinematics.mobility import mobility, mobility_at, undetermined
from lumped.mechanism.mechanism import LENGTHS, Mechanism, Posture
from lumped.memo import memo
from lumped.text import counted

# Farthest coordinate (m or rad) that is tried: squares of larger ones overflow in the end.
_FARTHEST = 100.0
# Residual of a closed posture, of the size of the mechanism.
CLOSED = 1e-12
# Singular values below this one are rounding.
_DEPENDENT = 1e-9
# Displacement of the first iteration, of the size of the mechanism or in rad.
_LONGEST = 0.4
# Each iteration at least this much shorter than the one before: one half at the edge of the
# workspace, where the posture is a double root, and quadratically inside.
_CONTRACTION = 0.6
_ITERATIONS = 60
_SMALLEST_PART = 2.0**-12
# Last step, of the size, after which quadratic convergence leaves rounding alone.
_CONVERGED = 1e-8
# Weight of the tool's pose beside the joints where not both can be met.
_INSISTENT = 1e3
# Gap, of the size, that typed digits leave open rather than a pose out of reach.
_INEXACT = 1e-6


def reference_posture(mechanism: Mechanism) -> Posture:
    """The posture in which the mechanism is described: every joint coordinate is zero."""
    return Posture(
        mechanism,
        mechanism.reference_pose,
        mechanism.reference,
        {joint.name: np.zeros(FREEDOMS[joint.kind]) for joint in mechanism.joints},
    )


class PoseError(InputError):
    """A `pose`, in words, that a robot cannot take for a `reason`."""

    def __init__(self, robot: str, pose: str, reason: str) -> None:
        super().__init__(f"{robot}, pose {pose}: {reason}")
        self.pose, self.reason = pose, reason


def posture(mechanism: Mechanism, pose: Array, start: Posture | None = None) -> Posture:
    """The posture of a `pose` (in the order of the tool's moves), reached from `start`.

    `start` is the reference posture unless given; poses between the two are taken on the straight
    line. Raises InputError if the joints do not close in the reference posture. Raises PoseError if
    the pose cannot be reached (naming the joint that stays open and how far the way went), or the
    tool is not held by the drives or not determined by its moves.
    """
    target = _checked(mechanism, pose)
    if start is None:
        return _from_reference(mechanism, tuple(target.tolist()))
    return _reached(mechanism, start, target)


@memo(256)
def _from_reference(mechanism: Mechanism, pose: tuple[float, ...]) -> Posture:
    """Remembered: who reads a robot file tries the poses that are asked for after that."""
    return _reached(mechanism, reference_posture(mechanism), np.array(pose))


def _reached(mechanism: Mechanism, start: Posture, target: Array) -> Posture:
    closure = closure_of(mechanism)
    if mechanism.inverse_kinematics is None:
        placement, coordinates = _walked(closure, start, target)
    else:
        with naming(mechanism.name):
            frames = mechanism.inverse_kinematics(target)
        placement = _placed(closure, frames, target)
        coordinates = list(closure.coordinates(placement))
    names = (joint.name for joint in mechanism.joints)
    reached = Posture(
        mechanism,
        target,
        closure.frames(placement),
        dict(zip(names, coordinates, strict=True)),
    )
    found = mobility(reached)
    if fault := undetermined(found, closure.size):
        said = "" if len(found.loose) else f"tool.moves = {list(mechanism.tool.moves)}: "
        raise PoseError(mechanism.name, shown_pose(mechanism, target), f"{said}{fault}")
    return reached


def _placed(closure: Closure, frames: Mapping[str, Frame], pose: Array) -> Placement:
    """The placement of bodies at `frames`; raises ComputationError where joints stand open there.

    What all models share no comparison of models would notice.
    """
    posed = Posture(closure.mechanism, pose, frames, {})
    placement = closure.placement(posed)
    missed = np.abs(closure.residual_at(placement, pose)).max()
    if not missed <= CLOSED * closure.size:
        raise ComputationError(
            f"{closure.mechanism.name}, pose {shown_pose(closure.mechanism, pose)}: its inverse "
            f"kinematics leaves the joints open or misses the pose by {missed:.2g} m"
        )
    return placement


def _walked(closure: Closure, begin: Posture, target: Array) -> tuple[Placement, list[Array]]:
    """The placement at a pose and the joints' coordinates there, on the straight way from `begin`.

    Raises InputError as `posture` does.
    """
    mechanism = closure.mechanism
    placement = closure.placement(begin)
    _refuse_open_reference(closure)
    coordinates = [begin.coordinates[joint.name] for joint in mechanism.joints]
    done, part = 0.0, 1.0
    while done < 1.0:
        goal = begin.pose + (done + part) * (target - begin.pose)
        closed = _closed(closure, placement, goal)
        if closed is not None:
            placement, done = closed, done + part
            coordinates = _followed(closure, placement, coordinates)
            part = min(2.0 * part, 1.0 - done)
        elif part > _SMALLEST_PART:
            part *= 0.5
        else:
            raise PoseError(
                mechanism.name,
                shown_pose(mechanism, target),
                _out_of_reach(closure, placement, target, done),
            )
    return placement, coordinates


def shown_pose(mechanism: Mechanism, pose: Array) -> str:
    """A pose in words, in the file's unit of length: "x = 0.2 m, phi_z = 0.1 rad"."""
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


def _closed(closure: Closure, placement: Placement, pose: Array) -> Placement | None:
    """The placement with closed joints and the tool at `pose`, or None if it is too far to walk."""
    before = np.inf
    for _ in range(_ITERATIONS):
        residual = closure.residual_at(placement, pose)
        closed = np.abs(residual).max(initial=0.0) <= CLOSED * closure.size
        if closed and before <= _CONVERGED * closure.size:
            return placement
        jacobian = closure.jacobian_at(placement)
        step = lstsq(
            jacobian, -residual, cond=_DEPENDENT, lapack_driver="gelsy", check_finite=False
        )[0]
        length = float(np.abs(step).max(initial=0.0))
        if closed and length > _CONTRACTION * before:
            return placement
        if length > min(_LONGEST * closure.size, _CONTRACTION * before):
            return None
        placement, before = closure.moved(placement, step), length
    return None


def _followed(closure: Closure, placement: Placement, before: list[Array]) -> list[Array]:
    """Coordinates of all joints, angles carried on past half a turn from what they were before."""
    found = []
    joints = closure.mechanism.joints
    for joint, values, old in zip(joints, closure.coordinates(placement), before, strict=True):
        turns = np.round((old - values) / (2.0 * np.pi)) * turning(joint)
        found.append(values + 2.0 * np.pi * turns)
    return found


def _refuse_open_reference(closure: Closure) -> None:
    residual = np.abs(closure.residual(closure.reference))
    if residual.max(initial=0.0) > CLOSED * closure.size:
        joint = closure.mechanism.joints[closure.joint_of[np.argmax(residual)]]
        raise InputError(
            f"{closure.mechanism.name}: joint {joint.name} is open by "
            f"{closure.mechanism.lengths.shown(residual.max(), 3)} in the reference posture"
        )


def _out_of_reach(closure: Closure, placement: Placement, pose: Array, done: float) -> str:
    """Why the way ends: which joint opens, by how much at the pose, and how far the way went."""
    widths = _widths(closure, _nearest(closure, placement, pose))
    reached = closure.pose(placement)[: len(pose)]
    joint = closure.mechanism.joints[int(np.argmax(widths))]
    why = (
        f'cannot be reached: joint "{joint.name}" stays open by '
        f"{closure.mechanism.lengths.shown(widths.max(), 3)}; the way from the reference posture "
        f"ends after {100.0 * done:.0f} %, at "
        f"{shown_pose(closure.mechanism, reached)}"
    )
    found = mobility_at(closure, placement)
    if done == 0.0 and found.at_limit:
        return f"{why}, where drives {', '.join(found.stirring)} move without the tool"
    if found.redundant and widths.max() < _INEXACT * closure.size:
        return (
            f"{why}; {found.redundant} of its constraints repeat others and contradict them by "
            "that little: points and directions must be given with all their digits"
        )
    if done == 0.0 and found.barred:
        return f"{why}; its joints do not let the tool move along {', '.join(found.barred)}"
    return why


def _widths(closure: Closure, placement: Placement) -> Array:
    """How far each joint stands open (m)."""
    squares = closure.residual(placement) ** 2
    return np.sqrt(np.bincount(closure.joint_of, squares, len(closure.mechanism.joints)))


def _nearest(closure: Closure, placement: Placement, pose: Array) -> Placement:
    """The placement that has the tool at the pose and the joints as little open as possible."""
    weights = np.ones(len(closure.joint_of) + len(closure.moves))
    weights[len(closure.joint_of) :] = _INSISTENT
    residual = weights * closure.residual_at(placement, pose)
    damping = 1.0
    for _ in range(_ITERATIONS):
        jacobian = weights[:, None] * closure.jacobian_at(placement)
        system = np.vstack([jacobian, damping * np.eye(jacobian.shape[1])])
        step = lstsq(system, np.append(-residual, np.zeros(jacobian.shape[1])))[0]
        tried = closure.moved(placement, step)
        found = weights * closure.residual_at(tried, pose)
        if found @ found < residual @ residual:
            placement, residual, damping = tried, found, 0.3 * damping
        else:
            damping *= 4.0
    return placement
