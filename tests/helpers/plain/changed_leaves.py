"""Copies of plain data, each with one number, text or array entry of it changed."""

from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np


def changed_leaves(  # noqa: PLR0912  one branch per kind of data
    value: Any, place: str = ""
) -> Iterator[tuple[str, Any]]:
    """Every place in `value` with a copy of the whole that differs there alone.

    Places read "leg.material.E" or "poses[0]"; of an array the first and the last entry change.
    Checks of a record's own construction are passed by: what is asked is whether a key sees it.
    """
    match value:
        case np.ndarray():
            for index in {0, value.size - 1} if value.size else ():
                other = value.copy()
                other.flat[index] += 1
                yield f"{place}[{index}]", other
        case bool():
            yield place, not value
        case int() | float():
            # The smallest change that there is: a key that rounds is none.
            yield place, np.nextafter(value, np.inf) if isinstance(value, float) else value + 1
        case str():
            yield place, f"{value}*"
        case None:
            yield place, "*"
        case PurePath():
            yield place, value / "other"
        case Mapping():
            for key, item in value.items():
                for where, other in changed_leaves(item, f"{place}[{key}]"):
                    yield where, {**value, key: other}
            for name, item in list(value.items())[:1]:
                fewer = {key: other for key, other in value.items() if key != name}
                yield f"{place} (one fewer)", fewer
                yield f"{place} (renamed)", {**fewer, f"{name}*": item}
        case tuple() | list():
            for index, item in enumerate(value):
                for where, other in changed_leaves(item, f"{place}[{index}]"):
                    yield where, type(value)([*value[:index], other, *value[index + 1 :]])
            yield f"{place} (one more)", type(value)([*value, "*"])
        case _ if is_dataclass(value):
            for entry in fields(value):
                if not entry.name.startswith("_"):
                    held = getattr(value, entry.name)
                    for where, other in changed_leaves(held, f"{place}.{entry.name}"):
                        changed = copy(value)
                        object.__setattr__(changed, entry.name, other)
                        yield where, changed
