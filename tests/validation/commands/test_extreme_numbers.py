"""Each number of a robot file replaced by extreme ones: one error line, or finite results."""

import json
import math
import tomllib
import warnings
from copy import deepcopy

import pytest
from support.random.mutated_robots import places, toml
from support.robots.single_arm import LOADS, ONE_ARM
from support.robots.valid_biglide import SOUND

from validation import cli

# One number of three; all of them in the soak run.
SHARE = 3
ASKED = """
[damping]
ratio = 0.02
[[responses]]
name = "r"
direction = [0.0, 0.0, 1.0]
from = 1.0
to = 300.0
count = 20
at = 20.0
[[measured]]
quantity = "x"
value = 1e-6
uncertainty = 1e-8
source = "gauge"
pose = [0.4]
load = 10.0
[[input_uncertainty]]
key = "{key}"
relative = 0.01
"""
SPEED = """
[[loads]]
name = "fast"
speed = [0.5, 0.0, 0.0]
"""
PATH = "[path]\nposes = [[0.4]]\n"
DRIVE = "drive = { stiffness = 5.0e4, loss = 0.01, inertia = 1e-3, ratio = 10.0 }"
ROBOTS = {
    "biglide": SOUND + LOADS + SPEED + ASKED.format(key="leg1.length"),
    "arm": ONE_ARM.replace("drive = { stiffness = 5.0e4 }", DRIVE)
    + PATH
    + LOADS
    + SPEED
    + ASKED.format(key="bodies.arm.material.E"),
}
VALUES = (
    0,
    -1,
    1e-300,
    1e300,
    1e151,
    math.nan,
    math.inf,
    -0.0,
    10**400,
    True,
    "x",
    [],
    1e-12,
    1e12,
)
# Numbers of a matrix or vector are all read alike: the first two of each are enough.
ENOUGH = 2


def numbers(name):
    """Paths (keys and indices) to the numbers of a robot file, the first few of each table."""
    tree, counts, ways = tomllib.loads(ROBOTS[name]), {}, []
    for path in places(tree):
        value = tree
        for key in path:
            value = value[key]
        if isinstance(value, int | float) and not isinstance(value, bool):
            table = tuple(key for key in path if not isinstance(key, int))
            counts[table] = counts.get(table, 0) + 1
            ways += [path] if counts[table] <= ENOUGH else []
    return ways


def finite(constant):
    raise AssertionError(f"JSON has no {constant}")


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Function `written(name, key_path, value)`: writes robot.toml, with `value` at `key_path`."""
    monkeypatch.chdir(tmp_path)

    def write(name, key_path, value):
        tree = deepcopy(tomllib.loads(ROBOTS[name]))
        table = tree
        for key in key_path[:-1]:
            table = table[key]
        table[key_path[-1]] = value
        (tmp_path / "robot.toml").write_text(toml(tree), encoding="utf-8")

    return write


@pytest.mark.parametrize(
    ("name", "key_path"),
    [
        pytest.param(
            name,
            key_path,
            id=f"{name}-{key_path}",
            marks=pytest.mark.soak if index % SHARE else pytest.mark.exhaustive,
        )
        for name in ROBOTS
        for index, key_path in enumerate(numbers(name))
    ],
)
def test_extreme_number_is_refused_or_finite(name, key_path, written, capsys):
    """No traceback, no warning of NumPy, and no infinite number in JSON."""
    for value in VALUES:
        written(name, key_path, value)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            code = cli.main(["check", "robot.toml"])
            printed = capsys.readouterr()
            output = printed.err + printed.out
            assert "Traceback" not in output
            assert code in {0, 2}, (value, output)
            if code == 2:
                # Each line names file and key; a sound number beside it may be the wrong one.
                lines = printed.err.splitlines()
                assert all(line.startswith("flexproof: robot.toml: ") for line in lines), output
                assert len(lines) <= 5, output
                continue
            code = cli.main(["solve", "robot.toml", "--model", "beam", "--json"])
            printed = capsys.readouterr()
            assert "Traceback" not in printed.err
            assert code in {0, 2, 3}, (value, printed.err)
            if code == 0:
                json.loads(printed.out, parse_constant=finite)
            else:
                *_, line = printed.err.splitlines()
                assert line.startswith("flexproof: "), (value, printed.err)
