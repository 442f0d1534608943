"""The runner: verdicts on results and errors, and equal numbers for any number of processes."""

import json
import os
import sys
import time
from dataclasses import replace
from xml.etree import ElementTree as ET

import pytest
from support.fakes import toy_catalogue as toys
from support.fakes.toy_runs import lines, run_in_this_process

from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from validation.console import progress as telling
from validation.console import streams
from validation.report.listing import junit_xml
from validation.run import progress, runner
from validation.run.folder import open_folder
from validation.run.outcome import outcome_of
from validation.validate import Request, validate


@pytest.fixture(scope="module")
def robot_file():
    return load_robot("ifw")


def request_for(robot_file, out, jobs=2, **changes):
    return Request(robot_file, "quick", out, jobs, **changes)


@pytest.fixture(scope="module")
def troubled_run(robot_file, tmp_path_factory):
    path = tmp_path_factory.mktemp("troubled") / "run"
    return validate(request_for(robot_file, path), toys.troubled), path


def test_run_folder_has_all_results(troubled_run):
    """Files, figures, JUnit counts and records of a run in which several cases fail."""
    gathered, path = troubled_run
    written = {*("log.txt", "run.json", "results.json", "results.jsonl")}
    written |= {"junit.xml", "report.html", "figures"}
    assert {entry.name for entry in path.iterdir() if entry.name[0] != "."} == written
    figures = {entry.name for entry in (path / "figures").iterdir()}
    assert figures == {
        f"toy.{name}.{kind}" for name in ("figure", "study") for kind in ("svg", "csv")
    }
    assert 'failures="1" errors="4" skipped="1"' in (path / "junit.xml").read_text()
    results = json.loads((path / "results.json").read_text())
    assert results["schema"] == 1
    header = {"started", "seconds", "robot", "robot_sha256", "versions", "preset"}
    assert header <= set(results["run"])
    verdicts = [entry["verdict"] for entry in results["cases"]]
    assert verdicts[:6] == ["agree"] * 3 + ["skipped", "disagree", "failed"]
    assert results["studies"][0]["series"] == {"beam": [1.0, 2.0]}
    # A group shares what is expensive.
    notes = [gathered.done[name].found.notes for name in ("toy.first[x=1]", "toy.second[x=2]")]
    assert notes[0] == notes[1]


def test_error_in_case_becomes_its_verdict(troubled_run):
    """Error with a message, program error, crash and lack of memory; later cases are computed."""
    gathered, path = troubled_run
    messages = {name: outcome.message for name, outcome in gathered.done.items()}
    assert gathered.standing.exit_code == 3
    assert messages["toy.singular"] == "leg 2: the stiffness matrix is singular"
    assert messages["toy.bug"] == "IndexError: pop from empty list (traceback in log.txt)"
    assert "was ended by SIGSEGV" in messages["toy.crash"]
    assert gathered.done["toy.after-the-crash"].verdict == "agree"
    # OpenBLAS ends the process, without a word to Python.
    starved = "ran out of memory (OpenBLAS error: Memory allocation still failed"
    assert starved in messages["toy.starved"]
    assert "reduce --jobs" in messages["toy.starved"]
    log = (path / "log.txt").read_text()
    for text in ("Traceback", "Segmentation fault", "this belongs into the log"):
        assert text in log


@pytest.mark.usefixtures("blank_charts")
def test_resumed_run_computes_missing_tasks(robot_file, troubled_run, capfd, monkeypatch):
    """Finished ones keep their values and times; failed ones are computed again."""
    first, path = troubled_run
    # A busy machine takes as long as it likes: no line says how far the work is.
    monkeypatch.setattr(telling, "_SILENT_SECONDS", 1e6)
    second = validate(request_for(robot_file, path, start="resumed"), toys.troubled)
    # Whatever goes wrong in it, nothing is printed where the user looks.
    assert capfd.readouterr() == ("", "")
    finished = "toy.first[x=1]"
    assert second.done[finished].found.notes == first.done[finished].found.notes
    assert second.done["toy.agrees"].seconds == first.done["toy.agrees"].seconds
    # What failed is tried again.
    assert (path / "log.txt").read_text().count("this belongs into the log") == 2
    assert second.standing.exit_code == 3


def test_failed_worker_start_ends_run(robot_file, tmp_path, monkeypatch):
    """The sources can be imported in the main process, but not in a worker."""
    monkeypatch.setenv("TOY_PARENT", str(os.getpid()))
    with pytest.raises(ComputationError, match="before it began"):
        validate(request_for(robot_file, tmp_path / "run"), toys.unloadable)
    assert "only workers come here" in (tmp_path / "run.partial" / "log.txt").read_text()


