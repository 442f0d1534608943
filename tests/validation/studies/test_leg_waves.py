"""Waves in the legs of a robot against its solids."""

import numpy as np
from numpy.testing import assert_allclose

from fem.reduction.superelement import Superelement
from lumped.biglide import postures, with_equivalent_legs
from lumped.legs import equivalent_leg
from lumped.robot_file import load_robot
from validation.studies.leg_waves import wave_changes, waves_of
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    OFFERED,
    own_beam,
    own_beam_modes,
    paired,
    solid_modes,
)

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
    path = tmp_path / "robot.toml"
    path.write_text(ROBOT, encoding="utf-8")
    robot = load_robot(path).robot
    member = with_equivalent_legs(robot)
    legs = {"leg1": equivalent_leg(member.leg1), "leg2": equivalent_leg(member.leg2)}
    divisions = {"leg1": 2, "leg2": 2}
    beams = {name: own_beam(leg, divisions[name]) for name, leg in legs.items()}
    changes = wave_changes(
        postures(member, member.stations(3)[1:2]),
        {name: Superelement(beam, np.eye(beam.size)) for name, beam in beams.items()},
        beams,
        waves_of(legs, divisions),
        elements=ELEMENTS,
        offered=OFFERED,
        count=5,
    )[0]
    both = divisions["leg1"], divisions["leg2"]
    own = own_beam_modes(robot, both, 3)
    found = paired(robot, own, solid_modes(robot, both, "free", 3))
    apart = (found.found / found.reference - 1.0)[1, :5]
    assert apart.max() > 4e-3
    # What is left is the length of the solids' elements, fourth order.
    assert_allclose(changes, apart, atol=3e-5)
