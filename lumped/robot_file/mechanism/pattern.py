"""Copies of points, bodies and joints about an axis: entries of a robot file with a `pattern`.

Copy k of n is the entry rotated by (k − 1)·360°/n about the axis. The number k is appended to the
name of the entry. It is also appended to names in the entry that refer to other entries with the
same pattern. All other names remain unchanged.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.placing import default_up
from lumped.robot_file.rules.rule import NO_DIRECTION, Text
from lumped.robot_file.rules.tables.robots import rules_of
from lumped.screws import rotation_about, turn_matrix
from lumped.text import shown, unknown_name

Tables: TypeAlias = Mapping[str, Any]
# Table and name of an entry.
Key: TypeAlias = tuple[str, str]
_PATTERN = "pattern"
_COPIED = ("points", "bodies", "joints")
# Distance from an axis, relative to the coordinates of a point, below which the point lies on the
# axis: the precision of typed numbers.
_ON_AXIS = 1e-6
# Position of a part whose file is in base axes.
_FILE_AXES = {"at": [0.0, 0.0, 0.0], "x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0]}
# Keys of an entry that refer to entries of another table.
_NAMES = {
    "bodies": dict.fromkeys(("from", "to", "points", "centre"), "points"),
    "joints": {"between": "bodies", "at": "points"},
}


@dataclass(frozen=True)
class _Pattern:
    """Rotational symmetry with `count` copies about an axis.

    `about` is the unit vector of the axis, `through` a point on it in the length unit of the file.
    """

    about: tuple[float, ...]
    through: tuple[float, ...]
    count: int

    def turn(self, number: int) -> Array:
        """Rotation (3×3) of copy `number`, which is 1 for the entry itself."""
        angle = 2.0 * np.pi * (number - 1) / self.count
        rotation: Array = rotation_about(angle * np.array(self.about))
        return rotation

    def place(self, point: Any, number: int) -> list[float]:
        """Position (3) in copy `number` of a `point` of the entry (3 coordinates).

        Both are in the length unit of the file.
        """
        origin = np.array(self.through)
        turned: list[float] = (origin + self.turn(number) @ (np.array(point) - origin)).tolist()
        return turned

    def direction(self, direction: Any, number: int) -> list[float]:
        """Vector (3) in copy `number` that corresponds to the vector `direction` of the entry."""
        turned: list[float] = (self.turn(number) @ np.array(direction, dtype=float)).tolist()
        return turned

    def misses(self, tables: Tables, point: str) -> bool:
        """True if a point has known coordinates and does not lie on the axis of the pattern."""
        position = _coordinates(tables, point)
        if position is None:
            return False
        arm = np.array(position) - np.array(self.through)
        far = np.linalg.norm(np.cross(self.about, arm))
        return bool(far > _ON_AXIS * max(1.0, float(np.linalg.norm(arm))))


def has_patterns(tables: Tables) -> bool:
    """True if any entry of the tables has a pattern."""
    return bool(_repeated(tables))


def pattern_faults(tables: Tables) -> list[str]:
    """Faults of patterns in tables whose keys have been checked, one line each."""
    pattern_items, faults = collect_faults(partial(_pattern, tables), _repeated(tables))
    patterns = dict(pattern_items)
    for (table, name), pattern in patterns.items():
        copies = {f"{name}{number}": number for number in range(1, pattern.count + 1)}
        faults += [
            f"{table}.{copy}: is copy {number} of {table}.{name} already; must have another name"
            for copy, number in copies.items()
            if copy in tables[table]
        ]
        for key, reference, among in _references(tables, table, name):
            other = patterns.get((among, reference))
            if other is None and among == "points" and pattern.misses(tables, reference):
                faults.append(
                    f"{key} = {shown(reference)}: has no pattern and lies off the axis of "
                    f"{table}.{name}; must have the same pattern, or lie on the axis"
                )
            if other is not None and other != pattern:
                faults.append(
                    f"{key} = {shown(reference)}: has another pattern than {table}.{name}; must "
                    "be the same axis and count, or the name of one copy"
                )
    return faults


def written_out(tables: Tables) -> Tables:
    """Tables in which each copy of an entry with a pattern is an entry of its own.

    All points are lists of coordinates.
    """
    points = tables.get("points", {}).values()
    if not has_patterns(tables) and not any(isinstance(point, dict) for point in points):
        return tables
    patterns = dict(_pattern(tables, entry) for entry in _repeated(tables))
    new = {name: table for name, table in tables.items() if name != "patterns"}
    for table in _COPIED:
        new[table] = {}
        for name, entry in tables[table].items():
            pattern = patterns.get((table, name))
            if pattern is None:
                is_point = table == "points" and isinstance(entry, dict)
                new[table][name] = entry["at"] if is_point else entry
                continue
            for number in range(1, pattern.count + 1):
                copy = _copied(tables, patterns, (table, name), number)
                new[table][f"{name}{number}"] = copy
    return new


def _repeated(tables: Tables) -> list[Key]:
    """Table and name of each point, body and joint with a pattern."""
    groups = {table: tables.get(table) for table in _COPIED}
    return [
        (table, name)
        for table, group in groups.items()
        for name, entry in (group.items() if isinstance(group, dict) else ())
        if isinstance(entry, dict) and _PATTERN in entry
    ]


def _pattern(tables: Tables, of: Key) -> tuple[Key, _Pattern]:
    """The entry `of` (table and name) and its pattern.

    Raises InputError if the pattern has a fault.
    """
    (table, name), patterns = of, tables.get("patterns", {})
    key, pattern = f"{table}.{name}.{_PATTERN}", tables[table][name][_PATTERN]
    if isinstance(pattern, str):
        if pattern not in patterns:
            raise InputError(unknown_name(key, pattern, patterns, "the name of one of [patterns]"))
        key, pattern = f"patterns.{pattern}", patterns[pattern]
    about, through = pattern["about"], pattern.get("through", [0.0, 0.0, 0.0])
    axis = np.eye(3)["xyz".index(about)] if isinstance(about, str) else np.array(about, float)
    if np.linalg.norm(axis) < NO_DIRECTION:
        raise InputError(f"{key}.about = {list(about)}: must not be zero, it is a direction")
    position = _coordinates(tables, through) if isinstance(through, str) else through
    if position is None:
        raise InputError(
            f"{key}.through = {shown(through)}: must be the name of a point without a pattern, or "
            "[x, y, z]"
        )
    unit = tuple((axis / np.linalg.norm(axis)).tolist())
    return of, _Pattern(unit, tuple(map(float, position)), pattern["count"])


def _coordinates(tables: Tables, point: str) -> list[float] | None:
    """Coordinates of a point. None if there is no such point, or if it has a pattern."""
    entry = tables["points"].get(point)
    if isinstance(entry, dict):
        entry = None if _PATTERN in entry else entry["at"]
    return entry if isinstance(entry, list) else None


def _references(tables: Tables, table: str, name: str) -> Iterator[tuple[str, str, str]]:
    """References from the entry `name` of `table` to other points, bodies and joints.

    Each contains the location of the reference, and the name and the table of the entry to which it
    refers.
    """
    rule = rules_of(tables).keys[table].kind
    entries = {name: tables[table][name]}
    for key, kind, value in rule.within(entries, table):
        if isinstance(kind, Text) and kind.among in _COPIED:
            yield key, value, kind.among


def _copied(
    tables: Tables, patterns: Mapping[Key, _Pattern], of: Key, number: int
) -> dict[str, Any] | list[float]:
    """Copy `number` (from 1) of the entry `of` (table and name), which has a pattern.

    `patterns` contains the patterns of all entries.
    """
    (table, name), pattern = of, patterns[of]
    entry = {key: value for key, value in tables[table][name].items() if key != _PATTERN}
    if table == "points":
        return pattern.place(entry["at"], number) if number > 1 else list(entry["at"])
    if "from" in entry and number > 1:
        entry.setdefault("up", _default_up(tables, entry))
    if "interfaces" in entry:
        entry["place"] = _FILE_AXES | entry.get("place", {})
    if number > 1:
        entry |= _turned(entry, pattern, number)

    def numbered(among: str, value: Any) -> Any:
        if isinstance(value, str):
            return f"{value}{number}" if (among, value) in patterns else value
        are_names = isinstance(value, list) and all(isinstance(name, str) for name in value)
        return [numbered(among, name) for name in value] if are_names else value

    def placed(stop: Any) -> Any:
        """Point of a leg's centre line in the copy, from that of the entry.

        Both are a name, coordinates, or a table { arc = POINT } with a name or coordinates.
        """
        if isinstance(stop, dict):
            return {key: placed(point) for key, point in stop.items()}
        if isinstance(stop, str):
            return numbered("points", stop)
        return pattern.place(stop, number)

    for key, among in _NAMES[table].items():
        if key in entry:
            entry[key] = numbered(among, entry[key])
    if "through" in entry:
        entry["through"] = [placed(stop) for stop in entry["through"]]
    if "sections" in entry:
        entry["sections"] = [
            section | {"at": numbered("points", section["at"])} for section in entry["sections"]
        ]
    if "interfaces" in entry:
        faces = entry["interfaces"]
        entry["interfaces"] = {
            numbered("points", point): selection for point, selection in faces.items()
        }
        entry["place"] = entry["place"] | {"at": numbered("points", entry["place"]["at"])}
    return entry


def _default_up(tables: Tables, leg: Tables) -> list[float]:
    """Default direction `up` (3) of a leg from its entry. Arbitrary if its points have faults."""
    ends = [tables["points"].get(leg.get(end)) for end in ("from", "to")]
    start, tip = (
        np.array(point["at"] if isinstance(point, dict) else point or 0.0) for point in ends
    )
    chord = tip - start
    up: list[float] = default_up(chord / (np.linalg.norm(chord) or 1.0)).tolist()
    return up


def _turned(entry: Tables, pattern: _Pattern, number: int) -> dict[str, Any]:
    """Keys and values of copy `number` of a body or joint that the rotation changes.

    They are positions, directions and matrices in base axes.
    """
    turned: dict[str, Any] = {}
    rotation = pattern.turn(number)
    if isinstance(entry.get("centre"), list):
        turned["centre"] = pattern.place(entry["centre"], number)
    if "points" in entry and "inertia" in entry:
        turned["inertia"] = (rotation @ np.array(entry["inertia"]) @ rotation.T).tolist()
    if "between" in entry and "compliance" in entry:
        turned["compliance"] = turn_matrix(np.array(entry["compliance"]), rotation).tolist()
    for key in ("up", "axis"):
        if key in entry:
            turned[key] = pattern.direction(entry[key], number)
    if "axes" in entry:
        turned["axes"] = [pattern.direction(axis, number) for axis in entry["axes"]]
    if "place" in entry:
        placement = entry["place"]
        turned["place"] = placement | {
            key: pattern.direction(placement[key], number) for key in "xy"
        }
        if isinstance(placement["at"], list):
            turned["place"]["at"] = pattern.place(placement["at"], number)
    return turned
