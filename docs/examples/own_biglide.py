"""A biglide made in Python, its legs two tubes: virtual joints against beams."""

import numpy as np

from lumped.legs import ConstantLeg, Material
from lumped.mechanism.biglide import biglide
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.sections import Tube
from validation.models.robot_models import answers

steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
robot = biglide(
    "two tubes",
    a=0.9,
    leg1=ConstantLeg(0.8, Tube(0.15, 0.008), steel),
    leg2=ConstantLeg(0.8, Tube(0.12, 0.006), steel),
    platform_mass=30.0,
    drive_stiffness=5.0e8,
)
centre = [reference_posture(robot)]
by_vjm, by_beams = (answers(model, centre, 0).compliances for model in ("vjm", "beam"))
frequencies = answers("beam", centre, 1).frequencies
assert np.allclose(by_vjm, by_beams, rtol=1e-9, atol=1e-18)
assert np.isclose(frequencies[0, 0], 106.73, rtol=1e-4)
