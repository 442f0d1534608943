"""Mechanisms by Ritz's method against bars by hand, symmetry and the mechanism of a biglide."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.biglide import postures
from lumped.errors import ComputationError
from lumped.mechanism.body import Frame, Prism
from lumped.mechanism.joint import Drive
from lumped.robot_file import load_robot
from validation.kinematics.poses import postures_of
from validation.studies.ritz import biglide, mechanism

IFW = load_robot("ifw").robot


def first_pose(name):
    described = load_robot(name).mechanism
    return postures_of(described, described.poses[:1])[0]


def test_the_biglide_as_a_mechanism_is_the_biglide():
    """Two descriptions of one robot: its elastic feet in series with slides, legs by their 6×6."""
    x = IFW.centre
    (at,) = postures(IFW, (x,))
    found, expected = mechanism.compliance(at), biglide.compliance(IFW, x, "given")
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(
        mechanism.frequencies(at, 4), biglide.frequencies(IFW, x, 4), rtol=1e-6
    )


def test_a_hexapod_has_the_stiffness_of_its_bars():
    at = first_pose("hexapod")
    stiffness = np.zeros((6, 6))
    for number in range(1, 7):
        bodies = (f"strut{number}", f"rod{number}")
        shapes = [at.mechanism.bodies[name].shape for name in bodies]
        give = sum(s.length / (s.material.E * s.section.area) for s in shapes)
        drive = next(j.drive for j in at.mechanism.joints if j.name == f"drive{number}")
        give += 1.0 / drive.stiffness
        rod = at.frames[f"rod{number}"]
        along = rod.rotation[:, 0]
        tip = (rod @ at.mechanism.bodies[f"rod{number}"].interfaces[f"Q{number}"]).position
        screw = np.concatenate([along, np.cross(tip - at.pose[:3], along)])
        stiffness += np.outer(screw, screw) / give
    found = mechanism.compliance(at)
    np.testing.assert_allclose(found @ stiffness, np.eye(6), atol=1e-8)


@pytest.mark.parametrize("softer", [1e-12, 1e-6, 1e6])
def test_frequencies_may_be_of_any_size(softer):
    """Rods that idle among them: of all stiffnesses the root."""
    at = first_pose("delta")
    described = at.mechanism
    bodies = {
        name: body
        if not isinstance(body.shape, Prism)
        else replace(body, shape=replace(body.shape, material=scaled(body.shape.material, softer)))
        for name, body in described.bodies.items()
    }
    joints = [
        joint
        if joint.drive is None
        else replace(joint, drive=Drive(softer * joint.drive.stiffness))
        for joint in described.joints
    ]
    found = mechanism.frequencies(
        replace(at, mechanism=replace(described, bodies=bodies, joints=joints)), 4
    )
    np.testing.assert_allclose(found, np.sqrt(softer) * mechanism.frequencies(at, 4), rtol=1e-6)


def scaled(material, factor):
    return replace(material, E=factor * material.E, G=factor * material.G)


def test_idle_rods_count_as_no_frequency():
    """Six rods of a Delta spin about themselves; in a symmetric pose its modes come in pairs."""
    at = first_pose("delta")
    found = mechanism.frequencies(at, 4)
    assert found[0] > 10.0
    described = load_robot("delta").mechanism
    (symmetric,) = postures_of(described, described.reference_pose[None])
    pair = mechanism.frequencies(symmetric, 2)
    assert pair[1] == pytest.approx(pair[0], rel=1e-7)


def test_a_posture_that_is_none_is_refused():
    at = first_pose("five-bar")
    moved = dict(at.frames)
    rod = moved["rod2"]
    moved["rod2"] = Frame(rod.position + np.array([1e-5, 0.0, 0.0]), rod.rotation)
    with pytest.raises(ComputationError, match="elbow2: open by"):
        mechanism.compliance(replace(at, frames=moved))
