"""Poses from the command line, and the postures of a mechanism for them.

Input: texts such as "0.25,0.6", or poses. Output: postures with closed loops. Raises InputError
with all poses that are malformed or out of reach.
"""

from collections.abc import Iterable, Sequence
from functools import partial
from time import perf_counter

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from validation.console.streams import write_message

# First number: poses after which the time for the remainder is estimated. Second number: largest
# estimate (s) without a message.
_TIMED_POSES, _SILENT_SECONDS = 10, 2.0


def parsed_pose(mechanism: Mechanism, text: str) -> Array:
    """Pose (SI) from numbers separated by commas, in the unit of length of the robot file.

    Raises InputError if the text is anything else.
    """
    moves = mechanism.tool.moves
    try:
        values = np.array([float(number) for number in text.split(",")])
    except ValueError:
        values = np.full(len(moves), np.nan)
    if len(values) != len(moves) or not np.isfinite(values).all():
        if not moves:
            raise InputError(
                f"--pose {text}: the tool of this robot has no moves; leave --pose out"
            )
        names = ",".join(moves)
        raise InputError(f"--pose {text}: must be {names} as finite numbers separated by commas")
    return mechanism.in_metres(values)


def parsed_poses(mechanism: Mechanism, texts: Iterable[str]) -> list[Array]:
    """Poses (SI) from texts. Raises InputError with the faults of all texts."""
    poses, faults = collect_faults(partial(parsed_pose, mechanism), texts)
    if faults:
        raise InputError(faults)
    return poses


def postures_of(mechanism: Mechanism, poses: Sequence[Array] | Array) -> list[Posture]:
    """Posture of each pose. A long computing time is announced on stderr.

    Raises InputError with the faults of all poses that have no posture.
    """
    postures, faults = _postures_and_faults(mechanism, poses)
    if faults:
        raise InputError(faults)
    return postures


def postures_on_path(mechanism: Mechanism, poses: Sequence[Array] | Array) -> list[Posture]:
    """Posture of each pose on a path. Poses of a grid that are out of reach are omitted.

    Raises InputError if a pose of a path that is not a grid, or every pose of a grid, is out of
    reach.
    """
    postures, faults = _postures_and_faults(mechanism, poses)
    if faults and not (mechanism.grid and postures):
        raise InputError(faults)
    return postures


def _postures_and_faults(
    mechanism: Mechanism, poses: Sequence[Array] | Array
) -> tuple[list[Posture], list[str]]:
    """Postures of the poses that can be reached, and why each other pose cannot be reached."""
    find, start = partial(posture, mechanism), perf_counter()
    postures, faults = collect_faults(find, poses[:_TIMED_POSES])
    seconds = (perf_counter() - start) * (len(poses) / _TIMED_POSES - 1.0)
    if seconds > _SILENT_SECONDS:
        write_message(f"{len(poses)} poses, about {seconds:.2g} s")
    later_postures, later_faults = collect_faults(find, poses[_TIMED_POSES:])
    return [*postures, *later_postures], [*faults, *later_faults]
