"""Files that a user names for results: refused at once, or written after the results are told."""

import resource
import signal

import pytest

from lumped.errors import InputError
from validation.cli import main
from validation.console.typed import require_place, write

COMMANDS = {
    "table": ["solve", "five-bar", "--model", "vjm", "--vary", "tool.mass=1:2:2", "--csv"],
    "picture": ["kinematics", "five-bar", "--picture"],
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS.keys())
def test_what_can_be_no_file_is_refused_before_anything_is_computed(command, tmp_path, capsys):
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    for path, reason in (
        (tmp_path, "is a folder"),
        (tmp_path / "file" / "table", f"{tmp_path / 'file'} is no folder"),
    ):
        assert main([*command, str(path)]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err == f"flexproof: {path}: cannot be written ({reason})" + (
            "; must be a file\n" if path == tmp_path else "\n"
        )
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"


def test_folders_that_lack_are_made_where_one_may_write(tmp_path, capsys, monkeypatch):
    path = tmp_path / "new" / "deeper" / "table"
    require_place(path, ".csv")
    assert not (tmp_path / "new").exists()
    write(path, b"content")
    assert path.read_bytes() == b"content"
    assert capsys.readouterr().err == f"flexproof: {path} written\n"
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match=f"{tmp_path} is not yours to write to"):
        require_place(tmp_path / "table", ".csv")


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS.keys())
def test_a_file_of_another_kind_is_left_alone(command, tmp_path, capsys):
    robot = tmp_path / "robot.toml"
    assert main(["new", "--type", "five-bar", str(robot)]) == 0
    content = robot.read_bytes()
    asked = [str(robot) if one == "five-bar" else one for one in command]
    # A link whose name ends as that of a table leads to it all the same.
    for ending in (".csv", ".png"):
        (tmp_path / f"link{ending}").symlink_to(robot)
    capsys.readouterr()
    for path in (robot, tmp_path / "link.csv", tmp_path / "link.png"):
        assert main([*asked, str(path)]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.startswith(f"flexproof: {path}: exists already, and only .")
    assert robot.read_bytes() == content


def test_results_are_told_though_their_file_cannot_be_written(tmp_path, capsys):
    # Nobody can make a file there, which shows only when one is made.
    assert main([*COMMANDS["table"], "/proc/none/table"]) == 2
    printed = capsys.readouterr()
    assert "five-bar" in printed.out
    assert "flexproof: /proc/none/table: cannot be written" in printed.err
    # One file for two results is refused at once.
    path = str(tmp_path / "both")
    assert main([*COMMANDS["table"], path, "--picture", path]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "is named for two results; each must have a file of its own" in printed.err


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path):
    foreign, link = tmp_path / "foreign.csv", tmp_path / "link.csv"
    foreign.write_bytes(b"mine")
    link.symlink_to(foreign)
    write(link, b"table")
    assert (foreign.read_bytes(), link.read_bytes()) == (b"mine", b"table")
    assert not link.is_symlink()
    assert sorted(tmp_path.iterdir()) == [foreign, link]


def test_what_cannot_be_written_whole_leaves_what_was_there(tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(b"earlier")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limit[1]))
    try:
        with pytest.raises(InputError, match="cannot be written"):
            write(path, b"x" * 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, before)
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]
