"""Comparison of two runs: changed verdicts, drift of values, new and removed cases.

Input: two run records. Output: `RunComparison`, as text or JSON. Rule: verdicts depend on
independent references. An earlier value of this program is not a reference: its change is drift,
never disagreement. For runs of different inputs, the differences of the inputs and the adequacy of
models are listed next to each other.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, isnan
from typing import Any, Literal, TypeAlias

import msgspec
import numpy as np

from lumped.text import aligned, counted
from validation.drawing.text import error_with_spread
from validation.run.outcome import Outcome, Verdict
from validation.run.records import RunRecord, StoredEntry

# Relative round-off between machines and library versions; this is far above it, and far below any
# tolerance.
_ROUNDING = 1e-9
# For a reference of zero, drift is allowed up to this fraction of the tolerance, since no size
# exists for a relative change.
_TOLERANCE_SHARE = 1e-3
# Ranks from good to bad. Skipped is worse than agree, since a skipped case detects no faults.
_RANK: dict[Verdict, int] = {"agree": 0, "skipped": 1, "undecided": 2, "disagree": 3, "failed": 4}
# Fields of the header that should be equal if the numbers of two runs are compared.
_CIRCUMSTANCES = ("robot", "robot_sha256", "preset", "options", "versions", "machine")
# Number of cases listed by the change of their time. --json has all of them.
_SLOWEST = 10
ComparedNumber: TypeAlias = Literal["value", "reference"]
_COMPARED_NUMBERS: tuple[ComparedNumber, ...] = ("value", "reference")


@dataclass(frozen=True)
class VerdictChange:
    """Change of a case's verdict.

    The order from best to worst is agree, skipped, undecided, disagree, failed.
    """

    id: str
    before: Verdict
    after: Verdict
    worse: bool


@dataclass(frozen=True)
class Drifted:
    """Change of a number of a case, in `unit`. It counts as drift if it exceeds `allowed`.

    `what`: "value" or "reference". `drift`: `after` − `before`.
    """

    id: str
    what: str
    unit: str
    before: float
    after: float
    drift: float
    allowed: float

    @property
    def beyond(self) -> bool:
        """True if the magnitude of the change exceeds the allowed one."""
        return abs(self.drift) > self.allowed


@dataclass(frozen=True)
class Timing:
    """Computing time (s) of a case in both runs."""

    id: str
    before: float
    after: float


@dataclass(frozen=True)
class InputChange:
    """A key of the robot file with its value in both runs. None if the file lacks the key."""

    key: str
    before: Any
    after: Any


@dataclass(frozen=True)
class ValueChange:
    """Value (SI) of a quantity by a model in one pose, in each of two runs."""

    pose: tuple[float, ...]
    before: float
    after: float


@dataclass(frozen=True)
class AdequacyChange:
    """Entry of a model and a quantity in each of two runs. None if a run lacks the entry.

    `values`: values of the quantity in the poses that both entries have.
    """

    model: str
    quantity: str
    before: StoredEntry | None
    after: StoredEntry | None
    values: tuple[ValueChange, ...]


@dataclass(frozen=True)
class RunComparison:
    """Changes from one run to another.

    `verdicts`: changed verdicts of cases. `drifted`: numbers that changed by more than the allowed
    drift. `new`, `removed`: ids of cases that only the later or only the earlier run has.
    `seconds`: computing times of the cases of both runs. `differs`: header fields that differ.
    `inputs`: keys of the robot file that differ, if both runs contain its tables. If there are any,
    drift is not computed. `adequacy`: entries of all models and quantities of both runs, also if
    equal. `different_robots`: names of two robots, whose cases are not compared; () if both runs
    are of one robot.
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
        """True if any verdict is worse."""
        return any(change.worse for change in self.verdicts)


def compare(before: RunRecord, after: RunRecord) -> RunComparison:
    """Changes from the run `before` to the run `after`."""
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
        drifted=()
        if inputs
        else tuple(
            change
            for a, b in both
            for field in _COMPARED_NUMBERS
            if (change := drift(a, b, field)) and change.beyond
        ),
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
    """Comparison as plain data for JSON."""
    return {"schema": 1, "worsened": comparison.worsened, **msgspec.to_builtins(comparison)}


