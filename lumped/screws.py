"""Twists and wrenches: transformations between points and frames, and descriptions in words.

A twist (or small displacement) is [x y z φx φy φz] (m, rad), a wrench is [Fx Fy Fz Mx My Mz] (N,
N m). Their product, the work, does not depend on the reference point or the axes. Twists and
wrenches are screws: each consists of a vector u along a line (rotation or force) and a vector w at
the reference point (translation or moment). The line passes through r = u × w / |u|², measured from
the reference point. The pitch of the screw is u·w / |u|².
"""

import numpy as np

from lumped.arrays import Array

# Components of a unit vector, and fractions of the length scale, are written as zero below this.
_ZERO = 1e-6


def skew(vector: Array) -> Array:
    """Matrices S (…×3×3) with S u = v × u for each of the vectors v (`vector`, …×3)."""
    v = np.asarray(vector, dtype=float)
    matrix = np.zeros((*v.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    return matrix - np.swapaxes(matrix, -1, -2)


def shift(offset: Array) -> Array:
    """Matrix X (…×6×6) with twist_B = X twist_A for two points A and B of one rigid body.

    `offset` (…×3) is the vector B − A (m), in the axes of the twists. The transpose transforms
    wrenches from B to A, wrench_A = Xᵀ wrench_B, without a change of the work.
    """
    arm = skew(offset)
    matrix = np.zeros((*arm.shape[:-2], 6, 6))
    matrix[...] = np.eye(6)
    matrix[..., :3, 3:] = -arm
    return matrix


def turn(rotation: Array) -> Array:
    """Matrix D = diag(R, R) (…×6×6) of eq. (14): twist in base axes = D · twist in local axes.

    The columns of `rotation` R (…×3×3) are the local axes in base axes.
    """
    matrix = np.zeros((*np.shape(rotation)[:-2], 6, 6))
    matrix[..., :3, :3] = rotation
    matrix[..., 3:, 3:] = rotation
    return matrix


def rotation_z(angle: float) -> Array:
    """3×3 matrix of a right-handed rotation about z by `angle` (rad)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_about(vector: Array) -> Array:
    """Rotation matrices (…×3×3) of rotation vectors (…×3, in rad), by Rodrigues' formula."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None] / np.pi
    cross = skew(vector)
    matrix: Array = np.sinc(angle) * cross + 0.5 * np.sinc(0.5 * angle) ** 2 * cross @ cross
    return np.eye(3) + matrix


def rotation_vector(rotation: Array) -> Array:
    """Rotation vectors (…×3, in rad, of length up to π) of rotation matrices (…×3×3).

    They are computed from the unit quaternion q = (w, x, y, z). The matrix 4 q qᵀ is linear in the
    rotation matrix, and each of its rows is proportional to q. The row with the largest diagonal
    entry is used (S. W. Shepperd, J. Guid. Control 1 (1978) 223).
    """
    r = np.asarray(rotation, dtype=float)
    trace = np.trace(r, axis1=-2, axis2=-1)
    transposed = np.swapaxes(r, -1, -2)
    outer = np.empty((*trace.shape, 4, 4))
    outer[..., 0, 0] = 1.0 + trace
    outer[..., 0, 1:] = (r - transposed)[..., [2, 0, 1], [1, 2, 0]]
    outer[..., 1:, 0] = outer[..., 0, 1:]
    outer[..., 1:, 1:] = r + transposed + (1.0 - trace)[..., None, None] * np.eye(3)
    largest = np.argmax(np.einsum("...ii->...i", outer), axis=-1)
    row = np.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    w, axis = np.abs(row[..., :1]), np.where(row[..., :1] < 0.0, -1.0, 1.0) * row[..., 1:]
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    stretched: Array = axis * np.divide(
        2.0 * np.arctan2(sine, w), sine, out=2.0 / np.maximum(w, 1.0), where=sine > 0.0
    )
    return stretched


def move_compliance(compliance: Array, offset: Array) -> Array:
    """6×6 compliance at a point B from the 6×6 `compliance` at a point A of the same rigid body.

    `offset` (3) is the vector B − A (m).
    """
    adjoint = shift(offset)
    return adjoint @ compliance @ adjoint.T


def turn_matrix(matrix: Array, rotation: Array) -> Array:
    """Compliance or stiffness D C Dᵀ (…×6×6) in base axes, from `matrix` C in local axes.

    The columns of `rotation` (…×3×3) are the local axes in base axes, as in `turn`.
    """
    block = turn(rotation)
    return block @ matrix @ np.swapaxes(block, -1, -2)


def name_twists(twists: Array, length: float) -> str:
    """Description in words of the motions spanned by `twists` (n×6, base axes).

    A basis with few nonzero components is described, for example "translate along x and turn about
    z through (0, 0.5, 0) m from the loaded point". `length` (m) is the size of the mechanism.
    """
    screws = np.hstack([twists[:, 3:], twists[:, :3] / length])
    return _described(screws, length, "turn about", "translate along")


def name_wrenches(wrenches: Array, length: float) -> str:
    """Description in words of the loads spanned by `wrenches` (n×6, base axes).

    `length` (m) is the size of the mechanism. Examples: "a force along x through the loaded point",
    "a moment about z".
    """
    screws = np.hstack([wrenches[:, :3], wrenches[:, 3:] / length])
    return _described(screws, length, "a force along", "a moment about")


def _described(screws: Array, length: float, line: str, moment: str) -> str:
    """Description in words of the `screws` (n×6: first u, then w, as in the module docstring).

    Lengths in w are divided by `length` (m). `line` is the phrase for screws with a line, such as
    "turn about". `moment` is the phrase for screws without a line (u = 0), such as "translate
    along".
    """
    return " and ".join(
        f"{line} {_direction(u)} through {_point(u, w, length)}{_pitch(u, w, length)}"
        if np.any(u)
        else f"{moment} {_direction(w)}"
        for u, w in _sparsest(screws)
    )


def _sparsest(screws: Array) -> list[tuple[Array, Array]]:
    """Basis of the span of `screws` (n×6) with few nonzero components, as pairs (u, w).

    It consists of the rows of the reduced row echelon form.
    """
    rows = screws / np.linalg.norm(screws, axis=1)[:, None]
    rank = 0
    for column in range(6):
        if rank == len(rows):
            break
        pivot = rank + int(np.argmax(np.abs(rows[rank:, column])))
        if abs(rows[pivot, column]) <= _ZERO:
            continue
        rows[[rank, pivot]] = rows[[pivot, rank]]
        rows[rank] /= rows[rank, column]
        other_rows = np.arange(len(rows)) != rank
        rows[other_rows] -= np.outer(rows[other_rows, column], rows[rank])
        rank += 1
    rows[np.abs(rows) <= _ZERO * np.abs(rows).max(axis=1)[:, None]] = 0.0
    return [(row[:3], row[3:]) for row in rows]


def _direction(vector: Array) -> str:
    unit = vector / np.linalg.norm(vector)
    unit = unit * np.sign(unit[np.argmax(np.abs(unit))])
    if np.count_nonzero(np.abs(unit) > _ZERO) == 1:
        return "xyz"[int(np.argmax(unit))]
    return _triple(unit)


def _point(u: Array, w: Array, length: float) -> str:
    offset = np.cross(u, w) / (u @ u)
    if np.linalg.norm(offset) <= _ZERO:
        return "the loaded point"
    return f"{_triple(offset * length)} m from the loaded point"


def _pitch(u: Array, w: Array, length: float) -> str:
    pitch = (u @ w) / (u @ u)
    return "" if abs(pitch) <= _ZERO else f" with a pitch of {pitch * length:.3g} m/rad"


def _triple(vector: Array) -> str:
    rounded = np.where(np.abs(vector) <= _ZERO * np.abs(vector).max(), 0.0, vector)
    return "(" + ", ".join(f"{value:.3g}" for value in rounded) + ")"
