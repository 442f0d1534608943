"""Progress of a run on stderr: what runs, how many are left, elapsed and expected time."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic

from rich.console import Console
from rich.live import Live
from rich.text import Text

from validation.records import Record, Task
from validation.runner import Observer

_BAR = 24


class Quiet:
    """An observer that says nothing."""

    def started(self, task: Task) -> None:
        """Nothing to say."""

    def finished(self, task: Task, record: Record) -> None:
        """Nothing to say."""


@dataclass
class Progress:
    """A line that is redrawn: bar, count, elapsed and expected time, and what is running.

    The expected time goes by the tasks' efforts: what is done took as long as it took, the rest
    will take as long per effort.
    """

    tasks: Sequence[Task]
    begun: float = field(default_factory=monotonic)
    done: int = 0
    effort_done: float = 0.0
    troubled: int = 0
    running: dict[str, Task] = field(default_factory=dict)

    def started(self, task: Task) -> None:
        """Show the task as running."""
        self.running[task.id] = task

    def finished(self, task: Task, record: Record) -> None:
        """Count the task as done."""
        self.running.pop(task.id, None)
        self.done += 1
        self.effort_done += task.effort
        self.troubled += record.get("verdict") in {"disagree", "failed"}

    def expected(self, elapsed: float) -> float | None:
        """Seconds still to go, None before anything is done."""
        if self.effort_done == 0.0:
            return None
        total = sum(task.effort for task in self.tasks)
        return elapsed * (total - self.effort_done) / self.effort_done

    def __rich__(self) -> Text:
        elapsed = monotonic() - self.begun
        total = len(self.tasks)
        filled = round(_BAR * self.done / total) if total else _BAR
        line = Text("━" * filled, style="green") + Text("━" * (_BAR - filled), style="dim")
        line += Text(f"  {self.done}/{total} done, {_clock(elapsed)} elapsed")
        if (left := self.expected(elapsed)) is not None and self.done < total:
            line += Text(f", about {_clock(left)} left")
        if self.troubled:
            line += Text(f", {self.troubled} not in agreement", style="bold red")
        for task in self.running.values():
            line += Text(f"\n  {task.title}", style="dim", overflow="ellipsis")
        return line


@contextmanager
def showing(tasks: Sequence[Task]) -> Iterator[Observer]:
    """An observer that draws on stderr while the context lasts; quiet without a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield Quiet()
        return
    progress = Progress(tasks)
    with Live(progress, console=console, refresh_per_second=8, transient=True):
        yield progress


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
