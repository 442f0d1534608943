"""Residual modes: how what a reduction drops gives way to given forces, and what that leaves open.

Z = A F less its share of the modes that are kept is Σ φ_k pᵀ/λ_k over the dropped ones, p = Fᵀφ_k:
their static response to the forces F. W = (MZ)ᵀ A (MZ) = Σ p pᵀ/λ_k³ is known without them.
"""

import numpy as np
from scipy.linalg import eigh

from fem.reduction.held import Swinging
from lumped.arrays import Array, fix_signs
from lumped.dense.modes import Modes

# Residual modes with less than this of the forces' work are rounding error.
_NO_RESIDUAL = 1e-11


def residual_modes(body: Swinging, forces: Array, modes: Modes) -> tuple[Modes, Array]:
    """Ritz modes of the dropped modes' static response to `forces` F (n×k), and W (k×k).

    `modes` are those that are kept.
    """
    mass_shapes = body.mass @ modes.shapes
    loads = forces - mass_shapes @ (modes.shapes.T @ forces)
    response = _without(modes, mass_shapes, body.flexibility(loads))
    inertia = body.mass @ response
    truncated = inertia.T @ _without(modes, mass_shapes, body.flexibility(inertia))
    stiffness, mass = loads.T @ response, response.T @ inertia
    scale = 1.0 / np.sqrt(np.einsum("ij,ij->j", forces, body.flexibility(forces)))
    values, vectors = eigh(_symmetric(stiffness) * scale[:, None] * scale)
    kept = values > _NO_RESIDUAL
    basis = scale[:, None] * vectors[:, kept] / np.sqrt(values[kept])
    inverse_squares, amplitudes = eigh(basis.T @ _symmetric(mass) @ basis)
    inverse_squares, amplitudes = inverse_squares[::-1], amplitudes[:, ::-1]
    shapes = fix_signs(response @ (basis @ amplitudes) / np.sqrt(inverse_squares))
    frequencies = 1.0 / (2.0 * np.pi * np.sqrt(inverse_squares))
    return Modes(frequencies, shapes), _symmetric(truncated)


def _without(modes: Modes, mass_shapes: Array, displacement: Array) -> Array:
    rest: Array = displacement - modes.shapes @ (mass_shapes.T @ displacement)
    return rest


def _symmetric(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))
