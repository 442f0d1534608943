"""`solve --vary`: one model of several robots that differ in some numbers of their file.

Input: a request and texts such as "KEY=FROM:TO:COUNT". Output: a table, JSON, CSV or a picture of
deflections and frequencies for each robot.
"""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.errors import InputError, naming
from lumped.robot_file import RobotFile
from lumped.robot_file.places import unit_of
from lumped.robot_file.variation import Variation, assignments, variations_of, varied
from lumped.text import aligned, counted
from validation.console.progress import stage
from validation.console.streams import write_message, write_messages, write_results
from validation.console.typed import write
from validation.drawing.style import OTHERS, csv_of
from validation.record_fields import plain_data
from validation.run.cluster import on_cluster
from validation.run.executor import Executor, in_order, in_turn, on_cores
from validation.run.provisions import Provisions, provisions
from validation.solve.answer import Answer, Solution
from validation.solve.answer_json import answer_record, finite_json
from validation.solve.design_choice import (
    DesignChoice,
    DesignKind,
    Purpose,
    choice_record,
    choice_text,
    design_choice,
    purpose_of,
)
from validation.solve.model_answers import checked, solve
from validation.solve.question import Question

if TYPE_CHECKING:
    from validation.drawing.chart import Panel

# Loads of the listed deflections: forces (N) for µm, moments (N m) for µrad.
_LOADS = 3 * (1000.0,) + 3 * (100.0,)
_MICRO = 1e6
# Resolution of a picture (dots per inch), and largest number of distinguishable curves.
_DOTS, _LARGEST_CURVE_COUNT = 150, len(OTHERS)
# Number of panels side by side.
_COLUMNS = 3
# Number of varied parameters of a map, and the smallest number of values of each.
_MAP_NUMBERS, _FEWEST_FOR_MAP = 2, 3


@dataclass(frozen=True)
class VariedAnswers:
    """Answers for all combinations of the values of `variations`.

    `values`: combination for each robot, in the order of `solutions`. `choice`: the best robot for
    a purpose. None if there is no purpose.
    """

    variations: tuple[Variation, ...]
    values: tuple[tuple[float, ...], ...]
    solutions: tuple[Solution, ...]
    choice: DesignChoice | None = None

    @property
    def names(self) -> list[str]:
        """Text for each robot with the keys and values of its varied parameters."""
        return [assignments(self.variations, values) for values in self.values]

    @property
    def rows(self) -> list[tuple[tuple[float, ...], Answer]]:
        """Pairs (values of the varied parameters, answer for the robot with these values)."""
        return [
            (values, answer)
            for values, solution in zip(self.values, self.solutions, strict=True)
            for answer in solution.answers
        ]


@dataclass(frozen=True)
class _Unit:
    """Request for one robot: plain data that can be sent to other processes and machines."""

    values_text: str
    question: Question
    sent: Provisions | None = None

    def __call__(self) -> Solution:
        with naming(f"--vary {self.values_text}"):
            return solve_sent(self.question, self.sent)


def solve_sent(question: Question, sent: Provisions | None) -> Solution:
    """Solution of a question, with the files of its CAD parts from `sent` unless that is None."""
    if sent is not None:
        question = replace(question, robot_file=sent.unpack(question.robot_file))
    return solve(question)


def solve_on_cluster(question: Question, cluster: str) -> Solution:
    """Solution of a question by one worker of a cluster."""
    sent = provisions(question.robot_file)
    with on_cluster(cluster, write_message) as executor:
        (solution,) = in_order(executor, [partial(solve_sent, question, sent)])
    return solution


