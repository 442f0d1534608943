"""
06 A CAD part, identified
=========================

A tapered leg with lugs and bores, read from a STEP file. Between its two bores it is a 6×6
compliance and a mass, each number with its uncertainty: of the meshes, and of how the bores are
held (rigid pins, or averaged).
"""

from pathlib import Path

import flexproof as fp

part = Path(fp.__file__).parent / "examples" / "tapered-biglide" / "leg1.step"
leg = fp.identify(
    part,
    interfaces={
        "A": {"cylinder": {"radius": 0.040}, "coupling": "rigid"},
        "B": {"cylinder": {"radius": 0.028}, "coupling": "rigid"},
    },
    material={"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
    unknowns=10_000,
    modes=4,
)
leg.plot()

# %%

print(f"{leg.total:.2f} kg; meshes of {', '.join(map(str, leg.unknowns))} unknowns")
leg.table()
