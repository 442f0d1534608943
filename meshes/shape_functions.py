"""Scalar shape functions of all types of elements.

They are taken from scikit-fem and returned in the node order of `meshes.elements`.
"""

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
    """Index in scikit-fem of each node in `meshes.elements`, found by comparing coordinates."""
    theirs = np.asarray(_SKFEM[element].doflocs)
    return [int(np.argmin(np.abs(theirs - node).sum(axis=1))) for node in ELEMENTS[element].nodes]


def values(element: ElementName, points: Array) -> Array:
    """Values of the k shape functions (k×Q) at reference coordinates `points` (d×Q)."""
    skfem = _SKFEM[element]
    return np.array([skfem.lbasis(points, i)[0] for i in _skfem_numbers(element)])


def gradients(element: ElementName, points: Array) -> Array:
    """Gradients ∂N/∂ξ (k×d×Q) of the k shape functions at reference coordinates `points` (d×Q)."""
    skfem = _SKFEM[element]
    return np.array([skfem.lbasis(points, i)[1] for i in _skfem_numbers(element)])


def quadrature(element: ElementName, degree: int) -> tuple[Array, Array]:
    """Points (d×Q) and weights (Q) of a quadrature on the reference cell, exact up to `degree`.

    The degree is the total degree of a polynomial on simplices, and the degree in each coordinate
    on squares and cubes.
    """
    points, weights = get_quadrature(_SKFEM[element].refdom, degree)
    return np.asarray(points), np.asarray(weights)
