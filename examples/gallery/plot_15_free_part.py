"""
15 A part on soft cords
=======================

A rocker with three bores, hung on soft cords for a modal test: nothing holds it. Its six rigid-body
motions are counted and left out; each elastic frequency has the half-width of the meshes.
"""

from pathlib import Path

import flexproof as fp

part = Path(fp.__file__).parent / "examples" / "rocker" / "rocker.step"
steel = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
rocker = fp.identify_free(part, material=steel, unknowns=8_000, modes=4)
rocker.plot()

# %%

print(f"{rocker.total:.2f} kg, {rocker.rigid} rigid-body motions")
rocker.table()
