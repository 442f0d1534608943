"""Progress of a run on stderr: what runs, how many are left, elapsed and expected time."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from time import monotonic

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from validation.case import Case
from validation.results.tasks import Record, Task

_BAR = 24
# How many running tasks are named.
_SHOWN = 8


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
    running: dict[str, tuple[Task, float]] = field(default_factory=dict)

    def started(self, task: Task) -> None:
        """Show the task as running."""
        self.running[task.id] = task, monotonic()

    def finished(self, task: Task, record: Record) -> None:
        """Count the task as done."""
        self.running.pop(task.id, None)
        self.done += 1
        self.effort_done += task.effort
        self.troubled += isinstance(task, Case) and record["verdict"] in {"disagree", "failed"}

    def expected(self, elapsed: float) -> float | None:
        """Seconds still to go, None before anything is done."""
        if self.effort_done == 0.0:
            return None
        total = sum(task.effort for task in self.tasks)
        return elapsed * (total - self.effort_done) / self.effort_done

    def __rich__(self) -> Group:
        lines = [self._line(), *self._running()]
        for line in lines:
            line.no_wrap, line.overflow = True, "ellipsis"
        return Group(*lines)

    def _line(self) -> Text:
        elapsed = monotonic() - self.begun
        total = len(self.tasks)
        filled = round(_BAR * self.done / total) if total else _BAR
        line = Text("━" * filled, style="green") + Text("━" * (_BAR - filled), style="dim")
        line += Text(f"  {self.done}/{total} done, {_clock(elapsed)} elapsed")
        if (left := self.expected(elapsed)) is not None and self.done < total:
            line += Text(f", about {_clock(left)} left")
        if self.troubled:
            line += Text(f", {self.troubled} not in agreement", style="bold red")
        return line

    def _running(self) -> list[Text]:
        if not self.running and not self.done:
            return [Text("  starting the computing processes", style="dim")]
        # The longest first: that is what a person waits for.
        longest = sorted(self.running.values(), key=lambda entry: entry[1])
        now = monotonic()
        lines = [Text(f"  {_clock(now - at)}  {task.title}") for task, at in longest[:_SHOWN]]
        if len(longest) > _SHOWN:
            lines.append(Text(f"  and {len(longest) - _SHOWN} more"))
        for line in lines:
            line.stylize("dim")
        return lines


@contextmanager
def showing(tasks: Sequence[Task]) -> Iterator[Progress]:
    """The progress of the tasks, drawn on stderr while the context lasts if that is a terminal."""
    console, progress = Console(stderr=True), Progress(tasks)
    with ExitStack() as stack:
        if console.is_terminal:
            live = Live(progress, console=console, refresh_per_second=8, transient=True)
            stack.enter_context(live)
        yield progress


@contextmanager
def stage(doing: str) -> Iterator[None]:
    """Say on stderr what is being done while the context lasts; quiet without a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield
        return
    with console.status(doing):
        yield


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
