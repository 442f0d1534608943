"""Many postures of one robot: the legs are dense and fixed, only their ends turn.

The fast path beside `lumped.biglide_assembly.assemble`, for legs of up to some hundred unknowns
(superelements, segments, beams). Everything that does not turn is summed once: feet, tool and
platform, and the internal unknowns of the legs, which stay in leg axes. A posture turns the rows
and columns of each leg's two ends.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh
from scipy.linalg.blas import dtrsm
from scipy.sparse import csr_array

from fem.reduction.superelement import ENDS
from lumped.arrays import Array, IntArray
from lumped.balance import balanced_flexibility
from lumped.biglide import Biglide, Places
from lumped.biglide_assembly import Release, assemble
from lumped.errors import ComputationError
from lumped.leg_matrices import LegMatrices
from lumped.modes import Modes, dense, fix_signs, unit_diagonal
from lumped.screws import turn

# Pivots of the stiffness with unit diagonal: those of a chain of 160 elements are 3e-8, rounding
# of a singular matrix leaves about 1e-16 to 1e-15.
_SMALLEST_PIVOT = 1e-13


@dataclass(frozen=True, eq=False)
class _TurningLeg:
    """End blocks of one leg in its own axes, and the robot's unknowns that they belong to.

    `free` are those of the 12 end unknowns that the robot does not hold (rigid feet do), `ends` the
    robot's numbers for them, `inner` for the leg's internal unknowns. `matrices`: stiffness and
    mass, each as the ends' own block (12×12) and their coupling to the internal unknowns.
    """

    free: IntArray
    ends: IntArray
    inner: IntArray
    matrices: tuple[tuple[Array, Array], tuple[Array, Array]]

    def add(self, rotation: Array, totals: tuple[Array, Array]) -> None:
        """Add the leg's stiffness and mass, turned by `rotation` (3×3), to those of the robot."""
        block = turn(rotation)
        to_robot = np.zeros((ENDS, ENDS))
        to_robot[:6, :6] = to_robot[6:, 6:] = block
        to_robot = to_robot[self.free]
        for (own, coupling), total in zip(self.matrices, totals, strict=True):
            turned = to_robot @ own @ to_robot.T
            total[np.ix_(self.ends, self.ends)] += 0.5 * (turned + turned.T)
            border = to_robot @ coupling
            total[np.ix_(self.ends, self.inner)] += border
            total[np.ix_(self.inner, self.ends)] += border.T


@dataclass(frozen=True, eq=False)
class PostureModel:
    """A robot whose postures can be solved one after the other; unknowns as there.

    `stiffness`, `mass` (n×n) are what does not turn, `loaded` (6×n) the twist of the loaded point.
    """

    robot: Biglide
    stiffness: Array
    mass: Array
    loaded: Array
    legs: tuple[_TurningLeg, _TurningLeg]

    def matrices(self, x: float) -> tuple[Array, Array]:
        """Stiffness and mass (n×n, dense) with B at `x` (m); InputError outside the stroke."""
        posture = self.robot.posture(x)
        totals = self.stiffness.copy(), self.mass.copy()
        for leg, rotation in zip(self.legs, _rotations(posture), strict=True):
            leg.add(rotation, totals)
        return totals


@dataclass(frozen=True, eq=False)
class SolvedPosture:
    """Robot with B at `x` (m): `compliance` (6×6, robot axes) at the loaded point and `modes`."""

    x: float
    compliance: Array
    modes: Modes


def posture_model(
    robot: Biglide, leg1: LegMatrices, leg2: LegMatrices, release: Release = "condensed"
) -> PostureModel:
    """Sum up what all postures of the robot share; `release` as in lumped.biglide_assembly."""
    centre = robot.posture(robot.centre)
    whole = assemble(robot, robot.centre, leg1, leg2, release)
    stiffness = sum((dense(k) for k in whole.springs.values()), np.zeros(whole.stiffness.shape))
    loaded = dense(whole.loaded)
    platform = np.diag([robot.platform_mass] * 3 + [0.0] * 3)
    mass = loaded.T @ platform @ loaded
    legs = []
    for leg, to_leg, rotation in zip((leg1, leg2), whole.legs, _rotations(centre), strict=True):
        # The leg's unknowns in robot axes are unknowns of the robot: turned back, the map is a
        # selection, whose entries are 0 and 1 but for rounding.
        back = np.kron(np.eye(2), turn(rotation)) @ dense(csr_array(to_leg)[:ENDS])
        free, ends = np.nonzero(np.round(back))
        inner = np.flatnonzero(dense(abs(csr_array(to_leg)[ENDS:]).sum(axis=0)))
        k, m = dense(leg.stiffness), dense(leg.mass)
        for total, own in ((stiffness, k), (mass, m)):
            total[np.ix_(inner, inner)] += own[ENDS:, ENDS:]
        blocks = tuple((a[:ENDS, :ENDS].copy(), a[:ENDS, ENDS:].copy()) for a in (k, m))
        legs.append(_TurningLeg(free, ends, inner, (blocks[0], blocks[1])))
    return PostureModel(robot, stiffness, mass, loaded, (legs[0], legs[1]))


def solve_posture(model: PostureModel, x: float, count: int) -> SolvedPosture:
    """Compliance and the lowest `count` modes (Hz, shapes n×count) with B at `x` (m).

    One Cholesky factor of K serves both: C = F K⁻¹ Fᵀ and L⁻¹ M L⁻ᵀ w = w/ω². Raises InputError
    outside the stroke, ComputationError where a part is free to move or too few modes have mass.
    """
    name = f"{model.robot.name} at x = {x:g} m"
    stiffness, mass = model.matrices(x)
    try:
        scale = unit_diagonal(stiffness)
        factor = cho_factor(stiffness * scale[:, None] * scale, lower=True, check_finite=False)
    except LinAlgError:
        factor = None
    if factor is None or np.min(np.diag(factor[0])) ** 2 < _SMALLEST_PIVOT:
        raise ComputationError(f"{name}: the stiffness matrix is singular; a part is free to move")
    wrenches = scale[:, None] * model.loaded.T
    displacements = scale[:, None] * cho_solve(factor, wrenches, check_finite=False)
    loads = model.loaded.T
    compliance = balanced_flexibility(loads, displacements, stiffness @ displacements, name)
    modes = _modes(factor[0], mass * scale[:, None] * scale, count, name)
    return SolvedPosture(
        x=x,
        compliance=compliance,
        modes=Modes(modes.frequencies, fix_signs(scale[:, None] * modes.shapes)),
    )


def _modes(lower: Array, mass: Array, count: int, name: str) -> Modes:
    """Modes from K = L Lᵀ (`lower`, upper triangle undefined) and M; signs not fixed."""
    n = len(mass)
    half = dtrsm(1.0, lower, mass, lower=1)
    standard = dtrsm(1.0, lower, half, side=1, lower=1, trans_a=1)
    values, vectors = eigh(
        standard, subset_by_index=[max(n - count, 0), n - 1], driver="evr", check_finite=False
    )
    values, vectors = values[::-1], vectors[:, ::-1]
    if len(values) < count or values[-1] <= np.finfo(float).eps * n * values[0]:
        raise ComputationError(f"{name}: {count} modes asked for, but fewer have mass")
    shapes = dtrsm(1.0, lower, vectors, lower=1, trans_a=1) / np.sqrt(values)
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(values)), shapes)


def _rotations(posture: Places) -> tuple[Array, Array]:
    return posture.rotation1, posture.rotation2
