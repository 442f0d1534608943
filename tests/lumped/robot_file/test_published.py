"""What others are told of the rules: JSON schema, the guide's list, comments of a new file."""

import re
import runpy
import tomllib
from functools import reduce
from math import inf
from operator import getitem
from pathlib import Path

import pytest
from mutated_robots import places
from sound_biglide import SOUND
from wrong_files import wrong_files

from lumped.robot_file import load_robot, write_template
from lumped.robot_file.rules.published import json_schema
from validation import cli

ROOT = Path(__file__).parents[3]
KINDS = {"object": dict, "array": list, "string": str, "number": int | float, "integer": int}
# What holds where a schema (draft 2020-12) does not say it, of the words that ours uses.
UNSAID = {"properties": {}, "required": (), "additionalProperties": True, "propertyNames": True}
UNSAID |= {"type": "object", "pattern": "", "maxProperties": inf, "minItems": 0, "maxItems": inf}
UNSAID |= {"minimum": -inf, "exclusiveMinimum": -inf, "maximum": inf, "exclusiveMaximum": inf}
SCHEMA = json_schema()


def valid(schema, value):
    """As the draft says, but for values of another kind than a word is about: never valid."""
    if isinstance(schema, bool):
        return schema
    said = UNSAID | schema
    if "if" in said:
        return valid(said["then" if valid(said["if"], value) else "else"], value)
    for word, most in (("anyOf", inf), ("oneOf", 1)):
        if word in said:
            return 1 <= sum(valid(one, value) for one in said[word]) <= most
    if "enum" in said or "const" in said:
        allowed = said.get("enum") or [said["const"]]
        return any(type(one) is type(value) and one == value for one in allowed)
    known = isinstance(value, KINDS[said["type"]]) and not isinstance(value, bool)
    return known and fits(said, value)


def fits(said, value):
    if isinstance(value, str):
        return re.search(said["pattern"], value) is not None
    if isinstance(value, list):
        counted = said["minItems"] <= len(value) <= said["maxItems"]
        return counted and all(valid(said["items"], one) for one in value)
    if isinstance(value, dict):
        kinds = {name: said["properties"].get(name, said["additionalProperties"]) for name in value}
        there = set(said["required"]) <= kinds.keys() and len(value) <= said["maxProperties"]
        named = there and all(valid(said["propertyNames"], name) for name in value)
        return named and all(valid(kinds[name], one) for name, one in value.items())
    within = said["minimum"] <= value <= said["maximum"]
    return within and said["exclusiveMinimum"] < value < said["exclusiveMaximum"]


def test_sound_files_are_valid():
    files = [*ROOT.glob("lumped/robots/*.toml"), *ROOT.glob("examples/*/*.toml")]
    texts = [SOUND, *(path.read_text("utf-8") for path in files)]
    assert len(texts) > 8
    for tables in map(tomllib.loads, texts):
        assert valid(SCHEMA, tables), tables["name"]


@pytest.mark.parametrize("robot", ["five-bar", "biglide"])
def test_a_key_lost_misspelt_or_of_another_kind_is_not_valid(robot):
    text = load_robot(robot).text
    ways = [way for way in places(tomllib.loads(text)) if isinstance(way[-1], str)]
    for *tables, key in ways:
        misspelt, another = tomllib.loads(text), tomllib.loads(text)
        table = reduce(getitem, tables, misspelt)
        table[f"{key}z"] = table.pop(key)
        # Whoever chose the name may choose another.
        named = bool(tables) and tables[-1] in {"points", "materials", "bodies", "joints"}
        assert valid(SCHEMA, misspelt) == named, (tables, key)
        reduce(getitem, tables, another)[key] = None
        assert not valid(SCHEMA, another), (tables, key)


def test_what_is_wrong_by_itself_is_not_valid():
    """Most of the rest is what keys must say together, of which no schema knows."""
    assert sum(not valid(SCHEMA, wrong.tables()) for wrong in wrong_files()) == 68


def test_the_guide_lists_the_keys_of_the_rules():
    script = runpy.run_path(str(ROOT / "docs" / "pictures" / "keys.py"))
    page = script["PAGE"].read_text("utf-8")
    assert script["renewed"](page) == page, "renew it: python docs/pictures/keys.py"


@pytest.mark.parametrize(
    ("robot", "keys"),
    [("biglide", ("leg1.section", "foot.compliance")), ("delta", ("bodies.NAME.up",))],
)
def test_a_new_file_is_the_robot_and_names_every_key(robot, keys, tmp_path):
    path = tmp_path / "new.toml"
    write_template(path, robot)
    text = path.read_text("utf-8")
    assert tomllib.loads(text) == load_robot(robot).tables
    assert all(f"\n# {key}: " in text for key in keys)


def test_the_command_prints_it(capsys):
    assert cli.main(["schema"]) == 0
    assert '"https://json-schema.org/draft/2020-12/schema"' in capsys.readouterr().out
