"""Twists and wrenches: how they move between points and frames.

A twist (or small displacement) is [x y z φx φy φz] (m, rad), a wrench [Fx Fy Fz Mx My Mz]
(N, N m). Moving the reference point or turning the axes keeps the work wrench · twist.
"""

import numpy as np

from lumped.arrays import Array


def skew(vector: Array) -> Array:
    """…×3×3 matrices S with S u = vector × u, of vectors …×3."""
    v = np.asarray(vector, dtype=float)
    matrix = np.zeros((*v.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    return matrix - np.swapaxes(matrix, -1, -2)


def shift(offset: Array) -> Array:
    """…×6×6 X with twist_B = X twist_A for two points of one rigid body.

    `offset` (…×3) is B − A (m), in the axes of the twists. Wrenches go the other way by the
    transpose: wrench_A = Xᵀ wrench_B, which keeps the work.
    """
    arm = skew(offset)
    matrix = np.zeros((*arm.shape[:-2], 6, 6))
    matrix[...] = np.eye(6)
    matrix[..., :3, 3:] = -arm
    return matrix


def turn(rotation: Array) -> Array:
    """…×6×6 D = diag(R, R) of eq. (14): twist in base axes = D · twist in local axes.

    `rotation` (…×3×3) is the matrix whose columns are the local axes in base axes.
    """
    matrix = np.zeros((*np.shape(rotation)[:-2], 6, 6))
    matrix[..., :3, :3] = rotation
    matrix[..., 3:, 3:] = rotation
    return matrix


def rotation_z(angle: float) -> Array:
    """3×3 rotation about z by `angle` (rad), right-handed."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def move_compliance(compliance: Array, offset: Array) -> Array:
    """6×6 compliance at B of the body whose compliance at A is given; `offset` = B − A (m)."""
    adjoint = shift(offset)
    return adjoint @ compliance @ adjoint.T


def turn_matrix(matrix: Array, rotation: Array) -> Array:
    """…×6×6 compliance or stiffness in base axes from the same in local axes: D C Dᵀ."""
    block = turn(rotation)
    return block @ matrix @ np.swapaxes(block, -1, -2)