def write_varied(
    question: Question,
    vary: Sequence[str],
    jobs: int,
    cluster: str | None,
    csv: Path | None,
    picture: Path | None,
    *,
    json: bool,
    minimise: str | None = None,
    maximise: str | None = None,
    where: Sequence[str] = (),
) -> bool:
    """Print the answers for all varied robots as text or JSON, and write the requested files.

    The result is False if there are conditions (`where`) that no robot meets. Raises the exceptions
    of `solve_varied`.
    """
    if question.against:
        raise InputError(
            "--against: not with --vary, because modes are paired for one robot; leave one "
            "of them out"
        )
    if question.free:
        raise InputError("--ends free-free: not with --vary; leave one of them out")
    if not vary:
        raise InputError(
            "--jobs, --csv, --picture, --minimise, --maximise and --where are only for --vary; "
            "leave them out"
        )
    variations = variations_of(question.robot_file, vary)
    purpose = None
    if minimise or maximise or where:
        if question.alone:
            raise InputError(
                "--minimise, --maximise, --where: need the whole robot; leave out the body"
            )
        purpose = purpose_of(question.robot_file, minimise, maximise, where, question.count)
    places = max(1, len(question.x) + len(question.poses))
    if picture is not None and not _is_map(variations, places):
        require_few_curves(variations, places)
    answers = solve_varied(question, variations, jobs, cluster, purpose)
    write_results(as_json(answers) if json else as_text(answers))
    write_messages(numbers_without_effect(answers), 0)
    if csv is not None:
        write(csv, csv_of(columns(answers)).encode(), ".csv")
    if picture is not None:
        write(picture, png(question.robot_file, answers), ".png")
    choice = answers.choice
    return not (choice and choice.purpose.conditions) or bool(choice.meets.any())


def solve_varied(
    question: Question,
    variations: tuple[Variation, ...],
    jobs: int,
    cluster: str | None,
    purpose: Purpose | None = None,
) -> VariedAnswers:
    """Answers for each robot of the variations, by `jobs` processes or on a `cluster`.

    If there is a `purpose`, the best of the robots is chosen. Raises InputError, which names the
    values, before any computation if a robot is invalid or cannot reach a requested pose. Raises
    ComputationError if a robot cannot be solved.
    """
    robots = varied(question.robot_file, variations)
    units, seconds = [], 0.0
    for values, robot in robots:
        text = assignments(variations, values)
        # The effect of printed digits is not computed: tables of many robots have no room for it.
        question_of_robot = replace(question, robot_file=robot, digits=False)
        with naming(f"--vary {text}"):
            seconds += checked(question_of_robot).seconds
        sent = None if cluster is None else provisions(robot)
        units.append(_Unit(text, question_of_robot, sent))
    with ExitStack() as stack, stage(counted(len(units), "robot"), seconds / jobs):
        executor: Executor = in_turn
        if cluster is not None:
            executor = stack.enter_context(on_cluster(cluster, write_message))
        elif jobs > 1:
            executor = stack.enter_context(on_cores(jobs))
        solutions = tuple(in_order(executor, units))
    choice = None
    if purpose:
        mechanisms = [robot.mechanism for _, robot in robots]
        choice = design_choice(purpose, mechanisms, [solution.answers for solution in solutions])
    return VariedAnswers(variations, tuple(values for values, _ in robots), solutions, choice)


def numbers_without_effect(answers: VariedAnswers) -> list[str]:
    """Lines on varied parameters that change no displacement, frequency or receptance."""
    lines = []
    for index, variation in enumerate(answers.variations):
        # Results of the robots that differ in this parameter alone, by their other parameters.
        results_by_others: dict[tuple[float, ...], set[bytes]] = {}
        for values, solution in zip(answers.values, answers.solutions, strict=True):
            numbers = b"".join(map(_numbers, solution.answers))
            other_values = values[:index] + values[index + 1 :]
            results_by_others.setdefault(other_values, set()).add(numbers)
        if len(variation.values) > 1 and all(
            len(results) == 1 for results in results_by_others.values()
        ):
            model = answers.solutions[0].model
            lines.append(
                f"--vary {variation.key}: has no effect on model {model}; choose another key "
                "or --model"
            )
    return lines


def _numbers(answer: Answer) -> bytes:
    """Bytes of the displacements, frequencies and receptances of an answer, for comparisons."""
    arrays = (
        answer.compliance,
        answer.frequencies,
        *answer.loads.values(),
        *(answer.damped or ()),
        *(response.receptance for response in answer.responses),
    )
    return b"".join(array.tobytes() for array in arrays)


