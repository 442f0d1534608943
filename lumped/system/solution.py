"""Compliance, modes and energies of a system, dense: for up to some thousand unknowns.

One Cholesky factor K = L Lᵀ serves statics and modes. Idle motions N make K singular. Holding as
many unknowns as there are stops them: the compliance of the tool does not feel it, and the modes
are those of the stiffness of the others with the mass M − M N (NᵀMN)⁺ NᵀM, which is what is left
when the idle motions run free.

Motions that cost no energy are idle ones, which the tool does not feel, and the tool's own. A rod
between two ball joints spins: harmless in statics, a zero frequency in dynamics. They are found by
kinematics alone: bodies as rigid, springs as locks.
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

# Pivots of the stiffness with unit diagonal: those of a chain of 160 elements are 3e-8. Rounding of
# a singular matrix leaves 1e-16 times what its stiffest entries are above those of the motion.
_SMALLEST_PIVOT = 1e-13
DOUBTFUL = 1e-8
# Mass of an idle motion, relative, below which it has none.
_MASSLESS = 1e-13
# Without units. Rounding of a motion is about 1e-14; a posture's loops are closed to 1e-12.
_FREE = 1e-9


@dataclass(frozen=True, eq=False)
class Solved:
    """A system with its stiffness factorised: L (lower) of the `kept` unknowns, scaled by `scale`.

    `idle` is the number of idle motions, `motions` (n×idle) they themselves.
    """

    system: System
    lower: Array
    scale: Array
    kept: IntArray
    motions: Array

    @property
    def idle(self) -> int:
        """Number of mobilities that do not move the tool."""
        return int(self.motions.shape[1])

    def displacements(self, loads: Array) -> Array:
        """Unknowns (n×m) under loads (n×m) that do no work on idle motions, these held."""
        found = np.zeros_like(loads)
        scaled = self.scale[:, None] * loads[self.kept]
        found[self.kept] = self.scale[:, None] * cho_solve((self.lower, True), scaled)
        return found


def solved(system: System) -> Solved:
    """Factorise the stiffness of `system`.

    Raises ComputationError where the tool is free to move, naming the motion, and where a stiffness
    is negative.
    """
    stiffness = dense(system.stiffness)
    kept = np.arange(system.size)
    factor = factorised(stiffness)
    even = is_even(stiffness[: system.outer, : system.outer])
    if factor is not None and even and _smallest_pivot(factor) > DOUBTFUL:
        return Solved(system, *factor, kept, np.zeros((system.size, 0)))
    idle = idle_motions(system)
    if len(idle.pinned):
        kept = np.delete(kept, idle.pinned)
        factor = factorised(stiffness[np.ix_(kept, kept)])
    if factor is None or _smallest_pivot(factor) < _SMALLEST_PIVOT:
        raise ComputationError(
            f"{system.name}: the stiffness matrix is not positive definite; a stiffness is "
            "negative or differs from the others by more than rounding allows"
        )
    motions = np.vstack([idle.motions, _followed(stiffness, system.outer, idle.motions)])
    return Solved(system, *factor, kept, motions)


def compliance(solution: Solved) -> Array:
    """6×6 compliance (SI, base axes) at the loaded point.

    Raises ComputationError where rounding leaves too little of it.
    """
    loads = solution.system.tool.T
    displacements = solution.displacements(loads)
    forces = solution.system.stiffness @ displacements
    return balanced_flexibility(loads, displacements, forces, solution.system.name)


def rounding(system: System, displacements: Array) -> Array:
    """What rounding of K leaves open of XᵀKX (m×m, SI; 95 %, of both signs), X = `displacements`.

    That is of toolᵀX where the tool's loads have led to X. Body by body, whose interfaces are
    turned, and joint by joint: the strain of a spring is a sum of as many terms as unknowns move
    it. A body's stiffness passes through every unknown that moves it, however little is left of
    their sum; a turned one through every component that turning mixes, for the angle is rounded
    too (`rounding_of_flexibility`).
    """
    squares = np.zeros((displacements.shape[1],) * 2)
    moved = np.abs(displacements[: system.outer])
    for name, model in system.models.items():
        vectors = system.ends[name].reshape(-1, 3, system.outer)
        sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
        passed = np.where(vectors, sizes, 0.0).reshape(-1, system.outer) @ moved
        own = np.concatenate([passed, displacements[system.inside[name]]])
        squares += rounding_of_flexibility(model.stiffness, own) ** 2
    for rows in system.motions.springs.values():
        terms = np.abs(rows) @ moved
        squares += (2.0 * np.sqrt(2.0) * np.finfo(float).eps * terms.T @ terms) ** 2
    return np.asarray(np.sqrt(squares))


def modes(solution: Solved, count: int) -> Modes:
    """The lowest `count` modes (Hz; shapes n×count, mass-normalised), idle motions left out.

    Raises ComputationError where fewer modes have mass.
    """
    found = modes_with_mass(solution, count)
    if not 0 < count == len(found.frequencies):
        raise too_few(solution.system.name, count)
    return found


def modes_with_mass(solution: Solved, count: int) -> Modes:
    """The same, where fewer than `count` have mass these."""
    n = len(solution.kept)
    if not (looked_at := min(count, n)):
        return Modes(np.zeros(0), np.zeros((solution.system.size, 0)))
    standard, drag = _inverse_squares(solution)
    values, vectors = eigh(
        standard, subset_by_index=[n - looked_at, n - 1], driver="evr", check_finite=False
    )
    with_mass = values > np.finfo(float).eps * n * max(values[-1], 0.0)
    values, vectors = values[with_mass][::-1], vectors[:, with_mass][:, ::-1]
    still = dtrsm(1.0, solution.lower, vectors, lower=1, trans_a=1)
    still *= solution.scale[:, None] / np.sqrt(values)
    shapes = solution.motions @ (drag @ still)
    shapes[solution.kept] += still
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(values)), fix_signs(shapes))


def _inverse_squares(solution: Solved) -> tuple[Array, Array]:
    """Matrix whose eigenvalues are 1/ω², and what the idle motions follow the others by."""
    kept, scale = solution.kept, solution.scale
    whole = dense(solution.system.mass)
    mass, drag = whole[np.ix_(kept, kept)], np.zeros((solution.idle, len(kept)))
    if solution.idle:
        momenta, with_mass = _of_idle(solution, whole)
        drag = -with_mass @ momenta[kept].T
        mass = mass + momenta[kept] @ drag
    half = dtrsm(1.0, solution.lower, mass * scale[:, None] * scale, lower=1)
    return dtrsm(1.0, solution.lower, half, side=1, lower=1, trans_a=1), drag


def with_idle(solution: Solved, displacements: Array) -> Array:
    """Displacements (n×m) with the idle motions that follow them freely, without momentum."""
    if not solution.idle:
        return displacements
    momenta, with_mass = _of_idle(solution, dense(solution.system.mass))
    return np.asarray(displacements - solution.motions @ (with_mass @ (momenta.T @ displacements)))


def without_idle(solution: Solved, loads: Array) -> Array:
    """Loads (n×m) less the inertia of idle motions that they set off: what is left strains."""
    if not solution.idle:
        return loads
    momenta, with_mass = _of_idle(solution, dense(solution.system.mass))
    return np.asarray(loads - momenta @ (with_mass @ (solution.motions.T @ loads)))


def idle_accelerations(solution: Solved, loads: Array) -> Array:
    """Accelerations (n×m, SI) of the idle motions that loads (n×m) set off."""
    if not solution.idle:
        return np.zeros_like(loads)
    _, with_mass = _of_idle(solution, dense(solution.system.mass))
    return np.asarray(solution.motions @ (with_mass @ (solution.motions.T @ loads)))


def _of_idle(solution: Solved, mass: Array) -> tuple[Array, Array]:
    """Momenta M N (n×k) of the idle motions, and (NᵀMN)⁺."""
    momenta = mass @ solution.motions
    heaviest = float(np.diag(mass)[: solution.system.outer].max())
    return momenta, _pseudo_inverse(solution.motions.T @ momenta, heaviest)


def strain_shares(system: System, shapes: Array) -> dict[Portion, Array]:
    """Share of the strain energy of each of the `shapes` (n×m) in bodies, drives and joints.

    Bodies by kind of deformation where their model knows it, joints by their elastic parts; the
    shares sum to 1.
    """
    outer = shapes[: system.outer]
    energies = {
        part: np.square(rows @ outer).sum(axis=0) for part, rows in system.motions.springs.items()
    }
    for name, model in system.models.items():
        own = system.own(name, shapes)
        for kind, stiffness in (model.parts or {"": model.stiffness}).items():
            energies[Portion(name, kind)] = np.sum(own * (stiffness @ own), axis=0)
    total = sum(energies.values())
    return {part: energy / total for part, energy in energies.items()}


def is_even(stiffness: Array) -> bool:
    """Whether no diagonal entry of the nodes' stiffness (…×n×n) is lost beside the largest."""
    diagonal = np.diagonal(stiffness, axis1=-2, axis2=-1)
    largest = diagonal.max(axis=-1, keepdims=True, initial=0.0)
    return bool((diagonal > DOUBTFUL * largest).all())


