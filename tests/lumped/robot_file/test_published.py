"""What others are told of the rules: JSON schema, the guide's list, comments of a new file."""

import re
import runpy
import tomllib
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest
from mutated_robots import places
from sound_biglide import SOUND
from wrong_files import wrong_files

from lumped.robot_file import built_in_robots, load_robot, write_template
from lumped.robot_file.rules.published import json_schema
from validation import cli

ROOT = Path(__file__).parents[3]
KINDS = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    "number": lambda value: isinstance(value, int | float) and not isinstance(value, bool),
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "boolean": lambda value: isinstance(value, bool),
}
# The words of JSON schema (draft 2020-12, validation vocabulary) that ours uses, as the draft says.
WORDS = {
    "type": lambda word, value, _: KINDS[word](value),
    "enum": lambda word, value, _: any(type(one) is type(value) and one == value for one in word),
    "const": lambda word, value, _: word == value,
    "minimum": lambda word, value, _: value >= word,
    "maximum": lambda word, value, _: value <= word,
    "exclusiveMinimum": lambda word, value, _: value > word,
    "exclusiveMaximum": lambda word, value, _: value < word,
    "pattern": lambda word, value, _: re.search(word, value) is not None,
    "minItems": lambda word, value, _: len(value) >= word,
    "maxItems": lambda word, value, _: len(value) <= word,
    "items": lambda word, value, _: all(valid(word, one) for one in value),
    "required": lambda word, value, _: all(name in value for name in word),
    "properties": lambda word, value, _: all(
        valid(word[name], one) for name, one in value.items() if name in word
    ),
    "maxProperties": lambda word, value, _: len(value) <= word,
    "propertyNames": lambda word, value, _: all(valid(word, name) for name in value),
    "additionalProperties": lambda word, value, schema: all(
        word and valid(word, one)
        for name, one in value.items()
        if name not in schema.get("properties", {})
    ),
    "anyOf": lambda word, value, _: any(valid(one, value) for one in word),
    "oneOf": lambda word, value, _: sum(valid(one, value) for one in word) == 1,
    "if": lambda word, value, schema: valid(
        schema["then" if valid(word, value) else "else"], value
    ),
}
SCHEMA = json_schema()
SAID = {"$schema", "title", "description", "default", "then", "else"}


def valid(schema, value):
    assert schema.keys() <= WORDS.keys() | SAID
    # A word of another kind of value is not asked: the type comes first and decides.
    return ("type" not in schema or KINDS[schema["type"]](value)) and all(
        WORDS[name](word, value, schema) for name, word in schema.items() if name in WORDS
    )


def test_sound_files_are_valid():
    robots = [load_robot(name).tables for name in built_in_robots()]
    robots += [tomllib.loads(path.read_text("utf-8")) for path in ROOT.glob("examples/*/*.toml")]
    assert len(robots) > 7
    for tables in (*robots, tomllib.loads(SOUND)):
        assert valid(SCHEMA, tables), tables["name"]


@pytest.mark.parametrize("robot", ["five-bar", "biglide"])
def test_a_key_lost_misspelt_or_of_another_kind_is_not_valid(robot):
    text = load_robot(robot).text
    ways = [way for way in places(tomllib.loads(text)) if isinstance(way[-1], str)]
    for *tables, key in ways:
        named = bool(tables) and tables[-1] in {"points", "materials", "bodies", "joints"}
        for change in ("misspelt", "another kind"):
            changed = tomllib.loads(text)
            table = reduce(getitem, tables, changed)
            if change == "misspelt":
                table[f"{key}z"] = table.pop(key)
            else:
                table[key] = None
            sound = named and change == "misspelt"
            assert valid(SCHEMA, changed) == sound, (tables, key, change)


def test_what_is_wrong_by_itself_is_not_valid():
    """Most of the rest is what keys must say together, of which no schema knows."""
    assert sum(not valid(SCHEMA, wrong.tables()) for wrong in wrong_files()) >= 60


def test_the_guide_lists_the_keys_of_the_rules():
    script = runpy.run_path(str(ROOT / "docs" / "pictures" / "keys.py"))
    page = script["PAGE"].read_text("utf-8")
    assert script["renewed"](page) == page, "renew it: python docs/pictures/keys.py"


@pytest.mark.parametrize("robot", ["biglide", "delta"])
def test_a_new_file_is_the_robot_and_names_every_key(robot, tmp_path):
    path = tmp_path / "new.toml"
    write_template(path, robot)
    text = path.read_text("utf-8")
    assert tomllib.loads(text) == load_robot(robot).tables
    for key in {"biglide": ("leg1.section", "foot.compliance"), "delta": ("bodies.NAME.up",)}[
        robot
    ]:
        assert f"\n# {key}: " in text


def test_the_command_prints_it(capsys):
    assert cli.main(["schema"]) == 0
    assert '"https://json-schema.org/draft/2020-12/schema"' in capsys.readouterr().out
