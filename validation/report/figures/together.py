"""Plots drawn by several processes at once: a run is over when the last of them is.

The other processes are copies of this one, which have the outcomes and the libraries at hand.
"""

import logging
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing import current_process, get_context, parent_process
from multiprocessing.connection import Connection
from threading import Thread
from typing import TypeAlias

from validation.exhibits import Figure

Draw: TypeAlias = Callable[[], Figure | None]
_Drawn: TypeAlias = dict[int, Figure | None]


def drawn_together(draws: Sequence[Draw], processes: int) -> list[Figure | None]:
    """The figures in the order of `draws`; none where one could not be drawn."""
    # Those that compute for another have no processes of their own.
    processes = 1 if current_process().daemon else min(processes, len(draws))
    context = get_context("fork")
    copies = []
    for first in range(1, processes):
        ours, theirs = context.Pipe(duplex=False)
        share = draws[first::processes]
        process = context.Process(target=_send_drawn, args=(theirs, share), daemon=True)
        process.start()
        theirs.close()
        copies.append((first, process, ours))
    found: _Drawn = {
        index: attempted(draws[index]) for index in range(0, len(draws), max(processes, 1))
    }
    for first, process, ours in copies:
        # One that ended early leaves its share to this process.
        with suppress(EOFError, ConnectionError):
            found |= dict(zip(range(first, len(draws), processes), ours.recv(), strict=True))
        process.join()
        ours.close()
    return [found[index] if index in found else attempted(draw) for index, draw in enumerate(draws)]


def attempted(draw: Draw) -> Figure | None:
    """The figure, or none: a plot that fails must not cost the report."""
    try:
        return draw()
    except Exception as error:  # noqa: BLE001  whatever it is, the numbers stand in the tables
        logging.getLogger(__name__).warning("a plot could not be drawn: %s", error)
        return None


def _send_drawn(connection: Connection, draws: Sequence[Draw]) -> None:
    # Ctrl-C is for the process that was begun by hand, which takes its copies along.
    os.setsid()
    Thread(target=_end_with_parent, daemon=True).start()
    connection.send([attempted(draw) for draw in draws])


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