def factorised(stiffness: Array) -> tuple[Array, Array] | None:
    """Cholesky factor of a matrix scaled to a unit diagonal, and the scale; None without one."""
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


def _followed(stiffness: Array, outer: int, motions: Array) -> Array:
    """What the inside of the bodies does when their interfaces move by `motions` (outer×k)."""
    forces = stiffness[outer:, :outer] @ motions
    if not forces.any():
        return np.zeros_like(forces)
    found: Array = -cho_solve(cho_factor(stiffness[outer:, outer:]), forces)
    return found


def _pseudo_inverse(mass: Array, size: float) -> Array:
    """(NᵀMN)⁺, where an idle motion may have no mass but the rounding of `size`."""
    values, vectors = np.linalg.eigh(0.5 * (mass + mass.T))
    heavy = values > _MASSLESS * size
    inverse: Array = (vectors[:, heavy] / values[heavy]) @ vectors[:, heavy].T
    return inverse


@dataclass(frozen=True, eq=False)
class IdleMotions:
    """Idle motions of a system, k of them: `motions` (outer × k) on its nodes' unknowns.

    Holding the `pinned` unknowns (k) stops them and nothing else.
    """

    motions: Array
    pinned: IntArray


def idle_motions(system: System) -> IdleMotions:
    """The idle motions of `system`, drives held or sprung.

    Raises ComputationError, naming the motion, where the tool is left free to move.
    """
    strains = [_relative(system, body) for body in system.ends]
    count = system.outer
    rows = np.vstack([system.motions.locks, *strains])
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    free = right[int(np.sum(values > _FREE)) :].T
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    felt = unit[:, None] * (system.tool[:, :count] @ free)
    left, sizes, mix = np.linalg.svd(felt, full_matrices=True)
    moving = int(np.sum(sizes > np.sqrt(_FREE)))
    if moving:
        motions = name_twists(left[:, :moving].T / unit, length)
        raise ComputationError(f"{system.name}: the tool is free to {motions}: no drive holds it")
    idle = free @ mix[moving:].T
    order = qr(idle.T, mode="r", pivoting=True)[1]
    return IdleMotions(idle, np.sort(order[: idle.shape[1]]))


def _relative(system: System, body: str) -> Array:
    """Twists of a body's other interfaces against its first, without units (6(m−1)×outer)."""
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    first, *others = system.posture.mechanism.bodies[body].interfaces.values()
    ends = system.ends[body]
    rows = [
        unit * (ends[6 * i : 6 * i + 6] - shift(other.position - first.position) @ ends[:6])
        for i, other in enumerate(others, start=1)
    ]
    return np.vstack([np.zeros((0, system.outer)), *rows])