@pytest.mark.usefixtures("blank_charts")
def test_inconsistent_verdict_is_recomputed(robot_file, tmp_path, monkeypatch):
    """A stored value that contradicts its stored verdict."""
    monkeypatch.setattr(runner, "run", run_in_this_process)
    request = request_for(robot_file, tmp_path, only="toy.agrees")
    validate(request, toys.disagreeing)
    # Whoever knows how a record is sealed: the value is far off, the verdict left at agree.
    mark = json.loads((tmp_path / "run.json").read_text())
    with open_folder(tmp_path, mark, "resumed") as folder:
        record = folder.records["toy.agrees"]
        record["found"]["value"] = 12345.0
        folder.keep(record, 1.0)
        folder.complete = True
    assert b"12345.0" in lines(tmp_path)[-1]
    second = validate(replace(request, start="resumed"), toys.disagreeing)
    assert second.done["toy.agrees"].found.value == 1.0 / 3.0


def test_brackets_in_patterns_are_literal(robot_file):
    """Only * and ? are wildcards in --only."""
    tasks = toys.sound(robot_file)
    for pattern, expected in {
        "toy.first*": ["toy.first[x=1]"],
        "toy.first[x=1]": ["toy.first[x=1]"],
        "*[x=?]": ["toy.first[x=1]", "toy.second[x=2]"],
    }.items():
        assert [task.id for task in runner.select(tasks, "quick", pattern)] == expected
    with pytest.raises(ValueError, match="same id"):
        runner.select((*tasks, tasks[0]), "quick")
    with pytest.raises(InputError, match=r'did you mean "toy\.agrees"'):
        runner.select(tasks, "quick", "toy.agree")


def test_junit_xml_escapes_control_characters():
    case = toys.case("toy.escape", toys.agrees)
    text = junit_xml([outcome_of(case, "failed", 0.0, "\x1b[31mred\x00 <&>")], "toys")
    error = ET.fromstring(text).find("testsuite/testcase/error")  # noqa: S314  our own
    assert error.get("message") == "?[31mred? <&>"


def test_only_long_runs_report_progress(monkeypatch, capsys):
    """Finished and failed cases, elapsed time, and remaining time by efforts."""
    tasks = list(toys.sound(load_robot("ifw")))
    with progress.showing(tasks, 0.0) as reporter:
        reporter.started(tasks[0])
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(telling, "_SILENT_SECONDS", 0.05)
    monkeypatch.setattr(telling, "_ESTIMATE_DELAY", 0.02)
    with progress.showing(tasks, 0.0) as reporter:
        reporter.started(tasks[0])
        time.sleep(0.2)
        reporter.finished(tasks[0], {"verdict": "disagree"})
        time.sleep(1.1)
    first, second = capsys.readouterr().err.splitlines()[:2]
    count = len(tasks)
    assert first == f"flexproof: 0/{count} done, 0 s elapsed"
    begins = f"flexproof: 1/{count} done, 1 not in agreement, 1 s elapsed, about "
    assert second.startswith(begins)
    # What is done took its share of the efforts.
    share = tasks[0].effort / sum(task.effort for task in tasks)
    remaining_seconds = float(second.removeprefix(begins).split()[0])
    assert abs(remaining_seconds - 1.1 * (1.0 / share - 1.0)) < 0.3 / share + 1.0


def test_progress_escapes_file_names(monkeypatch, capsys):
    """Brackets in a file name are no markup of the terminal library."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with telling.stage("reading [/red]a[bold].step"):
        time.sleep(0.2)
    assert "reading [/red]a[bold].step" in capsys.readouterr().err


def test_time_forecast_uses_machine_speed(monkeypatch, capsys):
    """On a machine of half the reference speed, 100 s become 200 s, printed as three minutes."""
    monkeypatch.setattr(telling, "slowness", lambda: 2.0)
    monkeypatch.setattr(telling, "_ESTIMATE_DELAY", 0.02)
    with telling.stage("meshing", 100.0):
        time.sleep(0.1)
    assert capsys.readouterr().err == "flexproof: meshing: about 3 min on this machine\n"
    monkeypatch.setattr(telling, "_SILENT_SECONDS", 0.05)
    with telling.stage("meshing", 50.0):
        time.sleep(0.2)
    forecast, line = capsys.readouterr().err.splitlines()
    assert forecast == "flexproof: meshing: about 100 s on this machine"
    assert line == "flexproof: meshing: 0 s elapsed, about 100 s left"
    # A run of which next to nothing is done has no pace of its own yet.
    tasks = list(toys.sound(load_robot("ifw")))
    with progress.showing(tasks, 50.0):
        time.sleep(0.2)
    line = capsys.readouterr().err.splitlines()[1]
    assert line == f"flexproof: 0/{len(tasks)} done, 0 s elapsed, about 100 s left"


def test_quiet_command_writes_no_progress(monkeypatch, capsys):
    """FLEXPROOF_QUIET=1, as --quiet sets it."""
    monkeypatch.setattr(telling, "_ESTIMATE_DELAY", 0.02)
    for variable, written in (("", True), ("1", False)):
        monkeypatch.setenv(streams.QUIET, variable)
        with telling.stage("meshing", 1e4):
            time.sleep(0.1)
        assert bool(capsys.readouterr().err) is written
