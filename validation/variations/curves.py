"""Curves of all models over the values of one number of the robot file.

Input: a robot file and a `Variation`. Output: `VariedCurves` of deflections and of frequencies.
Rule: each value gives another robot, whose computation is a separate unit of work. Results of units
are stored in the cache and not computed again.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import naming
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.variation import Variation, assignments, variations_of, varied
from validation.adequacy.posture_errors import (
    Compared,
    compared_compliances,
    compared_frequencies,
)
from validation.context import BUILT_IN, Context, Preset
from validation.references.robot_on_path import RobotOnPath, path_postures, robot_at
from validation.run.cache import Arrays, find, key_of, program
from validation.run.executor import Executor, Finished, Work, in_turn
from validation.run.stored_results import stored_arrays
from validation.variations.decision import OBJECTIVES, Decision, Objective

# Function that compares the models, extreme over the path, and factor from SI units to those of
# `UNITS`, which for deflections are µm under 1000 N.
_OBJECTIVES: Mapping[
    Objective, tuple[Callable[[RobotOnPath], Compared], Callable[[Array], float], float]
] = {
    "deflection": (compared_compliances, np.max, 1e9),
    "frequency": (compared_frequencies, np.min, 1.0),
}


@dataclass(frozen=True, eq=False)
class VariedModels:
    """Objective and errors of all models for one robot of a variation, as plain arrays.

    There are c curves with `names`. Those before index `first_reference` belong to models, the
    remaining curves to the reference under each interpretation of the robot file. `values` (c×k,
    SI) and `differences` (c×k, relative to the first reference) are those in `pose`, the middle of
    the path. `extremes` (c): largest deflection (µm) or smallest first frequency (Hz) over the
    path; `uncertainties` (c): their relative half-widths, zero for models. Shapes: k quantities.
    """

    pose: Array
    names: Array
    values: Array
    differences: Array
    first_reference: int
    extremes: Array
    uncertainties: Array


@dataclass(frozen=True)
class VariedRobot:
    """One robot of a variation as a unit of work: its deflections or frequencies along its path.

    `value` is a text with the key and value of the varied parameter, for messages.
    """

    robot_file: RobotFile
    preset: Preset
    value: str
    objective: Objective

    def postures(self) -> tuple[Posture, ...]:
        """Postures of the path.

        Raises InputError, which names the value of the varied parameter, if a pose is out of reach.
        """
        with naming(f"--vary {self.value}"):
            return path_postures(self._context())

    def compute(self) -> VariedModels:
        """Values of all models and of the reference for this robot.

        Raises InputError if there is no reference, and ComputationError if a model cannot be
        solved. Both messages contain the value of the varied parameter.
        """
        postures = self.postures()
        compare, extreme, factor = _OBJECTIVES[self.objective]
        with naming(f"--vary {self.value}"):
            compared = compare(robot_at(self._context(), postures))
        middle, names = len(postures) // 2, list(compared.values)
        values = np.array([curve[middle] for curve in compared.values.values()])
        no_difference = np.full((len(postures), values.shape[1]), np.nan)
        differences = [compared.differences.get(name, no_difference)[middle] for name in names]
        extremes, half_widths = _extremes(compared.objectives, compared.uncertainties, extreme)
        return VariedModels(
            postures[middle].pose,
            np.array(names),
            values,
            np.array(differences),
            names.index(compared.against),
            factor * extremes,
            half_widths,
        )

    def _context(self) -> Context:
        return replace(_shared(self.preset), robot_file=self.robot_file)


def checked_variations(
    robot_file: RobotFile, typed: Sequence[str], preset: Preset
) -> tuple[Variation, ...]:
    """Variations from texts of the command line.

    Raises InputError, which names the value, if a robot is impossible or cannot follow its path.
    """
    variations = variations_of(robot_file, typed)
    for variation in variations:
        for unit in varied_robots(robot_file, variation, preset)[: len(variation.values)]:
            unit.postures()
    return variations


def varied_robots(
    robot_file: RobotFile, variation: Variation, preset: Preset
) -> tuple[VariedRobot, ...]:
    """Units of work for all values of the parameter: first deflections, then frequencies."""
    robots = varied(robot_file, (variation,))
    return tuple(
        VariedRobot(robot, preset, assignments((variation,), values), objective)
        for objective in OBJECTIVES
        for values, robot in robots
    )


@memo(3)
def _shared(preset: Preset) -> Context:
    """Context whose stored results all robots of a process share, since most bodies are equal."""
    return Context(load_robot(BUILT_IN), preset)


def _extremes(
    curves: Mapping[str, Array],
    uncertainties: Mapping[str, Array],
    extreme: Callable[[Array], float],
) -> tuple[Array, Array]:
    """Largest or smallest value (c) of each of c curves (p×k values), and its uncertainty (c).

    `extreme` is np.min or np.max. The uncertainty is the largest relative change of the extreme if
    all values of the curve increase, or decrease, by their relative `uncertainties`. Shapes: p
    poses, k quantities.
    """
    extremes = np.array([extreme(values) for values in curves.values()])
    half_widths = np.zeros(len(curves))
    for row, (name, values) in enumerate(curves.items()):
        if name in uncertainties and extremes[row] != 0.0:
            relative = uncertainties[name][:, : values.shape[1]]
            changed = np.array([extreme(values * np.exp(sign * relative)) for sign in (-1.0, 1.0)])
            half_widths[row] = np.abs(np.log(changed / extremes[row])).max()
    return extremes, half_widths


def computed(units: Sequence[VariedRobot], executor: Executor, task: str) -> list[VariedModels]:
    """Results of the units in their order.

    Each result is stored in the cache before the next is processed, so that an interrupted
    computation continues after the last one. Equal units are computed once. `task` is the text of
    the progress bar, which appears if stderr is a terminal. Raises the exception of the first unit
    that fails.
    """
    names = tuple(entry.name for entry in fields(VariedModels))
    keys = [key_of(program(), unit) for unit in units]
    tasks = {key: partial(_arrays, unit) for key, unit in zip(keys, units, strict=True)}
    stored = stored_arrays(tasks, names, partial(_shown, executor, task))
    # Numbers are stored as arrays without dimensions.
    values: list[dict[str, Any]] = [{k: v[()] for k, v in stored[key].items()} for key in keys]
    return [VariedModels(**arrays) for arrays in values]


def _arrays(unit: VariedRobot) -> dict[str, Any]:
    """Arrays of the result of a unit, by field."""
    return vars(unit.compute())


def _shown(executor: Executor, task: str, calls: Sequence[Work]) -> Finished:
    """Yield number and result of each call by the executor, with a progress bar."""
    from rich.console import Console  # noqa: PLC0415  few runs have variations
    from rich.progress import track  # noqa: PLC0415

    console = Console(stderr=True)
    with closing(executor(calls)) as finished:
        yield from track(
            finished,
            f"  {task}",
            total=len(calls),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )


def stored_robots(robot_file: RobotFile, variation: Variation, preset: Preset) -> dict[str, Arrays]:
    """Stored results of the robots of a variation, by their key in the cache."""
    keys = [key_of(program(), unit) for unit in varied_robots(robot_file, variation, preset)]
    return {key: arrays for key in keys if (arrays := find(key))}


@dataclass(frozen=True, eq=False)
class VariedCurves:
    """Deflections or frequencies by all models over the n values of a variation.

    `compared`: compliances (SI) or frequencies (Hz) in the middle of the path, in `poses` (n×m for
    m coordinates of a pose). `decision`: extremes over the whole path, from which each model
    chooses the best value.
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
    """Curves of all models over a variation, by objective. Stored results are not recomputed."""
    units = varied_robots(robot_file, variation, preset)
    results = computed(units, executor, f"varying {variation.key}")
    curves: dict[Objective, VariedCurves] = {}
    for index, objective in enumerate(OBJECTIVES):
        robots = results[index * len(variation.values) :][: len(variation.values)]
        poses = np.array([robot.pose for robot in robots])
        curves[objective] = VariedCurves(poses, _stacked(robots), decision_of(objective, robots))
    return curves


