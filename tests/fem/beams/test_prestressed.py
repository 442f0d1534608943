"""Buckling and vibration of one loaded leg against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from fem.beams.prestressed import PrestressedLeg, prestressed_leg
from lumped.arrays import dense
from lumped.legs import BeamProperties, ConstantLeg, Material
from lumped.sections import Rectangle

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Stocky, so that shear matters, and softer along y than along z.
COLUMN = ConstantLeg(0.5, Rectangle(width=0.05, height=0.12), STEEL)
L = COLUMN.length
ALL = 10_000
# Free twists of root and tip along y and about z.
ENDS = {
    "fixed-free": (7, 11),
    "pinned-pinned": (5, 11),
    "fixed-fixed": (),
    "fixed-pinned": (11,),
}
PUSH = np.array([1.0, 0, 0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0])
NOTHING = np.zeros(12)


def loose(leg: PrestressedLeg, ends: tuple[int, ...]) -> np.ndarray:
    """Numbers of the unknowns that such ends leave."""
    return np.r_[np.array(ends, dtype=int), 12 : leg.matrices.stiffness.shape[0]]


def factor(leg: PrestressedLeg, ends, forces, spread=NOTHING) -> float:
    """How many times the forces buckle it."""
    free = np.ix_(loose(leg, ends), loose(leg, ends))
    added = leg.geometric_stiffness(forces, spread)
    return -1.0 / eigh(added[free], dense(leg.matrices.stiffness)[free], eigvals_only=True)[0]


def critical(p: BeamProperties, ends: str) -> float:
    """Euler's loads, Engesser's where sections shear."""
    if ends == "fixed-pinned":
        # θ = H/P (cos kL − 1 + …), ∫ w′ = 0: tan kL = kL (1 − P/κGA), P = EI k²/(1 + EI k²/κGA).
        def load(k: float) -> float:
            return p.EIz * k**2 / (1.0 + p.EIz * k**2 / p.GAy)

        def left(k: float) -> float:
            return np.sin(k * L) - k * L * (1.0 - load(k) / p.GAy) * np.cos(k * L)

        return load(brentq(left, 3.2 / L, 4.6 / L, xtol=1e-14))
    times = {"fixed-free": 0.25, "pinned-pinned": 1.0, "fixed-fixed": 4.0}[ends]
    euler = times * np.pi**2 * p.EIz / L**2
    return euler / (1.0 + euler / p.GAy)


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize("ends", ENDS)
def test_columns_buckle_at_eulers_loads_and_engessers(ends, theory):
    p = COLUMN.properties(theory)
    due = critical(p, ends)
    if theory == "euler-bernoulli":
        euler = np.pi**2 * p.EIz / L**2
        known = {"fixed-free": 0.25, "pinned-pinned": 1.0, "fixed-fixed": 4.0}
        assert due == pytest.approx(euler * known.get(ends, 2.04575), rel=1e-5)
    own = prestressed_leg(p, L, 10, ALL), prestressed_leg(p, L, 10, 24)
    assert factor(own[0], ENDS[ends], PUSH) == pytest.approx(due, rel=3e-4)
    assert factor(own[1], ENDS[ends], PUSH) == pytest.approx(due, rel=1e-3)
    # Never below: Ritz.
    assert factor(own[0], ENDS[ends], PUSH) >= due * (1.0 - 1e-9)


def test_they_converge_with_the_fourth_power():
    p = COLUMN.timoshenko
    counts = np.array([6, 8, 12, 16])
    due = critical(p, "fixed-fixed")
    errors = [factor(prestressed_leg(p, L, n, ALL), (), PUSH) / due - 1.0 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.15)


def test_a_force_along_a_leg_tunes_it_as_a_string():
    """f = f₀ √(1 + N L²/π²EI), pinned ends, exact without shear and rotary inertia."""
    p = COLUMN.properties("euler-bernoulli")
    leg = prestressed_leg(p, L, 10, ALL)
    free = np.ix_(loose(leg, (5, 11)), loose(leg, (5, 11)))
    euler = np.pi**2 * p.EIz / L**2
    for tension in (0.5 * euler, -0.7 * euler):
        stiffness = leg.matrices.stiffness + leg.geometric_stiffness(-tension * PUSH, NOTHING)
        square = eigh(stiffness[free], leg.matrices.mass[free], eigvals_only=True)[0]
        due = np.pi**4 * p.EIz / (p.mu * L**4) * (1.0 + tension / euler)
        assert square == pytest.approx(due, rel=1e-4)


def test_a_column_buckles_under_its_own_weight():
    """Q L²/EI = 7.8373 (Greenhill): the force grows along the leg. The ground carries all of it."""
    p = COLUMN.properties("euler-bernoulli")
    leg = prestressed_leg(p, L, 10, ALL)
    half = np.array([-0.5, 0, 0, 0, 0, 0])
    spread = np.r_[half, half]
    found = factor(leg, (7, 11), spread + np.r_[-2.0 * half, 0.0 * half], spread)
    assert found == pytest.approx(7.837347 * p.EIz / L**2, rel=1e-4)


def test_thin_walls_twist_under_pressure():
    """Wagner: P = GJ/i², however long."""
    strip = ConstantLeg(0.08, Rectangle(width=0.004, height=0.1), STEEL)
    p = strip.timoshenko
    leg = prestressed_leg(p, strip.length, 6, ALL)
    assert factor(leg, (9,), PUSH) == pytest.approx(p.GJ * p.mu / p.rho_J, rel=1e-9)


@pytest.fixture(scope="module")
def blade() -> tuple[BeamProperties, PrestressedLeg]:
    p = ConstantLeg(1.0, Rectangle(width=0.004, height=0.1), STEEL).properties("euler-bernoulli")
    return p, prestressed_leg(p, 1.0, 16, ALL)


def test_a_blade_buckles_sideways(blade):
    """Prandtl, Michell: P L²/√(EI GJ) = 4.0126 at the tip, M L/√(EI GJ) = π between forks."""
    p, leg = blade
    scale = np.sqrt(p.EIz * p.GJ)
    tip = np.array([0, 0, -1.0, 0, 1.0, 0, 0, 0, 1.0, 0, 0, 0])
    assert factor(leg, (6, 7, 8, 9, 10, 11), tip) == pytest.approx(4.0126 * scale, rel=1e-3)
    bent = np.array([0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0])
    assert factor(leg, (4, 5, 6, 10, 11), bent) == pytest.approx(np.pi * scale, rel=1e-3)


def test_a_shaft_buckles_by_torque(blade):
    """tan(TL/2EI) = TL/2EI, T = 8.9868 EI/L, of a round shaft with clamped ends (Greenhill)."""
    p = replace(blade[0], EIy=blade[0].EIz)
    leg = prestressed_leg(p, 1.0, 16, ALL)
    twisted = np.array([0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0, 0])
    assert factor(leg, (), twisted) == pytest.approx(8.98682 * p.EIz, rel=1e-3)
