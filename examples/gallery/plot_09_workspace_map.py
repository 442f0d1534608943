"""
09 Map of the workspace
=======================

Lowest stiffness, first frequency and error of a model over a grid of poses. The robot is the
built-in five-bar with a grid as its path. The simplified model, rigid bodies on elastic drives, is
the one that is relied on: the third map shows where it is wrong.
"""

import flexproof as fp

five_bar = fp.load(
    {
        **fp.load("five-bar").tables,
        "path": {"from": [-0.3, 0.3], "to": [0.3, 0.6], "counts": [11, 7]},
        "accept": {"rely": ["simplified"]},
    }
)
maps = fp.workspace(five_bar, preset="quick")
maps.plot()

# %%
# Stars are the worst postures, searched between the points of the grid, too:

maps.table()
