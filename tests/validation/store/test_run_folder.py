"""The run folder: atomic, locked, resumable, kind to what others wrote, clear about refusals."""

import errno
import json
import os
from math import isnan, nan

import pytest

from lumped.errors import InputError
from validation.store.manifest import sealed
from validation.store.opening import open_folder
from validation.store.replacement import ARRIVING, UNFINISHED
from validation.store.tree import StoreError, Tree, write_atomically

HEADER = {"robot": "r", "robot_sha256": "1", "preset": "quick", "versions": {"numpy": "2"}}
OTHER = HEADER | {"preset": "fine"}


def finished(path, header=HEADER, number=1.0):
    """A finished run in a folder: one record, results, a report and a figure."""
    with open_folder(path, header, "afresh") as folder:
        folder.keep({"id": "a", "value": number})
        folder.write("results.json", f'{{"number": {number}}}')
        folder.write("report.html", f"report {number}")
        folder.write("figures/a.svg", f"figure {number}")
        folder.complete = True
    return folder


def assert_refused(said, path, header, start):
    with pytest.raises(InputError, match=said), open_folder(path, header, start):
        pass


def content(path):
    """What a folder holds but for what changes with every opening, by name."""
    return {
        str(file.relative_to(path)): file.read_bytes()
        for file in path.rglob("*")
        if file.is_file() and file.name not in {".lock", ".manifest"}
    }


def test_records_survive_and_keep_what_is_no_number(tmp_path):
    path = tmp_path / "run"
    with open_folder(path, HEADER, "afresh") as folder:
        folder.keep({"id": "a[x=0.5]/b", "value": nan})
        folder.keep({"id": "a[x=0_5]/b", "value": 0.1 + 0.2})
    with open_folder(path, HEADER, "resumed") as folder:
        assert isnan(folder.record("a[x=0.5]/b")["value"])
        assert folder.record("a[x=0_5]/b")["value"] == 0.1 + 0.2
        assert folder.record("another") is None
        assert folder.remarks == []


def test_an_earlier_run_stays_until_the_new_one_is_whole(tmp_path):
    path = tmp_path / "run"
    finished(path)
    before = content(path)
    with open_folder(path, OTHER, "afresh") as folder:
        folder.keep({"id": "a", "value": 2.0})
        folder.write("results.json", "new")
        assert folder.path == path / UNFINISHED
        assert before.items() <= content(path).items()
    # Not complete: the earlier one stays, and the new one can be gone on with.
    assert before.items() <= content(path).items()
    with open_folder(path, OTHER, "resumed") as folder:
        assert folder.record("a")["value"] == 2.0
        folder.complete = True
    assert sorted(content(path)) == ["log.txt", next(n for n in before if "records" in n),
                                     "results.json", "run.json"]  # fmt: skip
    assert (path / "results.json").read_text() == "new"
    with open_folder(path, OTHER, "resumed") as folder:
        assert folder.path == path
        assert folder.record("a")["value"] == 2.0


def test_units_of_sweeps_of_both_runs_find_their_places(tmp_path):
    old, new = tmp_path / "sweeps" / f"{'0' * 32}.npz", tmp_path / "sweeps" / f"{'1' * 32}.npz"
    finished(tmp_path)
    old.parent.mkdir()
    old.write_bytes(sealed(old.stem, b"earlier"))
    copy = tmp_path / "backup" / old.name
    copy.parent.mkdir()
    copy.write_bytes(old.read_bytes())
    with open_folder(tmp_path, OTHER, "afresh") as folder:
        folder.keep({"id": "a", "value": 2.0})
        folder.write("results.json", "new")
        # Several processes write there, without a manifest.
        (folder.path / "sweeps").mkdir()
        (folder.path / "sweeps" / new.name).write_bytes(sealed(new.stem, b"new"))
        folder.complete = True
    assert new.read_bytes() == sealed(new.stem, b"new")
    assert not old.exists()
    # A copy that somebody made of a unit is theirs, whatever its seal says.
    assert copy.read_bytes() == sealed(old.stem, b"earlier")
    assert (tmp_path / "results.json").read_text() == "new"
    assert not (tmp_path / ARRIVING).exists()


def test_a_run_begun_beside_an_earlier_one_and_given_up_makes_way_for_the_next(tmp_path):
    finished(tmp_path)
    with open_folder(tmp_path, OTHER, "afresh") as folder:
        folder.keep({"id": "a", "value": 2.0})
    finished(tmp_path, HEADER, 3.0)
    assert (tmp_path / "report.html").read_text() == "report 3.0"
    assert not (tmp_path / UNFINISHED).exists()


class Killed(BaseException):
    """As kill -9: nobody catches it."""


