"""A seeded part of the calibration of uncertainties, tests/benchmarks/calibrate_uncertainty.py."""

import numpy as np
from calibration import ROUNDING, coverage, of_statics, random_leg


def test_stated_uncertainties_hold_the_finest_solution():
    numbers = list(of_statics(random_leg(np.random.default_rng(5))))
    assert sum(one.error > ROUNDING for one in numbers) > 4
    held, width = coverage(numbers)
    # Required is 93 % of all legs; one leg's numbers are few and alike.
    assert held >= 0.93
    assert width < 10.0
