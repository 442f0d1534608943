"""Beam elements of legs: statics, vibration and buckling against closed forms and CalculiX."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.optimize import brentq
from support.oracles.compliance_difference import scaled_difference
from support.robots.paper_legs import LEG_1, LEG_2, STEEL, kind_frequencies

from fem.beams.beam import beam_leg, warping_beam_leg
from fem.beams.beam_theory import (
    bending_frequencies,
    euler_bernoulli_roots,
    tension_frequencies,
    torsion_frequencies,
)
from fem.beams.prestressed import prestressed_leg
from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import PROGRAMS, calculix_program
from fem.sections.nonuniform_torsion import (
    cantilever_frequencies,
    held_torsion_compliance,
    warping_rod,
)
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.arrays import dense
from lumped.beam_properties import BeamProperties, tip_compliance
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import clamped_modes, tip_compliance_of
from lumped.sections import Circle, ISection, Rectangle
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh

PARTS = ("tension", "torsion", "bending y", "bending z")
both_theories = pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])


def square_leg(slenderness: float) -> ConstantLeg:
    return ConstantLeg(slenderness * 0.1, Rectangle(0.1, 0.1), STEEL)


def softer_along_y(p: BeamProperties) -> BeamProperties:
    """Return the properties with 0.7 κGA along y; a rectangle has equal κGA along y and z."""
    return replace(p, GAy=0.7 * p.GAy)


def test_off_axis_point_moves_with_section():
    """Tip displacement t and rotation φ displace a point at r from the tip by t + φ × r."""
    leg, off_axis_points = (
        beam_leg(LEG_1.timoshenko, 0.85, 1),
        np.array([[0.0, 0.1, -0.2], [0.0, 0.3, 0.4]]),
    )
    t, phi = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    twists = np.zeros(leg.size)
    twists[6:12] = np.concatenate([t, phi])
    displacements = (
        leg.displacements(np.array([0.85, 0.0, 0.0]) + off_axis_points) @ twists
    ).reshape(-1, 3)
    assert_allclose(displacements, t + np.cross(phi, off_axis_points), rtol=1e-12)


def test_beam_frequency_roots_equal_table():
    """Young and Felgar, Tables of Characteristic Functions (1949): cos x cosh x = −1."""
    tabulated = [1.8751041, 4.6940911, 7.8547574, 10.9955407, 14.1371684]
    roots = euler_bernoulli_roots(300)
    assert_allclose(roots[:5], tabulated, atol=6e-8)
    # From the twelfth root on 1/cosh x is below rounding; at the 300th cosh x would overflow.
    assert_allclose(roots[11:], (2.0 * np.arange(12, 301) - 1.0) * np.pi / 2.0, rtol=1e-14)


def huang_function(p: BeamProperties, L: float, plane: str, omega):
    """Return Huang's frequency equation of the clamped-free Timoshenko beam at `omega` (rad/s).

    T. C. Huang, J. Appl. Mech. 28 (1961) 579, Table 1, divided by the positive 1 + cosh bα to limit
    its size. With complex α, cosh and sinh become cos and sin above the cut-off frequency.
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


@pytest.mark.parametrize("plane", ["y", "z"])
@pytest.mark.parametrize("leg", [LEG_1, square_leg(1.0)])
def test_timoshenko_modes_equal_huang_roots(leg, plane):
    """The first twenty frequencies are roots of Huang's equation (1961), and none is missing."""
    p, L = softer_along_y(leg.timoshenko), leg.length
    omega = 2.0 * np.pi * bending_frequencies(p, L, plane, 20)
    # The cut-off of the second spectrum, √(κGA/ρI), lies below the 20th root of these legs.
    assert (
        omega[0] < np.sqrt((p.GAz / p.rho_Iy) if plane == "y" else (p.GAy / p.rho_Iz)) < omega[-1]
    )
    # The function changes its sign within 1e-9 of each frequency, and nowhere else.
    below, above = (huang_function(p, L, plane, omega * near) for near in (1 - 1e-9, 1 + 1e-9))
    assert np.all(np.sign(below) == -np.sign(above))
    scan = huang_function(p, L, plane, np.linspace(0.5 * omega[0], omega[-1] * 1.000001, 50_001))
    assert np.count_nonzero(np.diff(np.sign(scan))) == 20