def as_text(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    """Changes as text, the most serious first."""
    blocks = [_run_headings(before, after, comparison), sentence(comparison)]
    if comparison.inputs and not comparison.different_robots:
        blocks.append("The input differs: two robots, whose numbers may differ without any drift.")
        blocks += _table_block(
            "Input",
            ["key", "before", "after"],
            [[c.key, _input_text(c.before), _input_text(c.after)] for c in comparison.inputs],
        )
    blocks += _table_block(
        "Adequacy",
        ["model", "quantity", "before", "", "after", ""],
        [
            [c.model, c.quantity, *_entry_cells(c.before), *_entry_cells(c.after)]
            for c in comparison.adequacy
            # Listed for two robots: all entries; for variants of a robot: entries whose text
            # differs; for one input: entries whose verdict differs.
            if comparison.different_robots
            or (
                _entry_cells(c.before) != _entry_cells(c.after)
                if comparison.inputs
                else _verdict_changed(c)
            )
        ],
    )
    worst_first = sorted(comparison.verdicts, key=lambda change: not change.worse)
    blocks += _table_block(
        "Verdicts that changed",
        ["", "before", "after", "case"],
        [["worse" if c.worse else "", c.before, c.after, c.id] for c in worst_first],
    )
    numbers = "{0.before:.10g} {0.after:.10g} {0.drift:+.2g} {0.allowed:.2g}"
    blocks += _table_block(
        "Drifted beyond their uncertainty",
        ["before", "after", "drift", "allowed", "unit", "", "case"],
        [[*numbers.format(d).split(), d.unit, d.what, d.id] for d in comparison.drifted],
    )
    blocks += _table_block("New cases", ["case"], [[identifier] for identifier in comparison.new])
    blocks += _table_block(
        "Removed cases", ["case"], [[identifier] for identifier in comparison.removed]
    )
    if comparison.seconds:
        blocks.append(_time_table(comparison.seconds))
    return "\n\n".join(blocks)


def _run_headings(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    columns = ("robot", "preset", "started")
    rows = [
        [name, *(str(run.run.get(key, "?")) for key in columns), counted(len(run.cases), "case")]
        for name, run in (("before", before), ("after", after))
    ]
    differs = [name.replace("_", " ") for name in comparison.differs]
    note = f"\nThe runs differ in {', '.join(differs)}." if differs else ""
    return aligned(["", "robot", "preset", "started", ""], rows) + note


def _input_text(value: object) -> str:
    return "not given" if value is None else str(value)


def _entry_cells(entry: StoredEntry | None) -> list[str]:
    if entry is None:
        return ["", ""]
    if entry.error is None:
        return ["", entry.verdict]
    along = "" if entry.along is None else f" ({_percent(entry.along)} along)"
    error = error_with_spread(entry, _percent).replace("\N{NO-BREAK SPACE}", " ")
    return [f"{error}{along}", entry.verdict]


def _percent(error: float, *, signed: bool = True) -> str:
    """Error in per cent with two decimals, so that variants of a robot can be distinguished."""
    return f"{100.0 * error:{'+' if signed else ''}.2f} %"


def _verdict_changed(change: AdequacyChange) -> bool:
    before, after = change.before, change.after
    return before is None or after is None or before.verdict != after.verdict


def sentence(comparison: RunComparison) -> str:
    """Sentence that counts the changes, or states that two different robots are not compared."""
    if comparison.different_robots:
        first, second = comparison.different_robots
        return (
            f"Two different robots, {first} and {second}: their cases are not ranked. "
            "The adequacy of their models is listed side by side."
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


def _time_table(times: Sequence[Timing]) -> str:
    foremost = sorted(times, key=lambda timing: -abs(timing.after - timing.before))[:_SLOWEST]
    total = Timing("all", sum(t.before for t in times), sum(t.after for t in times))
    rows = [
        [f"{t.before:.2f}", f"{t.after:.2f}", f"{t.after - t.before:+.2f}", t.id]
        for t in (*foremost, total)
    ]
    heading = "Time per case (s)"
    if len(times) > len(foremost):
        heading += f", the {len(foremost)} of {len(times)} that changed most"
    return "\n".join(_table_block(heading, ["before", "after", "change", "case"], rows))


def _table_block(heading: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"{heading}\n{aligned(columns, rows)}"] if rows else []


def same_pose(first: tuple[float, ...], second: tuple[float, ...]) -> bool:
    """True if two poses are equal up to round-off, or if one of them is unknown, that is ()."""
    if not (first and second):
        return True
    return len(first) == len(second) and all(
        abs(a - b) <= _ROUNDING * max(abs(a), abs(b), 1.0)
        for a, b in zip(first, second, strict=True)
    )


def drift(before: Outcome, after: Outcome, field: ComparedNumber = "value") -> Drifted | None:
    """Change of a case's value or reference, with the allowed drift.

    None if a run lacks the number, or if the poses differ. The allowed drift is the larger of the
    known numerical uncertainties of both runs, and at least 1e-9 times the larger number. If the
    reference is zero, it is at least a thousandth of the tolerance.
    """
    if before.measurement is None or after.measurement is None:
        return None
    measurements = before.measurement, after.measurement
    earlier, value = (getattr(measurement, field) for measurement in measurements)
    poses = (measurement.pose for measurement in measurements)
    if not (isfinite(earlier) and isfinite(value) and same_pose(*poses)):
        return None
    half_widths = [measurement.numerical_uncertainty for measurement in measurements]
    finite_half_widths = [
        half_width for half_width in half_widths if half_width and not isnan(half_width)
    ]
    allowed = max([*finite_half_widths, _ROUNDING * max(abs(earlier), abs(value))])
    if after.measurement.reference == 0.0:
        allowed = max(allowed, _TOLERANCE_SHARE * after.tolerance)
    return Drifted(after.id, field, after.case.unit, earlier, value, value - earlier, allowed)


def with_drift(outcome: Outcome, earlier: Outcome | None) -> Outcome:
    """Copy of an outcome with its drift from an `earlier` one.

    The outcome itself if the drift is unknown.
    """
    change = drift(earlier, outcome) if earlier else None
    if change is None:
        return outcome
    return msgspec.structs.replace(
        outcome,
        earlier=change.before,
        drift=change.drift,
        drift_allowed=change.allowed,
        drifted=change.beyond,
    )


def _different_robots(before: RunRecord, after: RunRecord) -> tuple[str, ...]:
    """Names of the robots of two runs if they differ, otherwise ().

    Variants of a robot have the same name.
    """
    names = [run.run.get("robot") for run in (before, after)]
    return tuple(map(str, names)) if all(names) and names[0] != names[1] else ()


def _input_changes(before: RunRecord, after: RunRecord) -> Iterator[InputChange]:
    tables = [run.run.get("robot_tables") for run in (before, after)]
    if all(isinstance(table, Mapping) for table in tables):
        old, new = (dict(_flat_items(table)) for table in tables)
        for key in dict.fromkeys([*old, *new]):
            if old.get(key) != new.get(key):
                yield InputChange(key, old.get(key), new.get(key))


def _adequacy_changes(before: RunRecord, after: RunRecord) -> Iterator[AdequacyChange]:
    """Entries of all models and quantities of either run, those of `before` first."""
    old, new = (
        {(entry.model, _quantity_name(entry)): entry for entry in run.adequacy}
        for run in (before, after)
    )
    for key in dict.fromkeys([*old, *new]):
        before_entry, after_entry = old.get(key), new.get(key)
        yield AdequacyChange(
            *key, before_entry, after_entry, tuple(_value_changes(before_entry, after_entry))
        )


def _value_changes(before: StoredEntry | None, after: StoredEntry | None) -> Iterator[ValueChange]:
    """Values in the poses that both entries have, in the order of `before`."""
    from scipy.spatial import KDTree  # noqa: PLC0415

    old, new = _values_by_pose(before), _values_by_pose(after)
    # An edited file can have poses of any length.
    if not (old and new) or len({len(pose) for pose, _ in (*old, *new)}) > 1:
        return
    # A pose of a tool without moves has no coordinates, but a point needs at least one.
    points = [np.array([(0.0, *pose) for pose, _ in values]) for values in (old, new)]
    nearest = KDTree(points[1]).query(points[0])[1]
    for (pose, value), (other_pose, other_value) in zip(
        old, (new[k] for k in nearest), strict=True
    ):
        if same_pose(pose, other_pose):
            yield ValueChange(pose, value, other_value)


def _quantity_name(entry: StoredEntry) -> str:
    """Name of a quantity, with a remark if its reference is measured."""
    return f"{entry.quantity} (measured)" if entry.measured else entry.quantity


def _flat_items(tables: Any) -> Iterator[tuple[str, Any]]:
    """Each value of nested tables with its full key."""
    pending: list[tuple[str, Any]] = [("", tables)]
    while pending:
        path, value = pending.pop()
        if isinstance(value, Mapping):
            inner = [(f"{path}.{key}" if path else str(key), item) for key, item in value.items()]
            pending += reversed(inner)
        elif isinstance(value, Sequence) and not isinstance(value, str):
            inner = [(f"{path}[{number}]", item) for number, item in enumerate(value, start=1)]
            pending += reversed(inner)
        else:
            yield path, value


def _values_by_pose(entry: StoredEntry | None) -> list[tuple[tuple[float, ...], float]]:
    pairs = zip(entry.poses, entry.values, strict=False) if entry else ()
    return [(pose, value) for pose, value in pairs if value is not None]
