"""Forces under one load in one pose, and their numbers as they are shown."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.system.members import MemberForces
from lumped.system.reactions import Reaction
from validation.forces.solids import SolidStress
from validation.forces.stresses import MemberStress

REACTION_UNITS = ("N", "N", "N", "N m", "N m", "N m")
REACTIONS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
SECTION_FORCES = ("N", "Qy", "Qz", "T", "My", "Mz")
# Share of the largest force or moment of a load below which a number is round-off, shown as zero.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class ForcesUnderLoad:
    """Forces under one load in one pose, joints and legs in the order of the file.

    `stresses` are the largest stresses of legs by name, `without_stress` the reasons for which
    other legs have none. `solids` are the stress fields of bodies as solids, if requested.
    """

    reactions: tuple[Reaction, ...]
    members: tuple[MemberForces, ...]
    stresses: Mapping[str, MemberStress]
    without_stress: Mapping[str, str]
    solids: Mapping[str, SolidStress] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PoseForces:
    """Forces in one `pose` (m, rad), described by `place`, by name of the load.

    None if the mechanism cannot move as the load requires, or if the load's file has no wrench for
    the pose.
    """

    pose: tuple[float, ...]
    place: str
    loads: Mapping[str, ForcesUnderLoad | None]


def listed(values: Array) -> list[float | None]:
    """Numbers as a list, None for those that are not finite."""
    return [finite(value) for value in values.tolist()]


def finite(value: float) -> float | None:
    """The number, None if it is not finite."""
    return float(value) if np.isfinite(value) else None


def largest_of(found: ForcesUnderLoad) -> float:
    """Largest magnitude (N, N m) of all reactions and member forces."""
    wrenches = [one.wrench for one in found.reactions]
    along = [one.forces.ravel() for one in found.members]
    return float(np.nanmax(np.abs(np.concatenate([np.zeros(1), *wrenches, *along]))))


def shown(values: Array, scale: float) -> list[float | None]:
    """Numbers without the round-off of a largest one, None for those that are not finite."""
    return [
        0.0 if value is not None and abs(value) <= _ROUND_OFF * scale else value
        for value in listed(values)
    ]
