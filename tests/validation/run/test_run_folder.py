"""The folder of a run: complete or absent, locked, resumable, and safe for other files."""

import errno
import json
import os
import shutil
import signal
from itertools import count
from math import isnan, nan
from pathlib import Path

import pytest
from support.fakes.toy_runs import content, partial, refusing

from lumped.errors import InputError
from lumped.files import StoreError
from validation.run.folder import open_folder

HEADER = {"robot": "r", "robot_sha256": "1", "preset": "quick", "versions": {"numpy": "2"},
          "started": "today"}  # fmt: skip
OTHER = HEADER | {"preset": "fine"}
RUN = {"run.json", "results.jsonl", "results.json", "log.txt", "report.html", "figures/a.svg"}


def fill(folder, number=1.0):
    folder.keep({"id": "a", "value": number}, 5.0)
    folder.write({"results.json": f'{{"number": {number}}}', "report.html": f"report {number}"})
    folder.write({"figures/a.svg": f"figure {number}"})


def finished(path, header=HEADER, number=1.0, *, complete=True):
    """Write a run with a record, results, a report and a figure; abandoned if not `complete`."""
    with open_folder(path, header, "afresh") as folder:
        fill(folder, number)
        folder.complete = complete


def assert_refused(message, path, header, start):
    with pytest.raises(InputError, match=message), open_folder(path, header, start):
        pass


def test_records_keep_nan_and_infinity(tmp_path):
    """Records keep all digits. Similar ids are separate records, and a later record prevails."""
    path = tmp_path / "run"
    with open_folder(path, HEADER, "afresh") as folder:
        folder.keep({"id": "a[x=0.5]/b", "value": nan}, 3.0)
        folder.keep({"id": "a[x=0_5]/b", "value": 1.0}, 4.0)
        folder.keep({"id": "a[x=0_5]/b", "value": 0.1 + 0.2}, 7.0)
    with open_folder(path, HEADER | {"started": "later"}, "resumed") as folder:
        assert isnan(folder.records["a[x=0.5]/b"]["value"])
        assert folder.records["a[x=0_5]/b"]["value"] == 0.1 + 0.2
        assert len(folder.records) == 2
        assert folder.begun == {"started": "today", "seconds": 7.0}
        assert folder.remarks == []


def test_earlier_run_is_kept_until_completion(tmp_path):
    """The new run grows in FOLDER.partial and replaces the earlier one at its end."""
    path = tmp_path / "run"
    finished(path)
    before = content(path)
    assert set(before) == RUN
    finished(path, OTHER, 2.0, complete=False)
    # Not complete: the earlier one stays, and the new one can be gone on with.
    assert content(path) == before
    # A run that is whole is gone on with, too, and keeps what it has.
    for _ in range(2):
        with open_folder(path, OTHER, "resumed") as folder:
            assert folder.path == partial(path)
            assert folder.records["a"]["value"] == 2.0
            folder.complete = True
        assert (path / "report.html").read_text() == "report 2.0"
        assert set(content(path)) == RUN
        assert not partial(path).exists()


def test_abandoned_run_is_replaced(tmp_path):
    """Files of the unfinished run are removed, files of the user are kept."""
    path = tmp_path / "run"
    with open_folder(path, OTHER, "afresh") as folder:
        fill(folder, 2.0)
        folder.write({"figures/b.svg": "figure of the other run"})
        (folder.path / "notes").write_text("mine")
    finished(path, HEADER, 3.0)
    assert (path / "report.html").read_text() == "report 3.0"
    assert (path / "notes").read_text() == "mine"
    assert set(content(path)) == RUN | {"notes"}


def killed(moment, path):
    """True if a run that replaces another was killed after `moment` steps on the disk."""
    child = os.fork()
    if child == 0:
        remaining_steps = iter(range(moment))

        def limited(step):
            def doing(*arguments, **keywords):
                if next(remaining_steps, None) is None:
                    os.kill(os.getpid(), signal.SIGKILL)
                return step(*arguments, **keywords)

            return doing

        try:
            for name in ("open", "mkdir", "rename", "replace", "unlink", "rmdir"):
                setattr(Path, name, limited(getattr(Path, name)))
            finished(path, OTHER, 2.0)
            os._exit(0)
        finally:
            os._exit(1)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code in {0, -signal.SIGKILL}
    return code != 0


