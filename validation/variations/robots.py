"""Robots that differ from a run's in one number, each by all models: units of work for a sweep."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.caches import lru_cache
from lumped.errors import ComputationError, InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Posture
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.variation import Variation, told, variations_of, varied
from validation.adequacy.mechanism.compared import (
    Compared,
    compared_compliances,
    compared_frequencies,
)
from validation.context import BUILT_IN, Context, Preset


@dataclass(frozen=True, eq=False)
class VariedModels:
    """What all models say of one robot: plain arrays, as a journal keeps them.

    Of statics (s curves: names, values s×6 in SI, differences from curve number `static_against`)
    and of frequencies (d curves, d×k in Hz).
    """

    static: Array
    compliances: Array
    static_differences: Array
    static_against: int
    dynamic: Array
    frequencies: Array
    dynamic_differences: Array
    dynamic_against: int


@dataclass(frozen=True)
class VariedRobot:
    """One robot of a variation in one pose; `said` tells the value, for errors."""

    robot_file: RobotFile
    preset: Preset
    pose: tuple[float, ...]
    said: str

    def posture(self) -> Posture:
        """The robot in its pose; raises InputError where it cannot be there."""
        try:
            return posture(self.robot_file.mechanism, np.array(self.pose))
        except InputError as error:
            raise InputError([f"--vary {self.said}: {fault}" for fault in error.faults]) from error

    def compute(self) -> VariedModels:
        """All models; raises InputError and ComputationError, which name the value."""
        at = (self.posture(),)
        context = replace(_shared(self.preset), robot_file=self.robot_file)
        try:
            statics = compared_compliances(context, at)
            modes = self.robot_file.requirement.modes
            dynamics = compared_frequencies(context, at, modes)
        except (InputError, ComputationError) as error:
            raise ComputationError(f"--vary {self.said}: {error}") from error
        return VariedModels(*_packed(statics), *_packed(dynamics))


def checked_variations(robot_file: RobotFile, typed: Sequence[str]) -> tuple[Variation, ...]:
    """The variations as typed, each looked at by itself.

    Raises InputError, naming the values, where a robot cannot be or cannot be in the pose.
    """
    variations = variations_of(robot_file, typed)
    for variation in variations:
        for unit in varied_robots(robot_file, variation, "quick"):
            unit.posture()
    return variations


def varied_robots(
    robot_file: RobotFile, variation: Variation, preset: Preset
) -> tuple[VariedRobot, ...]:
    """A unit for each value, all in the pose in the middle of the robot's own path."""
    poses = robot_file.mechanism.poses
    pose = tuple(poses[len(poses) // 2].tolist())
    return tuple(
        VariedRobot(robot, preset, pose, told((variation,), values))
        for values, robot in varied(robot_file, (variation,))
    )


@lru_cache(maxsize=None)
def _shared(preset: Preset) -> Context:
    """A memo for all robots of a process: most of their bodies are the same."""
    return Context(load_robot(BUILT_IN), preset)


def _packed(found: Compared) -> tuple[Array, Array, Array, int]:
    """Names, values and differences (one row a curve) in one pose, and which is the reference."""
    names = list(found.values)
    values = np.array([found.values[name][0] for name in names])
    none = np.full((1, values.shape[1]), np.nan)
    differences = np.array([found.differences.get(name, none)[0] for name in names])
    return np.array(names), values, differences, names.index(found.against)
