"""Two runs side by side: verdicts that changed, values that drifted, cases that came and went.

Of runs of different inputs, what differs in these, and the adequacy of their models side by side.
References come from outside and decide the verdict; an earlier value is only our own and decides
nothing. A change of it is drift, never disagreement. As text these are plain tables that any
terminal, pager and mail can show.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

import msgspec
import numpy as np

from lumped.text import aligned, counted
from validation.drawing.text import error_with_spread
from validation.run.outcome import Verdict
from validation.run.records import CaseRecord, RunRecord, StoredEntry

# Rounding differs between machines and library versions; far above it, far below any tolerance.
_ROUNDING = 1e-9
# A value held against zero has no size of its own to be relative to, only its tolerance.
_OF_TOLERANCE = 1e-3
# From good to bad; a case that is skipped no longer protects anything.
_RANK: dict[Verdict, int] = {"agree": 0, "skipped": 1, "undecided": 2, "disagree": 3, "failed": 4}
# What should be the same in two runs whose numbers are compared.
_CIRCUMSTANCES = ("robot", "robot_sha256", "preset", "options", "versions", "machine")
# How many cases the text lists by the change of their time; --json has all of them.
_SLOWEST = 10


@dataclass(frozen=True)
class VerdictChange:
    """A case whose verdict is another one than before, and whether a worse one.

    From good to bad: agree, skipped, undecided, disagree, failed.
    """

    id: str
    before: Verdict
    after: Verdict
    worse: bool


@dataclass(frozen=True)
class Drifted:
    """A value or a reference (`what`) then and now: up to `allowed` (half-width) they are one."""

    id: str
    what: str
    unit: str
    before: float
    after: float
    drift: float
    allowed: float

    @property
    def beyond(self) -> bool:
        """Whether it has moved by more than is allowed."""
        return abs(self.drift) > self.allowed


@dataclass(frozen=True)
class Timing:
    """Seconds that a case took before and after."""

    id: str
    before: float
    after: float


@dataclass(frozen=True)
class InputChange:
    """A key of the robot file with its value in both runs (None: not given)."""

    key: str
    before: Any
    after: Any


@dataclass(frozen=True)
class ValueChange:
    """A model's value in a pose that both runs looked at (SI)."""

    pose: tuple[float, ...]
    before: float
    after: float


@dataclass(frozen=True)
class AdequacyChange:
    """A model's quantity in both runs; None where a run does not have it."""

    model: str
    quantity: str
    before: StoredEntry | None
    after: StoredEntry | None
    values: tuple[ValueChange, ...]


@dataclass(frozen=True)
class RunComparison:
    """What changed from one run to the other; `differs` names what else does.

    `inputs` are the keys of the robot file that differ, as far as both runs tell them. Of different
    inputs no value drifts: they differ, as they should. `adequacy` is that of both.
    `different_robots` are the names of two robots, of whose cases none is better or worse, new or
    removed; empty where both runs are of one.
    """

    verdicts: tuple[VerdictChange, ...]
    drifted: tuple[Drifted, ...]
    new: tuple[str, ...]
    removed: tuple[str, ...]
    seconds: tuple[Timing, ...]
    differs: tuple[str, ...]
    inputs: tuple[InputChange, ...]
    adequacy: tuple[AdequacyChange, ...]
    different_robots: tuple[str, ...]

    @property
    def worsened(self) -> bool:
        """Whether any verdict worsened."""
        return any(change.worse for change in self.verdicts)


def compare(before: RunRecord, after: RunRecord) -> RunComparison:
    """What changed from `before` to `after`."""
    robots = _different_robots(before, after)
    old, new = ({}, {}) if robots else (before.by_id, after.by_id)
    both = [(old[identifier], case) for identifier, case in new.items() if identifier in old]
    inputs = tuple(_input_changes(before, after))
    return RunComparison(
        verdicts=tuple(
            VerdictChange(b.id, a.verdict, b.verdict, _RANK[b.verdict] > _RANK[a.verdict])
            for a, b in both
            if a.verdict != b.verdict
        ),
        drifted=() if inputs else tuple(one for a, b in both for one in _drifted(a, b)),
        new=tuple(identifier for identifier in new if identifier not in old),
        removed=tuple(identifier for identifier in old if identifier not in new),
        seconds=tuple(Timing(b.id, a.seconds, b.seconds) for a, b in both),
        differs=tuple(
            name for name in _CIRCUMSTANCES if before.run.get(name) != after.run.get(name)
        ),
        inputs=inputs,
        adequacy=tuple(_adequacy_changes(before, after)),
        different_robots=robots,
    )


def as_dict(comparison: RunComparison) -> dict[str, Any]:
    """The comparison as plain data for JSON."""
    return {"schema": 1, "worsened": comparison.worsened, **msgspec.to_builtins(comparison)}


