"""Error classes: wrong input, which the user corrects, and failed computations."""

import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from errno import EAGAIN, EDQUOT, EFBIG, EIO, EMFILE, ENFILE, ENOMEM, ENOSPC
from typing import Any, TypeVar

from lumped.text import shortened

Item = TypeVar("Item")
Result = TypeVar("Result")

# Error numbers of a system that is out of files, processes, memory or room on its disk.
EXHAUSTED = frozenset({EMFILE, ENFILE, EAGAIN, ENOMEM, ENOSPC, EDQUOT, EFBIG, EIO})
# Largest number of faults in one message: more than anybody reads before correcting the first.
_LARGEST_FAULT_COUNT = 50


class _SendableError(Exception):
    """An error that survives pickling although its constructor takes more than a message.

    The message begins with the `part` of the model; "" if it names none.
    """

    part = ""

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled_error, (type(self), *self.args), self.__dict__


def _unpickled_error(kind: type[_SendableError], *message: str) -> _SendableError:
    return kind.__new__(kind, *message)


class Remark(UserWarning):
    """A message to the user, in one line, that changes neither results nor the exit code."""


@contextmanager
def remarks_to(receive: Callable[[Remark], object]) -> Iterator[None]:
    """Hand remarks over, each once; other warnings are shown as they are elsewhere."""
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
    """Wrong input: one line per fault, each with location, value and allowed values.

    Long lines are shortened. Of more than fifty faults the remainder is counted. Each line begins
    with the `part` of the model; "" if there is none.
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
    """A computation failed: the message names the part of the model and the likely cause."""

    def __init__(self, message: str, part: str = "") -> None:
        self.part = part
        super().__init__(_prefixed(part, message))


def _prefixed(part: str, message: str) -> str:
    return f"{part}: {message}" if part else message


def write_error(path: object, error: OSError, advice: str = "") -> InputError | ComputationError:
    """Error of a file that cannot be written.

    ComputationError if the system is out of resources, otherwise InputError with `advice` on a
    wrong path.
    """
    if error.errno in EXHAUSTED:
        return ComputationError(f"{path}: cannot be written ({error.strerror})")
    return InputError(f"{path}: cannot be written ({error.strerror}){advice}")


def collect_faults(
    function: Callable[[Item], Result], items: Iterable[Item]
) -> tuple[list[Result], list[str]]:
    """Results of a function for the items that it accepts, and its faults for all others."""
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
    """Prefix the messages of errors raised in this context with the `part` of the model.

    Errors of this part, and all errors if it is "", remain unchanged.
    """
    try:
        yield
    except InputError as error:
        if part in ("", error.part):
            raise
        raise InputError(error.faults, part) from error
    except ComputationError as error:
        if part in ("", error.part):
            raise
        raise ComputationError(str(error), part) from error
