"""The bending elements of a prismatic beam, written for scikit-fem.

Two fields, the deflection w and the rotation θ of the section, with shear strain γ = w′ − θ. An
element whose ends alone are loaded obeys M′ + V = 0 with constant V, that is

    w cubic,   γ = −Λ w‴,   θ = w′ + Λ w‴,   Λ = EI/κGA,

so the four such pairs (w, θ), taken by their end values, hold every static solution under nodal
loads: exact at the nodes and free of shear locking. Λ = 0 is Hermite's element (Euler, Bernoulli).
"""

from typing import Any

import numpy as np
from skfem import Element
from skfem.element import DiscreteField
from skfem.refdom import RefLine

from lumped.arrays import Array


class ElementLineBeam(Element):  # type: ignore[misc]  # scikit-fem has no types
    """Static solutions of the beam with the end values of w (m) and θ (rad) as unknowns.

    `shear_length_squared` is Λ (m²). The basis is written about the element's own middle: the
    global monomials of scikit-fem's ElementGlobal lose digits as (x/l)³ along the beam.
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
        """Fields w and θ of basis function `i` at the reference points `X`."""
        s, l = _from_middle(mapping, X, tind)
        w1, theta1, w2, theta2 = np.eye(4)[i]
        # w = w0 + w0′ s + κ s²/2 + q s³/6, with the end conditions solved for the coefficients.
        phi = 12.0 * self.shear_length_squared / l**2
        q = 12.0 / l**3 * ((w1 - w2) + 0.5 * l * (theta1 + theta2)) / (1.0 + phi)
        kappa = (theta2 - theta1) / l
        slope = (w2 - w1) / l - q * l**2 / 24.0
        middle = 0.5 * (w1 + w2) - kappa * l**2 / 8.0
        gradient = slope + s * (kappa + s * q / 2.0)
        w = middle + s * (slope + s * (kappa / 2.0 + s * q / 6.0))
        theta = gradient + self.shear_length_squared * q
        return _field(w, gradient), _field(theta, kappa + s * q)


class ElementLineShearBeam(ElementLineBeam):
    """The same with two unknowns inside, so that M′ + V = −ω²ρI θ and V′ = −ω²μ w can be followed.

    The first is a deflection by shear alone, a parabola, with γ linear; the second a parabola of
    rotation with the cubic deflection that leaves γ constant. Without them γ is tied to w‴ and the
    frequencies of a Timoshenko beam are second order in l; with them they are fourth order. Both
    vanish at the nodes and do no work on the static solutions, which stay as they are.
    """

    interior_dofs = 2
    dofnames = ("w", "theta", "shear", "rotation")
    doflocs = np.array([[0.0], [0.0], [1.0], [1.0], [0.5], [0.5]])

    def gbasis(
        self, mapping: Any, X: Array, i: int, tind: Any = None
    ) -> tuple[DiscreteField, DiscreteField]:
        """Fields w and θ of basis function `i` at the reference points `X`."""
        if i < 4:
            return super().gbasis(mapping, X, i, tind)
        s, l = _from_middle(mapping, X, tind)
        parabola, slope = 1.0 - 4.0 * (s / l) ** 2, -8.0 * s / l**2
        if i == 4:
            return _field(parabola, slope), _field(0.0 * s, 0.0 * s)
        w = s * parabola / 3.0
        return _field(w, parabola - 2.0 / 3.0), _field(parabola, slope)


def _from_middle(mapping: Any, X: Array, tind: Any) -> tuple[Array, Array]:
    """Distance from the middle of the element and the element's length (m), elements × points."""
    l = mapping.detDF(X, tind)
    return l * (X[0] - 0.5), l


def _field(value: Array, gradient: Array) -> DiscreteField:
    return DiscreteField(value=value, grad=gradient[None])
