"""Huang's equation for the clamped–free Timoshenko beam, its roots found in a second way."""

from math import pi

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from fem.beams.beam_theory import Plane, bending_frequencies
from lumped.arrays import Array
from lumped.legs import BeamProperties
from validation.case import Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.program.benchmarks.beams import SECTION
from validation.context import Context
from validation.models.legs import constant_leg_of

CITATION = "T. C. Huang, J. Appl. Mech. 28 (1961) 579; Legendre–Ritz solution of the same beam"
PLANES: tuple[Plane, ...] = ("y", "z")
MODES = 3
# Of the polynomials in Ritz's method.
_DEGREE = 20


cases = CaseGroup(section=SECTION)


@cases.case(
    "benchmark.huang.leg{number}[{plane}{order}]",
    "Leg {number}: root {order} of Huang's equation, bending {plane}",
    over={"number": (1, 2), "plane": PLANES, "order": range(1, MODES + 1)},
    quantity="natural frequency {order} of bending {plane}, clamped-free Timoshenko beam",
    unit="Hz",
    reference_kind="independent-solver",
    citation=CITATION,
    tolerance=Relative(1e-7),
    tolerance_reason="both are exact but for rounding, which the Ritz matrices of a slender leg "
    "grow by the square of its slenderness times the fourth power of the degree",
    group="benchmark.huang.{number}",
)
def _roots(context: Context, number: int, plane: Plane, order: int) -> Measurement:
    leg = constant_leg_of(context, f"leg{number}")
    roots = context.get(bending_frequencies, leg.timoshenko, leg.length, plane, MODES)
    ritz, lower = (
        context.get(ritz_frequencies, leg.timoshenko, leg.length, plane, MODES, degree)[order - 1]
        for degree in (_DEGREE, _DEGREE - 2)
    )
    return Measurement(
        float(roots[order - 1]),
        float(ritz),
        # Ritz's frequencies fall geometrically: the last two degrees change more than is left.
        reference_uncertainty=float(abs(ritz - lower)),
    )


def ritz_frequencies(
    properties: BeamProperties, length: float, plane: Plane, count: int, degree: int = _DEGREE
) -> Array:
    """Clamped–free Timoshenko bending (Hz) with w and θ polynomials of `degree`, by Ritz.

    With ξ = x/L, s = EI/κGA L², r = ρI/μL² the stationary values of
    [∫ θ′² + (w′ − θ)²/s dξ] / [∫ w² + r θ² dξ] are ω² μL⁴/EI.
    """
    p = properties
    EI, GA, rho_I = (p.EIy, p.GAz, p.rho_Iy) if plane == "y" else (p.EIz, p.GAy, p.rho_Iz)
    points, weights = legendre.leggauss(degree + 2)
    xi, weights = (points + 1.0) / 2.0, weights / 2.0
    # ξ times Legendre's polynomials: zero at the clamp, well conditioned.
    plain = legendre.legvander(points, degree - 1)
    slope = 2.0 * legendre.legval(points, legendre.legder(np.eye(degree))).T
    u, du, none = xi[:, None] * plain, plain + xi[:, None] * slope, np.zeros_like(plain)

    def integral(field: Array) -> Array:
        square: Array = (field * weights[:, None]).T @ field
        return square

    shear = integral(np.hstack([du, -u])) * GA * length**2 / EI
    stiffness = integral(np.hstack([none, du])) + shear
    mass = integral(np.hstack([u, none]))
    mass += integral(np.hstack([none, u])) * rho_I / (p.mu * length**2)
    inverse = eigh(mass, stiffness, eigvals_only=True)[::-1][:count]
    frequencies: Array = np.sqrt(EI / (p.mu * inverse)) / (2.0 * pi * length**2)
    return frequencies
