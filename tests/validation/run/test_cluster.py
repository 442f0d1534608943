"""Robots of --vary on a real Dask scheduler and two workers, one of which is killed in mid-run."""

import os
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from functools import partial
from operator import itemgetter
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from crane import write_meshed_crane
from forgetting import forget
from numpy.testing import assert_allclose
from one_arm import ONE_ARM

from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from lumped.robot_file.variation import variations_of
from validation import api, cli
from validation.adequacy.mechanism.parts import highest_of_parts
from validation.adequacy.mechanism.path import offered, path_postures
from validation.context import Context
from validation.models import parts
from validation.run.cluster import on_cluster
from validation.run.executor import on_cores
from validation.run.opening import open_folder
from validation.session.parts_ahead import prepare_parts
from validation.variations.curves import variation_study

ROOT = Path(__file__).resolve().parents[3]
ARM = f"{ONE_ARM}[path]\nposes = [[0.0], [0.1]]\n"
VARY = "bodies.arm.section.width=0.04:0.06:2"

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")


def varied(folder, *executor):
    """Curves of an arm of two widths, four units, by what computes them."""
    path = folder / "arm.toml"
    path.write_text(ARM, encoding="utf-8")
    robot = load_robot(path)
    (variation,) = variations_of(robot, [VARY])
    return variation_study(robot, variation, "quick", *executor)


def require_equal(found, expected):
    """Every number of the decisions, byte for byte."""
    for objective, curves in expected.items():
        for part in ("models", "references", "uncertainties"):
            own, its = (getattr(one.decision, part) for one in (curves, found[objective]))
            assert {name: values.tobytes() for name, values in own.items()} == {
                name: values.tobytes() for name, values in its.items()
            }


def start(*arguments, log, root=ROOT):
    environment = os.environ | {"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", *arguments],
        cwd=log.parent,
        env=environment,
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
    """Address of a scheduler, and the processes of its two workers."""
    folder = tmp_path_factory.mktemp("cluster")
    scheduler, address = started_scheduler(folder)
    workers = [started_worker(address, folder, f"worker{number}") for number in range(2)]
    yield address, workers
    for process in (*workers, scheduler):
        process.kill()
    for process in (*workers, scheduler):
        process.wait(timeout=30)


def scheduled(address):
    """How often a task has changed its state on the scheduler."""
    with distributed.Client(address) as client:
        return client.run_on_scheduler(lambda dask_scheduler: dask_scheduler.transition_counter)


def silent(_line):
    """Nothing is expected to be said."""


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_changes_no_number(cluster):
    address, workers = cluster
    finished, poses = [], [[x, 0.5] for x in np.linspace(0.0, 0.1, 12).tolist()]
    calls = [partial(api.solve, "five-bar", "beam", poses=[pose], modes=2) for pose in poses]
    with on_cluster(address, silent) as executor:
        for number, solution in executor(calls):
            finished.append((number, solution.answers[0]))
            if len(finished) == 3:
                os.kill(workers[0].pid, signal.SIGKILL)
        with pytest.raises(InputError, match="no-such-robot"):
            list(executor([partial(load_robot, "no-such-robot")]))
    assert workers[0].wait(timeout=30) == -signal.SIGKILL
    assert workers[1].poll() is None
    # In a process of this machine, with one thread as workers have.
    with on_cores(1) as executor:
        here = [(number, solution.answers[0]) for number, solution in executor(calls)]
    assert [number for number, _ in sorted(finished, key=itemgetter(0))] == list(range(12))
    for number, answer in here:
        found = dict(finished)[number]
        assert found.compliance.tobytes() == answer.compliance.tobytes()
        assert found.frequencies.tobytes() == answer.frequencies.tobytes()


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("nonsense", "no address of a scheduler"),
        ("http://127.0.0.1:80", "no address of a scheduler"),
        ("tcp://127.0.0.1:99999", "no address of a scheduler"),
        ("tcp://127.0.0.1:1", "no Dask scheduler answers there: Connection refused"),
        ("tcp://no-such-host.invalid:8786", "no Dask scheduler answers there"),
    ],
)
def test_an_earlier_run_survives_a_scheduler_that_is_not_there(
    address, said, tmp_path, monkeypatch, capfd
):
    with open_folder(tmp_path / "run", {}, "afresh") as folder:
        folder.write({"results.json": "precious"})
        folder.complete = True
    before = {f: f.read_bytes() for f in tmp_path.rglob("*") if f.is_file()}
    monkeypatch.chdir(tmp_path)
    arguments = ["run", "--preset", "quick", "--out", "run", "--cluster", address]
    arguments += ["--vary", "platform.mass=40:50:2"]
    assert cli.main(arguments) == 2
    printed = capfd.readouterr()
    assert printed.err.startswith("flexproof: --cluster")
    assert said in printed.err
    assert len(printed.err.splitlines()) == 1
    after = {f: f.read_bytes() for f in tmp_path.rglob("*") if f.is_file()}
    assert after == before


