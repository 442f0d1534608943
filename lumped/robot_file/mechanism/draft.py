"""A description as far as it can be read: what is sound in it, and all names that occur.

Faults in one entry must not hide those of the others; so each entry is read on its own.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from lumped.arrays import Array
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.mechanism.part_tables import Point
from lumped.robot_file.mechanism.tables import (
    BodyTable,
    JointTable,
    PathTable,
    ToolTable,
)
from lumped.robot_file.table_faults import value_faults
from lumped.robot_file.tables import MaterialTable
from lumped.text import did_you_mean, shown


@dataclass(frozen=True, eq=False)
class Draft:
    """The sound entries of a robot file's tables, by name; `names` of all, sound or not."""

    points: Mapping[str, Array]
    materials: Mapping[str, MaterialTable]
    bodies: Mapping[str, BodyTable]
    joints: Mapping[str, JointTable]
    tool: ToolTable | None
    path: PathTable | None
    names: Mapping[str, tuple[str, ...]]

    def unknown(self, key: str, name: str, among: str) -> list[str]:
        """The fault of a `name` at `key` that none of the table `among` has; empty if one has."""
        known = self.names[among] + ((GROUND,) if among == "bodies" else ())
        return wrong_name(key, name, known, f"the name of one of [{among}]")

    def interfaces(self, body: str) -> tuple[str, ...] | None:
        """Points at which a body can be joined; None for ground, that has all of them.

        None too for a body whose points have faults of their own, which joints must not repeat.
        """
        if body == GROUND or body not in self.bodies:
            return None
        table = self.bodies[body]
        held = (table.points, table.interfaces, (table.start, table.to))
        given = [tuple(point for point in points or () if point) for points in held]
        begun = [points for points in given if points]
        if len(begun) != 1 or (begun[0] == given[2] and len(set(begun[0])) != 2):
            return None
        known = all(point in self.names["points"] for point in begun[0])
        return begun[0] if known else None


def wrong_name(key: str, name: str, known: Iterable[str], allowed: str) -> list[str]:
    """The fault of a name that is not among the known ones, with the closest that is."""
    known = tuple(known)
    if name in known:
        return []
    advice = did_you_mean(name, known, otherwise=f": {', '.join(known) or 'none'}")
    return [f"{key} = {shown(name)}: must be {allowed}{advice}"]


def draft(tables: Mapping[str, Any]) -> Draft:
    """What is sound in the tables of a robot file of schema 2."""
    groups = {key: _table(tables, key) for key in ("points", "materials", "bodies", "joints")}
    return Draft(
        points={n: np.array(place, dtype=float) for n, place in _sound(groups["points"], Point)},
        materials=dict(_sound(groups["materials"], MaterialTable)),
        bodies=dict(_sound(groups["bodies"], BodyTable)),
        joints=dict(_sound(groups["joints"], JointTable)),
        tool=_one(tables, "tool", ToolTable),
        path=_one(tables, "path", PathTable),
        names={key: tuple(group) for key, group in groups.items()},
    )


def _table(tables: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    group = tables.get(key)
    return group if isinstance(group, dict) else {}


def _one(tables: Mapping[str, Any], key: str, kind: Any) -> Any:
    entry = {key: tables[key]} if key in tables else {}
    return next((table for _, table in _sound(entry, kind)), None)


def _sound(entries: Mapping[str, Any], kind: Any) -> Iterable[tuple[str, Any]]:
    for name, entry in entries.items():
        if not value_faults(kind, entry, name):
            yield name, msgspec.convert(entry, kind)
