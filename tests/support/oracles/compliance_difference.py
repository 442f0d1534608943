"""Difference of two compliance matrices, independent of the units of their entries."""

import numpy as np


def scaled_difference(compliance, reference):
    """Largest |Δc_ij| of two compliances in units of √(c_ii c_jj) of the reference.

    In a positive definite matrix |c_ij| is at most √(c_ii c_jj), so that zero couplings are
    compared, too.
    """
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((compliance - reference) * unit[:, None] * unit).max())
