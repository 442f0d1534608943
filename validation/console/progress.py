"""Progress of long tasks on stderr: estimated time, and an animation or lines of text.

Input: name of a task and its time on a reference machine. Output: an animation on a terminal, one
line per second on any other stream.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import lru_cache
from math import sqrt
from threading import Event, Thread
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from lumped.text import visible
from validation.console.streams import is_quiet, write_message

if TYPE_CHECKING:
    from rich.console import RenderableType

# Estimates below this time (s) are not written, nor are lines before it has passed.
_SILENT_SECONDS = 5.0
# Delay (s) of the estimate after the start. Results from the cache are ready sooner.
_ESTIMATE_DELAY = 1.0
# Estimates of at least this time (s) are written in minutes.
_MINUTES = 120.0
# Time (s) of the test computation on an idle core of the reference machine, on which costs were
# measured.
_REFERENCE_SECONDS = 0.03


@contextmanager
def stage(task: str, seconds: float = 0.0) -> Iterator[None]:
    """Context that shows a task's name and estimated time on stderr.

    `seconds` is the time of the task on an idle core of the reference machine. 0 if unknown.
    """

    def line(remaining: str) -> str:
        return f"{task}: {perf_counter() - start:.0f} s elapsed{remaining}"

    start = perf_counter()
    with progress_shown(task, seconds, line):
        yield


@contextmanager
def progress_shown(
    task: str,
    seconds: float,
    line: Callable[[str], str],
    display: "RenderableType | None" = None,
) -> Iterator[None]:
    """Context that shows `display` on a terminal, or writes lines to any other stream.

    `line` turns a text on the remaining time into a line of text. `seconds`: time of the task
    on an idle core of the reference machine, 0 if unknown.
    """
    if is_quiet():
        yield
        return
    on_terminal, finished, start = sys.stderr.isatty(), Event(), perf_counter()
    estimate = seconds * slowness() if seconds > _ESTIMATE_DELAY else 0.0

    def write_lines() -> None:
        if finished.wait(_ESTIMATE_DELAY):
            return
        if estimate > _SILENT_SECONDS:
            time = f"{estimate:.0f} s" if estimate < _MINUTES else f"{estimate / 60.0:.0f} min"
            write_message(f"{task}: about {time} on this machine")
        pause = _SILENT_SECONDS - _ESTIMATE_DELAY
        while not (on_terminal or finished.wait(pause)):
            remaining = start + estimate - perf_counter()
            write_message(line(f", about {remaining:.0f} s left" if remaining > 0.0 else ""))
            pause = 1.0

    animation = _animation(task, display) if on_terminal else nullcontext()
    writer = Thread(target=write_lines, daemon=True)
    writer.start()
    try:
        with animation:
            yield
    finally:
        finished.set()
        writer.join()


def _animation(task: str, display: "RenderableType | None") -> AbstractContextManager[object]:
    """Animation on a terminal: `display`, or the name of the task if `display` is None."""
    from rich.console import Console  # noqa: PLC0415
    from rich.live import Live  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    console = Console(stderr=True)
    # Plain text, because file names can contain markup characters of rich.
    return (
        Live(display, console=console, transient=True)
        if display
        else console.status(Text(visible(task)))
    )


@lru_cache(maxsize=1)
def slowness() -> float:
    """Ratio of the present computing time in one thread to that on the reference machine."""
    numbers = np.random.default_rng(0).random(300_000)
    start = perf_counter()
    sum(map(sqrt, range(300_000)))
    np.sort(numbers)
    return (perf_counter() - start) / _REFERENCE_SECONDS
