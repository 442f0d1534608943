"""Work on a real Dask scheduler and its workers, one of which is killed in mid-run."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from threading import Thread, Timer
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.fakes import toy_catalogue as toys
from support.fakes.cleared_memory import forget
from support.fakes.toy_runs import (
    ENVIRONMENT,
    content,
    lines,
    numbers,
    run_in_this_process,
    wait_for,
)
from support.robots.crane import write_meshed_crane

from lumped.errors import ComputationError, InputError, ProgramError
from lumped.robot_file import load_robot
from meshes.part.reading import read
from validation import cli
from validation.context import Context
from validation.models import reduced_parts
from validation.record_fields import plain_data
from validation.references.part_preparation import prepare_parts
from validation.references.reference_parts import highest_of_parts, solid_parts
from validation.references.robot_on_path import computed_count, holding, path_postures
from validation.run import cluster as on_dask
from validation.run import progress, runner
from validation.run.cache import CacheEntry
from validation.run.cluster import on_cluster
from validation.run.folder import RunFolder, open_folder
from validation.run.provisions import value_by_worker
from validation.solve import varied

ROOT = Path(__file__).resolve().parents[3]

pytestmark = pytest.mark.skipif(
    find_spec("distributed") is None, reason="the extra 'cluster' is not installed"
)


class Cluster:
    """A scheduler on a free loopback port, and workers with a cache of their own in its folder."""

    def __init__(self, folder):
        self.folder, self.processes = folder, {}
        self._start("scheduler", "--port", "0", "--no-show")
        log = folder / "scheduler.log"
        wait_for(lambda: "Scheduler at:" in log.read_text(encoding="utf-8"))
        self.address = re.search(r"tcp://\S+", log.read_text(encoding="utf-8"))[0]

    def worker(self, name, root=ROOT):
        """Start a worker with one thread and no nanny, so that a killed worker is not restarted."""
        words = (self.address, "--no-nanny", "--nthreads", "1", "--name", name)
        self._start("worker", *words, name=name, root=root)

    def _start(self, program, *words, name="scheduler", root=ROOT):
        always = ("--no-dashboard", "--host", "127.0.0.1")
        self.processes[name] = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{program}", *words, *always],
            cwd=self.folder,
            env=ENVIRONMENT | {"PYTHONPATH": str(root), "XDG_CACHE_HOME": str(self.folder)},
            stdout=(self.folder / f"{name}.log").open("wb"),
            stderr=subprocess.STDOUT,
        )


@contextmanager
def started(folder):
    cluster = Cluster(folder)
    yield cluster
    for process in reversed(cluster.processes.values()):
        process.kill()
        process.wait(timeout=30)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch, started(tmp_path_factory.mktemp("one")) as cluster:
        # A busy machine may need a minute for what takes seconds.
        patch.setattr(on_dask, "_ANSWER_TIMEOUT", 60.0)
        cluster.worker("first")
        yield cluster


def silent(_line):
    """Ignore a line of progress."""


@pytest.fixture(scope="module")
def dask():
    """A scheduler and a worker in threads of this process, which receive pickled calls."""
    distributed = pytest.importorskip("distributed")
    options = {
        "processes": False,
        "protocol": "tcp://",
        "host": "127.0.0.1",
        "dashboard_address": "",
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(on_dask, "_ANSWER_TIMEOUT", 60.0)
        with distributed.LocalCluster(1, threads_per_worker=1, **options) as cluster:
            yield cluster


def executed(dask):
    """Number of calls that the workers computed."""
    return sum(worker.state.executed_count for worker in dask.workers.values())


@pytest.fixture(scope="module")
def workers(dask):
    with on_cluster(dask.scheduler_address, silent) as workers:
        yield workers


@pytest.mark.parametrize(
    ("line", "calls"),
    [
        ("solve five-bar --model beam --modes 2 --vary tool.mass=1:2:2", 2),
        ("solve five-bar --model vjm", 1),
        # Two further counts are needed to find the smallest ones below each error.
        ("converge five-bar --body rod1 --model beam --elements 5,10", 4),
    ],
)
def test_command_on_cluster_equals_local_one(
    line, calls, command, monkeypatch, tmp_path, dask, workers
):
    """`solve`, `solve --vary` and `converge` with --cluster: equal JSON, computed by workers."""
    for module in (on_dask, varied):
        monkeypatch.setattr(module, "on_cluster", lambda *_: nullcontext(workers))
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "there"))
    before = executed(dask)
    on_cluster_result = command.json(*line.split(), "--cluster", dask.scheduler_address)
    # The conditions of the run come to the worker once.
    assert executed(dask) - before - calls in (0, 1)
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "here"))
    forget()
    assert on_cluster_result == command.json(*line.split())


@dataclass(frozen=True)
class PartOnDisk:
    """Stand-in for a CAD part; the content of its file is the key of its results."""

    path: Path


def length_entry(part):
    def compute():
        return {"length": len(part.path.read_bytes())}

    return CacheEntry("length", compute, lambda arrays: int(arrays["length"]))


def test_part_is_computed_without_its_file(tmp_path, monkeypatch):
    """A part's file is sent to the other machine, and the result is stored in this one's cache."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))
    part = PartOnDisk(tmp_path / "arm.step")
    part.path.write_bytes(b"solid")

    def on_another_machine(calls):
        part.path.unlink()
        yield from enumerate([call() for call in calls])

    assert value_by_worker(on_another_machine, part, length_entry) == 5
    assert value_by_worker(lambda _: pytest.fail("sent again"), part, length_entry) == 5


