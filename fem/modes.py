"""Lowest modes of K φ = ω² M φ by block Lanczos on the factor of K, certified by a Sturm count.

T = K⁻¹M is symmetric in the inner product of M, its eigenvalues are θ = 1/ω². Blocks of right-hand
sides read the factor once for all of them. The basis is kept M-orthonormal in full, so a Ritz
value has the residual ‖T x − θ x‖_M = ‖B s‖ with the last block's B and s: some eigenvalue lies
that near (Krylov, Weinstein), and within residual²/gap of an isolated one (Kato, Temple); Parlett,
The Symmetric Eigenvalue Problem, §§10–13. Lanczos alone cannot know what it missed: the negative
eigenvalues of K − σM, σ in the gap above the last mode, are counted.
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import block_array, csr_array, eye_array
from scipy.sparse.linalg import LinearOperator

from fem.cholesky import Backend, Factor, default_backend
from fem.end_coupling import RigidEnds
from fem.sturm import Inertia, count_below
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError, InputError
from lumped.modes import Modes, fix_signs

if TYPE_CHECKING:
    from fem.solid import ClampedLeg

# Measured for 20 modes: 6 to 12 columns cost the same time, fewer read the factor more often, more
# need more columns in all.
_BLOCK = 8
_SEED = 1
# Residual relative to θ: bounds the relative error of a frequency by half of it without any
# assumption, and by 5e-10 for a mode that keeps 1e-3 from its neighbours in ω².
_RESIDUAL = 1e-6
# The mode after the last one only has to show where the gap is.
_RESIDUAL_BEYOND = 1e-2
# Modes closer than this in ω² stay on one side of σ: rounding must not decide the count.
_GAP = 1e-4
_SHIFT_ABOVE = 1e-3
# Places of σ in its interval: a pivot may vanish at one of them by chance.
_PLACES = (1.0, 0.8, 0.6)
# A direction that loses this part of its squared length to those before it is rounding error.
_DEPENDENT = 1e-20

Count: TypeAlias = Callable[[float], Inertia]


@dataclass(frozen=True)
class CertifiedModes(Modes):
    """Modes of which none is missing.

    `frequency_errors`: relative, estimated by the smaller of both bounds of the residual.
    `count` eigenvalues lie below `shift` (rad²/s²), counted by `certificate`: the modes given and
    those of the last one's cluster. `solves`: right-hand sides solved for.
    """

    frequency_errors: Array
    shift: float
    count: int
    certificate: str
    solves: int


@dataclass(frozen=True)
class _Ritz:
    """Ritz values ω² (ascending), vectors (n×k), residuals relative to θ, and solves used."""

    values: Array
    vectors: Array
    residuals: Array
    solves: int


def _orthonormal(block: Array, basis: Array, M: SparseMatrix | LinearOperator) -> Array:
    """The part of `block` M-orthogonal to `basis`, M-orthonormal; dependent directions dropped."""
    size = np.einsum("ij,ij->j", block, M @ block)
    block = block[:, size > 0.0] / np.sqrt(size[size > 0.0])
    # Once more: the first pass leaves rounding errors of the size of what it removed.
    for _ in range(3):
        block = block - basis @ (basis.T @ (M @ block))
        gram = block.T @ (M @ block)
        squares, directions = eigh((gram + gram.T) / 2.0)
        kept = squares > _DEPENDENT
        block = block @ (directions[:, kept] / np.sqrt(squares[kept]))
    return np.asarray(block)


def _last_wanted(values: Array, count: int) -> int:
    """Number of modes up to the first gap at or after `count`, 0 where no gap is in sight."""
    gaps = values[count:] - values[count - 1 : -1] > _GAP * values[count - 1 : -1]
    return count + int(np.argmax(gaps)) if gaps.any() else 0


def _block_lanczos(
    factor: Factor,
    M: SparseMatrix | LinearOperator,
    start: Array,
    count: int,
    part: str,
) -> tuple[_Ritz, int]:
    """Ritz pairs until `count` and the rest of the last one's cluster have converged; how many."""
    limit = 12 * count + 20 * start.shape[1]
    size = len(start)
    block = _orthonormal(factor.solve(M @ start), np.zeros((size, 0)), M)
    solves, basis, projected = start.shape[1], block, np.zeros((0, 0))
    while True:
        image = factor.solve(M @ block)
        solves += block.shape[1]
        column = basis.T @ (M @ image)
        previous = basis.shape[1] - block.shape[1]
        projected = np.block(
            [[projected, column[:previous]], [column[:previous].T, column[previous:]]]
        )
        following = _orthonormal(image, basis, M)
        coefficients = following.T @ (M @ image)
        theta, s = eigh((projected + projected.T) / 2.0)
        theta, s = theta[::-1], s[:, ::-1]
        has_mass = theta > np.finfo(float).eps * len(theta) * theta[0]
        theta, s = theta[has_mass], s[:, has_mass]
        values = 1.0 / theta
        residuals = np.linalg.norm(coefficients @ s[previous:], axis=0) / theta
        exhausted = following.shape[1] == 0
        if exhausted and len(values) < count:
            raise ComputationError(f"{part}: {count} modes asked for, but fewer have mass")
        wanted = _last_wanted(values, count) if len(values) > count else 0
        if exhausted and not wanted:
            wanted = len(values)
        if wanted and np.all(residuals[:wanted] <= _RESIDUAL):
            beyond = residuals[wanted : wanted + 1]
            if np.all(beyond <= _RESIDUAL_BEYOND):
                kept = slice(0, wanted + 1)
                vectors = basis @ s[:, :wanted]
                return _Ritz(values[kept], vectors, residuals[kept], solves), wanted
        if exhausted or basis.shape[1] + following.shape[1] > limit:
            converged = int(np.argmin(np.append(residuals[:count] <= _RESIDUAL, [False])))
            raise ComputationError(
                f"{part}: {converged} of {count} modes converged in {solves} solves; "
                "fewer modes or a finer mesh are needed"
            )
        block, basis = following, np.hstack([basis, following])


