"""Twists and wrenches: rigid-body kinematics by hand, the work that must not change, and words."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from lumped.screws import move_compliance, name_twists, name_wrenches, shift, turn_matrix

X, Y, Z = np.eye(3)
LENGTH = 0.8


@pytest.mark.parametrize(("rotation", "velocity"), [(Z, 2.0 * Y), (Y, -2.0 * Z), (X, np.zeros(3))])
def test_a_turning_body_moves_the_point_in_front(rotation, velocity):
    """B lies 2 m along x of A: about z it goes to +y, about y to −z, about x nowhere."""
    moved = shift(2.0 * X) @ np.concatenate([np.zeros(3), rotation])
    assert_allclose(moved, np.concatenate([velocity, rotation]), atol=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_turned_and_moved_compliance_keeps_the_energy(seed):
    """The energy f·C·f is that of the same load carried back to the first point and axes."""
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(6, 6))
    compliance, wrench, offset = factor @ factor.T, rng.normal(size=6), rng.normal(size=3)
    R = Rotation.random(random_state=rng).as_matrix()
    moved = move_compliance(turn_matrix(compliance, R), offset)
    at_first = wrench.copy()
    at_first[3:] += np.cross(offset, wrench[:3])
    local = np.concatenate([R.T @ at_first[:3], R.T @ at_first[3:]])
    assert wrench @ moved @ wrench == pytest.approx(local @ compliance @ local, rel=1e-10)


@pytest.mark.parametrize(
    ("twists", "words"),
    [
        ([[0, 0, -3, 0, 0, 0]], "translate along z"),
        # The loaded point moves along +y when the robot turns about z at 0.5 m on its −x side.
        ([[0, 0.5, 0, 0, 0, 1]], "turn about z through (-0.5, 0, 0) m from the loaded point"),
        (
            [[0, 0, 0.02, 0, 0, 1]],
            "turn about z through the loaded point with a pitch of 0.02 m/rad",
        ),
        (
            [[1, 1, 0, 0, 0, 0], [1, -1, 0, 0, 0, 0]],
            "translate along x and translate along y",
        ),
        (
            [[0.3, 1, 0, 0, 0, 1], [0, 1, 0, 0, 0, 0]],
            "turn about z through (0, 0.3, 0) m from the loaded point and translate along y",
        ),
    ],
)
def test_twists_in_words(twists, words):
    assert name_twists(np.array(twists, dtype=float), LENGTH) == words


@pytest.mark.parametrize(
    ("wrenches", "words"),
    [
        ([[0, 7, 0, 0, 0, 0]], "a force along y through the loaded point"),
        ([[0, 0, 0, 0, 0, 2]], "a moment about z"),
        # r × F = (0.5, 0, 0) × (0, 1, 0) = (0, 0, 0.5)
        ([[0, 1, 0, 0, 0, 0.5]], "a force along y through (0.5, 0, 0) m from the loaded point"),
    ],
)
def test_wrenches_in_words(wrenches, words):
    assert name_wrenches(np.array(wrenches, dtype=float), LENGTH) == words
