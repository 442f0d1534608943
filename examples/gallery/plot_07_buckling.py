"""
07 Loads and buckling
=====================

A strut under its own weight and a compressive force. The displacement is linear in the load. How
near the load brings the strut to buckling is answered beside it.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexproof as fp

# sphinx_gallery_thumbnail_number = 2

length, width, height = 1.0, 0.030, 0.020
E, rho = 2.1e11, 7850.0
strut = {
    "schema": 2,
    "name": "strut",
    "points": {"A": [0.0, 0.0, 0.0], "P": [0.0, 0.0, length]},
    "bodies": {
        "strut": {
            "from": "A",
            "to": "P",
            "up": [1.0, 0.0, 0.0],
            "section": {"shape": "rectangle", "width": width, "height": height},
            "material": {"E": E, "nu": 0.3, "rho": rho},
        }
    },
    "joints": {"foot": {"type": "fixed", "between": ["ground", "strut"], "at": "A"}},
    "tool": {"body": "strut", "point": "P", "moves": []},
    "loads": [
        {"name": "press", "wrench": [0.0, 0.0, -1000.0, 0.0, 0.0, 0.0]},
        {"name": "push", "wrench": [100.0, 0.0, 0.0, 0.0, 0.0, 0.0]},
        {"name": "weight", "gravity": [0.0, 0.0, -9.81]},
    ],
}
solution = fp.solve(strut, "beam", modes=3)
solution.plot_loads()

# %%
# The strut bends by 8 mm under a lateral force of 100 N, and buckles at ten times the pressing
# force of 1 kN.

solution.load_table()

# %%
# Euler's load of a column that is clamped at one end, :math:`P = \pi^2 EI / 4L^2`, and Greenhill's
# (1881) for its own weight, :math:`q L^3 = 7.837\,EI`. Shear lowers both by less than 0.1 %.

inertia = width * height**3 / 12.0
euler = np.pi**2 * E * inertia / (4.0 * length**2) / 1000.0
greenhill = 7.837 * E * inertia / (rho * 9.81 * width * height * length**3)
stable = solution.answers[0].stability
print(f"press  {stable['press'].factor:.3f}, Euler {euler:.3f}")
print(f"weight {stable['weight'].factor:.2f}, Greenhill {greenhill:.2f}")

# %%
# The factor over the length of the strut, with Euler's curve:

lengths = np.linspace(0.4, 1.6, 7)
factors = []
for one in lengths:
    longer = {**strut, "points": {"A": [0.0, 0.0, 0.0], "P": [0.0, 0.0, one]}}
    factors.append(fp.solve(longer, "beam", modes=0).answers[0].stability["press"].factor)

figure, axes = plt.subplots(figsize=(7.4, 2.8), dpi=150, layout="constrained")
x = np.linspace(0.4, 1.6, 100)
axes.plot(x, euler * (length / x) ** 2, color="#999999", label="Euler")
axes.plot(lengths, factors, "o", label="flexproof")
axes.axhline(1.0, color="#D55E00", linestyle=":", label="buckling under 1 kN")
axes.set(xlabel="length of the strut (m)", ylabel="buckling factor", yscale="log")
axes.legend(frameon=False)
plt.show()
