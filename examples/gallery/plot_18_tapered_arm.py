"""
18 A tapered and curved arm
===========================

A swan-neck arm whose rectangle shrinks along a quarter circle: beam elements integrate its
flexibility along the line, so that statics is exact for any number of elements.
"""

from pathlib import Path

import numpy as np

import flexproof as fp

robot = fp.load(Path(fp.__file__).parent / "examples" / "tapered-arm" / "robot.toml")
fp.draw(robot)

# %%
# Beam elements and rigid segments converge with the same orders as those of a prism: 4 and 2.

study = fp.converge(robot, body="arm")
study.plot()

# %%
# The arm alone as a solid of hexahedra stretched along the line, its ends free to warp:

beam = fp.solve(robot, "beam", body="arm", modes=4)
solid = fp.solve(robot, "solid", body="arm", modes=4, divisions=2, ends="free")
deflections = {
    model: np.diag(solution.answers[0].compliance)[:3]
    for model, solution in (("beam", beam), ("solid", solid))
}
for axis, of_beam, of_solid in zip("xyz", *deflections.values(), strict=True):
    print(f"{axis}: beam {1e9 * of_beam:.1f} µm/kN, solid {1e9 * of_solid:.1f} µm/kN")

# %%
# Section forces along the line under a force on the tool, in the axes of the sections, with the
# stresses of Winkler's curved bar on the arc:

pushed = {"name": "push", "wrench": [0.0, -500.0, -200.0, 0.0, 0.0, 0.0]}
forces = fp.forces({**robot.tables, "loads": [pushed]})
forces.member_table()

# %%

forces.plot()
