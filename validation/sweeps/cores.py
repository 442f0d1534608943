"""Units of work on the cores of this machine: one process per core, one thread per process."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import active_children, get_context
from queue import Empty, SimpleQueue
from typing import Any

from lumped.errors import ComputationError
from validation.sweeps.processes import children_undisturbed, end_with_parent, single_threaded
from validation.sweeps.runner import Executor, Finished, Work

# Seconds; see `_next`.
_PATIENCE = 0.5


@contextmanager
def on_cores(jobs: int) -> Iterator[Executor]:
    """An executor with `jobs` processes, which last as long as the context.

    Leaving it by an exception (Ctrl-C among them) ends the processes at once. The executor raises
    what a call raises, and ComputationError where a process dies.
    """
    before = set(active_children())
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=end_with_parent)

    def execute(calls: Sequence[Work]) -> Finished:
        with children_undisturbed(), single_threaded():
            numbers = {pool.submit(call): number for number, call in enumerate(calls)}
        yield from _as_finished(numbers)

    try:
        yield execute
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in set(active_children()) - before:
            process.terminate()
        raise
    else:
        pool.shutdown()


def _as_finished(numbers: dict[Future[Any], int]) -> Finished:
    finished: SimpleQueue[Future[Any]] = SimpleQueue()
    for future in numbers:
        future.add_done_callback(finished.put)
    try:
        for _ in numbers:
            future = _next(finished)
            yield numbers[future], future.result()
    except BrokenProcessPool as error:
        raise ComputationError(
            "a process of the sweep was ended from outside, probably for want of memory; "
            "what was finished is kept: start it again with fewer jobs or a coarser mesh"
        ) from error
    finally:
        for future in numbers:
            future.cancel()


def _next(finished: SimpleQueue[Future[Any]]) -> Future[Any]:
    # A Ctrl-C that comes just before Python's wait begins does not end it: none may last long.
    while True:
        with suppress(Empty):
            return finished.get(timeout=_PATIENCE)