@pytest.mark.parametrize(
    ("greeting", "said"), [(b"HTTP/1.1 400", "is no Dask scheduler"), (b"", "timed out")]
)
def test_something_else_at_the_address(greeting, said, monkeypatch):
    monkeypatch.setattr("validation.run.cluster._ANSWER", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer():
            connection, _ = server.accept()
            connection.sendall(greeting)
            time.sleep(2.0)
            connection.close()

        answering = Thread(target=answer)
        answering.start()
        port = server.getsockname()[1]
        with pytest.raises(InputError, match=said), on_cluster(f"tcp://127.0.0.1:{port}", silent):
            pass
        answering.join()


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
        assert "a worker has come" in said[1]
        finished = executor([partial(time.sleep, 0.5)] * 4)
        next(finished)
        # The only worker dies in the middle of it.
        processes[1].kill()
        assert len(list(finished)) == 3
    assert ["no workers" in line for line in said] == [True, False, True, False]


@pytest.mark.exhaustive
def test_a_scheduler_that_dies_loses_nothing_that_was_finished(tmp_path, monkeypatch, processes):
    monkeypatch.setattr("validation.run.cluster._PATIENCE", 1.0)
    scheduler, address = started_scheduler(tmp_path)
    processes += [scheduler, started_worker(address, tmp_path, "worker")]
    kept, finished = tmp_path / "cache", []
    monkeypatch.setenv("FLEXPROOF_CACHE", str(kept))
    forget()

    def killing(calls):
        for number, result in executor(calls):
            finished.append(number)
            if len(finished) == 2:
                scheduler.kill()
            yield number, result

    gone = "the scheduler is gone; what was finished is kept"
    with on_cluster(address, silent) as executor, pytest.raises(ComputationError, match=gone):
        varied(tmp_path, killing)
    assert len(list(kept.glob("*.npz"))) >= 2
    forget()
    resumed = varied(tmp_path)
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    forget()
    with on_cores(1) as executor:
        require_equal(resumed, varied(tmp_path, executor))


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


def test_varied_robots_are_the_same_on_the_cluster(cluster, capsys):
    asked = ["solve", "five-bar", "--model", "beam", "--modes", "2", "--vary", "tool.mass=1:2:3"]
    assert cli.main([*asked, "--json"]) == 0
    here = capsys.readouterr().out
    assert cli.main([*asked, "--json", "--cluster", cluster[0]]) == 0
    assert capsys.readouterr().out == here


def test_parts_are_reduced_by_a_worker_and_nothing_of_them_here(tmp_path, monkeypatch, processes):
    """A worker with a cache of its own, and without the file: what it reduces lies here then."""
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "there"))
    scheduler, address = started_scheduler(tmp_path)
    processes += [scheduler, started_worker(address, tmp_path, "worker")]
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "here"))
    context = Context(load_robot(write_meshed_crane(tmp_path)), "quick")
    with on_cluster(address, silent) as executor:
        prepare_parts(context, executor, carried=True)
    here, there = (sorted((tmp_path / name).rglob("*.npz")) for name in ("here", "there"))
    assert len(here) >= 4
    assert [file.name for file in here] == [file.name for file in there]
    computed = []
    prepare_parts(context, lambda work: computed.append(work) or (), carried=False)
    assert not computed
    # The same reductions made here: other processes, the same numbers.
    arm = context.robot_file.mechanism.bodies["arm"]
    highest, cutoff = highest_of_parts(path_postures(context), offered(4))
    theirs = parts.reduced(arm, highest, cutoff)
    shutil.rmtree(tmp_path / "here")
    forget()
    own = parts.reduced(arm, highest, cutoff)
    assert own.counted == theirs.counted > 0
    for mine, its in ((own.stiffness, theirs.stiffness), (own.mass, theirs.mass)):
        assert_allclose(mine, its, rtol=1e-12, atol=1e-12 * np.abs(its).max())


def test_without_dask_the_message_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setattr("validation.run.cluster.require_scheduler", silent)
    with (
        pytest.raises(InputError, match=r"Dask is not installed; pip install 'flexproof\[cluster"),
        on_cluster("tcp://127.0.0.1:9", silent),
    ):
        pass


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(0, marks=pytest.mark.exhaustive),
        *(pytest.param(k, marks=pytest.mark.soak) for k in range(1, 5)),
    ],
)
def test_a_run_on_a_cluster_that_is_killed_goes_on_to_the_same_numbers(cluster_of_one, seed):
    address, here, folder = cluster_of_one
    path, moments = folder / f"run{seed}", random.Random(seed)  # noqa: S311  any moments will do
    resumed = []
    for _ in range(2):
        known = len(list(cache_of(path).glob("*.npz")))
        run = validated(path, "--cluster", address, *resumed)
        more = moments.randrange(1, 3)
        while run.poll() is None and len(list(cache_of(path).glob("*.npz"))) < known + more:
            time.sleep(0.01)
        resumed = ["--resume"]
        run.kill()
        run.communicate()
    done = validated(path, "--cluster", address, "--resume")
    _, said = done.communicate()
    assert done.returncode == 0, said
    # All models of a mechanism, its solid among them, for each value on the worker.
    assert scheduled(address) > 0
    assert len(here) >= 2
    assert swept(path) == here


def cache_of(path):
    """What a run finds computed already, and no other run."""
    return path.with_name(f"{path.name}.cache")


def validated(path, *arguments):
    """A run over a number of the arm alone."""
    robot = path.parent / "arm.toml"
    robot.write_text(ARM, encoding="utf-8")
    asked = ("--preset", "quick", "--only", "vary.*", "--vary", VARY, "--out", str(path))
    return subprocess.Popen(
        [sys.executable, "-m", "validation.cli", "run", str(robot), *asked, *arguments],
        cwd=ROOT,
        env=os.environ
        | {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "FLEXPROOF_CACHE": str(cache_of(path))},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def swept(path):
    """The numbers that the figures show."""
    return {file.name: file.read_text() for file in sorted((path / "figures").glob("*.csv"))}


@pytest.fixture(scope="module")
def cluster_of_one(tmp_path_factory):
    """Address of a cluster with one worker, what a run without it finds, and a folder."""
    folder = tmp_path_factory.mktemp("one")
    alone = validated(folder / "alone")
    _, said = alone.communicate()
    assert alone.returncode == 0, said
    scheduler, address = started_scheduler(folder)
    worker = started_worker(address, folder, "only")
    yield address, swept(folder / "alone"), folder
    for process in (worker, scheduler):
        process.kill()
        process.wait(timeout=30)