def test_kill_leaves_old_or_new_run(tmp_path, monkeypatch):
    """Killed at each step of the replacement; the new run can be resumed."""
    # Costs time, and saves from other ends than these.
    monkeypatch.setattr(os, "fsync", lambda _: None)
    replaced = 0
    for moment in count():
        path = tmp_path / f"{moment}" / "run"
        finished(path)
        (path / "figures" / "thesis.png").write_bytes(b"years of work")
        earlier = content(path)
        if not killed(moment, path):
            break
        if not path.exists() or json.loads((path / "run.json").read_text())["preset"] == "fine":
            # Whoever opens the folder next goes on.
            replaced += 1
            with open_folder(path, OTHER, "resumed") as folder:
                assert folder.records["a"]["value"] == 2.0
                folder.complete = True
            assert folder.remarks == []
        else:
            # Until the new run is whole, not a byte of the earlier one has changed.
            assert content(path) == earlier
            finished(path, OTHER, 2.0)
        assert set(content(path)) == RUN | {"figures/thesis.png"}
        assert (path / "figures" / "thesis.png").read_bytes() == b"years of work"
        assert (path / "figures" / "a.svg").read_text() == "figure 2.0"
        assert [entry.name for entry in path.parent.iterdir()] == ["run"]
    assert replaced > 5 < moment - replaced


@pytest.mark.parametrize("suffix", ["", ".partial"])
def test_foreign_folder_is_refused(tmp_path, suffix):
    """A folder with files but without a run, also as FOLDER.partial."""
    path, foreign = tmp_path / "run", tmp_path / f"run{suffix}"
    (foreign / "figures").mkdir(parents=True)
    (foreign / "figures" / "thesis.png").write_text("years of work")
    for text in ("{}", "[]", '{"robot": "a dog"}'):
        (foreign / "run.json").write_text(text)
        before = content(tmp_path)
        for start in ("afresh", "resumed"):
            assert_refused("contains other files", path, HEADER, start)
        assert content(tmp_path) == before


def test_only_own_files_are_removed(tmp_path):
    """Listed paths outside the folder and changed files are kept."""
    path, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    finished(path)
    elsewhere.mkdir()
    (path / "data").mkdir()
    (path / "linked").symlink_to(elsewhere)
    mark = json.loads((path / "run.json").read_text())
    mark["files"] |= {"../elsewhere/precious": "", str(elsewhere / "precious"): "", "linked/x": ""}
    (path / "run.json").write_text(json.dumps(mark))
    mine = ["figures/thesis.png", "data/precious.dat", "linked/precious", "linked/x", "report.html"]
    for name in mine:
        (path / name).write_text("mine")
    with open_folder(path, OTHER, "afresh") as folder:
        folder.write({"results.json": "{}", "report.html": "new"})
        folder.complete = True
    for name in mine[:-1]:
        assert (path / name).read_text() == "mine"
    assert (path / "report.html").read_text() == "new"
    assert (path / "report.html.kept").read_text() == "mine"
    assert "report.html was not written by a run; kept as report.html.kept" in folder.remarks[0]
    assert not (path / "figures" / "a.svg").exists()
    assert (path / "linked").is_symlink()


def linked_hard(path, precious):
    path.hardlink_to(precious)


def folder_of_mine(path, _precious):
    path.mkdir()
    (path / "mine").write_text("precious")


ODD_FILES = [Path.symlink_to, linked_hard, lambda path, _: os.mkfifo(path), folder_of_mine]


