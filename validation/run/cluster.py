"""Executor for tasks on a Dask cluster (optional extra `cluster`).

Input: the address of a scheduler and functions that can be pickled. Output: results in order of
completion. Rule: workers must have the same program and libraries as this process. A task whose
worker is lost goes to another worker. Each result comes to this process as soon as it is finished,
so that it cannot be lost with a worker or with the scheduler. Workers compute in the same kind of
process as the cores of this machine (`validation.run.cluster_worker`).
"""

import gc
import logging
import os
import pickle
import re
import socket
import warnings
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic, sleep
from types import ModuleType
from typing import Any, TypeAlias

from fem.extras import require_extra
from fem.solvers.backends.choice import solver_name
from lumped.errors import ComputationError, InputError
from lumped.solver_request import request_variables
from meshes.processes import CallAnswer, Crashed
from validation.console.streams import write_message
from validation.run.cluster_worker import (
    Conditions,
    DifferentProgram,
    Reply,
    Unable,
    compute,
    differences,
    end_idle,
    program,
    requested_program,
)
from validation.run.executor import (
    Answers,
    Call,
    Executor,
    Groups,
    ProcessExecutor,
    Work,
    in_turn,
)

# Timeout (s) for the scheduler's answer, and time (s) without workers before a notice.
_ANSWER_TIMEOUT = 10.0
_WORKER_TIMEOUT = 10.0
# Interval (s) between checks of the scheduler and its workers.
_HEARTBEAT = 0.5
# Largest accepted length (bytes) of a scheduler's first message; real ones have some hundred.
_LONGEST_GREETING = 1 << 20
_GONE = "--cluster {}: the scheduler is gone"
_ADDRESS = re.compile(r"(?:tcp|tls)://(?P<host>\[[0-9a-fA-F:.]+\]|[\w.-]+):(?P<port>\d{1,5})")
# Number of times that a call is sent again after the connection was lost, as Dask does for workers.
_MOST_LOSSES = 3
_LOST_WITH_WORKERS = (
    "lost with several workers, one after the other, probably because of lack of memory"
)


@contextmanager
def requested_executor(address: str | None) -> Iterator[Executor]:
    """Context with an executor on the cluster at `address`, or in this process if it is None."""
    if address is None:
        yield in_turn
        return
    with on_cluster(address, write_message) as cluster:
        yield cluster


