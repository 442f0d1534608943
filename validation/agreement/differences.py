"""One number of many: the farthest of what should be nothing, and what two meshes give."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from lumped.arrays import Array
from validation.agreement.convergence import step_factor
from validation.case import Measurement


def scaled_difference(found: Array, reference: Array) -> float:
    """Largest |Δc_ij| of two compliances in units of √(c_ii c_jj) of the reference.

    No entry of a positive matrix is larger: zero couplings count as well, whatever their unit.
    """
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((found - reference) * unit[:, None] * unit).max())


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


def farthest_refined(
    coarse: ArrayLike, fine: ArrayLike, *, order: float, ratio: float = 2.0
) -> Measurement:
    """The largest amount on the finer of two meshes of numbers that should all become zero."""
    before, off = np.ravel(coarse), np.ravel(fine)
    worst = int(np.argmax(np.abs(off)))
    found = refined(before[worst], off[worst], order=order, ratio=ratio)
    return replace(found, value=abs(found.value))
