"""Numerical uncertainty of a part's numbers from three meshes that are alike.

Tetrahedra of parts change at random from mesh to mesh, so that the order which a single number
shows means little: high by chance, it would promise too much (with each number its own order
between one and four, a quarter of random parts lay outside). All numbers of one answer show one
order together, by the sums of their relative changes. It is looked for between one, the least that
edges of held faces and inner corners leave, and two: walls that are one element thick converge
faster than they will go on. With the larger factor this held 95 % and more of random parts
(tests/validation/parts/test_refinement.py, calibration).
"""

import numpy as np

from lumped.arrays import Array
from meshes.part.volume import RATIO

_LOWEST, _HIGHEST = 1.0, 2.0
_SAFETY = 1.5
# Relative rounding of compliances and frequencies: below it a refinement shows nothing.
_ROUND_OFF = 1e-9


def refinement_uncertainty(
    coarse: Array, middle: Array, fine: Array, scale: Array | None = None
) -> Array:
    """Uncertainty (in the unit of the values, their shape) of the values on the finest mesh.

    `scale` is what changes are relative to (the values' shape), the values themselves where None.
    Where the scale is 0, nothing is left open. NaN stays NaN.
    """
    size = np.abs(fine) if scale is None else scale
    first, last = (
        np.divide(np.abs(change), size, out=np.zeros_like(size), where=size != 0.0)
        for change in (middle - coarse, fine - middle)
    )
    return np.asarray(left_by_changes(first, last) * size)


def left_by_changes(first: Array, last: Array) -> Array:
    """Relative uncertainty on the finest of three meshes from both relative changes (any shape).

    The last change counts as at least what the order leaves of the one before. NaN stays NaN.
    """
    before, after = float(np.nansum(first)), float(np.nansum(last))
    order = _LOWEST
    if before > after > 0.0:
        order = float(np.clip(np.log(before / after) / np.log(RATIO), _LOWEST, _HIGHEST))
    elif after == 0.0:
        order = _HIGHEST
    falls = RATIO**order
    return np.asarray(_SAFETY * np.maximum(last, first / falls) / (falls - 1.0) + _ROUND_OFF)


def compliance_uncertainty(coarse: Array, middle: Array, fine: Array) -> Array:
    """The same of a compliance matrix (k×k), entries relative to the diagonal's."""
    root = np.sqrt(np.diag(fine))
    return refinement_uncertainty(coarse, middle, fine, np.outer(root, root))
