"""The posture and the entry that are shown of many."""

import numpy as np
import pytest

from validation.agreement.farthest import farthest


@pytest.mark.parametrize("off", [0.01, -0.01])
@pytest.mark.parametrize("place", range(4))
def test_the_posture_shown_is_the_one_that_is_farthest_off(off, place):
    even = np.array([2.0, 4.0, 8.0, 16.0])
    found = even * (1.0 + off * np.where(np.arange(4) == place, 1.0, 0.5))
    assert farthest(found, even) == place
