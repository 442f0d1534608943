"""Legs with sections without two axes of symmetry, where bending and torsion are coupled."""

from math import sqrt

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import cantilever_frequencies, frequency_of_kind
from fem.bodies import doubling
from fem.couplings.end_effects import restrained_compliance
from fem.sections.section_constants import beam_properties, section_constants
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.accelerations import Motion
from lumped.models.bodies import clamped_modes, tip_compliance_of
from lumped.models.segments import segment_chain, segment_leg, static_leg
from lumped.sections import Angle, Channel, Composite, CompositePart, Polygon, Rectangle, Tee
from lumped.system.line_loads import inertia_load
from meshes.section.section_mesh import section_mesh
from validation.cases.ritz_legs import ritz_beam

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
CHANNEL = Channel(0.05, 0.1, 0.006, 0.005)
ANGLE = Angle(0.06, 0.1, 0.006, 0.005)
# The mass centre of this composite section differs from the centroid of its stiffness.
COMPOSITE = Composite(
    (
        CompositePart(Rectangle(0.05, 0.02), E=2.1e11, nu=0.3, rho=2000.0),
        CompositePart(Rectangle(0.03, 0.04), E=3.5e10, nu=0.3, rho=7000.0, at=(-0.01, 0.03)),
    )
)
SECTIONS = [CHANNEL, ANGLE, Tee(0.06, 0.1, 0.006, 0.005), COMPOSITE]
LENGTH = 1.0
# Rounding error of statics with a few elements, relative to the compliance.
ROUNDING = 1e-10


def scaled(difference, compliance):
    size = np.sqrt(np.diag(compliance))
    return np.abs(difference / np.outer(size, size)).max()


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_shear_centre_force_causes_no_twist(section, theory):
    """A force at the shear centre causes no twist, F at the centroid a twist F e L/(GJ).

    A torque T displaces the centroid by T e L/(GJ). The shear centre is e beside the centroid.
    """
    beam = ConstantLeg(LENGTH, section, STEEL).properties(theory)
    compliance = tip_compliance(beam, LENGTH)
    y, z = section.shear_centre
    twist = LENGTH / (STEEL.G * section.torsion_constant)
    assert compliance[3, 3] == pytest.approx(twist, rel=1e-12)
    # About the shear centre a force F at the centroid has the moment −y_s F if along z, and z_s F
    # if along y.
    assert compliance[3, 2] == pytest.approx(-y * twist, rel=1e-12)
    assert compliance[3, 1] == pytest.approx(z * twist, rel=1e-12, abs=1e-12 * twist)
    for direction, moment in ((1, -z), (2, y)):
        force = np.zeros(6)
        force[direction], force[3] = 1.0, moment
        assert abs((compliance @ force)[3]) < 1e-12 * twist * max(section.extent)


