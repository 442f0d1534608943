"""
21 A leg and its copies
=======================

A robot of three equal legs, in mm: one leg is written, and a pattern about z makes the others.
"""

import numpy as np

import flexproof as fp

diameter, wall, stiffness = 20.0, 2.0, 5.0e7  # mm, mm, N/m
aluminium = {"E": 7.0e10, "nu": 0.33, "rho": 2700.0}
section = {"shape": "tube", "diameter": diameter, "thickness": wall}
bodies = {"slide": {"points": ["A", "El", "Er"], "mass": 1.0, "centre": "A", "pattern": "legs"}}
ball = {"type": "spherical", "pattern": "legs"}
joints = {
    "drive": {
        "type": "prismatic",
        "between": ["ground", "slide"],
        "at": "A",
        "axis": [0.0, 0.0, 1.0],
        "drive": {"stiffness": stiffness},
        "pattern": "legs",
    }
}
points = {"A": [300.0, 0.0, 0.0]}
for side, y in (("l", 50.0), ("r", -50.0)):
    points |= {f"E{side}": [300.0, y, 0.0], f"C{side}": [60.0, y, -500.0]}
    leg = {"from": f"E{side}", "to": f"C{side}", "section": section, "material": aluminium}
    bodies[f"rod{side}"] = {**leg, "pattern": "legs"}
    joints[f"elbow{side}"] = {**ball, "between": ["slide", f"rod{side}"], "at": f"E{side}"}
    joints[f"wrist{side}"] = {**ball, "between": [f"rod{side}", "platform"], "at": f"C{side}"}
ends = [f"C{side}{number}" for number in (1, 2, 3) for side in "lr"]
bodies["platform"] = {"points": [*ends, "P"], "mass": 0.6, "centre": "P"}

tripod = {
    "schema": 2,
    "name": "tripod of driven rods",
    "units": "mm",
    "patterns": {"legs": {"about": "z", "count": 3}},
    "points": {
        **{name: {"at": place, "pattern": "legs"} for name, place in points.items()},
        "P": [0.0, 0.0, -500.0],
    },
    "bodies": bodies,
    "joints": joints,
    "tool": {"body": "platform", "point": "P", "moves": ["x", "y", "z"]},
}
fp.draw(tripod)

# %%
# Lengths of the file are in mm, results in SI units. By the pattern, x and y are equal:

x, y, z = np.diag(fp.solve(tripod, "beam", modes=0).answers[0].compliance)[:3]
print(f"at 1000 N: x {1e9 * x:.2f} µm, y {1e9 * y:.2f} µm, z {1e9 * z:.2f} µm")

# %%
# By hand along z: three drives side by side, and six rods of the length L at the angle θ to z:
# :math:`1/3k + L/(6 EA \cos^2\theta)`.

rod = 1e-3 * np.hypot(240.0, 500.0)
area = 1e-6 * np.pi / 4.0 * (diameter**2 - (diameter - 2.0 * wall) ** 2)
by_hand = 1.0 / (3.0 * stiffness) + rod**3 / (6.0 * aluminium["E"] * area * 0.5**2)
print(f"by hand: z {1e9 * by_hand:.2f} µm")
