"""A worker process: computes one case or figure after the other and sends back plain data.

Whatever the computations print goes to the run's log, never to the terminal. Ctrl-C does not
reach a worker (its parent ends it); it ends by itself when its parent is gone.
"""

import faulthandler
import os
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter

from lumped.errors import ComputationError, InputError
from lumped.robot_file import RobotFile
from validation.adequacy.assessment import Assessed, Assessment
from validation.case import Case, Outcome, Skip, judge
from validation.context import Context, Preset
from validation.drawing.text import function_name
from validation.exhibits import Drawing
from validation.results.records import (
    Drawn,
    Record,
    Task,
    assessed_to_record,
    drawn_to_record,
    outcome_to_record,
)
from validation.sweeps.processes import end_with_parent

# What helps where memory ran out.
REMEDY = "choose a smaller preset or fewer --jobs"


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


def serve(connection: Connection, job: Job, log: Path) -> None:
    """Work through the lists of ids that arrive, until None does.

    Sends ("started", (id, size of the log so far in bytes)) and ("finished", record) for each.
    """
    _print_to(log)
    end_with_parent()
    tasks = {task.id: task for task in job.catalogue(job.robot_file)}
    context = Context(job.robot_file, job.preset, job.options)
    with suppress(EOFError, BrokenPipeError):
        while (identifiers := connection.recv()) is not None:
            for identifier in identifiers:
                # Here, not where it is read: what the task prints may be there before.
                connection.send(("started", (identifier, os.fstat(1).st_size)))
                connection.send(("finished", execute(tasks[identifier], context)))


def execute(task: Task, context: Context) -> Record:
    """The record of one case or figure; errors become verdicts, tracebacks go to stderr."""
    if isinstance(task, Drawing):
        return drawn_to_record(_draw(task, context))
    if isinstance(task, Assessment):
        return assessed_to_record(_assess(task, context))
    return outcome_to_record(_compute(task, context))


def _compute(case: Case, context: Context) -> Outcome:
    start = perf_counter()
    try:
        measurement = case.measure(context)
        return judge(case, measurement, perf_counter() - start)
    except Skip as reason:
        return Outcome(case, "skipped", perf_counter() - start, message=str(reason))
    except Exception as error:  # noqa: BLE001  whatever happens in a case is its verdict
        return Outcome(case, "failed", perf_counter() - start, message=_explain(case.id, error))


def _draw(drawing: Drawing, context: Context) -> Drawn:
    start = perf_counter()
    try:
        drawn = drawing.draw(context.about(drawing.subject))
        figure = replace(drawn, computed_by=(function_name(drawing.draw),))
        return Drawn(drawing, perf_counter() - start, figure, figure.left_out)
    except Skip as reason:
        return Drawn(drawing, perf_counter() - start, message=str(reason))
    except Exception as error:  # noqa: BLE001  the report says which figure is missing and why
        return Drawn(
            drawing, perf_counter() - start, message=_explain(drawing.id, error), failed=True
        )


def _assess(assessment: Assessment, context: Context) -> Assessed:
    start = perf_counter()
    try:
        matrix = assessment.compute(context)
        return Assessed(assessment, perf_counter() - start, matrix)
    except Skip as reason:
        return Assessed(assessment, perf_counter() - start, message=str(reason))
    except Exception as error:  # noqa: BLE001  the report says why there is no matrix
        message = _explain(assessment.id, error)
        return Assessed(assessment, perf_counter() - start, message=message, failed=True)


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


def _print_to(log: Path) -> None:
    descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    for stream in (1, 2):
        os.dup2(descriptor, stream)
    faulthandler.enable()
