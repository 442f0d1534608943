"""A biglide as a record, its legs two tubes: virtual joints against beams."""

import numpy as np

from lumped.biglide import Biglide
from lumped.legs import ConstantLeg, Material
from lumped.sections import Tube
from validation.models.biglide import robot_compliance, robot_frequencies

steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
robot = Biglide(
    name="two tubes",
    a=0.9,
    platform_mass=30.0,
    actuator_stiffness=5.0e8,
    leg1=ConstantLeg(0.8, Tube(0.15, 0.008), steel),
    leg2=ConstantLeg(0.8, Tube(0.12, 0.006), steel),
)
by_vjm = robot_compliance("vjm", robot, robot.centre)
by_beams = robot_compliance("beam", robot, robot.centre)
assert np.allclose(by_vjm, by_beams, rtol=1e-9, atol=1e-18)
assert np.isclose(robot_frequencies("beam", robot, robot.centre, 1)[0], 106.73, rtol=1e-4)