def as_text(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    """What changed, the gravest first."""
    blocks = [_heads(before, after, comparison), sentence(comparison)]
    if comparison.inputs and not comparison.different_robots:
        blocks.append("The input differs: two robots, whose numbers may differ without any drift.")
        blocks += _block(
            "Input",
            ["key", "before", "after"],
            [[c.key, _given(c.before), _given(c.after)] for c in comparison.inputs],
        )
    blocks += _block(
        "Adequacy",
        ["model", "quantity", "before", "", "after", ""],
        [
            [c.model, c.quantity, *_told(c.before), *_told(c.after)]
            for c in comparison.adequacy
            # Of two robots all; of variants what reads otherwise; of one input other verdicts.
            if comparison.different_robots
            or (_told(c.before) != _told(c.after) if comparison.inputs else _rejudged(c))
        ],
    )
    worst_first = sorted(comparison.verdicts, key=lambda change: not change.worse)
    blocks += _block(
        "Verdicts that changed",
        ["", "before", "after", "case"],
        [["worse" if c.worse else "", c.before, c.after, c.id] for c in worst_first],
    )
    numbers = "{0.before:.10g} {0.after:.10g} {0.drift:+.2g} {0.allowed:.2g}"
    blocks += _block(
        "Drifted beyond their uncertainty",
        ["before", "after", "drift", "allowed", "unit", "", "case"],
        [[*numbers.format(d).split(), d.unit, d.what, d.id] for d in comparison.drifted],
    )
    blocks += _block("New cases", ["case"], [[identifier] for identifier in comparison.new])
    blocks += _block("Removed cases", ["case"], [[identifier] for identifier in comparison.removed])
    if comparison.seconds:
        blocks.append(_times(comparison.seconds))
    return "\n\n".join(blocks)


def _heads(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    told = ("robot", "preset", "started")
    rows = [
        [name, *(str(run.run.get(key, "?")) for key in told), counted(len(run.cases), "case")]
        for name, run in (("before", before), ("after", after))
    ]
    differs = [name.replace("_", " ") for name in comparison.differs]
    note = f"\nThe runs differ in {', '.join(differs)}." if differs else ""
    return aligned(["", "robot", "preset", "started", ""], rows) + note


def _given(value: object) -> str:
    return "not given" if value is None else str(value)


def _told(entry: StoredEntry | None) -> list[str]:
    if entry is None:
        return ["", ""]
    if entry.error is None:
        return ["", entry.verdict]
    along = "" if entry.along is None else f" ({_percent(entry.along)} along)"
    error = error_with_spread(entry, _percent).replace("\N{NO-BREAK SPACE}", " ")
    return [f"{error}{along}", entry.verdict]


def _percent(error: float, *, signed: bool = True) -> str:
    """An error in percent with two decimals, in which variants of a robot differ."""
    return f"{100.0 * error:{'+' if signed else ''}.2f} %"


def _rejudged(change: AdequacyChange) -> bool:
    before, after = change.before, change.after
    return before is None or after is None or before.verdict != after.verdict


def sentence(comparison: RunComparison) -> str:
    """What changed, counted; of two different robots, that nothing can be."""
    if comparison.different_robots:
        first, second = comparison.different_robots
        return (
            f"Two different robots, {first} and {second}: none of their cases is better or worse, "
            "and only the adequacy of their models stands side by side."
        )
    worse = sum(change.worse for change in comparison.verdicts)
    drifted = len({entry.id for entry in comparison.drifted})
    parts = [
        f"{counted(worse, 'verdict')} worse",
        f"{len(comparison.verdicts) - worse} better",
        f"{counted(drifted, 'case')} drifted",
        f"{len(comparison.new)} new",
        f"{len(comparison.removed)} removed",
    ]
    return ", ".join(parts) + "."


def _times(times: Sequence[Timing]) -> str:
    foremost = sorted(times, key=lambda timing: -abs(timing.after - timing.before))[:_SLOWEST]
    total = Timing("all", sum(t.before for t in times), sum(t.after for t in times))
    rows = [
        [f"{t.before:.2f}", f"{t.after:.2f}", f"{t.after - t.before:+.2f}", t.id]
        for t in (*foremost, total)
    ]
    heading = "Time per case (s)"
    if len(times) > len(foremost):
        heading += f", the {len(foremost)} of {len(times)} that changed most"
    return "\n".join(_block(heading, ["before", "after", "change", "case"], rows))


def _block(heading: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"{heading}\n{aligned(columns, rows)}"] if rows else []


def same_pose(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Whether two poses are the same up to rounding, or one of them is not known."""
    if not (one and other):
        return True
    return len(one) == len(other) and all(
        abs(a - b) <= _ROUNDING * max(abs(a), abs(b), 1.0) for a, b in zip(one, other, strict=True)
    )


def drift(
    before: CaseRecord, after: CaseRecord, what: Literal["value", "reference"] = "value"
) -> Drifted | None:
    """Drift of a case's value or reference; None where one is not known, or is of another pose.

    The larger one of the known uncertainties of then and now is allowed, and a relative 1e-9 in any
    case. Where the reference is zero, a thousandth of the tolerance counts as rounding.
    """
    earlier, value = getattr(before, what), getattr(after, what)
    comparable = earlier is not None and value is not None and isfinite(value)
    if not comparable or not same_pose(before.pose, after.pose):
        return None
    known = [
        u for u in (before.numerical_uncertainty, after.numerical_uncertainty) if u is not None
    ]
    allowed = max([*known, _ROUNDING * max(abs(earlier), abs(value))])
    if after.reference == 0.0 and after.tolerance is not None:
        allowed = max(allowed, _OF_TOLERANCE * after.tolerance)
    return Drifted(after.id, what, after.unit, earlier, value, value - earlier, allowed)


def with_drift(record: CaseRecord, earlier: CaseRecord | None) -> CaseRecord:
    """The record of a case with what it has drifted from an earlier one, if that is known."""
    moved = drift(earlier, record) if earlier else None
    if moved is None:
        return record
    return msgspec.structs.replace(
        record,
        earlier=moved.before,
        drift=moved.drift,
        drift_allowed=moved.allowed,
        drifted=moved.beyond,
    )


def _different_robots(before: RunRecord, after: RunRecord) -> tuple[str, ...]:
    """The names of the robots of two runs where these differ; a variant keeps its robot's name."""
    names = [run.run.get("robot") for run in (before, after)]
    return tuple(map(str, names)) if all(names) and names[0] != names[1] else ()


def _drifted(before: CaseRecord, after: CaseRecord) -> Iterator[Drifted]:
    moved = (drift(before, after, what) for what in ("value", "reference"))
    return (one for one in moved if one is not None and one.beyond)


def _input_changes(before: RunRecord, after: RunRecord) -> Iterator[InputChange]:
    tables = [run.run.get("robot_tables") for run in (before, after)]
    if all(isinstance(table, Mapping) for table in tables):
        old, new = (dict(_flat(table)) for table in tables)
        for key in dict.fromkeys([*old, *new]):
            if old.get(key) != new.get(key):
                yield InputChange(key, old.get(key), new.get(key))


def _adequacy_changes(before: RunRecord, after: RunRecord) -> Iterator[AdequacyChange]:
    """Every model and quantity of either run, in the order of the first."""
    old, new = (
        {(entry.model, _name(entry)): entry for entry in run.adequacy} for run in (before, after)
    )
    for key in dict.fromkeys([*old, *new]):
        one, other = old.get(key), new.get(key)
        yield AdequacyChange(*key, one, other, tuple(_value_changes(one, other)))


def _value_changes(before: StoredEntry | None, after: StoredEntry | None) -> Iterator[ValueChange]:
    """The values of poses that both have, in the order of the first."""
    from scipy.spatial import KDTree  # noqa: PLC0415

    old, new = _valued(before), _valued(after)
    # A file that somebody made may have anything as a pose.
    if not (old and new) or len({len(pose) for pose, _ in (*old, *new)}) > 1:
        return
    # A pose of a tool without moves has no coordinates; a point has at least one.
    points = [np.array([(0.0, *pose) for pose, _ in values]) for values in (old, new)]
    nearest = KDTree(points[1]).query(points[0])[1]
    for (pose, value), (other, now) in zip(old, (new[k] for k in nearest), strict=True):
        if same_pose(pose, other):
            yield ValueChange(pose, value, now)


def _name(entry: StoredEntry) -> str:
    """The quantity; by a measured reference it stands beside that by a computed one."""
    return f"{entry.quantity} (measured)" if entry.measured else entry.quantity


def _flat(tables: Any) -> Iterator[tuple[str, Any]]:
    """Every entry of the tables by its key, however deep they are."""
    waiting: list[tuple[str, Any]] = [("", tables)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, Mapping):
            inner = [(f"{path}.{key}" if path else str(key), one) for key, one in value.items()]
            waiting += reversed(inner)
        elif isinstance(value, Sequence) and not isinstance(value, str):
            inner = [(f"{path}[{number}]", one) for number, one in enumerate(value, start=1)]
            waiting += reversed(inner)
        else:
            yield path, value


def _valued(entry: StoredEntry | None) -> list[tuple[tuple[float, ...], float]]:
    known = zip(entry.poses, entry.values, strict=False) if entry else ()
    return [(pose, value) for pose, value in known if value is not None]
