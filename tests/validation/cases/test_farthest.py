"""The posture and the entry that are shown of many."""

import numpy as np
import pytest

from validation.cases.other_programs import farthest_entry
from validation.cases.polynomials import farthest


@pytest.mark.parametrize("off", [0.01, -0.01, np.nan])
@pytest.mark.parametrize("place", range(4))
def test_the_posture_shown_is_the_one_that_is_farthest_off(off, place):
    even, anywhere = np.array([2.0, 4.0, 8.0, 16.0]), np.ones(4, dtype=bool)
    found = even * (1.0 + np.where(np.arange(4) == place, off, 0.005))
    assert farthest(found, even, anywhere) == place
    # Of those that are looked at; of those off by rounding alone the largest number.
    assert farthest(found, even, np.arange(4) == 3 - place) == 3 - place
    assert farthest(even * (1.0 + 1e-12 * np.arange(4)[::-1]), even, anywhere) == 3


def test_the_entry_shown_is_in_units_of_its_diagonal():
    reference = np.diag([1.0, 4.0, 16.0])
    found = reference + np.diag([0.01, 0.08, 0.17])
    assert farthest_entry(found, reference) == pytest.approx((1.02, 1.0))
