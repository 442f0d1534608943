"""Oracle: the biglide by hand, its joints as unknowns that two bodies share.

A formulation of its own beside `lumped.system`. Unknowns of the robot: platform (6, at B), tool (6,
with a tool spring), foot 1 and foot 2 (6 each, unless rigid), the absolute rotations φz of both leg
roots and of leg 2's tip, then the legs' inner unknowns. A revolute joint about z is exact: its two
sides share five components and have a φz each. With the printed release of eq. (25) a foot without
its φz acts on the leg's root itself, and leg 2, which carries the joint, shares all six at B.
"""

import numpy as np

from lumped.dense.modes import dense
from lumped.screws import rotation_z, shift, turn
from lumped.system.joint_motion import printed_release


def by_hand(data, x, leg1, leg2, release="condensed"):
    """Stiffness, mass (n×n) and the rows of the loaded point (6×n), dense, with B at `x` (m).

    `data` are the arguments of the robot's constructor.
    """
    size = 6
    foot, spring = data["foot_compliance"], data.get("tool_compliance")
    offset = data.get("tool_offset", np.zeros(3))
    lengths = data["leg1"].length, data["leg2"].length
    heights = (np.sqrt(L**2 - b**2) for L, b in zip(lengths, (x, data["a"] - x), strict=True))
    angles = (np.arctan2(h, b) for h, b in zip(heights, (x, x - data["a"]), strict=True))
    rotations = [rotation_z(float(angle)) for angle in angles]
    platform = list(range(6))

    def new(count):
        nonlocal size
        size += count
        return list(range(size - count, size))

    tool = platform if spring is None else new(6)
    rigid = foot is None
    feet = [[-1] * 6 if rigid else new(6) for _ in range(2)]
    shared = release == "printed" and not rigid
    roots = [foot if shared else foot[:5] + new(1) for foot in feet]
    tips = [platform, platform if release == "printed" else platform[:5] + new(1)]
    inner = [new(leg.size - 12) for leg in (leg1, leg2)]

    def select(numbers):
        rows = np.zeros((len(numbers), size))
        for row, number in enumerate(numbers):
            if number >= 0:
                rows[row, number] = 1.0
        return rows

    moved = shift(offset) @ select(platform)
    loaded = moved if spring is None else select(tool)
    stiffness, mass = np.zeros((size, size)), data["platform_mass"] * loaded[:3].T @ loaded[:3]
    legs = zip((leg1, leg2), rotations, roots, tips, inner, strict=True)
    for leg, rotation, root, tip, inside in legs:
        rows = select(root + tip + inside)
        for end in (slice(0, 6), slice(6, 12)):
            rows[end] = turn(rotation).T @ rows[end]
        stiffness += rows.T @ dense(leg.stiffness) @ rows
        mass += rows.T @ dense(leg.mass) @ rows
    if not rigid:
        foot = np.linalg.inv(foot)
        foot = printed_release(foot) if release == "printed" else foot
        for where in feet:
            stiffness += select(where).T @ foot @ select(where)
    if spring is not None:
        apart = select(tool) - moved
        stiffness += apart.T @ np.linalg.inv(spring) @ apart
    return stiffness, mass, loaded
