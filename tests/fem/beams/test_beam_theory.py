"""Closed-form frequencies of cantilevers against published roots and Huang's own equation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from prismatic_legs import LEG_1

from fem.beams.beam_theory import (
    bending_frequencies,
    euler_bernoulli_roots,
    tension_frequencies,
    torsion_frequencies,
)
from lumped.legs import BeamProperties, ConstantLeg, Material
from lumped.sections import Rectangle


def huang_function(p: BeamProperties, L: float, plane: str, omega):
    """Huang's frequency equation of the clamped–free beam, J. Appl. Mech. 28 (1961) 579, Table 1.

    Divided by (1 + cosh bα), which is positive, so that its size stays moderate. Complex α takes
    care of frequencies above the cut-off, where cosh and sinh become cos and sin.
    """
    EI, GA, rho_I = (p.EIy, p.GAz, p.rho_Iy) if plane == "y" else (p.EIz, p.GAy, p.rho_Iz)
    b = np.asarray(omega, dtype=complex) * np.sqrt(p.mu * L**4 / EI)
    r2, s2 = rho_I / (p.mu * L**2), EI / (GA * L**2)
    root = np.sqrt((r2 - s2) ** 2 + 4.0 / b**2)
    alpha, beta = np.sqrt((root - r2 - s2) / 2.0), np.sqrt((root + r2 + s2) / 2.0)
    value = (
        2.0
        + (b**2 * (r2 - s2) ** 2 + 2.0) * np.cosh(b * alpha) * np.cos(b * beta)
        - b * (r2 + s2) / np.sqrt(1.0 - b**2 * r2 * s2) * np.sinh(b * alpha) * np.sin(b * beta)
    )
    return (value / (1.0 + np.abs(np.cosh(b * alpha)))).real


def square_leg(slenderness: float) -> ConstantLeg:
    steel = Material.isotropic(2.1e11, 0.3, 7850.0)
    return ConstantLeg(slenderness * 0.1, Rectangle(0.1, 0.1), steel)


def test_euler_bernoulli_roots_are_the_tabulated_ones():
    # Young and Felgar, Tables of Characteristic Functions (1949): cos x cosh x = −1.
    tabulated = [1.8751041, 4.6940911, 7.8547574, 10.9955407, 14.1371684]
    roots = euler_bernoulli_roots(300)
    assert_allclose(roots[:5], tabulated, atol=6e-8)
    # 1/cosh x is below rounding from the twelfth root on; the 300th would overflow cosh itself.
    odd = (2.0 * np.arange(12, 301) - 1.0) * np.pi / 2.0
    assert_allclose(roots[11:], odd, rtol=1e-14)


@pytest.mark.parametrize("plane", ["y", "z"])
@pytest.mark.parametrize("leg", [LEG_1, square_leg(1.0)])
def test_timoshenko_frequencies_are_all_the_roots_of_huang_s_equation(leg, plane):
    p, L = leg.timoshenko, leg.length
    omega = 2.0 * np.pi * bending_frequencies(p, L, plane, 20)
    # The cut-off of the second spectrum, √(κGA/ρI), lies below the 20th root of these legs.
    cut_off = np.sqrt((p.GAz / p.rho_Iy) if plane == "y" else (p.GAy / p.rho_Iz))
    assert omega[0] < cut_off < omega[-1]
    # Each is a root: the sign changes within 1e-9 of it; and there are no others in between.
    below = huang_function(p, L, plane, omega * (1.0 - 1e-9))
    above = huang_function(p, L, plane, omega * (1.0 + 1e-9))
    assert np.all(np.sign(below) == -np.sign(above))
    scan = huang_function(p, L, plane, np.linspace(0.5 * omega[0], omega[-1] * 1.000001, 50_001))
    assert np.count_nonzero(np.diff(np.sign(scan))) == 20


def test_tension_and_torsion_are_odd_quarter_waves():
    # Steel bar of 1 m: √(E/ρ)/4L = 5172.2/4 Hz; torsion slower by √(GJ/E(Iy + Iz)).
    leg = square_leg(10.0)
    p = leg.timoshenko
    tension = tension_frequencies(p, 1.0, 3)
    assert_allclose(tension, 1293.05 * np.array([1.0, 3.0, 5.0]), rtol=1e-5)
    # Square: J = 0.140577 b⁴ (Timoshenko and Goodier, §109), polar moment b⁴/6.
    slower = np.sqrt(0.140577 * 6.0 / 2.6)
    assert_allclose(torsion_frequencies(p, 1.0, 3), slower * tension, rtol=5e-6)
