"""Lateral buckling of legs with shear: closed forms, a solid by Ritz's method, invariance."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.polynomial import legendre
from prismatic_legs import STEEL
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq

from fem.beams.prestressed import PrestressedLeg, prestressed_leg
from lumped.arrays import dense
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle

ALL = 10_000
NOTHING = np.zeros(12)
# Free twists of the ends: forks leave rotations about y and z, and one end slides along x.
FORKS = (4, 5, 6, 10, 11)
BENT = np.array([0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0])


def factor(leg: PrestressedLeg, ends, forces, spread=NOTHING) -> float:
    """Buckling factor of the forces on a leg with such free twists of its ends."""
    stiffness = dense(leg.matrices.stiffness)
    free = np.ix_(*2 * [[*ends, *range(12, len(stiffness))]])
    added = leg.geometric_stiffness(forces, spread)
    return float(-1.0 / eigh(added[free], stiffness[free], eigvals_only=True)[0])


def moment_of_solid(leg: ConstantLeg, degree: int) -> float:
    """Buckling moment of a solid bar of ν = 0 between forks by Ritz's method, no beam theory.

    Displacements U cos kx, V sin kx, W sin kx with polynomials U, V, W of the section, k = π/L:
    Green's strains under the stress z/Iy, every section free to warp and to distort.
    """
    section, k, material = leg.section, np.pi / leg.length, leg.material
    points, weights = legendre.leggauss(degree + 3)
    values = legendre.legvander(points, degree)
    slopes = legendre.legval(points, legendre.legder(np.eye(degree + 1))).T
    sides = 0.5 * np.array([section.width, section.height])
    weight = np.outer(weights, weights).ravel() * sides.prod()
    fields = np.zeros((3, 3, len(weight), 0))
    for component, (i, j) in product(range(3), product(range(degree + 1), repeat=2)):
        # Lateral bending and twist: V is even in y, U and W are odd.
        if i + j > degree + 1 or (component == 1) != (i % 2 == 0):
            continue
        column = np.zeros((3, 3, len(weight), 1))
        for order, (y, z, scale) in enumerate(
            ((values, values, 1.0), (slopes, values, sides[0]), (values, slopes, sides[1]))
        ):
            column[component, order, :, 0] = np.outer(y[:, i], z[:, j]).ravel() / scale
        fields = np.concatenate([fields, column], axis=3)
    (u, uy, uz), (v, vy, vz), (w, wy, wz) = fields

    def form(rows, weight):
        return rows.T @ (weight[:, None] * rows)

    stiffness = sum(form(rows, material.E * weight) for rows in (k * u, vy, wz))
    stiffness += sum(form(rows, material.G * weight) for rows in (uy + k * v, uz + k * w, vz + wy))
    stress = np.tile(points * sides[1], len(points)) * 12.0
    stress = stress / (section.width * section.height**3)
    geometric = k**2 * sum(form(rows, stress * weight) for rows in (u, v, w))
    return float(1.0 / eigh(geometric, stiffness, eigvals_only=True)[-1])


@pytest.mark.parametrize(("width", "solid_shift"), [(0.02, -0.0034), (0.04, -0.027)])
def test_shear_lowers_lateral_buckling_moment(width, solid_shift):
    """M² = GJ P/(1 + P/κGA), P = π²EI/L²: lateral bending with Engesser's shear (own derivation).

    From −φ′ M γ: γ = Mφ′/κGA leaves GJ − M²/κGA of the torsional stiffness. The solid confirms the
    sign; what it adds for wide sections is of fourth order in their sides.
    """
    material = Material.isotropic(2.1e11, 0.0, 7850.0)
    leg = ConstantLeg(0.3, Rectangle(width, 0.06), material)
    p, moments = leg.timoshenko, {}
    for theory in ("euler-bernoulli", "timoshenko"):
        bar = prestressed_leg(leg.properties(theory), leg.length, 16, ALL)
        moments[theory] = factor(bar, FORKS, BENT)
    euler = np.pi**2 * p.EIz / leg.length**2
    # What 16 elements leave of the fourth order: 4e-6.
    assert moments["euler-bernoulli"] == pytest.approx(np.sqrt(p.GJ * euler), rel=4e-5)
    due = np.sqrt(p.GJ * euler / (1.0 + euler / p.GAy))
    assert moments["timoshenko"] == pytest.approx(due, rel=4e-5)
    slender = replace(leg, length=20.0 * leg.length)
    # The torsion constant of the polynomials cancels: that of a slender bar is the same.
    scale = moment_of_solid(slender, 7) * slender.length / (np.sqrt(p.GJ * p.EIz) * np.pi)
    shift = moment_of_solid(leg, 7) / (scale * np.sqrt(p.GJ * euler)) - 1.0
    assert shift == pytest.approx(solid_shift, abs=1.5e-3)
    beam = moments["timoshenko"] / moments["euler-bernoulli"] - 1.0
    assert 0.5 * shift > beam > 2.0 * shift


# Consistent forces and moments (Q, QL) of a load Q at root and tip, its lever, and Q L²/√(EI GJ):
# uniform (Timoshenko & Gere 1961, §6.3), and growing from zero at the root, by own shooting of
# φ″ + M(x)² φ/(EI GJ) = 0, φ(0) = φ′(L) = 0, M = Q (2/3 − x + x³/3).
SPREAD = {
    "uniform": ((0.5, 0.5), (1 / 12, -1 / 12), 1 / 2, 12.85),
    "growing": ((0.3, 0.7), (1 / 15, -1 / 10), 2 / 3, None),
}


def growing_load_factor() -> float:
    """Q L²/√(EI GJ) of a cantilever under a load that grows linearly from its root."""

    def slope_at_tip(load: float) -> float:
        def rates(x, state):
            moment = load * (2.0 / 3.0 - x + x**3 / 3.0)
            return state[1], -(moment**2) * state[0]

        return float(solve_ivp(rates, (0.0, 1.0), (0.0, 1.0), rtol=1e-9, atol=1e-12).y[1, -1])

    return float(brentq(slope_at_tip, 2.0, 12.0, xtol=1e-9))


@pytest.mark.parametrize("shape", SPREAD)
@pytest.mark.parametrize("across", ["y", "z"])
def test_spread_load_across_a_blade_buckles_it(across, shape):
    thin, deep = 0.004, 0.1
    section = Rectangle(thin, deep) if across == "z" else Rectangle(deep, thin)
    p = ConstantLeg(1.0, section, STEEL).properties("euler-bernoulli")
    axis, about, sign = {"y": (1, 5, 1.0), "z": (2, 4, -1.0)}[across]
    forces, moments, lever, due = SPREAD[shape]
    leg = prestressed_leg(p, 1.0, 16, ALL)
    for direction in (1.0, -1.0):
        spread, reaction = np.zeros(12), np.zeros(12)
        spread[[axis, 6 + axis]] = direction * np.array(forces)
        spread[[about, 6 + about]] = sign * direction * np.array(moments)
        reaction[[axis, about]] = -direction, -lever * sign * direction
        load = factor(leg, range(6, 12), spread + reaction, spread)
        scale = np.sqrt(min(p.EIy, p.EIz) * p.GJ)
        # Published to four digits.
        assert load == pytest.approx((due or growing_load_factor()) * scale, rel=1e-3)


def test_lateral_buckling_of_reversed_leg_is_the_same():
    """Root and tip exchanged, a half turn about z; and the section turned by a right angle."""
    stout = ConstantLeg(0.2, Rectangle(0.02, 0.06), STEEL)
    lying = ConstantLeg(0.2, Rectangle(0.06, 0.02), STEEL)
    leg = prestressed_leg(stout.timoshenko, 0.2, 12, ALL)
    at_tip = np.array([0, 0, -1.0, 0, 0.2, 0, 0, 0, 1.0, 0, 0, 0])
    at_root = np.array([0, 0, 1.0, 0, 0, 0, 0, 0, -1.0, 0, -0.2, 0])
    along_y = np.array([0, -1.0, 0, 0, 0, -0.2, 0, 1.0, 0, 0, 0, 0])
    load = factor(leg, range(6, 12), at_tip)
    assert factor(leg, range(6), at_root) == pytest.approx(load, rel=1e-9)
    turned = prestressed_leg(lying.timoshenko, 0.2, 12, ALL)
    assert factor(turned, range(6, 12), along_y) == pytest.approx(load, rel=1e-9)


def test_lateral_buckling_converges_with_fourth_order():
    """Towards 32 elements, whose own error is 1 % of that of ten."""
    p, counts = ConstantLeg(0.2, Rectangle(0.02, 0.06), STEEL).timoshenko, [4, 6, 8, 10]
    at_tip = np.array([0, 0, -1.0, 0, 0.2, 0, 0, 0, 1.0, 0, 0, 0])
    loads = [factor(prestressed_leg(p, 0.2, n, ALL), range(6, 12), at_tip) for n in (*counts, 32)]
    errors = np.abs(np.array(loads[:-1]) / loads[-1] - 1.0)
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.3)
