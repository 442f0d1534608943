"""Draft of a mechanism: the entries of its description that have no faults, with derived values.

An entry is one point, body, joint or material of a robot file. Each is read separately, so that a
fault in one entry does not hide faults in others.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import AXES
from lumped.mechanism.length_unit import UnitOfLength
from lumped.mechanism.mechanism import Tool
from lumped.robot_file.mechanism.line import LegLine, leg_line
from lumped.robot_file.rules.rule import NO_DIRECTION, field_of
from lumped.robot_file.rules.tables.bodies import BodyEntry, RepeatedPointEntry
from lumped.robot_file.rules.tables.joints import JointEntry
from lumped.robot_file.rules.tables.robots import (
    MECHANISM,
    BiglideLegEntry,
    MechanismEntry,
    PathEntry,
    length_unit_of,
    rules_of,
)
from lumped.robot_file.rules.tables.sections import (
    CompositeParts,
    LaminateWall,
    MaterialEntry,
    OwnMaterials,
)
from lumped.robot_file.rules.tables.values import Triple
from lumped.sections import Section

BodyKind: TypeAlias = Literal["leg", "rigid body", "part"]
_KIND_OF_KEY: Mapping[str, BodyKind] = {
    "from": "leg",
    "to": "leg",
    "points": "rigid body",
    "step": "part",
    "mesh": "part",
}


@dataclass(frozen=True, eq=False)
class LegDraft:
    """Entry of a leg of schema 1 or 2, with derived values.

    `key` is the location of the entry for messages, which give lengths in `unit`. `length` is in m.
    None if it is not known. In `section` and `material`, names of materials are replaced by the
    materials. `material` is None if it is left out or unknown. `material_key` is its location for
    messages. `line` is the centre line with its sections. None for a prism.
    """

    key: str
    entry: BodyEntry | BiglideLegEntry
    unit: UnitOfLength
    length: float | None
    section: Section | OwnMaterials | None
    material: MaterialEntry | None
    material_key: str
    line: LegLine | None = None


@dataclass(frozen=True, eq=False)
class BodyDraft(LegDraft):
    """Entry of a body with derived values.

    `kind` is None if the keys belong to no kind or to several kinds. `interface_points` are the
    names of the body's points. None if the points have faults. `vector` (3, in m) points from the
    first to the second point of a leg. None for other bodies, and if a point is unknown.
    """

    entry: BodyEntry
    kind: BodyKind | None = None
    interface_points: tuple[str, ...] | None = None
    vector: Array | None = None


@dataclass(frozen=True, eq=False)
class JointDraft:
    """Entry of a joint with derived values.

    `key` is the location of the entry for messages, which give lengths in `unit`. `points` are the
    names of the joint's point on the first and on the second body. `repeated_point` is True if the
    entry lists two equal names. `axis_key` is the key with which the kind of joint defines its
    axes. "" if it needs no axis. `directions` are the values of this key. `vector` (3, in m) points
    from the first to the second point. None if they coincide or are unknown.
    """

    key: str
    entry: JointEntry
    unit: UnitOfLength
    points: tuple[str, str]
    repeated_point: bool
    axis_key: Literal["", "axis", "axes"]
    directions: tuple[Triple, ...]
    vector: Array | None


@dataclass(frozen=True, eq=False)
class Draft:
    """Entries of a robot file of schema 2 that have no faults, by name.

    `points` are positions (3, in m, base axes). `tool` and `path` are None if they have faults or
    are left out. `names` contains, by table, the names of all entries with and without faults.
    `unit` is the unit of length of the file. `faults` are the faults of its keys, one line each.
    `entry` is the record of the whole file. None if it has faults.
    """

    points: Mapping[str, Array]
    bodies: Mapping[str, BodyDraft]
    joints: Mapping[str, JointDraft]
    tool: Tool | None
    path: PathEntry | None
    names: Mapping[str, tuple[str, ...]]
    unit: UnitOfLength
    faults: tuple[str, ...]
    entry: MechanismEntry | None


def draft(tables: Mapping[str, Any]) -> Draft:
    """Draft of a mechanism from the tables of a robot file of schema 2."""
    rules = rules_of(tables)
    faults, values = rules.checked_within(tables)
    names = {key: tuple(_group(tables, key)) for key in MECHANISM.keys}
    unit = length_unit_of(tables)
    points = {
        name: np.array(point.at if isinstance(point, RepeatedPointEntry) else point)
        for name, point in values.get("points", {}).items()
    }
    materials: Mapping[str, MaterialEntry] = values.get("materials", {})
    bodies: Mapping[str, BodyEntry] = values.get("bodies", {})
    joints: Mapping[str, JointEntry] = values.get("joints", {})
    return Draft(
        points=points,
        bodies={
            name: _body_draft(f"bodies.{name}", body, points, names["points"], materials, unit)
            for name, body in bodies.items()
        },
        joints={
            name: _joint_draft(f"joints.{name}", joint, points, unit)
            for name, joint in joints.items()
        },
        tool=values.get("tool"),
        path=values.get("path"),
        names=names,
        unit=unit,
        faults=tuple(faults),
        entry=None if faults else rules.entry(values),
    )


def _group(tables: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    group = tables.get(key)
    return group if isinstance(group, dict) else {}


def _body_draft(
    key: str,
    body: BodyEntry,
    points: Mapping[str, Array],
    names: tuple[str, ...],
    materials: Mapping[str, MaterialEntry],
    unit: UnitOfLength,
) -> BodyDraft:
    """Draft of the body at `key`.

    `points` are the positions of the points without faults, by name. `names` are the names of all
    points. `materials` are the materials without faults, by name.
    """
    material_key, section = f"{key}.material", body.section
    if isinstance(body.material, str):
        material_key = f"materials.{body.material}"
        material = materials.get(body.material)
    else:
        material = body.material
    if isinstance(section, CompositeParts | LaminateWall):
        section = section.resolved(materials)
    kinds = {
        kind for name, kind in _KIND_OF_KEY.items() if getattr(body, field_of(name)) is not None
    }
    kind = kinds.pop() if len(kinds) == 1 else None
    interface_points: tuple[str | None, ...] = ()
    match kind:
        case "leg":
            interface_points = body.from_, body.to
        case "rigid body":
            interface_points = body.points or ()
        case "part":
            interface_points = tuple(body.interfaces or ())
    known_points = tuple(point for point in interface_points if point in names)
    valid = (
        known_points
        and known_points == interface_points
        and (kind != "leg" or body.from_ != body.to)
    )
    vector = _vector_between(body.from_, body.to, points)
    return BodyDraft(
        key,
        body,
        unit,
        None if vector is None else float(np.linalg.norm(vector)),
        section,
        material,
        material_key,
        leg_line(body, points, key, unit),
        kind,
        known_points if valid else None,
        vector,
    )


def _joint_draft(
    key: str, joint: JointEntry, points: Mapping[str, Array], unit: UnitOfLength
) -> JointDraft:
    axis_keys: tuple[Literal["", "axis", "axes"], ...] = ("", "axis", "axes")
    axis_key = axis_keys[AXES[joint.type]]
    directions: tuple[Triple, ...] = ()
    if axis_key == "axis" and joint.axis is not None:
        directions = (joint.axis,)
    elif axis_key == "axes" and joint.axes is not None:
        directions = joint.axes
    pair = (joint.at, joint.at) if isinstance(joint.at, str) else joint.at
    vector = _vector_between(*pair, points)
    return JointDraft(
        key,
        joint,
        unit,
        points=pair,
        repeated_point=pair == joint.at and pair[0] == pair[1],
        axis_key=axis_key,
        directions=directions,
        vector=vector if vector is not None and np.linalg.norm(vector) > NO_DIRECTION else None,
    )


def _vector_between(
    first: str | None, second: str | None, points: Mapping[str, Array]
) -> Array | None:
    start, end = (None if name is None else points.get(name) for name in (first, second))
    return None if start is None or end is None else end - start
