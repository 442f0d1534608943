"""Corrections of a source's misprints: where the used value stands, and the data as printed."""

import re
from collections.abc import Iterable, Mapping
from copy import deepcopy
from typing import Any

from lumped.robot_file.matrix_faults import is_finite_number
from lumped.robot_file.tables import Correction
from lumped.text import shown

_KEY = re.compile(r"(?P<names>[\w-]+(?:\.[\w-]+)*)(?:\[(?P<indices>\d+(?:\s*,\s*\d+)?)\])?")


def value_at(tables: Mapping[str, Any], key: str) -> float:
    """The number at a key like "leg1.length" or "foot.compliance[6,6]" (counted from 1).

    Raises LookupError where nothing or no number stands there.
    """
    holder, last = _holder(tables, key)
    value = holder[last]
    if not is_finite_number(value):
        raise LookupError(key)
    return float(value)


def correction_faults(tables: Mapping[str, Any], corrections: Iterable[Correction]) -> list[str]:
    """Corrections that do not describe the file they stand in, one line each."""
    faults = []
    for i, correction in enumerate(corrections, start=1):
        place = f"corrections[{i}]"
        try:
            value = value_at(tables, correction.key)
        except LookupError:
            faults.append(
                f"{place}.key = {shown(correction.key)}: must name a number of this file, "
                'like "leg1.length" or "foot.compliance[6,6]"'
            )
            continue
        if value != correction.used:
            faults.append(
                f"{place}.used = {correction.used!r}: must be what stands at {correction.key}, "
                f"{value!r}"
            )
        if correction.printed == correction.used:
            faults.append(
                f"{place}.printed = {correction.printed!r}: must differ from used, "
                "or there is nothing to correct"
            )
    return faults


def with_printed_values(
    tables: Mapping[str, Any], corrections: Iterable[Correction]
) -> dict[str, Any]:
    """The tables with every correction undone."""
    printed = deepcopy(dict(tables))
    for correction in corrections:
        holder, last = _holder(printed, correction.key)
        holder[last] = correction.printed
    return printed


def with_value(tables: Mapping[str, Any], key: str, value: float) -> dict[str, Any]:
    """The tables with another number at a key; raises LookupError where there is no such place."""
    changed = deepcopy(dict(tables))
    holder, last = _holder(changed, key)
    holder[last] = value
    return changed


def can_be_scaled(tables: Mapping[str, Any], key: str) -> bool:
    """Whether a number or an array of numbers stands at the key."""
    try:
        holder, last = _holder(tables, key)
    except LookupError:
        return False
    return _are_numbers(holder[last])


def scaled(tables: Mapping[str, Any], key: str, factor: float) -> dict[str, Any]:
    """The tables with what stands at the key, a number or a matrix, times `factor`."""
    changed = deepcopy(dict(tables))
    holder, last = _holder(changed, key)
    holder[last] = _times(holder[last], factor)
    return changed


def _are_numbers(value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(map(_are_numbers, value))
    return is_finite_number(value)


def _times(value: Any, factor: float) -> Any:
    return [_times(one, factor) for one in value] if isinstance(value, list) else factor * value


def _holder(tables: Mapping[str, Any], key: str) -> tuple[Any, Any]:
    """The table or row that holds the value at `key`, and its key or index therein."""
    match = _KEY.fullmatch(key.strip())
    if match is None:
        raise LookupError(key)
    path: list[Any] = list(match["names"].split("."))
    if match["indices"]:
        path += [int(index) - 1 for index in match["indices"].split(",")]
    holder: Any = tables
    for depth, step in enumerate(path):
        known = range(len(holder)) if isinstance(holder, list) else holder
        if not isinstance(holder, list | dict) or step not in known:
            raise LookupError(key)
        if depth < len(path) - 1:
            holder = holder[step]
    return holder, path[-1]
