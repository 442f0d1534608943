"""Geometric stiffness of a loaded mechanism, its buckling factors and remaining stiffness.

Forces and moments do work on displacements of second order in the unknowns. The stiffness under λ
times the load is therefore K + λ G with the geometric stiffness G. Rotations are described by
rotation vectors θ. The second-order terms are the following:

- The point of application of a force, at an arm r from its node, has the additional displacement
  ½ θ × (θ × r).
- The second side of a joint with the relative displacement d and the relative rotation ψ has the
  additional displacement θ₁ × d and rotation ½ θ₁ × ψ relative to the first side, which rotates by
  θ₁.
- Each body contributes the geometric stiffness of its model.

In a rotation of the whole robot the terms of joints and bodies cancel, and only those of the loads
and of the joints at the ground remain. The load keeps its direction and its point of application,
and G is computed for the undeformed mechanism in its posture.

Idle motions are locked, as by friction. They have no strain energy, so that the load alone would
determine their rest position, and any amount of an idle motion could be added to a deformation. G
is therefore computed for motions from which the idle part is removed. The result does not depend on
the choice of base axes. Where the load would accelerate an idle motion, it is balanced by the
inertia of the bodies, and the joints transmit the forces that this requires.

With K = L Lᵀ, K + λ G is singular if −1/λ is an eigenvalue of L⁻¹ G L⁻ᵀ. The smallest and the
largest eigenvalue of this dense matrix are computed directly, so that no lower buckling factor is
missed.
"""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from scipy.linalg import eigh, solve_triangular

from lumped.arrays import Array, dense
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.joint import Joint
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import GROUND
from lumped.screws import shift, skew
from lumped.system.assembly import System
from lumped.system.loads import tool_displacements
from lumped.system.reactions import internal_forces
from lumped.system.solution import (
    Solved,
    compliance,
    factorised,
    modes_with_mass,
    strain_shares,
)

# Relative singular value below which conditions count as dependent. Loops are closed to 1e-12.
_DEPENDENT = 1e-9
# Buckling factor above which buckling counts as impossible.
_LARGEST_FACTOR = 1e6


@dataclass(frozen=True, eq=False)
class Stability:
    """Behaviour of a mechanism under one of its loads, linearised about its posture.

    It buckles at `factor` times the load, and at `reversed` times the load, a negative number for a
    load in the opposite direction. Each is None if its magnitude would exceed a million. `shares`
    are the fractions of the strain energy of the buckling mode at `factor`, by body or joint, the
    largest first. It is empty if `factor` is None.

    `stiffness_losses` (6) are the relative reductions of the tool's stiffness along and about each
    base axis due to the load, negative if the stiffness increases. `extra_displacement` is the
    relative increase of the tool's displacement over that without geometric stiffness, negative if
    it decreases. `frequencies` (Hz) are natural frequencies under the load. If the mechanism
    buckles below the load, `stiffness_losses` and `extra_displacement` are NaN and `frequencies` is
    empty.
    """

    factor: float | None
    reversed: float | None
    shares: dict[str, float]
    stiffness_losses: Array = field(default_factory=lambda: np.full(6, np.nan))
    extra_displacement: float = np.nan
    frequencies: Array = field(default_factory=lambda: np.zeros(0))


def stability(solution: Solved, geometric: Array, load: Loading, count: int = 0) -> Stability:
    """Stability and `count` natural frequencies under a load with `geometric` stiffness (n×n).

    Raises ComputationError if round-off dominates the compliance.
    """
    factors, shape = _buckling(solution, geometric)
    loaded = _under_load(solution, geometric)
    shares: dict[str, float] = defaultdict(float)
    if factors[0] is not None:
        for part, share in strain_shares(solution.system, shape[:, None]).items():
            shares[part.of] += float(share[0])
    result = Stability(*factors, dict(sorted(shares.items(), key=lambda entry: -entry[1])))
    if loaded is None:
        return result
    before, after = (np.diag(compliance(entry)) for entry in (solution, loaded))
    linear, nonlinear = (tool_displacements(entry, [load])[0, :3] for entry in (solution, loaded))
    size, increase = float(np.linalg.norm(linear)), nonlinear - linear
    extra = float(np.copysign(np.linalg.norm(increase), increase @ linear)) / size if size else 0.0
    return replace(
        result,
        stiffness_losses=1.0 - np.divide(before, after, out=np.ones(6), where=before > 0.0),
        extra_displacement=extra,
        frequencies=modes_with_mass(loaded, count).frequencies,
    )