def test_rod_has_axial_and_torsional_modes():
    """Steel rod of 1 m: √(E/ρ)/4L = 1293.05 Hz times 1, 3, 5; in torsion with GJ/ρI_p for E/ρ."""
    # Steel bar of 1 m: √(E/ρ)/4L = 5172.2/4 Hz; torsional frequencies times √(GJ/E(Iy + Iz)).
    p = square_leg(10.0).timoshenko
    tension = tension_frequencies(p, 1.0, 3)
    assert_allclose(tension, 1293.05 * np.array([1.0, 3.0, 5.0]), rtol=1e-5)
    # Square: J = 0.140577 b⁴ (Timoshenko and Goodier, §109), polar moment b⁴/6.
    slower = np.sqrt(0.140577 * 6.0 / 2.6)
    assert_allclose(torsion_frequencies(p, 1.0, 3), slower * tension, rtol=5e-6)


@both_theories
@pytest.mark.parametrize("part", PARTS)
def test_beam_frequency_order_is_four(theory, part):
    """Second frequencies in tension, torsion and bending, relative to exact ones: order n⁻⁴."""
    p, L = LEG_2.properties(theory), LEG_2.length
    kind, _, plane = part.partition(" ")
    exact = {
        "tension": lambda: tension_frequencies(p, L, 2),
        "torsion": lambda: torsion_frequencies(p, L, 2),
        "bending": lambda: bending_frequencies(p, L, plane, 2),
    }[kind]()[1]
    counts = [6, 8, 12, 16]
    errors = np.array([kind_frequencies(beam_leg(p, L, n), part, 2)[1] for n in counts]) / exact - 1
    # The next term of the error, (kl)² of the leading one, changes the fitted order slightly.
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(-4.0, abs=0.1)
    # Frequencies converge from above (Rayleigh–Ritz). With 16 elements the leading error
    # (kl)⁴/1440 is 5.2e-6 in tension and torsion (kl = 3π/32) and 5.1e-6 in bending
    # (kl = 4.694/16); shear makes it smaller.
    assert (errors > 0.0).all()
    assert errors[-1] < 6e-6


@both_theories
def test_beam_tip_compliance_is_exact(theory):
    """For one, two and seven elements: closed form of a cantilever, with and without shear."""
    for leg in (square_leg(1.0), square_leg(1e4), LEG_2):
        properties = leg.properties(theory)
        for elements in (1, 2, 7):
            compliance = tip_compliance_of(beam_leg(properties, leg.length, elements))
            # Rounding errors only; they grow as n⁴ with the condition number of n elements: 2400
            # eps for n = 7, up to 7.3e-13 with five kernels of OpenBLAS.
            assert scaled_difference(compliance, tip_compliance(properties, leg.length)) < 1e-11


@both_theories
def test_centreline_under_tip_load_is_exact(theory):
    """Closed forms of a cantilever under unit tip loads, such as x²(3L − x)/6EI + x/κGA."""
    p, L = softer_along_y(LEG_2.properties(theory)), LEG_2.length
    leg = beam_leg(p, L, 3)
    x = np.linspace(0.0, L, 14)
    loads = np.zeros((leg.size - 6, 6))
    loads[:6] = np.eye(6)
    u = np.vstack([np.zeros((6, 6)), np.linalg.solve(dense(leg.stiffness)[6:, 6:], loads)])
    # Beam theory for unit loads at the tip; only the bending part rotates the section.
    expected = np.zeros((len(x), 6, 6))
    expected[:, 0, 0] = x / p.EA
    expected[:, 1, 1] = x**2 * (3.0 * L - x) / (6.0 * p.EIz) + x / p.GAy
    expected[:, 5, 1] = x * (2.0 * L - x) / (2.0 * p.EIz)
    expected[:, 2, 2] = x**2 * (3.0 * L - x) / (6.0 * p.EIy) + x / p.GAz
    expected[:, 4, 2] = -x * (2.0 * L - x) / (2.0 * p.EIy)
    expected[:, 3, 3] = x / p.GJ
    expected[:, 2, 4] = -(x**2) / (2.0 * p.EIy)
    expected[:, 4, 4] = x / p.EIy
    expected[:, 1, 5] = x**2 / (2.0 * p.EIz)
    expected[:, 5, 5] = x / p.EIz
    curves = (leg.centreline(x) @ u).reshape(len(x), 6, 6)
    # Rounding errors only: the elements contain the static solution everywhere, not only at nodes.
    assert_allclose(curves, expected, rtol=1e-11, atol=1e-12 * expected.max(axis=0).max())
    assert_allclose(sum(map(dense, leg.parts.values())), dense(leg.stiffness), rtol=0, atol=0)
    # Clapeyron's theorem for unit loads: uᵀKu is the compliance, up to rounding errors.
    energies = {name: np.diag(u.T @ (part @ u)) for name, part in leg.parts.items()}
    kinds = ("tension", "bending z", "bending y", "torsion", "bending y", "bending z")
    compliance = np.diag(tip_compliance(p, L))
    for name in PARTS:
        energy = np.where(np.array(kinds) == name, compliance, 0.0)
        assert energies.pop(name) == pytest.approx(energy, rel=1e-11, abs=1e-30)
    assert not energies


