"""Two runs side by side: verdicts that changed, values that drifted, cases that came and went.

Of runs of different inputs, what differs in these, and the adequacy of their models side by side.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from validation.results.drift import drift, same_pose
from validation.results.outcome import Verdict
from validation.results.records import AdequacyRecord, CaseRecord, RunRecord

# From good to bad; a case that is skipped no longer protects anything.
_RANK: dict[Verdict, int] = {"agree": 0, "skipped": 1, "undecided": 2, "disagree": 3, "failed": 4}
# What should be the same in two runs whose numbers are compared.
_CIRCUMSTANCES = ("robot", "robot_sha256", "preset", "options", "versions", "machine")


@dataclass(frozen=True)
class VerdictChange:
    """A case whose verdict is another one than before."""

    id: str
    before: Verdict
    after: Verdict

    @property
    def worse(self) -> bool:
        """Whether it worsened; good to bad: agree, skipped, undecided, disagree, failed."""
        return _RANK[self.after] > _RANK[self.before]


@dataclass(frozen=True)
class Drifted:
    """A value or a reference (`what`) that moved by more than its uncertainty allows."""

    id: str
    what: str
    unit: str
    before: float
    after: float
    drift: float
    allowed: float


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
class AdequacyChange:
    """A model's quantity in both runs; None where a run does not have it."""

    model: str
    quantity: str
    before: AdequacyRecord | None
    after: AdequacyRecord | None

    @property
    def shared_poses(self) -> tuple[tuple[tuple[float, ...], float, float], ...]:
        """Poses that both runs looked at, with the model's value in each (SI)."""
        if self.before is None or self.after is None:
            return ()
        return tuple(
            (pose, before, after)
            for pose, before in _valued(self.before)
            for other, after in _valued(self.after)
            if same_pose(pose, other)
        )


@dataclass(frozen=True)
class RunComparison:
    """What changed from one run to the other; `circumstances` names what else differs.

    `inputs` are the keys of the robot file that differ, None where a run does not tell them. Of
    different inputs no value drifts: they differ, as they should. `adequacy` is that of both.
    `robots` are the names of two different robots, of whose cases none is better or worse, new or
    removed; empty where both runs are of one.
    """

    verdicts: tuple[VerdictChange, ...]
    drifted: tuple[Drifted, ...]
    new: tuple[str, ...]
    removed: tuple[str, ...]
    times: tuple[Timing, ...]
    circumstances: tuple[str, ...]
    inputs: tuple[InputChange, ...] | None = None
    adequacy: tuple[AdequacyChange, ...] = ()
    robots: tuple[str, ...] = ()

    @property
    def worsened(self) -> bool:
        """Whether any verdict worsened."""
        return any(change.worse for change in self.verdicts)


def compare(before: RunRecord, after: RunRecord) -> RunComparison:
    """What changed from `before` to `after`."""
    robots = different_robots(before, after)
    old, new = ({}, {}) if robots else (before.by_id, after.by_id)
    both = [(old[identifier], case) for identifier, case in new.items() if identifier in old]
    inputs = input_changes(before, after)
    return RunComparison(
        verdicts=tuple(
            VerdictChange(b.id, a.verdict, b.verdict) for a, b in both if a.verdict != b.verdict
        ),
        drifted=() if inputs else tuple(entry for a, b in both for entry in _drifted(a, b)),
        new=tuple(identifier for identifier in new if identifier not in old),
        removed=tuple(identifier for identifier in old if identifier not in new),
        times=tuple(Timing(b.id, a.seconds, b.seconds) for a, b in both),
        circumstances=tuple(
            name for name in _CIRCUMSTANCES if before.run.get(name) != after.run.get(name)
        ),
        inputs=inputs,
        adequacy=adequacy_changes(before, after),
        robots=robots,
    )


def different_robots(before: RunRecord, after: RunRecord) -> tuple[str, ...]:
    """The names of the robots of two runs where these differ; a variant keeps its robot's name."""
    names = [run.run.get("robot") for run in (before, after)]
    return tuple(map(str, names)) if all(names) and names[0] != names[1] else ()


def as_dict(comparison: RunComparison) -> dict[str, Any]:
    """The comparison as plain data for JSON."""
    return {
        "schema": 1,
        "worsened": comparison.worsened,
        "different_robots": list(comparison.robots),
        "verdicts": [asdict(change) | {"worse": change.worse} for change in comparison.verdicts],
        "drifted": [asdict(entry) for entry in comparison.drifted],
        "new": list(comparison.new),
        "removed": list(comparison.removed),
        "seconds": [asdict(timing) for timing in comparison.times],
        "differs": list(comparison.circumstances),
        "inputs": [asdict(change) for change in comparison.inputs or ()],
        "adequacy": [_adequacy(change) for change in comparison.adequacy],
    }


def _adequacy(change: AdequacyChange) -> dict[str, Any]:
    sides = {
        when: None
        if side is None
        else {name: getattr(side, name) for name in ("verdict", "error", "uncertainty", "along")}
        for when, side in (("before", change.before), ("after", change.after))
    }
    values = [
        {"pose": list(pose), "before": before, "after": after}
        for pose, before, after in change.shared_poses
    ]
    return {"model": change.model, "quantity": change.quantity, **sides, "values": values}


def _drifted(before: CaseRecord, after: CaseRecord) -> list[Drifted]:
    if not same_pose(before.pose, after.pose):
        # The worst posture is another one: these are two quantities, and none of them has moved.
        return []
    found = []
    for what in ("value", "reference"):
        old, new = getattr(before, what), getattr(after, what)
        if old is None or new is None:
            continue
        moved = drift(
            old,
            new,
            uncertainties=(before.numerical_uncertainty, after.numerical_uncertainty),
            reference=after.reference,
            tolerance=after.tolerance,
        )
        if moved.beyond:
            found.append(Drifted(after.id, what, after.unit, old, new, moved.amount, moved.allowed))
    return found


def input_changes(before: RunRecord, after: RunRecord) -> tuple[InputChange, ...] | None:
    """Keys of the robot file whose values differ; None where a run does not tell its input."""
    tables = [run.run.get("robot_tables") for run in (before, after)]
    if not all(isinstance(table, Mapping) for table in tables):
        return None
    old, new = (dict(_flat(table)) for table in tables)
    return tuple(
        InputChange(key, old.get(key), new.get(key))
        for key in dict.fromkeys([*old, *new])
        if old.get(key) != new.get(key)
    )


def adequacy_changes(before: RunRecord, after: RunRecord) -> tuple[AdequacyChange, ...]:
    """Every model and quantity of either run, in the order of the first."""
    old, new = (
        {(entry.model, _name(entry)): entry for entry in run.adequacy} for run in (before, after)
    )
    return tuple(
        AdequacyChange(*key, old.get(key), new.get(key)) for key in dict.fromkeys([*old, *new])
    )


def _name(entry: AdequacyRecord) -> str:
    """The quantity; by a measured reference it stands beside that by a computed one."""
    return f"{entry.quantity} (measured)" if entry.measured else entry.quantity


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _flat(entry, f"{path}.{key}" if path else str(key))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for number, entry in enumerate(value, start=1):
            yield from _flat(entry, f"{path}[{number}]")
    else:
        yield path, value


def _valued(entry: AdequacyRecord) -> list[tuple[tuple[float, ...], float]]:
    known = zip(entry.poses, entry.values, strict=False)
    return [(pose, value) for pose, value in known if value is not None]
