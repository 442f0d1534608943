"""A sweep: legs first, each once, then postures; finished units are kept and not computed again."""

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from functools import partial
from typing import Any, Protocol, TypeAlias, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from validation.sweeps.journal import Journal, key_of
from validation.sweeps.units import PostureUnit, ReducedLeg, SolvedPostures

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


def sweep(
    units: Sequence[PostureUnit], executor: Executor = in_turn, journal: Journal | None = None
) -> list[SolvedPostures]:
    """What the units yield, in their order.

    Every finished unit is in the journal before the next one is looked at, so that a sweep that
    was interrupted goes on where it stopped. Progress goes to stderr if that is a terminal. Raises
    what the first failing unit raises (InputError, ComputationError), and KeyboardInterrupt.
    """
    kept = Journal() if journal is None else journal
    postures = {key_of(unit): unit for unit in units}
    missing = [unit for key, unit in postures.items() if kept.find(key, SolvedPostures) is None]
    legs = {key_of(leg): leg for unit in missing for leg in unit.legs}
    leg_work = {key: leg.compute for key, leg in legs.items()}
    reduced = _finish(leg_work, ReducedLeg, executor, kept, "condensing legs")
    posture_work = {
        key: partial(unit.compute, tuple(reduced[key_of(leg)] for leg in unit.legs))
        for key, unit in postures.items()
        if kept.find(key, SolvedPostures) is None
    }
    _finish(posture_work, SolvedPostures, executor, kept, "solving postures")
    return [_kept(kept, key_of(unit), SolvedPostures) for unit in units]


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
    """What the units yield, a `kind` each, in their order, kept like the units of `sweep`.

    `what` is being done, for the progress display.
    """
    work = {key_of(unit): unit.compute for unit in units}
    found = _finish(work, kind, executor, journal, what)
    return [found[key_of(unit)] for unit in units]


def _finish(
    work: Mapping[str, Work],
    kind: Callable[..., T],
    executor: Executor,
    journal: Journal,
    what: str,
) -> dict[str, T]:
    """All results by key: those of the journal, and those that are computed now."""
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
    return {key: _kept(journal, key, kind) for key in work}


def _kept(journal: Journal, key: str, kind: Callable[..., T]) -> T:
    found = journal.find(key, kind)
    if found is None:
        raise RuntimeError("an executor ended without a unit that was given to it")
    return found
