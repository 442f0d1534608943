"""Sweeps on a real Dask scheduler and two workers, one of which is killed in mid-run."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation.models.options import ModelOptions
from validation.sweeps.cluster import on_cluster
from validation.sweeps.journal import Journal
from validation.sweeps.plans import lumped_models, member_units, solid_model
from validation.sweeps.runner import sweep
from validation.sweeps.units import posture_unit

ROOT = Path(__file__).resolve().parents[2]
ROBOT = load_robot("ifw").robot
MODELS = (*lumped_models(4), solid_model("solid", "rigid", 1))
ALPHAS = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0)

pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")


def units():
    return [
        unit
        for alpha in ALPHAS
        for unit in member_units(MODELS, ROBOT, alpha, (0.0, 0.25, 0.5, 0.75, 1.0))
    ]


def start(*arguments, log):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", *arguments],
        cwd=log.parent,
        env=environment,
        stdout=log.open("wb"),
        stderr=subprocess.STDOUT,
    )


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Address of a scheduler on a free loopback port, and the processes of its two workers.

    The workers have no nanny: a killed one is gone, as a machine would be.
    """
    folder = tmp_path_factory.mktemp("cluster")
    log = folder / "scheduler.log"
    processes = [
        start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
              "--no-dashboard", "--no-show", log=log)
    ]  # fmt: skip
    address = None
    for _ in range(600):
        if found := re.search(r"Scheduler at:\s+(tcp://\S+)", log.read_text(encoding="utf-8")):
            address = found[1]
            break
        time.sleep(0.1)
    assert address is not None, log.read_text(encoding="utf-8")
    workers = [
        start("distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1",
              "--no-dashboard", "--host", "127.0.0.1", log=folder / f"worker{number}.log")
        for number in range(2)
    ]  # fmt: skip
    processes += workers
    yield address, workers
    for process in reversed(processes):
        process.terminate()
    for process in processes:
        process.wait(timeout=30)


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_changes_no_number(cluster, tmp_path):
    address, workers = cluster
    asked = units()
    finished = []
    with on_cluster(address) as executor:

        def killing(calls):
            for number, result in executor(calls):
                finished.append(number)
                if len(finished) == 3:
                    os.kill(workers[0].pid, signal.SIGKILL)
                yield number, result

        found = sweep(asked, killing, Journal(tmp_path))
    assert workers[0].wait(timeout=30) == -signal.SIGKILL
    assert workers[1].poll() is None
    # Each leg and each unit of postures arrived exactly once.
    legs = {id(unit.legs) for unit in asked if unit.legs}
    assert len(finished) == 2 * len(legs) + len(asked)
    for there, here in zip(found, sweep(asked), strict=True):
        # Required: the same numbers to 1e-12 on a cluster.
        assert_allclose(there.compliances, here.compliances, rtol=1e-12, atol=1e-18)
        assert_allclose(there.frequencies, here.frequencies, rtol=1e-12)


@pytest.mark.slow
def test_what_a_unit_raises_arrives_here(cluster):
    address, _ = cluster
    unit = posture_unit("beam", ROBOT, (0.5,), 4, ModelOptions(elements=6), highest=300.0)
    with (
        pytest.raises(InputError, match=r"frequency 4 is 35\d.*above the 300 Hz"),
        on_cluster(address) as executor,
    ):
        sweep([unit], executor)


def test_nobody_at_the_address(monkeypatch):
    monkeypatch.setattr("validation.sweeps.cluster._PATIENCE", 1.0)
    with (
        pytest.raises(InputError, match=r"--cluster tcp://127\.0\.0\.1:9: no Dask scheduler"),
        on_cluster("tcp://127.0.0.1:9"),
    ):
        pass


def test_without_dask_the_message_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"Dask is not installed; pip install 'flexproof\[cluster"),
        on_cluster("tcp://127.0.0.1:9"),
    ):
        pass
