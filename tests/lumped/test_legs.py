"""Sections against textbooks and steel tables; legs against beam formulas and the paper."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.robots.paper_legs import STEEL
from support.robots.paper_robot_variants import LEG1, LEG2

from fem.bodies.solid import solid_leg, solid_mesh
from fem.sections.section_constants import section_constants
from lumped.beam_properties import tip_compliance
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError, InputError, naming
from lumped.legs import ConstantLeg, GivenLeg, Material
from lumped.sections import (
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Tube,
    rectangle_torsion_constant,
)
from meshes.section.section_mesh import section_mesh

BEAM = ConstantLeg(1.2, Rectangle(width=0.05, height=0.10), STEEL)


@pytest.mark.parametrize(
    ("leg", "rule", "expected", "height", "width"),
    [
        (LEG1, "stiffness", (8.613e8, 1.832e6, 4.771e6, 9.212e6), 0.2578, 0.1598),
        (LEG2, "stiffness", (4.316e9, 4.182e6, 5.980e7, 6.478e6), 0.4078, 0.1078),
        (LEG1, "compliance", (3.025e8, 1.157e6, 6.417e6, 4.913e6), 0.5046, 0.2142),
    ],
)
def test_equivalent_legs_equal_paper(leg, rule, expected, height, width):
    """EA, EIz, EIy and GJ to the paper's four printed digits, and the sides of the section in m."""
    computed = equivalent_leg(leg, rule)
    beam = computed.timoshenko
    assert_allclose((beam.EA, beam.EIz, beam.EIy, beam.GJ), expected, rtol=5e-4)
    assert_allclose((computed.section.height, computed.section.width), (height, width), atol=1e-4)
    assert (computed.mass, computed.material.nu) == (pytest.approx(leg.mass, rel=1e-14), 0.0)


@pytest.mark.parametrize("rule", ["stiffness", "compliance"])
def test_equivalent_leg_keeps_stiffness(rule):
    """EI from c22 = L³/3EI (by compliance) or K22 = 12EI/L³ (by stiffness, clamped tip)."""
    beam = BEAM.timoshenko
    given_leg = GivenLeg(1.2, 47.1, tip_compliance(beam.as_euler_bernoulli(), 1.2))
    computed = equivalent_leg(given_leg, rule).timoshenko
    for name in ("EA", "EIy", "EIz", "GJ"):
        # Inverting the 6×6 of a leg of slenderness 12 loses four of sixteen digits.
        assert getattr(computed, name) == pytest.approx(getattr(beam, name), rel=1e-11)


def test_indefinite_leg_has_no_equivalent():
    """c66 = −0.001 makes the 6×6 indefinite."""
    with pytest.raises(InputError, match="not positive definite"):
        equivalent_leg(GivenLeg(1.0, 10.0, np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -1e-3])))


def test_cantilever_equals_textbook():
    """Steel 50×100 mm, 1.2 m: PL³/3EI + PL/κGA, ML²/2EI, ML/EI, TL/GJ, NL/EA, signs of c26, c35."""
    L, E, G = 1.2, 2.1e11, 2.1e11 / 2.6
    A, Iy, Iz = 0.005, 0.05 * 0.1**3 / 12.0, 0.1 * 0.05**3 / 12.0
    J = 0.229 * 0.1 * 0.05**3  # Timoshenko & Goodier §109, side ratio 2, three digits
    shear = L / (13.0 / 15.3 * G * A)  # Cowper 10(1+ν)/(12+11ν)
    computed = tip_compliance(BEAM.timoshenko, L)
    assert computed[3, 3] == pytest.approx(L / (G * J), rel=2e-3)
    bent_z, bent_y = (L**3 / (3.0 * E * I) for I in (Iz, Iy))
    turned = [computed[3, 3], L / (E * Iy), L / (E * Iz)]
    expected = np.diag([L / (E * A), bent_z + shear, bent_y + shear, *turned])
    expected[1, 5] = expected[5, 1] = L**2 / (2.0 * E * Iz)
    expected[2, 4] = expected[4, 2] = -(L**2) / (2.0 * E * Iy)
    assert_allclose(computed, expected, rtol=1e-12, atol=1e-22)
    bending = tip_compliance(BEAM.properties("euler-bernoulli"), L)
    assert bending[1, 1] == pytest.approx(bent_z, rel=1e-12)


