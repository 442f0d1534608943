"""A fault on trial: it is made in a copy of this process, and cases say whether they notice.

The copy has those results of the sound models that the fault cannot touch. Whatever the fault
breaks, and wherever it runs for ever, ends with the copy.
"""

import os
import resource
import signal
import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from math import ceil
from time import process_time
from typing import cast

from validation.case import Case
from validation.faults.fault import Fault, replaced
from validation.faults.parts import meshed_elsewhere, recalling
from validation.faults.sound import SoundCases, verdict_of
from validation.results.outcome import Verdict
from validation.store.cache import nothing_kept

# Catchers after which dearer cases are spared.
ENOUGH = 2
# A faulty model may never come to an end: this many times the sound one's time (s), and more.
_PATIENCE, _LEAST_PATIENCE = 10.0, 20.0
# A fault that blurs a comparison until it decides nothing has been noticed too.
_NOTICED = frozenset({"disagree", "undecided", "failed"})


def tried(fault: Fault, sound: SoundCases) -> dict[Case, Verdict]:
    """What the cases that use the fault's place say under it, the cheapest first.

    As many as it takes until enough have noticed.
    """
    said: dict[Case, Verdict] = {}
    waiting = sound.using(fault.where)
    while waiting:
        for verdict in _testimony(fault, sound, waiting):
            said[waiting.pop(0)] = verdict
            if len(catchers(said)) >= ENOUGH:
                return said
        if waiting:
            # The copy died of it, or was ended where it would not end.
            said[waiting.pop(0)] = "failed"
    return said


def catchers(said: Mapping[Case, Verdict]) -> list[Case]:
    """The cases that noticed."""
    return [case for case, verdict in said.items() if verdict in _NOTICED]


def _testimony(fault: Fault, sound: SoundCases, cases: Sequence[Case]) -> Iterator[Verdict]:
    """What the cases say under the fault, as far as a copy of this process comes with them."""
    reading, writing = os.pipe()
    lifeline, alive = os.pipe()
    with warnings.catch_warnings():
        # Of threads: the one that a worker has waits for its parent, and holds nothing.
        warnings.simplefilter("ignore", DeprecationWarning)
        copy = os.fork()
    if copy == 0:
        with suppress(BaseException):
            os.close(reading)
            os.close(alive)
            _end_with(lifeline)
            _testify(fault, sound, cases, writing)
        os._exit(0)
    os.close(writing)
    os.close(lifeline)
    try:
        with os.fdopen(reading) as lines:
            for line in lines:
                yield cast("Verdict", line.strip())
    finally:
        os.kill(copy, signal.SIGKILL)
        os.waitpid(copy, 0)
        os.close(alive)


def _testify(fault: Fault, sound: SoundCases, cases: Sequence[Case], writing: int) -> None:
    context = sound.context.untouched_by(fault.where)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    parts = replaced(recalling(context) | meshed_elsewhere(fault))
    with fault.inject(), parts, nothing_kept():
        for case in cases:
            usual = sound.seconds(case, fault.where)
            patience = process_time() + max(_PATIENCE * usual, _LEAST_PATIENCE)
            resource.setrlimit(resource.RLIMIT_CPU, (ceil(patience), resource.RLIM_INFINITY))
            os.write(writing, f"{verdict_of(case, context)}\n".encode())


def _end_with(lifeline: int) -> None:
    """From now on this process ends when nobody holds the other end of the line."""

    def wait_and_leave() -> None:
        os.read(lifeline, 1)
        os._exit(1)

    threading.Thread(target=wait_and_leave, daemon=True).start()
