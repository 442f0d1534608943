"""
16 Forces and stresses
======================

A slider-crank press: a motor turns the crank, a rod pushes the ram in its guide. The forces in
joints and drive, and the stresses of the legs, follow from the load at the ram.
"""

import numpy as np

import flexproof as fp

# sphinx_gallery_thumbnail_number = 2

crank, rod, force = 0.06, 0.25, 5000.0
angle = np.radians(50.0)
elbow = [crank * np.sin(angle), crank * np.cos(angle), 0.0]
top = [0.0, elbow[1] + np.sqrt(rod**2 - elbow[0] ** 2), 0.0]
steel = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
revolute = {"type": "revolute", "axis": [0.0, 0.0, 1.0]}
press = {
    "schema": 2,
    "name": "press",
    "points": {"O": [0.0, 0.0, 0.0], "A": elbow, "B": top},
    "bodies": {
        "crank": {
            "from": "O",
            "to": "A",
            "section": {"shape": "rectangle", "width": 0.04, "height": 0.02},
            "material": steel,
        },
        "rod": {
            "from": "A",
            "to": "B",
            "section": {"shape": "tube", "diameter": 0.03, "thickness": 0.005},
            "material": steel,
        },
        "ram": {"points": ["B"], "mass": 2.0, "centre": "B"},
    },
    "joints": {
        "motor": {
            **revolute,
            "between": ["ground", "crank"],
            "at": "O",
            "drive": {"stiffness": 5.0e5},
        },
        "elbow": {**revolute, "between": ["crank", "rod"], "at": "A"},
        "pin": {**revolute, "between": ["rod", "ram"], "at": "B"},
        "guide": {
            "type": "prismatic",
            "between": ["ground", "ram"],
            "at": "B",
            "axis": [0.0, 1.0, 0.0],
        },
    },
    "tool": {"body": "ram", "point": "B", "moves": ["y"]},
    "loads": [{"name": "press", "wrench": [0.0, -force, 0.0, 0.0, 0.0, 0.0]}],
    "path": {"from": [0.2], "to": [0.305], "count": 15},
}
forces = fp.forces(press)
forces.table()

# %%
# By hand, the rod carries :math:`F/\cos\beta`, the guide :math:`F\tan\beta`, and the motor
# :math:`F r \sin(\varphi + \beta)/\cos\beta`.

beta = np.arcsin(elbow[0] / rod)
by_hand = {
    "rod": -force / np.cos(beta),
    "guide": force * np.tan(beta),
    "motor": force * crank * np.sin(angle + beta) / np.cos(beta),
}
found = forces.poses[0].loads["press"]
reactions = {reaction.joint: reaction for reaction in found.reactions}
members = {member.leg: member for member in found.members}
print(f"rod   {members['rod'].forces[0, 0]:.1f} N, by hand {by_hand['rod']:.1f} N")
print(f"motor {reactions['motor'].drive:.2f} N m, by hand {by_hand['motor']:.2f} N m")

# %%
# Forces and stresses along the legs. The crank bends most at the motor, by the whole torque.

forces.plot()

# %%
# Over the stroke, the torque has its maximum where crank and rod are about at right angles. At the
# dead centres the motor carries nothing.

fp.forces(press, path=True).plot()

# %%
# The largest stresses, with their half-widths from two meshes of each section:

forces.member_table()
