"""Runs cases and figures in worker processes and keeps each result as it arrives.

The unit of work is a group: tasks that share expensive results run in one process, one after the
other. Computing happens in workers only, even with one job: the numbers are then the same
whatever the number of jobs, a crash of a library ends a case and not the run, and Ctrl-C does not
have to wait for a factorisation.
"""

import signal
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import FrameType
from typing import Protocol

from lumped.errors import ComputationError, InputError
from lumped.text import did_you_mean
from validation.context import Preset
from validation.results.outcome import Result
from validation.results.tasks import Record, Task, plain
from validation.run.worker import REMEDY, Job, serve
from validation.store.tree import read_regular
from validation.sweeps.processes import children_undisturbed, single_threaded

# How long (s) the scheduler sleeps before it looks whether Ctrl-C was pressed.
_HEARTBEAT = 0.1
# How long (s) a worker may take to end after it was told to.
_GRACE = 0.5


class Observer(Protocol):
    """Who wants to know how the run goes (progress display)."""

    def started(self, task: Task) -> None:
        """A worker has begun the task."""

    def finished(self, task: Task, record: Record) -> None:
        """The task's record has arrived."""


def select(
    tasks: Sequence[Task], preset: Preset, pattern: str | None = None, always: Collection[str] = ()
) -> list[Task]:
    """Tasks of the preset whose id matches the shell-style pattern (brackets taken literally).

    Those whose ids are in `always` are taken, too.

    Raises InputError where nothing matches.
    """
    if len({task.id for task in tasks}) < len(tasks):
        raise ValueError("two cases or figures have the same id")
    in_preset = [task for task in tasks if preset in task.presets]
    if pattern is None:
        return in_preset
    # Ids carry parameters in brackets; as character classes they would never match themselves.
    literal = pattern.replace("[", "[[]")
    chosen = {task.id for task in in_preset if fnmatchcase(task.id, literal)}
    if not chosen:
        elsewhere = any(fnmatchcase(task.id, literal) for task in tasks)
        ids, listed = [task.id for task in in_preset], "; 'flexproof cases' lists them"
        near = did_you_mean(pattern.strip("*?"), ids, listed, cutoff=0.5)
        hint = "; only in other presets" if elsewhere else near
        raise InputError(f'--only: no case of preset {preset} matches "{pattern}"{hint}')
    return [task for task in in_preset if task.id in chosen.union(always)]


def run(
    job: Job,
    tasks: Sequence[Task],
    *,
    jobs: int,
    log: Path,
    keep: Callable[[Record], None],
    observer: Observer,
) -> bool:
    """Compute the tasks with `jobs` processes; True if all were finished, False if interrupted.

    `keep` gets each record as it arrives; what it raises ends the run. SIGINT, SIGTERM and SIGHUP
    end it within a second. Raises ComputationError where workers cannot even start.
    """
    scheduler = _Scheduler(job, {task.id: task for task in tasks}, log, keep, observer)
    scheduler.queue.extend(_groups(tasks))
    with _interruptible() as interrupted, single_threaded():
        try:
            for _ in range(min(jobs, len(scheduler.queue))):
                scheduler.start_worker()
            while scheduler.workers and not interrupted():
                scheduler.step()
        finally:
            scheduler.stop()
        return not interrupted()


def _groups(tasks: Sequence[Task]) -> list[list[str]]:
    """Ids that belong together, the longest work first: short work fills the gaps at the end."""
    groups: dict[str, list[Task]] = {}
    for task in tasks:
        groups.setdefault(task.group or task.id, []).append(task)
    by_effort = sorted(groups.values(), key=lambda group: -sum(task.effort for task in group))
    return [[task.id for task in group] for group in by_effort]


@dataclass
class _Worker:
    process: SpawnProcess
    connection: Connection
    waiting: list[str] = field(default_factory=list)
    current: str | None = None
    served: bool = False
    # Where the log ended when the current task, or the worker, began.
    log_from: int = 0


