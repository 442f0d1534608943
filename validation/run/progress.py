"""Progress of a run on stderr: what runs, how many are left, elapsed and expected time."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Group
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from lumped.text import counted
from validation.case import Case
from validation.console.progress import progress_shown
from validation.run.outcome import Record, Task

# Seconds over which the pace is measured: all of the run.
_ALL_OF_IT = 1e9
# The share of all work from which on its own speed says when the rest is done.
_WORTH_A_RATE = 0.1


class RunProgress:
    """A bar that grows by the tasks' efforts, as the expected time does, and what is running."""

    def __init__(self, tasks: Sequence[Task]) -> None:
        self._whole = Progress(
            BarColumn(24),
            TextColumn("{task.description}"),
            TimeElapsedColumn(),
            TextColumn("elapsed, about"),
            TimeRemainingColumn(),
            TextColumn("left"),
            speed_estimate_period=_ALL_OF_IT,
        )
        self._bar = self._whole.add_task("starting", total=sum(task.effort for task in tasks))
        self._running = Progress(
            TimeElapsedColumn(), TextColumn("{task.description}", style="dim", markup=False)
        )
        self._rows: dict[str, TaskID] = {}
        self._done, self._count, self._troubled = 0, len(tasks), 0

    def line(self, left: str = "") -> str:
        """What the bar says, in words: "12/243 done, 8 s elapsed, about 20 s left".

        Until a tenth is done, `left` is what the forecast says of it, if there is one.
        """
        (bar,) = self._whole.tasks
        elapsed, total = bar.elapsed or 0.0, bar.total or 0.0
        if bar.completed > (_WORTH_A_RATE * total if left else 0.0):
            left = f", about {elapsed * (total / bar.completed - 1.0):.0f} s left"
        troubled = f", {self._troubled} not in agreement" if self._troubled else ""
        return f"{self._done}/{self._count} done{troubled}, {elapsed:.0f} s elapsed{left}"

    def __rich__(self) -> Group:
        return Group(self._whole, self._running)

    def started(self, task: Task) -> None:
        """Show the task as running."""
        self._rows[task.id] = self._running.add_task(task.title)

    def finished(self, task: Task, record: Record) -> None:
        """Count the task as done."""
        self._running.remove_task(self._rows.pop(task.id))
        self._done += 1
        self._troubled += isinstance(task, Case) and record["verdict"] in {"disagree", "failed"}
        wrong = f", [bold red]{self._troubled} not in agreement[/]" if self._troubled else ""
        said = f"{self._done}/{self._count} done{wrong},"
        self._whole.update(self._bar, advance=task.effort, description=said)


@contextmanager
def showing(tasks: Sequence[Task], seconds: float) -> Iterator[RunProgress]:
    """The progress of the tasks on stderr while the context lasts; `seconds` as of `stage`."""
    progress = RunProgress(tasks)
    doing = counted(len(tasks), "comparison or figure", "comparisons, figures and verdicts")
    with progress_shown(doing, seconds, progress.line, progress):
        yield progress