@pytest.mark.parametrize("shift", range(4))
@pytest.mark.parametrize("complete", [True, False])
def test_links_in_folder_are_ignored(tmp_path, complete, shift):
    """Each file of a run but one is replaced by a link, a pipe or a folder of the user.

    The remaining file, run.json or results.jsonl, still identifies the folder as that of a run.
    """
    spared = "run.json" if shift % 2 else "results.jsonl"
    path, precious = tmp_path / "run", tmp_path / "precious"
    finished(path, complete=complete)
    precious.write_text("precious")
    for number, name in enumerate(sorted({".lock", *RUN} - {spared}), start=shift):
        tampered = (path if complete else partial(path)) / name
        tampered.unlink(missing_ok=True)
        ODD_FILES[number % 4](tampered, precious)
    for start in ("resumed", "afresh"):
        with open_folder(path, HEADER, start) as folder:
            fill(folder)
            folder.log.open("a").write("said")
            folder.complete = True
    assert precious.read_text() == "precious"
    assert {file.read_text() for file in path.rglob("mine")} == {"precious"}
    assert set(content(path)) >= RUN
    assert (path / "figures" / "a.svg").read_text() == "figure 1.0"


@pytest.mark.parametrize("complete", [True, False])
def test_linked_figures_folder_is_not_written(tmp_path, complete):
    """The link is kept under another name, and a folder takes its place."""
    path, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    finished(path, complete=complete)
    figures = (path if complete else partial(path)) / "figures"
    figures.rename(elsewhere)
    figures.symlink_to(elsewhere)
    with open_folder(path, HEADER, "resumed") as folder:
        folder.write({"figures/a.svg": "figure 2.0"})
        folder.complete = True
    assert [file.read_text() for file in elsewhere.iterdir()] == ["figure 1.0"]
    assert (path / "figures.kept").is_symlink()
    assert (path / "figures" / "a.svg").read_text() == "figure 2.0"


def test_linked_out_folder_is_used(tmp_path):
    """`--out` may be a link to another disk."""
    (tmp_path / "disk").mkdir()
    (tmp_path / "report").symlink_to("disk")
    finished(tmp_path / "report")
    assert set(content(tmp_path / "disk")) == RUN
    assert (tmp_path / "report").is_symlink()


ODD = [b"", b"[]", b"5", b"{}", b"null", b'{"seal": "', 100_000 * b"[", b"\x00\xff", b"NaN",
       b'{"flexproof": "run", "files": 5}', b'{"seal": "%s", "a": 5}' % (32 * b"0")]  # fmt: skip


def test_invalid_records_are_recomputed(tmp_path):
    """Damaged lines of results.jsonl, and lines of another run, each with a remark."""
    path = tmp_path / "odd"
    finished(path)
    records = path / "results.jsonl"
    records.write_bytes(b"\n".join(ODD) + b"\n" + records.read_bytes() + ODD[-1])
    with open_folder(path, HEADER, "resumed") as folder:
        assert folder.records == {"a": {"id": "a", "value": 1.0}}
        folder.keep({"id": "b"}, 6.0)
        assert all("is damaged or of another run" in remark for remark in folder.remarks)
        assert len(folder.remarks) == len(ODD)
    with open_folder(path, HEADER, "resumed") as folder:
        assert list(folder.records) == ["a", "b"]
    # Nor what was edited or is of another run.
    two = tmp_path / "two"
    finished(two, OTHER, 2.0)
    edited = two / "results.jsonl"
    edited.write_bytes(edited.read_bytes().replace(b"2.0", b"3.0") + records.read_bytes())
    with open_folder(two, OTHER, "resumed") as folder:
        assert folder.records == {}


@pytest.mark.parametrize("lost", ["run.json", "results.jsonl"])
def test_resume_needs_only_one_run_record(tmp_path, lost):
    """run.json or results.jsonl, whichever is intact, identifies the run."""
    path = tmp_path / "run"
    finished(path)
    (path / lost).write_bytes(b"\xff odd")
    assert_refused("another run", path, OTHER, "resumed")
    with open_folder(path, HEADER, "resumed") as folder:
        assert ("a" in folder.records) == (lost == "run.json")


