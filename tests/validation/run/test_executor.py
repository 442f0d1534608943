"""Calls on the cores of this machine: results, crashes, and cancellation."""

import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from support.fakes.cleared_memory import forget
from support.fakes.toy_runs import PATIENCE, started, wait_for

from fem.machine import ONE_BLAS_THREAD
from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from meshes.processes import Crashed
from validation.run.cache import key_of
from validation.run.executor import in_turn, on_cores
from validation.run.stored_results import stored_arrays

ROOT = Path(__file__).resolve().parents[3]


def powers_of(base):
    """Arrays of a made-up result: the first four powers of a base, and their sum."""
    powers = base ** np.arange(4)
    return {"powers": powers, "total": powers.sum()}


def computed(bases, executor):
    """Arrays of the powers of each base, stored in the cache."""
    tasks = {key_of("powers", base): partial(powers_of, base) for base in bases}
    arrays = stored_arrays(tasks, ("powers", "total"), executor)
    return [arrays[key_of("powers", base)] for base in bases]


def test_finished_calls_are_computed_once(tmp_path, monkeypatch):
    """After an interruption only the missing calls are computed, in any order."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path))
    bases = (2.0, 3.0, 2.0, 5.0)

    def interrupted(works):
        yield 1, works[1]()
        raise KeyboardInterrupt

    def backwards(works):
        assert len(works) == 2
        yield from reversed(list(in_turn(works)))

    with pytest.raises(KeyboardInterrupt):
        computed(bases, interrupted)
    for executor in (backwards, pytest.fail):
        forget()
        powers = computed(bases, executor)
        assert [power["total"] for power in powers] == [15.0, 40.0, 15.0, 156.0]
        assert_array_equal(powers[1]["powers"], [1.0, 3.0, 9.0, 27.0])


def test_results_are_computed_without_cache(monkeypatch):
    """200 results with FLEXPROOF_CACHE=off."""
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    powers = computed([float(base) for base in range(200)], in_turn)
    assert [power["powers"][1] for power in powers] == list(range(200))


SCRIPT = """
import sys, time
from functools import partial
from pathlib import Path
from validation.run.executor import on_cores

sleep = partial(time.sleep, 60.0)
groups = [[(name, Path(name).touch), (f"after {name}", sleep)] for name in ("one", "two")]
try:
    with on_cores(2) as cores:
        list(cores.answers(groups))
except KeyboardInterrupt:
    sys.exit(3)
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_ctrl_c_and_kill_end_all_processes(tmp_path, monkeypatch, how):
    """SIGINT or SIGKILL of the main process also ends its workers."""
    # A script that does not ask whether it is run by hand is not run again by its processes.
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    process = started([sys.executable, "script.py"])
    wait_for(lambda: len(list(tmp_path.iterdir())) == 3)
    workers = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    assert len(workers) == 2
    # As a terminal does: to every process of the group.
    os.killpg(process.pid, how)
    _, messages = process.communicate(timeout=PATIENCE)
    assert (process.returncode, messages) == (3 if how == signal.SIGINT else -how, "")
    wait_for(lambda: not any(Path(f"/proc/{worker}").exists() for worker in workers))


def test_crashed_call_ends_only_itself(tmp_path):
    """Other calls and the rest of its group are computed, and the cause of death is reported."""
    lives = partial(abs, -1)
    groups = [
        [("killed", partial(signal.raise_signal, signal.SIGKILL)), ("after it", lives)],
        [("full", partial(bytearray, 2**62))],
        [("refused", partial(load_robot, "no-such-robot"))],
        [("sound", lives), ("odd", partial(divmod, 1, 0)), ("after the odd", lives)],
    ]
    started = []
    with (
        on_cores(2, tmp_path / "log") as cores,
        closing(cores.answers(groups, started.append)) as answers,
    ):
        results = dict(answers)
    assert (
        sorted(results) == sorted(started) == sorted(name for group in groups for name, _ in group)
    )
    assert {results[name] for name in ("sound", "after it", "after the odd")} == {1}
    messages = {
        name: str(answer) for name, answer in results.items() if isinstance(answer, Exception)
    }
    assert "was ended by SIGKILL, probably because of lack of memory" in messages["killed"]
    assert messages["full"] == "out of memory"
    assert messages["odd"].startswith("ZeroDivisionError: ")
    assert isinstance(results["refused"], InputError)
    assert [name for name in messages if isinstance(results[name], Crashed)] == ["killed"]
    assert "ZeroDivisionError" in (tmp_path / "log").read_text()


def test_lost_process_is_reported():
    """The executor raises the error of a call, or one that names the exit code of its process."""
    with on_cores(1) as executor:
        with pytest.raises(ComputationError, match="code 9; start it again"):
            list(executor([partial(os._exit, 9)]))
        with pytest.raises(InputError, match="no-such-robot"):
            list(executor([partial(load_robot, "no-such-robot")]))


def test_cancelled_calls_end_at_once():
    """Calls of a minute end when the first result stops the run."""
    begun = time.monotonic()
    with on_cores(2) as cores:
        groups = [[(number, partial(time.sleep, 60.0 * (number > 0)))] for number in range(3)]
        finished = []
        for number, _ in cores.answers(groups, stopped=lambda: bool(finished)):
            finished.append(number)
    assert finished == [0]
    assert time.monotonic() - begun < 30.0


BITS = """
from validation.api import converge, solve
from validation.run.executor import on_cores

def bits():
    (answer,) = solve("five-bar", "segments", modes=6).answers
    series = converge("five-bar", "segments", body="rod1").series
    numbers = answer.frequencies, answer.compliance, *(one.values for one in series)
    return [number.tobytes().hex() for number in numbers]
"""
EQUAL = """
import os
from threadpoolctl import threadpool_info
from bits import bits, on_cores

def threads():
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}

# OpenBLAS starts no more threads than there are processors.
expected = {min(2, len(os.sched_getaffinity(0)))}
assert threads() == expected, threads()
here = bits()
assert threads() == expected, threads()
with on_cores(1) as executor:
    ((_, there),) = executor([bits])
assert here == there
"""


def test_worker_results_are_bit_identical(tmp_path):
    """BLAS runs with one thread in workers; with two threads these numbers differ by up to 1e-9."""
    (tmp_path / "bits.py").write_text(BITS, encoding="utf-8")
    (tmp_path / "equal.py").write_text(EQUAL, encoding="utf-8")
    blas = dict.fromkeys(ONE_BLAS_THREAD, "2")
    completed = subprocess.run(
        [sys.executable, "equal.py"],
        cwd=tmp_path,
        env={**os.environ, **blas, "OMP_NUM_THREADS": "2", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        check=False,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr
