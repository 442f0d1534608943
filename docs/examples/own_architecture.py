"""Another architecture by virtual joints: a planar 3-PRR robot with three equal legs.

A chain is what yields between base and platform in the posture at hand: passive joints by their
places and twists, springs by their places and compliances, as eq. (3) takes them.
"""

import numpy as np

from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.models.vjm import platform_compliance, robot_stiffness, serial_chain
from lumped.screws import rotation_z, turn_matrix
from lumped.sections import Tube

steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
LEG = ConstantLeg(0.5, Tube(0.06, 0.005), steel)
TURNING = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])  # about z


def chain(ray: float, turn: float = np.pi - 0.6, radius: float = 0.15):
    """A driven slide across its ray, passive joint, leg, passive joint, platform around the origin.

    `turn`: the leg's angle against the ray.
    """
    along = rotation_z(ray + turn)
    tip = rotation_z(ray) @ [radius, 0.0, 0.0]
    root = tip - LEG.length * along[:, 0]
    spring = turn_matrix(tip_compliance(LEG.timoshenko, LEG.length), along)
    return serial_chain(np.zeros(3), [(root, TURNING), (tip, TURNING)], [(tip, spring)])


stiffness = robot_stiffness(chain(ray) for ray in np.radians([0.0, 120.0, 240.0]))
compliance = platform_compliance(stiffness, "3-PRR platform")
assert np.isclose(compliance[0, 0], compliance[1, 1])  # threefold symmetry prefers no direction
