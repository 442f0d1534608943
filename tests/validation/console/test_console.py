"""Streams as shells and careless callers leave them, and files that a user names for results."""

import errno
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from toy_runs import refusing

from fem.machine import available_memory
from lumped.errors import ComputationError, InputError
from lumped.text import visible
from validation import cli
from validation.console import streams
from validation.console.typed import require_place, write

ROOT = Path(__file__).parents[3]
PROGRAM = "import sys; from validation.cli import main; sys.exit(main())"
SHELL = f'flexproof() {{ "{sys.executable}" -c "${{PROGRAM:-{PROGRAM}}}" "$@"; }}\n'
LOST = "the results cannot be written to stdout:"


def shell(line, **environment):
    """What a line of bash gives: exit code, stdout, stderr; `flexproof` is this program."""
    return subprocess.run(
        ["bash", "-c", SHELL + line],  # noqa: S607  the shell that is there
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("flexproof schema >&-", 3, f"{LOST} Bad file descriptor\n"),
        ("flexproof schema >&- 2>&- <&-", 3, ""),
        # Long results are written before the end.
        ("flexproof schema > /dev/full", 3, f"{LOST} No space left on device\n"),
        ("flexproof --hlep 2> /dev/full", 2, ""),
        # A reader that leaves early changes nothing.
        ("flexproof schema | head -1; exit ${PIPESTATUS[0]}", 0, ""),
        # Said before libraries fail for want of files or addresses.
        ("ulimit -n 8; flexproof faces x.step", 3, "the limit of open files (ulimit -n) is 8"),
        ("ulimit -v 500000; flexproof solve", 3, "the limit of the address space (ulimit -v) leav"),
        # A line of no columns is never full: without an end before.
        ("COLUMNS=0 LC_ALL=C flexproof run --help", 0, ""),
        ("LC_ALL=C flexproof faces µ-é-中-α", 2, "u-e-\\u4e2d-alpha: not a part"),
        ("LC_ALL=C.UTF-8 flexproof faces µ-é-中-α", 2, "µ-é-中-α: not a part"),
    ],
)
def test_odd_streams_and_limits_end_with_a_code_and_at_most_one_line(line, code, said):
    done = shell(line)
    assert done.returncode == code, done.stderr
    assert done.stdout.isascii()
    assert done.stderr.startswith(said and f"flexproof: {said}")
    assert len(done.stderr.splitlines()) == bool(said)


def test_what_cannot_be_shown_is_spelled_out_and_what_can_is_left_alone():
    streams.prepare()
    said = "µ − ′ “” × · ± ≤ ≥ → ø § √ ∫ ° Φ ² é 中"
    plain = 'u - \' "" x * +- <= >= -> o section  sqrt  integral   deg Phi 2 e \\u4e2d'
    assert said.encode("ascii", "flexproof.plain").decode() == plain
    assert visible(said) == said
    assert visible("a\nb\tc\u2028d\udcffe", keep="\n") == "a\nb\\tc\\u2028d\\udcffe"


def test_a_refused_run_leaves_nothing_at_home(tmp_path):
    home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": "", "MPLCONFIGDIR": ""}
    done = shell("flexproof run five-bar --only nothing", **home)
    assert done.returncode == 2, done.stderr
    assert not list(tmp_path.iterdir())


def test_without_a_home_nothing_is_kept(monkeypatch):
    """Of what libraries write at home nothing is left, wherever an odd one would lead."""
    kept = []
    monkeypatch.setattr(cli, "_run", lambda _: kept.append(Path.home() / "x") or kept[0].touch())
    monkeypatch.setenv("HOME", "odd home")
    cli.main([])
    assert os.environ["HOME"] == "odd home"
    assert kept[0].is_absolute()
    assert not kept[0].parent.exists()


def test_a_second_sigterm_while_the_first_is_answered_changes_nothing():
    program = """
import os, signal
from validation import cli
said, terminate = cli.complain, lambda *_: os.kill(os.getpid(), signal.SIGTERM)
cli._run, cli.complain = terminate, lambda *told: terminate() or said(*told)
raise SystemExit(cli.main())
"""
    done = shell("flexproof", PROGRAM=program)
    assert (done.returncode, done.stderr) == (3, "flexproof: interrupted\n")


def test_a_limit_of_the_address_space_counts_as_available_memory(monkeypatch):
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (taken + 10**8, -1))
    assert 0.5e8 < available_memory() <= 1.1e8


TABLE = ("solve", "five-bar", "--model", "vjm", "--vary", "tool.mass=1:2:2", "--csv")
PICTURE = ("kinematics", "five-bar", "--picture")


