"""Twists and wrenches: how they move between points and frames.

A twist (or small displacement) is [x y z φx φy φz] (m, rad), a wrench [Fx Fy Fz Mx My Mz]
(N, N m). Moving the reference point or turning the axes keeps the work wrench · twist.
"""

import numpy as np

from lumped.arrays import Array


def skew(vector: Array) -> Array:
    """3×3 matrix S with S u = vector × u."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def shift(offset: Array) -> Array:
    """6×6 X with twist_B = X twist_A for two points of one rigid body.

    `offset` is B − A (m), in the axes of the twists. Wrenches go the other way by the
    transpose: wrench_A = Xᵀ wrench_B, which keeps the work.
    """
    matrix = np.eye(6)
    matrix[:3, 3:] = -skew(np.asarray(offset, dtype=float))
    return matrix


def turn(rotation: Array) -> Array:
    """6×6 D = diag(R, R) of eq. (14): twist in base axes = D · twist in local axes.

    `rotation` is the 3×3 matrix whose columns are the local axes in base axes.
    """
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = rotation
    matrix[3:, 3:] = rotation
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
    """6×6 compliance or stiffness in base axes from the same in local axes: D C Dᵀ."""
    block = turn(rotation)
    return block @ matrix @ block.T
