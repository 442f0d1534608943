"""Statics and modes of a model in several poses: shapes, superposition, missing numbers."""

import numpy as np
import pytest

from lumped.acceptance.quantities import UNIT_LOADS, load_quantities
from validation.responses.statics_and_modes import PathModes, Statics

POSES, LOADS, FORCES = 4, 3, 5
QUANTITIES = (*UNIT_LOADS, *load_quantities(["a", "b", "c"]))


def statics(seed):
    rng = np.random.default_rng([45, seed])
    return Statics(rng.normal(size=(POSES, 6, 6)), rng.normal(size=(POSES, LOADS, 6)))


def wrenches(*shape):
    return np.random.default_rng(45).normal(size=(POSES, *shape, 6))


@pytest.mark.parametrize(("index", "quantity"), list(enumerate(QUANTITIES)))
def test_displacements_are_compliance_times_load(index, quantity):
    """The order is three deflections, three rotations, any force, then the loads."""
    responses, forces = statics(0), wrenches(FORCES)
    displacements = responses.displacements(quantity, forces)
    assert displacements.shape == (POSES, FORCES, 3)
    part = slice(3, 6) if index in (3, 4, 5) else slice(3)
    for pose in range(POSES):
        for k in range(FORCES):
            expected = responses.compliances[pose] @ forces[pose, k]
            if index > 6:
                expected = responses.load_displacements[pose, index - 7]
            assert displacements[pose, k] == pytest.approx(expected[part], rel=1e-12)
    alone = responses.displacements(quantity, forces[:, 0])
    np.testing.assert_allclose(alone, displacements[:, 0], rtol=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES, ids=str)
def test_displacements_are_linear_in_statics(quantity):
    """3 A − B of two models gives 3 and −1 times their displacements, for each quantity."""
    first, second, forces = statics(1), statics(2), wrenches()
    expected = 3.0 * first.displacements(quantity, forces) - second.displacements(quantity, forces)
    displacements = (3.0 * first - second).displacements(quantity, forces)
    np.testing.assert_allclose(displacements, expected, rtol=1e-12, atol=1e-12)


def test_nan_modes_of_pose_are_omitted():
    """Poses with two and one modes of three; shapes are weighted by the root of the masses."""
    frequencies = np.array([[10.0, 20.0, np.nan], [11.0, np.nan, np.nan]])
    samples = np.random.default_rng(1).normal(size=(2, 4, 3))
    weights, energy_shares = (
        np.array([1.0, 4.0, 9.0, 0.0]),
        np.array([[1.0, 0.5, 0.0], [0.7, 0.0, 0.0]]),
    )
    modes = PathModes(frequencies, samples, weights, energy_shares)
    for pose, count in enumerate((2, 1)):
        modes_of_pose = modes.at(pose)
        assert modes_of_pose.frequencies.tolist() == frequencies[pose, :count].tolist()
        assert modes_of_pose.energy_shares.tolist() == energy_shares[pose, :count].tolist()
        # Columns of unit length, weighed by the roots of the masses.
        weighed = np.array([[1.0], [2.0], [3.0], [0.0]]) * samples[pose][:, :count]
        weighed /= np.linalg.norm(weighed, axis=0)
        np.testing.assert_allclose(modes_of_pose.shapes, weighed, rtol=1e-12)