def test_tall_box_is_stiffest_in_shear_along_z():
    """A tall box is stiffest in shear along z, where its long walls lie; ρI is largest about y."""
    box = ConstantLeg(1.0, HollowRectangle(0.05, 0.2, 0.005), Material.isotropic(2e11, 0.3, 7800.0))
    beam, section = box.timoshenko, box.section
    # The two walls along z, as high as the middle line, take nearly all of the shear along z.
    assert beam.GAz == pytest.approx(box.material.G * 2 * 0.195 * 0.005, rel=0.1)
    assert beam.GAy < 0.3 * beam.GAz
    iy, iz = section.second_moment_y, section.second_moment_z
    moments = 7800.0 * np.array([iy + iz, iy, iz])
    assert_allclose((beam.rho_J, beam.rho_Iy, beam.rho_Iz), moments, rtol=1e-12)


@pytest.mark.parametrize(
    ("shape", "nu", "shear"), [(Rectangle(0.05, 0.10), 0.3, 1e-5), (Circle(0.1), -0.5, 2.0)]
)
def test_cowper_holds_for_independent_g(shape, nu, shear):
    """Cowper's coefficient against Saint-Venant's flexure by finite elements, for cubic material.

    By linear elasticity κ depends on νG/E alone. It is Cowper's κ for the isotropic ν′ with this
    νG/E. Cowper's κ for ν itself would be 3 % too large if G ≪ E.
    """
    leg = ConstantLeg(1.0, shape, Material(E=1e11, G=shear * 1e11, nu=nu, rho=1.0))
    constants = section_constants(section_mesh(shape, 8), nu, shear)
    computed = leg.timoshenko.GAy / (leg.material.G * shape.area)
    assert computed == pytest.approx(constants.cowper_coefficients[0], rel=2e-3)


def test_negative_shear_stiffness_is_refused():
    """Cowper's κ of a wide I-section is negative for ν = −0.9. Beams without shear remain."""
    wide = ISection(width=6.9e-5, height=1.0e-5, flange=1.0e-6, web=1.0e-6)
    leg = ConstantLeg(0.07, wide, Material.isotropic(2.1e11, -0.9, 7850.0))
    with pytest.raises(ComputationError, match=r"i-section: .* κGA = -.* N is negative"):
        _ = leg.timoshenko
    assert pytest.approx(2.1e11 * wide.area) == leg.properties("euler-bernoulli").EA


def test_leg_name_is_in_messages_only():
    """Legs that differ only in their names are equal and share one solution."""
    first, second = replace(BEAM, name="leg 1"), replace(BEAM, name="leg 2")
    assert {first} == {second}
    short = GivenLeg(1.0, 1.0, np.diag([1e-7, 1e-9, 1e-9, 1e-9, 3e-9, 3e-9]), name="leg 2")
    with pytest.raises(InputError, match=r"^equivalent of leg 2: length = 1.0: shorter"):
        solid_mesh(equivalent_leg(short), 2)
    uneven = replace(BEAM, material=replace(STEEL, G=1e4), name="rod")
    with pytest.raises(ComputationError, match=r"^rod: material with ν = 0.3: changes of"):
        solid_leg(uneven, solid_mesh(uneven, 2))
    with pytest.raises(InputError) as error, naming("leg 1"), naming("leg 1"):
        raise InputError(["length: too short", "width: too wide"])
    assert error.value.faults == ("leg 1: length: too short", "leg 1: width: too wide")
    # The name is put in front of a message even if the message begins with the same word.
    with pytest.raises(InputError) as error, naming("leg"):
        raise InputError("leg: is no section")
    assert error.value.faults == ("leg: leg: is no section",)


