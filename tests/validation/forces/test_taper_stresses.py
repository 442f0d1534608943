"""Stresses along tapered and stepped legs, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from support.robots.plane_frames import CANTILEVER, L
from support.robots.robot_from_text import described

from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import Load
from lumped.sections import Circle, HollowRectangle, Rectangle
from lumped.system.members import MemberForces
from validation.forces.stresses import _loaded_sections, member_stress
from validation.models.loads.statics import load_forces

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LENGTH, FORCE = 1.2, 1000.0


def cantilever(*stations):
    """A leg with sections at stations and its section forces under a force along z at the tip."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    positions = np.linspace(0.0, LENGTH, 13)
    forces = np.zeros((13, 6))
    forces[:, 2], forces[:, 4] = FORCE, -FORCE * (LENGTH - positions)
    return LineLeg(line, stations, STEEL), MemberForces(
        "arm", positions, forces, np.zeros(6), np.zeros(13, dtype=int)
    )


def test_deep_taper_stress_peaks_at_twice_tip_height():
    """S. P. Timoshenko, Strength of Materials: σ = 6Fξ/bh² is largest where h is twice the tip's.

    With h from 2 cm at the tip to 8 cm, this is L/3 from the tip, σ = FL/2bh².
    """
    leg, member = cantilever((0.0, Rectangle(0.03, 0.08)), (LENGTH, Rectangle(0.03, 0.02)))
    stress = member_stress(leg, member)
    expected = FORCE * LENGTH / (2.0 * 0.03 * 0.02**2)
    assert stress.station == pytest.approx(LENGTH * 2.0 / 3.0, rel=1e-9)
    assert stress.largest == pytest.approx(expected, rel=1e-5)
    assert stress.along[0] == pytest.approx(6.0 * FORCE * LENGTH / (0.03 * 0.08**2), rel=1e-5)
    assert abs(stress.point[1]) == pytest.approx(0.02, rel=1e-9)


def test_cone_stress_peaks_at_three_halves_of_tip():
    """σ = 32Fξ/πd³ of a cone is largest where d is 1.5 times the diameter at the tip."""
    tip = 0.02
    leg, member = cantilever((0.0, Circle(3.0 * tip)), (LENGTH, Circle(tip)))
    stress = member_stress(leg, member)
    expected = 32.0 * FORCE * LENGTH / 4.0 / (np.pi * (1.5 * tip) ** 3)
    assert stress.station == pytest.approx(0.75 * LENGTH, rel=1e-3)
    assert stress.largest == pytest.approx(expected, rel=1e-3)
    assert abs(stress.largest - expected) <= stress.half_width


def test_inclined_fibres_carry_shear_of_wedge():
    """Michell: a part F h_tip/h of the tip force F on a wedge shears the section of height h."""
    leg, member = cantilever((0.0, Rectangle(0.03, 0.1)), (LENGTH, Rectangle(0.03, 0.05)))
    heights, shearing = zip(
        *((there.section.height, there.forces[2]) for _, there in _loaded_sections(leg, member)),
        strict=True,
    )
    # Rates of the taper are those of a polynomial of degree 11.
    assert np.array(shearing) == pytest.approx(FORCE * 0.05 / np.array(heights), rel=1e-7)


def test_stress_at_step_is_larger_of_both_sides():
    """σ = 6Fξ/bh² with the height h of the thin side."""
    thick, thin = Rectangle(0.03, 0.08), Rectangle(0.03, 0.04)
    leg, member = cantilever((0.0, thick), (0.6, thick), (0.6, thin), (LENGTH, thin))
    stress = member_stress(leg, member)
    assert stress.station == pytest.approx(0.6)
    # The mesh leaves a shear stress of 2e-3 of the bending stress at the outer face.
    assert stress.largest == pytest.approx(6.0 * FORCE * 0.6 / (0.03 * 0.04**2), rel=1e-5)


