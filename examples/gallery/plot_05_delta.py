"""
05 A Delta with tubes
=====================

The built-in Delta has driven arms of hollow rectangles, and six rods of tube on ball joints. Each
rod may spin about itself: six idle mobilities, which do not move the tool.
"""

import numpy as np

import flexproof as fp

poses = [[0.0, 0.0, z] for z in np.linspace(-0.60, -0.44, 9)]
fp.draw("delta", poses=poses)

# %%
# Deflections and frequencies on the axis:

beam = fp.solve("delta", "beam", poses=poses, modes=3)
beam.plot()

# %%
# The Delta has threefold symmetry: on its axis x and y are equal, and modes come in pairs.

centre = beam.answers[4]
print(f"at z = {poses[4][2]:.2f} m: {centre.idle} idle mobilities")
x, y, z = 1e9 * np.diag(centre.compliance)[:3]
print(f"at 1000 N: x {x:.4f} µm, y {y:.4f} µm, z {z:.4f} µm")
print("f1 {:.3f} Hz, f2 {:.3f} Hz, f3 {:.3f} Hz".format(*centre.frequencies))

# %%
# With tubes twice as thick, how much stiffer does it become? Any number of a robot file can be
# replaced.

delta = fp.load("delta")
keys = [f"bodies.rod{leg}{side}.section.thickness" for leg in "123" for side in "lr"]
thick = delta.with_values(dict.fromkeys(keys, 0.004))
gain = fp.solve(thick, "beam", poses=[poses[4]], modes=0).answers[0].compliance / centre.compliance
for axis, place in (("x", 0), ("z", 2)):
    print(f"compliance along {axis} {100.0 * (gain[place, place] - 1.0):+.1f} %")
