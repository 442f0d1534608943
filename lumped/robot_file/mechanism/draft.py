"""Draft of a mechanism: entries of its description without faults, with derived values.

Each entry is read separately, so that a fault in one entry does not hide those of others.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import AXES
from lumped.mechanism.length_unit import UnitOfLength
from lumped.robot_file.mechanism.line import leg_line
from lumped.robot_file.rules.relations import NO_DIRECTION, Entry
from lumped.robot_file.rules.rule import Named
from lumped.robot_file.rules.several_materials import CompositeTable, LaminateTable
from lumped.robot_file.rules.tables import MECHANISM, length_unit_of, rules_of

_KIND_OF_KEY = {"from": "leg", "to": "leg", "points": "rigid body", "step": "part", "mesh": "part"}


@dataclass(frozen=True, eq=False)
class Draft:
    """Entries of a robot file without faults, by name.

    `names` contains the names of all entries, also of those with faults.

    An entry contains its keys, the location `key` for messages, and derived values:

    - bodies: `kind` ("leg", "rigid body" or "part"; None if the keys fit none or several), the
      material as a table, the key of a named material (`material_key`), `interface_points` (None if
      they have faults). For legs also the `vector` (3, in m) from first to second point and its
      `length` (m);
    - bodies and joints: `lengths`, the unit of length in messages;
    - joints: `points` on both bodies, `repeated_point` (True if two equal names are given),
      `axis_key` (the key for axes required by the kind of joint), the `directions` under that key,
      and the `vector` between points that are apart;
    - path: the `moves` of the tool.
    """

    points: Mapping[str, Array]
    bodies: Mapping[str, Entry]
    joints: Mapping[str, Entry]
    tool: Entry | None
    path: Entry | None
    names: Mapping[str, tuple[str, ...]]
    unit: UnitOfLength


def draft(tables: Mapping[str, Any]) -> Draft:
    """Draft of a mechanism from the tables of a robot file of schema 2."""
    names = {key: tuple(_group(tables, key)) for key in MECHANISM.keys}
    unit = length_unit_of(tables)
    coordinates, materials, bodies, joints, tool, path = (
        _valid_entries(tables, key)
        for key in ("points", "materials", "bodies", "joints", "tool", "path")
    )
    points = {name: np.array(position) for name, position in coordinates.items()}
    return Draft(
        points=points,
        bodies={
            name: entry
            | {"lengths": unit}
            | _material_values(entry["material"], materials, f"bodies.{name}")
            | _section_values(entry["section"], materials)
            | _body_values(entry, points, names["points"])
            | {"line": leg_line(entry, points, f"bodies.{name}", unit)}
            for name, entry in bodies.items()
        },
        joints={
            name: entry | {"lengths": unit} | _joint_values(entry, points, name)
            for name, entry in joints.items()
        },
        tool=tool or None,
        path=path | {"moves": tool["moves"]} if path and tool else None,
        names=names,
        unit=unit,
    )


def _group(tables: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    group = tables.get(key)
    return group if isinstance(group, dict) else {}


def _valid_entries(tables: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Those entries of a table of named entries that have no faults.

    The tables [tool] and [path] count as one.
    """
    group, rule = _group(tables, key), rules_of(tables).keys[key].kind
    if isinstance(rule, Named):
        kind = rule.kind
        if len(group) > rule.most:
            return {}
        return {
            name: kind.read(entry) for name, entry in group.items() if not kind.faults(entry, name)
        }
    return {} if rule.faults(tables.get(key), key) else rule.read(group)


def _material_values(material: Any, materials: Mapping[str, Entry], key: str) -> dict[str, Any]:
    if isinstance(material, str):
        table = materials.get(material, material)
        return {"key": key, "material": table, "material_key": f"materials.{material}"}
    return {"key": key}


def _section_values(section: Any, materials: Mapping[str, Entry]) -> dict[str, Any]:
    return (
        {"section": section.resolved(materials)}
        if isinstance(section, CompositeTable | LaminateTable)
        else {}
    )


def _body_values(
    body: Entry, points: Mapping[str, Array], names: tuple[str, ...]
) -> dict[str, Any]:
    kinds = {kind for key, kind in _KIND_OF_KEY.items() if body[key] is not None}
    kind = kinds.pop() if len(kinds) == 1 else None
    ends = (body["from"], body["to"])
    points_by_kind = {
        "leg": ends,
        "rigid body": body["points"],
        "part": tuple(body["interfaces"] or ()),
    }
    interface_points = points_by_kind.get(kind or "") or ()
    valid = (
        interface_points
        and set(interface_points) <= set(names)
        and (kind != "leg" or ends[0] != ends[1])
    )
    vector = _vector_between(ends, points)
    length = None if vector is None else float(np.linalg.norm(vector))
    return {
        "kind": kind,
        "interface_points": interface_points if valid else None,
        "vector": vector,
        "length": length,
    }


def _joint_values(joint: Entry, points: Mapping[str, Array], name: str) -> dict[str, Any]:
    point_names = joint["at"]
    axis_key = ("", "axis", "axes")[AXES[joint["type"]]]
    directions = joint[axis_key] if axis_key else None
    pair = (point_names, point_names) if isinstance(point_names, str) else point_names
    vector = _vector_between(pair, points)
    return {
        "key": f"joints.{name}",
        "points": pair,
        "repeated_point": pair == point_names and point_names[0] == point_names[1],
        "axis_key": axis_key,
        "directions": ()
        if directions is None
        else directions
        if axis_key == "axes"
        else (directions,),
        "vector": vector if vector is not None and np.linalg.norm(vector) > NO_DIRECTION else None,
    }


def _vector_between(ends: tuple[str, str], points: Mapping[str, Array]) -> Array | None:
    first, second = map(points.get, ends)
    return None if first is None or second is None else second - first
