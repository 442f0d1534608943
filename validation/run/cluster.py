"""Units of work on a Dask cluster (optional extra `cluster`).

A unit whose worker is lost goes to another one; results come to this process as they are
finished, so that nothing is lost with a worker or with the scheduler.
"""

import logging
import re
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from threading import Lock
from time import monotonic, sleep
from types import ModuleType
from typing import Any

from lumped.errors import ComputationError, InputError
from lumped.memo import memo
from validation.run.executor import Executor, Finished, Work
from validation.run.provenance import suite_digest, versions

# Seconds: how long to wait for the scheduler's answer, and without workers before that is said.
_ANSWER = 10.0
_PATIENCE = 10.0
# How often (s) to look whether the scheduler and its workers are still there.
_HEARTBEAT = 0.5
# Bytes: a greeting is some hundred long.
_LONGEST = 1 << 20
_ADDRESS = re.compile(r"(?:tcp|tls)://(?P<host>\[[0-9a-fA-F:.]+\]|[\w.-]+):(?P<port>\d{1,5})")
# Workers may have several threads; gmsh has one model and a unit is to have its core to itself.
_ONE_AT_A_TIME = Lock()
Say = Callable[[str], object]


class OtherProgram(Exception):  # noqa: N818  carried from a worker to the run, which names it
    """Raised by a worker whose program or libraries are not those of the run."""


@contextmanager
def on_cluster(address: str, say: Say) -> Iterator[Executor]:
    """An executor on the Dask cluster whose scheduler is at `address` ("tcp://host:port").

    Waits for workers as long as it takes, and says so after ten seconds. Raises InputError where
    Dask is not installed, where no scheduler answers, and where a worker has another program; the
    executor raises what a call raises, and ComputationError where the scheduler is lost, where a
    worker of another program joins, and where workers are lost faster than units are finished.
    """
    require_scheduler(address)
    distributed = _distributed()
    client = _connected(distributed, address)
    waiting = _Waiting(client, address, say)
    try:
        while not waiting.has_workers():
            sleep(_HEARTBEAT)
        _require_same_program(client, address)

        def execute(calls: Sequence[Work]) -> Finished:
            return _execute(distributed, waiting, calls)

        yield execute
    finally:
        # The scheduler's end is no reason to wait for it.
        client.close(timeout=_HEARTBEAT)


def require_scheduler(address: str) -> None:
    """Raise InputError for what is no address of a scheduler, or where none answers.

    Dask's own client waits for ever for what is no scheduler, and complains in several voices.
    """
    form = _ADDRESS.fullmatch(address)
    if form is None or int(form["port"]) > 65535:
        raise InputError(f'--cluster "{address}": no address of a scheduler (tcp://host:port)')
    place = form["host"].strip("[]"), int(form["port"])
    try:
        with socket.create_connection(place, _ANSWER) as connection:
            greeting = connection.recv(8) if address.startswith("tcp:") else b""
    except OSError as error:
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there: {error.strerror or error}"
        ) from error
    # A scheduler speaks first: the length of its greeting, 64 bits, little end first.
    if address.startswith("tcp:") and not 0 < int.from_bytes(greeting, "little") < _LONGEST:
        raise InputError(f"--cluster {address}: what answers there is no Dask scheduler")


@dataclass
class _Waiting:
    """The connection to the scheduler, looked at from time to time while results are awaited."""

    client: Any
    address: str
    say: Say
    _alone_since: float | None = None
    _lost_since: float | None = None
    _said: bool = False

    def has_workers(self) -> bool:
        """Whether there are workers; what is amiss is said after ten seconds.

        Raises ComputationError where the scheduler does not come back in that time.
        """
        now = monotonic()
        if self.client.status != "running":
            self._lost_since = self._lost_since or now
            if now - self._lost_since > _PATIENCE or self.client.status == "closed":
                raise ComputationError(
                    f"--cluster {self.address}: the scheduler is gone; what was finished is kept"
                )
            return False
        self._lost_since = None
        if _has_workers(self.client):
            self._alone_since = None
            if self._said:
                self.say(f"--cluster {self.address}: a worker has come; going on")
            self._said = False
            return True
        self._alone_since = self._alone_since or now
        if now - self._alone_since > _PATIENCE and not self._said:
            self.say(
                f"--cluster {self.address}: the scheduler has no workers; waiting for one "
                f"(start it with 'dask worker {self.address}', or stop with Ctrl-C)"
            )
            self._said = True
        return False


