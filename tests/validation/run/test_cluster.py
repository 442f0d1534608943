"""Work on a real Dask scheduler and two workers, one of which is killed in mid-run."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from functools import partial
from pathlib import Path
from threading import Event, Thread, Timer

import numpy as np
import pytest
from crane import write_meshed_crane
from forgetting import forget
from numpy.testing import assert_allclose
from toy_runs import content

from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from validation import api, cli
from validation.adequacy.mechanism.parts import highest_of_parts, solid_parts
from validation.adequacy.mechanism.path import holding, offered, path_postures
from validation.context import Context
from validation.models import parts
from validation.run import cluster as on_dask
from validation.run.cluster import on_cluster
from validation.run.opening import open_folder
from validation.session.parts_ahead import prepare_parts

ROOT = Path(__file__).resolve().parents[3]

pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")


def start(*arguments, log, root=ROOT):
    return subprocess.Popen(
        [sys.executable, "-m", *arguments],
        cwd=log.parent,
        env=os.environ | {"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1"},
        stdout=log.open("wb"),
        stderr=subprocess.STDOUT,
    )


def started_scheduler(folder):
    """A scheduler on a free loopback port, and its address."""
    log = folder / "scheduler.log"
    process = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
                    "--no-dashboard", "--no-show", log=log)  # fmt: skip
    for _ in range(600):
        if found := re.search(r"Scheduler at:\s+(tcp://\S+)", log.read_text(encoding="utf-8")):
            return process, found[1]
        time.sleep(0.1)
    raise AssertionError(log.read_text(encoding="utf-8"))


def started_worker(address, folder, name, root=ROOT):
    """A worker with one thread and without a nanny: a killed one is gone, as a machine would be."""
    return start("distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1",
                 "--no-dashboard", "--host", "127.0.0.1", "--name", name,
                 log=folder / f"{name}.log", root=root)  # fmt: skip


@pytest.fixture
def processes():
    """Processes that end with the test, the last one first."""
    running = []
    yield running
    for process in reversed(running):
        process.kill()
        process.wait(timeout=30)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Address of a scheduler, its two workers and itself, and the folder of the workers' cache.

    A busy machine may need a minute for what takes seconds: everything waits so long.
    """
    folder = tmp_path_factory.mktemp("cluster")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(on_dask, "_ANSWER", 60.0)
        patch.delenv("FLEXPROOF_CACHE", raising=False)
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        scheduler, address = started_scheduler(folder)
        workers = [started_worker(address, folder, f"worker{number}") for number in range(2)]
        patch.delenv("XDG_CACHE_HOME")
        yield address, (*workers, scheduler), folder / "cache"
    for process in (*workers, scheduler):
        process.kill()
        process.wait(timeout=30)


def silent(_line):
    """Nothing is expected to be said."""


def test_varied_robots_are_the_same_on_the_cluster(cluster, command):
    asked = ["solve", "five-bar", "--model", "beam", "--modes", "2", "--vary", "tool.mass=1:2:2"]
    assert command.json(*asked, "--cluster", cluster[0]) == command.json(*asked)


def test_parts_are_reduced_by_a_worker_and_nothing_of_them_here(tmp_path, monkeypatch, cluster):
    """Workers with a cache of their own, and without the file: what they reduce lies here then."""
    address, _, theirs = cluster
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "here"))
    context = Context(load_robot(write_meshed_crane(tmp_path)), "quick")
    with on_cluster(address, silent) as executor:
        prepare_parts(context, executor, carried=True)
    names = [{file.name for file in place.rglob("*.npz")} for place in (tmp_path / "here", theirs)]
    assert len(names[0]) >= 4
    assert names[0] <= names[1]
    forget()
    prepare_parts(context, lambda work: pytest.fail(f"{len(work)} computed again"), carried=True)
    with monkeypatch.context() as patch:
        for one in ("reduction", "free_interface"):
            patch.setattr(parts, one, lambda *_: pytest.fail("reduced again"))
        postures = path_postures(context)
        for ends in holding(context.robot_file.mechanism).alternatives.values():
            assert solid_parts(postures, offered(4), ends)["arm"].size > 12
    # One of the reductions made here: another process, the same numbers.
    arm = context.robot_file.mechanism.bodies["arm"]
    highest, cutoff = highest_of_parts(path_postures(context), offered(4))
    found = parts.reduced(arm, highest, cutoff)
    shutil.rmtree(tmp_path / "here")
    forget()
    own = parts.reduced(arm, highest, cutoff)
    assert own.counted == found.counted > 0
    for mine, its in ((own.stiffness, found.stiffness), (own.mass, found.mass)):
        assert_allclose(mine, its, rtol=1e-12, atol=1e-12 * np.abs(its).max())


