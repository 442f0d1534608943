"""Buckling of bodies on joints that are elastic in some directions and rigid in the others."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import InterfaceLoads
from lumped.system.assembly import assemble
from lumped.system.loads import loading
from lumped.system.solution import solved
from lumped.system.stability import geometric_stiffness, stability

# A rigid bar on two elastic seats A and B, pressed along its axis onto seat A by a force at P.
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
    at_reference = reference_posture(mechanism)
    solution = solved(assemble(at_reference, {}))
    loads = loading(at_reference, mechanism.loads[0], InterfaceLoads())
    return stability(solution, geometric_stiffness(solution, loads, {}), loads).factor


def test_rigid_seat_is_limit_of_stiff_seat():
    """A rigid seat takes the whole force, a seat k times as stiff as the other all but 1/k."""
    rigid = factor('"rigid"')
    kilo, mega = (factor(stiffness) for stiffness in (1e9, 1e12))
    assert kilo != pytest.approx(rigid, rel=1e-5)
    assert kilo / rigid - 1.0 == pytest.approx(1e3 * (mega / rigid - 1.0), rel=1e-2)
    assert mega == pytest.approx(rigid, rel=1e-5)


def test_pressed_bar_buckling_is_exact():
    """Bar pressed along its axis onto A by a force F, on springs at A and B that are 1 m apart.

    Transverse springs have the stiffness k at A and K at B, rotational ones c at each. With the
    transverse deflections v of A and w of B, the bar turns by θ = w − v. The energy is ½ (k v² + K
    w² + 2c θ²) − F ½ θ² L, where L = 1.5 m is the length from A, which takes the whole force, to
    the load at P.
    """
    k, K, tilting, length = 2.0e5, 5.0e5, 6.0e4, 1.5
    elastic = np.array([[k + tilting, -tilting], [-tilting, K + tilting]])
    geometric = np.array([[1.0, -1.0], [-1.0, 1.0]])
    flexibility = np.linalg.inv(elastic)
    critical = 1.0 / (length * np.trace(geometric @ flexibility))
    assert factor('"rigid"') * 1e3 == pytest.approx(critical, rel=1e-9)
