"""Joints that are elastic in some directions alone, in loops of rigid bodies under a load."""

import numpy as np
import pytest
from written_robot import described

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.system.assembly import assemble
from lumped.system.loads import loading
from lumped.system.prestress import geometric_stiffness
from lumped.system.solution import solved
from lumped.system.stability import stability

# A rigid bar on two seats that tilt softly, pressed onto the first; forces of both are in balance.
BAR = """
schema = 2
name = "bar"
points = { A = [0.0, 0.0, 0.0], B = [1.0, 0.0, 0.0], P = [1.5, 0.0, 0.0] }
bodies.bar = { points = ["A", "B", "P"], mass = 2.0, centre = "P" }
tool = { body = "bar", point = "P", moves = [] }
[joints.foot]
type = "fixed"
between = ["ground", "bar"]
at = "A"
up = [1.0, 0.0, 0.0]
stiffness = { axial = AXIAL, radial = 2.0e5, torsion = 1.0e4, tilting = 3.0e4 }
[joints.guide]
type = "fixed"
between = ["ground", "bar"]
at = "B"
up = [1.0, 0.0, 0.0]
stiffness = { axial = 1.0e6, radial = 5.0e5, torsion = "rigid", tilting = 3.0e4 }
[[loads]]
name = "press"
wrench = [-1.0e3, 0.0, 0.0, 0.0, 0.0, 0.0]
"""


def factor(axial):
    mechanism = described(BAR.replace("AXIAL", str(axial)))
    place = reference_posture(mechanism)
    solution = solved(assemble(place, {}))
    loads = loading(place, mechanism.loads[0], {})
    return stability(solution, geometric_stiffness(solution, loads, {}), loads).factor


def test_buckling_with_rigid_direction_is_the_limit():
    """The rigid seat takes the whole force; a seat k times stiffer all but a share of 1/k."""
    rigid = factor('"rigid"')
    kilo, mega = (factor(stiffness) for stiffness in (1e9, 1e12))
    assert kilo != pytest.approx(rigid, rel=1e-5)
    assert kilo / rigid - 1.0 == pytest.approx(1e3 * (mega / rigid - 1.0), rel=1e-2)
    assert mega == pytest.approx(rigid, rel=1e-5)


def test_buckling_of_pressed_bar_equals_hand():
    """Bar on springs across k at A, K at B, tilting c at each, pressed by P at P onto the foot A.

    With the deflections v of A and w of B, θ = w − v: energy ½ (k v² + K w² + 2c θ²) − P times the
    shortening ½ θ² of the length from the foot to the load, which the seat at A takes on its own.
    """
    k, K, tilting, length = 2.0e5, 5.0e5, 6.0e4, 1.5
    elastic = np.array([[k + tilting, -tilting], [-tilting, K + tilting]])
    geometric = np.array([[1.0, -1.0], [-1.0, 1.0]])
    flexibility = np.linalg.inv(elastic)
    critical = 1.0 / (length * np.trace(geometric @ flexibility))
    assert factor('"rigid"') * 1e3 == pytest.approx(critical, rel=1e-9)
