"""
19 Loads along a leg
====================

A cantilever axis carries a cable chain on its outer part, a load per length, and its own weight.
"""

import flexproof as fp

length, start, chain = 0.8, 0.3, 60.0
axis = {
    "schema": 2,
    "name": "cantilever axis",
    "points": {"A": [0.0, 0.0, 0.0], "P": [length, 0.0, 0.0]},
    "bodies": {
        "arm": {
            "from": "A",
            "to": "P",
            "section": {
                "shape": "hollow-rectangle",
                "width": 0.08,
                "height": 0.06,
                "thickness": 0.004,
            },
            "material": {"E": 7.0e10, "nu": 0.33, "rho": 2700.0},
        }
    },
    "joints": {"clamp": {"type": "fixed", "between": ["ground", "arm"], "at": "A"}},
    "tool": {"body": "arm", "point": "P", "moves": []},
    "loads": [
        {
            "name": "chain",
            "lines": [{"leg": "arm", "wrench": [0.0, 0.0, -chain, 0.0, 0.0, 0.0], "from": start}],
        },
        {"name": "weight", "gravity": [0.0, 0.0, -9.81]},
    ],
}

# %%
# The bending moment grows from the tip with the square of the distance, beyond the chain linearly.

forces = fp.forces(axis)
forces.plot()

# %%
# A load along the leg is integrated exactly, with one element as with twenty.

sag = {
    name: {
        count: float(fp.solve(axis, "beam", elements=count).answers[0].loads[name][2])
        for count in (1, 20)
    }
    for name in ("chain", "weight")
}
for name, by_count in sag.items():
    print(name, ", ".join(f"{count}: {1e6 * z:.2f} µm" for count, z in by_count.items()))

# %%
# The clamp carries the whole chain, and its moment.

clamp = forces.poses[0].loads["chain"].reactions[0]
print(f"{abs(clamp.wrench[2]):.1f} N, {abs(clamp.wrench[4]):.2f} N m")
