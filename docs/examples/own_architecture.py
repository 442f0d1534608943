"""Another architecture by virtual joints: a planar 3-PRR robot with three equal legs.

A chain is the list of its elements from the base to the loaded point, as in eq. (6): constant
transforms, joints, 6-DOF springs.
"""

import numpy as np

from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.models.chains import ChainJoint, Fixed, VirtualSpring
from lumped.models.vjm import platform_compliance, robot_stiffness
from lumped.screws import rotation_z
from lumped.sections import Tube

steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
LEG = ConstantLeg(0.5, Tube(0.06, 0.005), steel)
X, Y, Z = np.eye(3)


def chain(ray: float, turn: float = np.pi - 0.6, radius: float = 0.15):
    """Slide across its ray, passive joint, leg at the angle `turn`, passive joint, platform."""
    slide = radius * X - LEG.length * (np.cos(turn) * X + np.sin(turn) * Y)
    return (
        Fixed(rotation_z(ray) @ (slide[0] * X), rotation_z(ray)),
        ChainJoint("prismatic", Y, slide[1], "actuated"),
        ChainJoint("revolute", Z, turn),
        Fixed(LEG.length * X),
        VirtualSpring(tip_compliance(LEG.timoshenko, LEG.length), "leg"),
        ChainJoint("revolute", Z, -turn),
        Fixed(-radius * X, rotation_z(-ray)),
    )


stiffness = robot_stiffness(chain(ray) for ray in np.radians([0.0, 120.0, 240.0]))
compliance = platform_compliance(stiffness, "3-PRR platform")
assert np.isclose(compliance[0, 0], compliance[1, 1])  # threefold symmetry prefers no direction
