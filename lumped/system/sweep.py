"""Statics and natural frequencies of one mechanism in many postures.

Craig–Bampton reduction decouples the stiffness of the interfaces (e) of a body from that of its
inside (i): K = diag(K_e, Λ). The stiffness of the mechanism thus consists of that of the nodes,
which is factorised for each posture, and of Λ. With the stiffness of the nodes K_e = L Lᵀ the
inverse squares 1/ω² are the eigenvalues of

    [ L⁻¹ M_ee L⁻ᵀ        L⁻¹ M_ei Λ^(−½)  ]
    [ sym.           Λ^(−½) M_ii Λ^(−½) ]

whose last block does not depend on the posture. All postures are solved together. A posture is
solved individually (`lumped.system.solution`) if a body is not reduced, if there is an idle motion,
or if the stiffness may be singular.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import issparse

from lumped.arrays import Array
from lumped.dense.statics import balanced_flexibility
from lumped.errors import ComputationError
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import Assembly, NodeMatrices, System
from lumped.system.joint_motion import UnevenError
from lumped.system.solution import DOUBTFUL, compliance, is_well_scaled, modes, solved

# Number of matrix entries that are evaluated together, so that they fit into the processor's cache.
_LARGEST_BATCH = 2_000_000


@dataclass(frozen=True, eq=False)
class Swept:
    """Compliances and natural frequencies in P postures.

    `compliances` (P×6×6, SI, base axes) are those of the loaded point, `frequencies` (P×k) are in
    Hz. `idle` (P) is the number of idle motions, which move neither the tool nor a drive.
    """

    compliances: Array
    frequencies: Array
    idle: tuple[int, ...]


def swept(prepared: Assembly, postures: Sequence[Posture], count: int) -> Swept:
    """Compliance and the lowest `count` natural frequencies (Hz) in each of the postures.

    Raises ComputationError, with the posture in its message, under the conditions of `solved`,
    `compliance` and `modes`.
    """
    inside = _inner_matrices(prepared)
    results: list[Swept] = []
    for batch in _batches(prepared, postures):
        together = None if inside is None else _together(prepared, inside, batch, count)
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
    """Mass matrix of the internal unknowns scaled by Λ^(−½), and its coupling to the interfaces.

    `borders` contains the coupling (6m×i) of the m interfaces of each body to its i internal
    unknowns, by name.
    """

    mass: Array
    borders: dict[str, Array]


def _inner_matrices(prepared: Assembly) -> _InnerMatrices | None:
    """Matrices of the internal unknowns of all bodies. None if a body is not reduced."""
    masses, borders = [np.zeros((0, 0))], {}
    for name, model in prepared.models.items():
        stiffness, mass, ends = model.stiffness, model.mass, 6 * len(model.interfaces)
        if issparse(stiffness) or issparse(mass):
            return None
        inner_stiffnesses = np.diag(stiffness)[ends:]
        uncoupled = not stiffness[:ends, ends:].any() and (inner_stiffnesses > 0.0).all()
        if not (uncoupled and np.count_nonzero(stiffness[ends:, ends:]) == len(inner_stiffnesses)):
            return None
        unit = 1.0 / np.sqrt(inner_stiffnesses)
        masses.append(mass[ends:, ends:] * unit[:, None] * unit)
        borders[name] = mass[:ends, ends:] * unit
    return _InnerMatrices(block_diag(*masses), borders)


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
    """Results of a batch of postures. None if one of them must be solved individually."""
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
    """Natural frequencies (P×count, in Hz). None if too few modes move mass in a posture."""
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
