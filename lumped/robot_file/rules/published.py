"""JSON schema, list of keys and comments of a new robot file, made from the table of rules."""

import json
from collections.abc import Iterator, Mapping
from textwrap import wrap
from typing import Any

from lumped.mechanism.length_unit import LENGTH_UNITS, UnitOfLength
from lumped.robot_file.rules.rule import Either, Named, Rule, Several, TableRule
from lumped.robot_file.rules.tables.robots import BIGLIDE, MECHANISM, rules_of

_WIDTH = 100


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of robot files of both schemas, for editors."""
    in_metres, in_millimetres = map(_of_both_schemas, LENGTH_UNITS.values())
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "robot file of flexproof",
        "if": {"properties": {"units": {"const": "mm"}}, "required": ["units"]},
        "then": in_millimetres,
        "else": in_metres,
    }


def _of_both_schemas(unit: UnitOfLength) -> dict[str, Any]:
    return {
        "if": {"properties": {"schema": {"const": 1}}, "required": ["schema"]},
        "then": BIGLIDE.in_unit(unit, ()).schema,
        "else": MECHANISM.in_unit(unit, ()).schema,
    }


def key_table() -> str:
    """Table of all keys of schema 2 in Markdown."""
    rows = (f"| `{name}` | {allowed} | {meaning} |" for name, allowed, meaning in _lines(MECHANISM))
    return "\n".join(("| key | must be | meaning |", "|---|---|---|", *rows))


def key_comments(tables: Mapping[str, Any]) -> str:
    """List of all keys as TOML comments, for the end of a robot file.

    The keys are those of the schema of `tables`, the tables of the file.
    """
    rules = rules_of(tables)
    lines = ["# All keys, permitted values and meaning:"]
    for name, allowed, meaning in _lines(rules):
        lines += wrap(
            f"{name}: {allowed}; {meaning}", _WIDTH, initial_indent="# ", subsequent_indent="#     "
        )
    return "\n".join(lines) + "\n"


def _lines(rule: Rule, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Full name, allowed values and meaning of each key of a table and of its sub-tables.

    `path` precedes each name, such as "joints.NAME.".
    """
    match rule:
        case TableRule():
            for name, key in rule.keys.items():
                full_name = f"{path}.{name}" if path else name
                meaning = f"{' or '.join(key.owners)}: {key.meaning}" if key.owners else key.meaning
                if key.required:
                    meaning += "; required"
                elif key.default not in (None, (), {}):
                    meaning += f"; default {json.dumps(key.default)}"
                yield full_name, key.kind.allowed, meaning
                yield from _lines(key.kind, full_name)
        case Named():
            yield from _lines(rule.kind, f"{path}.NAME")
        case Several():
            yield from _lines(rule.kind, path)
        case Either():
            yield from _lines(rule.second, path)