def _execute(distributed: ModuleType, waiting: _Waiting, calls: Sequence[Work]) -> Finished:
    client, own = waiting.client, _program()
    futures = client.map(_alone, calls, own=own, pure=False, batch_size=None)
    numbers = {future.key: number for number, future in enumerate(futures)}
    finished: SimpleQueue[Any] = SimpleQueue()
    for future in futures:
        future.add_done_callback(finished.put)
    try:
        for _ in futures:
            future = _next(finished, waiting)
            yield numbers[future.key], future.result()
    except OtherProgram as error:
        raise ComputationError(
            f"--cluster {waiting.address}: {error}; what was finished is kept"
        ) from error
    except distributed.KilledWorker as error:
        raise ComputationError(
            "--cluster: one unit of the sweep was lost with several workers, one after the other, "
            "probably for want of memory; what was finished is kept"
        ) from error
    except distributed.client.FutureCancelledError as error:
        raise ComputationError(
            f"--cluster {waiting.address}: the scheduler is gone; what was finished is kept"
        ) from error
    finally:
        if client.status == "running":
            client.cancel(futures)


def _next(finished: SimpleQueue[Any], waiting: _Waiting) -> Any:
    while True:
        try:
            return finished.get(timeout=_HEARTBEAT)
        except Empty:
            waiting.has_workers()


def _alone(call: Work, own: Mapping[str, str]) -> Any:
    # A worker may have joined after the run asked all of them.
    if differing := _differences(_program(), own):
        raise OtherProgram(f"worker {_worker_name()} has {differing}; install this one")
    with _ONE_AT_A_TIME:
        return call()


@memo(1)
def _program() -> dict[str, str]:
    """What must be equal for numbers to be equal: the sources of this program, and libraries."""
    return {"another flexproof": suite_digest()} | versions()


def _differences(found: Any, own: Mapping[str, str]) -> str:
    """What a worker has that this process has not, in words; empty where there is nothing."""
    if not isinstance(found, dict) or found.get("another flexproof") != own["another flexproof"]:
        return "another flexproof, or none"
    return ", ".join(
        f"{name} {found.get(name, 'missing')} (here {version})"
        for name, version in own.items()
        if found.get(name) != version
    )


def _worker_name() -> str:
    from distributed import get_worker  # noqa: PLC0415  an optional extra, and slow to import

    worker = get_worker()
    return f"{worker.name} ({worker.address})"


def _distributed() -> ModuleType:
    try:
        import distributed  # noqa: PLC0415  an optional extra, and slow to import
    except ImportError as error:
        raise InputError(
            "--cluster: Dask is not installed; pip install 'flexproof[cluster]' brings it"
        ) from error
    # What matters is said here; how its tasks ended is of no use to the reader of a terminal.
    for name in ("asyncio", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in {"asyncio", "distributed", "tornado"}:
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    module: ModuleType = distributed
    return module


def _connected(distributed: ModuleType, address: str) -> Any:
    try:
        return distributed.Client(address, timeout=_ANSWER, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"--cluster {address}: what answers there is no Dask scheduler (or one that is busy)"
        ) from error


def _has_workers(client: Any) -> bool:
    try:
        return bool(client.nthreads())
    except OSError:
        # The connection broke while it was asked; the client's status will tell.
        return False


def _require_same_program(client: Any, address: str) -> None:
    own = _program()
    told = client.run(_told, on_error="return")
    faults = []
    for worker, answer in sorted(told.items()):
        name, program = answer if isinstance(answer, tuple) else ("", None)
        if differing := _differences(program, own):
            named = f"{name} ({worker})" if name else worker
            faults.append(f"--cluster {address}: worker {named} has {differing}; install this one")
    if faults:
        raise InputError(faults)


def _told(dask_worker: Any) -> tuple[str, dict[str, str]]:
    return str(dask_worker.name), _program()
