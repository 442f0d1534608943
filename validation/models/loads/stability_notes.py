"""What no linear model sees: how near to buckling a robot comes under its own loads on its path."""

from collections.abc import Iterator, Sequence

import numpy as np

from lumped.acceptance.requirement import AXES, LOAD, Requirement
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Posture
from lumped.system.stability import Stability
from validation.drawing.text import number, percent

# Less is left open of no error.
_NOTHING = 1e-3


def stability_notes(
    postures: Sequence[Posture],
    found: Sequence[Sequence[Stability | None]],
    requirement: Requirement,
) -> tuple[str, ...]:
    """A line for each load that takes stiffness: where it is nearest to buckling, and how much.

    `found` in each posture under each load.
    """
    loads = [load.name for load in postures[0].mechanism.loads]
    return tuple(
        f"Load {load}: {'; '.join(said)}"
        for load, row in zip(loads, zip(*found, strict=True), strict=True)
        if (known := [(at, one) for at, one in zip(postures, row, strict=True) if one])
        and (said := [*_said(f"{LOAD}{load}", requirement, known)])
    )


def _said(
    load: str, requirement: Requirement, found: Sequence[tuple[Posture, Stability]]
) -> Iterator[str]:
    lost = np.array([one.lost for _, one in found])
    taken, moved = float(lost.max()), max(one.farther for _, one in found)
    if np.isfinite(lost).all() and max(taken, moved) < _NOTHING:
        return
    buckling = [(one.factor, at, one) for at, one in found if one.factor is not None]
    if buckling:
        factor, at, one = min(buckling, key=lambda place: place[0])
        place = shown_pose(at.mechanism, at.pose)
        where = f", first at {place}" if place else ""
        most = next(iter(one.shares))
        yield f"buckles the robot at {number(factor, 3)} times this load{where}, in {most}"
    else:
        yield "buckles the robot nowhere"
    if not np.isfinite(lost).all():
        yield "nothing that is said of the robot under it holds"
        return
    axis = AXES[int(np.argmax(lost.max(axis=0)))]
    said = (
        f"takes up to {percent(max(taken, 0.0), signed=False)} of the tool's stiffness ({axis}) "
        f"and changes its displacement by {percent(moved, signed=False)}, which no linear "
        "model sees"
    )
    limit = requirement.limit(load)
    if requirement.absolute(load) is None and moved > limit:
        said += f": more than the {percent(limit, signed=False)} that are accepted"
    yield said