def test_rectangle_torsion_equals_table():
    """J/(b h³) for side ratios b/h (Timoshenko & Goodier, Theory of Elasticity, §109, table)."""
    table = {1.0: 0.140577, 1.2: 0.166119, 1.5: 0.195761, 2.0: 0.228682, 2.5: 0.249365}
    table |= {3.0: 0.263317, 4.0: 0.280813, 5.0: 0.291317, 10.0: 0.312325}
    computed = {ratio: rectangle_torsion_constant(ratio, 1.0) / ratio for ratio in table}
    assert computed == pytest.approx(table, abs=1e-6)
    assert rectangle_torsion_constant(1.0, 100.0) == rectangle_torsion_constant(100.0, 1.0)


def plates(*each):
    """Return area, Iy and Iz of rectangles (width, height, y, z) by the parallel-axis theorem."""
    b, h, y, z = np.array(each).T
    area = b * h
    return [sum(area), sum(area * (h**2 / 12 + z**2)), sum(area * (b**2 / 12 + y**2))]


def constants(section):
    return [section.area, section.second_moment_y, section.second_moment_z]


def test_hollow_rectangle_equals_four_walls():
    """Area and second moments are sums over plates; J by Bredt, 4A_m² t/perimeter."""
    b, h, t = 0.10, 0.16, 0.008
    section = HollowRectangle(b, h, t)
    across, along = (b - t) / 2.0, (h - t) / 2.0
    flanges = [(b, t, 0.0, z) for z in (-along, along)]
    webs = [(t, h - 2.0 * t, y, 0.0) for y in (-across, across)]
    assert constants(section) == pytest.approx(plates(*flanges, *webs), rel=1e-12)
    # Bredt: J = 4 A² t / s with area A and length s of the middle line.
    bredt = 4.0 * ((b - t) * (h - t)) ** 2 * t / (2.0 * (b - t + h - t))
    assert section.torsion_constant == pytest.approx(bredt, rel=1e-12)


def test_i_section_equals_three_plates():
    """IPE 300 without its fillets: h = 300, b = 150, tf = 10.7, tw = 7.1 mm."""
    b, h, tf, tw = 0.150, 0.300, 0.0107, 0.0071
    section = ISection(width=b, height=h, flange=tf, web=tw)
    flanges = [(b, tf, 0.0, z) for z in ((tf - h) / 2.0, (h - tf) / 2.0)]
    expected = plates(*flanges, (tw, h - 2.0 * tf, 0.0, 0.0))
    assert constants(section) == pytest.approx(expected, rel=1e-12)
    thin = (2.0 * b * tf**3 + (h - tf) * tw**3) / 3.0
    assert section.torsion_constant == pytest.approx(thin, rel=1e-12)
    # IPE 300 in EN 10365: 53.81 cm², 8356 cm⁴, 603.8 cm⁴ with fillets, 4 % of the area.
    assert constants(section) == pytest.approx([53.81e-4, 8356e-8, 603.8e-8], rel=0.045)


def test_tube_uses_mean_diameter():
    """A = π m t and I = π m t (m² + t²)/8 are exact with the mean diameter m; J = 2 I."""
    t, m = 0.004, 0.046
    section, bending = Tube(0.05, t), np.pi * m * t * (m**2 + t**2) / 8.0
    assert constants(section) == pytest.approx([np.pi * m * t, bending, bending], rel=1e-12)
    assert section.torsion_constant == pytest.approx(2.0 * bending, rel=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_section_shear_equals_cowper(nu):
    """Thin square tube: Cowper 1966; other shapes are compared with finite elements elsewhere."""
    cowper = 20.0 * (1.0 + nu) / (48.0 + 39.0 * nu)
    assert HollowRectangle(0.1, 0.1, 0.002).shear_coefficients(nu) == pytest.approx([cowper] * 2)
