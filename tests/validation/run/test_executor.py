"""Calls on the cores of this machine: what is finished is kept, and what dies is lost alone."""

import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from forgetting import forget
from numpy.testing import assert_array_equal

from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from meshes.processes import Crashed
from validation.run.executor import in_turn, on_cores
from validation.variations.curves import computed

ROOT = Path(__file__).resolve().parents[3]


@dataclass(frozen=True, eq=False)
class Powers:
    """What a unit yields: numbers and arrays."""

    powers: np.ndarray
    total: float


@dataclass(frozen=True)
class Unit:
    """The first powers of a base."""

    base: float

    def compute(self):
        powers = self.base ** np.arange(4)
        return Powers(powers, float(powers.sum()))


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A cache of the test's own, in which nothing is remembered."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))
    forget()
    return tmp_path / "cache"


def test_equal_units_are_computed_once_and_taken_up_in_order():
    units, calls = [Unit(2.0), Unit(3.0), Unit(2.0)], []

    def counting(works):
        calls.extend(works)
        yield from reversed([(number, work()) for number, work in enumerate(works)])

    found = computed(units, Powers, counting, "raising")
    assert [one.total for one in found] == [15.0, 40.0, 15.0]
    assert len(calls) == 2
    forget()
    (again,) = computed(units[1:2], Powers, pytest.fail, "raising")
    assert_array_equal(again.powers, [1.0, 3.0, 9.0, 27.0])


def test_units_are_computed_though_nothing_can_be_kept(monkeypatch):
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    # More than are remembered.
    units = [Unit(float(base)) for base in range(200)]
    found = computed(units, Powers, in_turn, "raising")
    assert [one.powers[1] for one in found] == [unit.base for unit in units]


SLOW = """
import os, sys, time
from dataclasses import dataclass
from pathlib import Path
from validation.run.executor import on_cores
from validation.variations.curves import computed

@dataclass(frozen=True)
class Number:
    number: int

@dataclass(frozen=True)
class Slow:
    number: int

    def compute(self):
        Path(f"{os.getpid()}.process").touch()
        time.sleep(0.05 if self.number < 2 else 60.0)
        return Number(self.number)

def main():
    try:
        with on_cores(2) as executor:
            computed([Slow(number) for number in range(6)], Number, executor, "sleeping")
    except KeyboardInterrupt:
        sys.exit(3)
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_ctrl_c_and_a_kill_end_all_processes_and_keep_what_was_finished(tmp_path, folder, how):
    (tmp_path / "slow.py").write_text(SLOW, encoding="utf-8")
    # A script that does not ask whether it is run by hand is not run again by its processes.
    (tmp_path / "script.py").write_text("import slow\nslow.main()\n", encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    # Some seconds on a loaded machine, and a limit for a hang.
    for _ in range(600):
        if len(list(folder.glob("*.npz"))) == 2:
            break
        time.sleep(0.1)
    begun = time.monotonic()
    # As a terminal does: to every process of the group.
    os.killpg(process.pid, how)
    _, messages = process.communicate(timeout=30)
    assert process.returncode == (3 if how == signal.SIGINT else -how), messages.decode()
    assert messages.decode() == ""
    assert len(list(folder.glob("*.npz"))) == 2
    workers = [int(file.stem) for file in tmp_path.glob("*.process")]
    assert len(workers) == 2
    while any(Path(f"/proc/{worker}").exists() for worker in workers):
        assert time.monotonic() - begun < 20.0
        time.sleep(0.05)


def test_a_call_that_dies_is_lost_alone(tmp_path):
    """Its neighbours are computed, the rest of its group as well, and how it died is told."""
    dies, lives = partial(os.kill, os.getpid(), 0), partial(abs, -1)
    groups = [
        [("killed", partial(kill_myself, signal.SIGKILL)), ("after it", lives)],
        [("crash", partial(kill_myself, signal.SIGSEGV))],
        [("left", partial(os._exit, 9))],
        [("full", partial(bytearray, 2**62))],
        [("refused", partial(load_robot, "no-such-robot"))],
        [(f"sound {number}", lives) for number in range(4)],
        [("odd", partial(divmod, 1, 0)), ("after the odd", dies)],
    ]
    started = []
    with (
        on_cores(2, tmp_path / "log") as cores,
        closing(cores.answers(groups, started.append)) as answers,
    ):
        found = dict(answers)
    names = [name for group in groups for name, _ in group]
    assert sorted(found) == sorted(started) == sorted(names)
    assert {found[name] for name in names if name.startswith("sound")} == {1}
    assert found["after it"] == 1
    assert found["after the odd"] is None
    said = {name: str(answer) for name, answer in found.items() if isinstance(answer, Exception)}
    assert "was ended by SIGKILL, probably for want of memory" in said["killed"]
    assert "was ended by SIGSEGV" in said["crash"]
    assert "ended with code 9" in said["left"]
    assert said["full"] == "memory ran out"
    assert said["odd"].startswith("ZeroDivisionError: ")
    assert isinstance(found["refused"], InputError)
    assert {name for name in said if isinstance(found[name], Crashed)} == {
        "killed",
        "crash",
        "left",
    }
    log = (tmp_path / "log").read_text()
    assert "Segmentation fault" in log
    assert "ZeroDivisionError" in log


def kill_myself(how):
    os.kill(os.getpid(), how)


def test_a_unit_that_is_lost_ends_its_sweep_and_names_the_cause():
    with (
        pytest.raises(ComputationError, match="code 9; what was finished is kept: start it again"),
        on_cores(1) as executor,
    ):
        list(executor([partial(os._exit, 9)]))
    with pytest.raises(InputError, match="no-such-robot"), on_cores(1) as executor:
        list(executor([partial(load_robot, "no-such-robot")]))


def test_what_is_given_up_is_not_waited_for():
    begun = time.monotonic()
    with on_cores(2) as cores:
        groups = [[(number, partial(time.sleep, 60.0 * (number > 0)))] for number in range(3)]
        finished = []
        for number, _ in cores.answers(groups, stopped=lambda: bool(finished)):
            finished.append(number)
    assert finished == [0]
    assert time.monotonic() - begun < 30.0
