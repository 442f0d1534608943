"""Measurements of one number: the farthest of what should be nothing, and what two meshes give."""

import numpy as np
from numpy.typing import ArrayLike

from validation.agreement.convergence import step_factor
from validation.case import Measurement


def farthest_off(off: ArrayLike) -> Measurement:
    """The largest amount of numbers that should all be zero, nothing of them discretised."""
    return Measurement(float(np.abs(off).max()), 0.0, exact=True)


def refined(
    coarse: float, fine: float, reference: float = 0.0, *, order: float, ratio: float = 2.0
) -> Measurement:
    """A number on the finer of two meshes, `ratio` apart, that converges with `order`.

    The step between them is what leaves it uncertain (`step_factor`); `reference` is exact.
    """
    uncertain = step_factor(ratio, order) * abs(fine - coarse)
    return Measurement(float(fine), float(reference), value_uncertainty=float(uncertain))
