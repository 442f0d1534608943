"""A description as far as it can be read: what is sound in it, and all names that occur.

Faults in one entry must not hide those of the others; so each entry is read on its own.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.rules.rule import Named
from lumped.robot_file.rules.tables import MECHANISM
from lumped.text import did_you_mean, shown

# A sound table as it is read: a value for every key, None where left out.
Entry: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Draft:
    """The sound entries of a robot file's tables, by name; `names` of all, sound or not."""

    points: Mapping[str, Array]
    materials: Mapping[str, Entry]
    bodies: Mapping[str, Entry]
    joints: Mapping[str, Entry]
    tool: Entry | None
    path: Entry | None
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
        held = (table["points"], table["interfaces"], (table["from"], table["to"]))
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
    points, materials, bodies, joints, tool, path = (
        _sound(tables, key) for key in ("points", "materials", "bodies", "joints", "tool", "path")
    )
    return Draft(
        points={name: np.array(place) for name, place in points.items()},
        materials=materials,
        bodies=bodies,
        joints=joints,
        tool=tool or None,
        path=path or None,
        names={key: tuple(_group(tables, key)) for key in MECHANISM.keys},
    )


def _group(tables: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    group = tables.get(key)
    return group if isinstance(group, dict) else {}


def _sound(tables: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The sound entries of a table of named ones; of [tool] and [path] all or nothing."""
    group, rule = _group(tables, key), MECHANISM.keys[key].kind
    if isinstance(rule, Named):
        kind = rule.kind
        return {name: kind.read(one) for name, one in group.items() if not kind.faults(one, name)}
    return {} if rule.faults(tables.get(key), key) else rule.read(group)
