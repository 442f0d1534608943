"""Malformed, oversized and special files are refused at once with few short lines."""

import math
import os
import random
import resource
import tomllib
from contextlib import suppress
from datetime import date
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest
from support.random.mutated_robots import places, toml
from support.robots.single_arm import ONE_ARM
from support.robots.valid_biglide import SOUND

from lumped.errors import InputError
from lumped.files import read_ordinary
from lumped.robot_file import load_robot
from lumped.robot_file.evidence import read_measured
from lumped.robot_file.load import described_by
from lumped.text import shown
from meshes.part.reading.read import require_file
from validation import cli
from validation.run.records import load_run

ARM = tomllib.loads(ONE_ARM)
LEG2_MATRIX = SOUND[SOUND.rindex("compliance = [") :]
DISTANCE = "a = 0.9\n"
MANY_DIGITS = "9" * 100_000
# Control characters, marks that reverse the reading direction, and characters without width.
INVISIBLE = "\\u001b[2J\\u202e\\u2066\\u200b\\r\\n\\u0007\\ufeff"
CORRECTION = '[[corrections]]\nkey = "{}"\nprinted = 1.0\nused = 2.0\nreason = "r"\n'


def with_matrix(rows, columns, value="1e-9"):
    row = f"[{', '.join([value] * columns)}]"
    return SOUND.replace(LEG2_MATRIX, f"compliance = [{', '.join([row] * rows)}]\n")


def with_keys(count, line):
    return SOUND.replace(DISTANCE, DISTANCE + "".join(line.format(i) for i in range(count)))


HOSTILE = (
    "",
    "#" * 1_000_000,
    '{"schema": 1, "name": "json"}',
    "\N{BYTE ORDER MARK}" * 2 + SOUND,
    SOUND[: SOUND.rindex("[0.0, 3.0e-8")],
    random.Random(20).randbytes(100_000) + b"\xff",  # noqa: S311  any bytes will do
    *(SOUND[:99].encode() + broken + SOUND[99:].encode() for broken in (b"\x00", b"\xc0\x80")),
    with_keys(1, f'"{"xyz-" * 2000}{INVISIBLE}" = []\n'),
    with_keys(20_000, "lenght{0} = {0}\n"),
    SOUND.replace("test robot", INVISIBLE + "\\u0001" * 200),
    SOUND.replace('"test robot"', r'"\u0000"'),
    *(f"a = {opened * 100_000}" for opened in ("[", "{a=", "a.")),
    f"[{'a.' * 100_000}a]",
    SOUND + "a." * 100_000 + "a = 1",
    SOUND + f"x = {'[' * 1000}{']' * 1000}",
    *(with_matrix(rows, columns) for rows, columns in ((0, 0), (6, 5), (300, 300))),
    with_matrix(6, 6, "nan"),
    *(
        SOUND.replace("0.85", length, 1)
        for length in (
            *(MANY_DIGITS, f"0x{MANY_DIGITS}", f"{MANY_DIGITS}.0", f"1e{MANY_DIGITS}"),
            *('"' + '\\"' * 50_000, '"""' * 1001 + '"', "[" * 50),
        )
    ),
    SOUND + CORRECTION.format("leg2.weight") * 2000,
    SOUND + CORRECTION.format("x" * 10_000 + "\\u202e"),
)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "robot.toml"


