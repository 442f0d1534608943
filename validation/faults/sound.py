"""The cases on the sound models: what each says, which places of faults it uses, what it costs.

Expensive results are computed once for all cases, as in a run. What made each is remembered, so
that a fault finds exactly those cases that use its place, and those results that it cannot touch.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import process_time
from typing import Any, TypeVar

from lumped.caches import forget
from lumped.robot_file import RobotFile
from validation.case import Case, Skip
from validation.context import Context, Preset
from validation.faults.fault import Change, Faulty, around, replaced
from validation.faults.parts import IN_THIS_PROCESS, recalling
from validation.results.outcome import Verdict, judge
from validation.store.cache import nothing_kept

T = TypeVar("T")


@dataclass
class Work:
    """A piece of work: the places that it uses, its own time (s), kept results that it rests on."""

    places: set[str] = field(default_factory=set)
    seconds: float = 0.0
    rests_on: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Listening(Context):
    """A context that knows what made the entries of its memo."""

    made_by: dict[str, Work] = field(default_factory=dict, repr=False, compare=False)
    _now: list[Work] = field(default_factory=list, repr=False, compare=False)

    def recall(self, key: str, compute: Callable[[], T]) -> T:
        """As that of a context."""
        if key in self._memo:
            self._rest_on(key)
            return super().recall(key, compute)
        with self.heard() as work:
            value = super().recall(key, compute)
        self.made_by[key] = work
        self._rest_on(key)
        return value

    @contextmanager
    def heard(self) -> Iterator[Work]:
        """What is done as long as the context lasts."""
        # What other work left in a cache would not be heard.
        forget()
        work, begun = Work(), process_time()
        self._now.append(work)
        try:
            yield work
        finally:
            self._now.pop()
            passed = process_time() - begun
            work.seconds += passed
            if self._now:
                self._now[-1].seconds -= passed
                self._now[-1].places |= work.places

    def uses(self, place: str) -> None:
        """The work that is going on uses a place."""
        if self._now:
            self._now[-1].places.add(place)

    def untouched_by(self, place: str) -> Context:
        """A context with those entries that were made without a place."""
        kept = {
            key: value for key, value in self._memo.items() if place not in self.made_by[key].places
        }
        return Context(self.robot_file, self.preset, self.options, kept)

    def again(self, work: Work, place: str) -> float:
        """Time (s) of a piece of work where everything that uses the place is done again."""
        keys: set[str] = set()
        todo = set(work.rests_on)
        while todo:
            key = todo.pop()
            if key not in keys and place in self.made_by[key].places:
                keys.add(key)
                todo |= self.made_by[key].rests_on
        return work.seconds + sum(self.made_by[key].seconds for key in keys)

    def _rest_on(self, key: str) -> None:
        if self._now:
            self._now[-1].rests_on.add(key)
            self._now[-1].places |= self.made_by[key].places


@dataclass(frozen=True)
class SoundCases:
    """Cases that agree on the sound models, and what each of them does."""

    context: Listening
    done: dict[Case, Work]

    def using(self, place: str) -> list[Case]:
        """The cases that use a place, the cheapest first."""
        using = [case for case, work in self.done.items() if place in work.places]
        return sorted(using, key=lambda case: self.seconds(case, place))

    def seconds(self, case: Case, place: str) -> float:
        """Time (s) of a case where everything that uses the place is done again."""
        return self.context.again(self.done[case], place)


def verdict_of(case: Case, context: Context) -> Verdict:
    """The verdict on a case; whatever ends its computation is a failure."""
    try:
        return judge(case, case.measure(context), 0.0).verdict
    except Skip:
        return "skipped"
    except Exception:  # noqa: BLE001  a fault may break anything; that is noticed
        return "failed"


def sound_cases(
    cases: Sequence[Case], robot_file: RobotFile, preset: Preset, places: Collection[str]
) -> SoundCases:
    """What the cases do without a fault, as far as they agree."""
    context = Listening(robot_file, preset)
    done = {}
    heard = {place: _listening(place, context) for place in places}
    with replaced(heard | recalling(context) | IN_THIS_PROCESS), nothing_kept():
        for case in cases:
            with context.heard() as work:
                verdict = verdict_of(case, context)
            if verdict == "agree":
                done[case] = work
    return SoundCases(context, done)


def _listening(place: str, context: Listening) -> Change:
    def listen(sound: Faulty, *args: Any, **kwargs: Any) -> Any:
        context.uses(place)
        return sound(*args, **kwargs)

    return around(listen)
