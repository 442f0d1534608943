"""Loads along legs: section forces by hand, and load vectors of solids and of beams."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.beam_properties import prism_sections
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import LineLoad
from lumped.sections import Rectangle
from lumped.system.line_loads import end_wrenches
from validation.models.leg_models import condensed_leg
from validation.models.loads.stability import stabilities
from validation.models.loads.statics import displacements, load_forces
from validation.models.options import ModelOptions
from validation.references.mesh_uncertainty import LINE_ON_BEAMS

LENGTH, LOAD = 0.8, 500.0
ARM = f"""
schema = 2
name = "arm"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
materials.steel = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
tool = {{ body = "arm", point = "P", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "arm"], at = "A" }}
[bodies.arm]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = 0.03, height = 0.05 }}
material = "steel"
[[loads]]
name = "snow"
lines = [{{ leg = "arm", wrench = [0.0, 0.0, -{LOAD}, 0.0, 0.0, 0.0], from = 0.2 }}]
"""


@pytest.mark.parametrize("model", ["beam", "segments", "links", "vjm", "simplified"])
def test_line_load_section_forces_are_exact(model):
    """Beyond 0.2 m: shear −q(L − x) and moment q(L − x)²/2. Below 0.2 m the shear is constant."""
    arm_posture = reference_posture(described(ARM))
    ((forces,),) = load_forces(model, [arm_posture], ModelOptions(elements=3))
    (member,) = forces.members
    beyond = LENGTH - np.maximum(member.stations, 0.2)
    shear = -LOAD * beyond
    centre = np.maximum(member.stations, 0.2) + beyond / 2.0
    moment = LOAD * beyond * (centre - member.stations)
    size = LOAD * LENGTH
    np.testing.assert_allclose(member.forces[:, 2], shear, atol=1e-9 * size)
    np.testing.assert_allclose(member.forces[:, 4], moment, atol=1e-9 * size)
    assert (member.half_width <= 1e-6 * size).all()
    # The clamp acts on its second body, the arm.
    (reaction,) = forces.reactions
    assert np.linalg.norm(reaction.wrench[:3]) == pytest.approx(LOAD * 0.6, rel=1e-9)
    assert np.linalg.norm(reaction.wrench[3:]) == pytest.approx(LOAD * 0.6 * 0.5, rel=1e-9)


def test_partial_load_follows_model_theory():
    """Without shear, ∫ q (x³/3 + x²(L − x)/2)/EI dx; shear adds ∫ q x/κGA dx."""
    arm_posture = reference_posture(described(ARM))
    x = np.polynomial.Polynomial([0.0, 1.0])
    leg = ConstantLeg(LENGTH, Rectangle(0.03, 0.05), Material.isotropic(2.1e11, 0.3, 7850.0))
    bent = (x**3 / 3.0 + x**2 * (LENGTH - x) / 2.0).integ()
    bending = (bent(LENGTH) - bent(0.2)) / leg.timoshenko.EIy
    shear = (LENGTH**2 - 0.2**2) / 2.0 / leg.timoshenko.GAz
    for theory, expected in (("euler-bernoulli", bending), ("timoshenko", bending + shear)):
        (((_, _, z, *_),),) = displacements(
            "beam", [arm_posture], ModelOptions(theory=theory, elements=2)
        )
        assert z == pytest.approx(-LOAD * expected, rel=1e-10)


def test_column_buckles_under_axial_line_load():
    """A cantilever buckles under axial q = 7.837 EI/L³ per length (Timoshenko & Gere, §2.12)."""
    text = ARM.replace("0.03, height = 0.05", "0.02, height = 0.02")
    line = 'wrench = [-1.0e4, 0.0, 0.0, 0.0, 0.0, 0.0], axes = "leg"'
    text = text.replace(f"wrench = [0.0, 0.0, -{LOAD}, 0.0, 0.0, 0.0], from = 0.2", line)
    ((stability,),) = stabilities("beam", [reference_posture(described(text))])
    leg = ConstantLeg(LENGTH, Rectangle(0.02, 0.02), Material.isotropic(2.1e11, 0.3, 7850.0))
    critical = 7.837 * leg.timoshenko.EIy / LENGTH**3
    # Shear lowers it by P/κGA = 1e-3 of a leg 40 times as long as high.
    assert stability.factor == pytest.approx(critical / 1e4, rel=3e-3)


@pytest.mark.parametrize(("ratio", "least"), [(5.0, 5e-3), (15.0, 1e-3)])
def test_solid_load_vector_has_end_effects(ratio, least):
    """The load vector ∫ Nᵀq with the static shapes N of a solid differs from that of a beam.

    Restrained warping and contraction at the end faces change N by the ratio of their decay length
    to the length of the leg.
    """
    leg = ConstantLeg(
        ratio * 0.05, Rectangle(0.03, 0.05), Material.isotropic(2.1e11, 0.3, 7850.0), "rigid"
    )
    solid = condensed_leg("solid", leg, ModelOptions(ends="rigid", divisions=2))
    line = np.array([100.0, 200.0, 300.0, 1.0, 2.0, 3.0])
    points, weights = np.polynomial.legendre.leggauss(40)
    half = leg.length / 4.0
    fields = solid.centreline(half * (1.0 + points)).toarray().reshape(40, 6, 12)
    load_vector = (half * np.einsum("s,sij,i->j", weights, fields, line)).reshape(2, 6)
    sections = prism_sections(leg.timoshenko, leg.length)
    expected = end_wrenches(sections, LineLoad(0.0, 2.0 * half, line, line))
    difference = np.abs(load_vector[1] / expected[1] - 1.0).max()
    assert least < difference < LINE_ON_BEAMS * 5.0 / ratio