def test_second_run_is_refused(tmp_path):
    """A folder in use is locked; the message has the number of the process."""
    path = tmp_path / "run"
    finished(path)
    with open_folder(path, HEADER, "afresh") as folder:
        fill(folder)
        for start in ("afresh", "resumed"):
            assert_refused(f"another run \\(process {os.getpid()}\\)", path, HEADER, start)
        folder.complete = True
    finished(path)


@pytest.mark.parametrize("complete", [True, False])
def test_different_run_is_not_resumed(tmp_path, complete):
    """Other preset, robot file, versions or sources: the difference is named."""
    finished(tmp_path / "run", complete=complete)
    for change, difference in (
        ({"preset": "fine"}, "preset"),
        ({"robot_sha256": "2"}, "robot file"),
        ({"versions": {}}, "versions"),
        ({"suite_sha256": "3"}, "source files of flexproof"),
    ):
        message = f"another run \\({difference} differ"
        assert_refused(message, tmp_path / "run", HEADER | change, "resumed")


def test_unusable_folder_is_unchanged(tmp_path, monkeypatch):
    """Files, mount points, the current folder, and full or read-only disks."""
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("")
    finished(tmp_path / "run")
    before = content(tmp_path)
    for name in ("empty", "new"):
        assert_refused("contains no run that can be resumed", tmp_path / name, HEADER, "resumed")
    for tail in ("file", "file/below", "file/below/deeper"):
        assert_refused("cannot write there", tmp_path / tail, HEADER, "afresh")
    assert_refused("is a mount point", Path("/"), HEADER, "afresh")
    path = tmp_path / "run"
    monkeypatch.chdir(path / "figures")
    for folder in (Path(".."), path):
        assert_refused("is the folder that you are in", folder, OTHER, "afresh")
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "mkdir", refusing(errno.EROFS))
        assert_refused("cannot write there: Read-only file system", path, OTHER, "afresh")
    usage = shutil.disk_usage(tmp_path)._replace(free=0)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    assert_refused(r"0\.0 MB are free, and the new run needs about", path, OTHER, "afresh")
    assert content(tmp_path) == before
    assert {entry.name for entry in tmp_path.iterdir()} == {"empty", "file", "run"}


def test_export_is_complete_or_absent(tmp_path):
    """A failed export leaves nothing; a run without --export removes it."""
    path = tmp_path / "run"
    with open_folder(path, HEADER, "afresh") as folder:
        with pytest.raises(KeyError), folder.exporting() as target:
            (target / "leg.vtu").write_text({}["no mesh"])
        with folder.exporting() as target:
            (target / "leg.vtu").write_text("mesh")
            assert not (folder.path / "export").exists()
        fill(folder)
        folder.complete = True
    assert set(content(path)) == RUN | {"export/leg.vtu"}
    with open_folder(path, HEADER, "resumed") as folder:
        folder.complete = True
    assert (path / "export" / "leg.vtu").read_text() == "mesh"
    finished(path)
    assert not (path / "export").exists()


def test_failed_write_keeps_old_file(tmp_path, monkeypatch):
    """Full disk or program error during a write; temporary files are removed later."""
    path = tmp_path / "run"
    finished(path, complete=False)
    with open_folder(path, HEADER, "resumed") as folder, monkeypatch.context() as patch:
        before = content(folder.path)
        patch.setattr(os, "fsync", refusing(errno.ENOSPC))
        with pytest.raises(StoreError, match=r"run\.partial: No space left on device"):
            folder.write({"results.json": "new"})
        assert content(folder.path) == before
        with pytest.raises(StoreError, match="No space left on device"):
            folder.keep({"id": "b"}, 6.0)
        # As a kill does, nobody heeds it.
        patch.setattr(os, "fsync", {}.__getitem__)
        with pytest.raises(KeyError):
            folder.write({"figures/a.svg": "new"})
        assert len(list(folder.path.rglob(".*.tmp"))) == 1
    with open_folder(path, HEADER, "resumed") as folder:
        assert not list(folder.path.rglob(".*.tmp"))
        assert (folder.path / "figures" / "a.svg").read_text() == "figure 1.0"
