"""Data records of the forces under one load in one pose, and their rounded numbers for display.

Input: reactions, section forces and stresses. Output: `ForcesUnderLoad` and `PoseForces`. Rule: a
number that is negligible compared with the largest force or moment is round-off and displayed as
zero.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.system.members import MemberForces
from lumped.system.reactions import Reaction
from validation.forces.solids import SolidStress
from validation.forces.stresses import LaminateStress, MemberStress
from validation.record_fields import finite_items

REACTION_UNITS = ("N", "N", "N", "N m", "N m", "N m")
REACTIONS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
SECTION_FORCES = ("N", "Qy", "Qz", "T", "My", "Mz")
# Stresses of a layer of fibres, along the fibres, across them, and in shear.
LAYER_STRESSES = ("σ1", "σ2", "τ12")
# Share of the largest force or moment of a load below which a number is round-off, shown as zero.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class ForcesUnderLoad:
    """Reactions of joints, and forces and stresses of legs, under one load in one pose.

    `stresses` are the largest stresses of legs by name, `laminates` those of the layers of legs of
    fibre layers, and `without_stress` the reasons for which other legs have none. `solids` are the
    stress fields of bodies as solids, if requested.
    """

    reactions: tuple[Reaction, ...]
    members: tuple[MemberForces, ...]
    stresses: Mapping[str, MemberStress]
    without_stress: Mapping[str, str]
    laminates: Mapping[str, LaminateStress] = field(default_factory=dict)
    solids: Mapping[str, SolidStress] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PoseForces:
    """Forces in one `pose` (m, rad) under each load, by name of the load.

    `place` describes the pose. The forces are None if the tool cannot perform the speed and
    acceleration that the load prescribes, or if the file of the load has no wrench for the pose.
    """

    pose: tuple[float, ...]
    place: str
    loads: Mapping[str, ForcesUnderLoad | None]


def largest_of(result: ForcesUnderLoad) -> float:
    """Largest magnitude (N, N m) of all reactions and member forces."""
    wrenches = [reaction.wrench for reaction in result.reactions]
    along = [member.forces.ravel() for member in result.members]
    return float(np.nanmax(np.abs(np.concatenate([np.zeros(1), *wrenches, *along]))))


def shown(values: Array, scale: float) -> list[float | None]:
    """Numbers for display.

    A number that is negligible compared with `scale` is round-off and displayed as zero. None for
    an infinite number or NaN.
    """
    return [
        0.0 if value is not None and abs(value) <= _ROUND_OFF * scale else value
        for value in finite_items(values)
    ]
