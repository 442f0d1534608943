"""Unusual standard streams, limits set by the shell, and paths of result files."""

import errno
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from support.fakes.toy_runs import refusing

from fem.machine import available_memory
from lumped.errors import ComputationError, InputError
from lumped.text import visible
from validation import cli
from validation.console import streams
from validation.console.typed import require_writable, write

ROOT = Path(__file__).parents[3]
PROGRAM = "import sys; from validation.cli import main; sys.exit(main())"
SHELL = f'flexproof() {{ "{sys.executable}" -c "${{PROGRAM:-{PROGRAM}}}" "$@"; }}\n'
LOST = "the results cannot be written to the standard output:"


def shell(line, **environment):
    """Run a line of bash in which `flexproof` starts this source tree; return the process."""
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
    ("line", "code", "message"),
    [
        ("flexproof schema >&-", 3, f"{LOST} Bad file descriptor\n"),
        ("flexproof schema >&- 2>&- <&-", 3, ""),
        # Long results are written before the end.
        ("flexproof schema > /dev/full", 3, f"{LOST} No space left on device\n"),
        ("flexproof --hlep 2> /dev/full", 2, ""),
        # A reader that ends early has no effect.
        ("flexproof schema | head -1; exit ${PIPESTATUS[0]}", 0, ""),
        # Reported before libraries fail because they lack files or addresses.
        ("ulimit -n 8; flexproof faces x.step", 3, "the limit of open files (ulimit -n) is 8"),
        ("ulimit -v 350000; flexproof solve", 3, "the limit of the address space (ulimit -v) leav"),
        # The wrapping of help texts to 0 columns did not end before.
        ("COLUMNS=0 LC_ALL=C flexproof run --help", 0, ""),
        ("LC_ALL=C flexproof faces µ-é-中-α", 2, "u-e-\\u4e2d-alpha: not a part"),
        ("LC_ALL=C.UTF-8 flexproof faces µ-é-中-α", 2, "µ-é-中-α: not a part"),
    ],
)
def test_unusual_shell_gives_at_most_one_error_line(line, code, message):
    """Closed or full standard streams, small limits of files and memory, other encodings."""
    completed = shell(line)
    assert completed.returncode == code, completed.stderr
    assert completed.stdout.isascii()
    assert completed.stderr.startswith(message and f"flexproof: {message}")
    assert len(completed.stderr.splitlines()) == bool(message)


def test_unencodable_characters_are_replaced():
    """An ASCII terminal shows µ as u and ± as +-; control characters are shown as codes."""
    streams.prepare()
    text = "µ − ′ “” × · ± ≤ ≥ → ø § √ ∫ ° Φ ² é 中"
    plain = 'u - \' "" x * +- <= >= -> o section  sqrt  integral   deg Phi 2 e \\u4e2d'
    assert text.encode("ascii", "flexproof.plain").decode() == plain
    assert visible(text) == text
    assert visible("a\nb\tc\u2028d\udcffe", keep="\n") == "a\nb\\tc\\u2028d\\udcffe"


def test_refused_run_leaves_home_empty(tmp_path):
    """No cache and no settings of libraries are written."""
    home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": "", "MPLCONFIGDIR": ""}
    completed = shell("flexproof run five-bar --only nothing", **home)
    assert completed.returncode == 2, completed.stderr
    assert not list(tmp_path.iterdir())


def test_relative_home_is_replaced_for_one_run(monkeypatch):
    """The home folder is temporary: files that libraries write there are deleted at the end."""
    files = []
    monkeypatch.setattr(cli, "_run", lambda _: files.append(Path.home() / "x") or files[0].touch())
    monkeypatch.setenv("HOME", "odd home")
    cli.main([])
    assert os.environ["HOME"] == "odd home"
    assert files[0].is_absolute()
    assert not files[0].parent.exists()


def test_second_sigterm_has_no_effect():
    """A second SIGTERM arrives while the message "interrupted" is written."""
    program = """
import os, signal
from validation import cli
write, terminate = cli.write_messages, lambda *_: os.kill(os.getpid(), signal.SIGTERM)
cli._run, cli.write_messages = terminate, lambda *args: terminate() or write(*args)
raise SystemExit(cli.main())
"""
    completed = shell("flexproof", PROGRAM=program)
    assert (completed.returncode, completed.stderr) == (3, "flexproof: interrupted\n")


