"""Postures of a run's robot where tests look at it."""

from collections.abc import Iterable

import numpy as np

from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Posture
from validation.context import Context


def placed(context: Context, x: Iterable[float]) -> tuple[Posture, ...]:
    """The postures of a robot whose pose is one number, at each of `x` (m)."""
    mechanism = context.robot_file.mechanism
    return tuple(posture(mechanism, np.array([value])) for value in x)
