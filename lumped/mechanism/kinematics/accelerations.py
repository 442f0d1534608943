"""Velocities and accelerations of all bodies of a mechanism for a given motion of its tool.

J is the derivative of the joint constraints and of the prescribed coordinates with respect to the
unknown displacements. The velocity v and the acceleration a of the unknowns satisfy J v = (0, ẋ)
and J a = (0, ẍ) − J̇ v for a velocity ẋ and an acceleration ẍ of the tool. The solutions of least
norm are used, in which idle motions are at rest.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.kinematics.closure import Closure, Placement, closure_of
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import GROUND, Posture

# Relative singular value below which equations are dependent. It is the value for a stretched leg,
# whose posture is a double root and hence accurate to half of the digits. Then: largest relative
# residual of a motion that the mechanism can perform.
_DEPENDENT, _RESIDUAL = 1e-5, 1e-6
# Step of the central difference for J̇ v, as a fraction of the size: relative error about 1e-10.
_STEP = 1e-5


@dataclass(frozen=True, eq=False)
class Motion:
    """Accelerations and angular velocity of a body, in base axes or in body axes.

    `linear_acceleration` (3, in m/s²) is the acceleration of the origin of the body.
    `angular_acceleration` (3) is in rad/s², `angular_velocity` (3) in rad/s.
    """

    linear_acceleration: Array
    angular_acceleration: Array
    angular_velocity: Array

    def acceleration_at(self, arm: Array) -> Array:
        """Acceleration (3, in m/s²) of a point of the body.

        `arm` (3, in m) is the vector from the origin of the body to the point.
        """
        centripetal = np.cross(self.angular_velocity, np.cross(self.angular_velocity, arm))
        return np.asarray(
            self.linear_acceleration + np.cross(self.angular_acceleration, arm) + centripetal
        )


REST = Motion(np.zeros(3), np.zeros(3), np.zeros(3))


def accelerations(posture: Posture, speed: Array, acceleration: Array) -> dict[str, Motion]:
    """Motion of each body (base axes, by name) if the loaded point moves.

    `speed` (3, in m/s) and `acceleration` (3, in m/s²) are those of the loaded point, in base axes.
    The prescribed rotations of the tool are constant. Raises ComputationError if the mechanism
    cannot perform the motion.
    """
    closure = closure_of(posture.mechanism)
    placement = closure.placement(posture)
    jacobian = closure.jacobian_at(placement)
    translation_rows = [(row, move) for row, move in enumerate(closure.moves) if move < 3]

    def prescribed(values: Array) -> Array:
        right_side = np.zeros(len(jacobian))
        for row, move in translation_rows:
            right_side[len(closure.joint_of) + row] = values[move]
        return right_side

    velocity = _shortest(posture, jacobian, prescribed(speed))
    bias = _bias(closure, placement, velocity)
    solution = _shortest(posture, jacobian, prescribed(acceleration) - bias)
    motions = {GROUND: REST}
    moving = [name for name in closure.names if name != GROUND]
    unit = np.array([1.0] * 3 + [1.0 / closure.size] * 3)
    rows = zip(moving, velocity.reshape(-1, 6) * unit, solution.reshape(-1, 6) * unit, strict=True)
    return motions | {name: Motion(a[:3], a[3:], v[3:]) for name, v, a in rows}


def _shortest(posture: Posture, jacobian: Array, right_side: Array) -> Array:
    solution = np.asarray(lstsq(jacobian, right_side, cond=_DEPENDENT, check_finite=False)[0])
    if np.linalg.norm(jacobian @ solution - right_side) > _RESIDUAL * np.linalg.norm(right_side):
        pose = shown_pose(posture.mechanism, posture.pose)
        raise ComputationError(
            f"{posture.mechanism.name}, pose {pose}: singular posture, in which the tool cannot "
            "move with the requested speed and acceleration"
        )
    return solution


def _bias(closure: Closure, placement: Placement, velocity: Array) -> Array:
    """Velocity-dependent term J̇ v of the acceleration equations, one value per row of J.

    `velocity` is v (one value per unknown).
    """
    fastest = float(np.abs(velocity).max(initial=0.0))
    if not fastest:
        return np.zeros(len(closure.joint_of) + len(closure.moves))
    time = _STEP * closure.size / fastest
    before, after = (
        closure.jacobian_at(closure.displaced(placement, step * velocity)) for step in (-time, time)
    )
    return np.asarray((after - before) @ velocity / (2.0 * time))
