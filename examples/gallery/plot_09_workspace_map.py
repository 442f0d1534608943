"""
09 Map of the workspace
=======================

Lowest stiffness, first frequency and error of a model over a grid of poses. The robot is the
built-in five-bar with a grid as its path. The model that is relied on is that of Euler–Bernoulli
beams, without shear: the third map shows where that matters.
"""

import flexproof as fp

five_bar = fp.load(
    {
        **fp.load("five-bar").tables,
        "path": {"from": [-0.3, 0.3], "to": [0.3, 0.6], "counts": [11, 7]},
        "accept": {"rely": ["beam-euler-bernoulli"]},
    }
)
maps = fp.workspace(five_bar, preset="quick")
maps.plot()

# %%
# Stars are the worst postures, searched between the points of the grid, too:

maps.table()
