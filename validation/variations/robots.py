"""Robots that differ from a run's in one number, each by all models: units of work for a sweep."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.errors import naming
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.variation import Variation, told, variations_of, varied
from validation.adequacy.compared import (
    Compared,
    compared_compliances,
    compared_frequencies,
    compared_statics,
)
from validation.adequacy.mechanism.path import RobotOnPath, path_postures, robot_at
from validation.context import BUILT_IN, Context, Preset
from validation.variations.decision import OBJECTIVES, Objective

# Deflections (µm) under 1000 N of compliances in m/N.
_MICROMETRES = 1e9


@dataclass(frozen=True, eq=False)
class VariedModels:
    """What all models say of one robot: plain arrays, as the cache keeps them.

    Of c curves their `names`, in the `pose` in the middle of the path `values` (c×k, SI) and
    `differences` (c×k) from curve number `against`; over the path the `extremes` (c; largest
    deflection, µm, or smallest first frequency, Hz) and their relative `uncertainties`. From curve
    `against` on they are the reference by every reading of what the robot file leaves open; those
    before it are models, whose numbers are theirs without any uncertainty.
    """

    pose: Array
    names: Array
    values: Array
    differences: Array
    against: int
    extremes: Array
    uncertainties: Array


@dataclass(frozen=True)
class VariedRobot:
    """Deflections or frequencies of one robot on its path; `said` tells the value, for errors."""

    robot_file: RobotFile
    preset: Preset
    said: str
    objective: Objective

    def postures(self) -> tuple[Posture, ...]:
        """The robot on its path; raises InputError where it cannot be there."""
        with naming(f"--vary {self.said}"):
            return path_postures(self._context())

    def compute(self) -> VariedModels:
        """All models; raises InputError, without reference, and ComputationError, which name it."""
        at = self.postures()
        with naming(f"--vary {self.said}"):
            found, extremes = self._over_path(robot_at(self._context(), at))
        middle, names = len(at) // 2, list(found.values)
        values = np.array([one[middle] for one in found.values.values()])
        none = np.full((len(at), values.shape[1]), np.nan)
        differences = [found.differences.get(name, none)[middle] for name in names]
        return VariedModels(
            at[middle].pose,
            np.array(names),
            values,
            np.array(differences),
            names.index(found.against),
            *extremes,
        )

    def _over_path(self, robot: RobotOnPath) -> tuple[Compared, tuple[Array, Array]]:
        """What the models say in every pose, and the extremes with their uncertainties."""
        if self.objective == "frequency":
            compared = compared_frequencies(robot)
            first = {name: one[:, :1] for name, one in compared.values.items()}
            return compared, _extremes(first, compared.uncertainties, np.min)
        compliances, uncertainties = compared_statics(robot)
        displacements = {
            name: _MICROMETRES * np.linalg.norm(one[:, :3, :3], axis=1)
            for name, one in compliances.items()
        }
        extremes = _extremes(displacements, uncertainties, np.max)
        return compared_compliances(compliances, uncertainties), extremes

    def _context(self) -> Context:
        return replace(_shared(self.preset), robot_file=self.robot_file)


def checked_variations(
    robot_file: RobotFile, typed: Sequence[str], preset: Preset
) -> tuple[Variation, ...]:
    """The variations as typed, each looked at by itself.

    Raises InputError, naming the values, where a robot cannot be or cannot follow its path.
    """
    variations = variations_of(robot_file, typed)
    for variation in variations:
        for unit in varied_robots(robot_file, variation, preset)[: len(variation.values)]:
            unit.postures()
    return variations


def varied_robots(
    robot_file: RobotFile, variation: Variation, preset: Preset
) -> tuple[VariedRobot, ...]:
    """Units for each value: of deflections all, then of frequencies all."""
    robots = varied(robot_file, (variation,))
    return tuple(
        VariedRobot(robot, preset, told((variation,), values), objective)
        for objective in OBJECTIVES
        for values, robot in robots
    )


@memo(3)
def _shared(preset: Preset) -> Context:
    """A memo for all robots of a process: most of their bodies are the same."""
    return Context(load_robot(BUILT_IN), preset)


def _extremes(
    found: Mapping[str, Array], uncertainties: Mapping[str, Array], of: Callable[[Array], float]
) -> tuple[Array, Array]:
    """Largest or smallest of the values (p×k) of each curve, and its relative uncertainty."""
    extremes = np.array([of(values) for values in found.values()])
    left_open = np.zeros(len(found))
    for place, (name, values) in enumerate(found.items()):
        if name in uncertainties and extremes[place] != 0.0:
            part = uncertainties[name][:, : values.shape[1]]
            moved = np.array([of(values * np.exp(way * part)) for way in (-1.0, 1.0)])
            left_open[place] = np.abs(np.log(moved / extremes[place])).max()
    return extremes, left_open
