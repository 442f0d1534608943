"""Poses as they are typed, and the postures that belong to them."""

from collections.abc import Iterable, Sequence

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture


def poses_of(mechanism: Mechanism, texts: Iterable[str]) -> list[Array]:
    """Poses (m, rad, in the order of the tool's moves) from texts like "0.25,0.6".

    Raises InputError, all faults at once.
    """
    moves = mechanism.tool.moves
    wanted = f"must be {len(moves)} numbers with commas ({','.join(moves)}), like " + ",".join(
        f"{value:g}" for value in mechanism.reference_pose
    )
    poses, faults = [], []
    for text in texts:
        try:
            pose = np.array([float(number) for number in text.split(",")])
        except ValueError:
            pose = np.array([np.nan])
        if len(pose) == len(moves) and np.isfinite(pose).all():
            poses.append(pose)
        else:
            faults.append(f"--pose = {text}: {wanted}")
    if faults:
        raise InputError(faults)
    return poses


def postures_of(mechanism: Mechanism, poses: Sequence[Array] | Array) -> list[Posture]:
    """The postures of the poses; raises InputError with the faults of all that have none."""
    found: list[Posture] = []
    faults: list[str] = []
    for pose in poses:
        try:
            found.append(posture(mechanism, pose))
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return found