def test_a_killed_worker_loses_nothing_and_a_killed_scheduler_is_said(cluster):
    """The last test on the cluster that all of them share."""
    address, (killed, other, scheduler), _ = cluster
    found, places = {}, np.linspace(0.0, 0.1, 8).tolist()
    calls = [partial(api.solve, "five-bar", "beam", poses=[[x, 0.5]], modes=2) for x in places]
    with on_cluster(address, silent) as executor:
        for number, solution in executor(calls):
            found[number] = solution.answers[0]
            if len(found) == 3:
                killed.kill()
        with pytest.raises(InputError, match="no-such-robot"):
            list(executor([partial(load_robot, "no-such-robot")]))
        assert killed.wait(timeout=30) == -signal.SIGKILL
        assert other.poll() is None
        finished = executor([partial(abs, -1)] * 3)
        next(finished)
        # All are computed; it stops answering, and dies while a result is fetched.
        time.sleep(1.0)
        scheduler.send_signal(signal.SIGSTOP)
        Timer(1.0, scheduler.kill).start()
        with pytest.raises(ComputationError, match="the scheduler is gone"):
            list(finished)
    assert sorted(found) == list(range(8))
    for number, call in enumerate(calls):
        (here,) = call().answers
        assert_allclose(found[number].compliance, here.compliance, rtol=1e-12, atol=0.0)
        assert_allclose(found[number].frequencies, here.frequencies, rtol=1e-12)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("http://127.0.0.1:80", "not the address of a scheduler"),
        ("tcp://127.0.0.1:99999", "not the address of a scheduler"),
        ("tcp://a..b:1", "no Dask scheduler answers there: no name of a host"),
        ("tcp://127.0.0.1:1", "no Dask scheduler answers there: Connection refused"),
    ],
)
def test_an_earlier_run_survives_a_scheduler_that_is_not_there(address, said, tmp_path, capfd):
    with open_folder(tmp_path / "run", {}, "afresh") as folder:
        folder.write({"results.json": "precious"})
        folder.complete = True
    before = content(tmp_path)
    arguments = ["run", "--preset", "quick", "--out", str(tmp_path / "run"), "--cluster", address]
    assert cli.main([*arguments, "--vary", "platform.mass=40:50:2"]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("flexproof: --cluster")
    assert said in line
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    ("greeting", "answer", "said"),
    [(b"HTTP/1.1 400", 60.0, "is not a Dask scheduler"), (b"", 0.2, "timed out")],
)
def test_something_else_at_the_address(greeting, answer, said, monkeypatch):
    monkeypatch.setattr(on_dask, "_ANSWER", answer)
    over = Event()
    with socket.create_server(("127.0.0.1", 0)) as server:

        def greet():
            connection, _ = server.accept()
            connection.sendall(greeting)
            over.wait()
            connection.close()

        greeting_thread = Thread(target=greet)
        greeting_thread.start()
        port = server.getsockname()[1]
        with pytest.raises(InputError, match=said), on_cluster(f"tcp://127.0.0.1:{port}", silent):
            pass
        over.set()
        greeting_thread.join()


def test_without_dask_the_message_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setattr(on_dask, "require_scheduler", silent)
    needed = r"Dask is not installed; pip install 'flexproof\[cluster"
    with pytest.raises(InputError, match=needed), on_cluster("tcp://127.0.0.1:9", silent):
        pass


@pytest.mark.exhaustive
def test_no_worker_is_said_and_the_run_goes_on_when_one_comes(tmp_path, monkeypatch, processes):
    monkeypatch.setattr("validation.run.cluster._PATIENCE", 1.0)
    scheduler, address = started_scheduler(tmp_path)
    processes.append(scheduler)
    said = []

    def say(line):
        said.append(line)
        if "no workers" in line:
            processes.append(started_worker(address, tmp_path, f"worker{len(said)}"))

    with on_cluster(address, say) as executor:
        assert "the scheduler has no workers; waiting for one" in said[0]
        assert "a worker has joined" in said[1]
        finished = executor([partial(time.sleep, 0.5)] * 4)
        next(finished)
        # The only worker dies in the middle of it.
        processes[1].kill()
        assert len(list(finished)) == 3
    assert ["no workers" in line for line in said] == [True, False, True, False]


@pytest.mark.exhaustive
def test_a_worker_of_another_version_is_refused_by_name(tmp_path, processes):
    other = tmp_path / "other"
    for package in ("lumped", "meshes", "fem", "validation"):
        shutil.copytree(ROOT / package, other / package)
    with (other / "lumped" / "errors.py").open("a") as file:
        file.write("# another version\n")
    scheduler, address = started_scheduler(tmp_path)
    processes += [scheduler, started_worker(address, tmp_path, "sound")]
    with on_cluster(address, silent) as executor:
        assert [result for _, result in executor([partial(abs, -1)])] == [1]
        # One that joins later is refused when it is given work.
        processes.append(started_worker(address, tmp_path, "stale", other))
        with pytest.raises(ComputationError, match=r"worker stale \(tcp://.*another flexproof"):
            list(executor([partial(time.sleep, 0.1)] * 600))
    refused = r"worker stale \(tcp://.*\) has another flexproof, or none; install this one"
    with (
        pytest.raises(InputError, match=refused),
        on_cluster(address, silent),
    ):
        pass
