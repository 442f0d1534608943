"""
20 Profiles and their shear centre
==================================

Cantilevers of a channel, an angle, a tee and a polygon, and the channel once more by its section
constants. A force through the centroid bends such a leg, and twists it by its lever arm about the
shear centre.
"""

import matplotlib.pyplot as plt

import flexproof as fp

length, force, wall = 0.6, 1000.0, 0.006
sizes = {"width": 0.05, "height": 0.1, "flange": wall, "web": wall}
# Corners of a Z profile [y, z]: its web stands in the middle, its flanges point to both sides.
corner, half, thin = 0.05, 0.05, 0.5 * wall
z_profile = [
    [-thin, -half],
    [corner, -half],
    [corner, wall - half],
    [thin, wall - half],
    [thin, half],
    [-corner, half],
    [-corner, half - wall],
    [-thin, half - wall],
]
sections = {
    **{shape: {"shape": shape, **sizes} for shape in ("channel", "angle", "tee")},
    "Z profile": {"shape": "polygon", "outline": z_profile},
}


def compliance(section):
    """6×6 compliance at the tip of the leg, from beam elements."""
    arm = {"from": "A", "to": "P", "section": section, "ends": "free"}
    arm["material"] = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
    robot = {
        "schema": 2,
        "name": "cantilever",
        "points": {"A": [0.0, 0.0, 0.0], "P": [length, 0.0, 0.0]},
        "bodies": {"arm": arm},
        "joints": {"root": {"type": "fixed", "between": ["ground", "arm"], "at": "A"}},
        "tool": {"body": "arm", "point": "P", "moves": []},
    }
    return fp.solve(robot, "beam", modes=0).answers[0].compliance


matrices = {name: compliance(section) for name, section in sections.items()}

# %%
# Under 1000 N along z at the tip, all but the tee twist or deflect to the side:

for name, matrix in matrices.items():
    y, z, twist = force * matrix[[1, 2, 3], 2]
    print(f"{name:9}  y {1e3 * y:6.3f} mm, z {1e3 * z:5.3f} mm, twist {1e3 * twist:7.2f} mrad")

# %%
# Twist per force over twist per moment is the lever arm of the force about the shear centre. That
# of a thin channel lies at :math:`3 b^2/(6 b + h)` beyond the middle of its web.

levers = {name: matrix[3, 2] / matrix[3, 3] for name, matrix in matrices.items()}
print("lever arm (mm):", ", ".join(f"{name} {1e3 * lever:.2f}" for name, lever in levers.items()))

figure, axes = plt.subplots(figsize=(7.4, 2.6), dpi=150, layout="constrained")
axes.barh(list(levers)[::-1], [1e3 * lever for lever in levers.values()][::-1], color="#0072B2")
axes.set_xlabel("lever arm of a force along z through the centroid (mm)")
plt.show()

# %%
# A profile of a catalogue is known by its constants. With those of the channel, the beam is equal:

b, h = sizes["width"], sizes["height"]
outer, inner = b * h, (b - wall) * (h - 2.0 * wall)
area = outer - inner
centre = (outer * 0.5 * b - inner * 0.5 * (b + wall)) / area
channel = {
    "shape": "properties",
    "A": area,
    "Iy": (b * h**3 - (b - wall) * (h - 2.0 * wall) ** 3) / 12.0,
    "Iz": (h * b**3 - (h - 2.0 * wall) * (b - wall) ** 3) / 12.0
    + outer * (0.5 * b - centre) ** 2
    - inner * (0.5 * (b + wall) - centre) ** 2,
    "J": length / (2.1e11 / 2.6 * matrices["channel"][3, 3]),
    "ys": -levers["channel"],
}
by_constants = compliance(channel)
for entry, row in (("z", 2), ("twist", 3)):
    share = by_constants[row, 2] / matrices["channel"][row, 2]
    print(f"{entry} by constants, without shear: {100.0 * share:.1f} % of that by the outline")
