"""Files that a user names for results: refused at once, or written after the results are told."""

import pytest

from lumped.errors import InputError
from validation.cli import main
from validation.console.written import require_place, write

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


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS.keys())
def test_results_are_told_though_their_file_cannot_be_written(command, capsys):
    # Nobody can make a file there, which shows only when one is made.
    assert main([*command, "/proc/none/table"]) == 2
    printed = capsys.readouterr()
    assert "five-bar" in printed.out
    assert "flexproof: /proc/none/table: cannot be written" in printed.err


def test_folders_that_lack_are_made(tmp_path, capsys):
    path = tmp_path / "new" / "deeper" / "table"
    require_place(path)
    assert not (tmp_path / "new").exists()
    write(path, b"content")
    assert path.read_bytes() == b"content"
    assert capsys.readouterr().err == f"flexproof: {path} written\n"


def test_a_folder_that_nobody_may_write_to_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match=f"{tmp_path} is not yours to write to"):
        require_place(tmp_path / "table")
