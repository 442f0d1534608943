"""Pairing of modes on cases whose answer is known."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.beams.beam import beam_leg
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import clamped_modes
from lumped.sections import Rectangle
from validation.agreement.mode_pairing import (
    centreline_samples,
    centreline_weights,
    mac_matrix,
    pair_modes,
)


@pytest.mark.parametrize("count", range(1, 7))
def test_pairing_undoes_a_permutation_with_signs_and_noise(count):
    random = np.random.default_rng(count)
    shapes = np.linalg.qr(random.normal(size=(20, 8)))[0]
    weights = np.ones(20)
    order = random.permutation(8)
    signs = random.choice([-1.0, 1.0], size=8)
    mixed = (shapes * signs)[:, order] + 0.01 * random.normal(size=(20, 8))
    mac = mac_matrix(shapes[:, :count], mixed, weights)
    partner = pair_modes(mac)
    assert list(order[partner]) == list(range(count))
    assert np.all(mac[np.arange(count), partner] > 0.95)


def test_mac_is_one_for_multiples_and_zero_for_mass_orthogonal_shapes():
    weights = np.array([2.0, 1.0])
    first = np.array([[1.0], [1.0]])
    orthogonal = np.array([[1.0], [-2.0]])  # 2·1·1 + 1·1·(−2) = 0
    assert_allclose(mac_matrix(first, -3.0 * first, weights), 1.0)
    assert_allclose(mac_matrix(first, orthogonal, weights), 0.0, atol=1e-30)


def test_optimal_pairing_is_better_than_greedy():
    """Greedy takes 0.9 for the first and leaves 0; together 0.8 + 0.7 is more."""
    target = np.sqrt(np.array([[0.9, 0.8], [0.7, 0.0]]))
    first = np.eye(4)[:, :2]
    rest = np.sqrt(1.0 - np.square(target).sum(axis=0).clip(max=1.0))
    second = np.vstack([target / np.maximum(1.0, np.linalg.norm(target, axis=0)), np.diag(rest)])
    assert list(pair_modes(mac_matrix(first, second, np.ones(4)))) == [1, 0]


def test_sampled_modes_of_a_clamped_beam_are_orthogonal_and_find_themselves():
    """In the product of the masses, rotary inertia included (Rayleigh)."""
    leg = ConstantLeg(0.85, Rectangle(0.1, 0.16), Material.isotropic(2.1e11, 0.3, 7850.0))
    beam = beam_leg(leg.timoshenko, leg.length, 20)
    stations, lengths = centreline_samples(leg.length, 24)
    shapes = beam.centreline(stations) @ clamped_modes(beam, 6).shapes
    weights = centreline_weights(leg.timoshenko, lengths)
    per_station = weights.reshape(-1, 6)
    assert_allclose(per_station[:, 1].sum(), leg.mass)
    assert_allclose(per_station[:, 3].sum(), leg.timoshenko.rho_J * 0.85)
    # Gauss stations integrate the first modes to 1e-4 and better, squared in MAC.
    assert_allclose(mac_matrix(shapes, shapes, weights), np.eye(6), atol=1e-7)
    reversed_order = mac_matrix(shapes, shapes[:, ::-1], weights)
    assert list(pair_modes(reversed_order)) == [5, 4, 3, 2, 1, 0]
