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


@pytest.mark.parametrize(("place", "quantity"), list(enumerate(QUANTITIES)))
def test_displacements_are_compliance_times_load(place, quantity):
    """The order is three deflections, three rotations, any force, then the loads."""
    own, forces = statics(0), wrenches(FORCES)
    found = own.displacements(quantity, forces)
    assert found.shape == (POSES, FORCES, 3)
    part = slice(3, 6) if place in (3, 4, 5) else slice(3)
    for pose in range(POSES):
        for k in range(FORCES):
            moved = own.compliances[pose] @ forces[pose, k]
            if place > 6:
                moved = own.load_displacements[pose, place - 7]
            assert found[pose, k] == pytest.approx(moved[part], rel=1e-12)
    alone = own.displacements(quantity, forces[:, 0])
    np.testing.assert_allclose(alone, found[:, 0], rtol=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES, ids=str)
def test_statics_are_linear_in_displacements(quantity):
    one, other, forces = statics(1), statics(2), wrenches()
    moved = 3.0 * one.displacements(quantity, forces) - other.displacements(quantity, forces)
    found = (3.0 * one - other).displacements(quantity, forces)
    np.testing.assert_allclose(found, moved, rtol=1e-12, atol=1e-12)


def test_nan_modes_of_pose_are_omitted():
    frequencies = np.array([[10.0, 20.0, np.nan], [11.0, np.nan, np.nan]])
    samples = np.random.default_rng(1).normal(size=(2, 4, 3))
    weights, seen = np.array([1.0, 4.0, 9.0, 0.0]), np.array([[1.0, 0.5, 0.0], [0.7, 0.0, 0.0]])
    modes = PathModes(frequencies, samples, weights, seen)
    for pose, count in enumerate((2, 1)):
        found = modes.at(pose)
        assert found.frequencies.tolist() == frequencies[pose, :count].tolist()
        assert found.energy_shares.tolist() == seen[pose, :count].tolist()
        # Columns of unit length, weighed by the roots of the masses.
        weighed = np.array([[1.0], [2.0], [3.0], [0.0]]) * samples[pose][:, :count]
        weighed /= np.linalg.norm(weighed, axis=0)
        np.testing.assert_allclose(found.shapes, weighed, rtol=1e-12)
