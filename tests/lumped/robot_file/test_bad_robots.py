"""What is no robot file is refused at once and in few lines, whatever it holds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.text import shown
from validation import cli

sys.path.insert(0, str(Path(__file__).parent))
from bad_robots import KINDS, SOUND, bad_robots
from mutated_mechanisms import mutated_mechanisms

ROOT = Path(__file__).parents[3]
SEED = 20
COUNT, MORE = 334, 1000
FEW_MECHANISMS, MECHANISMS = 30, 1500
# "exit code, seconds of computing, bytes at the height" of a command, on its last line.
MEASURED = """
import resource, subprocess, sys
check = [sys.executable, "-m", "validation.cli", "check", sys.argv[1]]
done = subprocess.run(check, capture_output=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(done.stderr.decode())
print(done.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024)
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "robot.toml"


def faults_of(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as error:
        load_robot(path)
    return [fault.removeprefix(f"{path}: ") for fault in error.value.faults]


def test_the_file_that_all_others_come_from_is_sound(path):
    path.write_text(SOUND, encoding="utf-8")
    assert load_robot(path).robot.a == 0.9


@pytest.mark.parametrize("part", range(2))
def test_each_of_many_generated_files_is_refused_in_few_short_lines(part, path, capsys):
    for number, (kind, content) in enumerate(bad_robots(COUNT, SEED)):
        if number % 2 != part:
            continue
        path.write_bytes(content)
        assert cli.main(["check", str(path)]) == 2, (number, kind)
        printed = capsys.readouterr()
        lines = printed.err.splitlines()
        assert printed.out == ""
        assert 1 <= len(lines) <= 50, (number, kind)
        for line in lines:
            assert line.startswith(f"flexproof: {path}: "), (number, kind)
            assert len(line) < 400 + len(str(path)), (number, kind)
            assert line.isprintable()
            assert "Traceback" not in line


def check_mechanisms(count, path, capsys):
    """Sound still, or refused like the others; some of every few are either."""
    codes = []
    for number, text in enumerate(mutated_mechanisms(count, SEED)):
        path.write_text(text, encoding="utf-8")
        codes.append(cli.main(["check", str(path)]))
        printed = capsys.readouterr()
        lines = printed.err.splitlines()
        assert len(lines) <= 50, number
        for line in lines:
            assert line.startswith(f"flexproof: {path}: "), number
            assert len(line) < 400 + len(str(path)), number
            assert line.isprintable(), number
        assert bool(printed.out) is (codes[-1] == 0), number
    assert set(codes) == {0, 2}


def test_whatever_is_done_to_a_mechanism_s_file_is_sound_or_refused(path, capsys):
    check_mechanisms(FEW_MECHANISMS, path, capsys)


@pytest.mark.soak
def test_whatever_is_done_to_many_files_of_mechanisms_is_sound_or_refused(path, capsys):
    check_mechanisms(MECHANISMS, path, capsys)


def measured(path, content):
    path.write_bytes(content)
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, str(path)],
        cwd=ROOT,
        env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    *said, last = done.stdout.splitlines()
    code, seconds, size = last.split()
    return "\n".join(said), int(code), float(seconds), int(size)


def assert_refused_cheaply(path, kind, content):
    """Seconds of computing and bytes that it took."""
    said, code, seconds, size = measured(path, content)
    assert code == 2, (kind, said[:500])
    assert "Traceback" not in said
    assert size < 200e6, kind
    return seconds, size


# A process each: the largest ones first, all with the random sets.
HEAVY = {"_nested", "_matrix", "_noise", "_digits"}


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(
            number,
            id=kind.__name__,
            marks=() if kind.__name__ in HEAVY else pytest.mark.exhaustive,
        )
        for number, kind in enumerate(KINDS)
    ],
)
def test_a_file_of_each_kind_takes_little_memory_in_a_process_of_its_own(number, path):
    kind, content = list(bad_robots(len(KINDS), SEED + 1))[number]
    assert_refused_cheaply(path, kind, content)


@pytest.mark.exhaustive
def test_all_generated_files_are_refused(path, capsys):
    for number, (kind, content) in enumerate(bad_robots(COUNT + MORE, SEED)):
        path.write_bytes(content)
        assert cli.main(["check", str(path)]) == 2, (number, kind)
        assert "Traceback" not in capsys.readouterr().err, (number, kind)


@pytest.mark.soak
def test_all_generated_files_in_processes_of_their_own(path):
    """With -s it says what the worst of them took."""
    took = [assert_refused_cheaply(path, *one) for one in bad_robots(COUNT + MORE, SEED)]
    seconds, size = map(max, zip(*took, strict=True))
    sys.stdout.write(f"{len(took)} files, at most {seconds:.2f} s, {size / 1e6:.0f} MB each\n")


def test_faults_beyond_fifty_lines_are_counted(path):
    names = "".join(f"lenght{i} = 1\n" for i in range(70))
    faults = faults_of(path, SOUND.replace("a = 0.9\n", f"a = 0.9\n{names}"))
    assert len(faults) == 50
    assert faults[-1] == "and 21 more faults"


