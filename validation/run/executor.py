"""Executors, which compute calls in any order and yield their results.

Input: functions without arguments. Output: number and result of each, in order of completion. Calls
run in this process (`in_turn`), on the cores of this machine (`on_cores`), or on a Dask cluster
(`validation.run.cluster`). Cores and workers of a cluster compute in the same kind of process
(`Interpreter`). A process that dies loses only its current call, and the reason is known;
docs/guide/architecture.md compares other process pools.
"""

import os
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, ClassVar, TypeAlias, TypeVar

from fem.machine import ONE_BLAS_THREAD
from lumped.errors import ComputationError, InputError
from lumped.files import read_regular
from meshes.processes import CallAnswer, Crashed, Process

# Call without arguments that can be pickled.
Work: TypeAlias = Callable[[], Any]
# Call that can be pickled. It has one argument if processes begin with a value.
Call: TypeAlias = Callable[..., Any]
# Calls with their names, in groups. Calls of a group run one after the other in one process.
Groups: TypeAlias = Sequence[Sequence[tuple[Hashable, Call]]]
# Name and answer (result or exception) of each call, in order of completion.
Answers: TypeAlias = Generator[tuple[Any, Any], None, None]
# Number and result of each call, in order of completion.
Finished: TypeAlias = Generator[tuple[int, Any], None, None]
# Function that computes calls in any order.
Executor: TypeAlias = Callable[[Sequence[Work]], Finished]
T = TypeVar("T")
# One thread per process, including the sparse solver, since there are as many processes as cores.
_SINGLE_THREADED = {"OMP_NUM_THREADS": "1", **ONE_BLAS_THREAD}
# Interval (s) between checks of `stopped`.
_HEARTBEAT = 0.1


def in_order(executor: Executor, calls: Sequence[Callable[[], T]]) -> list[T]:
    """Results of the calls in the order of the calls."""
    results = dict(executor(calls))
    return [results[number] for number in range(len(calls))]


def in_turn(calls: Sequence[Work]) -> Finished:
    """Compute calls one after the other in this process. Yield number and result of each."""
    for number, call in enumerate(calls):
        yield number, call()


class OutOfMemoryCrash(Crashed):
    """Error: OpenBLAS ended a process for lack of memory."""


@dataclass
class Interpreter:
    """A single-threaded process that computes one call at a time.

    Its output is appended to `log`.
    """

    process: Process
    log: Path
    # Size of the log (bytes) when the current call began.
    log_from: int = 0

    @classmethod
    def start(
        cls, log: Path, begin: Work | None, environment: Mapping[str, str] | None = None
    ) -> "Interpreter":
        """Start a process.

        If `begin` is not None, it is computed first, and its value is the argument of all calls.
        The answer to `begin` is received like that of a call.
        """
        process = Process(log, {**(environment or {}), **_SINGLE_THREADED})
        interpreter = cls(process, log, _size(log))
        if begin is None:
            process.request(int)
        else:
            process.begin(begin)
        return interpreter

    def request(self, call: Call) -> None:
        """Request the result of a call."""
        self.log_from = _size(self.log)
        self.process.request(call)

    def receive(self) -> CallAnswer:
        """Answer to the earliest request. Raises Crashed or OutOfMemoryCrash.

        OutOfMemoryCrash is raised if the log contains OpenBLAS's message on lack of memory.
        """
        try:
            return self.process.receive()
        except Crashed:
            text = (read_regular(self.log) or b"")[self.log_from :].decode("utf-8", "replace")
            lines = [line.strip() for line in text.splitlines() if "OpenBLAS error" in line]
            if lines:
                raise OutOfMemoryCrash(f"ran out of memory ({lines[-1]})") from None
            raise
        finally:
            self.log_from = _size(self.log)


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:
        return 0


class ProcessExecutor(ABC):
    """Executor on processes of this machine or of other machines."""

    # Advice if a process died.
    advice: ClassVar[str]

    def __call__(self, calls: Sequence[Work]) -> Finished:
        """Yield number and result of each call, in order of completion.

        Raises the error of a call, and ComputationError if a process dies.
        """
        groups = [[(number, call)] for number, call in enumerate(calls)]
        with closing(self.answers(groups)) as answers:
            for number, answer in answers:
                if isinstance(answer, Crashed):
                    raise ComputationError(f"{answer}; {self.advice}") from answer
                if isinstance(answer, InputError | ComputationError):
                    raise answer
                yield number, answer

    @abstractmethod
    def answers(
        self,
        groups: Groups,
        started: Callable[[Any], object] = lambda _name: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> Answers:
        """Yield (name, result or exception) of named calls in order of completion.

        Calls of a group are computed one after the other in one process. `started` is called with
        the name of each call when it begins. If `stopped` returns True, or if the generator is
        closed, unfinished calls are abandoned. Raises ComputationError if processes cannot begin.
        """


@contextmanager
def on_cores(
    jobs: int, log: Path = Path(os.devnull), begin: Work | None = None
) -> Iterator["Cores"]:
    """Context with an executor of `jobs` processes of one thread each, which end with the context.

    The output of the processes is appended to the `log`. `begin` is computed first in each process,
    and its value is the argument of all calls of this process. If `begin` is None, calls have no
    argument.
    """
    cores = Cores(jobs, log, begin)
    try:
        yield cores
    finally:
        for worker in cores.idle:
            worker.process.end()


@dataclass
class _Worker:
    """A process with its remaining calls. A busy process computes the first of them.

    `begun`: True once the process has started and can compute calls.
    """

    interpreter: Interpreter
    todo: deque[tuple[Any, Call]]
    begun: bool = False

    @property
    def process(self) -> Process:
        """Process of the interpreter."""
        return self.interpreter.process


@dataclass
class Cores(ProcessExecutor):
    """Executor on processes of this machine, see `on_cores`."""

    jobs: int
    log: Path
    begin: Work | None
    idle: list[_Worker] = field(default_factory=list)
    advice = "start it again with fewer jobs or a coarser mesh"

    def answers(
        self,
        groups: Groups,
        started: Callable[[Any], object] = lambda _name: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> Answers:
        """Yield (name, result or exception) of the calls, see `ProcessExecutor.answers`."""
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
                        worker.interpreter.request(worker.todo[0][1])
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
        """Worker whose process computes the first of the calls `todo`."""
        if self.idle:
            worker = self.idle.pop()
            worker.todo = todo
        else:
            worker = _Worker(Interpreter.start(self.log, self.begin), todo)
        worker.interpreter.request(todo[0][1])
        return worker

    def _receive_answer(self, worker: _Worker) -> Any:
        try:
            answer = worker.interpreter.receive().result()
        except (InputError, ComputationError) as error:
            answer = error
        if not worker.begun and isinstance(answer, Exception):
            worker.process.end()
            raise start_error(answer, self.log) from answer
        return answer


def start_error(error: Exception, log: Path) -> ComputationError:
    """Error to raise for a process that ended before it computed a call."""
    return ComputationError(
        f"a worker process ended before it began to compute: {error} ({log} may have details)"
    )
