"""
17 Catalogue joints
===================

A slide on a profile rail with a ball screw. The carriage, the nut and its bearing are sizes of a
catalogue, a shaft is softer far from its bearing, and dashpots limit the resonance.
"""

import numpy as np

import flexproof as fp

axis = {
    "schema": 2,
    "name": "axis",
    "points": {"A": [0.5, 0.0, 0.0], "P": [0.5, 0.0, 0.25]},
    "bodies": {
        "slide": {"points": ["A"], "mass": 15.0, "centre": "A"},
        "column": {
            "from": "A",
            "to": "P",
            "section": {"shape": "rectangle", "width": 0.08, "height": 0.08},
            "material": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
        },
    },
    "joints": {
        "guide": {
            "type": "prismatic",
            # The slide carries the blocks of its guide, whose directions stay with it.
            "between": ["slide", "ground"],
            "at": "A",
            "axis": [1.0, 0.0, 0.0],
            "up": [0.0, 0.0, 1.0],
            "guide": {"size": "HG25C", "preload": "ZA"},
            "damping": {"along": 2.0e3, "pitch": 300.0},
            "drive": {
                "screw": {
                    "length": 0.4,
                    "nut": {"size": "R25-10T3-FDI", "preload": 1200.0},
                    "bearing": "ZKLF1762",
                    "positive": "shorter",
                }
            },
        },
        "seat": {"type": "fixed", "between": ["slide", "column"], "at": "A"},
    },
    "tool": {"body": "column", "point": "P", "moves": ["x"]},
    "path": {"from": [0.2], "to": [1.0], "count": 9},
    "responses": [
        {"name": "tool", "direction": [1.0, 0.0, 0.0], "from": 20.0, "to": 400.0},
        {
            "name": "slide",
            "direction": [1.0, 0.0, 0.0],
            "of": {"point": "A", "body": "slide"},
            "from": 20.0,
            "to": 400.0,
        },
    ],
}
poses = np.linspace(0.2, 1.0, 9)
solution = fp.solve(axis, "beam", poses=list(poses), modes=4)
solution.plot()

# %%
# At x the nut is x − 0.1 m from its bearing. Along x, the screw (1/k = L/EA + nut + bearing), the
# pitch of the guide and the bending of the column are in series.

along_x = np.array([answer.compliance[0, 0] for answer in solution.answers])
print("stiffness at the tool (N/µm):", ", ".join(f"{1e-6 / value:.1f}" for value in along_x))

# %%
# The same force at the tool moves the slide less: a receptance between two points.

middle = fp.solve(axis, "beam", poses=[0.6], modes=4)
middle.plot_responses()
