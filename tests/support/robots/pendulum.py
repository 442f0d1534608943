"""Robot file of a rigid bob on a driven pivot, without a path."""

PENDULUM = """
schema = 2
name = "pendulum"
points = { A = [0.0, 0.0, 0.0], P = [0.0, -0.8, 0.0] }
tool = { body = "bob", point = "P", moves = ["x"] }
[bodies.bob]
points = ["A", "P"]
mass = 3.0
centre = [0.0, -0.5, 0.0]
inertia = [[0.1, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.11]]
[joints.pivot]
type = "revolute"
between = ["ground", "bob"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 4.0e4 }
"""
