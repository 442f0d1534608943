"""One leg alone, root clamped, on a leg so small that everything is known by hand."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csr_matrix, diags_array

from lumped.errors import ComputationError
from lumped.mechanism.body_model import LegMatrices
from lumped.models.cantilever import clamped_modes, tip_compliance_of

SPRINGS = np.array([1e9, 2e6, 3e6, 4e5, 5e5, 6e5])
MASSES = np.array([2.0, 2.0, 2.0, 0.1, 0.2, 0.3])


def spring_leg() -> LegMatrices:
    """Six uncoupled springs between a root and a tip, two in series with a massless inner body."""
    series = np.array([[1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, 2.0]])
    stiffness = np.kron(series, np.diag(2.0 * SPRINGS))
    mass = diags_array(np.r_[MASSES, MASSES, np.zeros(6)])
    return LegMatrices(
        model="springs",
        length=1.0,
        stiffness=csr_matrix(stiffness),
        mass=csr_matrix(mass),
        centreline=lambda stations: csr_matrix((6 * len(stations), 18)),
    )


def test_tip_compliance_of_springs_in_series():
    assert_allclose(tip_compliance_of(spring_leg()), np.diag(1.0 / SPRINGS), rtol=1e-14, atol=1e-22)


def test_clamped_modes_of_springs_in_series():
    modes = clamped_modes(spring_leg(), 6)
    by_hand = np.sort(np.sqrt(SPRINGS / MASSES) / (2.0 * np.pi))
    assert_allclose(modes.frequencies, by_hand, rtol=1e-13)
    assert modes.shapes.shape == (18, 6)
    assert np.all(modes.shapes[:6] == 0.0)
    # The massless body stands half-way between the clamped root and the tip. Frequencies 30 times
    # apart in one eigenproblem: rounding relative to the largest entry, about 1.
    assert_allclose(modes.shapes[12:], 0.5 * modes.shapes[6:12], rtol=1e-12, atol=1e-12)


def test_a_leg_that_is_not_held_is_named():
    broken = spring_leg().stiffness.toarray()
    broken[:, 7] = broken[7, :] = 0.0
    leg = replace(spring_leg(), stiffness=csr_matrix(broken))
    with pytest.raises(ComputationError, match="springs"):
        tip_compliance_of(leg)
