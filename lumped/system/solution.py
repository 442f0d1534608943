"""Compliance, natural modes and energies of a system, by dense matrices.

A system may have up to some thousand unknowns. One Cholesky factorisation K = L Lᵀ of the stiffness
is used for statics and modes. Motions without strain energy are free motions of the tool, which are
refused, and idle motions, which do not move the tool. A rod between two ball joints, for example,
can spin about its axis. Such a motion has no effect in statics and the frequency zero in dynamics.
Free and idle motions follow from kinematics alone, with rigid bodies and locked springs.

Idle motions N make K singular. They are locked by fixing as many unknowns, which does not affect
the compliance of the tool. The modes are those of the stiffness of the retained unknowns with the
mass matrix M − M N (NᵀMN)⁺ NᵀM, for which the idle motions follow the other motions freely.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh, qr
from scipy.linalg.blas import dtrsm

from lumped.arrays import Array, IntArray, dense, fix_signs, unit_diagonal
from lumped.dense.modes import Modes, too_few
from lumped.dense.statics import balanced_flexibility, rounding_of_flexibility
from lumped.errors import ComputationError
from lumped.screws import name_twists, shift
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion

# Smallest accepted pivot of the stiffness scaled to a unit diagonal. A chain of 160 elements has
# 3e-8. A singular matrix has pivots of about 1e-16 times the ratio of its stiffest entries to those
# of the free motion, due to round-off.
_SMALLEST_PIVOT = 1e-13
# Pivot or diagonal ratio below which the stiffness may be singular and is examined further.
DOUBTFUL = 1e-8
# Relative mass below which an idle motion counts as massless.
_MASSLESS = 1e-13
# Dimensionless strain below which a motion is free. Round-off is about 1e-14, loops are closed to
# 1e-12.
_FREE = 1e-9


@dataclass(frozen=True, eq=False)
class Solved:
    """A system with the Cholesky factor of its stiffness.

    `retained` are the indices of the unknowns that are not fixed to lock idle motions. `lower` is
    the lower triangular factor L of their stiffness, scaled by the factors `scale` to a unit
    diagonal. The columns of `motions` (n × number of idle motions) are the idle motions.
    """

    system: System
    lower: Array
    scale: Array
    retained: IntArray
    motions: Array

    @property
    def idle(self) -> int:
        """Number of idle motions: independent motions that move neither the tool nor a drive."""
        return int(self.motions.shape[1])

    def displacements(self, loads: Array) -> Array:
        """Values (n×m) of the unknowns under `loads` (n×m), with idle motions locked.

        The loads must do no work on idle motions.
        """
        unknowns = np.zeros_like(loads)
        scaled = self.scale[:, None] * loads[self.retained]
        unknowns[self.retained] = self.scale[:, None] * cho_solve((self.lower, True), scaled)
        return unknowns


def solved(system: System) -> Solved:
    """Factorise the stiffness of `system`.

    Raises ComputationError if the tool is free to move (the message describes the motion), or if a
    stiffness is negative.
    """
    stiffness = dense(system.stiffness)
    retained = np.arange(system.size)
    factor = factorised(stiffness)
    well_scaled = is_well_scaled(stiffness[: system.outer, : system.outer])
    if factor is not None and well_scaled and _smallest_pivot(factor) > DOUBTFUL:
        return Solved(system, *factor, retained, np.zeros((system.size, 0)))
    idle = idle_motions(system)
    if len(idle.pinned):
        retained = np.delete(retained, idle.pinned)
        factor = factorised(stiffness[np.ix_(retained, retained)])
    if factor is None or _smallest_pivot(factor) < _SMALLEST_PIVOT:
        raise ComputationError(
            f"{system.name}: the stiffness matrix is not positive definite; a stiffness is "
            "negative or differs from the others by more than rounding allows"
        )
    motions = np.vstack([idle.motions, _inner_motions(stiffness, system.outer, idle.motions)])
    return Solved(system, *factor, retained, motions)


def compliance(solution: Solved) -> Array:
    """6×6 compliance (SI, base axes) of the loaded point.

    Raises ComputationError if round-off dominates.
    """
    loads = solution.system.tool.T
    displacements = solution.displacements(loads)
    forces = solution.system.stiffness @ displacements
    return balanced_flexibility(loads, displacements, forces, solution.system.name)


def rounding(system: System, displacements: Array) -> Array:
    """Half-width (m×m, SI, 95 %) of the error of XᵀKX due to round-off of K.

    X is `displacements` (n×m). If they are those under unit loads at the tool, XᵀKX is the
    compliance of the tool. The squared errors of all bodies and of all springs of joints are added.
    The error of a body is proportional to the magnitudes of all unknowns that move it, even if
    their effects cancel. It is also proportional to the magnitude of all components that the
    rotation of the body mixes, because the angle is rounded, too (`rounding_of_flexibility`). The
    strain of a spring is a sum with one term for each unknown that moves it, and its error is
    proportional to the magnitudes of these terms.
    """
    squares = np.zeros((displacements.shape[1],) * 2)
    node_displacements = np.abs(displacements[: system.outer])
    for name, model in system.models.items():
        vectors = system.ends[name].reshape(-1, 3, system.outer)
        sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
        end_displacements = (
            np.where(vectors, sizes, 0.0).reshape(-1, system.outer) @ node_displacements
        )
        body_displacements = np.concatenate([end_displacements, displacements[system.inside[name]]])
        squares += rounding_of_flexibility(model.stiffness, body_displacements) ** 2
    for rows in system.motions.springs.values():
        terms = np.abs(rows) @ node_displacements
        squares += (2.0 * np.sqrt(2.0) * np.finfo(float).eps * terms.T @ terms) ** 2
    return np.asarray(np.sqrt(squares))


def modes(solution: Solved, count: int) -> Modes:
    """The lowest `count` natural modes (frequencies in Hz, shapes n×count), without idle motions.

    The shapes have unit modal mass. Raises ComputationError if fewer modes move mass.
    """
    result = modes_with_mass(solution, count)
    if not 0 < count == len(result.frequencies):
        raise too_few(solution.system.name, count)
    return result


def modes_with_mass(solution: Solved, count: int) -> Modes:
    """The lowest `count` modes that move mass, or all of them if there are fewer."""
    n = len(solution.retained)
    if not (solved_count := min(count, n)):
        return Modes(np.zeros(0), np.zeros((solution.system.size, 0)))
    standard, idle_following = _inverse_squares(solution)
    values, vectors = eigh(
        standard, subset_by_index=[n - solved_count, n - 1], driver="evr", check_finite=False
    )
    with_mass = values > np.finfo(float).eps * n * max(values[-1], 0.0)
    values, vectors = values[with_mass][::-1], vectors[:, with_mass][:, ::-1]
    elastic_shapes = dtrsm(1.0, solution.lower, vectors, lower=1, trans_a=1)
    elastic_shapes *= solution.scale[:, None] / np.sqrt(values)
    shapes = solution.motions @ (idle_following @ elastic_shapes)
    shapes[solution.retained] += elastic_shapes
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(values)), fix_signs(shapes))


def _inverse_squares(solution: Solved) -> tuple[Array, Array]:
    """Matrix whose eigenvalues are 1/ω² of the modes, and matrix of the idle motions that follow.

    The second matrix (number of idle motions × retained unknowns) maps the retained unknowns to the
    coefficients of the idle motions that follow them freely.
    """
    retained, scale = solution.retained, solution.scale
    full_mass = dense(solution.system.mass)
    mass, idle_following = (
        full_mass[np.ix_(retained, retained)],
        np.zeros((solution.idle, len(retained))),
    )
    if solution.idle:
        momenta, inverse_inertia = _idle_momenta(solution, full_mass)
        idle_following = -inverse_inertia @ momenta[retained].T
        mass = mass + momenta[retained] @ idle_following
    half_product = dtrsm(1.0, solution.lower, mass * scale[:, None] * scale, lower=1)
    return dtrsm(1.0, solution.lower, half_product, side=1, lower=1, trans_a=1), idle_following


def with_idle(solution: Solved, displacements: Array) -> Array:
    """Displacements (n×m) plus the idle motions that follow them freely.

    The sum u has no momentum in any of the idle motions N: NᵀMu = 0.
    """
    if not solution.idle:
        return displacements
    momenta, inverse_inertia = _idle_momenta(solution, dense(solution.system.mass))
    return np.asarray(
        displacements - solution.motions @ (inverse_inertia @ (momenta.T @ displacements))
    )


def without_idle(solution: Solved, loads: Array) -> Array:
    """Loads (n×m) minus the inertia forces of the idle motions that these loads accelerate."""
    if not solution.idle:
        return loads
    momenta, inverse_inertia = _idle_momenta(solution, dense(solution.system.mass))
    return np.asarray(loads - momenta @ (inverse_inertia @ (solution.motions.T @ loads)))


def idle_accelerations(solution: Solved, loads: Array) -> Array:
    """Accelerations (n×m, SI) of the unknowns in idle motions under `loads` (n×m)."""
    if not solution.idle:
        return np.zeros_like(loads)
    _, inverse_inertia = _idle_momenta(solution, dense(solution.system.mass))
    return np.asarray(solution.motions @ (inverse_inertia @ (solution.motions.T @ loads)))


def _idle_momenta(solution: Solved, mass: Array) -> tuple[Array, Array]:
    """Momenta M N (n×k) of the k idle motions N, and the pseudo-inverse (NᵀMN)⁺ (k×k).

    M is `mass` (n×n).
    """
    momenta = mass @ solution.motions
    heaviest = float(np.diag(mass)[: solution.system.outer].max())
    return momenta, _pseudo_inverse(solution.motions.T @ momenta, heaviest)


def strain_shares(system: System, shapes: Array) -> dict[Portion, Array]:
    """Fractions (m values) of the strain energy of each of m `shapes` (n×m), by portion.

    A portion belongs to a body or to a joint. The energy of a body is split by kind of deformation
    if its model supports this, and that of a joint into drive and compliance. The fractions of a
    shape add up to 1.
    """
    outer = shapes[: system.outer]
    energies = {
        part: np.square(rows @ outer).sum(axis=0) for part, rows in system.motions.springs.items()
    }
    for name, model in system.models.items():
        unknowns = system.body_unknowns(name, shapes)
        for kind, stiffness in (model.parts or {"": model.stiffness}).items():
            energies[Portion(name, kind)] = np.sum(unknowns * (stiffness @ unknowns), axis=0)
    total = sum(energies.values())
    return {part: energy / total for part, energy in energies.items()}


def is_well_scaled(stiffness: Array) -> bool:
    """True if no diagonal entry of `stiffness` (…×n×n) is negligible next to the largest one."""
    diagonal = np.diagonal(stiffness, axis1=-2, axis2=-1)
    largest = diagonal.max(axis=-1, keepdims=True, initial=0.0)
    return bool((diagonal > DOUBTFUL * largest).all())


def factorised(stiffness: Array) -> tuple[Array, Array] | None:
    """Cholesky factor of `stiffness` (n×n), scaled to a unit diagonal, and the scale factors (n).

    None if the matrix is not positive definite.
    """
    try:
        scale = unit_diagonal(stiffness)
        lower, _ = cho_factor(
            stiffness * scale[:, None] * scale, lower=True, overwrite_a=True, check_finite=False
        )
    except LinAlgError:
        return None
    return lower, scale


def _smallest_pivot(factor: tuple[Array, Array]) -> float:
    return float(np.diag(factor[0]).min(initial=1.0)) ** 2


def _inner_motions(stiffness: Array, outer: int, motions: Array) -> Array:
    """Motions (internal unknowns × k) of the inside of all bodies that follow their interfaces.

    `motions` (`outer`×k) are the motions of the first `outer` unknowns, which are those of the
    nodes. The inside of the bodies follows statically, with the given `stiffness` (n×n).
    """
    forces = stiffness[outer:, :outer] @ motions
    if not forces.any():
        return np.zeros_like(forces)
    inner_motions: Array = -cho_solve(cho_factor(stiffness[outer:, outer:]), forces)
    return inner_motions


def _pseudo_inverse(mass: Array, size: float) -> Array:
    """Pseudo-inverse (NᵀMN)⁺ of `mass`, the mass matrix NᵀMN (k×k) of k idle motions.

    Eigenvalues that are round-off relative to the mass `size` count as zero.
    """
    values, vectors = np.linalg.eigh(0.5 * (mass + mass.T))
    heavy = values > _MASSLESS * size
    inverse: Array = (vectors[:, heavy] / values[heavy]) @ vectors[:, heavy].T
    return inverse


@dataclass(frozen=True, eq=False)
class IdleMotions:
    """The k idle motions of a system.

    They are the columns of `motions` (unknowns of the nodes × k). If the k unknowns with the
    indices `pinned` are fixed, the idle motions are locked and no other motion is constrained.
    """

    motions: Array
    pinned: IntArray


def idle_motions(system: System) -> IdleMotions:
    """Idle motions of `system`: motions of rigid bodies with locked springs and drives.

    Raises ComputationError if one of these motions moves the tool. Its message describes the
    motion.
    """
    strains = [_relative(system, body) for body in system.ends]
    count = system.outer
    rows = np.vstack([system.motions.locks, *strains])
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    free = right[int(np.sum(values > _FREE)) :].T
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    tool_motions = unit[:, None] * (system.tool[:, :count] @ free)
    tool_directions, sizes, combinations = np.linalg.svd(tool_motions, full_matrices=True)
    moving = int(np.sum(sizes > np.sqrt(_FREE)))
    if moving:
        motions = name_twists(tool_directions[:, :moving].T / unit, length)
        raise ComputationError(
            f"{system.name}: the tool is free to {motions}: no drive prevents this"
        )
    idle = free @ combinations[moving:].T
    order = qr(idle.T, mode="r", pivoting=True)[1]
    return IdleMotions(idle, np.sort(order[: idle.shape[1]]))


def _relative(system: System, body: str) -> Array:
    """Matrix that maps the unknowns of the nodes to strains of a body with m interfaces.

    The strains are the dimensionless twists of the interfaces relative to the first interface. The
    matrix is 6(m−1) × unknowns of the nodes. Rigid motions of the body cause no strains.
    """
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    first, *other_interfaces = system.posture.mechanism.bodies[body].interfaces.values()
    ends = system.ends[body]
    rows = [
        unit * (ends[6 * i : 6 * i + 6] - shift(other.position - first.position) @ ends[:6])
        for i, other in enumerate(other_interfaces, start=1)
    ]
    return np.vstack([np.zeros((0, system.outer)), *rows])
