"""Loop closure: residuals of the joints of a mechanism, their derivatives, and their solution.

All joints are evaluated together, as arrays. Residuals are lengths (m): angles are multiplied by
the size of the mechanism, a length. The unknowns are small displacements of the movable bodies in
base axes, in the order of the mechanism. Each body has six: the translation of its origin (m), and
its rotation times the size of the mechanism (m). The derivatives are screws.

Loops are closed by the Gauss–Newton method. Each step is the shortest one that closes the joints to
first order. Idle motions therefore do not occur, and redundant constraints do no harm.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lstsq

from lumped.arrays import Array, IntArray
from lumped.errors import InputError
from lumped.mechanism.body import Frame
from lumped.mechanism.free_twists import (
    axes_of_drive,
    constraints,
    coordinates,
    rotation_since_reference,
    whole_turn_flags,
)
from lumped.mechanism.mechanism import GROUND, MOVES, Mechanism, Posture
from lumped.memo import memo
from lumped.screws import rotation_about, rotation_vector, skew

# Angle (rad) below which the second term θ²/720 of a power series is less than round-off.
_SMALL = 1e-6
# Residual of a closed posture, as a fraction of the size of the mechanism.
CLOSED = 1e-12
# Singular values below this are round-off.
_DEPENDENT = 1e-9
# Largest displacement in the first iteration, as a fraction of the size of the mechanism or in rad.
_LONGEST = 0.4
# Largest ratio of the displacements in successive iterations. Convergence is linear with 1/2 at the
# edge of the workspace, where the posture is a double root, and quadratic inside.
_CONTRACTION = 0.6
_ITERATIONS = 60
# Largest last step, as a fraction of the size, after which only round-off is left, because
# convergence is quadratic.
_CONVERGED = 1e-8
# Weight of the deviation from the pose relative to open joints, if both cannot be zero.
_INSISTENT = 1e3


@dataclass(frozen=True, eq=False)
class Placement:
    """Positions and rotations of all n bodies, in the order of the mechanism.

    `origins` (n×3, in m, base axes) are the positions of their origins. `turns` (n×3×3, base axes)
    are their rotations from the reference posture.
    """

    origins: Array
    turns: Array


class Closure:
    """Constraints of all joints of a mechanism and of the pose of its tool, as arrays."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.size = mechanism.size
        self.names = tuple(mechanism.bodies)
        self._number = {name: i for i, name in enumerate(self.names)}
        self._moving = np.array([name != GROUND for name in self.names])
        joints = mechanism.joints
        self._first = np.array([self._number[j.first.body] for j in joints], dtype=int)
        self._second = np.array([self._number[j.second.body] for j in joints], dtype=int)
        self._arm_first = np.array([self._arm(j.first.body, j.first.point) for j in joints])
        self._arm_second = np.array([self._arm(j.second.body, j.second.point) for j in joints])
        # Constraints n·p = 0 and b·R c = b·c of `lumped.mechanism.free_twists`, with n and b fixed
        # in the first body, c in the second.
        normals, b_vectors, c_vectors = zip(*map(constraints, joints), strict=True)
        self._normal, self._b, self._c = map(np.vstack, (normals, b_vectors, c_vectors))
        self._target = np.sum(self._b * self._c, axis=1)
        self._sliding = np.repeat(np.arange(len(joints)), list(map(len, normals)))
        self._turning = np.repeat(np.arange(len(joints)), list(map(len, b_vectors)))
        self._reference_gaps = self._gaps(self.reference)[2]
        # Index of the joint to which each constraint belongs, in the order of the residuals.
        self.joint_of = np.concatenate([self._sliding, self._turning])
        # True for constraints on translations, False for constraints on rotations.
        self.is_sliding = np.arange(len(self.joint_of)) < len(self._sliding)
        self._driven = np.array([i for i, j in enumerate(joints) if j.drive is not None], dtype=int)
        driven = [axes_of_drive(joint) for joint in joints if joint.drive is not None]
        self._drive_axes = np.array(driven).reshape(-1, 2, 3).swapaxes(0, 1)
        tool = mechanism.tool
        self._tool_body = self._number[tool.body]
        self._tool_arm = self._arm(tool.body, tool.point)
        constant_moves = dict(tool.constant_moves)
        # Prescribed coordinates: those of a pose, followed by those that are constant in all poses.
        self.moves = [MOVES.index(move) for move in (*tool.moves, *constant_moves)]
        self._constants = np.array(list(constant_moves.values()))
        self._datum = np.array(tool.datum)
        self._weights = np.array([1.0] * 3 + [self.size] * 3)[self.moves]

    def _arm(self, body: str, point: str) -> Array:
        """Vector (3, in m) from a body's origin to an interface, base axes, reference posture."""
        interface = self.mechanism.bodies[body].interfaces[point]
        arm: Array = self.mechanism.reference[body].rotation @ interface.position
        return arm

    @cached_property
    def reference(self) -> Placement:
        """Positions of all bodies in the reference posture."""
        origins = [self.mechanism.reference[name].position for name in self.names]
        return Placement(np.array(origins), np.tile(np.eye(3), (len(self.names), 1, 1)))

    def placement(self, posture: Posture) -> Placement:
        """Positions of all bodies in `posture`."""
        return Placement(
            np.array([posture.frames[name].position for name in self.names]),
            np.array([rotation_since_reference(posture, name) for name in self.names]),
        )

    def posture(self, placement: Placement, pose: Array, coordinates: Iterable[Array]) -> Posture:
        """Posture at `pose` with the positions of all bodies and the joints' `coordinates`."""
        reference = self.mechanism.reference
        frames = {
            name: Frame(origin, turn @ reference[name].rotation)
            for name, origin, turn in zip(
                self.names, placement.origins, placement.turns, strict=True
            )
        }
        joints = (joint.name for joint in self.mechanism.joints)
        return Posture(self.mechanism, pose, frames, dict(zip(joints, coordinates, strict=True)))

    def coordinates(self, placement: Placement) -> Iterator[Array]:
        """Coordinates (m, rad) of each joint, in order. Angles are between −π and π."""
        first = placement.turns[self._first]
        # Coordinates are zero in the reference posture, even if the interfaces are apart there.
        p = np.einsum("jki,jk->ji", first, self._gaps(placement)[2]) - self._reference_gaps
        R = np.einsum("jki,jkl->jil", first, placement.turns[self._second])
        return (coordinates(*each) for each in zip(self.mechanism.joints, p, R, strict=True))

    def coordinates_after(self, placement: Placement, before: list[Array]) -> list[Array]:
        """Coordinates of all joints, with whole turns added to angles so that they stay continuous.

        `before` contains the coordinates of all joints in the preceding posture.
        """
        unwrapped = []
        joints = self.mechanism.joints
        for joint, values, previous in zip(
            joints, self.coordinates(placement), before, strict=True
        ):
            turns = np.round((previous - values) / (2.0 * np.pi)) * whole_turn_flags(joint)
            unwrapped.append(values + 2.0 * np.pi * turns)
        return unwrapped

    def _gaps(self, placement: Placement) -> tuple[Array, Array, Array]:
        """Arms of the first and of the second interfaces of all j joints, and gaps between them.

        An arm is the vector from the origin of a body to its interface, a gap the vector from the
        first interface of a joint to the second. Each array is j×3 (m, base axes).
        """
        first = np.einsum("jkl,jl->jk", placement.turns[self._first], self._arm_first)
        second = np.einsum("jkl,jl->jk", placement.turns[self._second], self._arm_second)
        origins = placement.origins
        gap = origins[self._second] + second - origins[self._first] - first
        return first, second, gap

    def residual(self, placement: Placement) -> Array:
        """Residual (m) of each constraint of the joints. Zero if all joints are closed."""
        turns = placement.turns
        gap = self._gaps(placement)[2][self._sliding]
        normal = np.einsum("tkl,tl->tk", turns[self._first[self._sliding]], self._normal)
        b = np.einsum("rkl,rl->rk", turns[self._first[self._turning]], self._b)
        c = np.einsum("rkl,rl->rk", turns[self._second[self._turning]], self._c)
        slides, swings = (normal * gap).sum(axis=1), (b * c).sum(axis=1)
        return np.concatenate([slides, self.size * (swings - self._target)])

    def gap_widths(self, placement: Placement) -> Array:
        """Gap (m) of each joint: norm of the residuals of its constraints."""
        squares = self.residual(placement) ** 2
        return np.sqrt(np.bincount(self.joint_of, squares, len(self.mechanism.joints)))

    def jacobian(self, placement: Placement) -> Array:
        """Derivative (constraints × unknowns, dimensionless) of `residual`."""
        turns = placement.turns
        j = self._sliding
        first, second, gap = (each[j] for each in self._gaps(placement))
        normal = np.einsum("tkl,tl->tk", turns[self._first[j]], self._normal)
        sliding = self._rows(
            j, -normal, -_cross(first + gap, normal), normal, _cross(second, normal)
        )
        j = self._turning
        b = np.einsum("rkl,rl->rk", turns[self._first[j]], self._b)
        c = np.einsum("rkl,rl->rk", turns[self._second[j]], self._c)
        axis = self.size * _cross(c, b)
        no_translation = np.zeros_like(axis)
        turning = self._rows(j, no_translation, -axis, no_translation, axis)
        return self._unknowns(np.concatenate([sliding, turning]))

    def _rows(self, joints: IntArray, *blocks: Array) -> Array:
        """Derivatives (rows × bodies × 6) of constraints. Row i belongs to the joint `joints[i]`.

        The four `blocks` (rows×3 each) are the derivatives with respect to the translation and the
        rotation of the joint's first body, then of its second body.
        """
        rows = np.zeros((len(joints), len(self.names), 6))
        each = np.arange(len(joints))
        along1, about1, along2, about2 = blocks
        rows[each, self._first[joints], :3] = along1
        rows[each, self._first[joints], 3:] = about1
        rows[each, self._second[joints], :3] = along2
        rows[each, self._second[joints], 3:] = about2
        return rows

    def _unknowns(self, rows: Array) -> Array:
        movable_rows: Array = rows[:, self._moving]
        movable_rows[:, :, 3:] /= self.size
        return movable_rows.reshape(len(rows), 6 * int(self._moving.sum()))

    def drives(self, placement: Placement) -> Array:
        """Derivatives (drives × unknowns) of the coordinates of the driven joints.

        Coordinates that are angles are multiplied by the size of the mechanism.
        """
        first = self._gaps(placement)[0][self._driven]
        body1, body2 = self._first[self._driven], self._second[self._driven]
        along, about = (
            np.einsum("dkl,dl->dk", placement.turns[body1], axes) for axes in self._drive_axes
        )
        about = self.size * about
        arm = placement.origins[body1] + first - placement.origins[body2]
        rows = self._rows(
            self._driven,
            -along,
            -_cross(first, along) - about,
            along,
            _cross(arm, along) + about,
        )
        return self._unknowns(rows)

    def relative_motion(self, placement: Placement, number: int, *, slides: bool) -> Array:
        """Derivatives (3 × unknowns, base axes) of the relative motion of a joint's two bodies.

        The motion of the second body relative to the first is the translation of the interfaces if
        `slides` is True, otherwise the rotation multiplied by the size of the mechanism. `number`
        is the index of the joint.
        """
        joints = np.full(3, number)
        first, second, gap = (each[joints] for each in self._gaps(placement))
        axes = np.eye(3)
        if slides:
            blocks = (-axes, -_cross(first + gap, axes), axes, _cross(second, axes))
        else:
            nothing = np.zeros((3, 3))
            blocks = (nothing, -self.size * axes, nothing, self.size * axes)
        return self._unknowns(self._rows(joints, *blocks))

    def tool_twists(self, placement: Placement) -> Array:
        """Matrix (6 × unknowns) that maps the unknowns to the twist of the loaded point, base axes.

        The rotation in the twist is multiplied by the size of the mechanism.
        """
        rows = np.zeros((6, len(self.names), 6))
        rows[:, self._tool_body] = np.eye(6)
        rows[:3, self._tool_body, 3:] = -skew(self._tool_arm_in(placement))
        rows[3:] *= self.size
        return self._unknowns(rows)

    def pose(self, placement: Placement) -> Array:
        """Coordinates (m, rad) of the tool: its moves in their order, then its constant moves."""
        arm = self._tool_arm_in(placement) - self._datum
        position = placement.origins[self._tool_body] + arm
        values: Array = np.concatenate([position, self._tool_rotation(placement)])[self.moves]
        return values

    def pose_jacobian(self, placement: Placement) -> Array:
        """Derivative (coordinates × unknowns) of the tool's `pose` with respect to the unknowns.

        Coordinates that are angles are multiplied by the size of the mechanism.
        """
        rates = np.eye(6)
        rates[3:, 3:] = _rotation_vector_rates(self._tool_rotation(placement))
        derivative: Array = rates[self.moves] @ self.tool_twists(placement)
        return derivative

    def residual_at(self, placement: Placement, pose: Array) -> Array:
        """Residuals (m) of all joint constraints, then deviations (m) of the tool from `pose`.

        Deviations of angles are multiplied by the size of the mechanism.
        """
        deviation = self._weights * (self.pose(placement) - np.append(pose, self._constants))
        return np.concatenate([self.residual(placement), deviation])

    def jacobian_at(self, placement: Placement) -> Array:
        """Derivative (dimensionless) of `residual_at` with respect to the unknowns."""
        return np.concatenate([self.jacobian(placement), self.pose_jacobian(placement)])

    def displaced(self, placement: Placement, step: Array) -> Placement:
        """Positions of all bodies after the small displacements `step` (one value per unknown)."""
        along, about = step.reshape(-1, 2, 3).swapaxes(0, 1)
        origins, turns = placement.origins.copy(), placement.turns.copy()
        origins[self._moving] += along
        rotated = rotation_about(about / self.size) @ turns[self._moving]
        # One Newton step towards the nearest rotation matrix prevents round-off from accumulating.
        turns[self._moving] = 1.5 * rotated - 0.5 * rotated @ rotated.swapaxes(1, 2) @ rotated
        return Placement(origins, turns)

    def require_closed_reference(self) -> None:
        """Raise InputError if a joint is open in the reference posture."""
        residual = np.abs(self.residual(self.reference))
        if residual.max(initial=0.0) > CLOSED * self.size:
            joint = self.mechanism.joints[self.joint_of[np.argmax(residual)]]
            raise InputError(
                f"{self.mechanism.name}: joint {joint.name} is open by "
                f"{self.mechanism.lengths.shown(residual.max(), 3)} in the reference posture"
            )

    def closed_at(self, placement: Placement, pose: Array) -> Placement | None:
        """Positions of all bodies with closed joints and the tool at `pose`.

        The iteration starts at `placement`. None if its steps do not become shorter.
        """
        previous_length = np.inf
        for _ in range(_ITERATIONS):
            residual = self.residual_at(placement, pose)
            closed = np.abs(residual).max(initial=0.0) <= CLOSED * self.size
            if closed and previous_length <= _CONVERGED * self.size:
                return placement
            jacobian = self.jacobian_at(placement)
            step = lstsq(
                jacobian, -residual, cond=_DEPENDENT, lapack_driver="gelsy", check_finite=False
            )[0]
            length = float(np.abs(step).max(initial=0.0))
            if closed and length > _CONTRACTION * previous_length:
                return placement
            if length > min(_LONGEST * self.size, _CONTRACTION * previous_length):
                return None
            placement, previous_length = self.displaced(placement, step), length
        return None

    def nearest_to(self, placement: Placement, pose: Array) -> Placement:
        """Positions of all bodies with the tool at `pose` and the smallest gaps of joints."""
        weights = np.ones(len(self.joint_of) + len(self.moves))
        weights[len(self.joint_of) :] = _INSISTENT
        residual = weights * self.residual_at(placement, pose)
        damping = 1.0
        for _ in range(_ITERATIONS):
            jacobian = weights[:, None] * self.jacobian_at(placement)
            system = np.vstack([jacobian, damping * np.eye(jacobian.shape[1])])
            step = lstsq(system, np.append(-residual, np.zeros(jacobian.shape[1])))[0]
            trial = self.displaced(placement, step)
            trial_residual = weights * self.residual_at(trial, pose)
            if trial_residual @ trial_residual < residual @ residual:
                placement, residual, damping = trial, trial_residual, 0.3 * damping
            else:
                damping *= 4.0
        return placement

    def _tool_rotation(self, placement: Placement) -> Array:
        """Rotation vector (3, in rad) of the tool. Zero if no rotation is prescribed."""
        if max(self.moves, default=0) < 3:
            return np.zeros(3)
        return rotation_vector(placement.turns[self._tool_body])

    def _tool_arm_in(self, placement: Placement) -> Array:
        arm: Array = placement.turns[self._tool_body] @ self._tool_arm
        return arm


@memo(16)
def closure_of(mechanism: Mechanism) -> Closure:
    """`Closure` of a mechanism. The last 16 results are memoised."""
    return Closure(mechanism)


def _cross(first: Array, second: Array) -> Array:
    """Cross products of rows (n×3). For few rows, numpy.cross takes five times as long."""
    successor, predecessor = [1, 2, 0], [2, 0, 1]
    product: Array = (
        first[:, successor] * second[:, predecessor] - first[:, predecessor] * second[:, successor]
    )
    return product


def _rotation_vector_rates(vector: Array) -> Array:
    """3×3 matrix that maps angular velocity (base axes) to the rate of the rotation `vector`.

    It is the inverse of the left Jacobian of SO(3): I − [v]/2 + (1/θ² − (1 + cos θ)/(2θ sin θ))
    [v]².
    """
    angle, cross = float(np.linalg.norm(vector)), skew(vector)
    if angle < _SMALL:
        share = 1.0 / 12.0
    else:
        share = 1.0 / angle**2 - (1.0 + np.cos(angle)) / (2.0 * angle * np.sin(angle))
    return np.eye(3) - 0.5 * cross + share * cross @ cross