def _buckling(
    solution: Solved, geometric: Array
) -> tuple[tuple[float | None, float | None], Array]:
    """Buckling factors closest to zero, one positive and one negative, and a mode shape (n).

    The mode shape is that of the positive factor. A factor is None if its magnitude would exceed a
    million. Both are None for a mechanism without elastic parts.
    """
    if not len(solution.retained):
        return (None, None), np.zeros(solution.system.size)
    scaled_geometric = (
        solution.scale[:, None] * geometric[np.ix_(solution.retained, solution.retained)]
    )
    half_product = solve_triangular(solution.lower, scaled_geometric * solution.scale, lower=True)
    standard = solve_triangular(solution.lower, half_product.T, lower=True)
    last = len(standard) - 1
    (low, vector), (high, _) = (
        eigh(0.5 * (standard + standard.T), subset_by_index=[k, k], driver="evr") for k in (0, last)
    )
    shape = np.zeros(solution.system.size)
    retained_shape = solve_triangular(solution.lower, vector[:, 0], trans="T", lower=True)
    shape[solution.retained] = solution.scale * retained_shape
    reverse = _factor(high[0])
    return (_factor(-low[0]), None if reverse is None else -reverse), shape


def _factor(inverse: float) -> float | None:
    return float(1.0 / inverse) if inverse * _LARGEST_FACTOR > 1.0 else None


def _under_load(solution: Solved, geometric: Array) -> Solved | None:
    """System with the stiffness K + G, factorised, for G = `geometric` (n×n).

    None if the mechanism has buckled: K + G is then not positive definite.
    """
    system = solution.system
    stiffness = dense(system.stiffness) + geometric
    factor = factorised(stiffness[np.ix_(solution.retained, solution.retained)])
    if factor is None:
        return None
    loaded = replace(system, stiffness=stiffness, mass=dense(system.mass))
    return replace(solution, system=loaded, lower=factor[0], scale=factor[1])


class Prestressed(Protocol):
    """Function that computes the geometric stiffness of a body for the unknowns of its model."""

    def __call__(self, ends: Array, distributed: Array, *, spins: bool) -> Array:
        """Geometric stiffness (r×r, SI, body axes) for the r unknowns of the body's model.

        `ends` (6m, body axes) are the forces on the m interfaces that the stiffness of the body
        balances. `distributed` (6m) is the part of `ends` that represents loads along the length of
        the body. `spins` is True if the body has an idle motion about its x axis.
        """
        ...


def geometric_stiffness(
    solution: Solved, load: Loading, bodies: Mapping[str, Prestressed]
) -> Array:
    """Geometric stiffness (n×n) of a system under a load.

    `bodies` contains functions for the geometric stiffness of deformable bodies, by name. A
    deformable body without a function is treated as a body that rotates by the mean rotation of its
    interfaces. Idle motions have no geometric stiffness.
    """
    system = solution.system
    forces = internal_forces(solution, load)
    total = np.zeros((system.size, system.size))
    outer = total[: system.outer, : system.outer]
    for name, body_forces in forces.bodies.items():
        inside, ends = system.inside[name], system.ends[name]
        count = len(ends)
        if name not in bodies:
            interfaces = system.posture.mechanism.bodies[name].interfaces.values()
            positions = np.array([interface.position for interface in interfaces])
            outer += _rotating_body(ends, positions, body_forces.elastic)
            continue
        spins = _spins(ends @ solution.motions[: system.outer])
        body_stiffness = bodies[name](body_forces.elastic, body_forces.distributed, spins=spins)
        outer += ends.T @ body_stiffness[:count, :count] @ ends
        total[: system.outer, inside] += ends.T @ body_stiffness[:count, count:]
        total[inside, inside] += body_stiffness[count:, count:]
    for applied in load.wrenches:
        node = system.motions.structure.node(applied.body, applied.point)
        if applied.body != GROUND:
            outer += _at_arm(system, node, applied.position, applied.wrench)
    for transmitted in forces.joints:
        outer += _joint_stiffness(system, transmitted.joint, transmitted.wrench)
    total[system.outer :, : system.outer] = total[: system.outer, system.outer :].T
    return _without_idle_parts(solution, 0.5 * (total + total.T))


