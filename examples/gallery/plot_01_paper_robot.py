"""
01 The paper's robot in ten lines
=================================

Deflection and natural frequencies of the PRRRP biglide of Briot, Pashkevich and Chablat over its
stroke: the virtual joint method with the 6×6 matrices of the paper, and beam elements on legs of
constant section.
"""

import numpy as np

import flexproof as fp

stroke = np.linspace(0.145, 0.85, 9)
fp.draw("ifw", poses=stroke)

# %%
# Deflection by the virtual joint method:

vjm = fp.solve("ifw", "vjm", poses=stroke)
vjm.plot()

# %%
# The paper reports that z is the weakest direction. In the middle of the stroke, with 1000 N along
# each axis:

compliance = vjm.answers[4].compliance
planar = 1e9 * np.linalg.norm(compliance[:2, :2], axis=0)
along_z = 1e9 * compliance[2, 2]
print(f"planar: {planar[0]:.2f} µm under fx, {planar[1]:.2f} µm under fy; z: {along_z:.1f} µm")

# %%
# The virtual joint method is static. Frequencies come from models with mass, here beam elements:

beam = fp.solve("ifw", "beam", poses=stroke, modes=4)
frequencies = beam.answers[4].frequencies
beam.table()
