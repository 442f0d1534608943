"""Valid robot files with a changed or omitted key, and their error lines: invalid_files.txt."""

import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from support.robots.valid_biglide import SOUND

from lumped.robot_file import load_robot

TEXT = Path(__file__).with_name("invalid_files.txt").read_text("utf-8").split("\n\n", 1)[1]
EYE = str([[(i == j) * (1e-6 if i < 3 else 1e-5) for j in range(6)] for i in range(6)])
CORRECTION = {"key": "leg2.mass", "printed": 94.0, "used": 49.0, "reason": "digits swapped"}
PLACE = re.compile(r"([^\[]+)(?:\[(\d)(?:,(\d))?\])?")


class InvalidFile(NamedTuple):
    """Name of a valid file, lines `key = value` that change it, and the expected error lines."""

    robot: str
    edits: list[str]
    messages: list[str]

    def __str__(self) -> str:
        return f"{self.robot}-{self.edits[0]}"

    def tables(self) -> dict[str, Any]:
        """Tables of the file with all changes."""
        if self.robot == "schema 1":
            changed = tomllib.loads(SOUND) | {"corrections": [dict(CORRECTION)]}
        else:
            changed = tomllib.loads(_text_of(self.robot))
        for line in self.edits:
            _edit(changed, line)
        return changed


def invalid_files() -> Iterator[InvalidFile]:
    """All entries of invalid_files.txt."""
    for section in re.split(r"^(?=\[[\w -]+\]\n)", TEXT, flags=re.MULTILINE)[1:]:
        title, *rows = section.strip().split("\n\n")
        for row in rows:
            lines = row.split("\n")
            edits = [line for line in lines if not line.startswith(" ")]
            yield InvalidFile(title[1:-1], edits, [line.strip() for line in lines[len(edits) :]])


@cache
def _text_of(robot: str) -> str:
    return load_robot(robot).text


def _edit(tables: Any, line: str) -> None:
    """Apply the TOML line `key = value` to the tables. A line `key =` removes the key."""
    key, _, value = line.partition(" =")
    match = PLACE.fullmatch(key)
    assert match, line
    names, *indices = match.groups()
    *path, last = [*names.split("."), *(int(index) - 1 for index in indices if index)]
    for step in path:
        tables = tables[step]
    if value:
        tables[last] = tomllib.loads(f"value = {value.replace('EYE', EYE)}")["value"]
    else:
        del tables[last]
