"""Numerical uncertainty of a part's numbers from three meshes that are alike.

Roache's grid convergence index with the order that the three meshes show, between one and four:
edges of rigidly held faces are singular, and the order there is below that of the elements. Where
the three do not converge monotonically, which tetrahedra need not, three times their spread.
"""

import numpy as np

from lumped.arrays import Array
from meshes.part.volume import RATIO

_LOWEST, _FORMAL = 1.0, 4.0
# Roache's factors: three meshes that show an order, and meshes that show none.
_SAFETY, _UNPROVEN = 1.25, 3.0
# Relative rounding of compliances and frequencies: below it a refinement shows nothing.
_ROUND_OFF = 1e-9


def refinement_uncertainty(coarse: Array, middle: Array, fine: Array) -> Array:
    """Uncertainty (in the unit of the values, their shape) of the values on the finest mesh.

    An order below one is taken as one, and one above that of the elements as theirs.
    """
    first, second = middle - coarse, fine - middle
    with np.errstate(divide="ignore", invalid="ignore"):
        order = np.log(np.abs(first / second)) / np.log(RATIO)
    shown = np.clip(np.nan_to_num(order, nan=_LOWEST, posinf=_FORMAL), _LOWEST, _FORMAL)
    index = _SAFETY * np.abs(second) / (RATIO**shown - 1.0)
    spread = _UNPROVEN * np.maximum(np.abs(first), np.abs(second))
    monotone = first * second > 0.0
    return np.asarray(np.where(monotone, index, spread) + _ROUND_OFF * np.abs(fine))
