"""
04 A five-bar of one's own
==========================

A robot of any bodies and joints is a dictionary with the keys of a robot file, in SI units.
"""

import flexproof as fp

bar = {"shape": "hollow-rectangle", "width": 0.05, "height": 0.07, "thickness": 0.005}
axis = [0.0, 0.0, 1.0]
motor = {"type": "revolute", "axis": axis, "drive": {"stiffness": 8.0e4}}  # N m/rad
hinge = {"type": "revolute", "axis": axis}

five_bar = fp.load(
    {
        "schema": 2,
        "name": "my five-bar",
        "points": {
            "A1": [-0.15, 0.0, 0.0],
            "A2": [0.15, 0.0, 0.0],
            "B1": [-0.35, 0.25, 0.0],
            "B2": [0.35, 0.25, 0.0],
            "P": [0.0, 0.55, 0.0],
        },
        "materials": {"steel": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}},
        "bodies": {
            "crank1": {"from": "A1", "to": "B1", "section": bar, "material": "steel"},
            "crank2": {"from": "A2", "to": "B2", "section": bar, "material": "steel"},
            "rod1": {"from": "B1", "to": "P", "section": bar, "material": "steel"},
            "rod2": {"from": "B2", "to": "P", "section": bar, "material": "steel"},
        },
        "joints": {
            "motor1": {**motor, "between": ["ground", "crank1"], "at": "A1"},
            "motor2": {**motor, "between": ["ground", "crank2"], "at": "A2"},
            "elbow1": {**hinge, "between": ["crank1", "rod1"], "at": "B1"},
            "elbow2": {**hinge, "between": ["crank2", "rod2"], "at": "B2"},
            "pin": {**hinge, "between": ["rod1", "rod2"], "at": "P"},
        },
        "tool": {"body": "rod1", "point": "P", "moves": ["x", "y"], "mass": 2.0},
        "path": {"from": [-0.2, 0.45], "to": [0.2, 0.55], "count": 9},
    }
)

fp.draw(five_bar)

# %%
# Deflections and frequencies over the path, by beam elements:

poses = five_bar.mechanism.poses
beam = fp.solve(five_bar, "beam", poses=poses, modes=3)
beam.plot()

# %%
# The virtual joint method, matrix structural analysis and beams have one answer in statics:

models = {name: fp.solve(five_bar, name, poses=[[0.0, 0.5]]) for name in ("vjm", "links", "beam")}
stiffness = {name: 1e-6 / one.answers[0].compliance[0, 0] for name, one in models.items()}
for name, value in stiffness.items():
    print(f"{name:6} stiffness along x {value:.6f} N/µm")
