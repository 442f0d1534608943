"""The virtual joint method on parallel robots (eqs 3, 8 and 9) and on the biglide (Fig. 4).

Every chain's bordered system is solved as it stands, so that overconstrained robots and singular
postures need no special treatment; the chains' stiffness matrices are summed at the platform.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.dense.balance import rounding_of_flexibility
from lumped.errors import ComputationError
from lumped.legs import EquivalentBy, Theory, equivalent_leg, given_compliance, tip_compliance
from lumped.models.chains import Chain, ChainJoint, Element, Fixed, VirtualSpring, chain_jacobians
from lumped.screws import name_twists, name_wrenches

# All thresholds act on matrices without units. Rounding of a 6×6 problem is about 1e-15; a robot
# whose stiffest and softest directions are 1e12 apart is outside double precision anyway.
_DEPENDENT = 1e-12
_RIGID = 1e-13
_FREE = 1e-12
_X, _Y, _Z = np.eye(3)


def chain_stiffness(chain: Sequence[Element], name: str = "chain") -> Array:
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
    point's twists in SI units.
    """

    stiffness: Array
    matrix: Array
    solution: Array


def _bordered_solution(chain: Sequence[Element], name: str) -> _Bordered:
    jacobians = chain_jacobians(chain)
    S, Jq = jacobians.spring_compliance, jacobians.passive
    length = _characteristic_length(jacobians.reach, S)
    # Lengths in units of the chain, compliance in units of the largest: the system has no units.
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    S = S * unit[:, None] * unit
    largest = float(np.abs(S).max()) or 1.0
    free = _column_space(Jq * unit[:, None])
    count = free.shape[1]
    bordered = np.block([[S / largest, free], [free.T, np.zeros((count, count))]])
    values, vectors = np.linalg.eigh(bordered)
    if (rigid := np.abs(values) <= _RIGID).any():
        wrenches = vectors[:6, rigid].T * unit
        raise ComputationError(
            f"{name} is rigid against {name_wrenches(wrenches, length)}: neither a spring nor a "
            "passive joint yields to it, so its stiffness is infinite"
        )
    X = solve(bordered, np.eye(6 + count, 6), assume_a="sym")
    K = X[:6]
    return _Bordered(
        stiffness=0.5 * (K + K.T) * unit[:, None] * unit / largest,
        matrix=bordered,
        solution=X * unit / np.sqrt(largest),
    )


def robot_stiffness(chains: Iterable[Chain]) -> Array:
    """Sum of the chains' stiffness (6×6, SI, base axes) at their common end point, eq. (9)."""
    total = np.zeros((6, 6))
    for number, chain in enumerate(chains, start=1):
        total += chain_stiffness(chain, f"chain {number}")
    return total


def platform_compliance(stiffness: Array, name: str = "platform") -> Array:
    """6×6 compliance (SI) of a platform of the given stiffness, at the same point and axes.

    Raises ComputationError naming every motion in which the platform is left free, or a
    negative stiffness; the decision does not depend on units.
    """
    K = 0.5 * (stiffness + stiffness.T)
    translation, rotation = np.trace(K[:3, :3]), np.trace(K[3:, 3:])
    length = np.sqrt(rotation / translation) if translation > 0.0 and rotation > 0.0 else 1.0
    unit = np.array([length] * 3 + [1.0] * 3)
    values, vectors = np.linalg.eigh(K * unit[:, None] * unit)
    largest = float(np.abs(values).max())
    if values[0] < -_FREE * largest:
        raise ComputationError(
            f"{name}: the stiffness has a negative eigenvalue; a spring of the robot is not elastic"
        )
    if (free := values <= _FREE * largest).any():
        motions = name_twists(vectors[:, free].T * unit, length)
        raise ComputationError(
            f"{name} is free to {motions}: no chain holds it, or none by {_FREE:g} of what holds "
            "the platform elsewhere"
        )
    # Cholesky keeps the digits of a graded matrix that an eigenvalue decomposition loses.
    inverse: Array = cho_solve(cho_factor(K * unit[:, None] * unit), np.eye(6))
    flexibility: Array = 0.5 * (inverse + inverse.T) * unit[:, None] * unit
    return flexibility


