"""What is no robot file is refused at once and in few lines, whatever it holds."""

import math
import random
import resource
import tomllib
from contextlib import suppress
from datetime import date
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest
from mutated_robots import places, toml
from one_arm import ONE_ARM
from sound_biglide import SOUND

from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.text import shown
from validation import cli

LEG2_MATRIX = SOUND[SOUND.rindex("compliance = [") :]
DISTANCE = "a = 0.9\n"
MANY_DIGITS = "9" * 100_000
# Control characters, marks that turn the direction of reading, signs without width, half pairs.
UNSEEN = "\\u001b[2J\\u202e\\u2066\\u200b\\r\\n\\u0007\\ufeff"
WRONG_CORRECTION = '[[corrections]]\nkey = "{}"\nprinted = 1.0\nused = 2.0\nreason = "r"\n'


def with_matrix(rows: int, columns: int, value: str = "1e-9") -> str:
    row = f"[{', '.join([value] * columns)}]"
    return SOUND.replace(LEG2_MATRIX, f"compliance = [{', '.join([row] * rows)}]\n")


def with_length(text: str) -> str:
    return SOUND.replace("0.85", text, 1)


HOSTILE = {
    "empty": "",
    "a comment": "#" * 1_000_000,
    "JSON": '{"schema": 1, "name": "json"}',
    "two byte order marks": "\N{BYTE ORDER MARK}" * 2 + SOUND,
    "cut off": SOUND[: SOUND.rindex("[0.0, 3.0e-8")],
    "noise": random.Random(20).randbytes(100_000) + b"\xff",  # noqa: S311  any bytes will do
    **{
        f"bytes {broken!r}": SOUND[:99].encode() + broken + b"===" + SOUND[99:].encode()
        for broken in (b"\x00", b"\xc0\x80")
    },
    "a long unknown key": SOUND.replace(DISTANCE, f'{DISTANCE}"{"xyz-" * 2000}{UNSEEN}" = []\n'),
    "20 000 unknown keys": SOUND.replace(
        DISTANCE, "".join(f"lenght{i} = {i}\n" for i in range(20_000))
    ),
    "an unseen name": SOUND.replace("test robot", UNSEEN + "\\u0001" * 200),
    "no name": SOUND.replace('"test robot"', r'"\u0000"'),
    **{
        f"digits {number[:2]}…{number[-2:]}": with_length(number)
        for number in (MANY_DIGITS, f"0x{MANY_DIGITS}", f"{MANY_DIGITS}.0", f"1e{MANY_DIGITS}")
    },
    **{f"nested {opened}": f"a = {opened * 100_000}" for opened in ("[", "{a=", "a.")},
    "a deep table": f"[{'a.' * 100_000}a]",
    "a deep key": SOUND + "a." * 100_000 + "a = 1",
    "brackets that close": SOUND + f"x = {'[' * 1000}{']' * 1000}",
    **{
        f"matrix {rows}×{columns}": with_matrix(rows, columns)
        for rows, columns in ((0, 0), (6, 5), (300, 300))
    },
    "nothing but nan": with_matrix(6, 6, "nan"),
    **{
        f"unclosed {opened[:3]}": with_length(opened)
        for opened in ('"' + '\\"' * 50_000, '"""' * 1001 + '"', "[" * 50)
    },
    "2000 corrections": SOUND + WRONG_CORRECTION.format("leg2.weight") * 2000,
    "a long correction": SOUND + WRONG_CORRECTION.format("x" * 10_000 + "\\u202e"),
}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "robot.toml"


