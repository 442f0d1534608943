"""The virtual joint method on parallel robots (eqs 3 to 9).

Every chain's bordered system is solved as it stands, so that overconstrained robots and singular
postures need no special treatment; the chains' stiffness matrices are summed at the platform.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve

from lumped.arrays import Array
from lumped.dense.statics import rounding_of_flexibility
from lumped.errors import ComputationError
from lumped.screws import move_compliance, name_twists, name_wrenches, shift

# All thresholds act on matrices without units. Rounding of a 6×6 problem is about 1e-15; a robot
# whose stiffest and softest directions are 1e12 apart is outside double precision anyway.
_DEPENDENT = 1e-12
_RIGID = 1e-13
_FREE = 1e-12


class RigidChainError(ComputationError):
    """A chain that yields to some load in nothing: it has no stiffness."""


@dataclass(frozen=True, eq=False)
class Chain:
    """What yields between the base and the end of a serial chain, at its end in base axes (SI).

    `passive` Jq (6×q) holds the twists of the passive joints, `compliance` Sθ = Jθ Kθ⁻¹ Jθᵀ of
    eq. (3) what all springs yield (6×6); `reach` (m) is the largest distance of either from the
    end.
    """

    passive: Array
    compliance: Array
    reach: float


def serial_chain(
    end: Array, joints: Sequence[tuple[Array, Array]], springs: Sequence[tuple[Array, Array]]
) -> Chain:
    """The chain that ends at `end` (3, m) in the posture at hand, all in base axes (SI).

    `joints`: place (3, m) and twist of a unit rate (6) of every passive one-freedom joint;
    `springs`: place and compliance (6×6, positive, may be singular) of every virtual spring.
    """
    screws = [shift(end - place) @ twist for place, twist in joints]
    compliance = np.zeros((6, 6))
    for place, own in springs:
        compliance += move_compliance(own, end - place)
    distances = [float(np.linalg.norm(end - place)) for place, _ in (*joints, *springs)]
    return Chain(np.reshape(screws, (-1, 6)).T, compliance, max(distances, default=0.0))


def chain_stiffness(chain: Chain, name: str = "chain") -> Array:
    """6×6 stiffness (SI, base axes) of one chain at its end point, eqs (3) and (8).

    The block of the bordered matrix's inverse that belongs to Sθ. K is symmetric, has no negative
    eigenvalue, and K·Jq = 0. Where columns of Jq depend on each other (singular posture) δq is not
    unique but K is: Jq is replaced by an orthonormal basis of its columns. Raises
    ComputationError, naming the direction, where neither a spring nor a passive joint yields.
    """
    return _bordered_solution(chain, name).stiffness


@dataclass(frozen=True, eq=False)
class _Bordered:
    """A chain's stiffness K (6×6, SI) and X, from which it errs: δK = −Xᵀ δB X.

    B is the bordered matrix (6+q square), without units; X ((6+q)×6) its solution for the end
    point's twists in SI units. Without units are a twist times `unit` (6), and a compliance over
    `largest`.
    """

    stiffness: Array
    matrix: Array
    solution: Array
    unit: Array
    largest: float


def _bordered_solution(chain: Chain, name: str) -> _Bordered:
    S = chain.compliance
    length = _characteristic_length(chain.reach, S)
    # Lengths in units of the chain, compliance in units of the largest: the system has no units.
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
            "passive joint yields to it, so its stiffness is infinite"
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


def carried(chain: Chain, slip: Array, work: Array, name: str = "chain") -> Array:
    """Wrench (6, SI, base axes) that loads along a chain put on its end, which is held.

    `slip` (6) is by how much they would move the free end through the springs, `work` (q) what they
    do on a unit rate of each passive joint.
    """
    found = _bordered_solution(chain, name)
    free = found.matrix[:6, 6:]
    # Where passive joints depend on each other, the loads do no work on what they have twice.
    rates = free.T @ (chain.passive * found.unit[:, None])
    forces = found.largest * np.linalg.lstsq(rates.T, work, rcond=_DEPENDENT)[0]
    along = np.concatenate([slip * found.unit, forces])
    return np.asarray(found.solution.T @ along / np.sqrt(found.largest))


def robot_stiffness(chains: Iterable[Chain]) -> Array:
    """Sum of the chains' stiffness (6×6, SI, base axes) at their common end point, eq. (9)."""
    total = np.zeros((6, 6))
    for number, chain in enumerate(chains, start=1):
        total += chain_stiffness(chain, f"chain {number}")
    return total


def platform_compliance(stiffness: Array, name: str = "platform") -> Array:
    """6×6 compliance (SI) of a platform of the given stiffness, at the same point and axes.

    Raises ComputationError naming every motion in which the platform is left free, or held by a
    negative stiffness; the decision does not depend on units.
    """
    K = 0.5 * (stiffness + stiffness.T)
    translation, rotation = np.trace(K[:3, :3]), np.trace(K[3:, 3:])
    length = np.sqrt(rotation / translation) if translation > 0.0 and rotation > 0.0 else 1.0
    unit = np.array([length] * 3 + [1.0] * 3)
    values, vectors = np.linalg.eigh(K * unit[:, None] * unit)
    if (free := values <= _FREE * np.abs(values).max()).any():
        motions = name_twists(vectors[:, free].T * unit, length)
        raise ComputationError(
            f"{name} is free to {motions}: its stiffness there is zero, negative or below "
            f"{_FREE:g} of the largest"
        )
    # Cholesky keeps the digits of a graded matrix that an eigenvalue decomposition loses.
    inverse: Array = cho_solve(cho_factor(K * unit[:, None] * unit), np.eye(6))
    flexibility: Array = 0.5 * (inverse + inverse.T) * unit[:, None] * unit
    return flexibility


def rounding(chains: Iterable[Chain]) -> Array:
    """What rounding leaves open of the compliance (6×6, SI) that chains give together.

    95 %, of both signs. A chain's bordered matrix B is rounded as a turned stiffness is
    (`rounding_of_flexibility`): digits of L/EA are lost beside L³/3EI. C follows by
    (XC)ᵀ δB (XC), and by the rounding of the chains' sum.
    """
    solved = [_bordered_solution(chain, "chain") for chain in chains]
    flexibility = platform_compliance(sum((one.stiffness for one in solved), np.zeros((6, 6))))
    squares = np.zeros((6, 6))
    for one in solved:
        moved = one.solution @ flexibility
        squares += rounding_of_flexibility(one.matrix, moved, turned=6) ** 2
        squares += rounding_of_flexibility(one.stiffness, flexibility, turned=6) ** 2
    return np.asarray(np.sqrt(squares))


def _column_space(matrix: Array) -> Array:
    """Orthonormal basis (6×r) of the columns, each taken at unit size."""
    sizes = np.linalg.norm(matrix, axis=0)
    left, values, _ = np.linalg.svd(matrix / sizes, full_matrices=False)
    return left[:, values > _DEPENDENT]


def _characteristic_length(reach: float, S: Array) -> float:
    """Length (m) that makes rotations and translations comparable: the chain's, or its springs'."""
    translation, rotation = np.trace(S[:3, :3]), np.trace(S[3:, 3:])
    of_springs = np.sqrt(translation / rotation) if translation > 0.0 and rotation > 0.0 else 0.0
    return max(reach, float(of_springs)) or 1.0
