"""The robot with solid legs: `solve` gives the numbers of the robot without any reduction."""

import pytest
from compliances import scaled_difference
from like_ifw import EQUIVALENT, IFW, placed_at
from numpy.testing import assert_allclose

from fem.bodies.solid import solid_leg, solid_leg_matrices, solid_mesh
from fem.solvers import sparse_system
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from validation.models.mechanism import answers
from validation.models.options import ModelOptions


@pytest.mark.parametrize("x", [0.145, 0.4975])
def test_solve_with_solid_legs_is_the_unreduced_robot(x):
    legs = legs_of(EQUIVALENT).items()
    whole = {name: solid_leg_matrices(solid_leg(leg, solid_mesh(leg, 1))) for name, leg in legs}
    unreduced = sparse_system.factorised(assemble(*placed_at(EQUIVALENT, x), whole))
    (found,) = answers("solid", placed_at(IFW.mechanism, x), 6, ModelOptions(divisions=1))
    # Required: statics 1e-9, frequencies 1e-4; the compliance of reduced legs is exact.
    assert scaled_difference(found.compliance, sparse_system.compliance(unreduced)) < 1e-9
    assert_allclose(found.frequencies, sparse_system.modes(unreduced, 6).frequencies, rtol=1e-4)


def test_free_ends_are_softer_against_torsion_alone():
    """Known values: warping restrained at rigid faces; planar loads cause no torsion."""
    rigid, free = (
        answers("solid", placed_at(EQUIVALENT), 0, ModelOptions(divisions=2, ends=ends))[0]
        for ends in ("rigid", "free")
    )
    assert_allclose(free.compliance[:2, :2], rigid.compliance[:2, :2], rtol=1e-6)
    assert 0.005 < free.compliance[2, 2] / rigid.compliance[2, 2] - 1.0 < 0.021
