"""Executor for units of work on a Dask cluster (optional extra `cluster`).

Input: the address of a scheduler and functions that can be pickled. Output: results in order of
completion. Rule: workers must have the same program and libraries as this process. A unit whose
worker is lost goes to another one; results come to this process when they are finished, so that
nothing is lost with a worker or with the scheduler.
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

# Timeout (s) for the scheduler's answer, and time (s) without workers before a notice.
_ANSWER_TIMEOUT = 10.0
_WORKER_TIMEOUT = 10.0
# Interval (s) between checks of the scheduler and its workers.
_HEARTBEAT = 0.5
# Largest accepted length (bytes) of a scheduler's first message; real ones have some hundred.
_LONGEST_GREETING = 1 << 20
_GONE = "--cluster {}: the scheduler is gone; what was finished is kept"
_ADDRESS = re.compile(r"(?:tcp|tls)://(?P<host>\[[0-9a-fA-F:.]+\]|[\w.-]+):(?P<port>\d{1,5})")
# A worker can have several threads, but gmsh has one model and each unit needs a core.
_ONE_AT_A_TIME = Lock()


class DifferentProgram(Exception):  # noqa: N818  carried from a worker to the run, which names it
    """Raised by a worker whose program or libraries differ from those of the run."""


@contextmanager
def on_cluster(address: str, notify: Callable[[str], object]) -> Iterator[Executor]:
    """Context with an executor on the Dask cluster at `address` ("tcp://host:port").

    Waits for workers without limit, with a notice after ten seconds. Raises InputError if Dask is
    not installed, no scheduler answers, or a worker has another program. The executor raises errors
    of calls, and ComputationError if the scheduler is lost, a worker with another program joins, or
    workers are lost faster than units are finished.
    """
    require_extra("cluster", "--cluster")
    require_scheduler(address)
    distributed = _distributed()
    client = None
    with suppress(Exception):
        client = distributed.Client(address, timeout=_ANSWER_TIMEOUT, set_as_default=False)
    if client is None:
        # An incomplete client closes when it is collected. During the start of the next client, it
        # would wait forever for a lock of that start.
        gc.collect()
        raise InputError(
            f"--cluster {address}: the service at this address is not a Dask scheduler, "
            "or the scheduler is busy"
        )
    watch = _SchedulerWatch(client, address, notify)
    try:
        while not watch.has_workers():
            sleep(_HEARTBEAT)
        with _connection_errors(distributed, address):
            _require_same_program(client, address)

        def execute(calls: Sequence[Work]) -> Finished:
            return _execute(distributed, watch, calls)

        yield execute
    finally:
        # Do not wait for a scheduler that has ended. On a busy machine, the thread that closes can
        # start later than this; the results, or the error of a call, are here already.
        with suppress(TimeoutError):
            client.close(timeout=_HEARTBEAT)


def require_scheduler(address: str) -> None:
    """Raise InputError if the address is invalid or no scheduler answers.

    Dask's own client would wait forever for a service that is not a scheduler.
    """
    match = _ADDRESS.fullmatch(address)
    if match is None or int(match["port"]) > 65535:
        raise InputError(f'--cluster "{address}": not the address of a scheduler (tcp://host:port)')
    host_and_port = match["host"].strip("[]"), int(match["port"])
    try:
        with socket.create_connection(host_and_port, _ANSWER_TIMEOUT) as connection:
            greeting = connection.recv(8) if address.startswith("tcp:") else b""
    except (OSError, UnicodeError) as error:
        # Names of hosts are encoded first.
        reason = (error.strerror or error) if isinstance(error, OSError) else "no name of a host"
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there: {reason}"
        ) from error
    # A scheduler sends first: the length of its greeting, 64 bits, little-endian.
    if (
        address.startswith("tcp:")
        and not 0 < int.from_bytes(greeting, "little") < _LONGEST_GREETING
    ):
        raise InputError(
            f"--cluster {address}: the service at this address is not a Dask scheduler"
        )


@dataclass
class _SchedulerWatch:
    """Connection to the scheduler, checked at intervals while results are awaited."""

    client: Any
    address: str
    notify: Callable[[str], object]
    _last_fault: str = ""
    _since: float = 0.0
    _notified: bool = False

    def has_workers(self) -> bool:
        """True if there are workers. After ten seconds without any, a notice is written.

        Raises ComputationError if the scheduler does not return in that time.
        """
        fault, now = self._connection_fault(), monotonic()
        if fault != self._last_fault:
            self._last_fault, self._since = fault, now
        late = now - self._since > _WORKER_TIMEOUT
        if fault == "gone" and (late or self.client.status == "closed"):
            raise ComputationError(_GONE.format(self.address))
        if fault == "no workers" and late and not self._notified:
            self.notify(
                f"--cluster {self.address}: the scheduler has no workers; waiting for one "
                f"(start it with 'dask worker {self.address}', or stop with Ctrl-C)"
            )
            self._notified = True
        if not fault and self._notified:
            self.notify(f"--cluster {self.address}: a worker has joined; going on")
            self._notified = False
        return not fault

    def _connection_fault(self) -> str:
        if self.client.status != "running":
            return "gone"
        # If the connection breaks during this call, the next check of the client's status detects
        # it.
        with suppress(OSError):
            return "" if self.client.nthreads() else "no workers"
        return "no workers"


@contextmanager
def _connection_errors(distributed: ModuleType, address: str) -> Iterator[None]:
    """Context in which errors due to a lost scheduler are raised as ComputationError."""
    try:
        yield
    except (distributed.client.FutureCancelledError, distributed.comm.CommClosedError) as error:
        raise ComputationError(_GONE.format(address)) from error


def _execute(distributed: ModuleType, watch: _SchedulerWatch, calls: Sequence[Work]) -> Finished:
    with _connection_errors(distributed, watch.address):
        yield from _results(distributed, watch, calls)


def _results(distributed: ModuleType, watch: _SchedulerWatch, calls: Sequence[Work]) -> Finished:
    context: dict[str, Any] = {"program": _program(solver_name()), "request": request_variables()}
    futures = watch.client.map(_run_on_worker, calls, **context, pure=False, batch_size=None)
    numbers = {future.key: number for number, future in enumerate(futures)}
    finished: SimpleQueue[Any] = SimpleQueue()

    def fetch(future: Any) -> None:
        # In a thread, because a result lost with a worker is awaited until another worker has
        # computed it.
        try:
            finished.put((numbers[future.key], future.result(), None))
        except BaseException as error:  # noqa: BLE001  raised where the result is awaited
            finished.put((numbers[future.key], None, error))

    for future in futures:
        future.add_done_callback(fetch)
    try:
        for _ in futures:
            number, result, error = _next(finished, watch)
            if error is not None:
                raise error
            yield number, result
    except DifferentProgram as error:
        raise ComputationError(
            f"--cluster {watch.address}: {error}; what was finished is kept"
        ) from error
    except distributed.KilledWorker as error:
        raise ComputationError(
            "--cluster: one unit of the sweep was lost with several workers, one after the other, "
            "probably because of lack of memory; what was finished is kept"
        ) from error
    finally:
        if watch.client.status == "running":
            watch.client.cancel(futures)


def _next(finished: SimpleQueue[Any], watch: _SchedulerWatch) -> Any:
    while True:
        try:
            return finished.get(timeout=_HEARTBEAT)
        except Empty:
            watch.has_workers()


def _run_on_worker(call: Work, program: Mapping[str, str], request: Mapping[str, str]) -> Any:
    from distributed import get_worker  # noqa: PLC0415  an optional extra, and slow to import

    # A worker can have joined after the check of all workers.
    if differing := _differences(_requested_program(request), program):
        worker = get_worker()
        raise DifferentProgram(_difference_text(f"{worker.name} ({worker.address})", differing))
    with _ONE_AT_A_TIME, one_blas_thread():
        return call()


@memo(2)
def _program(solver: str) -> dict[str, str]:
    """Digest of the sources, versions of libraries, and `solver`.

    Equal programs give equal numbers.
    """
    return {"another flexproof": source_digest()} | versions() | {"linear solver": solver}


def _requested_program(request: Mapping[str, str]) -> dict[str, str]:
    """Program of a worker, with the linear solver that the run requests."""
    os.environ.update(request)
    return _program(solver_name())


def _differences(worker_program: Mapping[str, str], program: Mapping[str, str]) -> str:
    """Text on differences between a worker's program and that of this process. "" without any."""
    if worker_program.get("another flexproof") != program["another flexproof"]:
        return "another flexproof, or none"
    return ", ".join(
        f"{name} {worker_program.get(name, 'missing')} (here {version})"
        for name, version in program.items()
        if worker_program.get(name) != version
    )


def _difference_text(worker: str, differing: str) -> str:
    return f"worker {worker} has {differing}; install this one"


def _distributed() -> ModuleType:
    import distributed  # noqa: PLC0415  an optional extra, and slow to import

    # Messages of Dask on ending tasks are suppressed, since this module raises the errors.
    for name in ("asyncio", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in {"asyncio", "distributed", "tornado"}:
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    module: ModuleType = distributed
    return module


def _require_same_program(client: Any, address: str) -> None:
    faults = []
    # A worker without this program answers with an error.
    answers = client.run(_worker_program, request=request_variables(), on_error="return")
    for worker_address, answer in sorted(answers.items()):
        if isinstance(answer, InputError):
            faults.append(f"--cluster {address}: worker {worker_address}: {answer}")
            continue
        name, program = answer if isinstance(answer, tuple) else ("", {})
        if differing := _differences(program, _program(solver_name())):
            worker = f"{name} ({worker_address})" if name else worker_address
            faults.append(f"--cluster {address}: {_difference_text(worker, differing)}")
    if faults:
        raise InputError(faults)


def _worker_program(dask_worker: Any, request: Mapping[str, str]) -> tuple[str, dict[str, str]]:
    return str(dask_worker.name), _requested_program(request)
