"""Places in a robot file by their keys, like "leg1.length" or "foot.compliance[6,6]" (from 1)."""

import re
from collections.abc import Collection, Mapping
from copy import deepcopy
from typing import Any

from lumped.mechanism.mechanism import UNITS_OF_MOVES
from lumped.robot_file.rules.matrices import SquareMatrix
from lumped.robot_file.rules.rule import Either, Named, Number, Rule, Several, TableRule, Text
from lumped.robot_file.rules.section_rule import SectionRule
from lumped.robot_file.rules.tables import rules_of

_KEY = re.compile(
    r"(?P<names>[\w-]+(?:\.[\w-]+)*)(?:\[(?P<indices>[1-9]\d*(?:\s*,\s*[1-9]\d*)?)\])?"
)
_UNITS_OF_COMPLIANCE = ("m/N", "rad/N", "rad/(N m)")


def value_at(tables: Mapping[str, Any], key: str) -> Any:
    """What stands at a key; raises LookupError where nothing does."""
    holder, last = _holder(tables, key)
    return holder[last]


def with_value(tables: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """The tables with something else at a key; raises LookupError where there is no such place."""
    changed = deepcopy(dict(tables))
    holder, last = _holder(changed, key)
    holder[last] = value
    return changed


def keys_named(tables: Mapping[str, Any], names: Collection[str], head: str = "") -> list[str]:
    """Keys of the numbers and matrices in the tables whose last part is one of `names`."""
    found = []
    for name, value in tables.items():
        key = f"{head}{name}"
        if isinstance(value, Mapping):
            found += keys_named(value, names, f"{key}.")
        elif name in names and not isinstance(value, str):
            found.append(key)
    return found


def unit_of(tables: Mapping[str, Any], key: str) -> str:
    """Unit of the number at a key of sound tables; "" where it has none."""
    names, indices = _steps(key)
    rule: Rule = rules_of(tables)
    for name in names:
        rule = _inside(rule, name)
    while isinstance(rule, Several | Either):
        rule = rule.kind if isinstance(rule, Several) else _of_numbers(rule)
    if isinstance(rule, SquareMatrix) and rule.compliance:
        return _UNITS_OF_COMPLIANCE[sum(index >= 3 for index in indices)]
    unit = rule.unit if isinstance(rule, Number | SquareMatrix) else ""
    if names[0] == "path" and indices:
        # A list of poses has the coordinate second.
        move: str = tables["tool"]["moves"][indices[-1]]
        return UNITS_OF_MOVES[move]
    if names[0] == "joints":
        first, _, second = unit.partition(" or ")
        return second if tables["joints"][names[1]]["type"] == "revolute" else first
    return unit


def _of_numbers(rule: Either) -> Rule:
    return rule.second if isinstance(rule.first, Text) else rule.first


def _inside(rule: Rule, name: str) -> Rule:
    """The rule of an entry of a table."""
    if isinstance(rule, Either):
        rule = _of_numbers(rule)
    if isinstance(rule, SectionRule):
        return Number("m")
    if isinstance(rule, Named):
        return rule.kind
    return rule.keys[name].kind if isinstance(rule, TableRule) else rule


def _steps(key: str) -> tuple[list[str], list[int]]:
    """Names of the tables that lead to a key, and indices (from 0) behind them."""
    match = _KEY.fullmatch(key.strip())
    if match is None:
        raise LookupError(key)
    indices = match["indices"].split(",") if match["indices"] else []
    return match["names"].split("."), [int(index) - 1 for index in indices]


def _holder(tables: Mapping[str, Any], key: str) -> tuple[Any, Any]:
    """The table or row that holds the value at `key`, and its key or index therein."""
    names, indices = _steps(key)
    steps: list[str | int] = [*names, *indices]
    *path, last = steps
    holder: Any = tables
    try:
        for step in path:
            holder = holder[step]
        holder[last]
    except (LookupError, TypeError):
        raise LookupError(key) from None
    return holder, last
