"""The robot with solid legs: `solve` gives the numbers of the robot without any reduction."""

import numpy as np
from compliances import scaled_difference
from like_ifw import EQUIVALENT, IFW, placed_at
from numpy.testing import assert_allclose
from scipy.sparse import csc_array
from scipy.sparse.linalg import eigsh, spsolve

from fem.bodies.solid import solid_leg, solid_leg_matrices, solid_mesh
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from validation.models.mechanism import answers
from validation.models.options import ModelOptions


def test_solve_with_solid_legs_is_the_unreduced_robot():
    x, legs = 0.145, legs_of(EQUIVALENT).items()
    whole = {name: solid_leg_matrices(solid_leg(leg, solid_mesh(leg, 1))) for name, leg in legs}
    robot = assemble(*placed_at(EQUIVALENT, x), whole)
    stiffness, mass = csc_array(robot.stiffness), csc_array(robot.mass)
    (found,) = answers("solid", placed_at(IFW.mechanism, x), 6, ModelOptions(divisions=1))
    # Required: statics 1e-9, frequencies 1e-4; the compliance of reduced legs is exact.
    compliance = robot.tool @ spsolve(stiffness, robot.tool.T)
    assert scaled_difference(found.compliance, compliance) < 1e-9
    squared = np.sort(eigsh(stiffness, 6, mass, sigma=0.0, return_eigenvectors=False))
    assert_allclose(found.frequencies, np.sqrt(squared) / (2.0 * np.pi), rtol=1e-4)
