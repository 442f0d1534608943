"""Half-widths of a part's results from three meshes with one grading.

The tetrahedra of a part change at random from mesh to mesh, so that the observed order of a single
number has little meaning. An order that is high by chance gives too small a half-width: with an
order between one and four for each number, a quarter of random parts lay outside. Therefore all
numbers of one answer have one order together, from the sums of their relative changes. It is
limited to the range from one to two. One is the least order that the edges of held faces and inner
corners leave. Beyond two it is not believed, because walls of one element converge faster at first
than on finer meshes. With the larger safety factor the half-widths contained the error of 95 % and
more of random parts (tests/validation/parts/test_refinement.py, calibration).
"""

import numpy as np

from lumped.arrays import Array
from meshes.part.volume import RATIO
from validation.uncertainty.combiners import relative_sizes
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Relative rounding of compliances and frequencies. Changes below it have no order.
_ROUND_OFF = 1e-9
# Rule of half-widths from meshes of tetrahedra whose sizes have the ratio `RATIO`.
TETRAHEDRA = MeshPolicy(RATIO, orders=(1.0, 2.0), safety=1.5, round_off=_ROUND_OFF)


def refinement_uncertainty(
    coarse: Array, middle: Array, fine: Array, scale: Array | None = None
) -> Array:
    """Half-widths of the values on the finest mesh, with their unit and shape.

    Changes are relative to `scale` (shape of the values). None for the values themselves. A number
    with scale 0 has half-width 0. NaN stays NaN.
    """
    size = np.abs(fine) if scale is None else scale
    changes = [relative_sizes(change, size) for change in (middle - coarse, fine - middle)]
    return np.asarray(mesh_half_widths(changes, TETRAHEDRA) * size)


def compliance_uncertainty(coarse: Array, middle: Array, fine: Array) -> Array:
    """Half-widths of a compliance matrix (k×k), with changes relative to √(cᵢᵢ cⱼⱼ)."""
    root = np.sqrt(np.diag(fine))
    return refinement_uncertainty(coarse, middle, fine, np.outer(root, root))
