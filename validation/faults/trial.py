"""What the cases say of a sound and of a faulty model, group by group.

Cases of one group share results, so that they are tried together. A group is tried on a fault only
if it uses the faulty function, which is found out by listening to it on the sound models.
"""

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from types import FrameType
from typing import Any

from lumped.robot_file import RobotFile
from validation.case import Case, Skip, Verdict, judge
from validation.context import Context, Preset
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Change, Fault, Faulty, around, replaced

# Catchers after which expensive groups are spared, and the effort (s) from which a group is that.
ENOUGH = 2
CHEAP = 1.9
# A faulty model may never come to an end: this many times the sound one's time, in s.
_PATIENCE, _LEAST_PATIENCE = 10.0, 20.0


@dataclass(frozen=True)
class SoundGroup:
    """Verdicts by case id on the sound models, what they use of the faults' places, time (s)."""

    verdicts: Mapping[str, Verdict]
    used: frozenset[str]
    seconds: float


def groups_of(cases: Sequence[Case]) -> dict[str, tuple[Case, ...]]:
    """Cases by group, the cheapest group first."""
    groups: dict[str, list[Case]] = {}
    for case in cases:
        groups.setdefault(case.group or case.id, []).append(case)
    return {name: tuple(groups[name]) for name in sorted(groups, key=lambda n: effort(groups[n]))}


def effort(cases: Sequence[Case]) -> float:
    """Expected time (s) of a group."""
    return sum(case.effort for case in cases)


def verdicts(cases: Sequence[Case], context: Context) -> dict[str, Verdict]:
    """The verdict of each case; whatever ends a computation is a failure."""
    found: dict[str, Verdict] = {}
    for case in cases:
        try:
            found[case.id] = judge(case, case.measure(context), 0.0).verdict
        except Skip:
            found[case.id] = "skipped"
        except Exception:  # noqa: BLE001  a fault may break anything; that is noticed
            found[case.id] = "failed"
    return found


def sound_group(cases: Sequence[Case], context: Context) -> SoundGroup:
    """What a group says and uses without a fault."""
    found: dict[str, Verdict] = {}
    begun = perf_counter()
    used = listened(lambda: found.update(verdicts(cases, context)))
    return SoundGroup(found, used, perf_counter() - begun)


def listened(computation: Callable[[], object]) -> frozenset[str]:
    """The faults' places that a computation on the sound models uses."""
    used: set[str] = set()
    with replaced({fault.where: _listening(fault.where, used) for fault in FAULTS}):
        computation()
    return frozenset(used)


def caught(cases: Sequence[Case], sound: SoundGroup, context: Context) -> dict[str, Verdict]:
    """The cases that agree on the sound models and not on those that `context` sees now."""
    with _patience(max(_PATIENCE * sound.seconds, _LEAST_PATIENCE)):
        found = verdicts(cases, context)
    return {
        identifier: verdict
        for identifier, verdict in found.items()
        if sound.verdicts[identifier] == "agree" and verdict in _NOTICED
    }


# A fault that blurs a comparison until it decides nothing has been noticed too.
_NOTICED = frozenset({"disagree", "undecided", "failed"})


@dataclass
class SoundGroups:
    """The groups without a fault, each computed when it is first asked for."""

    groups: Mapping[str, Sequence[Case]]
    robot_file: RobotFile
    preset: Preset
    known: dict[str, SoundGroup] = field(default_factory=dict)

    def of(self, name: str) -> SoundGroup:
        """What the group says and uses without a fault."""
        if name not in self.known:
            context = Context(self.robot_file, self.preset)
            self.known[name] = sound_group(self.groups[name], context)
        return self.known[name]


def tried(fault: Fault, sound: SoundGroups) -> dict[str, dict[str, Verdict]]:
    """Cases that catch the fault, by group that was asked.

    Asked are the groups that use the fault's place, expensive ones while few cases have caught it.
    """
    cheap = [name for name, cases in sound.groups.items() if effort(cases) <= CHEAP]
    asked: dict[str, dict[str, Verdict]] = {}
    # One injection for all that is cheap: it looks for cached values among all objects.
    for names in (cheap, *([name] for name in sound.groups if name not in cheap)):
        if sum(len(found) for found in asked.values()) >= ENOUGH:
            break
        using = {name: sound.of(name) for name in names if fault.where in sound.of(name).used}
        if not using:
            continue
        with fault.inject():
            for name, reference in using.items():
                context = Context(sound.robot_file, sound.preset)
                asked[name] = caught(sound.groups[name], reference, context)
    return asked


def _listening(where: str, used: set[str]) -> Change:
    def listen(sound: Faulty, *args: Any, **kwargs: Any) -> Any:
        used.add(where)
        return sound(*args, **kwargs)

    return around(listen)


@contextmanager
def _patience(seconds: float) -> Iterator[None]:
    """TimeoutError after so many seconds, in the main thread of a process."""

    def give_up(_number: int, _frame: FrameType | None) -> None:
        raise TimeoutError

    former = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, former)
