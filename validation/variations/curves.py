"""Curves of all models over a number of the robot file, from robots kept in the cache.

Each robot is a unit of work: finished ones are kept and not computed again.
"""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from inspect import signature
from typing import Protocol, TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track

from lumped.arrays import Array
from lumped.memo import memo
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.adequacy.compared import Compared
from validation.context import Preset
from validation.run.cache import find, keep, key_of
from validation.run.executor import Executor, in_turn
from validation.run.provenance import suite_digest
from validation.variations.decision import OBJECTIVES, Decision, Objective
from validation.variations.robots import VariedModels, varied_robots

T = TypeVar("T")
Result_co = TypeVar("Result_co", covariant=True)


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
    keys = [key_of(_sources(), unit) for unit in units]
    work = dict(zip(keys, units, strict=True))
    names = set(signature(kind).parameters)
    known = {key: arrays for key in work if (arrays := find(key)) and set(arrays) == names}
    missing = [key for key in work if key not in known]
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


@memo(1)
def _sources() -> str:
    return suite_digest()


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
