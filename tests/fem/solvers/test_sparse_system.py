"""The unreduced solid robot, sparse, against the dense solution of the same matrices."""

from dataclasses import replace

import numpy as np
import pytest
from like_ifw import EQUIVALENT, system_of
from numpy.testing import assert_allclose
from prismatic_legs import meshed

from fem.bodies.solid import solid_leg_matrices
from fem.solvers.sparse_system import compliance, factorised, modes
from lumped.errors import ComputationError
from lumped.models.bodies import legs_of
from lumped.models.segments import segment_chain, static_leg
from lumped.system import solution

LEG_1, LEG_2 = legs_of(EQUIVALENT).values()


def of_slices(*counts):
    legs = zip((LEG_1, LEG_2), counts, strict=True)
    return tuple(solid_leg_matrices(meshed(leg, 1, count)) for leg, count in legs)


@pytest.fixture(scope="module")
def legs():
    return solid_leg_matrices(meshed(LEG_1, 1, 4)), solid_leg_matrices(meshed(LEG_2, 1, 3))


@pytest.mark.parametrize("x", [0.145, 0.4975])
def test_sparse_solutions_equal_dense_ones(legs, x):
    whole = system_of(x, *legs)
    robot = factorised(whole)
    dense = solution.solved(whole)
    expected = solution.compliance(dense)
    scale = 1.0 / np.sqrt(np.diag(expected))
    assert np.abs((compliance(robot) - expected) * scale[:, None] * scale).max() < 1e-10
    found, exact = modes(robot, 12), solution.modes(dense, 12)
    assert_allclose(found.frequencies, exact.frequencies, rtol=1e-9)
    gram = found.shapes.T @ (whole.mass @ exact.shapes)
    assert_allclose(np.abs(gram), np.eye(12), atol=1e-7)
    assert np.array_equal(found.shapes, modes(robot, 12).shapes)


def test_first_frequencies_at_the_centre():
    """Known values: 113.0, 184.0, 212.5, 353 Hz with both legs as solids, rigid end faces."""
    whole = system_of(0.4975, *of_slices(12, 12))
    found = modes(factorised(whole), 4).frequencies
    # One element across the section: torsion, a part of the first mode, is a little too stiff.
    assert_allclose(found, [113.0, 184.0, 212.5, 353.0], rtol=5e-3)


def test_free_part_is_an_error_that_names_the_robot():
    chains = [segment_chain(leg.timoshenko, leg.length, 2) for leg in (LEG_1, LEG_2)]
    whole = system_of(0.4975, *(static_leg(chain) for chain in chains))
    loose = whole.stiffness.tolil()
    loose[2, :] = 0.0
    loose[:, 2] = 0.0
    loose[2, 2] = -1.0
    broken = replace(whole, stiffness=loose.tocsr())
    with pytest.raises(ComputationError, match=r"IFW.*not positive definite"):
        factorised(broken)