@pytest.mark.parametrize("moment", range(17))
def test_a_kill_at_any_step_of_a_replacement_leaves_one_of_the_two_runs(tmp_path, moment):
    finished(tmp_path)
    (tmp_path / "figures" / "thesis.png").write_bytes(b"years of work")
    earlier = content(tmp_path)
    new = finished(tmp_path.with_name(f"{tmp_path.name}-new"), OTHER, 2.0)
    expected = content(new.path) | {"figures/thesis.png": b"years of work"}
    expected.pop("run.json"), expected.pop("log.txt")
    steps = iter(range(1000))

    def killing(original):
        def step(*arguments):
            if next(steps) == moment:
                raise Killed
            return original(*arguments)

        return step

    with pytest.MonkeyPatch.context() as patch:
        try:
            with open_folder(tmp_path, OTHER, "afresh") as folder:
                folder.keep({"id": "a", "value": 2.0})
                folder.write("results.json", '{"number": 2.0}')
                folder.write("report.html", "report 2.0")
                folder.write("figures/a.svg", "figure 2.0")
                folder.complete = True
                patch.setattr(Tree, "move", killing(Tree.move))
                patch.setattr(Tree, "remove", killing(Tree.remove))
        except Killed:
            pass
        else:
            assert moment > 10
    committed = not (tmp_path / UNFINISHED).exists()
    if not committed:
        # Not a byte of the earlier run has changed.
        assert earlier.items() <= content(tmp_path).items()
    with open_folder(tmp_path, OTHER, "resumed") as folder:
        assert folder.record("a")["value"] == 2.0
        folder.complete = True
    assert folder.remarks == []
    after = content(tmp_path)
    assert {name: after[name] for name in expected} == expected
    assert set(after) == set(expected) | {"run.json", "log.txt"}
    assert not (tmp_path / ARRIVING).exists()


@pytest.mark.parametrize("mark", [{"run.json": "{}"}, {".lock": "mine"}, {".lock": ""},
                                  {"run.json": '{"robot": "a dog"}'}, {"run.json": "[]"},
                                  {".manifest": "mine"}])  # fmt: skip
def test_a_folder_of_something_else_is_left_alone(tmp_path, mark):
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "thesis.png").write_text("years of work")
    for name, text in mark.items():
        (tmp_path / name).write_text(text)
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    for start in ("afresh", "resumed"):
        assert_refused("other files", tmp_path, HEADER, start)
    assert {f: f.read_bytes() for f in tmp_path.rglob("*") if f.is_file()} == before


def test_only_what_a_run_wrote_is_ever_removed(tmp_path):
    finished(tmp_path)
    (tmp_path / "figures" / "thesis.png").write_text("years of work")
    (tmp_path / "export").mkdir()
    (tmp_path / "export" / "precious.dat").write_text("measured")
    (tmp_path / "report.html").write_text("report with remarks of its reader")
    with open_folder(tmp_path, OTHER, "afresh") as folder:
        folder.write("results.json", "{}")
        folder.write("report.html", "new")
        folder.complete = True
    assert (tmp_path / "figures" / "thesis.png").read_text() == "years of work"
    assert (tmp_path / "export" / "precious.dat").read_text() == "measured"
    assert (tmp_path / "report.html").read_text() == "new"
    assert (tmp_path / "report.html.kept").read_text() == "report with remarks of its reader"
    assert "report.html was no run's: kept as report.html.kept" in folder.remarks[0]
    assert not (tmp_path / "figures" / "a.svg").exists()


@pytest.mark.parametrize("name", [".lock", "results.json", "log.txt", "run.json", "figures/a.svg"])
@pytest.mark.parametrize("kind", ["symbolic", "hard", "pipe"])
def test_no_link_is_followed(tmp_path, name, kind):
    path, precious = tmp_path / "run", tmp_path / "precious"
    finished(path)
    precious.write_text("precious")
    (path / name).unlink()
    if kind == "symbolic":
        (path / name).symlink_to(precious)
    elif kind == "hard":
        (path / name).hardlink_to(precious)
    else:
        os.mkfifo(path / name)
    for start in ("resumed", "afresh"):
        with open_folder(path, HEADER, start) as folder:
            folder.write(name, "new") if name != ".lock" else None
            folder.complete = True
    assert precious.read_text() == "precious"


def test_a_folder_that_is_a_link_is_not_written_into(tmp_path):
    path, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    finished(path)
    for name in ("figures", "records", "sweeps"):
        if (path / name).exists():
            (path / name).rename(tmp_path / f"former {name}")
        (elsewhere / name).mkdir(parents=True)
        (path / name).symlink_to(elsewhere / name)
    with open_folder(path, HEADER, "resumed") as folder:
        folder.keep({"id": "a", "value": 1.0})
        folder.write("figures/a.svg", "figure")
    assert not any(file.is_file() for file in elsewhere.rglob("*"))
    assert (path / "figures.kept").is_symlink()
    assert not (path / "sweeps").exists()


ODD = ["", "[]", "5", "{}", "null", '{"flexproof": "record"}', "[" * 100_000, "\x00\xff", "NaN",
       '{"flexproof": "record", "run": 1, "digest": [], "record": 5}']  # fmt: skip


@pytest.mark.parametrize("odd", ODD, ids=range(len(ODD)))
def test_odd_files_count_as_not_there(tmp_path, odd):
    finished(tmp_path)
    (record,) = (tmp_path / "records").iterdir()
    for file in (record, tmp_path / "results.json", tmp_path / "run.json"):
        file.write_text(odd)
    with open_folder(tmp_path, HEADER, "resumed") as folder:
        assert folder.begun() == {}
        assert folder.record("a") is None
        assert any("does not hold: a is not finished" in said for said in folder.remarks)