def columns(answers: VariedAnswers) -> dict[str, list[float | str]]:
    """Columns of the table, one row for each robot and posture.

    The columns are the varied parameters, pose, deflections and frequencies. If there is a purpose,
    its other quantities are added: mass, and displacements under loads in the worst pose of the
    robot. If there are conditions, a last column contains "yes" for a robot that meets all of them,
    otherwise "no".
    """
    rows = answers.rows
    table: dict[str, list[float | str]] = {
        variation.key: [values[index] for values, _ in rows]
        for index, variation in enumerate(answers.variations)
    }
    places = [plain_data(answer.place) for _, answer in rows]
    for name, value in places[0].items():
        if name == "pose":
            table |= {
                f"pose[{k + 1}]": [row["pose"][k] for row in places] for k in range(len(value))
            }
        else:
            table[name] = [row[name] for row in places]
    table |= quantities([answer for _, answer in rows])
    if (choice := answers.choice) is None:
        return table
    robots = [row for row, solution in enumerate(answers.solutions) for _ in solution.answers]
    for quantity, values in choice.values.items():
        if quantity.kind in {DesignKind.MASS, DesignKind.LOAD}:
            table[f"{quantity.name} ({quantity.unit})"] = [float(values[row]) for row in robots]
    if choice.purpose.conditions:
        table["meets all"] = ["yes" if choice.meets[row] else "no" for row in robots]
    return table


def quantities(answers: Sequence[Answer]) -> dict[str, list[float | str]]:
    """Columns of deflections along unit loads and of frequencies, one number for each answer."""
    table: dict[str, list[float | str]] = {}
    for k, name in enumerate(AXES[: len(answers[0].compliance)]):
        unit = "µrad at 100 N m" if name in ROTATIONS else "µm at 1000 N"
        scale = _LOADS[k] * _MICRO
        table[f"{name} ({unit})"] = [scale * float(answer.compliance[k, k]) for answer in answers]
    columns = zip_longest(*(answer.frequencies.tolist() for answer in answers), fillvalue=np.nan)
    return table | {f"f{k} (Hz)": list(column) for k, column in enumerate(columns, start=1)}


def as_text(answers: VariedAnswers) -> str:
    """Table of all answers as text."""
    numbers, first = columns(answers), answers.solutions[0]
    texts = [
        [value if isinstance(value, str) else f"{value:.6g}" for value in column]
        for column in numbers.values()
    ]
    head = f"{first.robot}, {first.model}, {counted(len(answers.values), 'robot')}"
    rows = list(zip(*texts, strict=True))
    text = f"{head}\n{aligned(list(numbers), rows, indent='')}"
    return f"{text}\n{choice_text(answers.choice, answers.names)}" if answers.choice else text


def as_json(answers: VariedAnswers) -> str:
    """Answers as JSON (schema 1): those of `solve --json`, each with its parameters by key."""
    first = answers.solutions[0]
    keys = [variation.key for variation in answers.variations]
    document = {
        "schema": 1,
        "robot": first.robot,
        "model": first.model,
        "options": first.options,
        "vary": [
            {"key": variation.key, "values": list(variation.values)}
            for variation in answers.variations
        ],
        "results": [
            {"vary": dict(zip(keys, values, strict=True)), **plain_data(answer_record(answer))}
            for values, answer in answers.rows
        ],
    }
    if answers.choice:
        values = [dict(zip(keys, of_robot, strict=True)) for of_robot in answers.values]
        document["choice"] = choice_record(answers.choice, values)
    return finite_json(document)


def require_few_curves(variations: Sequence[Variation], places: int) -> None:
    """Raise InputError if the curves of all robots in `places` poses outnumber the line styles."""
    count = places * prod(len(variation.values) for variation in variations[1:])
    if count > _LARGEST_CURVE_COUNT:
        raise InputError(
            f"--picture: {count} curves over {variations[0].key}, at most "
            f"{_LARGEST_CURVE_COUNT} can be drawn; vary other parameters over fewer "
            "values, or give fewer poses"
        )


