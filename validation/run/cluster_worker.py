"""Computation of calls on a Dask worker, in child processes like those of a local run.

Input: a call, and the conditions under which processes begin. Output: a `Reply` with answer and
log. Rules: a Dask worker computes in child processes, one for each of its threads, so that errors,
crashes, logs, memory and numbers are those of a local run. A process remains for the next call with
the same conditions. The process of a cancelled call is ended.
"""

import os
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, partial
from hashlib import blake2b
from pathlib import Path
from pickle import loads
from threading import Lock
from typing import Any, NamedTuple

from fem.solvers.backends.choice import solver_name
from lumped.errors import ComputationError, InputError
from lumped.files import read_regular
from lumped.memo import memo
from meshes.processes import CallAnswer, Crashed
from validation.run.cache import CACHE_VARIABLE, cache_folder, source_digest
from validation.run.executor import Call, Interpreter
from validation.run.provenance import versions

# Largest part of a log (bytes) that is sent with an answer.
_LONGEST_LOG = 1 << 20
# Final states of a Dask worker, in which its tasks are lost.
_ENDING = {"closing", "closed", "closing_gracefully", "failed", "stopping", "stopped"}


class DifferentProgram(ComputationError):  # noqa: N818  names the event, as messages do
    """Error: program or libraries of a worker differ from those of the run."""


class Unable(ComputationError):  # noqa: N818  names the event, as messages do
    """Error: a process failed before it computed a call, or its call was cancelled."""


class Reply(NamedTuple):
    """Answer to a call, or the reason why there is none.

    `worker` and `name` are address and name of the Dask worker, `log` the output of its process.
    """

    answer: CallAnswer | ComputationError
    worker: str
    name: str
    log: bytes


@dataclass(frozen=True)
class Conditions:
    """Conditions under which the processes of a run begin.

    `content`: pickled function without arguments, which each process computes first. Its value is
    the argument of all calls. b"" if calls have no argument. `program` identifies sources and
    libraries of the run, `request` its linear solver (environment variables).
    """

    content: bytes
    program: Mapping[str, str]
    request: Mapping[str, str]

    @cached_property
    def key(self) -> str:
        """Digest of all fields."""
        text = repr((sorted(self.program.items()), sorted(self.request.items())))
        return blake2b(text.encode() + self.content, digest_size=16).hexdigest()

    def __call__(self) -> Any:
        """Value of the function in `content`, None for b"".

        Raises DifferentProgram if the program of this process differs from that of the run.
        """
        if differing := differences(program(solver_name()), self.program):
            raise DifferentProgram(differing)
        return loads(self.content)() if self.content else None  # noqa: S301  from the run


@dataclass
class _Pool:
    """Idle processes of this Dask worker, by the key of their conditions.

    Each process is paired with the group of the call that it computed last. `count`: number of log
    files made so far.
    """

    idle: dict[str, list[tuple[str, Interpreter]]] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)
    count: int = 0

    def take(self, key: str, group: str) -> Interpreter | None:
        """Take an idle process whose conditions have this `key`. None if there is none.

        A process that computed the last call of the `group` is preferred. Processes with other
        conditions are ended.
        """
        self.end([other for other in self.idle if other != key])
        with self.lock:
            idle = self.idle.get(key, [])
            idle.sort(key=lambda item: item[0] == group)
            return idle.pop()[1] if idle else None

    def next_log(self, folder: Path) -> Path:
        """File for the output of a new process."""
        with self.lock:
            self.count += 1
            return folder / f"flexproof-{self.count}.log"

    def give_back(self, key: str, group: str, interpreter: Interpreter) -> None:
        """Keep the process `interpreter` for a later call with the same `key`.

        A later call of the same `group` gets it if possible.
        """
        with self.lock:
            self.idle.setdefault(key, []).append((group, interpreter))

    def end(self, keys: Collection[str]) -> None:
        """End the idle processes whose conditions have these `keys`."""
        with self.lock:
            ended = [interpreter for key in keys for _, interpreter in self.idle.pop(key, [])]
        for interpreter in ended:
            interpreter.process.end()
            interpreter.log.unlink(missing_ok=True)


@memo(1)
def _pool() -> _Pool:
    return _Pool()


