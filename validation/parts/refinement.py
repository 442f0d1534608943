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
from validation.agreement.mesh_half_widths import MeshPolicy, mesh_half_widths

# Relative rounding of compliances and frequencies: below it a refinement shows nothing.
_ROUND_OFF = 1e-9
# Between similar meshes of tetrahedra.
TETRAHEDRA = MeshPolicy(RATIO, orders=(1.0, 2.0), safety=1.5, round_off=_ROUND_OFF)


def refinement_uncertainty(
    coarse: Array, middle: Array, fine: Array, scale: Array | None = None
) -> Array:
    """Uncertainty (in the unit of the values, their shape) of the values on the finest mesh.

    `scale` is what changes are relative to (the values' shape), the values themselves if None.
    A number whose scale is 0 has no uncertainty. NaN stays NaN.
    """
    size = np.abs(fine) if scale is None else scale
    changes = [
        np.divide(np.abs(change), size, out=np.zeros_like(size), where=size != 0.0)
        for change in (middle - coarse, fine - middle)
    ]
    return np.asarray(mesh_half_widths(changes, TETRAHEDRA) * size)


def compliance_uncertainty(coarse: Array, middle: Array, fine: Array) -> Array:
    """The same of a compliance matrix (k×k), entries relative to the diagonal's."""
    root = np.sqrt(np.diag(fine))
    return refinement_uncertainty(coarse, middle, fine, np.outer(root, root))
