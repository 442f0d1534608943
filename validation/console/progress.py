"""How far work is that takes its time: its forecast, what runs on a terminal, lines elsewhere."""

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
from validation.console.streams import mention

if TYPE_CHECKING:
    from rich.console import RenderableType

# Seconds of work that says nothing where nobody may be looking on; what takes longer is forecast,
# so many seconds after its beginning: what is kept from an earlier time is there by then.
_QUIET, _SOON, _MINUTES = 5.0, 1.0, 120.0
# Seconds that the work by which speed is measured takes on an idle core such as costs are told of.
_ON_ITS_CORE = 0.03


@contextmanager
def stage(doing: str, seconds: float = 0.0) -> Iterator[None]:
    """Say on stderr what is being done while the context lasts, and how long it will take.

    `seconds` is its time on an idle core such as costs are told of, 0 where nobody knows.
    """

    def line(left: str) -> str:
        return f"{doing}: {perf_counter() - begun:.0f} s elapsed{left}"

    begun = perf_counter()
    with told(doing, seconds, line):
        yield


@contextmanager
def told(
    doing: str,
    seconds: float,
    line: Callable[[str], str],
    drawn: "RenderableType | None" = None,
) -> Iterator[None]:
    """Forecast long work; show `drawn` on a terminal, elsewhere write a line a second.

    `line` has what it says after how long is left; `seconds` as of `stage`.
    """
    on_terminal, over, begun = sys.stderr.isatty(), Event(), perf_counter()
    forecast = seconds * slowness() if seconds > _SOON else 0.0

    def tell() -> None:
        if over.wait(_SOON):
            return
        if forecast > _QUIET:
            about = f"{forecast:.0f} s" if forecast < _MINUTES else f"{forecast / 60.0:.0f} min"
            mention(f"{doing}: about {about} on this machine")
        pause = _QUIET - _SOON
        while not (on_terminal or over.wait(pause)):
            left = begun + forecast - perf_counter()
            mention(line(f", about {left:.0f} s left" if left > 0.0 else ""))
            pause = 1.0

    shown = _shown(doing, drawn) if on_terminal else nullcontext()
    telling = Thread(target=tell, daemon=True)
    telling.start()
    try:
        with shown:
            yield
    finally:
        over.set()
        telling.join()


def _shown(doing: str, drawn: "RenderableType | None") -> AbstractContextManager[object]:
    """What runs on a terminal while work lasts; a fortieth of a second to load."""
    from rich.console import Console  # noqa: PLC0415
    from rich.live import Live  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    console = Console(stderr=True)
    # Names of files are no markup.
    return (
        Live(drawn, console=console, transient=True)
        if drawn
        else console.status(Text(visible(doing)))
    )


@lru_cache(maxsize=1)
def slowness() -> float:
    """How many times as long as on that core computing takes here and now, in one thread."""
    numbers = np.random.default_rng(0).random(300_000)
    begun = perf_counter()
    sum(map(sqrt, range(300_000)))
    np.sort(numbers)
    return (perf_counter() - begun) / _ON_ITS_CORE
