"""Memoised values of pure functions within a process, and fingerprints as keys of stored values."""

from collections.abc import Callable, Iterable, MutableMapping, Sequence
from dataclasses import Field, fields, is_dataclass
from functools import lru_cache, partial
from hashlib import blake2b
from pathlib import PurePath
from typing import Any, ParamSpec, Protocol, TypeVar, cast
from weakref import WeakKeyDictionary

import msgspec
import numpy as np

P = ParamSpec("P")
T = TypeVar("T")


class _Memoised(Protocol):
    def cache_clear(self) -> None: ...


_memoised: list[_Memoised] = []


def memo(size: int) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Decorator for a pure function with hashable arguments, whose last `size` values are kept."""

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        cached = lru_cache(maxsize=size)(function)
        _memoised.append(cached)
        return cast("Callable[P, T]", cached)

    return decorate


def forget() -> None:
    """Discard all memoised values, so that changes of the source code take effect."""
    for cached in _memoised:
        cached.cache_clear()


def fingerprint(value: object) -> str:
    """Hash of plain data: numbers, texts, paths, arrays, records with all fields, and collections.

    A function is hashed by its name, a `functools.partial` by its function and its arguments. Equal
    data have equal hashes in every process. Raises TypeError for other types.
    """
    return _hashed(value, fields)


def comparison_fingerprint(value: object) -> str:
    """Fingerprint without the fields that == ignores, so that equal records have equal ones."""
    return _hashed(value, _compared)


def _compared(record: Any) -> list[Field[Any]]:
    return [entry for entry in fields(record) if entry.compare]


# Digests of records that compare by identity, such as mechanisms, for as long as these exist.
_digests_by_selection: dict[object, MutableMapping[Any, bytes]] = {
    fields: WeakKeyDictionary(),
    _compared: WeakKeyDictionary(),
}


def _hashed(value: object, select_fields: Callable[[Any], Iterable[Field[Any]]]) -> str:
    digest = blake2b(digest_size=16)
    _feed(digest.update, value, select_fields, {})
    return digest.hexdigest()


def _feed(
    update: Callable[[bytes], object],
    value: Any,
    select_fields: Callable[[Any], Iterable[Field[Any]]],
    digests_by_id: MutableMapping[Any, bytes],
) -> None:
    """Add `value` to a digest, to which `update` adds bytes.

    `select_fields` returns the fields of a record that are hashed. `digests_by_id` contains digests
    that were computed before, by the `id` of the record. It is used for records that are compared
    by value.
    """
    match value:
        case np.ndarray():
            update(f"array {value.dtype.str} {value.shape} ".encode())
            update(np.ascontiguousarray(value).tobytes())
        case PurePath():
            update(f"path {value};".encode())
        case None | bool() | int() | float() | complex() | str() | bytes() | np.generic():
            update(f"{type(value).__name__} {value!r};".encode())
        case tuple() | list() | partial():
            items = _items(value)
            update(f"sequence {len(items)} ".encode())
            for item in items:
                _feed(update, item, select_fields, digests_by_id)
        case dict():
            update(f"mapping {len(value)} ".encode())
            for key in sorted(value):
                _feed(update, key, select_fields, digests_by_id)
                _feed(update, value[key], select_fields, digests_by_id)
        case _ if is_dataclass(value) and not isinstance(value, type):
            digests, key = (
                (_digests_by_selection[select_fields], value)
                if type(value).__hash__ is object.__hash__
                else (digests_by_id, id(value))
            )
            if key not in digests:
                digests[key] = _record(value, select_fields, digests_by_id)
            update(digests[key])
        case msgspec.Struct():
            update(f"record {type(value).__module__}.{type(value).__qualname__} ".encode())
            _feed(update, msgspec.structs.astuple(value), select_fields, digests_by_id)
        case _ if callable(value) and hasattr(value, "__qualname__"):
            update(f"function {value.__module__}.{value.__qualname__};".encode())
        case _:
            raise TypeError(f"{type(value).__name__} cannot be hashed; must be plain data")


def _items(value: Any) -> Sequence[Any]:
    """Items of a sequence. For a `functools.partial`: "partial", its function, its arguments."""
    if isinstance(value, partial):
        return "partial", value.func, value.args, value.keywords
    return cast("Sequence[Any]", value)


def _record(
    value: Any,
    select_fields: Callable[[Any], Iterable[Field[Any]]],
    digests_by_id: MutableMapping[Any, bytes],
) -> bytes:
    kind = f"record {type(value).__module__}.{type(value).__qualname__} "
    digest = blake2b(kind.encode(), digest_size=16)
    for entry in select_fields(value):
        _feed(digest.update, getattr(value, entry.name), select_fields, digests_by_id)
    return digest.digest()