def test_a_record_edited_by_hand_or_filed_elsewhere_does_not_hold(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        for identifier in ("a", "b", "c"):
            folder.keep({"id": identifier, "value": 57.39})
    a, b, c = sorted((tmp_path / "records").iterdir())
    a.write_text(a.read_text().replace("57.39", "12345.0"))
    c.write_text(b.read_text())
    with open_folder(tmp_path, HEADER, "resumed") as folder:
        found = [folder.record(identifier) for identifier in ("a", "b", "c")]
    assert found == [None, {"id": "b", "value": 57.39}, None]


def test_a_record_of_another_run_does_not_hold(tmp_path):
    finished(tmp_path / "one")
    finished(tmp_path / "two", OTHER, 2.0)
    (record,) = (tmp_path / "one" / "records").iterdir()
    record.replace(tmp_path / "two" / "records" / record.name)
    with open_folder(tmp_path / "two", OTHER, "resumed") as folder:
        assert folder.record("a") is None


def test_times_that_cannot_be_are_not_taken_up(tmp_path):
    finished(tmp_path)
    for seconds in (-1.0, 1e999, "long"):
        told = {"run": {"started": "today", "seconds": seconds}}
        (tmp_path / "results.json").write_text(json.dumps(told))
        with open_folder(tmp_path, HEADER, "resumed") as folder:
            assert folder.begun() == {}


def test_a_second_run_in_the_same_folder_is_refused(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        folder.keep({"id": "a", "value": 1.0})
        assert_refused(f"another run \\(process {os.getpid()}\\)", tmp_path, HEADER, "afresh")
        assert folder.record("a") is not None
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
    assert_refused(f"another run \\({named} differ", tmp_path, HEADER | change, "resumed")


@pytest.mark.parametrize("lost", ["run.json", ".manifest"])
def test_one_witness_of_what_was_run_is_enough(tmp_path, lost):
    finished(tmp_path)
    (tmp_path / lost).unlink()
    with open_folder(tmp_path, HEADER, "resumed") as folder:
        assert folder.record("a") == {"id": "a", "value": 1.0}
    assert_refused("another run", tmp_path, OTHER, "resumed")


@pytest.mark.parametrize("made", [True, False])
def test_nothing_to_resume_is_said(tmp_path, made):
    path = tmp_path / "new"
    if made:
        path.mkdir()
    assert_refused("no run to go on with", path, HEADER, "resumed")


@pytest.mark.parametrize("tail", ["file", "file/below", "file/below/deeper"])
def test_a_folder_that_cannot_be_made_is_refused(tmp_path, tail):
    (tmp_path / "file").write_text("")
    assert_refused("cannot write there", tmp_path / tail, HEADER, "afresh")


def test_files_made_by_others_take_their_places_in_one_step_each(tmp_path):
    with open_folder(tmp_path, HEADER, "afresh") as folder:
        with folder.replacing("export") as target:
            (target / "leg.vtu").write_text("mesh")
            assert not (tmp_path / "export").exists()
        with pytest.raises(KeyError), folder.replacing("export") as target:
            (target / "leg.vtu").write_text({}["no mesh"])
        assert (tmp_path / "export" / "leg.vtu").read_text() == "mesh"
        folder.write("results.json", "{}")
    assert not list(tmp_path.rglob("*.tmp"))
    finished(tmp_path)
    assert not (tmp_path / "export").exists()


def test_a_new_run_without_room_beside_the_earlier_one_is_refused(tmp_path, monkeypatch):
    finished(tmp_path)
    before = content(tmp_path)
    volume = os.statvfs(tmp_path)
    full = os.statvfs_result([0 if k == 4 else entry for k, entry in enumerate(volume)])
    monkeypatch.setattr(os, "fstatvfs", lambda _descriptor: full)
    assert_refused(r"0\.0 MB are free, and the new run needs about", tmp_path, OTHER, "afresh")
    assert content(tmp_path) == before


def test_a_full_disk_leaves_the_old_file_and_nothing_half_written(tmp_path, monkeypatch):
    path = tmp_path / "results.json"
    write_atomically(path, b"old")

    def full(_descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreError, match=r"results\.json: No space left on device.*is kept"):
        write_atomically(path, b"new")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["results.json"]


def test_what_a_kill_left_half_written_is_cleared_and_nothing_else(tmp_path, monkeypatch):
    def dies(_descriptor):
        raise Killed

    with open_folder(tmp_path, HEADER, "afresh") as folder, monkeypatch.context() as patch:
        folder.keep({"id": "a", "value": 1.0})
        patch.setattr(os, "fsync", dies)
        with pytest.raises(Killed):
            folder.write("results.json", "new")
    (left,) = tmp_path.glob(".results.json.*.tmp")
    like_it = left.with_name(".results.json.0123456789abcdef.tmp")
    like_it.write_text("mine")
    with open_folder(tmp_path, HEADER, "resumed"):
        assert not left.exists()
        assert like_it.read_text() == "mine"
