"""The virtual joint method for parallel robots (eqs 3 to 9 of the paper).

The bordered system [Sθ Jq; Jqᵀ 0] of each chain, with the compliance Sθ of its springs and the
twists Jq of its passive joints, is solved directly. Overconstrained robots and singular postures
therefore need no special treatment. The stiffness matrices of the chains are added at the platform.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve

from lumped.arrays import Array
from lumped.dense.statics import rounding_of_flexibility
from lumped.errors import ComputationError
from lumped.screws import move_compliance, name_twists, name_wrenches, shift

# Thresholds for dimensionless matrices. The round-off of a 6×6 problem is about 1e-15. A ratio of
# 1e12 between the stiffest and the softest direction cannot be resolved in double precision.
_DEPENDENT = 1e-12
_RIGID = 1e-13
_FREE = 1e-12


class RigidChainError(ComputationError):
    """Error: a chain is rigid in some direction, so that its stiffness is infinite."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Passive twists and spring compliance of a serial chain at its end, base axes, SI.

    `passive` is Jq (6×q), whose columns are the twists of the passive joints. `compliance` is Sθ =
    Jθ Kθ⁻¹ Jθᵀ (6×6) of eq. (3), that of all springs. `reach` (m) is the largest distance of a
    joint or spring from the end.
    """

    passive: Array
    compliance: Array
    reach: float


def serial_chain(
    end: Array, joints: Sequence[tuple[Array, Array]], springs: Sequence[tuple[Array, Array]]
) -> Chain:
    """Chain with its end at `end` (3, in m). All data are in base axes and SI units.

    `joints` contains, for each passive motion of a joint, the position (3) of the joint and the
    twist (6) there for a unit rate. `springs` contains the position (3) and the compliance (6×6,
    positive semidefinite) of each virtual spring.
    """
    screws = [shift(end - position) @ twist for position, twist in joints]
    compliance = np.zeros((6, 6))
    for position, spring_compliance in springs:
        compliance += move_compliance(spring_compliance, end - position)
    distances = [float(np.linalg.norm(end - position)) for position, _ in (*joints, *springs)]
    return Chain(np.reshape(screws, (-1, 6)).T, compliance, max(distances, default=0.0))


def chain_stiffness(chain: Chain, name: str = "chain") -> Array:
    """6×6 stiffness (SI, base axes) of one chain at its end, eqs (3) and (8) of the paper.

    K is the first 6×6 block of the inverse of the bordered matrix [Sθ Jq; Jqᵀ 0]. It is symmetric
    and positive semidefinite, and K·Jq = 0. In a singular posture columns of Jq are dependent. The
    joint rates δq are then not unique but K is, and Jq is replaced by an orthonormal basis of its
    column space. Raises ComputationError, with the direction in its message, if neither a spring
    nor a passive joint yields in some direction.
    """
    return _bordered_solution(chain, name).stiffness


@dataclass(frozen=True, eq=False)
class _Bordered:
    """Stiffness K (6×6, SI) of a chain, with the data to bound its round-off δK = −Xᵀ δB X.

    `matrix` is B, the bordered matrix (6+q rows and columns) in dimensionless form. `solution` is X
    ((6+q)×6), the solution of the bordered system for unit twists (SI) of the end. The factors
    `unit` (6) make twists dimensionless. Compliances are divided by `largest`.
    """

    stiffness: Array
    matrix: Array
    solution: Array
    unit: Array
    largest: float


def _bordered_solution(chain: Chain, name: str) -> _Bordered:
    S = chain.compliance
    length = _characteristic_length(chain.reach, S)
    # Lengths divided by that of the chain and compliances divided by the largest are dimensionless.
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    S = S * unit[:, None] * unit
    largest = float(np.abs(S).max()) or 1.0
    free = _column_space(chain.passive * unit[:, None])
    count = free.shape[1]
    bordered = np.block([[S / largest, free], [free.T, np.zeros((count, count))]])
    values, vectors = np.linalg.eigh(bordered)
    if (rigid := np.abs(values) <= _RIGID).any():
        wrenches = vectors[:6, rigid].T * unit
        raise RigidChainError(
            f"{name} is rigid against {name_wrenches(wrenches, length)}: neither a spring nor a "
            "passive joint yields there, so that the stiffness is infinite"
        )
    X = solve(bordered, np.eye(6 + count, 6), assume_a="sym")
    K = X[:6]
    return _Bordered(
        stiffness=0.5 * (K + K.T) * unit[:, None] * unit / largest,
        matrix=bordered,
        solution=X * unit / np.sqrt(largest),
        unit=unit,
        largest=largest,
    )


def clamped_end_wrench(chain: Chain, slip: Array, work: Array, name: str = "chain") -> Array:
    """Wrench (6, SI, base axes) on the clamped end of a chain under loads along the chain.

    `slip` (6) is the displacement that the end would have if it were free, the passive joints were
    locked, and the springs deflected under the loads. `work` (q) is the work of the loads on a unit
    rate of each passive joint.
    """
    bordered = _bordered_solution(chain, name)
    free = bordered.matrix[:6, 6:]
    # If twists of passive joints are dependent, loads do no work on their redundant combinations.
    rates = free.T @ (chain.passive * bordered.unit[:, None])
    forces = bordered.largest * np.linalg.lstsq(rates.T, work, rcond=_DEPENDENT)[0]
    loads = np.concatenate([slip * bordered.unit, forces])
    return np.asarray(bordered.solution.T @ loads / np.sqrt(bordered.largest))


def robot_stiffness(chains: Iterable[Chain]) -> Array:
    """Sum of the stiffnesses (6×6, SI, base axes) of chains at their common end, eq. (9)."""
    total = np.zeros((6, 6))
    for number, chain in enumerate(chains, start=1):
        total += chain_stiffness(chain, f"chain {number}")
    return total


def platform_compliance(stiffness: Array, name: str = "platform") -> Array:
    """6×6 compliance (SI) of a platform from its 6×6 stiffness, at the same point and axes.

    Raises ComputationError if the platform is free to move or has a negative stiffness in some
    motion. Its message describes these motions. The result of this check does not depend on units.
    """
    K = 0.5 * (stiffness + stiffness.T)
    translation, rotation = np.trace(K[:3, :3]), np.trace(K[3:, 3:])
    length = np.sqrt(rotation / translation) if translation > 0.0 and rotation > 0.0 else 1.0
    unit = np.array([length] * 3 + [1.0] * 3)
    values, vectors = np.linalg.eigh(K * unit[:, None] * unit)
    if (free := values <= _FREE * np.abs(values).max()).any():
        motions = name_twists(vectors[:, free].T * unit, length)
        raise ComputationError(
            f"{name} is free to {motions}: the stiffness against this motion is zero, negative "
            f"or below {_FREE:g} of the largest one"
        )
    # Unlike an eigenvalue decomposition, Cholesky's method keeps the accuracy of a graded matrix.
    inverse: Array = cho_solve(cho_factor(K * unit[:, None] * unit), np.eye(6))
    flexibility: Array = 0.5 * (inverse + inverse.T) * unit[:, None] * unit
    return flexibility


def rounding(chains: Iterable[Chain]) -> Array:
    """Half-width (6×6, SI, 95 %) of the round-off error of the compliance C of parallel chains.

    The bordered matrix B of a chain has the round-off of a matrix in rotated axes
    (`rounding_of_flexibility`), in which digits of the small compliance L/EA of a leg are lost next
    to its large compliance L³/3EI. With the solution X of each chain (`_Bordered`), the error of C
    is (XC)ᵀ δB (XC), plus the round-off of the sum of the chains' stiffnesses.
    """
    solved = [_bordered_solution(chain, "chain") for chain in chains]
    flexibility = platform_compliance(
        sum((bordered.stiffness for bordered in solved), np.zeros((6, 6)))
    )
    squares = np.zeros((6, 6))
    for bordered in solved:
        deflections = bordered.solution @ flexibility
        squares += rounding_of_flexibility(bordered.matrix, deflections, rotated=6) ** 2
        squares += rounding_of_flexibility(bordered.stiffness, flexibility, rotated=6) ** 2
    return np.asarray(np.sqrt(squares))


def _column_space(matrix: Array) -> Array:
    """Orthonormal basis (6×r) of the column space of `matrix` (6×q).

    Columns are normalised first, so that their lengths do not affect the rank r.
    """
    sizes = np.linalg.norm(matrix, axis=0)
    left_vectors, values, _ = np.linalg.svd(matrix / sizes, full_matrices=False)
    return left_vectors[:, values > _DEPENDENT]


def _characteristic_length(reach: float, S: Array) -> float:
    """Length (m) that makes rotations comparable to translations.

    It is the larger of two lengths: the `reach` (m) of a chain, and √(tr S_tt / tr S_rr), with the
    blocks S_tt for translation and S_rr for rotation of the compliance `S` (6×6) of its springs.
    """
    translation, rotation = np.trace(S[:3, :3]), np.trace(S[3:, 3:])
    spring_length = np.sqrt(translation / rotation) if translation > 0.0 and rotation > 0.0 else 0.0
    return max(reach, float(spring_length)) or 1.0