def test_address_space_limit_is_respected(monkeypatch):
    """A limit by `ulimit -v` counts as the available memory."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (used + 10**8, -1))
    assert 0.5e8 < available_memory() <= 1.1e8


TABLE = ("solve", "five-bar", "--model", "vjm", "--vary", "tool.mass=1:2:2", "--csv")
PICTURE = ("kinematics", "five-bar", "--picture")


@pytest.mark.parametrize("words", [TABLE, PICTURE], ids=["table", "picture"])
def test_file_of_other_kind_is_not_replaced(words, tmp_path, command):
    """A robot file as --csv or --picture, directly or by a link, stays unchanged."""
    robot = tmp_path / "robot.toml"
    command.output("new", "--type", "five-bar", robot)
    content = robot.read_bytes()
    # The ending of the target counts, not that of a link.
    links = [tmp_path / f"link{ending}" for ending in (".csv", ".png")]
    for link in links:
        link.symlink_to(robot)
    arguments = [robot if word == "five-bar" else word for word in words]
    for path, message in (
        (tmp_path, "cannot be written (is a folder); must be a file"),
        (robot / "table", f"cannot be written ({robot} is not a folder)"),
        *((file, "exists already and is not a .") for file in (robot, *links)),
    ):
        assert command.error_line(*arguments, path).startswith(f"flexproof: {path}: {message}")
    assert robot.read_bytes() == content


def test_missing_folders_are_created(tmp_path, capsys, monkeypatch):
    """Only when the file is written, not when its path is checked."""
    path = tmp_path / "new" / "deeper" / "table"
    require_writable(path, ".csv")
    assert not (tmp_path / "new").exists()
    write(path, b"x,y\n1,2\n", ".csv")
    assert path.read_bytes() == b"x,y\r\n1,2\n"
    assert capsys.readouterr().err == f"flexproof: {path} written\n"
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match=f"no write permission for {tmp_path}"):
        require_writable(tmp_path / "table", ".csv")


def test_failed_write_prints_results(tmp_path, capsys, command):
    """The computed table is printed although its file cannot be written."""
    # No file can be made there, which cannot be detected in advance.
    assert cli.main([*TABLE, "/proc/none/table"]) == 2
    printed = capsys.readouterr()
    assert "five-bar" in printed.out
    assert "flexproof: /proc/none/table: cannot be written" in printed.err
    # One file for two results is refused at once.
    path = tmp_path / "both"
    message = "given for two results; give a separate file for each"
    assert message in command.error_line(*TABLE, path, "--picture", path)


@pytest.mark.parametrize(
    "words",
    [
        "run five-bar --preset quick",
        "export five-bar --to npz",
        "solve five-bar --model simplified --vary tool.mass=1:2:2 --csv t.csv",
    ],
)
def test_deleted_folder_gives_one_error_line(words, tmp_path):
    folder = tmp_path / "gone"
    completed = shell(f"mkdir '{folder}'; cd '{folder}'; rmdir '{folder}'; flexproof {words}")
    message = "flexproof: the current folder no longer exists; change to another one (cd)\n"
    assert (completed.returncode, completed.stdout, completed.stderr) == (2, "", message)


@pytest.mark.parametrize("module", ["cyclopts", "fem.machine", "validation.export.command"])
def test_interrupted_import_is_one_line(module):
    """SIGINT arrives during an import, within the first third of a second."""
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
    completed = shell("flexproof schema", PROGRAM=program)
    assert (completed.returncode, completed.stdout, completed.stderr) == (
        3,
        "",
        "flexproof: interrupted\n",
    )


EXPORT = ("export", "five-bar", "--to", "npz", "--out")


@pytest.mark.parametrize(
    ("words", "name"), [(TABLE, "table.csv"), (EXPORT, "robot.npz")], ids=["table", "export"]
)
def test_full_disk_writes_no_files(words, name, tmp_path, monkeypatch, capsys):
    """A full disk is not a wrong input, which would have exit code 2."""
    monkeypatch.setattr("meshes.processes.in_own_process", lambda *_: b"content")
    monkeypatch.setattr(os, "fsync", refusing(errno.ENOSPC))
    path = tmp_path / name
    assert cli.main([*words, str(path)]) == 3
    *_, message = capsys.readouterr().err.splitlines()
    assert message == f"flexproof: {path}: cannot be written (No space left on device)"
    assert not list(tmp_path.iterdir())


def test_full_disk_writes_no_template(tmp_path):
    """A limit of the file size, in blocks of 1024 bytes, simulates a full disk."""
    path = tmp_path / "robot.toml"
    completed = shell(f"ulimit -f 1; flexproof new '{path}'")
    message = f"flexproof: {path}: cannot be written (File too large)\n"
    assert (completed.returncode, completed.stderr) == (3, message)
    assert not path.exists()


def test_output_link_is_not_followed(tmp_path):
    """The link is replaced by the result; the file that it pointed to stays unchanged."""
    foreign, link = tmp_path / "foreign.csv", tmp_path / "link.csv"
    foreign.write_bytes(b"mine")
    link.symlink_to(foreign)
    write(link, b"x\n1\n", ".csv")
    assert (foreign.read_bytes(), link.read_bytes()) == (b"mine", b"x\r\n1\n")
    assert not link.is_symlink()
    assert sorted(tmp_path.iterdir()) == [foreign, link]


def test_failed_write_keeps_the_earlier_file(tmp_path, monkeypatch):
    """The disk is full while the new file is written."""
    path = tmp_path / "table.csv"
    path.write_bytes(b"earlier")
    monkeypatch.setattr(os, "fsync", refusing(errno.ENOSPC))
    with pytest.raises(ComputationError, match="cannot be written"):
        write(path, b"x\n1\n", ".csv")
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]
