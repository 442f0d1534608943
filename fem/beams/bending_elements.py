"""Beam elements for scikit-fem: bending with shear deformation, exact for loads at the nodes.

Bending elements have two fields: the deflection w and the rotation θ of the section, with the shear
strain γ = w′ − θ. An element that is loaded only at its ends satisfies M′ + V = 0 with constant V,
that is

    w cubic,   γ = −Λ w‴,   θ = w′ + Λ w‴,   Λ = EI/κGA.

The four such pairs (w, θ), determined by their end values, contain every static solution under
nodal loads: the element is exact at the nodes and free of shear locking. Λ = 0 is Hermite's element
(Euler, Bernoulli).
"""

from typing import Any

import numpy as np
from skfem import Element
from skfem.element import DiscreteField
from skfem.refdom import RefLine

from lumped.arrays import Array


class ElementLineBeam(Element):  # type: ignore[misc]  # scikit-fem has no types
    """Beam element whose unknowns are the end values of deflection w (m) and rotation θ (rad).

    Its fields are the static solutions for loads at the ends. `shear_length_squared` is Λ (m²). The
    basis functions are written about the middle of the element: the global monomials of
    scikit-fem's ElementGlobal would lose digits in proportion to (x/l)³ along the beam.
    """

    nodal_dofs = 2
    maxdeg = 3
    dofnames: tuple[str, ...] = ("w", "theta")
    doflocs = np.array([[0.0], [0.0], [1.0], [1.0]])
    refdom = RefLine

    def __init__(self, shear_length_squared: float) -> None:
        self.shear_length_squared = shear_length_squared

    def gbasis(
        self, mapping: Any, X: Array, i: int, tind: Any = None
    ) -> tuple[DiscreteField, DiscreteField]:
        """Fields w and θ of basis function `i` at the reference points `X`.

        The arguments are those of scikit-fem's `Element.gbasis`.
        """
        s, l = _from_middle(mapping, X, tind)
        w1, theta1, w2, theta2 = np.eye(4)[i]
        # w = w0 + w0′ s + κ s²/2 + q s³/6. The coefficients follow from the end values.
        phi = 12.0 * self.shear_length_squared / l**2
        q = 12.0 / l**3 * ((w1 - w2) + 0.5 * l * (theta1 + theta2)) / (1.0 + phi)
        kappa = (theta2 - theta1) / l
        slope = (w2 - w1) / l - q * l**2 / 24.0
        middle = 0.5 * (w1 + w2) - kappa * l**2 / 8.0
        gradient = slope + s * (kappa + s * q / 2.0)
        w = middle + s * (slope + s * (kappa / 2.0 + s * q / 6.0))
        theta = gradient + self.shear_length_squared * q
        return discrete_field(w, gradient), discrete_field(theta, kappa + s * q)


class ElementLineShearBeam(ElementLineBeam):
    """Beam element with two additional unknowns inside, for vibration with shear deformation.

    The fields of these unknowns make it possible to satisfy M′ + V = −ω²ρI θ and V′ = −ω²μ w
    approximately. The first field is a parabolic deflection by shear alone, with linear γ. The
    second is a parabolic rotation with the cubic deflection for which γ is constant. Without them γ
    is coupled to w‴, and the frequencies of a Timoshenko beam converge with second order in l. With
    them the order is four. Both fields vanish at the nodes and do no work on the static solutions,
    which remain unchanged.
    """

    interior_dofs = 2
    dofnames = ("w", "theta", "shear", "rotation")
    doflocs = np.array([[0.0], [0.0], [1.0], [1.0], [0.5], [0.5]])

    def gbasis(
        self, mapping: Any, X: Array, i: int, tind: Any = None
    ) -> tuple[DiscreteField, DiscreteField]:
        """Fields w and θ of basis function `i` at the reference points `X`.

        The arguments are those of scikit-fem's `Element.gbasis`.
        """
        if i < 4:
            return super().gbasis(mapping, X, i, tind)
        s, l = _from_middle(mapping, X, tind)
        parabola, slope = 1.0 - 4.0 * (s / l) ** 2, -8.0 * s / l**2
        if i == 4:
            return discrete_field(parabola, slope), discrete_field(0.0 * s, 0.0 * s)
        w = s * parabola / 3.0
        return discrete_field(w, parabola - 2.0 / 3.0), discrete_field(parabola, slope)


def _from_middle(mapping: Any, X: Array, tind: Any) -> tuple[Array, Array]:
    """Distances of the points `X` from the middle, and element lengths (m, elements × points)."""
    l = mapping.detDF(X, tind)
    return l * (X[0] - 0.5), l


def discrete_field(value: Array, gradient: Array) -> DiscreteField:
    """Field of scikit-fem with its values and its derivative along the element."""
    return DiscreteField(value=value, grad=gradient[None])
