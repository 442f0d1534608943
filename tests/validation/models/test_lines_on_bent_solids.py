"""Loads along bent solid legs against a solid that carries them on its nodes."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from fem.bodies.solid import centreline_of, clamped_leg, solid_leg, solid_mesh
from lumped.legs import LineLeg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from validation.models.loads.statics import displacements
from validation.models.options import ModelOptions

FRAME = """
schema = 2
name = "frame"
points = { A = [0.0, 0.0, 0.0], K = [0.25, 0.0, 0.0], P = [0.25, 0.25, 0.0] }
materials.steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
tool = { body = "arm", point = "P", moves = [] }
joints.clamp = { type = "fixed", between = ["ground", "arm"], at = "A" }
[bodies.arm]
from = "A"
to = "P"
through = ["K"]
section = { shape = "hollow-rectangle", width = 0.05, height = 0.05, thickness = 0.002 }
material = "steel"
ends = "free"
[[loads]]
name = "wind"
lines = [{ leg = "arm", wrench = [0.0, 0.0, -500.0, 0.0, 0.0, 0.0], from = 0.1, to = 0.4 }]
"""


def test_line_on_bent_solid_moves_tip_like_nodal_loads():
    """The solid itself, loaded on its nodes: by beam wrenches the tip moved 20 % too far."""
    posture = reference_posture(described(FRAME))
    options = ModelOptions(divisions=1, ends="free")
    ((motion,),) = displacements("solid", [posture], options)
    leg = legs_of(posture.mechanism)["arm"]
    assert isinstance(leg, LineLeg)
    mesh = solid_mesh(leg, 1)
    body = clamped_leg(solid_leg(leg, mesh), "free")
    centreline = centreline_of(mesh, body.solid)
    points, weights = np.polynomial.legendre.leggauss(60)
    forces = 0.0
    for start, stop in ((0.1, 0.25), (0.25, 0.4)):
        stations = start + 0.5 * (stop - start) * (points + 1.0)
        up = centreline(stations)[2::6]
        forces = forces - 500.0 * 0.5 * (stop - start) * (up.T @ weights)
    expected = body.loads.T @ body.flexibility(forces[:, None])[:, 0]
    assert motion[2] == pytest.approx(expected[2], rel=1e-3)
