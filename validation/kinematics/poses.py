"""Poses as they are typed, and the postures that belong to them."""

from collections.abc import Iterable, Sequence
from functools import partial
from time import perf_counter

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from validation.console.streams import mention

# Poses that tell how long one takes, and seconds that need no forecast.
_FEW, _PATIENCE = 10, 2.0


def parsed_pose(mechanism: Mechanism, text: str) -> Array:
    """A pose as typed, in the file's unit of length, numbers separated by commas.

    Raises InputError for anything else.
    """
    moves = mechanism.tool.moves
    try:
        values = np.array([float(number) for number in text.split(",")])
    except ValueError:
        values = np.full(len(moves), np.nan)
    if len(values) != len(moves) or not np.isfinite(values).all():
        wanted = ",".join(moves) or "nothing: the tool has no moves"
        raise InputError(f"--pose {text}: must be {wanted} as finite numbers separated by commas")
    return mechanism.in_metres(values)


def parsed_poses(mechanism: Mechanism, texts: Iterable[str]) -> list[Array]:
    """Typed poses; raises InputError with the faults of all."""
    found, faults = collect_faults(partial(parsed_pose, mechanism), texts)
    if faults:
        raise InputError(faults)
    return found


def postures_of(mechanism: Mechanism, poses: Sequence[Array] | Array) -> list[Posture]:
    """The postures of the poses; says how long it takes where that is long.

    Raises InputError with the faults of all that have none.
    """
    found, faults = _tried(mechanism, poses)
    if faults:
        raise InputError(faults)
    return found


def postures_on_path(mechanism: Mechanism, poses: Sequence[Array] | Array) -> list[Posture]:
    """The same of poses of the path; of a grid those within reach, if there are any."""
    found, faults = _tried(mechanism, poses)
    if faults and not (mechanism.grid and found):
        raise InputError(faults)
    return found


def _tried(mechanism: Mechanism, poses: Sequence[Array] | Array) -> tuple[list[Posture], list[str]]:
    """The postures of those poses that have one, and why the others have none."""
    find, begun = partial(posture, mechanism), perf_counter()
    found, faults = collect_faults(find, poses[:_FEW])
    seconds = (perf_counter() - begun) * (len(poses) / _FEW - 1.0)
    if seconds > _PATIENCE:
        mention(f"{len(poses)} poses, about {seconds:.2g} s")
    more, others = collect_faults(find, poses[_FEW:])
    return [*found, *more], [*faults, *others]
