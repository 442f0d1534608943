"""All models over a number of the robot file: robots that differ in it, as units of work.

Finished units are kept in the cache and not computed again.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from inspect import signature
from typing import Protocol, TypeVar

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
from validation.run.cache import find, keep, key_of
from validation.run.executor import Executor, in_turn
from validation.run.sources import program
from validation.variations.decision import OBJECTIVES, Decision, Objective

T = TypeVar("T")
Result_co = TypeVar("Result_co", covariant=True)
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
        statics, uncertainties = compared_statics(robot)
        displacements = {
            name: _MICROMETRES * np.linalg.norm(one.compliances[:, :3, :3], axis=1)
            for name, one in statics.items()
        }
        extremes = _extremes(displacements, uncertainties, np.max)
        return compared_compliances(statics, uncertainties), extremes

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


class Unit(Protocol[Result_co]):
    """Plain data that stand for a result, and can be sent to other processes and machines."""

    def compute(self) -> Result_co:
        """The result."""


def computed(
    units: Sequence[Unit[T]], kind: Callable[..., T], executor: Executor, what: str
) -> list[T]:
    """What the units yield, a `kind` each (a dataclass of numbers and arrays), in their order.

    Every finished unit is in the cache before the next one is looked at, so that what was
    interrupted goes on where it stopped; equal units are computed once. `what` is being done, for
    the progress on stderr if that is a terminal. Raises what the first failing unit raises.
    """
    keys = [key_of(program(), unit) for unit in units]
    work = dict(zip(keys, units, strict=True))
    names = set(signature(kind).parameters)
    known = {key: arrays for key in work if (arrays := find(key)) and set(arrays) == names}
    missing = [key for key in work if key not in known]
    from rich.console import Console  # noqa: PLC0415  few runs vary anything
    from rich.progress import track  # noqa: PLC0415

    console = Console(stderr=True)
    if missing:
        with closing(executor([work[key].compute for key in missing])) as finished:
            for number, result in track(
                finished,
                f"  {what}",
                total=len(missing),
                console=console,
                transient=True,
                disable=not console.is_terminal,
            ):
                arrays = {name: getattr(result, name) for name in names}
                known[missing[number]] = keep(missing[number], arrays)
    # Numbers are kept as arrays of no dimension.
    return [kind(**{name: array[()] for name, array in known[key].items()}) for key in keys]


@dataclass(frozen=True, eq=False)
class VariedCurves:
    """Deflections or frequencies by all models over the n values of a variation.

    `compared` (compliances, SI, or frequencies, Hz) in the middle of the path, where the robots are
    in `poses` (n×m); the `decision` over the whole of it.
    """

    poses: Array
    compared: Compared
    decision: Decision


def variation_study(
    robot_file: RobotFile,
    variation: Variation,
    preset: Preset,
    executor: Executor = in_turn,
) -> dict[Objective, VariedCurves]:
    """All models of every robot of the variation, from the cache as far as it goes."""
    units = varied_robots(robot_file, variation, preset)
    found = computed(units, VariedModels, executor, f"varying {variation.key}")
    curves: dict[Objective, VariedCurves] = {}
    for number, objective in enumerate(OBJECTIVES):
        robots = found[number * len(variation.values) :][: len(variation.values)]
        poses = np.array([robot.pose for robot in robots])
        curves[objective] = VariedCurves(poses, _stacked(robots), decision_of(objective, robots))
    return curves


def _stacked(robots: Sequence[VariedModels]) -> Compared:
    """Curves over the robots, of as many quantities as all have; NaN where one has no such."""
    least = min(robot.values.shape[1] for robot in robots)

    def over(column: str) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for number, robot in enumerate(robots):
            for name, values in zip(robot.names.tolist(), getattr(robot, column), strict=True):
                curve = found.setdefault(name, np.full((len(robots), least), np.nan))
                curve[number] = values[:least]
        return found

    # A number of the file may make a solid of a leg known by its 6×6: there are then several.
    references = list(dict.fromkeys(str(robot.names[robot.against]) for robot in robots))
    differences = {name: one for name, one in over("differences").items() if name not in references}
    return Compared(over("values"), differences, " or ".join(references))


def decision_of(objective: Objective, robots: Sequence[VariedModels]) -> Decision:
    """By the models that answer for every robot, and by every reading of the references."""
    models = [
        str(name)
        for name in robots[0].names[: robots[0].against]
        if all(name in robot.names[: robot.against] for robot in robots)
    ]

    def read(column: str, at: Sequence[int]) -> Array:
        return np.array([getattr(robot, column)[k] for robot, k in zip(robots, at, strict=True)])

    references, uncertainties = {}, {}
    for reading in range(max(len(robot.names) - robot.against for robot in robots)):
        # Where a robot leaves less open than others, its last reading goes with all further ones.
        at = [min(robot.against + reading, len(robot.names) - 1) for robot in robots]
        kinds = set(read("names", at).tolist())
        name = kinds.pop() if len(kinds) == 1 else f"reference, reading {reading + 1}"
        references[name], uncertainties[name] = read("extremes", at), read("uncertainties", at)
    own = {
        name: read("extremes", [list(robot.names).index(name) for robot in robots])
        for name in models
    }
    return Decision(objective, own, references, uncertainties)
