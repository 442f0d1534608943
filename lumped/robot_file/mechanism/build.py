"""From the tables of a robot file of schema 2 to the mechanism they describe."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from lumped.mechanism.body import Body, Frame, Rigid, leg_shape
from lumped.mechanism.joint import Drive, Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.part import Part
from lumped.mechanism.placing import leg_on, rigid_on
from lumped.robot_file.leg_table import leg_of, symmetric
from lumped.robot_file.mechanism.body_faults import body_faults, kind_of, leg_length, material_of
from lumped.robot_file.mechanism.draft import Draft, draft
from lumped.robot_file.mechanism.joint_faults import (
    joint_faults,
    points_of,
    tool_faults,
    way_between,
)
from lumped.robot_file.mechanism.part_tables import interface_of
from lumped.robot_file.mechanism.tables import (
    BodyTable,
    JointTable,
    MechanismTables,
    PathTable,
)
from lumped.robot_file.mechanism.whole_faults import connection_faults, path_faults
from lumped.robot_file.table_faults import table_faults
from lumped.robot_file.tables import LegTable


def description_faults(tables: Mapping[str, Any]) -> list[str]:
    """Every fault of a robot file's tables that shows without closing a loop."""
    given = draft(tables)
    faults = table_faults(MechanismTables, tables)
    faults += body_faults(given) + joint_faults(given) + tool_faults(given) + path_faults(given)
    # Who is connected to whom is known once every joint says what it joins.
    return faults or connection_faults(given)


def mechanism_of(tables: Mapping[str, Any], folder: Path | None = None) -> Mechanism:
    """The mechanism that tables without faults describe; files of parts lie in `folder`."""
    given = draft(tables)
    tool = given.tool
    if tool is None:
        raise InputError("a mechanism must have a tool")
    joints = tuple(_joint(given, name) for name in given.joints)
    sides = [side for joint in joints for side in (joint.first, joint.second)]
    base = dict.fromkeys(side.point for side in sides if side.body == GROUND)
    placed = [
        rigid_on(GROUND, base, given.points, origin=np.zeros(3)),
        *(_body(given, name, folder or Path()) for name in given.bodies),
    ]
    mechanism = Mechanism(
        name=str(tables["name"]),
        bodies={body.name: body for body, _ in placed},
        joints=joints,
        tool=Tool(tool.body, tool.point, tuple(tool.moves), tool.mass),
        reference={body.name: frame for body, frame in placed},
        poses=np.zeros((0, len(tool.moves))),
    )
    poses = mechanism.reference_pose[None] if given.path is None else _poses(given.path)
    return replace(mechanism, poses=poses)


def _body(given: Draft, name: str, folder: Path) -> tuple[Body, Frame]:
    table = given.bodies[name]
    if kind_of(table) == "part":
        return _part(given, name, table, folder)
    if kind_of(table) == "rigid body":
        return _rigid(given, name, table)
    start, to, length = table.start, table.to, leg_length(given, table)
    if start is None or to is None or length is None:
        raise InputError(f"bodies.{name}: a leg must have two points")
    leg = leg_of(
        LegTable(
            length=length,
            mass=table.mass,
            compliance=table.compliance,
            section=table.section,
            material=material_of(given, table),
            ends=table.ends,
            mass_centre=table.mass_centre,
            inertia=table.inertia,
        ),
        name,
    )
    up = None if table.up is None else np.array(table.up, dtype=float)
    return leg_on(name, leg_shape(leg), (start, to), given.points, up)


def _part(given: Draft, name: str, table: BodyTable, folder: Path) -> tuple[Body, Frame]:
    data = material_of(given, table)
    if data is None or data.rho is None:
        raise InputError(f"bodies.{name}: a part must have a material with a density")
    place, frame = table.place, Frame()
    if place is not None:
        at = given.points[place.at] if isinstance(place.at, str) else np.array(place.at, float)
        x, y = (np.array(axis, dtype=float) for axis in (place.x, place.y))
        x = x / np.linalg.norm(x)
        z = np.cross(x, y) / np.linalg.norm(np.cross(x, y))
        frame = Frame(at, np.column_stack([x, np.cross(z, x), z]))
    wanted = table.interfaces or {}
    shape = Part(
        file=folder / (table.step or table.mesh or ""),
        material=Material.isotropic(data.E, data.nu, data.rho),
        interfaces={point: interface_of(interface) for point, interface in wanted.items()},
        unit=table.unit,
    )
    seen = frame.inverse()
    held = {point: Frame((seen @ Frame(given.points[point])).position) for point in wanted}
    return Body(name, shape, held), frame


def _rigid(given: Draft, name: str, table: BodyTable) -> tuple[Body, Frame]:
    points = table.points or []
    origin = given.points[points[0]]
    centre = origin
    if table.centre is not None:
        place = table.centre
        centre = given.points[place] if isinstance(place, str) else np.array(place, dtype=float)
    inertia = np.zeros((3, 3)) if table.inertia is None else symmetric(table.inertia)
    shape = Rigid(table.mass or 0.0, centre - origin, inertia)
    return rigid_on(name, points, given.points, shape)


def _joint(given: Draft, name: str) -> Joint:
    table = given.joints[name]
    first, second = map(Side, table.between, points_of(table))
    way = way_between(given, table)
    axes = np.array(table.axes or [axis for axis in (table.axis,) if axis], dtype=float)
    if way is not None:
        # What six digits of a direction would leave open.
        axes = way[None]
    axes = axes.reshape(-1, 3)
    return Joint(
        name,
        table.type,
        first,
        second,
        axes / np.linalg.norm(axes, axis=1)[:, None],
        _drive(table),
        None if table.compliance is None else symmetric(table.compliance),
    )


def _drive(table: JointTable) -> Drive | None:
    if table.drive is None:
        return None
    stiffness = table.drive.stiffness
    return Drive(None if isinstance(stiffness, str) else stiffness, table.drive.simplified)


def _poses(path: PathTable) -> Array:
    if path.poses is not None:
        return np.array(path.poses, dtype=float).reshape(len(path.poses), -1)
    start, to = path.start or [], path.to or []
    if path.counts is None:
        return np.linspace(start, to, path.count or 1)
    steps = zip(start, to, path.counts, strict=True)
    return np.array(list(product(*(np.linspace(a, b, count) for a, b, count in steps))))
