"""Where two computations of the same numbers lie farthest apart."""

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array

# Digits of differences that are more than rounding.
_DIGITS = 8


def farthest(found: Array, reference: Array, known: NDArray[np.bool_] | None = None) -> int:
    """Number of the posture (of p) that is farthest off, relatively, among those `known`.

    Of those off by rounding alone that of the largest number: rounding differs from machine to
    machine. What is not there where it should be is farthest of all.
    """
    looked = np.ones(len(reference), dtype=bool) if known is None else known
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.round(np.abs(found / reference - 1.0), _DIGITS)
    off = np.where(looked, np.where(np.isnan(off), np.inf, off), -1.0)
    return int(np.lexsort((np.where(looked, reference, -np.inf), off))[-1])


def farthest_entry(
    found: Array, reference: Array, left_open: Array | float = 0.0
) -> tuple[float, float, float]:
    """The entries of two compliances (…×n×n) that differ most, in units of √(c_ii c_jj).

    And what is `left_open` of their difference: they are those that differ most beyond it. The
    unit is the power of two next to that of the reference, so that both numbers stay what they are.
    Of entries that differ by rounding alone the largest: rounding differs from machine to machine.
    """
    sizes = np.sqrt(np.abs(np.diagonal(reference, axis1=-2, axis2=-1)))
    scale = sizes[..., :, None] * sizes[..., None, :]
    scale = np.exp2(np.round(np.log2(np.where(scale > 0.0, scale, 1.0))))
    ours, theirs, open_of_both = (
        (one / scale).ravel() for one in (found, reference, left_open + 0.0 * found)
    )
    beyond = np.round(np.abs(ours - theirs) - open_of_both, _DIGITS)
    at = np.lexsort((np.abs(theirs), beyond))[-1]
    return float(ours[at]), float(theirs[at]), float(open_of_both[at])
