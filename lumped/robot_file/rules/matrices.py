"""Faults of compliance and inertia matrices: symmetry, positive definiteness, unit.

Both the reader of robot files and the audit use these checks.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.robot_file.rules.rule import Number, Rule, Several, is_finite_number
from lumped.text import shown

# Largest asymmetry relative to √(k_ii k_jj). Finite element programs print seven digits, so that
# symmetric entries may differ in the last one. A wrong sign or exponent makes a larger difference.
SYMMETRY_TOLERANCE = 1e-6
# Smallest eigenvalue of a matrix scaled to a unit diagonal. Below it, round-off decides the sign.
DEFINITENESS_TOLERANCE = 1e-12
# Smallest compliance (m/N), below that of any part. An "infinite" stiffness increases round-off.
SMALLEST_COMPLIANCE = 1e-15
# Largest compliance: 1 m or 1 rad under 1 N or 1 N m. A larger entry is a stiffness (1e5 and more).
LARGEST_COMPLIANCE = 1.0
_DIAGONAL = tuple(
    Number(
        unit,
        above=0.0,
        slip=SMALLEST_COMPLIANCE,
        most=LARGEST_COMPLIANCE,
        high="is this a stiffness?",
    )
    for unit in ("m/N", "rad/(N m)")
    for _ in range(3)
)
# From a grain of 1e-9 kg to 1e5 kg at 100 m, the largest mass and length of a body.
_INERTIA = Number("kg m²", above=0.0, slip=1e-20, most=1e9, high="is this in kg mm²?")
# Number of entries above LARGEST_COMPLIANCE that indicate a stiffness matrix. A single one is a
# typing error.
_ENTRIES_OF_A_STIFFNESS = 2


@dataclass(frozen=True)
class Asymmetry:
    """Two entries of a matrix that should be equal: `lower` below the diagonal, `upper` above it.

    `row` and `column` (from 1) are those of `lower`.
    """

    row: int
    column: int
    lower: float
    upper: float


def asymmetries(matrix: Array) -> tuple[Asymmetry, ...]:
    """Entries of a square matrix that differ from their mirror image by more than round-off."""
    size = np.sqrt(np.abs(np.diag(matrix)))
    scale = np.maximum(np.outer(size, size), np.maximum(np.abs(matrix), np.abs(matrix.T)))
    wrong = np.tril(np.abs(matrix - matrix.T) > SYMMETRY_TOLERANCE * scale)
    return tuple(
        Asymmetry(int(i) + 1, int(j) + 1, float(matrix[i, j]), float(matrix[j, i]))
        for i, j in zip(*np.nonzero(wrong), strict=True)
    )


def smallest_eigenvalue(matrix: Array) -> float:
    """Smallest eigenvalue of the symmetric part of a square matrix, in its (mixed) units."""
    return float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0])


def is_positive_definite(matrix: Array) -> bool:
    """True if the symmetric part of a matrix is positive definite, regardless of units."""
    diagonal = np.diag(matrix)
    if np.any(diagonal <= 0.0):
        return False
    scale = 1.0 / np.sqrt(diagonal)
    return smallest_eigenvalue(matrix * np.outer(scale, scale)) > DEFINITENESS_TOLERANCE


def symmetric(rows: Any) -> Array:
    """Symmetric part of a square matrix that is given by its rows."""
    matrix: Array = np.array(rows, dtype=float)
    mean: Array = 0.5 * (matrix + matrix.T)
    return mean


@dataclass(frozen=True)
class SquareMatrix(Rule):
    """Rule for a symmetric positive definite matrix with `size` rows and columns in `unit`.

    `compliance` is True for a compliance matrix, False for an inertia matrix.
    """

    written = (list,)
    size: int
    unit: str
    compliance: bool

    @property
    def allowed(self) -> str:
        return f"a symmetric {self.size}×{self.size} matrix in {self.unit}"

    @property
    def schema(self) -> dict[str, Any]:
        return Several(Several(Number(), self.size), self.size).schema

    def faults(self, value: object, key: str) -> list[str]:
        return [f"{key}{fault}" for fault in _matrix_faults(value, self)]

    def read(self, value: Any) -> Array:
        return symmetric(value)


def _matrix_faults(value: object, kind: SquareMatrix) -> list[str]:
    """Faults of a matrix from a file.

    Each is a text such as "[1,2] = …", which continues the key of the matrix in a message.
    """
    faults = _shape_faults(value, kind)
    if faults:
        return faults
    matrix = np.array(value, dtype=float)
    if kind.compliance and (fault := _stiffness_fault(matrix)):
        return [fault]
    faults = [
        (
            f"[{a.row},{a.column}] = {a.lower!r}, [{a.column},{a.row}] = {a.upper!r}: must be "
            f"equal, because the matrix is symmetric (within {SYMMETRY_TOLERANCE:g} of the "
            "diagonal, to allow for rounding to seven digits)"
        )
        for a in asymmetries(matrix)
    ]
    faults += _diagonal_faults(matrix, kind)
    if not faults and not is_positive_definite(matrix):
        smallest = smallest_eigenvalue(matrix)
        faults.append(
            f": smallest eigenvalue {smallest:.3g}: the matrix must be positive definite, or some "
            "load would do negative work"
            if kind.compliance
            else f": smallest principal moment {smallest:.3g} kg m²: all three must be above 0, or "
            "some rotation would have negative energy"
        )
    return faults


def _shape_faults(value: object, kind: SquareMatrix) -> list[str]:
    n = kind.size
    rows = value if isinstance(value, list) else []
    if [len(row) for row in rows if isinstance(row, list)] != [n] * n or len(rows) != n:
        return [f": must be {n} rows of {n} numbers in {kind.unit}"]
    return [
        f"[{i},{j}] = {shown(entry)}: must be a finite number in {kind.unit}"
        for i, row in enumerate(rows, start=1)
        for j, entry in enumerate(row, start=1)
        if not is_finite_number(entry)
    ]


def _diagonal_faults(matrix: Array, kind: SquareMatrix) -> list[str]:
    rules = _DIAGONAL if kind.compliance else (_INERTIA,) * kind.size
    entries = enumerate(zip(rules, np.diag(matrix).tolist(), strict=True), start=1)
    return [fault for i, (rule, entry) in entries for fault in rule.faults(entry, f"[{i},{i}]")]


def _stiffness_fault(matrix: Array) -> str:
    """Error message for a stiffness matrix in place of a compliance. "" for other matrices.

    It is reported in place of the faults of single entries.
    """
    diagonal = np.diag(matrix)
    above = np.flatnonzero(diagonal > LARGEST_COMPLIANCE)
    if len(above) < _ENTRIES_OF_A_STIFFNESS:
        return ""
    largest = int(np.argmax(diagonal)) + 1
    return (
        f": {len(above)} of 6 entries on the diagonal are above {LARGEST_COMPLIANCE:g} m/N or "
        f"rad/(N m), [{largest},{largest}] = {diagonal[largest - 1]:.3g} the most: is this a "
        "stiffness matrix? This key needs its inverse, the compliance"
    )