def test_run_on_cluster_equals_local_run(tmp_path, workers):
    """Equal values, errors with messages, crash of a worker process, and log."""
    robot = load_robot("ifw")
    context, left_out = Context(robot, "quick"), {"toy.starved"}
    tasks = [task for task in toys.troubled(robot) if task.id not in left_out]
    records, log = {}, tmp_path / "log"
    runner.run(
        toys.troubled,
        context,
        tasks,
        jobs=1,
        log=log,
        cluster=workers,
        keep=lambda record: records.update({record["id"]: record}),
        progress=progress.RunProgress(tasks),
    )
    notes = [records[name]["found"].pop("notes") for name in ("toy.first[x=1]", "toy.second[x=2]")]
    # A group shares what is expensive.
    assert notes[0] == notes[1] != []
    assert "was ended by SIGSEGV" in records.pop("toy.crash")["message"]
    for task in tasks:
        if task.id != "toy.crash":
            local = plain_data(runner.execute(task, context))
            if task.group == "shared":
                del local["found"]["notes"]
            remote = records.pop(task.id)
            assert remote == local | {"seconds": remote["seconds"]}
    assert not records
    for line in ("Traceback", "Segmentation fault", "this belongs into the log"):
        assert line in log.read_text()


# A scheduler with its only worker, which ends with its standard input.
SCHEDULER = """
from distributed import LocalCluster
options = {"processes": False, "protocol": "tcp://", "host": "127.0.0.1", "dashboard_address": ""}
with LocalCluster(1, threads_per_worker=1, **options) as cluster:
    print(cluster.scheduler_address, flush=True)
    input()
"""


