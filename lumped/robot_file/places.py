"""Values of a robot file by key: "leg1.length", "foot.compliance[6,6]", "sections[2].width".

Indices are counted from 1.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from copy import deepcopy
from typing import Any

from lumped.mechanism.mechanism import LENGTHS
from lumped.robot_file.rules.matrices import SquareMatrix
from lumped.robot_file.rules.rule import Number, Several, is_finite_number
from lumped.robot_file.rules.tables.robots import length_unit_of, rules_of

# A name with indices after it.
_STEP = re.compile(r"([\w-]+)(?:\[([1-9]\d*(?:\s*,\s*[1-9]\d*)?)\])?")
_KEY = re.compile(rf"{_STEP.pattern}(?:\.{_STEP.pattern})*")
_UNITS_OF_COMPLIANCE = ("m/N", "rad/N", "rad/(N m)")


def value_at(tables: Mapping[str, Any], key: str) -> Any:
    """Value at a key. Raises LookupError if the key does not exist."""
    holder, last = _holder(tables, key)
    return holder[last]


def with_value(tables: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Copy of the tables with `value` at a key. Raises LookupError if the key does not exist."""
    changed = deepcopy(dict(tables))
    holder, last = _holder(changed, key)
    holder[last] = value
    return changed


def numbers_of(value: Any, key: str = "") -> Iterator[tuple[str, float]]:
    """All numbers within `value`, each with its full key.

    `key` is the key of `value` itself, with which the full keys begin.
    """
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from numbers_of(inner, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for i, inner in enumerate(value, start=1):
            if isinstance(inner, Mapping):
                yield from numbers_of(inner, f"{key}[{i}]")
            elif isinstance(inner, list):
                for j, entry in enumerate(inner, start=1):
                    if is_finite_number(entry):
                        yield f"{key}[{i},{j}]", entry
            elif is_finite_number(inner):
                yield f"{key}[{i}]", inner
    elif is_finite_number(value):
        yield key, value


def keys_named(tables: Mapping[str, Any], names: Collection[str]) -> list[str]:
    """Full keys of numbers and matrices in the tables whose last part is one of `names`.

    If a table within an entry has one of these names, as in `joints.a.stiffness`, the keys of all
    numbers in this table are included.
    """
    keys = dict.fromkeys(key.partition("[")[0] for key, _ in numbers_of(tables))
    parts = {key: key.split(".") for key in keys}
    return [key for key in keys if not {parts[key][-1], *parts[key][2:]}.isdisjoint(names)]


def unit_of(tables: Mapping[str, Any], key: str) -> str:
    """Unit of the number at a key of tables without faults. "" if it has no unit."""
    steps = _steps(key)
    indices = [step for step in steps if isinstance(step, int)]
    names = [step for step in steps if isinstance(step, str)]
    rules = {rule_key: rule for rule_key, rule, _ in rules_of(tables).within(tables, "")}
    rule = rules.get(key.strip(), rules.get(key.strip().rpartition("[")[0]))
    while isinstance(rule, Several):
        rule = rule.kind
    if isinstance(rule, SquareMatrix) and rule.compliance:
        return _UNITS_OF_COMPLIANCE[sum(index >= 3 for index in indices)]
    unit = rule.unit if isinstance(rule, Number | SquareMatrix) else ""
    if names[0] == "path" and indices:
        # In a list of poses the second index is that of the coordinate.
        move: str = tables["tool"]["moves"][indices[-1]]
        return length_unit_of(tables).name if move in LENGTHS else "rad"
    if names[0] == "joints":
        first, _, second = unit.partition(" or ")
        return second if second and tables["joints"][names[1]]["type"] == "revolute" else first
    return unit


def _steps(key: str) -> list[str | int]:
    """Parts of a full key: names and indices (from 0), from the outermost table inwards."""
    if _KEY.fullmatch(key.strip()) is None:
        raise LookupError(key)
    steps: list[str | int] = []
    for name, indices in _STEP.findall(key):
        steps.append(name)
        steps += [int(index) - 1 for index in indices.split(",") if index]
    return steps


def _holder(tables: Mapping[str, Any], key: str) -> tuple[Any, Any]:
    """Table or row that contains the value at `key`, and the value's key or index in it."""
    *path, last = _steps(key)
    holder: Any = tables
    try:
        for step in path:
            holder = holder[step]
        holder[last]
    except (LookupError, TypeError):
        raise LookupError(key) from None
    return holder, last