def _errors(values: Array, residuals: Array, wanted: int) -> Array:
    """Relative errors of frequencies from residuals: half of the smaller bound of ω²'s."""
    distances = np.abs(values[:wanted, None] - values) / values
    distances[distances < _GAP] = np.inf
    gaps = distances.min(axis=1)
    return np.asarray(np.minimum(residuals[:wanted], residuals[:wanted] ** 2 / gaps) / 2.0)


def certify(values: Array, wanted: int, count: Count, part: str) -> float:
    """A shift σ (rad²/s²) below which exactly the first `wanted` eigenvalues are proven to lie.

    `values` are the eigenvalues found (ω², ascending), with the one after `wanted` if there is
    one; `count` the inertia of K − σM. Raises ComputationError where the count differs or cannot
    be made.
    """
    last = values[wanted - 1]
    room = _SHIFT_ABOVE * last
    if len(values) > wanted:
        room = min(room, (values[wanted] - last) / 2.0)
    for place in _PLACES:
        sigma = float(last + place * room)
        found = count(sigma)
        if found.zero:
            continue
        if found.negative != wanted:
            raise ComputationError(
                f"{part}: certificate of the modes failed: {found.negative} lie below "
                f"{np.sqrt(sigma) / (2.0 * np.pi):.6g} Hz, {wanted} were found; the start has "
                "no share in a mode or the factor of the stiffness is inaccurate"
            )
        return sigma
    raise ComputationError(
        f"{part}: certificate of the modes failed: zero pivots near "
        f"{np.sqrt(last) / (2.0 * np.pi):.6g} Hz; ask for another number of modes"
    )


