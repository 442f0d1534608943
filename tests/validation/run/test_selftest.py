"""Checks of the program: made once, kept, shown by other runs, believed where they hold."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from lumped.robot_file import load_robot
from validation import catalogue, cli
from validation.results import provenance
from validation.results.tasks import is_check
from validation.run import summary
from validation.run.kept_checks import kept_of
from validation.run.session import Request, validate

HERE = Path(__file__).parents[1]
IFW = load_robot("ifw")
PATIENCE = 30.0


@pytest.fixture(scope="module")
def toys():
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(HERE))
    patch.setattr(provenance, "suite_digest", lambda: "0")
    import toy_catalogue  # noqa: PLC0415  found only on the path set above

    yield toy_catalogue
    patch.undo()


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "flexproof" / "selftest"


def ran(listed, out, robot_file=IFW, **changes):
    return validate(Request(robot_file, "quick", out, 1, **changes), listed)


def moment(gathered):
    """What the check that is never the same twice has noted."""
    return gathered.done["toy.check.sum"].found.notes[0]


def counts(gathered):
    return gathered.selftest["kept"], gathered.selftest["computed"]


def test_a_second_run_shows_what_the_first_one_found(toys, cache, tmp_path, capsys):
    first = ran(toys.checked, tmp_path / "first")
    said = capsys.readouterr().err
    assert "3 checks of the program itself are made in this run; none are kept" in said
    second = ran(toys.checked, tmp_path / "second")
    assert counts(first) == (0, 3)
    assert counts(second) == (3, 0)
    assert capsys.readouterr().err == ""
    assert moment(second) == moment(first)
    assert second.exit_code() == 0
    content = json.loads((tmp_path / "second/results.json").read_text())
    assert {case["id"] for case in content["cases"]} >= {"toy.check.steady", "toy.check.sum"}
    assert content["run"]["selftest"]["kept"] == 3
    assert 'name="toy.check.sum"' in (tmp_path / "second/junit.xml").read_text()
    line = summary.program(second)
    assert line.startswith(f"the program: 2 of 2 checks agree, checked on {time.strftime('%Y-')}")
    page = (tmp_path / "second/report.html").read_text()
    assert line[1:] in page
    assert (tmp_path / "second/figures/toy.check.figure.svg").exists()
    assert len(list(cache.iterdir())) == 1


def test_the_program_is_checked_on_the_built_in_robot(toys, tmp_path):
    other = replace(IFW, described=replace(IFW.robot, a=IFW.robot.a + 0.02))
    gathered = ran(toys.checked, tmp_path / "run", other)
    assert gathered.done["toy.check.steady"].found.value == IFW.robot.a
    assert gathered.done["toy.check.figure"].found.data == f"x\n{IFW.robot.a}\n"
    # Nor does the robot tell kept checks apart.
    assert counts(ran(toys.checked, tmp_path / "next")) == (3, 0)


def test_a_disagreement_that_is_kept_still_ends_with_1(toys, tmp_path):
    assert ran(toys.wrongly_checked, tmp_path / "first").exit_code() == 1
    second = ran(toys.wrongly_checked, tmp_path / "second")
    assert counts(second) == (4, 0)
    assert second.exit_code() == 1
    assert "2 of 3 checks agree" in summary.program(second)


def test_what_failed_is_tried_again(toys, tmp_path, monkeypatch):
    monkeypatch.setenv("FAILING", "yes")
    assert ran(toys.wrongly_checked, tmp_path / "first").exit_code() == 3
    second = ran(toys.wrongly_checked, tmp_path / "second")
    assert counts(second) == (4, 1)
    assert second.exit_code() == 3


def flipped(content):
    at = content.index(b'"value": 1.0')
    return content[: at + 9] + b"7" + content[at + 10 :]


@pytest.mark.parametrize(
    ("damage", "holding"),
    [
        (lambda _: b"", []),
        (lambda _: bytes(range(256)) * 20, []),
        (lambda content: content[:-40], [0, 1]),
        (flipped, [0, 2]),
        (lambda content: content.replace(b'"run": "', b'"run": "0'), []),
        (lambda content: b'{"flexproof": "record"}\n[[[[\n' + content, [0, 1, 2]),
        (lambda content: content.replace(b'"verdict": "agree"', b'"verdict": "disagree"'), []),
        (lambda content: content + content[:400], [0, 1, 2]),
    ],
    ids=["empty", "noise", "cut", "number", "other work", "foreign lines", "verdict", "twice"],
)
def test_what_does_not_hold_is_nothing(cache, damage, holding):
    kept = kept_of(provenance.header(IFW, "quick", {}))
    measured = {"reference": 1.0, "notes": ["n" * 300]}
    records = [
        {"id": f"check.{k}", "verdict": "agree", "measurement": measured | {"value": float(k)}}
        for k in range(3)
    ]
    for record in records:
        kept.add(record)
    (file,) = cache.iterdir()
    file.write_bytes(damage(file.read_bytes()))
    found = {name: {**record} for name, record in kept.records().items()}
    assert all(record.pop("checked") for record in found.values())
    assert found == {records[k]["id"]: records[k] for k in holding}


@pytest.mark.exhaustive
def test_what_was_damaged_is_made_again_and_holds_then(toys, cache, tmp_path):
    first = ran(toys.checked, tmp_path / "first")
    (file,) = cache.iterdir()
    file.write_bytes(flipped(file.read_bytes()))
    again = ran(toys.checked, tmp_path / "again")
    assert counts(again) == (2, 1)
    assert again.done["toy.check.sum"].found.value == 1.0
    assert moment(again) != moment(first)
    assert counts(ran(toys.checked, tmp_path / "healed")) == (3, 0)


@pytest.mark.exhaustive
def test_other_sources_have_checks_of_their_own(toys, tmp_path, monkeypatch):
    ran(toys.checked, tmp_path / "first")
    monkeypatch.setattr(provenance, "suite_digest", lambda: "1")
    assert counts(ran(toys.checked, tmp_path / "sources")) == (0, 3)


def test_checks_made_of_changing_sources_are_not_kept(toys, cache, tmp_path, monkeypatch):
    digests = iter(["0", "1"])
    monkeypatch.setattr(provenance, "suite_digest", lambda: next(digests))
    gathered = ran(toys.checked, tmp_path / "run")
    assert counts(gathered) == (0, 3)
    assert any("sources of flexproof changed" in remark for remark in gathered.remarks)
    assert list(cache.iterdir()) == []


@pytest.mark.parametrize("place", ["a file", "off"])
def test_where_nothing_can_be_kept_every_run_checks(toys, tmp_path, monkeypatch, place):
    if place == "off":
        monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    else:
        (tmp_path / "file").write_text("in the way")
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    gathered = ran(toys.checked, tmp_path / "run")
    assert counts(gathered) == (0, 3)
    assert gathered.exit_code() == 0
    assert any("cannot be kept for other runs" in remark for remark in gathered.remarks)
    assert kept_of(gathered.header).records() == {}


@pytest.mark.exhaustive
def test_who_names_checks_or_asks_for_them_has_them_computed(toys, tmp_path):
    first = ran(toys.checked, tmp_path / "first")
    named = ran(toys.checked, tmp_path / "named", only="toy.check.*")
    assert counts(named) == (0, 3)
    assert moment(named) != moment(first)
    asked = ran(toys.checked, tmp_path / "asked", selftest=True)
    assert counts(asked) == (0, 3)
    assert moment(ran(toys.checked, tmp_path / "then")) == moment(asked)


def test_checks_can_be_left_out_and_that_is_said(toys, cache, tmp_path):
    gathered = ran(toys.checked, tmp_path / "run", selftest=False)
    assert list(gathered.done) == ["toy.agrees"]
    assert summary.program(gathered) == "the program: not checked in this run"
    assert "The program: not checked in this run" in (tmp_path / "run/report.html").read_text()
    assert gathered.header["options"] == {"selftest": "left out"}
    assert not cache.exists()


def started(listed, *arguments):
    return subprocess.Popen(
        [sys.executable, HERE / "command_line.py", listed, *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE.parents[1]), str(HERE)])},
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.mark.exhaustive
def test_a_kill_leaves_what_was_finished_to_the_next_run(toys, cache, tmp_path):
    process = started(
        "slowly_checked", "run", "--preset", "quick", "--out", str(tmp_path / "killed")
    )
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        lines = [line for file in cache.glob("*") for line in file.read_bytes().splitlines()]
        if len([line for line in lines if line]) == 3:
            break
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert counts(ran(toys.checked, tmp_path / "next")) == (3, 0)


@pytest.mark.exhaustive
def test_two_runs_at_once_both_check_and_leave_what_holds(toys, tmp_path):
    both = [
        started("checked", "run", "--preset", "quick", "--out", str(tmp_path / name))
        for name in ("one", "two")
    ]
    assert [process.wait(PATIENCE) for process in both] == [0, 0]
    assert counts(ran(toys.checked, tmp_path / "next")) == (3, 0)


def test_the_command_checks_again_keeps_and_says_the_verdict(toys, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(catalogue, "checks", toys.checks)
    assert cli.main(["selftest", "--preset", "quick", "--jobs", "1"]) == 0
    assert "the program: 2 of 2 checks agree" in capsys.readouterr().out
    out = tmp_path / "out"
    assert cli.main(["selftest", "--preset", "quick", "--jobs", "1", "--out", str(out)]) == 0
    assert json.loads((out / "results.json").read_text())["run"]["selftest"]["computed"] == 3
    assert counts(ran(toys.checked, tmp_path / "after")) == (3, 0)
    monkeypatch.setattr(catalogue, "checks", toys.wrongly_checked)
    assert cli.main(["selftest", "--preset", "quick", "--jobs", "1"]) == 1
    assert "disagree" in capsys.readouterr().out


def test_every_check_of_the_program_stands_in_the_catalogue_of_every_robot():
    listed = {task.id for task in catalogue.checks(IFW)}
    assert len(listed) > 200
    for robot in ("ifw", "five-bar"):
        whole = catalogue.catalogue(load_robot(robot))
        assert {task.id for task in whole if is_check(task)} == listed
    assert all(map(is_check, catalogue.checks(IFW)))
