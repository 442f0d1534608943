"""A wrong robot file gets one line for each fault: key, value, unit, what is allowed.

faults.txt holds what is done to sound files, and what is said of it.
"""

import re
import tomllib
from functools import cache
from pathlib import Path

import pytest
from sound_biglide import SOUND

from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from validation import cli

TEXT = Path(__file__).with_name("faults.txt").read_text("utf-8").split("\n\n", 1)[1]
EYE = str([[(i == j) * (1e-6 if i < 3 else 1e-5) for j in range(6)] for i in range(6)])
CORRECTION = {"key": "leg2.mass", "printed": 94.0, "used": 49.0, "reason": "digits swapped"}
PLACE = re.compile(r"([^\[]+)(?:\[(\d)(?:,(\d))?\])?")


def wrong():
    """Of every row of the table: the robot, what is set, what is said."""
    for section in re.split(r"^(?=\[[\w -]+\]\n)", TEXT, flags=re.MULTILINE)[1:]:
        title, *rows = section.strip().split("\n\n")
        for row in rows:
            lines = row.split("\n")
            edits = [line for line in lines if not line.startswith(" ")]
            said = [line.strip() for line in lines if line.startswith(" ")]
            yield pytest.param(title[1:-1], edits, said, id=f"{title[1:-1]}-{edits[0]}")


@cache
def text_of(robot):
    return load_robot(robot).text


def sound(robot):
    if robot == "schema 1":
        return tomllib.loads(SOUND) | {"corrections": [CORRECTION]}
    return tomllib.loads(text_of(robot))


def edit(tables, line):
    """Set what `key = value` says in TOML, or leave out what `key =` names."""
    key, _, value = line.partition(" =")
    names, *indices = PLACE.fullmatch(key).groups()
    *path, last = [*names.split("."), *(int(index) - 1 for index in indices if index)]
    for step in path:
        tables = tables[step]
    if value:
        tables[last] = tomllib.loads(f"value = {value.replace('EYE', EYE)}")["value"]
    else:
        del tables[last]


def faults_of(tables):
    with pytest.raises(InputError) as refused:
        described_by(tables, Path())
    return refused.value.faults


@pytest.mark.parametrize(("robot", "edits", "said"), list(wrong()))
def test_each_fault_is_one_line_with_its_key_and_what_is_allowed(robot, edits, said):
    tables = sound(robot)
    for line in edits:
        edit(tables, line)
    faults = faults_of(tables)
    assert len(faults) == len(said), faults
    for line in said:
        assert any(fault.startswith(line) for fault in faults), (line, faults)
    assert not any("\n" in fault for fault in faults)


def test_the_command_names_the_file_in_every_line(tmp_path, capsys):
    path = tmp_path / "wrong.toml"
    path.write_text(SOUND.replace("46.0", "-1").replace("a = 0.9", "a = 900"), encoding="utf-8")
    assert cli.main(["check", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = [line.removeprefix(f"flexproof: {path}: ") for line in said.err.splitlines()]
    assert [line.split(" ")[0] for line in lines] == ["geometry.a", "platform.mass"]


def test_an_empty_file_names_every_missing_key():
    missing = {fault.split(": missing")[0] for fault in faults_of({})}
    keys = ("schema", "name", "type", "geometry", "platform", "actuators", "leg1", "leg2")
    assert missing == set(keys)