def _stacked(robots: Sequence[VariedModels]) -> Compared:
    """Curves over the varied robots, for the quantities that all robots have.

    NaN for a robot that a model does not solve.
    """
    common = min(robot.values.shape[1] for robot in robots)

    def stacked(column: str) -> dict[str, Array]:
        curves: dict[str, Array] = {}
        for row, robot in enumerate(robots):
            for name, values in zip(robot.names.tolist(), getattr(robot, column), strict=True):
                curve = curves.setdefault(name, np.full((len(robots), common), np.nan))
                curve[row] = values[:common]
        return curves

    # The first reference differs between robots if the variation gives a section, and thereby a
    # solid, to a leg given by its 6×6.
    references = list(dict.fromkeys(str(robot.names[robot.first_reference]) for robot in robots))
    differences = {
        name: curve for name, curve in stacked("differences").items() if name not in references
    }
    return Compared(stacked("values"), differences, " or ".join(references))


def decision_of(objective: Objective, robots: Sequence[VariedModels]) -> Decision:
    """Values of an objective for all robots, by models and by the reference.

    Only models that solve every robot are included. The reference has values under each
    interpretation of the robot file.
    """
    common_models = [
        str(name)
        for name in robots[0].names[: robots[0].first_reference]
        if all(name in robot.names[: robot.first_reference] for robot in robots)
    ]

    def column(name: str, curves: Sequence[int]) -> Array:
        pairs = zip(robots, curves, strict=True)
        return np.array([getattr(robot, name)[curve] for robot, curve in pairs])

    references, uncertainties = {}, {}
    for reading in range(max(len(robot.names) - robot.first_reference for robot in robots)):
        # If a robot has fewer readings than others, its last one replaces the missing ones.
        curves = [min(robot.first_reference + reading, len(robot.names) - 1) for robot in robots]
        names = set(column("names", curves).tolist())
        name = names.pop() if len(names) == 1 else f"reference, reading {reading + 1}"
        references[name] = column("extremes", curves)
        uncertainties[name] = column("uncertainties", curves)
    models = {
        name: column("extremes", [list(robot.names).index(name) for robot in robots])
        for name in common_models
    }
    return Decision(objective, models, references, uncertainties)
