"""A description as far as it can be read: its sound entries with what follows of their keys.

Faults in one entry must not hide those of the others; so each entry is read on its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import AXES
from lumped.mechanism.length_unit import UnitOfLength
from lumped.robot_file.rules.relations import NO_DIRECTION, Entry
from lumped.robot_file.rules.rule import Named
from lumped.robot_file.rules.tables import MECHANISM, length_unit_of, rules_of

_TELLING = {"from": "leg", "to": "leg", "points": "rigid body", "step": "part", "mesh": "part"}


@dataclass(frozen=True, eq=False)
class Draft:
    """The sound entries of a robot file's tables, by name; `names` of all, sound or not.

    Beside the keys of an entry stand its own, `key`, and what follows from them. Of a body: its
    `kind` (None where it is none or several), its material as a table where that is sound, and
    where a named one stands (`material_key`), the points at which it can be `held` (None where
    they have faults), from a leg's first point to its second the `way` (3, m) and its `length`
    (m). Of bodies and joints: the unit of `lengths` in messages. Of a joint: the `points` of its
    bodies, whether one is named twice (`one_twice`), which key its kind `wanted`, the `directions`
    there, and the `way` between points that are apart. Of the path: the tool's `moves`.
    """

    points: Mapping[str, Array]
    bodies: Mapping[str, Entry]
    joints: Mapping[str, Entry]
    tool: Entry | None
    path: Entry | None
    names: Mapping[str, tuple[str, ...]]
    unit: UnitOfLength


def draft(tables: Mapping[str, Any]) -> Draft:
    """What is sound in the tables of a robot file of schema 2."""
    names = {key: tuple(_group(tables, key)) for key in MECHANISM.keys}
    unit = length_unit_of(tables)
    places, materials, bodies, joints, tool, path = (
        _sound(tables, key) for key in ("points", "materials", "bodies", "joints", "tool", "path")
    )
    points = {name: np.array(place) for name, place in places.items()}
    return Draft(
        points=points,
        bodies={
            name: one
            | {"lengths": unit}
            | _of_material(one["material"], materials, f"bodies.{name}")
            | _of_points(one, points, names["points"])
            for name, one in bodies.items()
        },
        joints={
            name: one | {"lengths": unit} | _of_joint(one, points, name)
            for name, one in joints.items()
        },
        tool=tool or None,
        path=path | {"moves": tool["moves"]} if path and tool else None,
        names=names,
        unit=unit,
    )


def _group(tables: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    group = tables.get(key)
    return group if isinstance(group, dict) else {}


def _sound(tables: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The sound entries of a table of named ones; of [tool] and [path] all or nothing."""
    group, rule = _group(tables, key), rules_of(tables).keys[key].kind
    if isinstance(rule, Named):
        kind = rule.kind
        if len(group) > rule.most:
            return {}
        return {name: kind.read(one) for name, one in group.items() if not kind.faults(one, name)}
    return {} if rule.faults(tables.get(key), key) else rule.read(group)


def _of_material(material: Any, materials: Mapping[str, Entry], key: str) -> dict[str, Any]:
    if isinstance(material, str):
        found = materials.get(material, material)
        return {"key": key, "material": found, "material_key": f"materials.{material}"}
    return {"key": key}


def _of_points(body: Entry, points: Mapping[str, Array], names: tuple[str, ...]) -> dict[str, Any]:
    kinds = {kind for key, kind in _TELLING.items() if body[key] is not None}
    kind = kinds.pop() if len(kinds) == 1 else None
    ends = (body["from"], body["to"])
    held = {"leg": ends, "rigid body": body["points"], "part": tuple(body["interfaces"] or ())}
    found = held.get(kind or "") or ()
    known = found and set(found) <= set(names) and (kind != "leg" or ends[0] != ends[1])
    way = _way(ends, points)
    length = None if way is None else float(np.linalg.norm(way))
    return {"kind": kind, "held": found if known else None, "way": way, "length": length}


def _of_joint(joint: Entry, points: Mapping[str, Array], name: str) -> dict[str, Any]:
    at = joint["at"]
    wanted = ("", "axis", "axes")[AXES[joint["type"]]]
    given = joint[wanted] if wanted else None
    pair = (at, at) if isinstance(at, str) else at
    way = _way(pair, points)
    return {
        "key": f"joints.{name}",
        "points": pair,
        "one_twice": pair == at and at[0] == at[1],
        "wanted": wanted,
        "directions": () if given is None else given if wanted == "axes" else (given,),
        "way": way if way is not None and np.linalg.norm(way) > NO_DIRECTION else None,
    }


def _way(ends: tuple[str, str], points: Mapping[str, Array]) -> Array | None:
    first, second = map(points.get, ends)
    return None if first is None or second is None else second - first
