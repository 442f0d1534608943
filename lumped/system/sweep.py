"""Statics and natural frequencies of one mechanism in many postures.

Craig–Bampton reduction decouples the stiffness of the interfaces (e) of a body from that of its
internal unknowns (i): K = diag(K_e, Λ) with a diagonal matrix Λ. A body that is not reduced is
decoupled by the substitution u_i = −K_ii⁻¹ K_ie u_e + L_ii⁻ᵀ q with K_ii = L_ii L_iiᵀ, after which
Λ is the identity. This keeps all unknowns and changes no result. The stiffness of the mechanism is
then diag(K_e, Λ), too. Only the stiffness K_e = L Lᵀ of the nodes depends on the posture and is
factorised for each posture. The inverse squares 1/ω² of the frequencies are the eigenvalues of

    [ L⁻¹ M_ee L⁻ᵀ        L⁻¹ M_ei Λ^(−½)  ]
    [ sym.           Λ^(−½) M_ii Λ^(−½) ]

whose last block does not depend on the posture. Postures are solved together in batches. The
postures of a batch are solved individually (`lumped.system.solution`) if the matrices of a body are
sparse, if there is an idle motion, or if the stiffness may be singular.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, block_diag, cho_solve, cholesky, solve_triangular
from scipy.sparse import issparse

from lumped.arrays import Array
from lumped.dense.statics import balanced_flexibility
from lumped.errors import ComputationError
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import Assembly, NodeMatrices, System
from lumped.system.joint_motion import UnevenError
from lumped.system.solution import DOUBTFUL, compliance, is_well_scaled, modes, solved

# Number of matrix entries that are evaluated together, so that they fit into the processor's cache.
_LARGEST_BATCH = 2_000_000


@dataclass(frozen=True, eq=False)
class Swept:
    """Compliances and natural frequencies in P postures.

    `compliances` (P×6×6, SI, base axes) are those of the loaded point. `frequencies` (P×k) are in
    Hz, ascending. `idle` (P) are the numbers of idle motions, which move neither the tool nor a
    drive.
    """

    compliances: Array
    frequencies: Array
    idle: tuple[int, ...]


def swept(prepared: Assembly, postures: Sequence[Posture], count: int) -> Swept:
    """Compliance and the lowest `count` natural frequencies (Hz) in each of the postures.

    Raises ComputationError, with the posture in its message, under the conditions of `solved`,
    `compliance` and `modes`.
    """
    decoupled = _decoupled(prepared)
    results: list[Swept] = []
    for batch in _batches(prepared, postures):
        together = None if decoupled is None else _together(*decoupled, batch, count)
        if together:
            results.append(together)
        else:
            results += [_individually(system, count) for system in prepared.along(batch)]
    return Swept(
        np.concatenate([result.compliances for result in results]),
        np.concatenate([result.frequencies for result in results]),
        tuple(number for result in results for number in result.idle),
    )


@dataclass(frozen=True, eq=False)
class _InnerMatrices:
    """Blocks of the mass matrix for the internal unknowns of all bodies, scaled by Λ^(−½).

    `mass` is Λ^(−½) M_ii Λ^(−½). `borders` contains, by name of the body, the matrix M_ei Λ^(−½)
    (6m×i), which couples the m interfaces of a body to its i internal unknowns.
    """

    mass: Array
    borders: dict[str, Array]


def _decoupled(prepared: Assembly) -> tuple[Assembly, _InnerMatrices] | None:
    """Assembly of bodies whose stiffness is diag(K_e, Λ), and the blocks of their mass matrices.

    None if a body has sparse matrices, or if the stiffness of its internal unknowns is not positive
    definite.
    """
    models, masses, borders = {}, [np.zeros((0, 0))], {}
    for name, model in prepared.models.items():
        if issparse(model.stiffness) or issparse(model.mass):
            return None
        try:
            models[name] = decoupled = _decoupled_body(model)
        except LinAlgError:
            return None
        ends = 6 * len(model.interfaces)
        unit = 1.0 / np.sqrt(np.diag(decoupled.stiffness)[ends:])
        masses.append(decoupled.mass[ends:, ends:] * unit[:, None] * unit)
        borders[name] = decoupled.mass[:ends, ends:] * unit
    return replace(prepared, models=models), _InnerMatrices(block_diag(*masses), borders)


def _decoupled_body(model: BodyModel) -> BodyModel:
    """The same body with other internal unknowns, so that its stiffness is diag(K_e, Λ).

    Λ is diagonal and positive. Raises LinAlgError if the stiffness of the internal unknowns is not
    positive definite.
    """
    stiffness, mass, ends = model.stiffness, model.mass, 6 * len(model.interfaces)
    inner, coupling = stiffness[ends:, ends:], stiffness[:ends, ends:]
    values = np.diag(inner)
    if (values > 0.0).all() and not coupling.any() and np.count_nonzero(inner) == len(values):
        return model
    lower = cholesky(inner, lower=True)
    shapes = np.eye(len(stiffness))
    shapes[ends:, :ends] = -cho_solve((lower, True), coupling.T)
    shapes[ends:, ends:] = solve_triangular(lower, np.eye(len(inner)), lower=True, trans="T")
    at_ends = stiffness[:ends, :ends] + coupling @ shapes[ends:, :ends]
    decoupled_stiffness = block_diag(0.5 * (at_ends + at_ends.T), np.eye(len(inner)))
    return replace(model, stiffness=decoupled_stiffness, mass=shapes.T @ mass @ shapes)


def _batches(prepared: Assembly, postures: Sequence[Posture]) -> Iterator[Sequence[Posture]]:
    unknowns = 6 * len(prepared.structure.nodes)
    unknowns += sum(model.size for model in prepared.models.values())
    count = max(1, _LARGEST_BATCH // unknowns**2)
    for first in range(0, len(postures), count):
        yield postures[first : first + count]


def _individually(system: System, count: int) -> Swept:
    solution = solved(system)
    frequencies = modes(solution, count).frequencies if count else np.zeros(0)
    return Swept(compliance(solution)[None], frequencies[None], (solution.idle,))


def _together(
    prepared: Assembly, inside: _InnerMatrices, postures: Sequence[Posture], count: int
) -> Swept | None:
    """Compliances and frequencies of a batch of postures, solved together.

    None if the postures must be solved individually.
    """
    try:
        nodes = prepared.node_matrices(postures)
        if not is_well_scaled(nodes.stiffness):
            return None
        scale = 1.0 / np.sqrt(np.diagonal(nodes.stiffness, axis1=1, axis2=2))
        lower = np.linalg.cholesky(nodes.stiffness * scale[:, :, None] * scale[:, None])
    except (UnevenError, np.linalg.LinAlgError):
        return None
    if np.diagonal(lower, axis1=1, axis2=2).min(initial=1.0) ** 2 < DOUBTFUL:
        return None
    # `inverse` contains the scale, so that K⁻¹ = inverseᵀ · inverse.
    inverse = np.linalg.inv(lower) * scale[:, None]
    loads = np.swapaxes(nodes.tool, 1, 2)
    displacements = np.swapaxes(inverse, 1, 2) @ (inverse @ loads)
    forces = nodes.stiffness @ displacements
    frequencies = _frequencies(nodes, inside, inverse, count)
    try:
        compliances = balanced_flexibility(loads, displacements, forces, prepared.mechanism.name)
    except ComputationError:
        return None
    return (
        frequencies
        if frequencies is None
        else Swept(compliances, frequencies, (0,) * len(postures))
    )


def _frequencies(
    nodes: NodeMatrices, inside: _InnerMatrices, inverse: Array, count: int
) -> Array | None:
    """The lowest `count` natural frequencies (P×count, in Hz) in P postures.

    `inverse` (P×n×n) is L⁻¹ for the stiffness K_e = L Lᵀ of the nodes. None if fewer than `count`
    modes move mass in a posture.
    """
    postures, size = inverse.shape[:2]
    if not count:
        return np.zeros((postures, 0))
    total = size + len(inside.mass)
    standard = np.empty((postures, total, total))
    standard[:, :size, :size] = inverse @ nodes.mass @ np.swapaxes(inverse, 1, 2)
    assigned = size
    for name, border in inside.borders.items():
        columns = slice(assigned, assigned + border.shape[1])
        standard[:, :size, columns] = inverse @ (np.swapaxes(nodes.ends[name], 1, 2) @ border)
        assigned = columns.stop
    standard[:, size:, :size] = np.swapaxes(standard[:, :size, size:], 1, 2)
    standard[:, size:, size:] = inside.mass
    values = np.linalg.eigvalsh(standard)[:, ::-1]
    rounding = np.finfo(float).eps * total * values[:, :1]
    if count > total or (values[:, :count] <= rounding).any():
        return None
    return np.asarray(1.0 / (2.0 * np.pi * np.sqrt(values[:, :count])))
