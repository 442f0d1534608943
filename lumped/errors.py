"""Error classes for wrong input, which the user can correct, and for failed computations."""

import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from errno import EAGAIN, EDQUOT, EFBIG, EIO, EMFILE, ENFILE, ENOMEM, ENOSPC
from traceback import format_exception
from typing import Any, TypeVar

from lumped.text import shortened

Item = TypeVar("Item")
Result = TypeVar("Result")

# Values of errno if the system is out of file handles, processes, memory or disk space.
EXHAUSTED = frozenset({EMFILE, ENFILE, EAGAIN, ENOMEM, ENOSPC, EDQUOT, EFBIG, EIO})
# Largest number of faults in one message: more than anybody reads before correcting the first.
_LARGEST_FAULT_COUNT = 50


class _SendableError(Exception):
    """Error that can be pickled although its constructor needs more than a message.

    `part` is the part of the model with which the message begins. "" if the message has no part.
    """

    part = ""

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled_error, (type(self), *self.args), self.__dict__


def _unpickled_error(kind: type[_SendableError], *message: str) -> _SendableError:
    return kind.__new__(kind, *message)


class Remark(UserWarning):
    """A message of one line to the user that affects neither results nor the exit code."""


@contextmanager
def remarks_to(receive: Callable[[Remark], object]) -> Iterator[None]:
    """Context in which `receive` is called for each remark. Other warnings are shown as usual."""
    with warnings.catch_warnings():
        show = warnings.showwarning

        def receive_or_show(
            message: Warning | str, category: type[Warning], *place: Any, **options: Any
        ) -> None:
            if isinstance(message, Remark):
                receive(message)
            else:
                show(message, category, *place, **options)

        warnings.showwarning = receive_or_show
        yield


class InputError(_SendableError):
    """Wrong input, with one line per fault: location, value and allowed values.

    Long lines are shortened. A message has at most fifty lines; if there are more faults, the last
    line gives the number of the others. Each line begins with `part`, the affected part of the
    model, unless `part` is "".
    """

    def __init__(self, faults: str | Iterable[str], part: str = "") -> None:
        lines = (faults,) if isinstance(faults, str) else tuple(faults)
        self.part, lines = part, tuple(_prefixed(part, line) for line in lines)
        if len(lines) > _LARGEST_FAULT_COUNT:
            remainder = f"and {len(lines) - _LARGEST_FAULT_COUNT + 1} more faults"
            lines = (*lines[: _LARGEST_FAULT_COUNT - 1], remainder)
        self.faults: tuple[str, ...] = tuple(map(shortened, lines))
        super().__init__("\n".join(self.faults))


class ComputationError(_SendableError):
    """A computation failed. The message contains the part of the model and the likely cause."""

    def __init__(self, message: str, part: str = "") -> None:
        self.part = part
        super().__init__(_prefixed(part, message))


class ProgramError(ComputationError):
    """An error of the program itself in another process.

    The message contains the part of the model, and the class and text of the error. `traceback`
    contains the lines of its traceback, for a report of the error.
    """

    def __init__(self, message: str, traceback: Iterable[str], part: str = "") -> None:
        super().__init__(message, part)
        self.traceback = tuple(traceback)


def program_error(error: Exception) -> ProgramError:
    """ProgramError with the class and the text of `error`.

    The message begins with the parts of the model that `naming` added to `error` as notes.
    """
    parts = [part for part in getattr(error, "__notes__", ()) if part]
    lines = "".join(format_exception(error)).splitlines()
    return ProgramError(": ".join([*reversed(parts), f"{type(error).__name__}: {error}"]), lines)


def _prefixed(part: str, message: str) -> str:
    return f"{part}: {message}" if part else message


def write_error(path: object, error: OSError, advice: str = "") -> InputError | ComputationError:
    """Error to raise if the file `path` cannot be written.

    ComputationError if the system is out of resources. Otherwise InputError, whose message ends
    with `advice`, because the path is wrong.
    """
    if error.errno in EXHAUSTED:
        return ComputationError(f"{path}: cannot be written ({error.strerror})")
    return InputError(f"{path}: cannot be written ({error.strerror}){advice}")


def collect_faults(
    function: Callable[[Item], Result], items: Iterable[Item]
) -> tuple[list[Result], list[str]]:
    """Apply a function to each item. Return the results, and the faults of all InputErrors."""
    results: list[Result] = []
    faults: list[str] = []
    for item in items:
        try:
            results.append(function(item))
        except InputError as error:
            faults += error.faults
    return results, faults


@contextmanager
def naming(part: str) -> Iterator[None]:
    """Context that prefixes the messages of errors raised in it with `part`, a part of the model.

    A message that already begins with `part` is not changed. If `part` is "", no message is
    changed. Exceptions of other classes, which are errors of the program, get `part` as a note.
    """
    try:
        yield
    except InputError as error:
        if part in ("", error.part):
            raise
        raise InputError(error.faults, part) from error
    except ProgramError as error:
        if part in ("", error.part):
            raise
        raise ProgramError(str(error), error.traceback, part) from error
    except ComputationError as error:
        if part in ("", error.part):
            raise
        raise ComputationError(str(error), part) from error
    except Exception as error:
        if part:
            error.add_note(part)
        raise
