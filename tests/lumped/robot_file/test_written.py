"""Robots written from dictionaries as TOML, and read back."""

import tomllib
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.robot_file import built_in_robots, load_robot, robot_of
from lumped.robot_file.written import toml_of

ODD = {
    "text": 'quote " backslash \\ tab \t line\nend \x7f ü',
    "key with blank": {"a.b": [1, 2.5, True, [], {}]},
    "numbers": [1e-300, -0.0, 3, 123456789.125],
}


def test_toml_text_round_trips():
    """Odd names, special characters and numbers: TOML text read back is unchanged."""
    assert tomllib.loads(toml_of(ODD)) == ODD


def test_arrays_and_paths_become_toml():
    """NumPy arrays, NumPy integers, tuples and `Path` objects."""
    written = toml_of({"c": np.eye(2), "n": np.int64(3), "t": (1.0, 2.0), "p": Path("a/b.step")})
    expected = {"c": [[1.0, 0.0], [0.0, 1.0]], "n": 3, "t": [1.0, 2.0], "p": "a/b.step"}
    assert tomllib.loads(written) == expected


@pytest.mark.parametrize("name", built_in_robots())
def test_dictionary_gives_same_robot(name):
    """All built-in robots, from their file and from a dictionary of their tables."""
    robot = load_robot(name)
    copy = robot_of(robot.tables)
    assert copy.tables == robot.tables
    assert copy.requirement == robot.requirement
    assert copy.mechanism.bodies.keys() == robot.mechanism.bodies.keys()
    assert np.array_equal(copy.mechanism.poses, robot.mechanism.poses)


def test_unsupported_value_is_reported():
    """None and `Decimal` have no TOML form; the key of each is named."""
    with pytest.raises(InputError) as error:
        robot_of({"a": None, "b": {"c": [1.0, Decimal(1)]}})
    assert [fault.partition(" = ")[0] for fault in error.value.faults] == [
        "dictionary: a",
        "dictionary: b.c[2]",
    ]


def test_dictionary_errors_equal_file_errors():
    """The word "dictionary" stands in place of the file's name."""
    with pytest.raises(InputError, match=r"dictionary: tool\.moves"):
        robot_of({**load_robot("five-bar").tables, "tool": {"body": "rod1", "point": "P"}})