@contextmanager
def on_cluster(address: str, notify: Callable[[str], object]) -> Iterator["Cluster"]:
    """Context with an executor on the Dask cluster at `address` ("tcp://host:port").

    Waits for workers without limit. `notify` receives a message after ten seconds without a worker.
    Raises InputError if Dask is not installed, no scheduler answers, or a worker has another
    program. The executor raises ComputationError if the scheduler is lost or a worker with another
    program joins. A call during which several workers were lost, one after the other, counts as
    crashed.
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
    watch, cluster = _SchedulerWatch(client, address, notify), None
    try:
        while not watch.has_workers():
            sleep(_HEARTBEAT)
        with _connection_errors(distributed, address):
            _require_same_program(client, address)

        cluster = Cluster(distributed, watch)
        yield cluster
    finally:
        if cluster is not None and client.status == "running":
            # An error here must not replace an error of the run.
            with suppress(Exception):
                client.run(end_idle, list(cluster.shared), wait=False)
        # Do not wait for a scheduler that has ended. On a busy machine, the thread that closes the
        # client can start after this timeout; all results, or the error of a call, have arrived.
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
        # A name of a host that cannot be encoded raises UnicodeError.
        reason = (error.strerror or error) if isinstance(error, OSError) else "invalid host name"
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
    # Numbers of workers, at least one, and of their threads.
    workers: int = 1
    threads: int = 1
    _checked: float = 0.0
    _last_fault: str = ""
    _since: float = 0.0
    _notified: bool = False

    @property
    def is_due(self) -> bool:
        """True if the last check was at least half a second ago."""
        return monotonic() - self._checked >= _HEARTBEAT

    def has_workers(self) -> bool:
        """Check the connection. Return True if the scheduler has workers.

        `notify` receives a message after ten seconds without a worker, and another when one has
        joined. Raises ComputationError if the connection is closed, or has been lost for ten
        seconds.
        """
        fault, now = self._connection_fault(), monotonic()
        self._checked = now
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
            self.notify(f"--cluster {self.address}: a worker has joined; the run continues")
            self._notified = False
        return not fault

    def _connection_fault(self) -> str:
        if self.client.status != "running":
            return "gone"
        # If the connection breaks during this call, the next check of the client's status detects
        # it.
        with suppress(OSError):
            threads = self.client.nthreads()
            self.workers, self.threads = max(1, len(threads)), max(1, sum(threads.values()))
            return "" if threads else "no workers"
        return "no workers"


@contextmanager
def _connection_errors(distributed: ModuleType, address: str) -> Iterator[None]:
    """Context in which errors due to a lost scheduler are raised as ComputationError.

    Dask raises OSError if a call needs a new connection and the scheduler does not answer.
    """
    try:
        yield
    except (distributed.client.FutureCancelledError, OSError) as error:
        raise ComputationError(_GONE.format(address)) from error


@dataclass
class Cluster(ProcessExecutor):
    """Executor on the workers of a Dask cluster, see `on_cluster`.

    A call is sent when a thread of a worker is free. The next call of its group goes to the same
    worker as long as this worker is connected. `log`: file to which the output of the workers'
    processes is appended. `begin`: function that is computed first in each process; its value is
    the argument of all calls. If it is None, calls have no argument.
    """

    distributed: ModuleType
    watch: "_SchedulerWatch"
    log: Path = Path(os.devnull)
    begin: Work | None = None
    # Dask futures of the `Conditions` of all processes that this run began, by key. Workers keep
    # the value of a future as long as it is referenced.
    shared: dict[str, Any] = field(default_factory=dict)
    advice = "continue with more memory for each worker, or a coarser mesh"

    def beginning(self, log: Path, begin: Work) -> "Cluster":
        """Executor with these values of `log` and `begin` on the same cluster.

        `log`: file to which the output of its processes is appended. `begin`: function that is
        computed first in each process; its value is the argument of all calls. It is sent to each
        worker once.
        """
        return replace(self, log=log, begin=begin)

    def answers(
        self,
        groups: Groups,
        started: Callable[[Any], object] = lambda _name: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> Answers:
        """Yield (name, result or exception) of the calls, see `ProcessExecutor.answers`.

        Raises ComputationError if the scheduler is lost.
        """
        content = b"" if self.begin is None else pickle.dumps(self.begin)
        conditions = Conditions(content, program(solver_name()), request_variables())
        sent = _SentCalls(self.distributed, self.watch, conditions, self.shared)
        queue = deque(deque(group) for group in groups)
        # If each group is a single call, a worker gets one call more than it has threads. It then
        # need not wait for this process.
        single = all(len(group) == 1 for group in groups)
        try:
            with _connection_errors(self.distributed, self.watch.address):
                while (queue or sent.todo) and not stopped():
                    while (
                        queue and len(sent.todo) < self.watch.threads + single * self.watch.workers
                    ):
                        calls = queue.popleft()
                        sent.send(calls)
                        started(calls[0][0])
                    reply = sent.next_reply()
                    if self.watch.is_due:
                        self.watch.has_workers()
                    if reply is None:
                        continue
                    calls, answer, worker, log = reply
                    self._append(log)
                    name, _ = calls.popleft()
                    if calls:
                        sent.send(calls, worker)
                        started(calls[0][0])
                    yield name, answer
        finally:
            sent.cancel()

    def _append(self, log: bytes) -> None:
        """Append the output of a worker's process to the log."""
        # Results are kept even if the disk is too full for the log.
        with suppress(OSError), self.log.open("ab") as file:
            file.write(log)


# Calls of a group, answer to the first, address of its worker, and its log.
_Arrived: TypeAlias = tuple[deque[tuple[Any, Call]], Any, str | None, bytes]