def test_zero_elements_are_refused():
    """Stations beyond the tip of the leg are refused, too."""
    with pytest.raises(InputError, match="elements = 0"):
        beam_leg(LEG_1.timoshenko, 0.85, 0)
    with pytest.raises(InputError, match="station"):
        beam_leg(LEG_1.timoshenko, 0.85, 3).centreline(np.array([0.1, 0.86]))


LENGTH = 0.9


@pytest.fixture(scope="module")
def flanged() -> SectionConstants:
    section = ISection(width=0.1, height=0.1, flange=0.008, web=0.006)
    return section_constants(section_mesh(section, 4), STEEL.nu)


def warped(constants, elements, ends):
    properties, rod = beam_properties(constants, STEEL), warping_rod(constants, STEEL)
    return warping_beam_leg(properties, rod, LENGTH, elements, ends)


def test_free_warping_is_saint_venant_torsion(flanged):
    """Tip compliance L/GJ, and torsional frequencies (2k − 1)/4L √(GJ/ρI_p)."""
    leg = warped(flanged, 20, "free")
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    assert tip_compliance_of(leg) == pytest.approx(expected, rel=1e-8, abs=1e-16)
    modes = clamped_modes(leg, 12)
    twists = np.abs(leg.centreline(np.array([LENGTH]))[3].toarray().ravel() @ modes.shapes)
    torsional = modes.frequencies[twists > 0.1 * twists.max()]
    frequencies = cantilever_frequencies(flanged, STEEL, LENGTH, 2)
    assert torsional[:2] == pytest.approx(frequencies, rel=1e-4)


def test_fixed_warping_torsion_equals_vlasov(flanged):
    """Tip compliance (L − 2d tanh(L/2d))/GJ, d² = EΓ/GJ.

    A round section has no warping unknowns.
    """
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    expected[3, 3] = held_torsion_compliance(warping_rod(flanged, STEEL), LENGTH)
    coarse, fine = (tip_compliance_of(warped(flanged, n, "rigid")) for n in (20, 40))
    # Discretisation error of fourth order: warping decays from the ends over four elements.
    assert coarse == pytest.approx(expected, rel=1e-4, abs=1e-16)
    assert abs(fine[3, 3] - expected[3, 3]) < abs(coarse[3, 3] - expected[3, 3]) / 12.0
    # Round sections do not warp: their elements have no warping unknowns.
    constants = section_constants(section_mesh(Circle(diameter=0.1), 8), STEEL.nu)
    round_leg = warped(constants, 4, "rigid")
    assert round_leg.size == beam_leg(beam_properties(constants, STEEL), LENGTH, 4).size


# A stocky column, in which shear matters, softer along y than along z.
COLUMN = ConstantLeg(0.5, Rectangle(width=0.05, height=0.12), STEEL)
L = COLUMN.length
ALL = 10_000
# Unknowns of root and tip that are free (7: tip along y; 5, 11: root and tip about z), and the
# buckling load over that of a column between pins.
ENDS = {
    "fixed-free": ((7, 11), 0.25),
    "pinned-pinned": ((5, 11), 1.0),
    "fixed-fixed": ((), 4.0),
    "fixed-pinned": ((11,), 2.04575),
}
PUSH = np.array([1.0, 0, 0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0])
NOTHING = np.zeros(12)


def reduced_matrices(leg, ends, forces, spread=NOTHING):
    """Return geometric stiffness, stiffness and mass of a leg on the unknowns that are free.

    `ends` are the free unknowns of root and tip, `forces` the twelve end forces. `spread` is the
    part of `forces` that is equivalent to a distributed load.
    """
    stiffness, mass = dense(leg.matrices.stiffness), dense(leg.matrices.mass)
    free = [*ends, *range(12, len(mass))]
    added = leg.geometric_stiffness(forces, spread)
    return [matrix[np.ix_(free, free)] for matrix in (added, stiffness, mass)]


def factor(leg, ends, forces, spread=NOTHING) -> float:
    """Return the buckling factor of `forces`, the twelve end forces, and `spread`."""
    added, stiffness, _ = reduced_matrices(leg, ends, forces, spread)
    return -1.0 / eigh(added, stiffness, eigvals_only=True)[0]


