"""Processes that compute for another: one thread each, undisturbed, and an end with their parent.

Ctrl-C and the hang-up of a terminal reach all processes in front; those that compute leave it to
the one that started them to decide what is to be done.
"""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import parent_process, resource_tracker

# One thread per process: the numbers then do not depend on how many processes there are.
SINGLE_THREADED = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"), "1"
)


@contextmanager
def single_threaded() -> Iterator[None]:
    """Environment in which new processes compute with one thread each."""
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


@contextmanager
def children_undisturbed() -> Iterator[None]:
    """Processes that start here are kept from Ctrl-C and hang-ups by a mask: this one ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    # Started with the first child, the tracker would lift the mask before that child inherits it.
    resource_tracker.ensure_running()
    former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, former)


def end_with_parent() -> None:
    """From now on this process ends when the one that started it is gone, however it went."""
    parent = parent_process()
    if parent is None:
        return

    def wait_and_leave() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait_and_leave, daemon=True).start()