@pytest.mark.usefixtures("blank_charts")
def test_resumed_run_after_scheduler_death_is_equal(tmp_path, monkeypatch, capsys):
    """Scheduler and worker are killed after the second result. One process computes the rest."""
    monkeypatch.setattr(on_dask, "_WORKER_TIMEOUT", 0.2)
    catalogue = SimpleNamespace(catalogue=toys.disagreeing)
    monkeypatch.setitem(sys.modules, "validation.catalogue", catalogue)
    words = ["run", "ifw", "--preset", "quick", "--quiet", "--jobs", "1", "--out"]
    scheduler = subprocess.Popen(
        [sys.executable, "-c", SCHEDULER],
        env=ENVIRONMENT | {"XDG_CACHE_HOME": str(tmp_path)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    keep, count = RunFolder.keep, 0

    def keep_and_kill(folder, record, seconds):
        nonlocal count
        keep(folder, record, seconds)
        count += 1
        if count == 2:
            scheduler.kill()
            scheduler.wait()

    address = scheduler.stdout.readline().strip()
    with monkeypatch.context() as patch, scheduler:
        patch.setattr(RunFolder, "keep", keep_and_kill)
        assert cli.main([*words, str(tmp_path / "run"), "--cluster", address]) == 3
    gone, how_to_go_on = capsys.readouterr().err.splitlines()
    assert gone == f"flexproof: --cluster {address}: the scheduler is gone"
    assert how_to_go_on.startswith("flexproof: finished results are kept; continue with: ")
    finished_lines = lines(tmp_path / "run")
    assert len(finished_lines) == 2
    assert cli.main([*words, str(tmp_path / "run"), "--resume"]) == 1
    assert lines(tmp_path / "run")[:2] == finished_lines
    monkeypatch.setattr(runner, "run", run_in_this_process)
    assert cli.main([*words, str(tmp_path / "undisturbed")]) == 1
    assert numbers(tmp_path / "run") == numbers(tmp_path / "undisturbed")


def test_scheduler_lost_at_program_check_is_reported(dask, monkeypatch):
    """Dask's error if the scheduler dies between the connection and the check of all programs."""
    distributed = pytest.importorskip("distributed")

    def unanswered(*_, **__):
        raise OSError("Timed out trying to connect to tcp://127.0.0.1:8786 after 10 s")

    monkeypatch.setattr(distributed.Client, "run", unanswered)
    gone = re.escape(f"--cluster {dask.scheduler_address}: the scheduler is gone")
    with (
        pytest.raises(ComputationError, match=f"{gone}$"),
        on_cluster(dask.scheduler_address, silent),
    ):
        pass


def test_stopped_run_ends_calls_on_workers(tmp_path, workers):
    """A call that nobody awaits is ended, with its process."""
    child = tmp_path / "child"
    answers = workers.answers([[("sleeps", partial(sleep_long, child))]], stopped=child.exists)
    assert list(answers) == []
    wait_for(lambda: not Path("/proc", child.read_text()).exists())


def sleep_long(file):
    """Write the number of this process, and sleep."""
    file.with_suffix(".new").write_text(str(os.getpid()))
    file.with_suffix(".new").replace(file)
    time.sleep(60.0)


def test_late_close_keeps_results(monkeypatch, dask):
    """Dask's `Client.close` raises TimeoutError: results, and the error of a call, are kept."""
    distributed = pytest.importorskip("distributed")
    close = distributed.Client.close

    def late(client, timeout):
        close(client, timeout=60.0)
        raise TimeoutError(f"timed out after {timeout} s.")

    monkeypatch.setattr(distributed.Client, "close", late)
    results = []
    with pytest.raises(ProgramError, match="ZeroDivisionError"):
        append_results(dask.scheduler_address, [partial(abs, -1), partial(divmod, 1, 0)], results)
    assert results == [1]


def append_results(address, calls, results):
    with on_cluster(address, silent) as executor:
        for call in calls:
            results += [result for _, result in executor([call])]


@pytest.mark.soak
def test_parts_are_reduced_on_workers(tmp_path, monkeypatch, cluster):
    """The worker lacks the part's file. Its reductions are stored in this machine's cache, too."""
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "here"))
    monkeypatch.setattr(read, "within_limits", lambda _, function, *arguments: function(*arguments))
    robot = write_meshed_crane(tmp_path)
    # Held in one way, which saves the worker a reduction.
    text = robot.read_text("utf-8").replace(" } }", ' }, coupling = "rigid" }')
    robot.write_text(text, "utf-8")
    context = Context(load_robot(robot), "quick")
    with on_cluster(cluster.address, silent) as executor:
        prepare_parts(context, executor, remote=True)
    places = (tmp_path / "here", cluster.folder)
    names = [{file.name for file in folder.rglob("*.npz")} for folder in places]
    assert len(names[0]) >= 4
    assert names[0] <= names[1]
    forget()
    prepare_parts(context, lambda work: pytest.fail(f"{len(work)} computed again"), remote=True)
    with monkeypatch.context() as patch:
        for function in ("reduction", "free_interface"):
            patch.setattr(reduced_parts, function, lambda *_: pytest.fail("reduced again"))
        postures = path_postures(context)
        for ends in holding(context.robot_file.mechanism).alternatives.values():
            assert solid_parts(postures, computed_count(4), ends)["arm"].size > 12
    # One of the reductions made here: another process, the same numbers.
    arm = context.robot_file.mechanism.bodies["arm"]
    highest, cutoff = highest_of_parts(path_postures(context), computed_count(4))
    first = reduced_parts.reduced(arm, highest, cutoff)
    shutil.rmtree(tmp_path / "here")
    forget()
    second = reduced_parts.reduced(arm, highest, cutoff)
    assert second.counted == first.counted > 0
    for second_matrix, first_matrix in (
        (second.stiffness, first.stiffness),
        (second.mass, first.mass),
    ):
        assert_allclose(
            second_matrix, first_matrix, rtol=1e-12, atol=1e-12 * np.abs(first_matrix).max()
        )


