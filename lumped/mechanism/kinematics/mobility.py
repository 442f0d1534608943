"""Mobility of a posture from the null space of its constraints: what moves, what idles.

With J the derivative of the constraints, N a basis of its null space, D the rates of the drives, T
the twist and M the pose of the tool: a motion in N that D does not see is left with the drives
held. If T does not see it either it idles; otherwise the tool is loose.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq, svd

from lumped.arrays import Array
from lumped.mechanism.kinematics.closure import Closure, Placement, closure_of
from lumped.mechanism.mechanism import MOVES, Mechanism, Posture
from lumped.memo import memo
from lumped.screws import name_twists

# Singular values of matrices without units. Geometry is typed with six digits or more.
_NOTHING = 1e-6
# Below it a constraint repeats others but for directions typed with three digits.
_ALMOST = 3e-3
# How far another posture is, of the size, and how many steps of Newton's close it again.
_AWAY = 0.02
_ITERATIONS = 8


@dataclass(frozen=True, eq=False)
class Mobility:
    """What can move in a posture.

    `mobility` of the whole mechanism; `redundant` constraints, without which it would move no more
    (the overconstraint), and those that are so but for a few digits (`almost_redundant`), of
    `constraints`; `idle` motions, which stir neither the tool nor a
    drive. Twists of the loaded point (base axes, m and rad) span `loose` (k×6), what is left to
    it with the drives held, and `unprescribed` (k×6), what it can do while its pose stands.
    `barred` names the moves that some motion of the joints would be needed for and none exists,
    `stirring` the drives that can move while the pose stands. In a posture where legs are
    stretched or folded there are as many of one as of the other (`at_limit`).
    """

    mobility: int
    constraints: int
    redundant: int
    almost_redundant: int
    idle: int
    moves: int
    loose: Array
    unprescribed: Array
    stirring: tuple[str, ...]
    barred: tuple[str, ...]

    @property
    def spare(self) -> int:
        """Motions beyond those that idle and those that the tool's moves prescribe."""
        return self.mobility - self.idle - self.moves

    @property
    def at_limit(self) -> bool:
        """Whether the tool is at the edge of what its legs reach (a type 1 singularity)."""
        return self.spare == 0 and bool(self.stirring)


@memo(256)
def mobility(posture: Posture) -> Mobility:
    """Mobility, idle motions, overconstraint and singularities of a posture."""
    closure = closure_of(posture.mechanism)
    return mobility_at(closure, closure.placement(posture))


def mobility_nearby(mechanism: Mechanism) -> Mobility:
    """As `mobility`, of a posture that all motions of the reference posture have led away from it.

    What is singular in one posture alone is not so there.
    """
    closure = closure_of(mechanism)
    placement = closure.reference
    free = _null_space(closure.jacobian(placement))
    step = _AWAY * closure.size * free @ np.linspace(1.0, 2.0, free.shape[1])
    for _ in range(_ITERATIONS):
        placement = closure.moved(placement, step)
        step = -lstsq(closure.jacobian(placement), closure.residual(placement), cond=_NOTHING)[0]
    return mobility_at(closure, placement)


def mobility_at(closure: Closure, placement: Placement) -> Mobility:
    """As `mobility`, of a closed placement of the bodies."""
    jacobian = closure.jacobian(placement)
    _, values, right = svd(jacobian, check_finite=False)
    rank = int(np.count_nonzero(values > _NOTHING))
    free = right[rank:].T
    drives = closure.drives(placement) @ free
    tool = closure.tool_twists(placement) @ free
    unit = np.array([1.0] * 3 + [closure.size] * 3)
    moves = closure.pose_jacobian(placement) @ free
    undriven = _null_space(drives)
    loose = _row_space((tool @ undriven).T)
    unmoved = _null_space(moves)
    barred = _null_space(moves.T)
    names = (joint.name for joint in closure.mechanism.joints if joint.drive is not None)
    return Mobility(
        mobility=free.shape[1],
        constraints=len(jacobian),
        redundant=len(jacobian) - rank,
        almost_redundant=int(np.count_nonzero((values > _NOTHING) & (values < _ALMOST))),
        idle=undriven.shape[1] - len(loose),
        moves=len(moves),
        loose=loose / unit,
        unprescribed=_row_space((tool @ unmoved).T) / unit,
        stirring=_touched(names, drives @ unmoved),
        barred=_touched((MOVES[move] for move in closure.moves), barred),
    )


def _touched(names: Iterable[str], shares: Array) -> tuple[str, ...]:
    """The names whose row of `shares` is not zero."""
    largest = np.abs(shares).max(axis=1, initial=0.0)
    return tuple(name for name, most in zip(names, largest, strict=True) if most > _NOTHING)


def undetermined(found: Mobility, size: float, *, singular: bool = False) -> str:
    """What the drives leave to the tool, or its moves to the mechanism, in words; "" if nothing.

    `size` (m) is the scale of the mechanism. `singular`: motions of a posture `at_limit` count.
    """
    if len(found.loose):
        motions = name_twists(found.loose, size)
        return (
            f"with all drives held the tool is free to {motions}; "
            "drives must hold every motion of the tool"
        )
    if not found.moves or not (found.spare > 0 or (singular and found.at_limit)):
        return ""
    left = (
        f"the tool is free to {name_twists(found.unprescribed, size)}"
        if len(found.unprescribed)
        else f"drives {', '.join(found.stirring)} are free to move"
    )
    return f"with these held {left}; must prescribe every free motion"


def _null_space(matrix: Array) -> Array:
    """Orthonormal basis (columns) of the null space."""
    _, values, right = svd(matrix, check_finite=False)
    basis: Array = right[np.count_nonzero(values > _NOTHING) :].T
    return basis


def _row_space(matrix: Array) -> Array:
    """Orthonormal basis (rows) of the row space."""
    _, values, right = svd(matrix, check_finite=False)
    basis: Array = right[: np.count_nonzero(values > _NOTHING)]
    return basis