def stress_of_clamped_leg(stations, **load):
    """Stress of a clamped leg of length L, its sections at shares of L, under a load at its tip."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (L, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    leg = LineLeg(line, tuple((share * L, section) for share, section in stations), STEEL)
    robot = described(CANTILEVER)
    bodies = {**robot.bodies, "bar": replace(robot.bodies["bar"], shape=leg)}
    loads = (Load("load", robot.tool.body, robot.tool.point, **load),)
    ((forces,),) = load_forces(
        "beam", [reference_posture(replace(robot, bodies=bodies, loads=loads))]
    )
    (member,) = forces.members
    return member_stress(leg, member)


def test_stress_at_step_off_equal_stations_is_found():
    """σ = 6 Fξ/bh² in the thin section at the step. Equal stations are L/20 apart."""
    thick, thin = Rectangle(0.03, 0.08), Rectangle(0.03, 0.04)
    stress = stress_of_clamped_leg(
        ((0.0, thick), (0.63, thick), (0.63, thin), (1.0, thin)),
        wrench=np.array([0.0, 0.0, FORCE, 0.0, 0.0, 0.0]),
    )
    assert stress.station == pytest.approx(0.63 * L, rel=1e-9)
    assert abs(stress.normal) == pytest.approx(6.0 * FORCE * 0.37 * L / (0.03 * 0.04**2), rel=1e-6)
    # Poisson's ratio causes a small shear stress in the outer face.
    assert stress.largest == pytest.approx(abs(stress.normal), rel=1e-5)


@pytest.mark.parametrize("load", [0.0, -1500.0])
def test_peak_between_stations_of_taper_is_found(load):
    """σ = 6 (Fξ + pξ²/2)/bh², h = t + kξ, is largest where Ft = ξ (kF − pt): there dσ/dξ = 0.

    F acts on the tip, p on the length; ξ is the distance from the tip, whose height is t. Without
    Poisson's ratio the outer faces have no shear stress.
    """
    tip, rate = 0.008, (0.1 - 0.008) / LENGTH
    leg, _ = cantilever((0.0, Rectangle(0.03, 0.1)), (LENGTH, Rectangle(0.03, tip)))
    stations = np.linspace(0.0, LENGTH, 21)
    beyond, forces = LENGTH - stations, np.zeros((21, 6))
    forces[:, 2] = FORCE + load * beyond
    forces[:, 4] = -FORCE * beyond - load * beyond**2 / 2.0
    leg = replace(leg, material=Material.isotropic(2.1e11, 0.0, 7850.0))
    stress = member_stress(
        leg, MemberForces("arm", stations, forces, np.zeros(6), np.zeros(21, dtype=int))
    )
    peak = FORCE * tip / (rate * FORCE - load * tip)
    moment = FORCE * peak + load * peak**2 / 2.0
    expected = 6.0 * moment / (0.03 * (tip + rate * peak) ** 2)
    assert stress.station == pytest.approx(LENGTH - peak, abs=1e-3 * LENGTH)
    assert abs(stress.normal) == pytest.approx(expected, rel=2e-6)
    assert abs(stress.largest - expected) <= stress.half_width


def test_half_width_contains_shear_due_to_moment():
    """A moment of half-width ΔM shears the root of a taper by |λ| ΔM, λ = d ln (I/S)/dx.

    The reference is a prism with the section of the root, under the forces that shear it, with a
    half-width of the shear force. λ is a difference quotient.
    """
    root, tip = HollowRectangle(0.06, 0.1, 0.004), HollowRectangle(0.06, 0.08, 0.004)
    leg, member = cantilever((0.0, root), (LENGTH, tip))
    moment, step = 5.0, 1e-6
    arms = [lever_arm(root), lever_arm(replace(root, height=0.1 - step * 0.02))]
    rate = np.log(arms[1] / arms[0]) / (step * LENGTH)
    member = replace(member, half_width=np.array([0.0, 0.0, 0.0, 0.0, moment, 0.0]))
    forces = member.forces[:1] + np.array([0.0, 0.0, rate * FORCE * LENGTH, 0.0, 0.0, 0.0])
    width = np.array([0.0, 0.0, -rate * moment, 0.0, moment, 0.0])
    prism = MemberForces("arm", member.stations[:1], forces, width, member.runs[:1])
    expected = member_stress(ConstantLeg(LENGTH, root, STEEL), prism)
    stress = member_stress(leg, member)
    assert stress.station == 0.0
    assert stress.half_width == pytest.approx(expected.half_width, rel=1e-5)
    alone = replace(prism, half_width=member.half_width)
    without = member_stress(ConstantLeg(LENGTH, root, STEEL), alone)
    assert expected.half_width - without.half_width > 1e-3 * without.half_width


def lever_arm(tube):
    """I/S (m) of a rectangular tube, S the first moment of its upper half."""
    hole = tube.inner
    halves = tube.width * tube.height**2 / 8.0, hole.width * hole.height**2 / 8.0
    return tube.second_moment_y / (halves[0] - halves[1])