def png(robot_file: RobotFile, answers: VariedAnswers) -> bytes:
    """PNG of deflections and frequencies over the varied parameters, one panel each.

    If two parameters with several values each are varied in one pose, panels are maps. Otherwise
    they have curves over the first parameter, one for each combination of the other parameters and
    poses.
    """
    # Imported here: only a picture needs the plotting library.
    from validation.drawing.chart import Chart, few_ticks  # noqa: PLC0415
    from validation.drawing.plot import chart_png  # noqa: PLC0415

    labels = [
        f"{variation.key} ({unit})"
        if (unit := unit_of(robot_file.tables, variation.keys[0]))
        else variation.key
        for variation in answers.variations
    ]
    several = len(answers.solutions[0].answers) > 1
    if _is_map(answers.variations, len(answers.solutions[0].answers)):
        panels = _maps(answers, labels[1])
    else:
        panels = _curves(answers, several=several)
    return chart_png(Chart(panels, labels[0], min(_COLUMNS, len(panels)), x_scale=few_ticks), _DOTS)


def _is_map(variations: Sequence[Variation], places: int) -> bool:
    """True if two parameters have enough values for a map and there is one pose."""
    enough = [len(variation.values) >= _FEWEST_FOR_MAP for variation in variations]
    return places == 1 and len(enough) == _MAP_NUMBERS and all(enough)


def _maps(answers: VariedAnswers, y_label: str) -> list["Panel"]:
    """Maps over two varied parameters of all columns of the table of answers.

    If an objective or conditions are given, there are maps of their quantities alone. A star marks
    the best robot. The map of the objective is blank for robots that miss a condition.
    """
    from validation.drawing.chart import Contours, Panel  # noqa: PLC0415

    x, y = (np.array(variation.values) for variation in answers.variations)
    star = None
    if choice := answers.choice:
        maps = {
            f"{quantity.name} ({quantity.unit})": values
            for quantity, values in choice.values.items()
        }
        if (objective := choice.purpose.objective) and choice.purpose.conditions:
            heading = f"{objective.name} ({objective.unit})"
            only = {
                f"{heading}\nwhere all conditions are met": np.where(
                    choice.meets, maps.pop(heading), np.nan
                )
            }
            maps = only | maps
        if choice.best is not None:
            first, second = answers.values[choice.best]
            star = float(first), float(second)
    else:
        table = quantities([answer for _, answer in answers.rows])
        maps = {heading: np.array(numbers, dtype=float) for heading, numbers in table.items()}
    panels: list[Panel] = []
    for heading, numbers in maps.items():
        if not np.isfinite(numbers).any():
            continue
        span = float(np.nanmin(numbers)), float(np.nanmax(numbers))
        contours = Contours(x, y, numbers.reshape(len(x), len(y)), span, star, "best robot")
        label = "" if len(panels) % _COLUMNS else y_label
        panels.append(Panel(title=heading, y_label=label, contours=contours))
    return panels


def _curves(answers: VariedAnswers, *, several: bool) -> list["Panel"]:
    """Panels of curves over the first varied parameter. `several`: labels contain the pose."""
    from validation.drawing.chart import Panel, Series, from_zero  # noqa: PLC0415

    first, *other_variations = answers.variations
    names = [
        _curve(other_variations, values[1:], answer if several else None)
        or answers.solutions[0].model
        for values, answer in answers.rows
    ]
    rows_by_name = {
        name: [row for row, other_name in enumerate(names) if other_name == name] for name in names
    }
    x = np.array(first.values)
    return [
        Panel(
            [Series(name, x, np.array(numbers)[places]) for name, places in rows_by_name.items()],
            heading,
            scale=from_zero,
        )
        for heading, numbers in quantities([answer for _, answer in answers.rows]).items()
    ]


def _curve(variations: Sequence[Variation], values: Sequence[float], answer: Answer | None) -> str:
    """Label of a curve: values of all varied parameters except the first, and the pose of `answer`.

    Without the pose if `answer` is None.
    """
    texts = [assignments(variations, values)] if variations else []
    if answer is not None:
        name = "x" if answer.place.pose is None else "pose"
        numbers = answer.place.coordinates
        texts.append(f"{name} {', '.join(f'{value:.4g}' for value in numbers)}")
    return "; ".join(texts)
