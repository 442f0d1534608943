"""Units of work on a Dask cluster (optional extra `cluster`).

A unit whose worker is lost goes to another one; results come to this process as they are
finished, so that nothing is lost with a worker or with the scheduler.
"""

import gc
import logging
import os
import re
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from threading import Lock
from time import monotonic, sleep
from types import ModuleType
from typing import Any

from fem.extras import require_extra
from fem.machine import one_blas_thread
from fem.solvers.backends.choice import solver_name
from lumped.errors import ComputationError, InputError
from lumped.memo import memo
from lumped.solver_request import request_variables
from validation.run.executor import Executor, Finished, Work
from validation.run.provenance import versions
from validation.run.sources import source_digest

# Seconds: how long to wait for the scheduler's answer, and without workers before that is said.
_ANSWER = 10.0
_PATIENCE = 10.0
# How often (s) to look whether the scheduler and its workers are still there.
_HEARTBEAT = 0.5
# Bytes: a greeting is some hundred long.
_LONGEST = 1 << 20
_GONE = "--cluster {}: the scheduler is gone; what was finished is kept"
_ADDRESS = re.compile(r"(?:tcp|tls)://(?P<host>\[[0-9a-fA-F:.]+\]|[\w.-]+):(?P<port>\d{1,5})")
# Workers may have several threads; gmsh has one model and a unit is to have its core to itself.
_ONE_AT_A_TIME = Lock()


class OtherProgram(Exception):  # noqa: N818  carried from a worker to the run, which names it
    """Raised by a worker whose program or libraries are not those of the run."""


@contextmanager
def on_cluster(address: str, say: Callable[[str], object]) -> Iterator[Executor]:
    """An executor on the Dask cluster whose scheduler is at `address` ("tcp://host:port").

    Waits for workers as long as it takes, and says so after ten seconds. Raises InputError where
    Dask is not installed, where no scheduler answers, and where a worker has another program; the
    executor raises what a call raises, and ComputationError where the scheduler is lost, where a
    worker of another program joins, and where workers are lost faster than units are finished.
    """
    require_extra("cluster", "--cluster")
    require_scheduler(address)
    distributed = _distributed()
    client = None
    with suppress(Exception):
        client = distributed.Client(address, timeout=_ANSWER, set_as_default=False)
    if client is None:
        # A half-made client closes when it is collected. In the start of the next client it would
        # wait for ever for the lock that this start holds.
        gc.collect()
        raise InputError(
            f"--cluster {address}: what answers there is not a Dask scheduler (or one that is busy)"
        )
    waiting = _Waiting(client, address, say)
    try:
        while not waiting.has_workers():
            sleep(_HEARTBEAT)
        with _connected(distributed, address):
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
        raise InputError(f'--cluster "{address}": not the address of a scheduler (tcp://host:port)')
    place = form["host"].strip("[]"), int(form["port"])
    try:
        with socket.create_connection(place, _ANSWER) as connection:
            greeting = connection.recv(8) if address.startswith("tcp:") else b""
    except (OSError, UnicodeError) as error:
        # Names of hosts are encoded first.
        reason = (error.strerror or error) if isinstance(error, OSError) else "no name of a host"
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there: {reason}"
        ) from error
    # A scheduler speaks first: the length of its greeting, 64 bits, little end first.
    if address.startswith("tcp:") and not 0 < int.from_bytes(greeting, "little") < _LONGEST:
        raise InputError(f"--cluster {address}: what answers there is not a Dask scheduler")


@dataclass
class _Waiting:
    """The connection to the scheduler, looked at from time to time while results are awaited."""

    client: Any
    address: str
    say: Callable[[str], object]
    _amiss: str = ""
    _since: float = 0.0
    _said: bool = False

    def has_workers(self) -> bool:
        """Whether there are workers; what is amiss is said after ten seconds.

        Raises ComputationError where the scheduler does not come back in that time.
        """
        amiss, now = self._found_amiss(), monotonic()
        if amiss != self._amiss:
            self._amiss, self._since = amiss, now
        late = now - self._since > _PATIENCE
        if amiss == "gone" and (late or self.client.status == "closed"):
            raise ComputationError(_GONE.format(self.address))
        if amiss == "no workers" and late and not self._said:
            self.say(
                f"--cluster {self.address}: the scheduler has no workers; waiting for one "
                f"(start it with 'dask worker {self.address}', or stop with Ctrl-C)"
            )
            self._said = True
        if not amiss and self._said:
            self.say(f"--cluster {self.address}: a worker has joined; going on")
            self._said = False
        return not amiss

    def _found_amiss(self) -> str:
        if self.client.status != "running":
            return "gone"
        # Where the connection breaks while it is asked, the client's status will tell.
        with suppress(OSError):
            return "" if self.client.nthreads() else "no workers"
        return "no workers"