@dataclass
class _Scheduler:
    job: Job
    tasks: Mapping[str, Task]
    log: Path
    keep: Callable[[Record], None]
    observer: Observer
    queue: deque[list[str]] = field(default_factory=deque)
    workers: list[_Worker] = field(default_factory=list)

    def start_worker(self) -> None:
        spawn = get_context("spawn")
        ours, theirs = spawn.Pipe()
        process = spawn.Process(target=serve, args=(theirs, self.job, self.log), daemon=True)
        before = _size(self.log)
        with children_undisturbed():
            process.start()
        theirs.close()
        worker = _Worker(process, ours, log_from=before)
        self.workers.append(worker)
        self._give_work(worker)

    def step(self) -> None:
        """Wait a moment for messages and act on them."""
        by_connection = {worker.connection: worker for worker in self.workers}
        for ready in wait(list(by_connection), timeout=_HEARTBEAT):
            worker = by_connection[ready]  # type: ignore[index]
            try:
                kind, content = worker.connection.recv()
            except (EOFError, ConnectionError):
                self._bury(worker)
                continue
            if kind == "started":
                (identifier, worker.log_from), worker.served = content, True
                worker.current = identifier
                worker.waiting.remove(identifier)
                self.observer.started(self.tasks[identifier])
            else:
                worker.current = None
                self._finish(content)
                if not worker.waiting:
                    self._give_work(worker)

    def stop(self) -> None:
        """End all workers, whatever they are doing."""
        for worker in self.workers:
            worker.process.terminate()
        for worker in list(self.workers):
            self._dismiss(worker)

    def _give_work(self, worker: _Worker) -> None:
        if self.queue:
            worker.waiting = self.queue.popleft()
            _send(worker, list(worker.waiting))
            return
        _send(worker, None)
        self._dismiss(worker)

    def _dismiss(self, worker: _Worker) -> None:
        """Wait for a worker's end, and force it where a library hangs on leaving."""
        worker.process.join(_GRACE)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()
        worker.connection.close()
        self.workers.remove(worker)

    def _finish(self, record: Record) -> None:
        self.keep(record)
        self.observer.finished(self.tasks[record["id"]], record)

    def _bury(self, worker: _Worker) -> None:
        """A worker died: its current task has failed, the rest goes to a new worker."""
        self._dismiss(worker)
        starved = _starved(self.log, worker.log_from)
        if not worker.served:
            raise ComputationError(
                "a worker process ended before it began to compute; "
                + (starved or f"{self.log} says why")
            )
        if worker.current is not None:
            why = starved or _how_it_ended(worker.process.exitcode)
            self._finish(plain(Result(worker.current, "failed", 0.0, why)))
        if worker.waiting:
            self.queue.appendleft(worker.waiting)
        if self.queue:
            self.start_worker()


def _send(worker: _Worker, message: list[str] | None) -> None:
    # A worker that has died meanwhile is noticed, and buried, when its pipe is read.
    with suppress(BrokenPipeError):
        worker.connection.send(message)


def _size(log: Path) -> int:
    try:
        return log.stat().st_size
    except OSError:
        return 0


def _starved(log: Path, start: int) -> str:
    """What OpenBLAS says before it ends a process that it cannot give memory; else empty."""
    said = (read_regular(log) or b"")[start:].decode("utf-8", "replace")
    lines = [line.strip() for line in said.splitlines() if "OpenBLAS error" in line]
    return f"ran out of memory ({lines[-1]}); {REMEDY}" if lines else ""


def _how_it_ended(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        how = f"was ended by {signal.Signals(-exitcode).name}"
        if -exitcode == signal.SIGKILL:
            how += ", probably for want of memory"
    else:
        how = f"ended with code {exitcode}"
    return f"the computing process {how} (log.txt may say more)"


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """SIGINT, SIGTERM and SIGHUP only raise a flag, so that no file is left half-written.

    A hang-up that is ignored, under nohup, stays ignored.
    """
    received: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    heeded = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        heeded.append(signal.SIGHUP)
    former = {number: signal.signal(number, note) for number in heeded}
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)
