"""Robot file of one prismatic arm on a driven joint, without a path."""

ONE_ARM = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], P = [0.0, 0.5, 0.0] }
[bodies.arm]
from = "A"
to = "P"
section = { shape = "rectangle", width = 0.06, height = 0.04 }
material = { E = 2.1e11, nu = 0.0, rho = 7850.0 }
[joints.motor]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 5.0e4 }
[tool]
body = "arm"
point = "P"
moves = ["x"]
mass = 1.0
[accept]
modes = 2
"""
# Loads of its own, to stand behind the tables of a robot.
LOADS = """
[[loads]]
name = "weight"
gravity = [0.0, 0.0, -9.81]
[[loads]]
name = "cutting"
wrench = [100.0, 0.0, -50.0, 0.0, 0.0, 0.0]
[[loads]]
name = "stop"
acceleration = [5.0, 0.0, 0.0]
"""
