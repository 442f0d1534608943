"""Units of work on the cores of this machine: one process per core, one thread per process."""

import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from typing import Any

from lumped.errors import ComputationError
from validation.sweeps.runner import Executor, Finished, Work
from validation.worker import SINGLE_THREADED


@contextmanager
def on_cores(jobs: int) -> Iterator[Executor]:
    """An executor with `jobs` processes, which last as long as the context.

    Leaving it by an exception (Ctrl-C among them) ends the processes at once. The executor raises
    what a call raises, and ComputationError where a process dies.
    """
    before = set(active_children())
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_end_with_parent)

    def execute(calls: Sequence[Work]) -> Finished:
        with _children_undisturbed(), _single_threaded():
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
    try:
        for future in as_completed(numbers):
            yield numbers[future], future.result()
    except BrokenProcessPool as error:
        raise ComputationError(
            "a process of the sweep was ended from outside, probably for want of memory; "
            "what was finished is kept: start it again with fewer jobs or a coarser mesh"
        ) from error
    finally:
        for future in numbers:
            future.cancel()


@contextmanager
def _children_undisturbed() -> Iterator[None]:
    """Processes that start here inherit a mask that keeps Ctrl-C from them: this one ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, former)


@contextmanager
def _single_threaded() -> Iterator[None]:
    former = {name: os.environ.get(name) for name in SINGLE_THREADED}
    os.environ.update(SINGLE_THREADED)
    try:
        yield
    finally:
        for name, value in former.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is None:
        return

    def wait_and_leave() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait_and_leave, daemon=True).start()
