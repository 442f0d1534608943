"""The two ways in which a computation can go wrong; the user answers them differently."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from errno import EAGAIN, EDQUOT, EFBIG, EIO, EMFILE, ENFILE, ENOMEM, ENOSPC
from typing import Any, TypeVar

from lumped.text import shortened

Item = TypeVar("Item")
Found = TypeVar("Found")

# Error numbers of a system that is out of files, processes, memory or room on its disk.
EXHAUSTED = frozenset({EMFILE, ENFILE, EAGAIN, ENOMEM, ENOSPC, EDQUOT, EFBIG, EIO})
# What a person reads before mending the first of them.
_MOST_LINES = 50


class _SendableError(Exception):
    """Arrives from another process as it was, though its constructor takes more than a message."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_again, (type(self), *self.args), self.__dict__


def _made_again(kind: type[_SendableError], *message: str) -> _SendableError:
    return kind.__new__(kind, *message)


class InputError(_SendableError):
    """The input is wrong: one line per fault, each naming place, value and what is allowed.

    Long lines are shortened, and of more than fifty the rest are counted.
    """

    def __init__(self, faults: str | Iterable[str]) -> None:
        lines = (faults,) if isinstance(faults, str) else tuple(faults)
        if len(lines) > _MOST_LINES:
            more = f"and {len(lines) - _MOST_LINES + 1} more faults"
            lines = (*lines[: _MOST_LINES - 1], more)
        self.faults: tuple[str, ...] = tuple(map(shortened, lines))
        super().__init__("\n".join(self.faults))


class ComputationError(_SendableError):
    """A computation failed: the message names the part of the model and the likely cause."""


def write_error(path: object, error: OSError, advice: str = "") -> InputError | ComputationError:
    """Error of a file that cannot be written: of the system if it is out of room, else of input.

    `advice` is what to do about a wrong name.
    """
    if error.errno in EXHAUSTED:
        return ComputationError(f"{path}: cannot be written ({error.strerror})")
    return InputError(f"{path}: cannot be written ({error.strerror}){advice}")


def each(function: Callable[[Item], Found], items: Iterable[Item]) -> tuple[list[Found], list[str]]:
    """What a function says of the items that it takes, and its faults of all the others."""
    found: list[Found] = []
    faults: list[str] = []
    for item in items:
        try:
            found.append(function(item))
        except InputError as error:
            faults += error.faults
    return found, faults


@contextmanager
def naming(part: str) -> Iterator[None]:
    """Errors raised within, their messages beginning with the `part` of the model; "" is none.

    A message that names it already stays as it is.
    """
    try:
        yield
    except InputError as error:
        if not part:
            raise
        raise InputError(_named(part, fault) for fault in error.faults) from error
    except ComputationError as error:
        if not part:
            raise
        raise ComputationError(_named(part, str(error))) from error


def _named(part: str, message: str) -> str:
    return message if message.startswith(f"{part}: ") else f"{part}: {message}"
