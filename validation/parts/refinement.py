"""Half-widths of a CAD part's results from three meshes with one grading.

Input: compliances or frequencies on a coarse, a middle and a fine mesh. Output: half-widths on the
fine mesh. Rule: all numbers have one common order of convergence, the lower one of two. One follows
from the sums of relative changes, the other counts all numbers alike. It is limited to the range
from one to two.

With the sums alone, one number that changes most can claim an order that others do not show: in
`examples/tapered-biglide`, f10 changed by 26 and 11 % with order 2.0, f1 to f9 by 0.3 % with order
0.3, and the half-width of f1 was a third of that with order 1.

The tetrahedra of a part change at random from mesh to mesh, so the observed order of a single
number means little: with an order of its own between one and four for each number, the errors of a
quarter of random parts exceeded their half-widths. The lowest order that edges of rigid faces and
inner corners cause is one. Orders above two are not used, because walls that are one element thick
converge faster at first than on finer meshes. With the safety factor of `TETRAHEDRA`, the
half-widths contained the error of at least 95 % of random parts
(tests/validation/parts/test_refinement.py, calibration).
"""

from collections.abc import Sequence

import numpy as np

from lumped.arrays import Array
from meshes.part.volume import RATIO
from validation.uncertainty.half_widths import MeshPolicy, half_widths_on, relative_sizes

# Relative round-off of compliances and frequencies. Smaller changes have no order.
_ROUND_OFF = 1e-9
# Mesh policy for tetrahedra with the size ratio `RATIO` between meshes.
TETRAHEDRA = MeshPolicy(RATIO, orders=(1.0, 2.0), safety=1.5, round_off=_ROUND_OFF)


def refinement_uncertainty(values: Sequence[Array], scale: Array | None = None) -> Array:
    """Half-widths of values on the finest mesh, in their unit and shape.

    `values`: arrays of equal shape on a coarse, a middle and a fine mesh. If there is only one
    mesh, which cannot be refined, half-widths are NaN. Changes between meshes are relative to
    `scale` (same shape as the values), or to the values if it is None. A number with scale 0 has
    half-width 0. NaN stays NaN.
    """
    *coarser, fine = values
    if not coarser:
        return np.full_like(fine, np.nan)
    size = np.abs(fine) if scale is None else scale
    half_widths = half_widths_on(
        range(len(values)),
        TETRAHEDRA,
        values.__getitem__,
        lambda first, second, _: relative_sizes(second - first, size),
    )
    return half_widths * size


def compliance_uncertainty(compliances: Sequence[Array]) -> Array:
    """Half-widths (k×k) of a compliance matrix on the finest mesh, relative to √(cᵢᵢ cⱼⱼ).

    `compliances` (k×k each) on three meshes or on one, as for `refinement_uncertainty`.
    """
    root = np.sqrt(np.diag(compliances[-1]))
    return refinement_uncertainty(compliances, np.outer(root, root))
