"""Runs cases and figures in processes of their own and keeps each result as it arrives.

The unit of work is a group: tasks that share expensive results run in one process, one after the
other. Computing happens there only, even with one job: the numbers are then the same whatever the
number of jobs, a crash of a library ends a case and not the run, and Ctrl-C does not have to wait
for a factorisation. Whatever the computations print goes to the run's log, never to the terminal.
"""

import signal
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from time import perf_counter
from types import FrameType
from typing import TYPE_CHECKING, TypeAlias

from lumped.errors import InputError
from lumped.text import did_you_mean
from validation.case import OUT_OF_MEMORY, Case, Skip, failure_reason
from validation.context import Context, Preset
from validation.drawing.text import function_name
from validation.run.executor import OutOfMemoryCrash, on_cores
from validation.run.outcome import AnyResult, Record, Result, Task, judge, plain
from validation.studies_and_figures import PlannedFigure
from validation.verdicts import Assessment

if TYPE_CHECKING:
    # Rich, which processes that compute do without.
    from validation.run.progress import RunProgress

# A function at the top of a module that lists the cases and figures for a robot file; it must be
# quick and give the same list in every process.
Catalogue: TypeAlias = Callable[..., Sequence[Task]]


def select(
    tasks: Sequence[Task], preset: Preset, pattern: str | None = None, always: Collection[str] = ()
) -> list[Task]:
    """Tasks of the preset whose id matches the shell-style pattern (brackets taken literally).

    Those whose ids are in `always` are taken, too.

    Raises InputError where nothing matches that compares anything.
    """
    if len({task.id for task in tasks}) < len(tasks):
        raise ValueError("two cases or figures have the same id")
    in_preset = [task for task in tasks if preset in task.presets]
    if pattern is None:
        return in_preset
    # Ids carry parameters in brackets; as character classes they would never match themselves.
    literal = pattern.replace("[", "[[]")
    chosen = {task.id for task in in_preset if fnmatchcase(task.id, literal)}
    if not chosen:
        elsewhere = any(fnmatchcase(task.id, literal) for task in tasks)
        ids, listed = [task.id for task in in_preset], "; 'flexproof cases' lists them"
        near = did_you_mean(pattern.strip("*?"), ids, listed, cutoff=0.5)
        hint = "; only in other presets" if elsewhere else near
        raise InputError(f'--only: no case of preset {preset} matches "{pattern}"{hint}')
    if all(isinstance(task, PlannedFigure) for task in in_preset if task.id in chosen):
        raise InputError(
            f'--only: "{pattern}" matches figures alone, and nothing would be compared; must match '
            "a case ('flexproof cases' lists them) or adequacy"
        )
    return [task for task in in_preset if task.id in chosen.union(always)]


def run(
    catalogue: Catalogue,
    context: Context,
    tasks: Sequence[Task],
    *,
    jobs: int,
    log: Path,
    keep: Callable[[Record], None],
    progress: "RunProgress",
) -> None:
    """Compute the tasks, some of the catalogue's, with `jobs` processes.

    `keep` gets each record as it arrives; what it raises ends the run. SIGINT, SIGTERM and SIGHUP
    end it within a second. Raises ComputationError where workers cannot even start.
    """
    by_id = {task.id: task for task in tasks}
    groups = [[(name, partial(_compute, name)) for name in group] for group in _groups(tasks)]
    with (
        _interruptible() as interrupted,
        on_cores(jobs, log, partial(_begin, catalogue, context)) as cores,
        closing(
            cores.answers(groups, lambda name: progress.started(by_id[name]), interrupted)
        ) as answers,
    ):
        for name, answer in answers:
            record = _failed(name, answer) if isinstance(answer, Exception) else answer
            keep(record)
            progress.finished(by_id[name], record)


def _failed(name: str, error: Exception) -> Record:
    """The record of a task whose process ended."""
    starved = isinstance(error, OutOfMemoryCrash)
    more = f"; {OUT_OF_MEMORY}" if starved else " (log.txt may say more)"
    return plain(Result(name, "failed", 0.0, f"{error}{more}"))


def _groups(tasks: Sequence[Task]) -> list[list[str]]:
    """Ids that belong together: first what answers whether the models suffice, then the longest.

    What is short fills the gaps at the end.
    """
    groups: dict[str, list[Task]] = {}
    for task in sorted(tasks, key=lambda task: not isinstance(task, Assessment)):
        groups.setdefault(task.group or task.id, []).append(task)

    def place(group: Sequence[Task]) -> tuple[bool, float]:
        return not isinstance(group[0], Assessment), -sum(task.effort for task in group)

    return [[task.id for task in group] for group in sorted(groups.values(), key=place)]


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """SIGINT, SIGTERM and SIGHUP only raise a flag, so that no file is left half-written.

    A hang-up that is ignored, under nohup, stays ignored.
    """
    received: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    heeded = [signal.SIGINT, signal.SIGTERM]
    hang_up = getattr(signal, "SIGHUP", None)
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:
        heeded.append(hang_up)
    former = {number: signal.signal(number, note) for number in heeded}
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)


@dataclass(frozen=True)
class _Assigned:
    """Tasks of a run by id, and their context: computed once in each process of the run."""

    tasks: Mapping[str, Task]
    context: Context


def _begin(catalogue: Catalogue, context: Context) -> _Assigned:
    return _Assigned({task.id: task for task in catalogue(context.robot_file)}, context)


def _compute(identifier: str, assigned: _Assigned) -> Record:
    return plain(execute(assigned.tasks[identifier], assigned.context))


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
        return Result(task.id, "failed", perf_counter() - start, failure_reason(task.id, error))