def biglide_chains(
    robot: Biglide, x: float, leg_springs: tuple[Array, Array]
) -> tuple[Chain, Chain]:
    """Both chains of the biglide with B at `x` (m), items (a) to (i) of §2.2, eq. (6).

    `leg_springs` are the 6×6 tip compliances (SI, leg axes) of leg 1 and leg 2. Both chains end
    at the loaded point in the axes of leg 1, which the platform is rigid with. Raises InputError
    outside the stroke or for a compliance that is none.
    """
    posture = robot.posture(x)
    spring1, spring2 = leg_springs
    angle1, angle2 = _angle(posture.rotation1), _angle(posture.rotation2)
    tool = Fixed(translation=posture.rotation1.T @ robot.tool_offset)
    end_of_leg2 = ChainJoint("revolute", _Z, coordinate=angle1 - angle2)
    slide1, slide2 = float(posture.root1[1]), float(posture.root2[1])
    base2 = Fixed(translation=np.array([robot.a, 0.0, 0.0]))
    return (
        (
            *_slide_and_foot(robot, Fixed(), slide1, "foot of leg 1"),
            *_leg(robot.leg1.length, angle1, spring1, "spring of leg 1"),
            tool,
        ),
        (
            *_slide_and_foot(robot, base2, slide2, "foot of leg 2"),
            *_leg(robot.leg2.length, angle2, spring2, "spring of leg 2"),
            end_of_leg2,
            tool,
        ),
    )


def compliance(robot: Biglide, x: float, leg_springs: tuple[Array, Array]) -> Array:
    """6×6 compliance (SI, robot axes) at the loaded point with B at `x` (m), eqs (3) to (9).

    `leg_springs` as in `biglide_chains`, from `given_leg_springs` or `equivalent_leg_springs`. A
    tool compliance lies in series with the platform. Raises InputError outside the stroke,
    ComputationError where the platform is free to move (legs aligned).
    """
    place = f"{robot.name}, virtual joints, x = {x:g} m: the platform"
    stiffness = robot_stiffness(biglide_chains(robot, x, leg_springs))
    platform = platform_compliance(stiffness, place)
    return platform if robot.tool_compliance is None else platform + robot.tool_compliance


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


def given_leg_springs(robot: Biglide) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI, leg axes) of both legs as the robot file describes them."""
    return given_compliance(robot.leg1), given_compliance(robot.leg2)


def equivalent_leg_springs(
    robot: Biglide, theory: Theory, by: EquivalentBy = "stiffness"
) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI, leg axes) of both legs' equivalent constant-section legs (§2.3)."""
    leg1, leg2 = (equivalent_leg(leg, by) for leg in (robot.leg1, robot.leg2))
    return (
        tip_compliance(leg1.properties(theory), leg1.length),
        tip_compliance(leg2.properties(theory), leg2.length),
    )


def _slide_and_foot(robot: Biglide, base: Fixed, slide: float, name: str) -> Chain:
    """Items (a) to (d). The foot's frame is at the revolute joint, in robot axes."""
    actuated = ChainJoint("prismatic", _Y, coordinate=slide, drive="actuated")
    if robot.foot_compliance is None:
        return base, actuated
    return base, actuated, VirtualSpring(robot.foot_compliance, name)


def _leg(length: float, angle: float, spring: Array, name: str) -> Chain:
    """Items (e) to (g): the joint at the root, the rigid leg, its spring at the tip."""
    root = ChainJoint("revolute", _Z, coordinate=angle)
    return root, Fixed(translation=length * _X), VirtualSpring(spring, name)


def _angle(rotation: Array) -> float:
    """Angle (rad) of a rotation about z."""
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


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