class _SentCalls:
    """Calls that were sent to the cluster: the first unfinished call of each group."""

    def __init__(
        self,
        distributed: ModuleType,
        watch: "_SchedulerWatch",
        conditions: Conditions,
        shared: dict[str, Any],
    ) -> None:
        self.distributed, self.watch = distributed, watch
        self.conditions, self.shared = conditions, shared
        self._share_conditions()
        # Number of times that the first call of a group was lost with the connection, by name.
        self._losses: Counter[Hashable] = Counter()
        # Calls of the group and future by key.
        self.todo: dict[str, tuple[deque[tuple[Any, Call]], Any]] = {}
        self._finished: SimpleQueue[tuple[str, Any]] = SimpleQueue()

    def _share_conditions(self) -> None:
        """Submit the run's `Conditions` as a task, whose future becomes an entry of `shared`.

        Dask sends the value of a task to each worker once, and computes it again if it is lost.
        """
        with warnings.catch_warnings():
            # A large task is intended here.
            warnings.simplefilter("ignore", UserWarning)
            key = self.conditions.key
            future = self.watch.client.submit(_itself, self.conditions, key=f"flexproof-{key}")
            self.shared[key] = future

    def send(self, calls: deque[tuple[Any, Call]], worker: str | None = None) -> None:
        """Submit the first of the `calls` of a group.

        If `worker` (its address) is not None, it is preferred, and the call precedes new groups.
        """
        future = self.watch.client.submit(
            compute,
            calls[0][1],
            str(id(calls)),
            self.shared[self.conditions.key],
            pure=False,
            workers=worker and [worker],
            allow_other_workers=worker is not None,
            priority=int(worker is not None),
        )
        self.todo[future.key] = calls, future
        future.add_done_callback(self._fetch)

    def _fetch(self, future: Any) -> None:
        """Queue the reply of a finished call.

        Called in a thread, because a reply lost with a worker is awaited until another worker has
        computed it.
        """
        try:
            reply = future.result()
        except BaseException as error:  # noqa: BLE001  raised where the result is awaited
            reply = error
        self._finished.put((future.key, reply))

    def next_reply(self) -> _Arrived | None:
        """Next reply of a worker. None if none arrives within half a second.

        Also None if the call of the reply was lost with the connection and has been sent again.
        Raises ComputationError for a worker with another program, or for one whose processes fail
        before they compute a call.
        """
        try:
            key, reply = self._finished.get(timeout=_HEARTBEAT)
        except Empty:
            return None
        calls, _ = self.todo.pop(key)
        if isinstance(reply, self.distributed.KilledWorker):
            return calls, Crashed(_LOST_WITH_WORKERS), None, b""
        if isinstance(reply, Reply):
            return calls, self._result(reply), reply.worker, reply.log
        if _is_lost(self.distributed, reply):
            return self._send_again(calls)
        if not isinstance(reply, Exception):
            raise reply
        # Dask could not even read the call on a worker, or its reply here.
        raise self._failure(f"a worker failed with {type(reply).__name__}: {reply}") from reply

    def _send_again(self, calls: deque[tuple[Any, Call]]) -> _Arrived | None:
        """Send the first of `calls` again, which was lost with the connection. Return None.

        If the call was lost more than three times, it is not sent again, and a reply with the
        exception `Crashed` is returned. Raises ComputationError if the scheduler does not come
        back.
        """
        name = calls[0][0]
        self._losses[name] += 1
        if self._losses[name] > _MOST_LOSSES:
            return calls, Crashed(_LOST_WITH_WORKERS), None, b""
        self.watch.has_workers()
        while self.watch.client.status != "running":
            sleep(_HEARTBEAT)
            self.watch.has_workers()
        # The future of the conditions was lost as well.
        self._share_conditions()
        self.send(calls)
        return None

    def _result(self, reply: Reply) -> Any:
        """Value or error of a call. Its remarks (warnings) are issued again in this process."""
        if isinstance(reply.answer, DifferentProgram):
            reason = _difference_text(f"{reply.name} ({reply.worker})", str(reply.answer))
            raise self._failure(reason) from reply.answer
        if isinstance(reply.answer, Unable):
            raise self._failure(f"worker {reply.worker}: {reply.answer}") from reply.answer
        if not isinstance(reply.answer, CallAnswer):
            return reply.answer
        try:
            return reply.answer.result()
        except (InputError, ComputationError) as error:
            return error

    def _failure(self, reason: str) -> ComputationError:
        return ComputationError(f"--cluster {self.watch.address}: {reason}")

    def cancel(self) -> None:
        """Cancel all calls that are not finished."""
        if self.watch.client.status == "running":
            self.watch.client.cancel([future for _, future in self.todo.values()])


def _itself(conditions: Conditions) -> Conditions:
    return conditions


def _is_lost(distributed: ModuleType, error: object) -> bool:
    """True if `error` means that a call was lost with the connection to the scheduler."""
    return isinstance(
        error, distributed.client.FutureCancelledError | distributed.comm.CommClosedError
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
        if isinstance(answer, OSError):
            # The worker was lost before it answered.
            continue
        if isinstance(answer, InputError):
            faults.append(f"--cluster {address}: worker {worker_address}: {answer}")
            continue
        name, worker_program = answer if isinstance(answer, tuple) else ("", {})
        if differing := differences(worker_program, program(solver_name())):
            worker = f"{name} ({worker_address})" if name else worker_address
            faults.append(f"--cluster {address}: {_difference_text(worker, differing)}")
    if faults:
        raise InputError(faults)


def _worker_program(dask_worker: Any, request: Mapping[str, str]) -> tuple[str, Mapping[str, str]]:
    return str(dask_worker.name), requested_program(request)
