"""Natural frequencies and mode shapes of small undamped models, by dense matrices."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, eigh

from lumped.arrays import Array, SparseMatrix, dense, fix_signs, unit_diagonal
from lumped.errors import ComputationError
from lumped.text import counted


@dataclass(frozen=True)
class Modes:
    """Natural frequencies (k, in Hz, ascending) and mode shapes (n×k, columns).

    The shapes have unit modal mass.
    """

    frequencies: Array
    shapes: Array


def solve_modes(
    stiffness: SparseMatrix | Array, mass: SparseMatrix | Array, count: int, part: str
) -> Modes:
    """The lowest `count` natural modes: solutions of det(K − ω²M) = 0, eq. (24) of the paper.

    The problem is solved as M v = (1/ω²) K v, so that M may be singular (massless unknowns) and the
    lowest frequencies are the most accurate. The largest entry of each shape is positive. Raises
    ComputationError, with `part` in its message, if K is not positive definite or if fewer than
    `count` modes move mass.
    """
    k, m = dense(stiffness), dense(mass)
    n = k.shape[0]
    try:
        scale = unit_diagonal(k)
        k = k * scale[:, None] * scale
        m = m * scale[:, None] * scale
        values, vectors = eigh(m, k, subset_by_index=[max(n - count, 0), n - 1])
    except LinAlgError as error:
        raise ComputationError(
            "the stiffness matrix is not positive definite; "
            "a part is free to move or a stiffness is negative",
            part=part,
        ) from error
    values, vectors = values[::-1], vectors[:, ::-1] * scale[:, None]
    if len(values) < count or values[-1] <= np.finfo(float).eps * n * values[0]:
        raise too_few(part, count)
    shapes = fix_signs(vectors / np.sqrt(values))
    return Modes(frequencies=1.0 / (2.0 * np.pi * np.sqrt(values)), shapes=shapes)


class FewerModesError(ComputationError):
    """Error: more modes were requested than there are modes that move mass."""


def too_few(part: str, count: int) -> FewerModesError:
    """Error to raise if `count` modes of `part` were requested, but fewer modes move mass."""
    return FewerModesError(
        f"{counted(count, 'mode')} requested, but fewer modes move mass", part=part
    )
