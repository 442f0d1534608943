"""Draft of a mechanism: entries of its description without faults, with derived values.

Each entry is read separately, so that a fault in one entry does not hide those of others.
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

    `key` is its location for messages, with lengths in `unit`. `length` is in m, None if it is not
    known. `section` and `material` do not refer to [materials] any more. `material` is None if it
    is left out or unknown, `material_key` is its location. `line` is the centre line, None for a
    prism.
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

    `kind` is None if the keys fit none or several kinds. `interface_points` is None if they have
    faults. `vector` (3, in m) points from the first to the second point of a leg, None for other
    bodies and unknown points.
    """

    entry: BodyEntry
    kind: BodyKind | None = None
    interface_points: tuple[str, ...] | None = None
    vector: Array | None = None


@dataclass(frozen=True, eq=False)
class JointDraft:
    """Entry of a joint with derived values.

    `key` is its location for messages, with lengths in `unit`. `points` are those of both bodies.
    `repeated_point` is True if two equal names are given. `axis_key` is the key for axes required
    by the kind of joint, `directions` are those under that key. `vector` (3, in m) points from the
    first to the second point, None if they coincide or are unknown.
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
    """Entries of a robot file that have no faults, by name; `faults`: those of all other entries.

    `names` contains the names of all entries, also of those with faults. `entry` is the whole file,
    None if it has faults.
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
    """Draft of a body. `points` are those without faults, `names` are the names of all points."""
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
