"""Mechanisms by Ritz's method against bars by hand, symmetry, beams and a foil."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from compliances import scaled_difference
from one_arm import ONE_ARM
from prismatic_legs import STEEL
from scipy.linalg import solve
from written_robot import described

from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.mechanism.body import Frame
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle, Tube
from validation.cases import ritz
from validation.kinematics.poses import postures_of
from validation.models.mechanism import answers
from validation.selftest.benchmarks import hexapod_stiffness

ROCKER = Path(__file__).resolve().parents[3] / "examples" / "rocker" / "robot.toml"
# Beside the stiffness along such a leg rounding took 2e-4 of its torsion, 3e-5 without shear.
FOIL = ConstantLeg(90.0, Tube(2e-4, 1e-6), Material(2.1e11, 1.05e9, -0.9, 7850.0))


def first_pose(name):
    described = load_robot(name).mechanism
    return postures_of(described, described.poses[:1])[0]


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("prism", [ConstantLeg(0.85, Rectangle(0.1, 0.16), STEEL), FOIL])
def test_a_leg_alone_is_the_textbook_cantilever(prism, theory):
    beam = prism.properties(theory)
    found = ritz.of_beam(beam, prism.length, ritz.STATIC_DEGREE)
    free = ritz.free_motions(found.stiffness, found.root)
    loaded = found.tip @ free
    compliance = loaded @ solve(free.T @ found.stiffness @ free, loaded.T, assume_a="pos")
    assert scaled_difference(compliance, tip_compliance(beam, prism.length)) < 3e-6


def test_a_hexapod_has_the_stiffness_of_its_bars():
    at = first_pose("hexapod")
    stiffness = hexapod_stiffness(at.mechanism, at.pose)
    np.testing.assert_allclose(ritz.compliance(at) @ stiffness, np.eye(6), atol=1e-8)


@pytest.mark.parametrize("softer", [1e-12, 1e6])
def test_frequencies_may_be_of_any_size(softer):
    """Rods that idle among them: of all stiffnesses the root."""
    at = first_pose("delta")

    def scaled(thing, *names):
        return replace(thing, **{name: softer * getattr(thing, name) for name in names})

    bodies = {
        name: replace(
            body, shape=replace(body.shape, material=scaled(body.shape.material, "E", "G"))
        )
        for name, body in at.mechanism.bodies.items()
        if isinstance(body.shape, ConstantLeg)
    }
    joints = [
        replace(joint, drive=scaled(joint.drive, "stiffness")) if joint.drive else joint
        for joint in at.mechanism.joints
    ]
    changed = replace(at.mechanism, bodies={**at.mechanism.bodies, **bodies}, joints=joints)
    found = ritz.frequencies(replace(at, mechanism=changed), 4)
    np.testing.assert_allclose(found, np.sqrt(softer) * ritz.frequencies(at, 4), rtol=1e-6)


def test_idle_rods_count_as_no_frequency():
    """Six rods of a Delta spin about themselves; in a symmetric pose its modes come in pairs."""
    pair = ritz.frequencies(reference_posture(load_robot("delta").mechanism), 2)
    assert pair[0] > 10.0
    assert pair[1] == pytest.approx(pair[0], rel=1e-7)


def test_parts_are_rigid_bodies_on_the_drives():
    at = first_pose(ROCKER)
    (own,) = answers("simplified", [at], 1)
    compliance, frequencies = ritz.on_drives(at, 1)
    atol = 1e-10 * np.abs(compliance).max()
    np.testing.assert_allclose(own.compliance, compliance, rtol=1e-9, atol=atol)
    np.testing.assert_allclose(own.frequencies, frequencies, rtol=1e-10)


def test_what_no_drive_moves_is_rigid_and_has_no_mode():
    """The arm on a fixed joint: a structure."""
    motor = "axis = [0.0, 0.0, 1.0]\ndrive = { stiffness = 5.0e4 }\n"
    text = ONE_ARM.replace(motor, "").replace('"revolute"', '"fixed"').replace('["x"]', "[]")
    compliance, frequencies = ritz.on_drives(reference_posture(described(text)), 2)
    assert not compliance.any()
    assert len(frequencies) == 0


def test_a_posture_that_is_none_is_refused():
    at = first_pose("five-bar")
    rod = at.frames["rod2"]
    moved = Frame(rod.position + np.array([1e-5, 0.0, 0.0]), rod.rotation)
    with pytest.raises(ComputationError, match="elbow2: open by"):
        ritz.compliance(replace(at, frames={**at.frames, "rod2": moved}))