def test_long_keys_numbers_and_texts_are_cut(path):
    (fault,) = faults_of(path, SOUND.replace("a = 0.9\n", f"a = 0.9\n{'k' * 9999} = 1\n"))
    assert fault.startswith("geometry.kkk")
    assert len(fault) < 120
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = 0x{'f' * 9999}"))
    assert fault.startswith("geometry.a = a number of thousands of digits: must be at most 100 m")
    (fault,) = faults_of(path, SOUND.replace("a = 0.9", f"a = {'9' * 4000}"))
    assert len(fault) < 150
    assert shown("x" * 10**7) == '"' + "x" * 58 + "…"


def test_control_and_bidirectional_characters_are_written_out(path):
    hostile = SOUND.replace("a = 0.9\n", 'a = 0.9\n"\\u001b[2J\\u202e\\u200b" = 1\n')
    (fault,) = faults_of(path, hostile)
    assert fault.startswith("geometry.\\x1b[2J\\u202e\\u200b: unknown key")
    named = path.with_name("\u202elmot.toml")
    named.write_text("", encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_robot(named)
    assert all("\\u202elmot.toml: " in fault for fault in error.value.faults)


def test_a_name_that_turns_the_terminal_around_is_shown_written_out(path, capsys):
    path.write_text(SOUND.replace("test robot", "a\\u202eb"), encoding="utf-8")
    assert cli.main(["check", str(path)]) == 0
    assert f"{path}: sound; a\\u202eb, all 9 poses" in capsys.readouterr().out


def test_large_files_pipes_and_devices_are_refused_before_they_are_read(path):
    with path.open("wb") as file:
        file.truncate(10_000_001)
    with pytest.raises(InputError, match="is larger than 10 MB; must be a robot file"):
        load_robot(path)
    pipe = path.with_name("pipe.toml")
    os.mkfifo(pipe)
    # Opened, it would wait for someone to write.
    with pytest.raises(InputError, match="is a pipe, socket or device; must be a robot file"):
        load_robot(pipe)
    for device in ("/dev/zero", "/dev/null", "/dev/tty"):
        if Path(device).exists():
            with pytest.raises(InputError, match=f"{device}: is a pipe, socket or device"):
                load_robot(device)


@pytest.mark.parametrize(
    "text",
    [
        "a = " + "[" * 101,
        "a = 1\nb = " + "{ a = " * 101,
        "a." * 101 + "a = 1",
        "[" + "a." * 101 + "a]",
        'a = "[[["\nb = ' + "[" * 101 + "# ]",
    ],
)
def test_nesting_beyond_a_hundred_is_refused_before_it_is_parsed(path, text):
    (fault,) = faults_of(path, text)
    assert fault.endswith("is nested more than 100 deep; not a robot file")


@pytest.mark.parametrize(
    "text",
    ["a = '" + "[" * 200 + "'", "# " + "[" * 200, 'a = """' + "{" * 200 + '\n."""', "a = [" * 9],
)
def test_brackets_in_texts_and_comments_do_not_nest(path, text):
    assert not any("nested" in fault for fault in faults_of(path, text))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("thickness = 0.008", "thickness = 1e-300", "thickness = 1e-300: must be at least 1e-06 m"),
        ("[[1.0e-10", "[[5e-324", "foot.compliance[1,1] = 5e-324: must be at least 1e-15 m/N"),
        ("mass = 46.0", "mass = 5e-324", "platform.mass = 5e-324: must be at least 1e-09 kg"),
        ("length = 0.85", "length = 1e-300", "leg1.length = 1e-300: must be at least 0.0001 m"),
    ],
)
def test_numbers_that_only_a_slip_can_make_are_outside_the_bounds(path, old, new, said):
    text = SOUND.replace("[\n    [", "[[")
    assert text.count(old)
    assert any(said in fault for fault in faults_of(path, text.replace(old, new, 1)))


def test_a_stiffness_matrix_gets_one_line_with_the_guess(path):
    contents = [content for kind, content in bad_robots(200, SEED) if kind == "stiffness"]
    assert len(contents) > 5
    for content in contents:
        (fault,) = faults_of(path, content)
        assert fault.startswith("leg2.compliance: 6 of 6 entries on the diagonal are above 1 m/N")
        assert "is this a stiffness matrix?" in fault


def test_a_doubt_about_sound_data_stands_in_the_first_line(path, capsys):
    wrong_sign = SOUND.replace("0.0, 3.0e-8]", "0.0, -3.0e-8]").replace(
        "[0.0, 3.0e-8", "[0.0, -3.0e-8"
    )
    path.write_text(wrong_sign, encoding="utf-8")
    assert cli.main(["check", str(path)]) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert first.startswith(f"{path}: sound in form, 1 doubt; test robot")
    path.write_text(SOUND, encoding="utf-8")
    assert cli.main(["check", str(path)]) == 0
    assert capsys.readouterr().out.startswith(f"{path}: sound; test robot")


def test_a_position_beyond_the_stroke_is_told_by_how_much(path, capsys):
    path.write_text(SOUND, encoding="utf-8")
    assert cli.main(["solve", str(path), "--model", "simplified", "--x", "0.8500001"]) == 2
    said = capsys.readouterr().err
    assert "x = 0.8500001 m is outside the stroke 0.1 m to 0.85 m, by 1e-07 m" in said
