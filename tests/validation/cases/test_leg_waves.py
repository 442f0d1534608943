"""Waves in the legs of a robot against its solids."""

import numpy as np
from like_ifw import placed_at
from numpy.testing import assert_allclose
from written_robot import robot_of

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import Superelement
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from lumped.system.solution import modes, solved
from validation.cases.leg_waves import wave_changes, waves_of
from validation.solids.legs import ELEMENTS, held_solid, own_beam

OFFERED = 12
# A leg so light bends between ends at rest. With ν = −0.9 its κ by strain energy is 0.007; waves
# are much stiffer in shear.
ROBOT = """
schema = 1
name = "a leg between ends at rest"
type = "biglide"
geometry = { a = 0.12 }
platform = { mass = 10.0 }
actuators = { stiffness = 3e11 }
[leg1]
length = 0.06
section = { shape = "rectangle", width = 0.0017, height = 0.0008 }
material = { E = 2.1e11, nu = -0.9, rho = 7850.0 }
[leg2]
length = 0.07
section = { shape = "rectangle", width = 0.01, height = 0.01 }
material = { E = 2.1e11, nu = 0.0, rho = 7850.0 }
"""


def test_a_leg_that_swings_between_ends_at_rest_has_its_waves(tmp_path):
    mechanism = robot_of(ROBOT, tmp_path).mechanism
    legs, divisions = legs_of(mechanism), {"leg1": 2, "leg2": 2}
    beams = {name: own_beam(leg, divisions[name]) for name, leg in legs.items()}
    places = placed_at(mechanism)
    changes = wave_changes(
        places,
        {name: Superelement(beam, np.eye(beam.size)) for name, beam in beams.items()},
        beams,
        waves_of(legs, divisions),
        elements=ELEMENTS,
        offered=OFFERED,
        count=5,
    )[0]
    own = modes(solved(assemble(places[0], beams)), 5).frequencies
    solids = {
        name: craig_bampton(held_solid(leg, divisions[name], "free"), 2.0 * own[-1]).matrices
        for name, leg in legs.items()
    }
    apart = modes(solved(assemble(places[0], solids)), 5).frequencies / own - 1.0
    assert apart.max() > 4e-3
    # What is left is the length of the solids' elements, fourth order.
    assert_allclose(changes, apart, atol=3e-5)
