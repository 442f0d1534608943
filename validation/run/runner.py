"""Computation of cases and figures in worker processes, with each result stored on arrival.

Input: a catalogue of tasks and the context of a run. Output: records, passed to `keep`. Rule: tasks
of one group share expensive results and run in one process, one after the other. All computing
takes place in worker processes, even with one job: numbers then do not depend on the number of
jobs, a crash of a library ends a case and not the run, and Ctrl-C does not wait for a
factorisation. Output of the computations goes to the log of the run, never to the terminal.
"""

import signal
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from time import perf_counter
from types import FrameType
from typing import TYPE_CHECKING, Literal, TypeAlias

from fem.machine import search_cycles_rarely
from lumped.errors import InputError
from lumped.text import did_you_mean
from validation.case import OUT_OF_MEMORY, Case, Skip, failure_reason
from validation.context import Context, Preset
from validation.drawing.text import function_name
from validation.record_fields import plain_data
from validation.run.executor import OutOfMemoryCrash, on_cores
from validation.run.outcome import (
    AnyResult,
    Record,
    Result,
    Task,
    judge,
    outcome_of,
)
from validation.run.provisions import Provisions
from validation.studies_and_figures import PlannedFigure
from validation.verdicts import Assessment

if TYPE_CHECKING:
    # For annotations only: processes that compute do without rich, and few runs need Dask.
    from validation.run.cluster import Cluster
    from validation.run.progress import RunProgress

# Module-level function that lists the cases and figures for a robot file. It must be fast and
# return the same list in every process.
Catalogue: TypeAlias = Callable[..., Sequence[Task]]


def select(
    tasks: Sequence[Task], preset: Preset, pattern: str | None = None, always: Collection[str] = ()
) -> list[Task]:
    """Tasks of the preset whose id matches a shell-style pattern, with brackets taken literally.

    All tasks of the preset if `pattern` is None. Tasks of the preset with ids in `always` are
    added. Raises InputError if no matching task is a comparison or an assessment.
    """
    if len({task.id for task in tasks}) < len(tasks):
        raise ValueError("two cases or figures have the same id")
    in_preset = [task for task in tasks if preset in task.presets]
    if pattern is None:
        return in_preset
    # Ids contain parameters in brackets, which would be read as character classes.
    literal = pattern.replace("[", "[[]")
    selected = {task.id for task in in_preset if fnmatchcase(task.id, literal)}
    if not selected:
        elsewhere = any(fnmatchcase(task.id, literal) for task in tasks)
        ids, listed = [task.id for task in in_preset], "; 'flexproof cases' lists them"
        near = did_you_mean(pattern.strip("*?"), ids, listed, cutoff=0.5)
        hint = "; only in other presets" if elsewhere else near
        raise InputError(f'--only: no case of preset {preset} matches "{pattern}"{hint}')
    if all(isinstance(task, PlannedFigure) for task in in_preset if task.id in selected):
        raise InputError(
            f'--only: "{pattern}" matches figures alone, and nothing would be compared; must match '
            "a case ('flexproof cases' lists them) or adequacy"
        )
    return [task for task in in_preset if task.id in selected.union(always)]


def run(
    catalogue: Catalogue,
    context: Context,
    tasks: Sequence[Task],
    *,
    jobs: int,
    log: Path,
    cluster: "Cluster | None" = None,
    sent: Provisions | None = None,
    keep: Callable[[Record], None],
    progress: "RunProgress",
) -> None:
    """Compute `tasks` with `jobs` processes, or on the `cluster` if it is not None.

    `catalogue`: function that lists all tasks, called in each process. `log`: file for the output
    of the processes. `sent`: files and cache entries that workers of the cluster need. `keep` is
    called with each record on arrival; an exception in it ends the run. SIGINT, SIGTERM and SIGHUP
    end the run within a second. Raises ComputationError if workers cannot start, or if the cluster
    is lost.
    """
    by_id = {task.id: task for task in tasks}
    groups = [[(name, partial(_compute, name)) for name in group] for group in _groups(tasks)]
    begin = partial(_begin, catalogue, context, sent)
    with (
        _interruptible() as interrupted,
        nullcontext(cluster.beginning(log, begin))
        if cluster
        else on_cores(jobs, log, begin) as workers,
        closing(
            workers.answers(groups, lambda name: progress.started(by_id[name]), interrupted)
        ) as answers,
    ):
        for name, answer in answers:
            record = _failed(by_id[name], answer) if isinstance(answer, Exception) else answer
            keep(record)
            progress.finished(by_id[name], record)


