"""How far two compliances are apart, whatever the units of their entries."""

import numpy as np


def scaled_difference(found, reference):
    """Largest |Δc_ij| of two compliances in units of √(c_ii c_jj) of the reference.

    No entry of a positive matrix is larger: zero couplings count as well, whatever their unit.
    """
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((found - reference) * unit[:, None] * unit).max())
