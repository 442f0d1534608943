"""Scalar shape functions of the element kinds, taken from scikit-fem, in our node order."""

import numpy as np
from skfem import (
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
)
from skfem.quadrature import get_quadrature

from lumped.arrays import Array
from meshes.elements import ELEMENTS, ElementName

_SKFEM = {
    "quad4": ElementQuad1(),
    "quad8": ElementQuadS2(),
    "quad9": ElementQuad2(),
    "tri3": ElementTriP1(),
    "tri6": ElementTriP2(),
    "hex8": ElementHex1(),
    "hex20": ElementHexS2(),
    "hex27": ElementHex2(),
    "tet4": ElementTetP1(),
    "tet10": ElementTetP2(),
}


def _skfem_numbers(element: ElementName) -> list[int]:
    """Number in scikit-fem of each of our local nodes, matched by their coordinates."""
    theirs = np.asarray(_SKFEM[element].doflocs)
    return [int(np.argmin(np.abs(theirs - node).sum(axis=1))) for node in ELEMENTS[element].nodes]


def values(element: ElementName, points: Array) -> Array:
    """Shape functions (k×Q) at reference `points` (d×Q), in our node order."""
    skfem = _SKFEM[element]
    return np.array([skfem.lbasis(points, i)[0] for i in _skfem_numbers(element)])


def gradients(element: ElementName, points: Array) -> Array:
    """Reference gradients ∂N/∂ξ (k×d×Q) at reference `points` (d×Q), in our node order."""
    skfem = _SKFEM[element]
    return np.array([skfem.lbasis(points, i)[1] for i in _skfem_numbers(element)])


def quadrature(element: ElementName, degree: int) -> tuple[Array, Array]:
    """Points (d×Q) and weights (Q) on the reference cell, exact for polynomials of `degree`.

    The degree is the total degree on simplices, and that of each coordinate on squares and cubes.
    """
    points, weights = get_quadrature(_SKFEM[element].refdom, degree)
    return np.asarray(points), np.asarray(weights)