def test_angle_deflects_along_principal_axes():
    """L³/3EI with I = t b³/3 and t b³/12 about the axes at 45°, exact as t/b → 0."""
    t, b, length = 0.001, 0.1, 2.0
    leg = ConstantLeg(length, Angle(b, b, t, t), STEEL)
    beam = leg.properties("euler-bernoulli")
    compliance = tip_compliance(beam, length)
    # Forces act at the shear centre, where they cause no twist.
    to_shear_centre = beam.to_shear_centre
    bent = (to_shear_centre @ compliance @ to_shear_centre.T)[1:3, 1:3]
    softer, stiffer = (np.array([1.0, 1.0]), np.array([1.0, -1.0]))
    for force, divisor in ((softer, 12.0), (stiffer, 3.0)):
        unit = force / sqrt(2.0)
        deflection = bent @ unit
        assert deflection == pytest.approx(unit * (unit @ deflection), rel=1e-9)
        exact = length**3 / (3.0 * STEEL.E * t * b**3 / divisor)
        assert unit @ deflection == pytest.approx(exact, rel=2.0 * t / b)


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_coupled_beam_statics_are_exact(section, theory):
    """Beam elements and segments have the tip compliance of the closed form, for any count."""
    beam = ConstantLeg(LENGTH, section, STEEL).properties(theory)
    exact = tip_compliance(beam, LENGTH)
    for count in (1, 3):
        chain = segment_chain(beam, LENGTH, count)
        for leg in (beam_leg(beam, LENGTH, count), segment_leg(chain), static_leg(chain)):
            assert scaled(tip_compliance_of(leg) - exact, exact) < ROUNDING


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_coupled_frequencies_converge(section, theory):
    """Reference: Ritz's method with ten polynomials.

    Beam elements converge with order four, segments with order two.
    """
    beam = ConstantLeg(LENGTH, section, STEEL).properties(theory)
    exact = np.array([mode.frequency for mode in cantilever_frequencies(beam, LENGTH, 4)])
    ritz = ritz_beam(beam, LENGTH, 10)
    free = null_space(ritz.root)
    squares = eigh(free.T @ ritz.stiffness @ free, free.T @ ritz.mass @ free, eigvals_only=True)
    assert np.sqrt(squares[:4]) / (2.0 * np.pi) == pytest.approx(exact, rel=1e-8)

    def errors(legs):
        return np.array([np.abs(clamped_modes(leg, 4).frequencies / exact - 1.0) for leg in legs])

    coarse, fine = errors(beam_leg(beam, LENGTH, count) for count in (8, 16))
    assert (np.log2(coarse / fine) > 3.7).all()
    assert fine.max() < 2e-5
    coarse, fine = errors(segment_leg(segment_chain(beam, LENGTH, n)) for n in (16, 32))
    assert np.log2(coarse / fine) == pytest.approx(np.full(4, 2.0), abs=0.1)


def test_weight_twists_composite_leg():
    """A weight μg per length along y at the mass centre twists the tip by μg (z_s − z_m) L²/2GJ."""
    beam = ConstantLeg(LENGTH, COMPOSITE, STEEL).timoshenko
    leg = beam_leg(beam, LENGTH, 3)
    gravity = np.zeros(leg.size)
    # All nodes have the same acceleration along y; the twelve end unknowns come first.
    gravity[1 : 6 * 4 : 6] = 9.81
    weights = leg.mass @ gravity
    clamped = leg.stiffness.toarray()[6:, 6:]
    tip = np.linalg.solve(clamped, weights[6:])[:6]
    arm = beam.centre_z - beam.mass_z
    assert abs(arm) > 1e-3
    assert tip[3] == pytest.approx(beam.mu * 9.81 * arm * LENGTH**2 / (2.0 * beam.GJ), rel=1e-9)


@pytest.mark.parametrize("make", [beam_leg, lambda p, L, n: segment_leg(segment_chain(p, L, n))])
def test_composite_leg_mass_is_sum_of_parts(make):
    """Mass, first moments and inertia about the root are those of two boxes."""
    beam = ConstantLeg(LENGTH, COMPOSITE, Material(*COMPOSITE.mean_material)).timoshenko
    leg = make(beam, LENGTH, 8)
    motions = rigid_nodes(leg, 8)
    # Centroid of the stiffness: the parts have EA = 2.1e8 N and 4.2e7 N; the second lies 0.03 m
    # above and 0.01 m beside the first.
    share = 4.2e7 / (4.2e7 + 2.1e8)
    expected = np.zeros((6, 6))
    for part in COMPOSITE.parts:
        width, height = part.section.extent
        sizes = np.array([LENGTH, width, height])
        mass = part.rho * sizes.prod()
        centre = np.array([LENGTH / 2.0, part.at[0] + 0.01 * share, part.at[1] - 0.03 * share])
        inertia = np.diag(mass / 12.0 * ((sizes**2).sum() - sizes**2))
        cross = np.cross(np.eye(3), centre)
        expected[:3, :3] += mass * np.eye(3)
        expected[:3, 3:] += mass * cross.T
        expected[3:, :3] += mass * cross
        expected[3:, 3:] += inertia + mass * cross.T @ cross
    computed = motions.T @ (leg.mass @ motions)
    assert scaled(computed - expected, expected) < 1e-9


