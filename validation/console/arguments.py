"""Check of the arguments of public Python functions against their type annotations.

Input: a call with its arguments. Output: the result of the function, or InputError with a line for
each argument of a wrong type.
"""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from numbers import Integral, Real
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin

import numpy as np

from fem.machine import one_blas_thread
from lumped.errors import InputError
from lumped.text import did_you_mean, shown

P = ParamSpec("P")
T = TypeVar("T")
_WORDS: Mapping[Any, str] = {
    int: "a whole number",
    float: "a number",
    str: "a text",
    Path: "a path",
    NoneType: "None",
    bool: "True or False",
}


def checked(function: Callable[P, T]) -> Callable[P, T]:
    """Decorator that raises InputError with a line for each argument of a wrong type.

    Arguments in **kwargs are not checked. The function runs with one BLAS thread, as commands do.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        hints = inspect.get_annotations(function)
        arguments = signature.bind(*args, **kwargs).arguments
        faults = [
            fault
            for name, value in arguments.items()
            if name in hints
            and signature.parameters[name].kind is not inspect.Parameter.VAR_KEYWORD
            for fault in faults_of(name, value, hints[name])
        ]
        if faults:
            raise InputError(faults)
        with one_blas_thread():
            return function(*args, **kwargs)

    return call


def faults_of(name: str, value: object, hint: Any) -> list[str]:
    """Message if the argument `name` is not of the type `hint`. [] if it is."""
    if _fits(value, hint):
        return []
    suggestion = did_you_mean(value, _choices(hint)) if isinstance(value, str) else ""
    return [f"{name} = {shown(value)}: must be {_allowed(hint)}{suggestion}"]


def _fits(value: object, hint: Any) -> bool:
    origin, parts = get_origin(hint), get_args(hint)
    if hint is Any:
        return True
    if origin in {Union, UnionType}:
        return any(_fits(value, part) for part in parts)
    if origin is Literal:
        return isinstance(value, str) and value in parts
    if origin is Sequence:
        entries: Any = value.tolist() if isinstance(value, np.ndarray) else value
        is_list = isinstance(entries, Sequence) and not isinstance(entries, str | bytes)
        return is_list and all(_fits(entry, parts[0]) for entry in entries)
    if origin is Mapping:
        pairs = value.items() if isinstance(value, Mapping) else ()
        fits = all(_fits(name, parts[0]) and _fits(entry, parts[1]) for name, entry in pairs)
        return fits and isinstance(value, Mapping)
    kind = {int: Integral, float: Real}.get(hint, hint)
    return isinstance(value, kind) and (hint is bool or not isinstance(value, bool))


def _choices(hint: Any) -> list[str]:
    """Texts that a type annotation allows by `Literal`."""
    if get_origin(hint) is Literal:
        return list(get_args(hint))
    return [choice for part in get_args(hint) for choice in _choices(part)]


def _allowed(hint: Any) -> str:
    origin, parts = get_origin(hint), get_args(hint)
    if origin in {Union, UnionType}:
        return " or ".join(map(_allowed, parts))
    if origin is Literal:
        return f"one of {', '.join(parts)}"
    if origin is Sequence:
        return f"a list, each entry {_allowed(parts[0])}"
    if origin is Mapping and parts[1] is Any:
        return "a dictionary"
    if origin is Mapping:
        return f"a dictionary, each value {_allowed(parts[1])}"
    return _WORDS.get(hint) or f"a {hint.__name__}"


_OPTION = re.compile(r"(?<!\S)--([a-z]+)")
# Options of the command line whose arguments in Python have another name.
_ARGUMENTS = {"pose": "poses", "x": "poses", "load": "loads"}


@contextmanager
def arguments_named() -> Iterator[None]:
    """Context in which faults of input name function arguments instead of command options."""

    def argument(option: re.Match[str]) -> str:
        return _ARGUMENTS.get(option[1], option[1])

    try:
        yield
    except InputError as error:
        raise InputError([_OPTION.sub(argument, fault) for fault in error.faults]) from error
