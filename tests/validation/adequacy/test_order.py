"""Verdicts on the order of modes, for known permutations."""

from dataclasses import replace

import numpy as np
import pytest
from support.fakes.toy_responses import model as toy_model
from support.fakes.toy_responses import reference
from support.fakes.toy_subject import toy_subject

from lumped.acceptance.requirement import Requirement
from validation.adequacy.judgement import verdict_matrix
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes

SAMPLES, JUDGED, LIMIT = 24, 7, 0.05


def families(rng):
    """Multiplicities of a robot's frequencies, its frequencies (Hz), and those of a model (Hz).

    Neighbouring frequencies differ by 1 to 9 %. Those of the model differ by up to 40 % from the
    robot's.
    """
    sizes = rng.choice([1, 1, 2, 3], 6)
    frequencies = 100.0 * np.cumprod(rng.uniform(1.01, 1.09, len(sizes)))
    factors = np.where(rng.random(len(sizes)) < 0.4, rng.uniform(0.6, 1.4, len(sizes)), 1.001)
    return sizes, frequencies, frequencies * factors


def vibration(rng, sizes, frequencies, shapes):
    """Modes in ascending order, mixed at random if frequencies are equal, and their families."""
    places = np.split(np.arange(sizes.sum()), np.cumsum(sizes)[:-1])
    order = np.argsort(frequencies)
    turned = [
        shapes[:, places[k]] @ np.linalg.qr(rng.normal(size=(sizes[k],) * 2))[0] for k in order
    ]
    repeated = np.repeat(frequencies[order], sizes[order])
    visible = np.ones((1, sizes.sum()))
    modes = PathModes(repeated[None], np.hstack(turned)[None], np.ones(SAMPLES), visible)
    return modes, np.repeat(order, sizes[order])


@pytest.mark.parametrize("seed", range(40))
def test_mode_order_follows_families(seed):
    """Mode k of the model is in order if mode k of the robot has the same repeated frequency."""
    rng = np.random.default_rng([43, seed])
    sizes, true_frequencies, model_frequencies = families(rng)
    shapes = np.linalg.qr(rng.normal(size=(SAMPLES, sizes.sum())))[0]
    truth, of_truth = vibration(rng, sizes, true_frequencies, shapes)
    model, of_model = vibration(rng, sizes, model_frequencies, shapes)
    count = min(JUDGED, sizes.sum())
    subject = replace(
        toy_subject(SAMPLES),
        models=[toy_model("model", modes=model)],
        dynamics=reference("truth", {"": truth}),
    )
    matrix = verdict_matrix(subject, Requirement(frequency=LIMIT, modes=count))
    for mode in range(count):
        entry = matrix.entry("model", f"f{mode + 1}")
        family = of_truth[mode]
        assert entry.error == pytest.approx(
            model_frequencies[family] / true_frequencies[family] - 1.0, abs=1e-9
        )
    has_moved = of_truth[:count] != of_model[:count]
    misled = np.where(
        has_moved,
        model_frequencies[of_model[:count]] / true_frequencies[of_truth[:count]] - 1.0,
        0.0,
    )
    order = matrix.entry("model", "order")
    # Families of different sizes shift the members of those between them.
    places = [
        np.flatnonzero(of_model == family)[: (of_truth[:count] == family).sum()]
        for family in dict.fromkeys(of_truth[:count])
    ]
    shifted = np.concatenate(places) != np.arange(count)
    expected = np.where(shifted, model.frequencies[0, :count] / truth.frequencies[0, :count] - 1, 0)
    assert abs(order.error) == pytest.approx(np.abs(expected).max(), abs=1e-9)
    assert abs(order.error) >= np.abs(misled).max() - 1e-9
    assert order.verdict == ("inadequate" if abs(order.error) > LIMIT else "adequate")


@pytest.mark.parametrize("seed", range(20))
def test_frequency_error_needs_partner(seed):
    """A model lacks three of nine modes of close frequencies.

    Reference modes without a partner have no error, and no mode of the model is a partner twice.
    """
    rng = np.random.default_rng([44, seed])
    shapes = np.linalg.qr(rng.normal(size=(SAMPLES, 9)))[0]
    frequencies = 100.0 * np.cumprod(rng.uniform(1.0, 1.09, 9))
    partner_modes = np.sort(rng.permutation(9)[:6])
    order = rng.permutation(partner_modes)
    weights = np.ones(SAMPLES)
    model = PathModes(frequencies[None, :6], shapes[None][:, :, order], weights, np.ones((1, 6)))
    truth = PathModes(frequencies[None], shapes[None], weights, np.ones((1, 9)))
    pairs = partners(truth, model, 9)
    assert (np.isnan(pairs.frequency) == (pairs.partner_indices < 0)).all()
    expected = [int(np.flatnonzero(order == k)[0]) if k in partner_modes else -1 for k in range(9)]
    assert pairs.partner_indices[0].tolist() == expected
    has_partner = pairs.partner_indices[0] >= 0
    np.testing.assert_array_equal(
        pairs.frequency[0, has_partner], frequencies[pairs.partner_indices[0, has_partner]]
    )
