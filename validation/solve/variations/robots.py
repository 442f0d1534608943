"""One model of many robots that differ in some numbers of their file, here or on a cluster."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.acceptance.requirement import AXES, ROTATIONS
from lumped.errors import naming
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation, told, varied
from validation.drawing.style import csv_of
from validation.run.executor import Executor
from validation.solve.answer import Answer, Solution, record_of
from validation.solve.model_answers import checked, solve
from validation.solve.question import Asked, Question

# What is told of each deflection: µm under 1000 N, µrad under 100 N m.
_LOADS = 3 * (1000.0,) + 3 * (100.0,)
_MICRO = 1e6


@dataclass(frozen=True)
class VariedAnswers:
    """The answers for every combination of the values of `variations`, in their order."""

    variations: tuple[Variation, ...]
    values: tuple[tuple[float, ...], ...]
    solutions: tuple[Solution, ...]


@dataclass(frozen=True)
class _Unit:
    """One robot: plain data that can be sent to other processes and machines."""

    said: str
    asked: Question

    def __call__(self) -> Solution:
        with naming(f"--vary {self.said}"):
            return solve(self.asked)


def solve_varied(
    robot_file: RobotFile,
    variations: tuple[Variation, ...],
    asked: Asked,
    executor: Executor,
) -> VariedAnswers:
    """Every robot of the variations, asked the same.

    Raises InputError, naming the values, before anything is computed where a robot cannot be or
    cannot be where it is asked, ComputationError where one cannot be solved.
    """
    robots = varied(robot_file, variations)
    units = []
    for values, robot in robots:
        said = told(variations, values)
        # Tables of many robots have no room for what digits leave open of each.
        question = replace(asked.of(robot), text="")
        with naming(f"--vary {said}"):
            checked(question)
        units.append(_Unit(said, question))
    solved = dict(executor(units))
    return VariedAnswers(
        variations,
        tuple(values for values, _ in robots),
        tuple(solved[number] for number in range(len(units))),
    )


def without_say(found: VariedAnswers) -> list[str]:
    """A line for every number that was varied and changes no answer."""
    lines = []
    for place, one in enumerate(found.variations):
        first: dict[tuple[float, ...], Solution] = {}
        changes = False
        for values, solution in zip(found.values, found.solutions, strict=True):
            others = values[:place] + values[place + 1 :]
            changes = changes or not _alike(first.setdefault(others, solution), solution)
        if len(one.values) > 1 and not changes:
            model = found.solutions[0].model
            lines.append(f"--vary {one.key}: changes no answer of the {model} model")
    return lines


def _alike(one: Solution, other: Solution) -> bool:
    return all(
        np.array_equal(a.compliance, b.compliance) and np.array_equal(a.frequencies, b.frequencies)
        for a, b in zip(one.answers, other.answers, strict=True)
    )


def columns(found: VariedAnswers) -> dict[str, list[float | str]]:
    """A row for each robot and posture: values, place, deflections and frequencies."""
    rows = [
        (values, answer)
        for values, solution in zip(found.values, found.solutions, strict=True)
        for answer in solution.answers
    ]
    table: dict[str, list[float | str]] = {
        one.key: [values[place] for values, _ in rows] for place, one in enumerate(found.variations)
    }
    for name, value in rows[0][1].place.items():
        places = [answer.place[name] for _, answer in rows]
        if isinstance(value, list):
            table |= {
                f"{name}[{k + 1}]": [place[k] for place in places if isinstance(place, list)]
                for k in range(len(value))
            }
        else:
            table[name] = [place for place in places if not isinstance(place, list)]
    return table | quantities([answer for _, answer in rows])


def quantities(answers: Sequence[Answer]) -> dict[str, list[float | str]]:
    """Deflections under their own loads and frequencies, a number for each answer."""
    table: dict[str, list[float | str]] = {}
    for k, name in enumerate(AXES[: len(answers[0].compliance)]):
        unit = "µrad at 100 N m" if name in ROTATIONS else "µm at 1000 N"
        scale = _LOADS[k] * _MICRO
        table[f"{name} ({unit})"] = [scale * float(one.compliance[k, k]) for one in answers]
    for k in range(max(len(one.frequencies) for one in answers)):
        table[f"f{k + 1} (Hz)"] = [_frequency(one, k) for one in answers]
    return table


def as_csv(found: VariedAnswers) -> str:
    """The table as CSV, all digits."""
    return csv_of(columns(found))


def as_text(found: VariedAnswers) -> str:
    """The table for people."""
    table = columns(found)
    cells = [[heading, *(_shown(value) for value in column)] for heading, column in table.items()]
    widths = [max(map(len, column)) for column in cells]
    first = found.solutions[0]
    lines = [f"{first.robot}, {first.model}, {len(found.values)} robots"]
    lines += [
        "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True))
        for row in zip(*cells, strict=True)
    ]
    return "\n".join(lines)


def as_json(found: VariedAnswers) -> str:
    """The answers as JSON (schema 1): those of `solve --json`, each with its values by key."""
    first = found.solutions[0]
    keys = [one.key for one in found.variations]
    document = {
        "schema": 1,
        "robot": first.robot,
        "model": first.model,
        "options": first.options,
        "vary": [{"key": one.key, "values": list(one.values)} for one in found.variations],
        "results": [
            {"vary": dict(zip(keys, values, strict=True)), **record_of(answer)}
            for values, solution in zip(found.values, found.solutions, strict=True)
            for answer in solution.answers
        ],
    }
    return json.dumps(document, allow_nan=False)


def _frequency(answer: Answer, place: int) -> float:
    return float(answer.frequencies[place]) if place < len(answer.frequencies) else np.nan


def _shown(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"
