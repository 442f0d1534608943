"""Progress of a run on stderr: running and remaining tasks, elapsed and expected time.

Input: tasks with their efforts. Output: a bar on a terminal, otherwise lines.
"""

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

# Time (s) over which the speed is averaged: the whole run.
_WHOLE_RUN = 1e9
# Fraction of the effort from which on the measured speed replaces the forecast.
_RATE_SHARE = 0.1


class RunProgress:
    """Progress of a run: bar in proportion to the effort of finished tasks, and running tasks."""

    def __init__(self, tasks: Sequence[Task]) -> None:
        self._whole = Progress(
            BarColumn(24),
            TextColumn("{task.description}"),
            TimeElapsedColumn(),
            TextColumn("elapsed, about"),
            TimeRemainingColumn(),
            TextColumn("left"),
            speed_estimate_period=_WHOLE_RUN,
        )
        self._bar = self._whole.add_task("starting", total=sum(task.effort for task in tasks))
        self._running = Progress(
            TimeElapsedColumn(), TextColumn("{task.description}", style="dim", markup=False)
        )
        self._rows: dict[str, TaskID] = {}
        self._done, self._count, self._troubled = 0, len(tasks), 0

    def line(self, forecast: str = "") -> str:
        """State as text: "12/243 done, 8 s elapsed, about 20 s left".

        `forecast`: text on the remaining time, used until a tenth of the effort is done. If it is
        "", the measured speed is used from the start.
        """
        (bar,) = self._whole.tasks
        elapsed, total = bar.elapsed or 0.0, bar.total or 0.0
        if bar.completed > (_RATE_SHARE * total if forecast else 0.0):
            forecast = f", about {elapsed * (total / bar.completed - 1.0):.0f} s left"
        troubled = f", {self._troubled} not in agreement" if self._troubled else ""
        return f"{self._done}/{self._count} done{troubled}, {elapsed:.0f} s elapsed{forecast}"

    def __rich__(self) -> Group:
        return Group(self._whole, self._running)

    def started(self, task: Task) -> None:
        """Display the task as running."""
        self._rows[task.id] = self._running.add_task(task.title)

    def finished(self, task: Task, record: Record) -> None:
        """Count the task as done."""
        self._running.remove_task(self._rows.pop(task.id))
        self._done += 1
        self._troubled += isinstance(task, Case) and record["verdict"] in {"disagree", "failed"}
        wrong = f", [bold red]{self._troubled} not in agreement[/]" if self._troubled else ""
        text = f"{self._done}/{self._count} done{wrong},"
        self._whole.update(self._bar, advance=task.effort, description=text)


@contextmanager
def showing(tasks: Sequence[Task], seconds: float) -> Iterator[RunProgress]:
    """Context with the progress of the tasks on stderr.

    `seconds`: estimated time of the run on an idle reference machine. 0 if unknown.
    """
    progress = RunProgress(tasks)
    doing = counted(len(tasks), "comparison or figure", "comparisons, figures and verdicts")
    with progress_shown(doing, seconds, progress.line, progress):
        yield progress
