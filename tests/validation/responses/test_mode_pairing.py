"""Pairing of modes against naive oracles: assignment of shapes, principal angles, permutations."""

import numpy as np
import pytest
from scipy.linalg import subspace_angles
from scipy.optimize import linear_sum_assignment

from validation.responses.mode_pairing import (
    equal_frequency_groups,
    mac_matrix,
    pair_modes,
    sampled_modes,
    space_mac,
)

SAMPLES, MODES = 30, 8
RNG_OF = np.random.default_rng


def modes_of(frequencies, shapes, weights, energy_shares=None):
    return sampled_modes(frequencies, np.sqrt(weights)[:, None] * shapes, energy_shares)


def orthonormal(rng, count):
    """Random shapes (k×m, m = `count`), mass-normalised by the masses (k), and these masses."""
    weights = rng.uniform(0.5, 2.0, SAMPLES)
    basis = np.linalg.qr(rng.normal(size=(SAMPLES, count)))[0]
    return basis / np.sqrt(weights)[:, None], weights


def rotation(rng, size):
    return np.linalg.qr(rng.normal(size=(size, size)))[0]


@pytest.mark.parametrize("seed", range(20))
def test_separate_modes_have_partners(seed):
    """Shapes are rotated by up to 15° and shuffled.

    The samples contain a part of each mode's energy.
    """
    rng = RNG_OF([1, seed])
    shapes, weights = orthonormal(rng, MODES + 2)
    other_shapes = shapes + 0.04 * rng.normal(size=shapes.shape)
    other_shapes = (other_shapes * rng.choice([1.0, -1.0], MODES + 2))[
        :, rng.permutation(MODES + 2)
    ]
    energy_shares = rng.uniform(0.75, 1.0, MODES)
    first_modes = modes_of(np.arange(1.0, MODES + 1), shapes[:, :MODES], weights, energy_shares)
    frequencies = np.cumsum(rng.uniform(0.01, 1.0, MODES + 2)) + 1.0
    pairs = pair_modes(first_modes, modes_of(frequencies, other_shapes, weights))
    # The same, one entry after the other.
    expected = np.zeros((MODES, MODES + 2))
    for i, j in np.ndindex(*expected.shape):
        a, b = shapes[:, i], other_shapes[:, j]
        mac = (a * weights @ b) ** 2 / (a * weights @ a) / (b * weights @ b)
        expected[i, j] = mac * energy_shares[i]
    rows, columns = linear_sum_assignment(expected, maximize=True)
    assert pairs.partner.tolist() == columns.tolist()
    assert pairs.mac == pytest.approx(expected[rows, columns], rel=1e-10)
    assert not pairs.mixed.any()
    assert not pairs.undecided.any()


def test_pairs_maximise_sum_of_mac():
    """A greedy choice takes 0.6 and leaves 0; the best pairs have 0.5 + 0.5."""
    first, second = [1.0, 0.0, 0.0, 0.0], [0.5, 0.5057, 0.7030, 0.0]
    other_shapes = [[0.7746, 0.6325, 0.0, 0.0], [0.7071, -0.2126, -0.35, 0.5762]]
    first_modes, second_modes = (
        modes_of(np.array([1.0, 2.0]), np.transpose(shapes), np.ones(4))
        for shapes in ([first, second], other_shapes)
    )
    np.testing.assert_allclose(
        mac_matrix(first_modes, second_modes), [[0.6, 0.5], [0.5, 0.0]], atol=1e-3
    )
    assert pair_modes(first_modes, second_modes).nearest.tolist() == [1, 0]
    alone = modes_of(np.array([1.0]), np.transpose(other_shapes[:1]), np.ones(4))
    assert pair_modes(first_modes, alone).nearest.tolist() == [0, -1]


@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_repeated_modes_use_principal_angles(size, tilt):
    """MAC of two and three equal frequencies: cos² of SciPy's `subspace_angles`."""
    rng = RNG_OF([2, size])
    shapes, weights = orthonormal(rng, 6)
    repeated, single = shapes[:, :size], shapes[:, size : size + 2]
    rotated = repeated @ rotation(rng, size)
    rotated[:, 0] = np.cos(tilt) * rotated[:, 0] + np.sin(tilt) * shapes[:, 5]
    # The pair or triple is the first of one model and the last of the other.
    first_modes = modes_of(
        np.repeat([10.0, 20.0, 30.0], [size, 1, 1]), np.hstack([repeated, single]), weights
    )
    turned = modes_of(
        np.repeat([12.0, 21.0, 40.0], [1, 1, size]), np.hstack([single, rotated]), weights
    )
    pairs = pair_modes(first_modes, turned)
    assert pairs.partner.tolist() == [*range(2, 2 + size), 0, 1]
    root = np.sqrt(weights)[:, None]
    expected = np.cos(subspace_angles(root * repeated, root * rotated)) ** 2
    np.testing.assert_allclose(np.sort(pairs.mac[:size]), np.sort(expected), atol=1e-12)
    np.testing.assert_allclose(pairs.mac[size:], 1.0, atol=1e-12)


