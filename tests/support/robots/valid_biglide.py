"""Valid biglide with both kinds of leg. Invalid files differ from it by one edit."""

SOUND = """\
schema = 1
name = "test robot"
type = "biglide"

[geometry]
a = 0.9
tool_offset = [0.0, 0.0, 0.1]

[platform]
mass = 46.0

[actuators]
stiffness = 1.0e9

[foot]
compliance = [
    [1.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 6.0e-9, 0.0, 0.0, 0.0, 4.0e-8],
    [0.0, 0.0, 5.0e-10, 0.0, -4.0e-9, 0.0],
    [0.0, 0.0, 0.0, 7.0e-8, 0.0, 0.0],
    [0.0, 0.0, -4.0e-9, 0.0, 8.0e-8, 0.0],
    [0.0, 4.0e-8, 0.0, 0.0, 0.0, 3.0e-7],
]

[leg1]
length = 0.85
section = { shape = "hollow-rectangle", width = 0.10, height = 0.16, thickness = 0.008 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }

[leg2]
length = 0.8
mass = 49.0
compliance = [
    [3.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 2.0e-8, 0.0, 0.0, 0.0, 3.0e-8],
    [0.0, 0.0, 3.0e-8, 0.0, -5.0e-8, 0.0],
    [0.0, 0.0, 0.0, 2.5e-7, 0.0, 0.0],
    [0.0, 0.0, -5.0e-8, 0.0, 1.5e-7, 0.0],
    [0.0, 3.0e-8, 0.0, 0.0, 0.0, 1.0e-7],
]
"""
