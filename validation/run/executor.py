"""Executors, which compute calls in any order and yield their results.

Input: functions without arguments. Output: number and result of each, in order of completion. Calls
run in this process (`in_turn`), on the cores of this machine (`on_cores`), or on a Dask cluster
(`validation.run.cluster`). On cores, a process that dies loses only one call, and the reason is
known; docs/guide/architecture.md compares other process pools.
"""

import os
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from fem.machine import ONE_BLAS_THREAD
from lumped.errors import ComputationError, InputError
from lumped.files import read_regular
from meshes.processes import Crashed, Process

# Call without arguments that can be pickled.
Work: TypeAlias = Callable[[], Any]
# Call that can be pickled. It has one argument if processes begin with a value.
Call: TypeAlias = Callable[..., Any]
# Number and result of each call, in order of completion.
Finished: TypeAlias = Generator[tuple[int, Any], None, None]
# Function that computes calls in any order.
Executor: TypeAlias = Callable[[Sequence[Work]], Finished]
K = TypeVar("K", bound=Hashable)
# One thread per process, including the sparse solver, since there are as many processes as cores.
_SINGLE_THREADED = {"OMP_NUM_THREADS": "1", **ONE_BLAS_THREAD}
# Interval (s) between checks of `stopped`.
_HEARTBEAT = 0.1


def in_turn(calls: Sequence[Work]) -> Finished:
    """Compute the calls one after the other in this process."""
    for number, call in enumerate(calls):
        yield number, call()


@contextmanager
def on_cores(
    jobs: int, log: Path = Path(os.devnull), begin: Work | None = None
) -> Iterator["Cores"]:
    """Context with an executor of `jobs` processes of one thread each, which end with the context.

    Their output is appended to the `log`. The value of `begin` is computed first in each process
    and is the argument of all its calls. If `begin` is None, calls have no argument.
    """
    cores = Cores(jobs, log, begin)
    try:
        yield cores
    finally:
        for worker in cores.idle:
            worker.process.end()


@dataclass
class _Worker:
    """A process with its remaining calls. A busy process computes the first of them."""

    process: Process
    todo: deque[tuple[Any, Call]]
    begun: bool = False
    # Size of the log (bytes) when the current call began.
    log_from: int = 0


class OutOfMemoryCrash(Crashed):
    """OpenBLAS ended a process for lack of memory."""


@dataclass
class Cores:
    """Executor on processes of this machine, see `on_cores`."""

    jobs: int
    log: Path
    begin: Work | None
    idle: list[_Worker] = field(default_factory=list)

    def __call__(self, calls: Sequence[Work]) -> Finished:
        """Results of the calls. Raises errors of calls, and ComputationError if a process dies."""
        groups = [[(number, call)] for number, call in enumerate(calls)]
        with closing(self.answers(groups)) as answers:
            for number, answer in answers:
                if isinstance(answer, Crashed):
                    raise ComputationError(
                        f"{answer}; what was finished is kept: start it again with fewer jobs or a "
                        "coarser mesh"
                    )
                if isinstance(answer, InputError | ComputationError):
                    raise answer
                yield number, answer

    def answers(
        self,
        groups: Sequence[Sequence[tuple[K, Call]]],
        started: Callable[[K], object] = lambda _name: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> Generator[tuple[K, Any], None, None]:
        """Yield (name, result or exception) of named calls in order of completion.

        Calls of a group are computed one after the other in one process. `started` is called with
        each name. When `stopped` returns True, or the generator is closed, unfinished calls are
        abandoned. Raises ComputationError if processes cannot begin.
        """
        queue = deque(deque(group) for group in groups)
        busy: dict[Connection, _Worker] = {}
        try:
            while (queue or busy) and not stopped():
                while queue and len(busy) < self.jobs:
                    worker = self._worker(queue.popleft())
                    busy[worker.process.connection] = worker
                    started(worker.todo[0][0])
                for ready in wait(list(busy), timeout=_HEARTBEAT):
                    worker = busy[ready]  # type: ignore[index]
                    answer = self._receive_answer(worker)
                    if not worker.begun:
                        worker.begun = True
                        continue
                    name, _ = worker.todo.popleft()
                    if worker.todo and not isinstance(answer, Crashed):
                        self._start_call(worker)
                        started(worker.todo[0][0])
                    else:
                        del busy[worker.process.connection]
                        if isinstance(answer, Crashed):
                            worker.process.end()
                            queue.extendleft([worker.todo] if worker.todo else [])
                        else:
                            self.idle.append(worker)
                    yield name, answer
        finally:
            for worker in busy.values():
                worker.process.end()

    def _worker(self, todo: deque[tuple[Any, Call]]) -> _Worker:
        """Process that computes the first of the calls `todo`."""
        if self.idle:
            worker = self.idle.pop()
            worker.todo = todo
        else:
            worker = _Worker(Process(self.log, _SINGLE_THREADED), todo, log_from=self._log_size())
            if self.begin is None:
                worker.process.ask(int)
            else:
                worker.process.begin(self.begin)
        self._start_call(worker)
        return worker

    def _start_call(self, worker: _Worker) -> None:
        if worker.begun:
            worker.log_from = self._log_size()
        worker.process.ask(worker.todo[0][1])

    def _receive_answer(self, worker: _Worker) -> Any:
        try:
            answer = worker.process.answer()
        except (InputError, ComputationError) as error:
            answer = self._crash_reason(error, worker.log_from)
        if not worker.begun and isinstance(answer, Exception):
            worker.process.end()
            raise ComputationError(
                f"a worker process ended before it began to compute: {answer} ({self.log} may say "
                "more)"
            )
        return answer

    def _crash_reason(self, error: InputError | ComputationError, start: int) -> Exception:
        """The error, or OutOfMemoryCrash if the log has a message of OpenBLAS on lack of memory."""
        log_text = (read_regular(self.log) or b"")[start:].decode("utf-8", "replace")
        lines = [line.strip() for line in log_text.splitlines() if "OpenBLAS error" in line]
        crashed = isinstance(error, Crashed)
        if crashed and lines:
            return OutOfMemoryCrash(f"ran out of memory ({lines[-1]})")
        return error

    def _log_size(self) -> int:
        try:
            return self.log.stat().st_size
        except OSError:
            return 0