def test_composite_inertia_load_is_consistent():
    """The resultant of the inertia load about the root is −M (a, α).

    M is the mass matrix (6×6) of rigid motions, a and α are the accelerations of the root.
    """
    beam = ConstantLeg(LENGTH, COMPOSITE, Material(*COMPOSITE.mean_material)).timoshenko
    leg = beam_leg(beam, LENGTH, 2)
    motions = rigid_nodes(leg, 2)
    acceleration = np.array([1.0, -2.0, 3.0, 0.5, -0.7, 0.9])
    motion = Motion(acceleration[:3], acceleration[3:], np.zeros(3))
    load = inertia_load(beam, LENGTH, motion)
    # Simpson's rule is exact for the moments of a linear load, which are quadratic.
    total = np.zeros(6)
    for x, weight in zip((0.0, 0.5, 1.0), np.array([1.0, 4.0, 1.0]) / 6.0, strict=True):
        wrench = (1.0 - x) * load.first + x * load.last
        lever = np.cross([x * LENGTH, 0.0, 0.0], wrench[:3])
        total += LENGTH * weight * (wrench + np.append(np.zeros(3), lever))
    expected = -(motions.T @ (leg.mass @ motions)) @ acceleration
    assert total == pytest.approx(expected, rel=1e-9)


def rigid_nodes(leg, elements):
    """Return the twists of all nodes (n×6) in unit rigid motions about the root."""
    tip_last = np.r_[0.0, LENGTH, np.linspace(0.0, LENGTH, elements + 1)[1:-1]]
    if leg.model == "segments":
        tip_last = np.r_[0.0, LENGTH, (np.arange(elements) + 0.5) * LENGTH / elements]
    motions = np.zeros((leg.size, 6))
    for number, x in enumerate(tip_last):
        twist = np.eye(6)
        twist[1, 5], twist[2, 4] = x, -x
        motions[6 * number : 6 * number + 6] = twist
    # Unknowns inside the elements follow from K_ii u_i = −K_ib u_b, without internal force.
    nodal = 6 * len(tip_last)
    stiffness = leg.stiffness.toarray()
    if nodal < leg.size:
        inner = stiffness[nodal:, nodal:]
        motions[nodal:] = -np.linalg.solve(inner, stiffness[nodal:, :nodal] @ motions[:nodal])
    return motions


def test_rectangle_has_no_bending_torsion_coupling():
    """A rectangle treated as a coupled section has the frequencies of bending and torsion alone."""
    beam = ConstantLeg(LENGTH, Rectangle(0.1, 0.2), STEEL).timoshenko
    kinds = ("torsion", "bending y", "bending z")
    alone = sorted(frequency_of_kind(beam, LENGTH, kind, n) for kind in kinds for n in (1, 2, 3, 4))
    kind = "torsion with bending z with bending y"
    coupled = [frequency_of_kind(beam, LENGTH, kind, n) for n in range(1, 7)]
    assert coupled == pytest.approx(alone[:6], rel=1e-10)


@pytest.mark.parametrize(
    "section",
    [
        Channel(0.05, 0.1, 0.02, 0.02),
        Angle(0.06, 0.1, 0.02, 0.02),
        Polygon(((0.0, 0.0), (0.1, 0.0), (0.03, 0.08))),
    ],
    ids=lambda section: section.shape,
)
def test_beam_of_each_section_equals_solid(section):
    """With free warping beam and solid are equal; rigid end faces add the decaying end effects.

    The slices of the solid are far thinner than its walls. At the edges of rigid faces they leave
    an error of 1e-6 in the end effects.
    """
    length = 0.3
    mesh = section_mesh(section, 4)
    leg = ConstantLeg(length, section, STEEL)
    piece = doubling.condensed_leg(leg, mesh, 512)
    free, rigid = (doubling.tip_compliance(piece, ends) for ends in ("free", "rigid"))
    constants = section_constants(mesh, STEEL.nu)
    beam = tip_compliance(beam_properties(constants, STEEL), length)
    assert scaled(free - beam, beam) < 1e-8
    restrained = restrained_compliance(mesh, STEEL, length)
    assert scaled(rigid - beam - restrained, beam) < 3e-6
    # The end effects are not small, and finite and boundary elements give similar constants.
    assert scaled(restrained, beam) > 0.01
    assert scaled(tip_compliance(leg.timoshenko, length) - beam, beam) < 0.03
