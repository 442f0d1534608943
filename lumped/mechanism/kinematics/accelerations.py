"""How all bodies of a mechanism move while its tool moves: velocities and accelerations.

With J the derivative of all that is closed and prescribed, J v = (0, ẋ) and J a = (0, ẍ) − J̇ v.
Motions that idle do not start: of all solutions the shortest is taken.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.kinematics.closure import Closure, Placement, closure_of
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import GROUND, Posture

# Singular values below this one are those of a stretched leg, whose posture is a double root, known
# to half of the digits; what is then left of the right-hand side is no motion of the mechanism.
_DEPENDENT, _LEFT = 1e-5, 1e-6
# Of the size: the step of the difference that gives J̇ v, to 1e-10 of itself.
_STEP = 1e-5


@dataclass(frozen=True, eq=False)
class Motion:
    """How a body moves.

    Accelerations `linear` (3, m/s²) of the origin of its axes and `angular` (3, rad/s²), angular
    velocity `turning` (3, rad/s), in the axes that are spoken of.
    """

    linear: Array
    angular: Array
    turning: Array

    def at(self, arm: Array) -> Array:
        """Acceleration (3, m/s²) of the body's point at `arm` (3, m) from its origin."""
        swung = np.cross(self.turning, np.cross(self.turning, arm))
        return np.asarray(self.linear + np.cross(self.angular, arm) + swung)


REST = Motion(np.zeros(3), np.zeros(3), np.zeros(3))


def accelerations(posture: Posture, speed: Array, acceleration: Array) -> dict[str, Motion]:
    """Motions of all bodies while the loaded point has `speed` and `acceleration` (3 each, base).

    Along and about all other directions that its pose prescribes the tool is at rest. Raises
    ComputationError where the mechanism cannot move so.
    """
    closure = closure_of(posture.mechanism)
    placement = closure.placement(posture)
    jacobian = closure.jacobian_at(placement)
    along = [(row, move) for row, move in enumerate(closure.moves) if move < 3]

    def prescribed(values: Array) -> Array:
        right = np.zeros(len(jacobian))
        for row, move in along:
            right[len(closure.joint_of) + row] = values[move]
        return right

    velocity = _shortest(posture, jacobian, prescribed(speed))
    bias = _bias(closure, placement, velocity)
    found = _shortest(posture, jacobian, prescribed(acceleration) - bias)
    motions = {GROUND: REST}
    moving = [name for name in closure.names if name != GROUND]
    unit = np.array([1.0] * 3 + [1.0 / closure.size] * 3)
    rows = zip(moving, velocity.reshape(-1, 6) * unit, found.reshape(-1, 6) * unit, strict=True)
    return motions | {name: Motion(a[:3], a[3:], v[3:]) for name, v, a in rows}


def _shortest(posture: Posture, jacobian: Array, right: Array) -> Array:
    found = np.asarray(lstsq(jacobian, right, cond=_DEPENDENT, check_finite=False)[0])
    if np.linalg.norm(jacobian @ found - right) > _LEFT * np.linalg.norm(right):
        place = shown_pose(posture.mechanism, posture.pose)
        raise ComputationError(
            f"{posture.mechanism.name}, pose {place}: the tool cannot move that way"
        )
    return found


def _bias(closure: Closure, placement: Placement, velocity: Array) -> Array:
    """J̇ v (rows of J)."""
    fastest = float(np.abs(velocity).max(initial=0.0))
    if not fastest:
        return np.zeros(len(closure.joint_of) + len(closure.moves))
    time = _STEP * closure.size / fastest
    before, after = (
        closure.jacobian_at(closure.moved(placement, sign * time * velocity)) for sign in (-1, 1)
    )
    return np.asarray((after - before) @ velocity / (2.0 * time))