@pytest.fixture
def little_memory():
    """Limit the address space to 1 GB more than is in use, twice the need of every command."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + 1_000_000_000, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.usefixtures("little_memory")
def test_malformed_file_is_refused(path, capsys):
    """Binary, nested, huge or cut texts: `check` prints short lines, with exit code 2."""
    for content in HOSTILE:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        code = cli.main(["check", str(path)])
        printed = capsys.readouterr()
        lines = printed.err.splitlines()
        assert (code, printed.out, 0 < len(lines) <= 50) == (2, "", True), content[:100]
        for line in lines:
            assert line.startswith(f"flexproof: {path}: "), content[:100]
            assert len(line) < 400 + len(str(path)), content[:100]
            assert line.isprintable(), content[:100]


ODD_VALUES = (
    *(math.nan, -math.inf, -1, 0, 1e308, True, "x", "", [], {}, [[]], [1], [[1, 2], [3]], [{}]),
    *({"shape": []}, {"E": {}}, date(2020, 1, 1), 10**400),
)


@pytest.mark.parametrize("value", ODD_VALUES, ids=lambda value: str(value)[:9])
def test_malformed_value_is_refused(value):
    """Each key of a valid file gets a value of another kind. At most three keys accept it."""
    key_paths = [
        key_path for key_path in places(tomllib.loads(SOUND)) if isinstance(key_path[-1], str)
    ]
    accepted = []
    for *tables, key in key_paths:
        robot = tomllib.loads(SOUND)
        reduce(getitem, tables, robot)[key] = value
        with suppress(InputError):
            described_by(robot, Path())
            accepted.append(key)
    # A text is a valid name or reason, and zero is a valid Poisson's ratio.
    assert len(accepted) <= 3, accepted


def faults_of(path, content):
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_robot(path)
    return [fault.removeprefix(f"{path}: ") for fault in error.value.faults]


def test_many_errors_are_counted_and_cut(path):
    """At most 50 lines and 150 characters of a value are printed."""
    faults = faults_of(path, with_keys(70, "lenght{} = 1\n"))
    assert (len(faults), faults[-1]) == (50, "and 21 more faults")
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = 0x{'f' * 9999}"))
    assert fault.startswith("geometry.a = a number of thousands of digits: must be at most 100 m")
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = {'9' * 4000}"))
    assert len(fault) < 150
    assert shown("x" * 10**7) == '"' + "x" * 58 + "…"


def repeated_key(key, count):
    (entry, *_) = ARM[key].values()
    return toml(ARM | {key: {f"N{number}": entry for number in range(count)}})


GRID = {"from": [0.0, 0.0], "to": [0.1, 0.1], "counts": [1000, 100]}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (repeated_key("points", 1001), "points: 1001 entries; must be at most 1000"),
        (repeated_key("bodies", 101), "bodies: 101 entries; must be at most 100"),
        (repeated_key("joints", 201), "joints: 201 entries; must be at most 200"),
        (
            toml(ARM | {"tool": ARM["tool"] | {"moves": ["x", "y"]}, "path": GRID}),
            "path.counts = [1000, 100]: 100000 entries; must be at most 10000",
        ),
        (
            toml(ARM | {"path": {"poses": [[0.0]] * 10_001}}),
            "path.poses: 10001 entries; must be at most 10000",
        ),
        (
            SOUND + CORRECTION.format("geometry.a") * 1001,
            "corrections: 1001 entries; must be at most 1000",
        ),
        (
            toml(ARM | {"bodies": {"part": {"step": "a\0b"}}}),
            "must be the name of a file, 1 to 1000",
        ),
        ("#" * 1_000_001, "is larger than 1 MB; must be a robot file"),
        ("[" + "a." * 101 + "a]", "a key of more than 100 parts"),
        # Dots in a comment and brackets in a text are no nesting.
        ("# " + "." * 200 + "\na = '" + "[" * 200 + "'", "schema: missing"),
    ],
    ids=lambda value: value[:20],
)
def test_oversized_file_is_refused(path, content, message):
    """Upper limits of points, bodies and other entries of a robot file."""
    assert any(message in fault for fault in faults_of(path, content))


READERS = {
    "robot.toml": load_robot,
    "measured.csv": read_measured,
    "results.json": load_run,
    "fork.step": require_file,
    "fork.brep": require_file,
    "fork.msh": require_file,
}


@pytest.mark.parametrize("name", READERS)
def test_pipe_link_or_device_is_refused(name, tmp_path):
    """Named pipe, dangling link, /dev/zero and 300 MB, for each reader of a file."""
    path = tmp_path / name

    def assert_refused(message):
        with pytest.raises(InputError, match=message):
            READERS[name](path)
        path.unlink()

    os.mkfifo(path)
    assert_refused("is a pipe; must be")
    path.symlink_to("nowhere")
    assert_refused(f"{name}: is a link to nowhere, which does not exist")
    if READERS[name] is not require_file:
        path.symlink_to("/dev/zero")
        assert_refused("is a device")
        with path.open("wb") as file:
            file.truncate(300_000_000)
        assert_refused("is larger than")


def test_file_of_largest_size_is_read(tmp_path):
    """One byte more is refused."""
    path = tmp_path / "file"
    path.write_bytes(b"x" * 100)
    assert read_ordinary(path, "a file", 100) == b"x" * 100
    with pytest.raises(InputError, match="is larger than"):
        read_ordinary(path, "a file", 99)