def _failed(task: Task, error: Exception) -> Record:
    """Record of a task whose process ended unexpectedly."""
    out_of_memory = isinstance(error, OutOfMemoryCrash)
    advice = f"; {OUT_OF_MEMORY}" if out_of_memory else " (log.txt may have details)"
    record: Record = plain_data(_without_numbers(task, "failed", 0.0, f"{error}{advice}"))
    return record


def _without_numbers(
    task: Task, task_verdict: Literal["failed", "skipped"], seconds: float, message: str
) -> AnyResult:
    """Result of a failed or skipped task: no content, and the reason in `message`."""
    if isinstance(task, Case):
        return outcome_of(task, task_verdict, seconds, message)
    return Result(task.id, task_verdict, seconds, message)


def _groups(tasks: Sequence[Task]) -> list[list[str]]:
    """Ids of tasks, grouped by process. Groups with assessments of models come first.

    The other groups follow by decreasing effort: short groups at the end balance the load of the
    processes.
    """
    groups: dict[str, list[Task]] = {}
    for task in sorted(tasks, key=lambda task: not isinstance(task, Assessment)):
        groups.setdefault(task.group or task.id, []).append(task)

    def order(group: Sequence[Task]) -> tuple[bool, float]:
        return not isinstance(group[0], Assessment), -sum(task.effort for task in group)

    return [[task.id for task in group] for group in sorted(groups.values(), key=order)]


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """Context in which SIGINT, SIGTERM and SIGHUP set a flag, so that no file is half-written.

    Yields a function that returns the flag. SIGHUP remains ignored if it was ignored before, as
    under nohup.
    """
    received: list[int] = []

    def record(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    signals = [signal.SIGINT, signal.SIGTERM]
    hang_up = getattr(signal, "SIGHUP", None)
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:
        signals.append(hang_up)
    handlers = {number: signal.signal(number, record) for number in signals}
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


@dataclass(frozen=True)
class _Assigned:
    """Tasks of a run by id, and their context, set up once in each process."""

    tasks: Mapping[str, Task]
    context: Context


def _begin(catalogue: Catalogue, context: Context, sent: Provisions | None) -> _Assigned:
    search_cycles_rarely()
    if sent is not None:
        context = replace(context, robot_file=sent.unpack(context.robot_file))
    return _Assigned({task.id: task for task in catalogue(context.robot_file)}, context)


def _compute(identifier: str, assigned: _Assigned) -> Record:
    record: Record = plain_data(execute(assigned.tasks[identifier], assigned.context))
    return record


def execute(task: Task, context: Context) -> AnyResult:
    """Result of a task.

    An error in the task gives the verdict "failed", `Skip` the verdict "skipped". The traceback of
    an error goes to stderr.
    """
    start = perf_counter()
    try:
        match task:
            case Case():
                measurement = task.measure(context)
                return judge(task, measurement, perf_counter() - start)
            case PlannedFigure():
                figure = task.draw(context)
                named_figure = replace(figure, computed_by=(function_name(task.draw),))
                return Result(
                    task.id, "made", perf_counter() - start, named_figure.left_out, named_figure
                )
            case Assessment():
                matrix = task.compute(context)
                return Result(task.id, "made", perf_counter() - start, found=matrix)
    except Skip as reason:
        return _without_numbers(task, "skipped", perf_counter() - start, str(reason))
    except Exception as error:  # noqa: BLE001  whatever happens in a task is its verdict
        message = failure_reason(task.id, error)
        return _without_numbers(task, "failed", perf_counter() - start, message)
