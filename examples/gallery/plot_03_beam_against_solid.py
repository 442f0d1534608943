"""
03 Beam against solid for one leg
=================================

The same leg by beam elements and as a solid of quadratic hexahedra. In bending they agree. In
torsion the solid is stiffer, because its end faces are held plane: Saint-Venant's theory lets them
warp. With ends that are free to warp, this difference disappears.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexproof as fp

beam = fp.solve("ifw", "beam", leg=1, modes=4).answers[0]
solids = {
    ends: fp.solve("ifw", "solid", leg=1, modes=4, divisions=4, ends=ends).answers[0]
    for ends in ("rigid", "free")
}
differences = {
    ends: 100.0 * (np.diag(beam.compliance) / np.diag(solid.compliance) - 1.0)
    for ends, solid in solids.items()
}

figure, axes = plt.subplots(figsize=(7.4, 2.8), dpi=150, layout="constrained")
names = ["x", "y", "z", "phi_x", "phi_y", "phi_z"]
places = np.arange(len(names))
labels = {"rigid": "end faces held plane", "free": "end faces free to warp"}
for shift, ends in ((-0.2, "rigid"), (0.2, "free")):
    shown = differences[ends].round(2) + 0.0  # no −0.00
    bars = axes.bar(places + shift, shown, 0.38, label=labels[ends])
    axes.bar_label(bars, fmt="%.2f", fontsize=8)
axes.set_xticks(places, names)
axes.set(ylabel="beam minus solid (%)", title="tip compliance of leg 1", ylim=(-0.1, 1.8))
axes.axhline(0.0, color="black", linewidth=0.8)
axes.legend(frameon=False)
plt.show()

# %%

for ends, values in differences.items():
    print(f"{ends:6}", "  ".join(f"{n} {v:+.3f} %" for n, v in zip(names, values, strict=True)))

# %%
# Natural frequencies agree to 0.01 %:

for mode, (one, other) in enumerate(
    zip(beam.frequencies, solids["rigid"].frequencies, strict=True), start=1
):
    print(f"f{mode}: beam {one:.2f} Hz, solid {other:.2f} Hz, {100.0 * (one / other - 1.0):+.4f} %")

# %%
# The solid has a convergence of its own, with the number of elements across the section:

meshes = fp.converge("ifw", "solid", body="leg1", divisions=[1, 2, 3, 4])
meshes.plot(["f1", "f2"])