def critical(p: BeamProperties, ends: str) -> float:
    """Return the buckling load (N) along y by Euler, or with shear by Engesser."""
    if ends != "fixed-pinned":
        euler = ENDS[ends][1] * np.pi**2 * p.EIz / L**2
        return euler / (1.0 + euler / p.GAy)

    # θ = H/P (cos kL − 1 + …), ∫ w′ = 0: tan kL = kL (1 − P/κGA), P = EI k²/(1 + EI k²/κGA).
    def load(k: float) -> float:
        return p.EIz * k**2 / (1.0 + p.EIz * k**2 / p.GAy)

    def residual(k: float) -> float:
        return np.sin(k * L) - k * L * (1.0 - load(k) / p.GAy) * np.cos(k * L)

    return load(brentq(residual, 3.2 / L, 4.6 / L, xtol=1e-14))


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize("ends", ENDS)
def test_column_buckles_at_engesser_load(ends, theory):
    """P_E/(1 + P_E/κGA) with Euler's P_E; fixed-pinned by its equation for k, with shear."""
    p, (free, times) = COLUMN.properties(theory), ENDS[ends]
    expected = critical(p, ends)
    if theory == "euler-bernoulli":
        assert expected == pytest.approx(times * np.pi**2 * p.EIz / L**2, rel=1e-5)
    with_all_modes, with_24_modes = (
        factor(prestressed_leg(p, L, 10, mode_count), free, PUSH) for mode_count in (ALL, 24)
    )
    assert with_all_modes == pytest.approx(expected, rel=3e-4)
    assert with_24_modes == pytest.approx(expected, rel=1e-3)
    # A Ritz approximation is never below the exact load.
    assert with_all_modes >= expected * (1.0 - 1e-9)


def test_column_buckling_has_order_four():
    """Relative error of the load of a column with two clamped ends: order n⁻⁴."""
    p, counts = COLUMN.timoshenko, [6, 8, 12, 16]
    expected = critical(p, "fixed-fixed")
    errors = [factor(prestressed_leg(p, L, n, ALL), (), PUSH) / expected - 1.0 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.15)


def test_tension_raises_beam_frequency():
    """f = f₀ √(1 + N L²/π²EI) for pinned ends, exact without shear and rotary inertia."""
    p = COLUMN.properties("euler-bernoulli")
    added, stiffness, mass = reduced_matrices(
        prestressed_leg(p, L, 10, ALL), ENDS["pinned-pinned"][0], PUSH
    )
    euler = np.pi**2 * p.EIz / L**2
    for tension in (0.5 * euler, -0.7 * euler):
        square = eigh(stiffness - tension * added, mass, eigvals_only=True)[0]
        expected = np.pi**4 * p.EIz / (p.mu * L**4) * (1.0 + tension / euler)
        assert square == pytest.approx(expected, rel=1e-4)


def test_own_weight_buckling_is_greenhill():
    """A leg buckles at the weight Q with Q L²/EI = 7.8373 (Greenhill), clamped at its lower end."""
    p = COLUMN.properties("euler-bernoulli")
    half = np.array([-0.5, 0, 0, 0, 0, 0])
    spread = np.r_[half, half]
    at_ends = spread + np.r_[-2.0 * half, 0.0 * half]
    weight = factor(prestressed_leg(p, L, 10, ALL), (7, 11), at_ends, spread)
    assert weight == pytest.approx(7.837347 * p.EIz / L**2, rel=1e-4)


def test_torsional_buckling_equals_wagner():
    """A thin leg of any length buckles by twist at P = GJ/i², polar gyration radius i (Wagner)."""
    p = ConstantLeg(0.08, Rectangle(width=0.004, height=0.1), STEEL).timoshenko
    leg = prestressed_leg(p, 0.08, 6, ALL)
    assert factor(leg, (9,), PUSH) == pytest.approx(p.GJ * p.mu / p.rho_J, rel=1e-9)


def test_blade_and_shaft_buckle_as_published():
    """Blade under a tip force, P L²/√(EI GJ) = 4.0126, and an end moment, M L/√(EI GJ) = π.

    The moment acts between fork supports (Prandtl, Michell). A round shaft with clamped ends
    buckles under a torque T = 8.9868 EI/L, from tan(TL/2EI) = TL/2EI (Greenhill).
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


# Axial force (N), a quarter of the buckling load of the solid column below.
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


@pytest.mark.exhaustive
@pytest.mark.skipif(not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed")
def test_column_load_equals_calculix(tmp_path):
    """Two buckling loads of a column, and two frequencies under a compressive load."""
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
    added, stiffness, mass = reduced_matrices(leg, range(6, 12), LOAD * PUSH)
    buckling_loads = -LOAD / eigh(added, stiffness, eigvals_only=True)[:2]
    assert list(map(float, factors[:2])) == pytest.approx(buckling_loads, rel=3e-3)
    eigenvalues = eigh(stiffness + added, mass, eigvals_only=True)[:2]
    assert list(map(float, squares[:2])) == pytest.approx(eigenvalues, rel=3e-3)
    assert (eigenvalues < 0.85 * eigh(stiffness, mass, eigvals_only=True)[:2]).all()
