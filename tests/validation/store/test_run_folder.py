"""The run folder: atomic, locked, resumable, and clear about what the disk refuses."""

import errno
import os
from math import isnan, nan
from pathlib import Path

import pytest

from lumped.errors import InputError
from validation.store.run_folder import StoreError, open_folder, write_atomically

HEADER = {"robot": "r", "robot_sha256": "1", "preset": "quick", "versions": {"numpy": "2"}}


def test_records_survive_and_keep_what_is_no_number(tmp_path):
    path = tmp_path / "run"
    with open_folder(path, HEADER, "afresh") as folder:
        folder.keep({"id": "a[x=0.5]/b", "value": nan})
        folder.keep({"id": "a[x=0_5]/b", "value": 0.1 + 0.2})
    with open_folder(path, HEADER, "resumed") as folder:
        records = folder.records()
    assert isnan(records["a[x=0.5]/b"]["value"])
    assert records["a[x=0_5]/b"]["value"] == 0.1 + 0.2


def test_a_run_afresh_clears_the_former_one(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        folder.keep({"id": "a"})
        folder.write("report.html", "old")
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        assert folder.records() == {}
    assert not (tmp_path / "report.html").exists()


def test_a_torn_record_counts_as_not_finished(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        folder.keep({"id": "a"})
        (tmp_path / "records" / "torn.json").write_text('{"id": "b", "va')
        assert set(folder.records()) == {"a"}


def test_a_second_run_in_the_same_folder_is_refused(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        folder.keep({"id": "a"})
        with (
            pytest.raises(InputError, match=f"another run \\(process {os.getpid()}\\)"),
            open_folder(tmp_path, HEADER, "afresh"),
        ):
            pass
        assert set(folder.records()) == {"a"}
    with open_folder(tmp_path, HEADER, "afresh"):
        pass


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"preset": "fine"}, "preset"),
        ({"robot_sha256": "2"}, "robot file"),
        ({"versions": {}}, "versions"),
        ({"suite_sha256": "3"}, "source files of flexproof"),
    ],
)
def test_a_different_run_is_not_resumed(tmp_path, change, named):
    with open_folder(tmp_path, HEADER, "afresh"):
        pass
    with (
        pytest.raises(InputError, match=f"another run \\({named} differ"),
        open_folder(tmp_path, HEADER | change, "resumed"),
    ):
        pass


def test_nothing_to_resume_is_said(tmp_path):
    with (
        pytest.raises(InputError, match="no run to go on with"),
        open_folder(tmp_path / "new", HEADER, "resumed"),
    ):
        pass


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match="other files"), open_folder(tmp_path, HEADER, "afresh"):
        pass
    assert [entry.name for entry in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("tail", ["file", "file/below", "file/below/deeper"])
def test_a_folder_that_cannot_be_made_is_refused(tmp_path, tail):
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(InputError, match="cannot write there"),
        open_folder(tmp_path / tail, HEADER, "afresh"),
    ):
        pass


def test_a_full_disk_leaves_the_old_file_and_nothing_half_written(tmp_path, monkeypatch):
    path = tmp_path / "results.json"
    write_atomically(path, "old")

    def full(_descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreError, match=r"results\.json: No space left on device.*is kept"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["results.json"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has /dev/full")
def test_a_device_that_is_full_is_named(tmp_path):
    (tmp_path / ".log.tmp").symlink_to("/dev/full")
    with pytest.raises(StoreError, match="No space left"):
        write_atomically(tmp_path / "log", "x")
