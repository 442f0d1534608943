"""Calls computed in any order, here or elsewhere: an executor yields what they come to.

In this process (`in_turn`), on the cores of this machine (`on_cores`), or on a Dask cluster
(`validation.run.cluster`). On cores, a call whose process dies is lost alone, and how it died is
known; docs/guide/architecture.md says what pools of processes were tried instead.
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

# A call without arguments that can be pickled.
Work: TypeAlias = Callable[[], Any]
# The same, but for one argument if processes begin with a value.
Call: TypeAlias = Callable[..., Any]
# Number of a call and its result, one after the other as they are finished.
Finished: TypeAlias = Generator[tuple[int, Any], None, None]
# Computes calls in any order.
Executor: TypeAlias = Callable[[Sequence[Work]], Finished]
K = TypeVar("K", bound=Hashable)
# One thread per process, of the sparse solver too: processes are as many as cores.
_SINGLE_THREADED = {"OMP_NUM_THREADS": "1", **ONE_BLAS_THREAD}
# How often (s) to look whether all of it was given up.
_HEARTBEAT = 0.1


def in_turn(calls: Sequence[Work]) -> Finished:
    """One call after the other in this process."""
    for number, call in enumerate(calls):
        yield number, call()


@contextmanager
def on_cores(
    jobs: int, log: Path = Path(os.devnull), begin: Work | None = None
) -> Iterator["Cores"]:
    """An executor with `jobs` processes, one thread each, which last as long as the context.

    What they print is added to the `log`. The value of `begin`, if given, is computed first in each
    of them, stays there, and is the argument of all calls.
    """
    cores = Cores(jobs, log, begin)
    try:
        yield cores
    finally:
        for worker in cores.idle:
            worker.process.end()


@dataclass
class _Worker:
    """A process, the calls that it has to do, the first of which it does, if it is busy."""

    process: Process
    todo: deque[tuple[Any, Call]]
    begun: bool = False
    # Where the log ended when the current call began.
    log_from: int = 0


class OutOfMemoryCrash(Crashed):
    """OpenBLAS ended a process for lack of memory."""


@dataclass
class Cores:
    """Processes of this machine; see `on_cores`."""

    jobs: int
    log: Path
    begin: Work | None
    idle: list[_Worker] = field(default_factory=list)

    def __call__(self, calls: Sequence[Work]) -> Finished:
        """As an executor: raises what a call raises, and ComputationError where a process dies."""
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
        """What named calls come to, an error where one raises it, as they are finished.

        Those of a group are computed one after the other in one process. `started` is told the
        names; once `stopped`, or closed, all that is not finished is given up. Raises
        ComputationError where processes do not even begin.
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
                    answer = self._answer(worker)
                    if not worker.begun:
                        worker.begun = True
                        continue
                    name, _ = worker.todo.popleft()
                    if worker.todo and not isinstance(answer, Crashed):
                        self._ask(worker)
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
        """A process that has been given the first of these calls."""
        if self.idle:
            worker = self.idle.pop()
            worker.todo = todo
        else:
            worker = _Worker(Process(self.log, _SINGLE_THREADED), todo, log_from=self._logged())
            if self.begin is None:
                worker.process.ask(int)
            else:
                worker.process.begin(self.begin)
        self._ask(worker)
        return worker

    def _ask(self, worker: _Worker) -> None:
        if worker.begun:
            worker.log_from = self._logged()
        worker.process.ask(worker.todo[0][1])

    def _answer(self, worker: _Worker) -> Any:
        try:
            answer = worker.process.answer()
        except (InputError, ComputationError) as error:
            answer = self._explained(error, worker.log_from)
        if not worker.begun and isinstance(answer, Exception):
            worker.process.end()
            raise ComputationError(
                f"a worker process ended before it began to compute: {answer} ({self.log} may say "
                "more)"
            )
        return answer

    def _explained(self, error: InputError | ComputationError, start: int) -> Exception:
        """The error, or what OpenBLAS said before it ended a process for want of memory."""
        said = (read_regular(self.log) or b"")[start:].decode("utf-8", "replace")
        lines = [line.strip() for line in said.splitlines() if "OpenBLAS error" in line]
        crashed = isinstance(error, Crashed)
        if crashed and lines:
            return OutOfMemoryCrash(f"ran out of memory ({lines[-1]})")
        return error

    def _logged(self) -> int:
        try:
            return self.log.stat().st_size
        except OSError:
            return 0
