"""Buckling and vibration of one loaded leg against closed forms, and solids that CalculiX loads."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.linalg import eigh
from scipy.optimize import brentq

from fem.beams.prestressed import prestressed_leg
from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import PROGRAMS, calculix_program
from lumped.arrays import dense
from lumped.legs import BeamProperties, ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.prism import tetrahedra

# Stocky, so that shear matters, and softer along y than along z.
COLUMN = ConstantLeg(0.5, Rectangle(width=0.05, height=0.12), STEEL)
L = COLUMN.length
ALL = 10_000
# Free twists of root and tip along y and about z, and the load in those of a column between pins.
ENDS = {
    "fixed-free": ((7, 11), 0.25),
    "pinned-pinned": ((5, 11), 1.0),
    "fixed-fixed": ((), 4.0),
    "fixed-pinned": ((11,), 2.04575),
}
PUSH = np.array([1.0, 0, 0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0])
NOTHING = np.zeros(12)


def freed(leg, ends, forces, spread=NOTHING):
    """What the forces add to the stiffness, stiffness and mass, on what such ends leave free."""
    stiffness, mass = dense(leg.matrices.stiffness), dense(leg.matrices.mass)
    free = [*ends, *range(12, len(mass))]
    added = leg.geometric_stiffness(forces, spread)
    return [matrix[np.ix_(free, free)] for matrix in (added, stiffness, mass)]


def factor(leg, ends, forces, spread=NOTHING) -> float:
    """How many times the forces buckle it."""
    added, stiffness, _ = freed(leg, ends, forces, spread)
    return -1.0 / eigh(added, stiffness, eigvals_only=True)[0]


def critical(p: BeamProperties, ends: str) -> float:
    """Euler's loads, Engesser's where sections shear."""
    if ends != "fixed-pinned":
        euler = ENDS[ends][1] * np.pi**2 * p.EIz / L**2
        return euler / (1.0 + euler / p.GAy)

    # θ = H/P (cos kL − 1 + …), ∫ w′ = 0: tan kL = kL (1 − P/κGA), P = EI k²/(1 + EI k²/κGA).
    def load(k: float) -> float:
        return p.EIz * k**2 / (1.0 + p.EIz * k**2 / p.GAy)

    def left(k: float) -> float:
        return np.sin(k * L) - k * L * (1.0 - load(k) / p.GAy) * np.cos(k * L)

    return load(brentq(left, 3.2 / L, 4.6 / L, xtol=1e-14))


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize("ends", ENDS)
def test_columns_buckle_at_eulers_loads_and_engessers(ends, theory):
    p, (free, times) = COLUMN.properties(theory), ENDS[ends]
    due = critical(p, ends)
    if theory == "euler-bernoulli":
        assert due == pytest.approx(times * np.pi**2 * p.EIz / L**2, rel=1e-5)
    whole, few = (factor(prestressed_leg(p, L, 10, kept), free, PUSH) for kept in (ALL, 24))
    assert whole == pytest.approx(due, rel=3e-4)
    assert few == pytest.approx(due, rel=1e-3)
    # Never below: Ritz.
    assert whole >= due * (1.0 - 1e-9)


def test_they_converge_with_the_fourth_power():
    p, counts = COLUMN.timoshenko, [6, 8, 12, 16]
    due = critical(p, "fixed-fixed")
    errors = [factor(prestressed_leg(p, L, n, ALL), (), PUSH) / due - 1.0 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.15)


def test_a_force_along_a_leg_tunes_it_as_a_string():
    """f = f₀ √(1 + N L²/π²EI), pinned ends, exact without shear and rotary inertia."""
    p = COLUMN.properties("euler-bernoulli")
    added, stiffness, mass = freed(prestressed_leg(p, L, 10, ALL), ENDS["pinned-pinned"][0], PUSH)
    euler = np.pi**2 * p.EIz / L**2
    for tension in (0.5 * euler, -0.7 * euler):
        square = eigh(stiffness - tension * added, mass, eigvals_only=True)[0]
        due = np.pi**4 * p.EIz / (p.mu * L**4) * (1.0 + tension / euler)
        assert square == pytest.approx(due, rel=1e-4)


def test_a_column_buckles_under_its_own_weight():
    """Q L²/EI = 7.8373 (Greenhill): the force grows along the leg. The ground carries all of it."""
    p = COLUMN.properties("euler-bernoulli")
    half = np.array([-0.5, 0, 0, 0, 0, 0])
    spread = np.r_[half, half]
    at_ends = spread + np.r_[-2.0 * half, 0.0 * half]
    found = factor(prestressed_leg(p, L, 10, ALL), (7, 11), at_ends, spread)
    assert found == pytest.approx(7.837347 * p.EIz / L**2, rel=1e-4)


def test_thin_walls_twist_under_pressure():
    """Wagner: P = GJ/i², however long."""
    p = ConstantLeg(0.08, Rectangle(width=0.004, height=0.1), STEEL).timoshenko
    leg = prestressed_leg(p, 0.08, 6, ALL)
    assert factor(leg, (9,), PUSH) == pytest.approx(p.GJ * p.mu / p.rho_J, rel=1e-9)


def test_a_blade_buckles_sideways_and_a_shaft_by_torque():
    """P L²/√(EI GJ) = 4.0126 at the tip, M L/√(EI GJ) = π between forks (Prandtl, Michell).

    A round shaft with clamped ends: tan(TL/2EI) = TL/2EI, T = 8.9868 EI/L (Greenhill).
    """
    p = ConstantLeg(1.0, Rectangle(width=0.004, height=0.1), STEEL).properties("euler-bernoulli")
    leg, scale = prestressed_leg(p, 1.0, 16, ALL), np.sqrt(p.EIz * p.GJ)
    tip = np.array([0, 0, -1.0, 0, 1.0, 0, 0, 0, 1.0, 0, 0, 0])
    assert factor(leg, range(6, 12), tip) == pytest.approx(4.0126 * scale, rel=1e-3)
    bent = np.array([0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0])
    assert factor(leg, (4, 5, 6, 10, 11), bent) == pytest.approx(np.pi * scale, rel=1e-3)
    shaft = prestressed_leg(replace(p, EIy=p.EIz), 1.0, 16, ALL)
    twisted = np.array([0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0, 0])
    assert factor(shaft, (), twisted) == pytest.approx(8.98682 * p.EIz, rel=1e-3)


# A quarter of what buckles the column of solids below.
LOAD = 1.2e5
STEPS = """*STEP
*BUCKLE
2
*CLOAD
{node}, 1, -1.0
*END STEP
*STEP
*STATIC
*CLOAD, OP=NEW
{node}, 1, -{load}
*END STEP
*STEP, PERTURBATION
*FREQUENCY
2
*END STEP
"""


@pytest.mark.skipif(not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed")
def test_calculix_buckles_and_loads_the_same_column(tmp_path):
    column = ConstantLeg(0.8, Rectangle(0.05, 0.06), Material.isotropic(2.1e11, 0.0, 7850.0))
    mesh = tetrahedra(column.section, column.length, 1)
    deck = replace(leg_deck(mesh, column.material), load_cases=(), modes=0)
    text = deck_text(deck) + STEPS.format(node=deck.watched[0] + 1, load=LOAD)
    (tmp_path / "column.inp").write_text(text, encoding="ascii")
    program = [calculix_program(), "-i", "column"]
    subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    printed = (tmp_path / "column.dat").read_text(encoding="ascii")
    buckled, _, vibrating = printed.partition("E I G E N V A L U E   O U T P U T")
    factors = re.findall(r"^ +\d+ +(\S+E\S+) *$", buckled, re.MULTILINE)
    squares = re.findall(r"^ +\d+ +(\S+E\S+) ", vibrating, re.MULTILINE)
    leg = prestressed_leg(column.timoshenko, column.length, 10, ALL)
    added, stiffness, mass = freed(leg, range(6, 12), LOAD * PUSH)
    own = -LOAD / eigh(added, stiffness, eigvals_only=True)[:2]
    assert [float(one) for one in factors[:2]] == pytest.approx(own, rel=3e-3)
    own = eigh(stiffness + added, mass, eigvals_only=True)[:2]
    assert [float(one) for one in squares[:2]] == pytest.approx(own, rel=3e-3)
    assert (own < 0.85 * eigh(stiffness, mass, eigvals_only=True)[:2]).all()
