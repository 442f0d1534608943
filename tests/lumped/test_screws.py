"""Twists and wrenches: rigid-body kinematics by hand, invariance of work, and descriptions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from lumped.screws import (
    move_compliance,
    name_twists,
    name_wrenches,
    rotation_about,
    rotation_vector,
    shift,
    turn_matrix,
)

X, Y, Z = np.eye(3)


@pytest.mark.parametrize(("rotation", "velocity"), [(Z, 2.0 * Y), (Y, -2.0 * Z), (X, np.zeros(3))])
def test_rotation_moves_distant_point(rotation, velocity):
    """B lies 2 m from A along x: a rotation about z moves B along +y, one about y along −z."""
    twist = shift(2.0 * X) @ np.concatenate([np.zeros(3), rotation])
    assert_allclose(twist, np.concatenate([velocity, rotation]), atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-150, 1e-9, 0.7, 2.0, np.pi - 1e-9, np.pi])
def test_rotation_vectors_equal_scipy(angle):
    """Angles from zero to half a turn, in both directions of the conversion."""
    axes = np.random.default_rng(0).normal(size=(50, 3))
    vectors = angle * axes / np.linalg.norm(axes, axis=1, keepdims=True)
    rotations = Rotation.from_rotvec(vectors).as_matrix()
    assert_allclose(rotation_about(vectors), rotations, atol=1e-14)
    recovered = rotation_vector(rotations)
    assert_allclose(np.linalg.norm(recovered, axis=1), angle, rtol=1e-14)
    # Compared as matrices, because half a turn about an axis and about its opposite is the same.
    assert_allclose(rotation_about(recovered), rotations, atol=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_transformation_keeps_energy(seed):
    """The energy f·C·f is unchanged if load and compliance are moved to another point."""
    rng = np.random.default_rng(seed)
    factor, wrench, offset = rng.normal(size=(6, 6)), rng.normal(size=6), rng.normal(size=3)
    compliance, R = factor @ factor.T, Rotation.random(random_state=rng).as_matrix()
    moved_compliance = move_compliance(turn_matrix(compliance, R), offset)
    force, moment = wrench[:3], wrench[3:] + np.cross(offset, wrench[:3])
    local = np.concatenate([force @ R, moment @ R])
    assert wrench @ moved_compliance @ wrench == pytest.approx(
        local @ compliance @ local, rel=1e-10
    )


@pytest.mark.parametrize(
    ("name", "screws", "words"),
    [
        (name_twists, [[0, 0, -3, 0, 0, 0]], "translate along z"),
        # Rotation about a z axis through x = −0.5 m moves the loaded point along +y.
        (name_twists, [[0, 0.5, 0, 0, 0, 1]], "turn about z through (-0.5, 0, 0) m from B"),
        (name_twists, [[0, 0, 0.02, 0, 0, 1]], "turn about z through B with a pitch of 0.02 m/rad"),
        (
            name_twists,
            [[0.3, 1, 0, 0, 0, 1], [0, 1, 0, 0, 0, 0]],
            "turn about z through (0, 0.3, 0) m from B and translate along y",
        ),
        (name_wrenches, [[0, 7, 0, 0, 0, 0]], "a force along y through B"),
        (name_wrenches, [[0, 0, 0, 0, 0, 2]], "a moment about z"),
        # r × F = (0.5, 0, 0) × (0, 1, 0) = (0, 0, 0.5)
        (name_wrenches, [[0, 1, 0, 0, 0, 0.5]], "a force along y through (0.5, 0, 0) m from B"),
    ],
)
def test_twist_and_wrench_have_descriptions(name, screws, words):
    """Such as "turn about z through a point" and "a force along y"."""
    description = name(np.array(screws, dtype=float), 0.8)
    assert description.replace("the loaded point", "B") == words
