"""Mobility and idle motions of a posture, from the null space of its constraints.

J is the derivative of the joint constraints with respect to small displacements of the bodies, and
N is a basis of its null space. The matrices D, T and M map small displacements to the motions of
the drives, the twist of the tool and the pose of the tool. A motion x in the span of N with D x = 0
is possible with locked drives. It is idle if T x = 0, too. If T x is not zero, the drives do not
determine the motion of the tool.
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

# Singular values of dimensionless matrices below this count as zero. Geometry is typed with six
# digits or more.
_ZERO = 1e-6
# A singular value below this shows that a constraint repeats others, apart from the inaccuracy of
# directions typed with three digits.
_ALMOST = 3e-3
# Distance of a nearby posture, as a fraction of the size, and number of Newton steps to close it.
_NEIGHBOUR_DISTANCE = 0.02
_ITERATIONS = 8


@dataclass(frozen=True, eq=False)
class Mobility:
    """Mobility of a mechanism in one posture.

    `mobility` is the number of independent motions of the whole mechanism. `constraints` is the
    number of joint constraints. Of these, `redundant` is the number that do not reduce the mobility
    (overconstraint), and `almost_redundant` the number that reduce it only because of the last
    digits of the geometry. `idle` is the number of motions that move neither the tool nor a drive.
    `moves` is the number of coordinates of the tool that a pose prescribes.

    The following twists are those of the loaded point (base axes, m and rad).
    `uncontrolled_twists` (k×6) span the motions of the tool with locked drives.
    `unprescribed_twists` (k×6) span its motions at constant pose. `barred` names the coordinates of
    the tool that take part in prescribed motions which the joints do not allow. `stirring` names
    the joints whose drives can move at constant pose. Neither is empty if legs are stretched or
    folded (`at_limit`).
    """

    mobility: int
    constraints: int
    redundant: int
    almost_redundant: int
    idle: int
    moves: int
    uncontrolled_twists: Array
    unprescribed_twists: Array
    stirring: tuple[str, ...]
    barred: tuple[str, ...]

    @property
    def excess_mobility(self) -> int:
        """Number of motions that are neither idle nor prescribed by the moves of the tool."""
        return self.mobility - self.idle - self.moves

    @property
    def at_limit(self) -> bool:
        """True at the boundary of the workspace (type 1 singularity)."""
        return self.excess_mobility == 0 and bool(self.stirring)


@memo(256)
def mobility(posture: Posture) -> Mobility:
    """Mobility, idle motions, overconstraint and singularities of a posture."""
    closure = closure_of(posture.mechanism)
    placement = closure.placement(posture)
    return mobility_at(closure, placement)


def generic_mobility(mechanism: Mechanism) -> Mobility:
    """Mobility in a posture near the reference posture.

    The posture is reached by a small displacement in which all free motions take part. A
    singularity of the reference posture itself therefore does not affect the result.
    """
    closure = closure_of(mechanism)
    placement = closure.reference
    free = null_space(closure.jacobian(placement))
    step = _NEIGHBOUR_DISTANCE * closure.size * free @ np.linspace(1.0, 2.0, free.shape[1])
    for _ in range(_ITERATIONS):
        placement = closure.displaced(placement, step)
        step = -lstsq(closure.jacobian(placement), closure.residual(placement), cond=_ZERO)[0]
    return mobility_at(closure, placement)


def mobility_at(closure: Closure, placement: Placement) -> Mobility:
    """Mobility of a mechanism with closed joints and the given positions of its bodies."""
    jacobian = closure.jacobian(placement)
    _, values, right = svd(jacobian, check_finite=False)
    rank = int(np.count_nonzero(values > _ZERO))
    free_motions = right[rank:].T
    drives = closure.drives(placement) @ free_motions
    tool = closure.tool_twists(placement) @ free_motions
    unit = np.array([1.0] * 3 + [closure.size] * 3)
    moves = closure.pose_jacobian(placement) @ free_motions
    undriven = null_space(drives)
    uncontrolled_twists = row_space((tool @ undriven).T)
    constant_pose = null_space(moves)
    barred = null_space(moves.T)
    names = (joint.name for joint in closure.mechanism.joints if joint.drive is not None)
    return Mobility(
        mobility=free_motions.shape[1],
        constraints=len(jacobian),
        redundant=len(jacobian) - rank,
        almost_redundant=int(np.count_nonzero((values > _ZERO) & (values < _ALMOST))),
        idle=undriven.shape[1] - len(uncontrolled_twists),
        moves=len(moves),
        uncontrolled_twists=uncontrolled_twists / unit,
        unprescribed_twists=row_space((tool @ constant_pose).T) / unit,
        stirring=_touched(names, drives @ constant_pose),
        barred=_touched((MOVES[move] for move in closure.moves), barred),
    )


def _touched(names: Iterable[str], shares: Array) -> tuple[str, ...]:
    """Names, out of n `names`, whose row in `shares` (n×k) is not zero."""
    largest = np.abs(shares).max(axis=1, initial=0.0)
    return tuple(
        name for name, row_maximum in zip(names, largest, strict=True) if row_maximum > _ZERO
    )


def indeterminacy(result: Mobility, size: float, *, singular: bool = False) -> str:
    """Description of motions that neither the drives nor the moves of the tool determine.

    "" if there are none. `size` (m) is the size of the mechanism. If `singular` is True, motions of
    drives at the boundary of the workspace are described, too.
    """
    if len(result.uncontrolled_twists):
        motions = name_twists(result.uncontrolled_twists, size)
        return (
            f"with all drives locked the tool is free to {motions}; "
            "drives must prevent every motion of the tool"
        )
    if not result.moves or not (result.excess_mobility > 0 or (singular and result.at_limit)):
        return ""
    free_motions = (
        f"the tool is free to {name_twists(result.unprescribed_twists, size)}"
        if len(result.unprescribed_twists)
        else f"drives {', '.join(result.stirring)} are free to move"
    )
    return f"with these moves fixed {free_motions}; must prescribe every free motion"


def null_space(matrix: Array) -> Array:
    """Orthonormal basis (columns) of the null space of `matrix`."""
    _, values, right = svd(matrix, check_finite=False)
    basis: Array = right[np.count_nonzero(values > _ZERO) :].T
    return basis


def row_space(matrix: Array) -> Array:
    """Orthonormal basis (rows) of the row space of `matrix`."""
    _, values, right = svd(matrix, check_finite=False)
    basis: Array = right[: np.count_nonzero(values > _ZERO)]
    return basis
