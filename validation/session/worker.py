"""In a process of a run: one case or figure after the other becomes plain data.

Whatever the computations print goes to the run's log, never to the terminal.
"""

import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from time import perf_counter

from lumped.errors import ComputationError, InputError
from lumped.robot_file import RobotFile
from validation.adequacy.matrix import Assessment
from validation.case import Case, Skip
from validation.context import Context, Preset
from validation.drawing.text import function_name
from validation.exhibits import PlannedFigure
from validation.results.outcome import Result, judge
from validation.results.tasks import AnyResult, Record, Task, plain

# What helps where memory ran out.
REMEDY = "choose a smaller preset or fewer --jobs"
# The tasks and the context of the job that this process has begun.
_AT_WORK: list[tuple[Mapping[str, Task], Context]] = []


@dataclass(frozen=True)
class Job:
    """What is to be run, as it is sent to workers.

    `catalogue` (a function at the top of a module) lists the cases and figures for a robot; it
    must be quick and give the same list in every process.
    """

    catalogue: Callable[[RobotFile], Sequence[Task]]
    robot_file: RobotFile
    preset: Preset = "standard"
    options: Mapping[str, str] = field(default_factory=dict)


def begin(job: Job) -> None:
    """Get ready, as a process of a run, to compute its tasks."""
    tasks = {task.id: task for task in job.catalogue(job.robot_file)}
    _AT_WORK.append((tasks, Context(job.robot_file, job.preset, job.options)))


def compute(identifier: str) -> Record:
    """The record of a task of the job that was begun."""
    tasks, context = _AT_WORK[-1]
    return plain(execute(tasks[identifier], context))


def execute(task: Task, context: Context) -> AnyResult:
    """The result of a task; errors become verdicts, tracebacks go to stderr."""
    start = perf_counter()
    try:
        match task:
            case Case():
                measured = task.measure(context)
                return judge(task, measured, perf_counter() - start).result
            case PlannedFigure():
                drawn = task.draw(context)
                figure = replace(drawn, computed_by=(function_name(task.draw),))
                return Result(task.id, "made", perf_counter() - start, figure.left_out, figure)
            case Assessment():
                matrix = task.compute(context)
                return Result(task.id, "made", perf_counter() - start, found=matrix)
    except Skip as reason:
        return Result(task.id, "skipped", perf_counter() - start, str(reason))
    except Exception as error:  # noqa: BLE001  whatever happens in a task is its verdict
        return Result(task.id, "failed", perf_counter() - start, _explain(task.id, error))


def _explain(identifier: str, error: Exception) -> str:
    if isinstance(error, ComputationError | InputError):
        message = str(error)
    elif isinstance(error, MemoryError):
        message = f"ran out of memory; {REMEDY}"
    else:
        message = f"{type(error).__name__}: {error} (traceback in log.txt)"
    # A disk that is too full for the log must not take the case with it.
    with suppress(OSError):
        sys.stderr.write(f"\n== {identifier}: {message}\n")
        traceback.print_exception(error)
        sys.stderr.flush()
    return " ".join(message.split())
