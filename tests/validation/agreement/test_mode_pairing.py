"""Pairing of modes on cases whose answer is known."""

import numpy as np
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


def test_the_sum_of_all_pairs_decides_and_not_the_best_of_them():
    """Greedy takes 0.9 for the first and leaves 0; together 0.8 + 0.7 is more."""
    assert list(pair_modes(np.array([[0.9, 0.8], [0.7, 0.0]]))) == [1, 0]
    assert list(pair_modes(np.array([[0.9], [0.1]]))) == [0, -1]


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
    assert_allclose(mac_matrix(shapes, -3.0 * shapes, weights), np.eye(6), atol=1e-7)
    reversed_order = mac_matrix(shapes, shapes[:, ::-1], weights)
    assert list(pair_modes(reversed_order)) == [5, 4, 3, 2, 1, 0]