@pytest.mark.parametrize("words", [TABLE, PICTURE], ids=["table", "picture"])
def test_what_is_no_file_of_the_kind_is_left_alone(words, tmp_path, command):
    robot = tmp_path / "robot.toml"
    command.told("new", "--type", "five-bar", robot)
    content = robot.read_bytes()
    # A link whose name ends as that of a table leads to it all the same.
    links = [tmp_path / f"link{ending}" for ending in (".csv", ".png")]
    for link in links:
        link.symlink_to(robot)
    asked = [robot if one == "five-bar" else one for one in words]
    for path, said in (
        (tmp_path, "cannot be written (is a folder); must be a file"),
        (robot / "table", f"cannot be written ({robot} is no folder)"),
        *((one, "exists already, and only .") for one in (robot, *links)),
    ):
        assert command.refused(*asked, path).startswith(f"flexproof: {path}: {said}")
    assert robot.read_bytes() == content


def test_folders_that_lack_are_made_where_one_may_write(tmp_path, capsys, monkeypatch):
    path = tmp_path / "new" / "deeper" / "table"
    require_place(path, ".csv")
    assert not (tmp_path / "new").exists()
    write(path, b"x,y\n1,2\n", ".csv")
    assert path.read_bytes() == b"x,y\r\n1,2\n"
    assert capsys.readouterr().err == f"flexproof: {path} written\n"
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match=f"{tmp_path} is not yours to write to"):
        require_place(tmp_path / "table", ".csv")


def test_results_are_told_though_their_file_cannot_be_written(tmp_path, capsys, command):
    # Nobody can make a file there, which shows only when one is made.
    assert cli.main([*TABLE, "/proc/none/table"]) == 2
    printed = capsys.readouterr()
    assert "five-bar" in printed.out
    assert "flexproof: /proc/none/table: cannot be written" in printed.err
    # One file for two results is refused at once.
    path = tmp_path / "both"
    said = "is named for two results; each must have a file of its own"
    assert said in command.refused(*TABLE, path, "--picture", path)


@pytest.mark.parametrize(
    "words",
    [
        "run five-bar --preset quick",
        "export five-bar --to npz",
        "solve five-bar --model simplified --vary tool.mass=1:2:2 --csv t.csv",
    ],
)
def test_deleted_working_folder_is_said_in_one_line(words, tmp_path):
    place = tmp_path / "gone"
    done = shell(f"mkdir '{place}'; cd '{place}'; rmdir '{place}'; flexproof {words}")
    said = "flexproof: the folder that you are in exists no more; change to another one (cd)\n"
    assert (done.returncode, done.stdout, done.stderr) == (2, "", said)


@pytest.mark.parametrize("module", ["cyclopts", "fem.machine", "validation.export.command"])
def test_interrupt_while_modules_load_is_one_line(module):
    """As the signal comes within the first third of a second."""
    program = f"""
import os, signal, sys
class Interrupting:
    def find_spec(self, name, *_):
        if name == "{module}":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
from validation.entry.start import main
sys.exit(main())
"""
    done = shell("flexproof schema", PROGRAM=program)
    assert (done.returncode, done.stdout, done.stderr) == (3, "", "flexproof: interrupted\n")


EXPORT = ("export", "five-bar", "--to", "npz", "--out")


@pytest.mark.parametrize(
    ("words", "name"), [(TABLE, "table.csv"), (EXPORT, "robot.npz")], ids=["table", "export"]
)
def test_full_disk_ends_with_3_and_nothing_written(words, name, tmp_path, monkeypatch, capsys):
    """What is out of the user's hands is no wrong input."""
    monkeypatch.setattr("meshes.processes.in_own_process", lambda *_: b"content")
    monkeypatch.setattr(os, "fsync", refusing(errno.ENOSPC))
    path = tmp_path / name
    assert cli.main([*words, str(path)]) == 3
    *_, said = capsys.readouterr().err.splitlines()
    assert said == f"flexproof: {path}: cannot be written (No space left on device)"
    assert not list(tmp_path.iterdir())


def test_full_disk_leaves_no_half_template(tmp_path):
    """A limit of the size of files, in blocks of 1024 bytes, stands for a full disk."""
    path = tmp_path / "robot.toml"
    done = shell(f"ulimit -f 1; flexproof new '{path}'")
    said = f"flexproof: {path}: cannot be written (File too large)\n"
    assert (done.returncode, done.stderr) == (3, said)
    assert not path.exists()


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path):
    foreign, link = tmp_path / "foreign.csv", tmp_path / "link.csv"
    foreign.write_bytes(b"mine")
    link.symlink_to(foreign)
    write(link, b"x\n1\n", ".csv")
    assert (foreign.read_bytes(), link.read_bytes()) == (b"mine", b"x\r\n1\n")
    assert not link.is_symlink()
    assert sorted(tmp_path.iterdir()) == [foreign, link]


def test_what_cannot_be_written_whole_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "table.csv"
    path.write_bytes(b"earlier")
    monkeypatch.setattr(os, "fsync", refusing(errno.ENOSPC))
    with pytest.raises(ComputationError, match="cannot be written"):
        write(path, b"x\n1\n", ".csv")
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]
