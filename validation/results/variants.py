"""What differs in the input of two runs, and the adequacy of their models side by side."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from validation.results.drift import same_pose
from validation.results.saved_run import SavedEntry, SavedRun


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
    before: SavedEntry | None
    after: SavedEntry | None

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


def input_changes(before: SavedRun, after: SavedRun) -> tuple[InputChange, ...] | None:
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


def adequacy_changes(before: SavedRun, after: SavedRun) -> tuple[AdequacyChange, ...]:
    """Every model and quantity of either run, in the order of the first."""
    old, new = (
        {(entry.model, _name(entry)): entry for entry in run.adequacy} for run in (before, after)
    )
    return tuple(
        AdequacyChange(*key, old.get(key), new.get(key)) for key in dict.fromkeys([*old, *new])
    )


def _name(entry: SavedEntry) -> str:
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


def _valued(entry: SavedEntry) -> list[tuple[tuple[float, ...], float]]:
    known = zip(entry.poses, entry.values, strict=False)
    return [(pose, value) for pose, value in known if value is not None]