def write(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def faults_of(path, content):
    write(path, content)
    with pytest.raises(InputError) as error:
        load_robot(path)
    return [fault.removeprefix(f"{path}: ") for fault in error.value.faults]


def check(path, capsys, name) -> int:
    """Exit code of `flexproof check`; what it prints is sound, or few short lines of faults."""
    code = cli.main(["check", str(path)])
    printed = capsys.readouterr()
    lines = printed.err.splitlines()
    assert len(lines) <= 50, name
    for line in lines:
        assert line.startswith(f"flexproof: {path}: "), name
        assert len(line) < 400 + len(str(path)), name
        assert line.isprintable(), name
    assert (code, bool(lines), bool(printed.out)) in {(0, False, True), (2, True, False)}, name
    return code


@pytest.fixture
def little_memory():
    """A gigabyte more than is in use, twice what every command asks for."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + 1_000_000_000, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.usefixtures("little_memory")
def test_hostile_files_are_refused_in_few_short_lines(path, capsys):
    for name, content in HOSTILE.items():
        write(path, content)
        assert check(path, capsys, name) == 2, name


ODD_VALUES = (
    *(math.nan, -math.inf, -1, 0, 1e308, True, "x", "", [], {}, [[]], [1], [[1, 2], [3]], [{}]),
    *({"shape": []}, {"E": {}}, date(2020, 1, 1), 10**400),
)


@pytest.mark.parametrize("value", ODD_VALUES, ids=lambda value: str(value)[:9])
def test_an_odd_value_at_any_key_is_refused(value):
    ways = [way for way in places(tomllib.loads(SOUND)) if isinstance(way[-1], str)]
    taken = []
    for *tables, key in ways:
        robot = tomllib.loads(SOUND)
        reduce(getitem, tables, robot)[key] = value
        with suppress(InputError):
            described_by(robot, Path())
            taken.append(key)
    # Texts are fine names and reasons, zero is a fine Poisson's ratio.
    assert len(taken) <= 3, taken


def test_many_faults_are_counted_and_long_ones_cut(path):
    names = "".join(f"lenght{i} = 1\n" for i in range(70))
    faults = faults_of(path, SOUND.replace(DISTANCE, f"{DISTANCE}{names}"))
    assert len(faults) == 50
    assert faults[-1] == "and 21 more faults"
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = 0x{'f' * 9999}"))
    assert fault.startswith("geometry.a = a number of thousands of digits: must be at most 100 m")
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = {'9' * 4000}"))
    assert len(fault) < 150
    assert shown("x" * 10**7) == '"' + "x" * 58 + "…"


def larger_files():
    """Files of more than any robot has, and what is said of it."""
    robot = tomllib.loads(ONE_ARM)
    for key, most in (("points", 1000), ("bodies", 100), ("joints", 200)):
        (one, *_) = robot[key].values()
        many = {f"N{number}": one for number in range(most + 1)}
        yield toml(robot | {key: many}), f"{key}: {most + 1} entries; must be at most {most}"
    grid = {"from": [0.0, 0.0], "to": [0.1, 0.1], "counts": [1000, 100]}
    tool = robot["tool"] | {"moves": ["x", "y"]}
    said = "path.counts = [1000, 100]: 100000 entries; must be at most 10000"
    yield toml(robot | {"tool": tool, "path": grid}), said
    poses = {"poses": [[0.0]] * 10_001}
    yield toml(robot | {"path": poses}), "path.poses: 10001 entries; must be at most 10000"
    corrections = WRONG_CORRECTION.format("geometry.a") * 1001
    yield SOUND + corrections, "corrections: 1001 entries; must be at most 1000"
    part = {"part": {"step": "a\0b"}}
    yield toml(robot | {"bodies": robot["bodies"] | part}), "must be the name of a file, 1 to 1000"
    yield "#" * 1_000_001, "is larger than 1 MB; must be a robot file"


def test_what_is_larger_than_any_robot_is_refused_at_once(path):
    for content, said in larger_files():
        assert any(said in fault for fault in faults_of(path, content)), said


def test_what_only_looks_like_nesting_is_read(path):
    faults = faults_of(path, "# " + "." * 200 + "\na = '" + "[" * 200 + "'")
    assert any(fault.startswith("schema: missing") for fault in faults)
    (fault,) = faults_of(path, "[" + "a." * 101 + "a]")
    assert fault.startswith("a key of more than 100 parts")


def test_a_doubt_about_sound_data_stands_in_the_first_line(path, capsys):
    wrong_sign = SOUND.replace("0.0, 3.0e-8]", "0.0, -3.0e-8]").replace(
        "[0.0, 3.0e-8", "[0.0, -3.0e-8"
    )
    for text, said in ((wrong_sign, "sound in form, 1 doubt"), (SOUND, "sound")):
        path.write_text(text, encoding="utf-8")
        assert cli.main(["check", str(path)]) == 0
        assert capsys.readouterr().out.startswith(f"{path}: {said}; test robot")
