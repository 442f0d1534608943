"""Units of work: where they are computed; finished ones are kept and not computed again."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from typing import Any, Protocol, TypeAlias, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from validation.sweeps.journal import Journal, key_of

# A call without arguments that can be pickled.
Work: TypeAlias = Callable[[], Any]
# Number of a call and its result, one after the other as they are finished.
Finished: TypeAlias = Generator[tuple[int, Any], None, None]
# Computes calls in any order.
Executor: TypeAlias = Callable[[Sequence[Work]], Finished]
T = TypeVar("T")
Result_co = TypeVar("Result_co", covariant=True)


def in_turn(calls: Sequence[Work]) -> Finished:
    """One call after the other in this process."""
    for number, call in enumerate(calls):
        yield number, call()


class Unit(Protocol[Result_co]):
    """Plain data that stand for a result, and can be sent to other processes and machines."""

    def compute(self) -> Result_co:
        """The result."""


def computed(
    units: Sequence[Unit[T]],
    kind: Callable[..., T],
    executor: Executor,
    journal: Journal,
    what: str,
) -> list[T]:
    """What the units yield, a `kind` each (a dataclass of numbers and arrays), in their order.

    Every finished unit is in the journal before the next one is looked at, so that what was
    interrupted goes on where it stopped; equal units are computed once. `what` is being done, for
    the progress on stderr if that is a terminal. Raises what the first failing unit raises.
    """
    work = {key_of(unit): unit.compute for unit in units}
    keys = [key for key in work if journal.find(key, kind) is None]
    console = Console(stderr=True)
    columns = (
        TextColumn("  {task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    if keys:
        with (
            Progress(
                *columns, console=console, transient=True, disable=not console.is_terminal
            ) as progress,
            closing(executor([work[key] for key in keys])) as finished,
        ):
            shown = progress.add_task(what, total=len(work), completed=len(work) - len(keys))
            for number, result in finished:
                journal.keep(keys[number], result)
                progress.advance(shown)
    return [_kept(journal, key_of(unit), kind) for unit in units]


def _kept(journal: Journal, key: str, kind: Callable[..., T]) -> T:
    found = journal.find(key, kind)
    if found is None:
        raise RuntimeError("an executor ended without a unit that was given to it")
    return found
