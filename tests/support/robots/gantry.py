"""Gantry of rigid bodies on three slides with independent motions: ω² = k/m along each axis."""

# N/m and kg along x, y and z.
STIFFNESSES, MASSES = (2.0e6, 5.0e6, 4.0e6), (28.0, 8.0, 3.0)
GANTRY = """
schema = 2
name = "gantry"
points = { O = [0.0, 0.0, 0.0] }
bodies.bridge = { points = ["O"], mass = 20.0, centre = "O" }
bodies.carriage = { points = ["O"], mass = 5.0, centre = "O" }
bodies.quill = { points = ["O"] }
tool = { body = "quill", point = "O", moves = ["x", "y", "z"], mass = 3.0 }
"""
for _move, _first, _second, _axis, _stiffness in (
    ("x", "ground", "bridge", [1, 0, 0], STIFFNESSES[0]),
    ("y", "bridge", "carriage", [0, 1, 0], STIFFNESSES[1]),
    ("z", "carriage", "quill", [0, 0, 1], STIFFNESSES[2]),
):
    GANTRY += f"""joints.{_move}.type = "prismatic"
joints.{_move}.between = ["{_first}", "{_second}"]
joints.{_move}.at = "O"
joints.{_move}.axis = {_axis}
joints.{_move}.drive = {{ stiffness = {_stiffness} }}
"""