def test_missing_mode_of_triple_has_no_partner():
    """Two of three equal frequencies have partners with a MAC of 1."""
    shapes, weights = orthonormal(RNG_OF(3), 4)
    triple = modes_of(np.full(3, 10.0), shapes[:, :3] @ rotation(RNG_OF(4), 3), weights)
    other = modes_of(np.full(3, 11.0), shapes[:, [0, 1, 3]], weights)
    pairs = pair_modes(triple, other)
    assert pairs.partner.tolist() == [0, 1, -1]
    assert pairs.mac[:2] == pytest.approx(1.0)


def test_repeated_modes_pair_with_split_ones():
    """The other model has the pair's two shapes at two frequencies: each shape has its partner."""
    rng = RNG_OF(5)
    shapes, weights = orthonormal(rng, 3)
    pair = modes_of(
        np.array([10.0, 10.0, 20.0]),
        np.hstack([shapes[:, :2] @ rotation(rng, 2), shapes[:, 2:]]),
        weights,
    )
    split = modes_of(np.array([9.0, 15.0, 16.0]), shapes[:, [1, 2, 0]], weights)
    assert pair_modes(pair, split).partner.tolist() == [0, 2, 1]
    # Of the pair, the first direction belongs to both.
    assert pair_modes(split, pair).partner.tolist() == [0, 2, 1]
    np.testing.assert_allclose(space_mac(split, pair)[[0, 2], :2], 1.0, atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_permuted_close_modes_are_recovered(seed):
    """Neighbouring frequencies differ by 1 to 8 %, for any number of modes."""
    rng = RNG_OF([6, seed])
    shapes, weights = orthonormal(rng, MODES)
    frequencies = 100.0 * np.cumprod(rng.uniform(1.01, 1.08, MODES))
    order = rng.permutation(MODES)
    modes = modes_of(frequencies, shapes, weights)
    pairs = pair_modes(modes, modes_of(0.97 * frequencies, shapes[:, order], weights))
    assert pairs.partner.tolist() == np.argsort(order).tolist()
    assert pairs.ordered.tolist() == pairs.partner.tolist()


@pytest.mark.parametrize(("degrees", "mixed"), [(0.0, False), (30.0, False), (45.0, True)])
def test_shapes_turned_by_45_degrees_are_mixed(degrees, mixed):
    """Two close modes are paired one by one if turned by 30°, and as a mixed pair at 45°."""
    shapes, weights = orthonormal(RNG_OF(7), 2)
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turned = shapes @ np.array([[cosine, -sine], [sine, cosine]])
    modes, rotated = (
        modes_of(np.array([10.0, 10.5]), sampled, weights) for sampled in (shapes, turned)
    )
    pairs = pair_modes(modes, rotated)
    assert pairs.mixed.any() == mixed
    assert sorted(pairs.partner) == [0, 1]
    np.testing.assert_allclose(pairs.mac, 1.0 if mixed else cosine**2, atol=1e-12)


@pytest.mark.parametrize("share", [0.002, 0.12, 0.3])
def test_local_mode_mac_is_below_energy(share):
    """A local mode looks like a model's mode at the samples: MAC = its energy share there."""
    shapes, weights = orthonormal(RNG_OF(8), 2)
    modes = modes_of(np.array([10.0, 11.0]), shapes, weights, np.array([share, 1.0]))
    other = modes_of(np.array([10.0, 12.0]), shapes, weights)
    np.testing.assert_allclose(mac_matrix(modes, other), np.diag([share, 1.0]), atol=1e-12)
    pairs = pair_modes(modes, other)
    assert pairs.partner.tolist() == [-1, 1]
    assert pairs.mac[0] == pytest.approx(share)
    assert pair_modes(other, modes).partner.tolist() == [-1, 1]


def test_mode_groups_are_not_wider_than_uncertainty():
    """Five frequencies in steps of 0.9 %, uncertain by 1 %, form three groups, not one.

    A frequency without uncertainty is in no group with another one.
    """
    chain = 100.0 * 1.009 ** np.arange(5)
    assert equal_frequency_groups(chain, np.full(5, 0.01)).tolist() == [0, 0, 1, 1, 2]
    assert equal_frequency_groups(chain).tolist() == [0, 1, 2, 3, 4]
    certain = np.array([0.05, 0.0, 0.05, 0.05])
    groups = equal_frequency_groups(np.array([100.0, 101.0, 102.0, 103.0]), certain)
    assert groups.tolist() == [0, 1, 2, 2]
    assert equal_frequency_groups(np.array([100.0, 100.0 + 1e-9, 50.0])).tolist() == [1, 1, 0]