async def end_idle(keys: Collection[str]) -> None:
    """End the idle processes of a run on this Dask worker."""
    _pool().end(keys)


def compute(call: Call, group: str, conditions: Conditions) -> Reply:
    """Compute a call in a child process of this Dask worker, whose thread waits for the answer.

    Calls of a group run in the same process if they come to the same worker.
    """
    from distributed import get_worker  # noqa: PLC0415  an optional extra, and slow to import

    worker, pool = get_worker(), _pool()
    is_needed = partial(_is_wanted, worker, worker.get_current_task())
    interpreter = pool.take(conditions.key, group)
    is_new = interpreter is None
    if interpreter is None:
        folder = Path(worker.local_directory)
        interpreter = Interpreter.start(
            pool.next_log(folder),
            conditions if conditions.content else None,
            _environment(conditions, folder),
        )
    try:
        if is_new:
            _begin(interpreter, conditions, is_needed)
        interpreter.request(call)
        answer = _next_answer(interpreter, is_needed)
    except (Crashed, DifferentProgram, Unable) as error:
        interpreter.process.end()
        log = _taken_log(interpreter.log)
        interpreter.log.unlink(missing_ok=True)
        return Reply(error, worker.address, str(worker.name), log)
    log = _taken_log(interpreter.log)
    pool.give_back(conditions.key, group, interpreter)
    return Reply(answer, worker.address, str(worker.name), log)


def _environment(conditions: Conditions, folder: Path) -> dict[str, str]:
    """Environment of child processes: the run's solver, a shared cache, and a temporary folder.

    The folder is removed when the worker ends.
    """
    cache = {} if cache_folder() else {CACHE_VARIABLE: str(folder / "flexproof-cache")}
    return {**conditions.request, **cache, "TMPDIR": str(folder)}


def _begin(interpreter: Interpreter, conditions: Conditions, is_needed: Callable[[], bool]) -> None:
    """Wait until a new process can compute calls.

    Raises DifferentProgram if its program differs from that of the run. Raises Unable if the
    process ends or if `is_needed` returns False.
    """
    try:
        _next_answer(interpreter, is_needed).result()
        if not conditions.content:
            interpreter.request(conditions)
            _next_answer(interpreter, is_needed).result()
    except (DifferentProgram, Unable):
        raise
    except (ComputationError, InputError) as error:
        raise Unable(f"a process ended before it began to compute: {error}") from error


def _next_answer(interpreter: Interpreter, is_needed: Callable[[], bool]) -> CallAnswer:
    while not interpreter.process.has_answer():
        if not is_needed():
            raise Unable("the call was cancelled")
    return interpreter.receive()


def _is_wanted(worker: Any, key: object) -> bool:
    """False if the task `key` was cancelled, for example because its run or the scheduler ended."""
    task = worker.state.tasks.get(key)
    return task is not None and task.state != "cancelled" and worker.status.name not in _ENDING


def _taken_log(log: Path) -> bytes:
    """Last part of a log file, at most `_LONGEST_LOG` bytes. The file is then emptied."""
    content = (read_regular(log) or b"")[-_LONGEST_LOG:]
    with suppress(OSError):
        os.truncate(log, 0)
    return content


@memo(2)
def program(solver: str) -> Mapping[str, str]:
    """Digest of the sources, versions of libraries, and `solver`, by name.

    Equal programs give equal numbers.
    """
    return {"another flexproof": source_digest()} | versions() | {"linear solver": solver}


def requested_program(request: Mapping[str, str]) -> Mapping[str, str]:
    """Program of a worker that uses the linear solver of the run.

    `request`: environment variables that select this solver. They are set in the worker's process.
    """
    os.environ.update(request)
    return program(solver_name())


def differences(worker_program: Mapping[str, str], run_program: Mapping[str, str]) -> str:
    """Text on differences between a worker's program and that of the run. "" if there are none."""
    if worker_program.get("another flexproof") != run_program["another flexproof"]:
        return "another version of flexproof, or none"
    return ", ".join(
        f"{name} {worker_program.get(name, 'missing')} (here {version})"
        for name, version in run_program.items()
        if worker_program.get(name) != version
    )
