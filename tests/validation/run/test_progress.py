"""Progress where no terminal is: words, a line a second, and nothing of a short run."""

import time

import toy_catalogue as toys

from lumped.robot_file import load_robot
from validation.session import progress


def test_a_long_run_says_how_far_it_is_and_a_short_one_nothing(monkeypatch, capsys):
    tasks = list(toys.sound(load_robot("ifw")))
    with progress.showing(tasks) as shown:
        shown.started(tasks[0])
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(progress, "_QUIET", 0.05)
    with progress.showing(tasks) as shown:
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
