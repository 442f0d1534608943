"""The command in a process of its own, with streams as shells and careless callers leave them."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from lumped.text import visible

ROOT = Path(__file__).parents[3]
PROGRAM = "import sys; from validation.cli import main; sys.exit(main())"
SHELL = f'flexproof() {{ "{sys.executable}" -c "{PROGRAM}" "$@"; }}\n'
FULL = Path("/dev/full")

needs_full = pytest.mark.skipif(not FULL.exists(), reason="no /dev/full here")


def shell(line, **environment):
    """What a line of bash gives: exit code, stdout, stderr; `flexproof` is this program."""
    return subprocess.run(
        ["bash", "-c", SHELL + line],  # noqa: S607  the shell that is there
        cwd=ROOT,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"} | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


FULL_DISK, CLOSED = "No space left on device", "Bad file descriptor"


@needs_full
@pytest.mark.parametrize(
    ("command", "streams_are", "code", "reason"),
    [
        ("schema", ">&-", 3, CLOSED),
        ("schema", ">&- 2>&- <&-", 3, ""),
        # Long results are written before the end.
        ("schema", "> /dev/full", 3, FULL_DISK),
        ("--hlep", "2> /dev/full", 2, ""),
    ],
)
def test_closed_and_full_streams_never_end_with_1_or_a_traceback(
    command, streams_are, code, reason
):
    done = shell(f"flexproof {command} {streams_are}")
    assert done.returncode == code
    assert "Traceback" not in done.stdout + done.stderr
    if reason:
        assert done.stderr == f"flexproof: the results cannot be written to stdout: {reason}\n"


def test_a_reader_that_leaves_early_changes_nothing():
    done = shell("flexproof schema | head -1; exit ${PIPESTATUS[0]}")
    assert (done.returncode, done.stderr) == (0, "")


def test_what_an_ascii_terminal_cannot_show_is_spelled_out():
    done = shell("flexproof solve ifw --model vjm", LC_ALL="C")
    assert done.returncode == 0, done.stderr
    assert "deflection (um) along a force of 1000 N:" in done.stdout
    assert "compliance 6x6" in done.stdout


def test_a_name_of_any_script_is_shown_as_the_terminal_can():
    both = "flexproof check no-such-robot-µ-é-中-α; LC_ALL=C flexproof check no-such-robot-µ-é-中-α"
    refused = shell(both, LC_ALL="C.UTF-8")
    assert refused.returncode == 2
    assert "no-such-robot-µ-é-中-α: no such file" in refused.stderr
    assert "no-such-robot-u-e-\\u4e2d-alpha: no such file" in refused.stderr


def test_too_few_open_files_are_said_before_libraries_fail_for_want_of_them():
    done = shell("ulimit -n 8; flexproof faces examples/rocker/rocker.step")
    assert (done.returncode, done.stdout) == (3, "")
    (line,) = done.stderr.splitlines()
    assert "the limit of open files (ulimit -n) is 8" in line


def test_too_little_address_space_is_said_before_libraries_fail_for_want_of_it():
    done = shell("ulimit -v 500000; flexproof solve ifw --model vjm")
    assert done.returncode == 3
    (line,) = done.stderr.splitlines()
    assert "the limit of the address space (ulimit -v) leaves" in line


def test_a_terminal_of_no_width_gets_its_help():
    # Without an end before: a line of no columns is never full.
    found = subprocess.run(
        [sys.executable, "-m", "validation.cli", "solve", "--help"],
        env={**os.environ, "COLUMNS": "0"},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert "Solve one model of the robot" in found.stdout


def test_a_refused_run_leaves_nothing_at_home(tmp_path):
    home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": "", "MPLCONFIGDIR": ""}
    done = shell("flexproof run five-bar --only nothing", **home)
    assert done.returncode == 2, done.stderr
    assert not list(tmp_path.iterdir())


def test_without_a_home_nothing_is_kept(tmp_path):
    """Of what libraries write at home nothing is left, wherever an odd one would lead."""
    home = {"HOME": "odd home", "XDG_CACHE_HOME": "", "MPLCONFIGDIR": "", "TMPDIR": str(tmp_path)}
    picture = tmp_path / "robot.png"
    done = shell(f"flexproof kinematics five-bar --picture {picture}", **home)
    assert done.returncode == 0, done.stderr
    assert not (ROOT / "odd home").exists()
    assert list(tmp_path.iterdir()) == [picture]


def test_a_second_sigterm_while_the_first_is_answered_changes_nothing():
    program = """
import os, signal
from validation import cli
said, terminate = cli.complain, lambda *_: os.kill(os.getpid(), signal.SIGTERM)
cli._run, cli.complain = terminate, lambda *told: terminate() or said(*told)
raise SystemExit(cli.main())
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (3, "flexproof: interrupted\n")


def test_a_limit_of_the_address_space_counts_as_available_memory():
    limited = (
        "import resource; from fem.machine import available_memory;"
        "resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9)); print(available_memory())"
    )
    done = subprocess.run(
        [sys.executable, "-c", limited], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert resource.getrlimit(resource.RLIMIT_AS)[0] != 10**9
    assert 0 < int(done.stdout) < 10**9


def test_visible_text_is_left_alone():
    assert visible("1 µm ≤ 3·10⁻⁶ m, Größe, 中") == "1 µm ≤ 3·10⁻⁶ m, Größe, 中"
    assert visible("a\nb\tc\u2028d\udcffe", keep="\n") == "a\nb\\tc\\u2028d\\udcffe"