@contextmanager
def _connected(distributed: ModuleType, address: str) -> Iterator[None]:
    """Whatever breaks when the scheduler goes, as ComputationError."""
    try:
        yield
    except (distributed.client.FutureCancelledError, distributed.comm.CommClosedError) as error:
        raise ComputationError(_GONE.format(address)) from error


def _execute(distributed: ModuleType, waiting: _Waiting, calls: Sequence[Work]) -> Finished:
    with _connected(distributed, waiting.address):
        yield from _results(distributed, waiting, calls)


def _results(distributed: ModuleType, waiting: _Waiting, calls: Sequence[Work]) -> Finished:
    told: dict[str, Any] = {"own": _program(solver_name()), "request": request_variables()}
    futures = waiting.client.map(_alone, calls, **told, pure=False, batch_size=None)
    numbers = {future.key: number for number, future in enumerate(futures)}
    finished: SimpleQueue[Any] = SimpleQueue()

    def fetch(future: Any) -> None:
        # In a thread: what was lost with a worker is waited for until another one has computed it.
        try:
            finished.put((numbers[future.key], future.result(), None))
        except BaseException as error:  # noqa: BLE001  raised where the result is awaited
            finished.put((numbers[future.key], None, error))

    for future in futures:
        future.add_done_callback(fetch)
    try:
        for _ in futures:
            number, result, error = _next(finished, waiting)
            if error is not None:
                raise error
            yield number, result
    except OtherProgram as error:
        raise ComputationError(
            f"--cluster {waiting.address}: {error}; what was finished is kept"
        ) from error
    except distributed.KilledWorker as error:
        raise ComputationError(
            "--cluster: one unit of the sweep was lost with several workers, one after the other, "
            "probably for want of memory; what was finished is kept"
        ) from error
    finally:
        if waiting.client.status == "running":
            waiting.client.cancel(futures)


def _next(finished: SimpleQueue[Any], waiting: _Waiting) -> Any:
    while True:
        try:
            return finished.get(timeout=_HEARTBEAT)
        except Empty:
            waiting.has_workers()


def _alone(call: Work, own: Mapping[str, str], request: Mapping[str, str]) -> Any:
    from distributed import get_worker  # noqa: PLC0415  an optional extra, and slow to import

    # A worker may have joined after the run asked all of them.
    if differing := _differences(_program_by(request), own):
        worker = get_worker()
        raise OtherProgram(_install(f"{worker.name} ({worker.address})", differing))
    with _ONE_AT_A_TIME, one_blas_thread():
        return call()


@memo(2)
def _program(solver: str) -> dict[str, str]:
    """Sources of this program, libraries and `solver`, which must be equal for equal numbers."""
    return {"another flexproof": source_digest()} | versions() | {"linear solver": solver}


def _program_by(request: Mapping[str, str]) -> dict[str, str]:
    """The program of a worker that takes over the run's request for a linear solver."""
    os.environ.update(request)
    return _program(solver_name())


def _differences(found: Mapping[str, str], own: Mapping[str, str]) -> str:
    """What a worker has that this process has not, in words; empty where there is nothing."""
    if found.get("another flexproof") != own["another flexproof"]:
        return "another flexproof, or none"
    return ", ".join(
        f"{name} {found.get(name, 'missing')} (here {version})"
        for name, version in own.items()
        if found.get(name) != version
    )


def _install(worker: str, differing: str) -> str:
    return f"worker {worker} has {differing}; install this one"


def _distributed() -> ModuleType:
    import distributed  # noqa: PLC0415  an optional extra, and slow to import

    # What matters is said here; how its tasks ended is of no use to the reader of a terminal.
    for name in ("asyncio", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in {"asyncio", "distributed", "tornado"}:
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    module: ModuleType = distributed
    return module


def _require_same_program(client: Any, address: str) -> None:
    faults = []
    # A worker without this program answers with an error.
    answers = client.run(_told, request=request_variables(), on_error="return")
    for place, answer in sorted(answers.items()):
        if isinstance(answer, InputError):
            faults.append(f"--cluster {address}: worker {place}: {answer}")
            continue
        name, program = answer if isinstance(answer, tuple) else ("", {})
        if differing := _differences(program, _program(solver_name())):
            worker = f"{name} ({place})" if name else place
            faults.append(f"--cluster {address}: {_install(worker, differing)}")
    if faults:
        raise InputError(faults)


def _told(dask_worker: Any, request: Mapping[str, str]) -> tuple[str, dict[str, str]]:
    return str(dask_worker.name), _program_by(request)
