"""Many postures of one mechanism, all at once where its bodies are reduced.

Craig and Bampton leave a body whose interfaces do not strain its inside: K = diag(K_e, Λ). So the
stiffness of the mechanism falls apart into that of the nodes, which alone is factorised anew, and
Λ. With K_e = L Lᵀ the inverse squares 1/ω² are the eigenvalues of

    [ L⁻¹ M_ee L⁻ᵀ        L⁻¹ M_ei Λ^(−½)  ]
    [ sym.           Λ^(−½) M_ii Λ^(−½) ]

whose last block no posture changes. Where bodies are not reduced, where something idles, and where
a stiffness is in doubt, a posture is solved by itself (`lumped.system.solution`).
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
from lumped.system.assembly import Assembly, Outside, System
from lumped.system.joint_motion import UnevenError
from lumped.system.solution import DOUBTFUL, compliance, is_even, modes, solved

# Numbers in the matrices of the postures that are done together: what fits into a cache.
_TOGETHER = 2_000_000


@dataclass(frozen=True, eq=False)
class Swept:
    """P postures: `compliances` (P×6×6, SI, base axes) at the loaded point, `frequencies` (P×k).

    `idle` (P) is the number of mobilities that do not move the tool.
    """

    compliances: Array
    frequencies: Array
    idle: tuple[int, ...]


def swept(prepared: Assembly, postures: Sequence[Posture], count: int) -> Swept:
    """Compliance and the lowest `count` frequencies (Hz) in each of the postures.

    Raises ComputationError, naming the posture, as `solved`, `compliance` and `modes` do.
    """
    inside = _inside(prepared)
    found = []
    for some in _portions(prepared, postures):
        together = None if inside is None else _together(prepared, inside, some, count)
        found += [together] if together else [_alone(one, count) for one in prepared.along(some)]
    return Swept(
        np.concatenate([one.compliances for one in found]),
        np.concatenate([one.frequencies for one in found]),
        tuple(number for one in found for number in one.idle),
    )


@dataclass(frozen=True, eq=False)
class _Inside:
    """What is inside the bodies, in units of Λ^(−½): `mass`, and its `borders` (6m×i) by body."""

    mass: Array
    borders: dict[str, Array]


def _inside(prepared: Assembly) -> _Inside | None:
    """None where a body is not reduced."""
    masses, borders = [np.zeros((0, 0))], {}
    for name, model in prepared.models.items():
        stiffness, mass, ends = model.stiffness, model.mass, 6 * len(model.interfaces)
        if issparse(stiffness) or issparse(mass):
            return None
        own = np.diag(stiffness)[ends:]
        uncoupled = not stiffness[:ends, ends:].any() and (own > 0.0).all()
        if not (uncoupled and np.count_nonzero(stiffness[ends:, ends:]) == len(own)):
            return None
        unit = 1.0 / np.sqrt(own)
        masses.append(mass[ends:, ends:] * unit[:, None] * unit)
        borders[name] = mass[:ends, ends:] * unit
    return _Inside(block_diag(*masses), borders)


def _portions(prepared: Assembly, postures: Sequence[Posture]) -> Iterator[Sequence[Posture]]:
    unknowns = 6 * len(prepared.structure.nodes)
    unknowns += sum(model.size for model in prepared.models.values())
    count = max(1, _TOGETHER // unknowns**2)
    for first in range(0, len(postures), count):
        yield postures[first : first + count]


def _alone(system: System, count: int) -> Swept:
    solution = solved(system)
    frequencies = modes(solution, count).frequencies if count else np.zeros(0)
    return Swept(compliance(solution)[None], frequencies[None], (solution.idle,))


def _together(
    prepared: Assembly, inside: _Inside, postures: Sequence[Posture], count: int
) -> Swept | None:
    """None where one of the postures must be looked at by itself."""
    try:
        outside = prepared.outside(postures)
        if not is_even(outside.stiffness):
            return None
        scale = 1.0 / np.sqrt(np.diagonal(outside.stiffness, axis1=1, axis2=2))
        lower = np.linalg.cholesky(outside.stiffness * scale[:, :, None] * scale[:, None])
    except (UnevenError, np.linalg.LinAlgError):
        return None
    if np.diagonal(lower, axis1=1, axis2=2).min(initial=1.0) ** 2 < DOUBTFUL:
        return None
    # L⁻¹ with the scale: K⁻¹ = Lᵢᵀ Lᵢ.
    inverse = np.linalg.inv(lower) * scale[:, None]
    loads = np.swapaxes(outside.tool, 1, 2)
    displacements = np.swapaxes(inverse, 1, 2) @ (inverse @ loads)
    forces = outside.stiffness @ displacements
    frequencies = _frequencies(outside, inside, inverse, count)
    try:
        found = balanced_flexibility(loads, displacements, forces, prepared.mechanism.name)
    except ComputationError:
        return None
    return frequencies if frequencies is None else Swept(found, frequencies, (0,) * len(postures))


def _frequencies(outside: Outside, inside: _Inside, inverse: Array, count: int) -> Array | None:
    """P×count (Hz); None where a posture has fewer modes with mass."""
    postures, size = inverse.shape[:2]
    if not count:
        return np.zeros((postures, 0))
    whole = size + len(inside.mass)
    standard = np.empty((postures, whole, whole))
    standard[:, :size, :size] = inverse @ outside.mass @ np.swapaxes(inverse, 1, 2)
    done = size
    for name, border in inside.borders.items():
        mine = slice(done, done + border.shape[1])
        standard[:, :size, mine] = inverse @ (np.swapaxes(outside.ends[name], 1, 2) @ border)
        done = mine.stop
    standard[:, size:, :size] = np.swapaxes(standard[:, :size, size:], 1, 2)
    standard[:, size:, size:] = inside.mass
    values = np.linalg.eigvalsh(standard)[:, ::-1]
    rounding = np.finfo(float).eps * whole * values[:, :1]
    if count > whole or (values[:, :count] <= rounding).any():
        return None
    return np.asarray(1.0 / (2.0 * np.pi * np.sqrt(values[:, :count])))
