"""Leg along a line in space: straight, a tapering arc out of its plane, a corner, and a step.

A robot file is `HOOK_POINTS`, tool and joints, and `HOOK_LEG`, which is held at A or P.
"""

HOOK_POINTS = """
schema = 2
name = "hook"
points.A = [0.1, 0.0, 0.0]
points.K = [0.3, 0.1, 0.0]
points.M = [0.5, 0.2, 0.15]
points.Q = [0.55, 0.3, 0.3]
points.P = [0.6, 0.0, 0.4]
materials.steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
"""
HOOK_LEG = """
[bodies.hook]
from = "A"
to = "P"
through = ["K", { arc = "M" }, "Q"]
up = [0.2, -0.3, 1.0]
material = "steel"
sections = [
  { at = "A", shape = "rectangle", width = 0.05, height = 0.06 },
  { at = "K", shape = "rectangle", width = 0.05, height = 0.06 },
  { at = "Q", shape = "rectangle", width = 0.03, height = 0.02 },
  { at = "Q", shape = "circle", diameter = 0.03 },
  { at = "P", shape = "circle", diameter = 0.03 },
]
"""