def lowest_modes(
    factor: Factor,
    M: SparseMatrix | LinearOperator,
    mode_count: int,
    count: Count,
    part: str,
    certificate: str = "sturm",
    start: Array | None = None,
) -> CertifiedModes:
    """The lowest `mode_count` modes from the factor of K (n×n) and M (n×n, semidefinite).

    `count` gives the inertia of K − σM; `certificate` is its name. `start` (n×s) are vectors near
    the modes; fixed noise is always added, so that no symmetry of theirs hides a mode. Shapes are
    mass-normalised, on the n unknowns. Where the count finds a missed mode, the search is repeated
    once with blocks of twice the size. Raises InputError for fewer than one mode or a start of
    another size, ComputationError, naming `part`, where modes do not converge or the certificate
    fails again.
    """
    n = M.shape[0]
    if mode_count < 1:
        raise InputError(f"{part}: modes = {mode_count!r}: must be 1 or more")
    if start is not None and (start.ndim != 2 or len(start) != n):
        raise InputError(f"{part}: start has shape {start.shape}: must be {n} × any number")
    solves = 0
    for columns in (_BLOCK, 2 * _BLOCK):
        rng = np.random.default_rng(_SEED)
        block = rng.standard_normal((n, columns)) / np.sqrt(n)
        if start is not None:
            mixed = start @ rng.standard_normal((start.shape[1], columns))
            block = block * np.linalg.norm(mixed) / np.sqrt(columns) + mixed
        ritz, wanted = _block_lanczos(factor, M, block, mode_count, part)
        solves += ritz.solves
        try:
            sigma = certify(ritz.values, wanted, count, part)
        except ComputationError:
            if columns == _BLOCK:
                continue
            raise
        break
    return CertifiedModes(
        frequencies=np.sqrt(ritz.values[:mode_count]) / (2.0 * np.pi),
        shapes=fix_signs(ritz.vectors[:, :mode_count]),
        frequency_errors=_errors(ritz.values, ritz.residuals, wanted)[:mode_count],
        shift=sigma,
        count=wanted,
        certificate=certificate,
        solves=solves,
    )


def _counting_backend() -> Backend:
    """PARDISO where it is installed: at 800k unknowns it alone counts in a minute."""
    return "mkl" if find_spec("pypardiso") else default_backend()


def clamped_count(clamped: "ClampedLeg", backend: Backend) -> Count:
    """Inertia of K − σM of a clamped leg, its ends rigid or free.

    Free ends: K − σM on B_rootᵀu = 0 is replaced by K − σM + c B_root B_rootᵀ on all u, a spring
    for the constraint. That can only add to the negative ones, and modes found are there in any
    case: an equal count is as good a proof. With the forces of the springs as unknowns the matrix
    stays sparse and has six negative eigenvalues more.
    """
    if isinstance(clamped.ends, RigidEnds):
        ends = clamped.ends.leading_blocks

        def rigid(sigma: float) -> Inertia:
            return count_below(clamped.stiffness, csr_array(clamped.mass), sigma, ends, backend)

        return rigid

    K, M = clamped.solid.stiffness, clamped.solid.mass
    length, loads = clamped.solid.mesh.length, clamped.ends.root_loads
    # Far stiffer than the leg, and of the size of the stiffness matrix's own entries.
    pivot = float(K.diagonal().mean())
    stiffness = 1e2 * clamped.solid.leg.material.E * length * np.repeat([1.0, length**2], 3)
    coupling = csr_array(loads * np.sqrt(pivot * stiffness))
    bordered = csr_array(
        block_array([[-pivot * eye_array(6), coupling.T], [coupling, K]], format="csr")
    )
    mass = csr_array(block_array([[csr_array((6, 6)), None], [None, M]], format="csr"))

    def free(sigma: float) -> Inertia:
        found = count_below(bordered, mass, sigma, (6,), backend)
        return Inertia(found.negative - 6, found.zero, found.positive)

    return free


def modes(clamped: "ClampedLeg", count: int, start: Array | None = None) -> CertifiedModes:
    """The lowest `count` modes of a leg held at its root: shapes 3N×count, leg axes.

    `start` as in `lowest_modes`, on the unknowns of the held leg. Raises as `lowest_modes` does.
    """
    backend = _counting_backend()
    found = lowest_modes(
        clamped.factor,
        clamped.mass,
        count,
        clamped_count(clamped, backend),
        "solid leg",
        {"cholmod": "sturm (LDLᵀ)", "mkl": "sturm (MKL PARDISO)"}[backend],
        start,
    )
    return CertifiedModes(
        frequencies=found.frequencies,
        shapes=fix_signs(clamped.ends.expanded(found.shapes)),
        frequency_errors=found.frequency_errors,
        shift=found.shift,
        count=found.count,
        certificate=found.certificate,
        solves=found.solves,
    )
