"""Choices from tables of designs: known losses, and Spearman's ρ against scipy's."""

import numpy as np
import pytest
from scipy import stats

from validation.variations.decision import choice, equally_good, losses, spearman


def test_losses_of_a_known_table():
    # The first chooses its 1.0, where the reference has 2.0 instead of its best 1.6.
    own, reference = np.array([1.0, 2.0, 4.0, 3.0]), np.array([2.0, 1.6, 3.0, 5.0])
    found = choice(own, reference, "deflection")
    assert (found.design, found.equally_good) == (0, (0,))
    assert found.loss == pytest.approx(0.25)
    # Of frequencies the largest is best: 4.0, where the reference has 3.0 of its 5.0.
    assert choice(own, reference, "frequency").loss == pytest.approx(0.4)
    np.testing.assert_allclose(losses(reference, "frequency"), [0.6, 0.68, 0.4, 0.0])


def test_the_indifferent_are_held_in_their_favour():
    # A model of rigid legs finds 1 µm throughout, but for rounding and one design.
    own = 1.0 + np.array([3e-9, 0.5, 0.0, -2e-9])
    reference = np.array([4.0, 1.0, 3.0, 2.0])
    assert equally_good(own, "deflection").tolist() == [0, 2, 3]
    found = choice(own, reference, "deflection")
    assert (found.design, found.loss) == (3, pytest.approx(1.0))
    assert choice(np.zeros(4), reference, "deflection").design == 1


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("levels", [4, 1000])
def test_spearman_is_scipys(seed, levels):
    """With few levels there are ties, which share their mean rank."""
    one, other = np.random.default_rng(seed).integers(1, levels, (2, 9)).astype(float)
    assert spearman(one, other) == pytest.approx(stats.spearmanr(one, other).statistic, abs=1e-12)


def test_rounding_makes_no_order():
    reference = np.arange(1.0, 7.0)
    assert np.isnan(spearman(1.0 + 1e-9 * reference, reference))
    # One exchange of neighbours among n costs 12/(n(n² − 1)).
    exchanged = reference[[1, 0, 2, 3, 4, 5]]
    assert spearman(exchanged, reference) == pytest.approx(1.0 - 12.0 / 210.0)
