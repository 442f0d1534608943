"""Units of work: finished ones are kept in the cache and not computed again."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import fields
from typing import Protocol, TypeVar

from rich.console import Console
from rich.progress import track

from lumped.memo import memo
from validation.run.cache import find, keep, key_of
from validation.run.executor import Executor
from validation.run.provenance import suite_digest

T = TypeVar("T")
Result_co = TypeVar("Result_co", covariant=True)


class Unit(Protocol[Result_co]):
    """Plain data that stand for a result, and can be sent to other processes and machines."""

    def compute(self) -> Result_co:
        """The result."""


def computed(
    units: Sequence[Unit[T]],
    kind: Callable[..., T],
    executor: Executor,
    what: str,
) -> list[T]:
    """What the units yield, a `kind` each (a dataclass of numbers and arrays), in their order.

    Every finished unit is in the cache before the next one is looked at, so that what was
    interrupted goes on where it stopped; equal units are computed once. `what` is being done, for
    the progress on stderr if that is a terminal. Raises what the first failing unit raises.
    """
    keys = [key_of(_sources(), unit) for unit in units]
    work = dict(zip(keys, units, strict=True))
    known = {key: arrays for key in work if (arrays := find(key)) is not None}
    missing = [key for key in work if key not in known]
    console = Console(stderr=True)
    if missing:
        with closing(executor([work[key].compute for key in missing])) as finished:
            for number, result in track(
                finished,
                f"  {what}",
                total=len(missing),
                console=console,
                transient=True,
                disable=not console.is_terminal,
            ):
                arrays = {entry.name: getattr(result, entry.name) for entry in fields(result)}
                known[missing[number]] = keep(missing[number], arrays)
    # Numbers are kept as arrays of no dimension.
    return [kind(**{name: array[()] for name, array in known[key].items()}) for key in keys]


@memo(1)
def _sources() -> str:
    return suite_digest()