@pytest.mark.exhaustive
def test_killed_worker_loses_no_results(cluster, monkeypatch):
    """Runs last, because it kills a worker of the cluster that all tests of this file share."""
    monkeypatch.setattr(on_dask, "_WORKER_TIMEOUT", 1.0)
    results, messages = {}, []

    def record(line):
        messages.append(line)
        if "no workers" in line:
            cluster.worker("second")

    calls = [partial(subprocess.getoutput, f"sleep {n // 4}; echo {n}") for n in range(8)]
    with on_cluster(cluster.address, record) as executor:
        for number, printed in executor(calls):
            results[number] = printed
            if len(results) == 1:
                # The only worker dies with results that nobody has asked for, in the middle of one.
                time.sleep(1.0)
                cluster.processes["first"].kill()
        with pytest.raises(InputError, match="no-such-robot"):
            list(executor([partial(load_robot, "no-such-robot")]))
        finished = executor([partial(time.sleep, 0.5)] * 9)
        next(finished)
        # It stops answering, and dies.
        scheduler = cluster.processes["scheduler"]
        scheduler.send_signal(signal.SIGSTOP)
        Timer(1.0, scheduler.kill).start()
        with pytest.raises(ComputationError, match="the scheduler is gone"):
            list(finished)
    assert results == {n: f"{n}" for n in range(8)}
    missing, joined = messages
    assert "the scheduler has no workers; waiting for one" in missing
    assert "a worker has joined" in joined


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("http://127.0.0.1:80", "not the address of a scheduler"),
        ("tcp://127.0.0.1:99999", "not the address of a scheduler"),
        ("tcp://a..b:1", "no Dask scheduler answers there: invalid host name"),
        ("tcp://127.0.0.1:1", "no Dask scheduler answers there: Connection refused"),
    ],
)
def test_missing_scheduler_keeps_earlier_run(address, message, tmp_path, command):
    """Invalid addresses and addresses without an answer: one line, and no file is changed."""
    with open_folder(tmp_path / "run", {}, "afresh") as folder:
        folder.write({"results.json": "precious"})
        folder.complete = True
    before = content(tmp_path)
    words = ["run", "--preset", "quick", "--out", tmp_path / "run", "--cluster", address]
    line = command.error_line(*words, "--vary", "platform.mass=40:50:2")
    assert line.startswith("flexproof: --cluster")
    assert message in line
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    ("greeting", "answer", "message"),
    [(b"HTTP/1.1 400", 60.0, "is not a Dask scheduler"), (b"", 0.2, "timed out")],
)
def test_non_dask_service_is_refused(greeting, answer, message, monkeypatch):
    """An HTTP server, and one that never answers."""
    monkeypatch.setattr(on_dask, "_ANSWER_TIMEOUT", answer)
    with socket.create_server(("127.0.0.1", 0)) as server:
        if greeting:
            Thread(target=lambda: server.accept()[0].sendall(greeting), daemon=True).start()
        port = server.getsockname()[1]
        with (
            pytest.raises(InputError, match=message),
            on_cluster(f"tcp://127.0.0.1:{port}", silent),
        ):
            pass


@pytest.mark.parametrize(
    "greeting",
    [
        # Frames of 10 bytes that say how many there are; one of a number, of a list; none.
        (10).to_bytes(8, "little") + b"x" * 10,
        b"".join(number.to_bytes(8, "little") for number in (17, 1, 1)) + b"\x05",
        b"".join(number.to_bytes(8, "little") for number in (19, 1, 3)) + b"\x92\x01\x02",
        b"".join(number.to_bytes(8, "little") for number in (8, 0)),
    ],
)
def test_invalid_greeting_is_refused(greeting, monkeypatch):
    """Services whose first bytes look like a message of Dask."""
    monkeypatch.setattr(on_dask, "_ANSWER_TIMEOUT", 2.0)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def greet():
            with suppress(OSError):
                while True:
                    server.accept()[0].sendall(greeting)

        Thread(target=greet, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        message = "the service at this address is not a Dask scheduler"
        with pytest.raises(InputError, match=message), on_cluster(address, silent):
            pass


def test_missing_dask_names_command(monkeypatch):
    """Dask is installed by `./flexproof extras cluster`."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setattr(on_dask, "require_scheduler", silent)
    needed = r"--cluster: needs distributed, not installed; \./flexproof extras cluster adds"
    with pytest.raises(InputError, match=needed), on_cluster("tcp://127.0.0.1:9", silent):
        pass


@pytest.mark.soak
def test_worker_of_other_version_is_refused(tmp_path):
    """Before the run, and during it when such a worker joins."""
    other = tmp_path / "other"
    for package in ("lumped", "meshes", "fem", "validation"):
        shutil.copytree(ROOT / package, other / package)
    with (other / "lumped" / "errors.py").open("a") as file:
        file.write("# another version\n")
    refused = (
        r"worker stale \(tcp://.*\) has another version of flexproof, or none; install this one"
    )
    with started(tmp_path) as cluster:
        cluster.worker("sound")
        with on_cluster(cluster.address, silent) as executor:
            assert [result for _, result in executor([partial(abs, -1)])] == [1]
            # One that joins later is refused when it is given work.
            cluster.worker("stale", other)
            with pytest.raises(ComputationError, match=refused):
                list(executor([partial(time.sleep, 0.1)] * 600))
        with pytest.raises(InputError, match=refused), on_cluster(cluster.address, silent):
            pass
