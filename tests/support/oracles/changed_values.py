"""Copies of plain data, each with one changed number, text or array entry."""

from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

Changes = Callable[[Any], Iterator[tuple[str, Any]]]


def least(value: Any) -> Iterator[tuple[str, Any]]:
    """Smallest possible changes of a value. A cache key that rounds would not notice them.

    In an array the first and the last entry are changed. The items of a collection are not changed
    here.
    """
    match value:
        case np.ndarray():
            for index in {0, value.size - 1} if value.size else ():
                other = value.copy()
                other.flat[index] += 1
                yield f"[{index}]", other
        case bool():
            yield "", not value
        case int() | float():
            yield "", np.nextafter(value, np.inf) if isinstance(value, float) else value + 1
        case str() | None:
            yield "", f"{value or ''}*"
        case PurePath():
            yield "", value / "other"
        case Mapping():
            for name, item in list(value.items())[:1]:
                fewer = {key: other for key, other in value.items() if key != name}
                yield " (one fewer)", fewer
                yield " (renamed)", {**fewer, f"{name}*": item}
        case tuple() | list():
            yield " (one more)", type(value)([*value, "*"])


def changed_leaves(
    value: Any, changes: Changes = least, path: str = ""
) -> Iterator[tuple[str, Any]]:
    """Yield each location in `value` with a copy of the whole that differs at this location only.

    Locations are texts such as "leg.material.E" or "poses[0]". Checks in constructors are bypassed,
    because the copies only serve to test cache keys.
    """
    yield from ((path + where, other) for where, other in changes(value))
    match value:
        case Mapping():
            for key, item in value.items():
                for where, other in changed_leaves(item, changes, f"{path}[{key}]"):
                    yield where, {**value, key: other}
        case tuple() | list():
            for index, item in enumerate(value):
                for where, other in changed_leaves(item, changes, f"{path}[{index}]"):
                    yield where, type(value)([*value[:index], other, *value[index + 1 :]])
        case _ if is_dataclass(value):
            for name in (field.name for field in fields(value) if not field.name.startswith("_")):
                for where, other in changed_leaves(getattr(value, name), changes, f"{path}.{name}"):
                    changed = copy(value)
                    object.__setattr__(changed, name, other)
                    yield where, changed
