"""
08 Frequency response
=====================

Displacement of the tool under a harmonic force, such as that of a milling cutter. The material, the
drive and all modes lose energy, each as the robot file specifies.
"""

import flexproof as fp

arm = {
    "schema": 2,
    "name": "arm",
    "points": {"A": [0.0, 0.0, 0.0], "P": [0.0, 0.5, 0.0]},
    "bodies": {
        "arm": {
            "from": "A",
            "to": "P",
            "section": {"shape": "rectangle", "width": 0.06, "height": 0.04},
            "material": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0, "loss": 0.001},
        }
    },
    "joints": {
        "motor": {
            "type": "revolute",
            "between": ["ground", "arm"],
            "at": "A",
            "axis": [0.0, 0.0, 1.0],
            "drive": {"stiffness": 5.0e4, "loss": 0.1},
        }
    },
    "tool": {"body": "arm", "point": "P", "moves": ["x"]},
    "damping": {"ratio": 0.005},
    "responses": [
        {"name": "along-x", "direction": [1.0, 0.0, 0.0], "from": 10.0, "to": 1000.0},
        {"name": "along-z", "direction": [0.0, 0.0, 1.0], "from": 10.0, "to": 1000.0},
    ],
}
solution = fp.solve(arm, "beam", modes=6)
solution.plot_responses()

# %%
# Along x the drive gives way, and its loss factor of 0.1 limits the peak. Along z the arm bends,
# and only the material and the damping ratio act.

for response in solution.answers[0].responses:
    size, frequency = response.judged[:2]
    name = response.excitation.name
    print(f"{name}: peak {1e6 * size:.2f} µm/N at {frequency:.2f} Hz")
losses = solution.answers[0].damped[1]
print("loss factors of the modes (%):", ", ".join(f"{100.0 * loss:.2f}" for loss in losses))
