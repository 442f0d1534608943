"""What a process remembers: values of pure functions, and fingerprints to find them by."""

from collections.abc import Callable, Iterable, MutableMapping
from dataclasses import Field, fields, is_dataclass
from functools import lru_cache
from hashlib import blake2b
from pathlib import PurePath
from typing import Any, ParamSpec, Protocol, TypeVar, cast
from weakref import WeakKeyDictionary

import msgspec
import numpy as np

P = ParamSpec("P")
T = TypeVar("T")


class _Remembering(Protocol):
    def cache_clear(self) -> None: ...


_remembering: list[_Remembering] = []


def memo(size: int) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """A pure function that remembers its last `size` values, by arguments that can be hashed."""

    def remembering(function: Callable[P, T]) -> Callable[P, T]:
        cached = lru_cache(maxsize=size)(function)
        _remembering.append(cached)
        return cast("Callable[P, T]", cached)

    return remembering


def forget() -> None:
    """Have all functions with a memo compute anew, as when what they rest on was changed."""
    for cached in _remembering:
        cached.cache_clear()


def fingerprint(value: object) -> str:
    """Hash of plain data: numbers, texts, paths, arrays, records with all fields, and collections.

    Equal data give equal hashes in every process. Raises TypeError for anything else.
    """
    return _hashed(value, fields)


def likeness(value: object) -> str:
    """As `fingerprint`, alike for records that are equal: names for messages alone do not count."""
    return _hashed(value, _compared)


def _compared(record: Any) -> list[Field[Any]]:
    return [entry for entry in fields(record) if entry.compare]


# Digests of records that are equal to themselves alone, as mechanisms, as long as these live.
_kept: dict[object, MutableMapping[Any, bytes]] = {
    fields: WeakKeyDictionary(),
    _compared: WeakKeyDictionary(),
}


def _hashed(value: object, told: Callable[[Any], Iterable[Field[Any]]]) -> str:
    digest = blake2b(digest_size=16)
    _feed(digest.update, value, told, {})
    return digest.hexdigest()


def _feed(
    update: Callable[[bytes], object],
    value: Any,
    told: Callable[[Any], Iterable[Field[Any]]],
    known: MutableMapping[Any, bytes],
) -> None:
    """`known` digests of other records by identity: many postures are of one mechanism."""
    match value:
        case np.ndarray():
            update(f"array {value.dtype.str} {value.shape} ".encode())
            update(np.ascontiguousarray(value).tobytes())
        case PurePath():
            update(f"path {value};".encode())
        case None | bool() | int() | float() | complex() | str() | bytes() | np.generic():
            update(f"{type(value).__name__} {value!r};".encode())
        case tuple() | list():
            update(f"sequence {len(value)} ".encode())
            for item in value:
                _feed(update, item, told, known)
        case dict():
            update(f"mapping {len(value)} ".encode())
            for key in sorted(value):
                _feed(update, key, told, known)
                _feed(update, value[key], told, known)
        case _ if is_dataclass(value) and not isinstance(value, type):
            alone = type(value).__hash__ is object.__hash__
            digests, place = (_kept[told], value) if alone else (known, id(value))
            if place not in digests:
                digests[place] = _record(value, told, known)
            update(digests[place])
        case msgspec.Struct():
            update(f"record {type(value).__module__}.{type(value).__qualname__} ".encode())
            _feed(update, msgspec.structs.astuple(value), told, known)
        case _ if callable(value) and hasattr(value, "__qualname__"):
            update(f"function {value.__module__}.{value.__qualname__};".encode())
        case _:
            raise TypeError(f"{type(value).__name__} is no plain data: it has no fingerprint")


def _record(
    value: Any, told: Callable[[Any], Iterable[Field[Any]]], known: MutableMapping[Any, bytes]
) -> bytes:
    kind = f"record {type(value).__module__}.{type(value).__qualname__} "
    digest = blake2b(kind.encode(), digest_size=16)
    for entry in told(value):
        _feed(digest.update, getattr(value, entry.name), told, known)
    return digest.digest()