def _spins(idle: Array) -> bool:
    """True if a combination of idle motions is a rotation of a leg about its x axis.

    `idle` (12×k, leg axes) contains the twists of both ends of the leg in k idle motions.
    """
    spin = np.zeros(12)
    spin[[3, 9]] = 1.0
    return bool(np.linalg.norm(spin - idle @ np.linalg.lstsq(idle, spin)[0]) < _DEPENDENT)


def _without_idle_parts(solution: Solved, geometric: Array) -> Array:
    """Geometric stiffness PᵀGP (n×n), in which the matrix P removes the idle parts of motions.

    G is `geometric` (n×n). The idle part of a motion is fitted by least squares to the twists of
    all nodes.
    """
    if not solution.idle:
        return geometric
    motions, outer = solution.system.motions, solution.system.outer
    unit = np.array([1.0 / motions.structure.length] * 3 + [1.0] * 3)
    twists = (unit[:, None] * motions.twists).reshape(-1, outer)
    idle = solution.motions
    part = np.linalg.lstsq(twists @ idle[:outer], twists)[0]
    projection = np.eye(len(idle))
    projection[:, :outer] -= idle @ part
    return np.asarray(projection.T @ geometric @ projection)


def _arm_hessian(force: Array, arm: Array) -> Array:
    """Hessian (3×3) of the energy −½ f·(θ × (θ × r)) with respect to the rotation θ.

    f is `force` (3, in N), r is `arm` (3, in m).
    """
    product = np.outer(force, arm)
    return np.asarray(float(force @ arm) * np.eye(3) - 0.5 * (product + product.T))


def _at_arm(system: System, node: int, position: Array, wrench: Array) -> Array:
    rotation = system.motions.twists[node, 3:]
    arm = position - system.motions.places[node]
    return np.asarray(rotation.T @ _arm_hessian(wrench[:3], arm) @ rotation)


def _rotating_body(ends: Array, positions: Array, forces: Array) -> Array:
    """Geometric stiffness (n×n) of a body under `forces` (6k) on its k interfaces.

    `positions` (k×3, in m) are the positions of the interfaces. `ends` (6k×n) maps the n unknowns
    of the nodes to their twists. All are in body axes. The body rotates by θ, the mean rotation of
    its interfaces. Relative to axes that rotate with it, an interface at r with displacement u and
    rotation θᵢ has the second-order displacement −θ × u + ½ θ × (θ × r) and rotation −½ θ × θᵢ.
    """
    arms = positions - positions.mean(axis=0)
    size = float(np.abs(arms).max(initial=0.0)) or 1.0
    unit = np.tile([1.0 / size] * 3 + [1.0] * 3, len(arms))
    rigid = np.vstack([shift(arm) for arm in arms])
    mean = np.linalg.pinv(unit[:, None] * rigid) @ (unit[:, None] * ends)
    mean_rotation = mean[3:]
    total = np.zeros((ends.shape[1],) * 2)
    for arm, twist, wrench in zip(
        arms, ends.reshape(len(arms), 6, -1), forces.reshape(-1, 6), strict=True
    ):
        half_hessian = mean_rotation.T @ (
            skew(wrench[:3]) @ twist[:3] + 0.5 * skew(wrench[3:]) @ twist[3:]
        )
        total += (
            half_hessian
            + half_hessian.T
            - mean_rotation.T @ _arm_hessian(wrench[:3], arm) @ mean_rotation
        )
    return total


def _joint_stiffness(system: System, joint: Joint, wrench: Array) -> Array:
    """Geometric stiffness (n×n) of a joint for the n unknowns of the nodes.

    `wrench` (6, base axes) is that of the joint on its second body, at its first interface.
    """
    motions, position = system.motions, interface_position(system.posture, joint.first)
    first, second = (
        motions.at(side.body, side.point, position) for side in (joint.first, joint.second)
    )
    force, moment = wrench[:3], wrench[3:]
    half_hessian = (second - first)[:3].T @ skew(force) @ first[3:]
    half_hessian += 0.5 * second[3:].T @ skew(moment) @ first[3:]
    if joint.kind == "universal":
        axes = free_twists(system.posture, joint)[3:]
        angles = np.linalg.pinv(axes) @ (second - first)[3:]
        half_hessian += 0.5 * float(moment @ np.cross(*axes.T)) * np.outer(angles[0], angles[1])
    total = half_hessian + half_hessian.T
    for side, sign in ((joint.first, -1.0), (joint.second, 1.0)):
        if side.body != GROUND:
            node = motions.structure.node(side.body, side.point)
            total += _at_arm(system, node, position, sign * wrench)
    return np.asarray(total)
