"""
11 A design decision
====================

How wide should an arm on an elastic drive be? All models and the reference over the width, and
what each of them would choose.
"""

import flexproof as fp

arm = {
    "schema": 2,
    "name": "arm",
    "points": {"A": [0.0, 0.0, 0.0], "P": [0.0, 0.3, 0.0]},
    "bodies": {
        "arm": {
            "from": "A",
            "to": "P",
            "ends": "rigid",
            "section": {"shape": "rectangle", "width": 0.03, "height": 0.04},
            "material": {"E": 7.0e10, "nu": 0.33, "rho": 2700.0},
        }
    },
    "joints": {
        "motor": {
            "type": "revolute",
            "between": ["ground", "arm"],
            "at": "A",
            "axis": [0.0, 0.0, 1.0],
            "drive": {"stiffness": 2.0e4},
        }
    },
    "tool": {"body": "arm", "point": "P", "moves": ["x"], "mass": 1.0},
}
designs = fp.vary(arm, "bodies.arm.section.width=0.02:0.05:4", preset="quick")
designs.plot()

# %%
# A wider arm always deflects less. The first frequency has a maximum: beyond it, the mass of the
# arm costs more than its stiffness brings. The simplified model has rigid bodies without mass on
# elastic drives: all designs are equal to it, and of these the best counts as its choice.

print(f"least deflection: {1e3 * designs.best('deflection'):.0f} mm")
print(f"highest first frequency: {1e3 * designs.best('frequency'):.0f} mm")
for model in designs.decisions["frequency"].models:
    chosen, loss = designs.best("frequency", model), designs.loss(model, "frequency")
    print(f"{model:24} chooses {1e3 * chosen:2.0f} mm, {100.0 * loss:.2f} % below the best")
