"""Progress where no terminal is: words, a line a second, and nothing of a short run."""

import time

import toy_catalogue as toys

from lumped.robot_file import load_robot
from validation.console import progress as telling
from validation.session import progress


def test_a_long_run_says_how_far_it_is_and_a_short_one_nothing(monkeypatch, capsys):
    tasks = list(toys.sound(load_robot("ifw")))
    with progress.showing(tasks, 0.0) as shown:
        shown.started(tasks[0])
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(telling, "_QUIET", 0.05)
    monkeypatch.setattr(telling, "_SOON", 0.02)
    with progress.showing(tasks, 0.0) as shown:
        shown.started(tasks[0])
        time.sleep(0.2)
        shown.finished(tasks[0], {"verdict": "disagree"})
        time.sleep(1.1)
    first, second = capsys.readouterr().err.splitlines()[:2]
    count = len(tasks)
    assert first == f"flexproof: 0/{count} done, 0 s elapsed"
    begins = f"flexproof: 1/{count} done, 1 not in agreement, 1 s elapsed, about "
    assert second.startswith(begins)
    # What is done took its share of the efforts.
    share = tasks[0].effort / sum(task.effort for task in tasks)
    left = float(second.removeprefix(begins).split()[0])
    assert abs(left - 1.1 * (1.0 / share - 1.0)) < 0.3 / share + 1.0


def test_a_file_on_a_terminal_may_have_any_name(monkeypatch, capsys):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with telling.stage("reading [/red]a[bold].step"):
        time.sleep(0.2)
    assert "reading [/red]a[bold].step" in capsys.readouterr().err


def test_long_work_is_forecast_by_the_speed_of_the_machine(monkeypatch, capsys):
    """A hundred seconds elsewhere are 200 here, and three minutes are told as such."""
    monkeypatch.setattr(telling, "slowness", lambda: 2.0)
    monkeypatch.setattr(telling, "_SOON", 0.02)
    with telling.stage("meshing", 100.0):
        time.sleep(0.1)
    assert capsys.readouterr().err == "flexproof: meshing: about 3 min on this machine\n"
    monkeypatch.setattr(telling, "_QUIET", 0.05)
    with telling.stage("meshing", 50.0):
        time.sleep(0.2)
    forecast, line = capsys.readouterr().err.splitlines()
    assert forecast == "flexproof: meshing: about 100 s on this machine"
    assert line == "flexproof: meshing: 0 s elapsed, about 100 s left"
