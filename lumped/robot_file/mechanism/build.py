"""From sound tables of a robot file to what they describe: legs, of either schema, mechanisms.

A table is as it is read: a value for every key, None where left out.
"""

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material
from lumped.mechanism.body import (
    Body,
    ByCylinder,
    ByFaces,
    ByName,
    ByPlane,
    Frame,
    Part,
    PartInterface,
    Rigid,
    Selection,
)
from lumped.mechanism.joint import Drive, Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import axes_along, place_leg, place_rigid_body
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.rules.relations import Entry


def mechanism_of(given: Draft, name: str, folder: Path) -> Mechanism:
    """The mechanism of a draft without faults; files of parts lie in `folder`."""
    tool: Entry = given.tool or {}
    joints = tuple(_joint(given, name) for name in given.joints)
    sides = [side for joint in joints for side in (joint.first, joint.second)]
    base = dict.fromkeys(side.point for side in sides if side.body == GROUND)
    placed = [
        place_rigid_body(GROUND, base, given.points, origin=np.zeros(3)),
        *(_body(given, name, folder) for name in given.bodies),
    ]
    mechanism = Mechanism(
        name=name,
        bodies={body.name: body for body, _ in placed},
        joints=joints,
        tool=Tool(**tool),
        reference={body.name: frame for body, frame in placed},
        poses=np.zeros((0, len(tool["moves"]))),
        lengths=given.unit,
    )
    if given.path is None:
        return replace(mechanism, poses=mechanism.reference_pose[None])
    return replace(mechanism, poses=_poses(given.path), grid=_grid(given.path))


def _body(given: Draft, name: str, folder: Path) -> tuple[Body, Frame]:
    table = given.bodies[name]
    if table["kind"] == "part":
        return _part(given, name, table, folder)
    if table["kind"] == "rigid body":
        return _rigid(given, name, table)
    up = None if table["up"] is None else np.array(table["up"])
    body, frame = place_leg(name, leg_of(table, name), table["held"], given.points, up)
    return replace(body, loss=loss_of(table)), frame


def _place(given: Draft, place: Any) -> Array:
    """A point (3, m) by its name or its coordinates."""
    return given.points[place] if isinstance(place, str) else np.array(place)


def _part(given: Draft, name: str, table: Entry, folder: Path) -> tuple[Body, Frame]:
    place, frame = table["place"], Frame()
    if place is not None:
        frame = Frame(_place(given, place["at"]), axes_along(place["x"], place["y"]))
    shape = Part(
        file=folder / (table["step"] or table["mesh"]),
        material=isotropic_of(table["material"]),
        interfaces={point: interface_of(one) for point, one in table["interfaces"].items()},
        unit=table["unit"],
    )
    seen = frame.inverse()
    held = {
        point: Frame((seen @ Frame(given.points[point])).position) for point in shape.interfaces
    }
    return Body(name, shape, held, loss_of(table)), frame


def _rigid(given: Draft, name: str, table: Entry) -> tuple[Body, Frame]:
    origin = given.points[table["points"][0]]
    centre = origin if table["centre"] is None else _place(given, table["centre"])
    inertia = np.zeros((3, 3)) if table["inertia"] is None else table["inertia"]
    shape = Rigid(table["mass"] or 0.0, centre - origin, inertia)
    return place_rigid_body(name, table["points"], given.points, shape)


def _joint(given: Draft, name: str) -> Joint:
    table = given.joints[name]
    first, second = map(Side, table["between"], table["points"])
    # Two points also say what six digits of a direction would leave open.
    along = table["directions"] if table["way"] is None else table["way"]
    axes = np.reshape(along, (-1, 3))
    drive = table["drive"]
    if drive is not None:
        stiffness = None if drive["stiffness"] == "rigid" else drive["stiffness"]
        inertia = (drive["inertia"] or 0.0) * (drive["ratio"] or 1.0) ** 2
        drive = Drive(stiffness, drive["simplified"], drive["loss"], inertia)
    unit = axes / np.linalg.norm(axes, axis=1)[:, None]
    give = table["compliance"], table["loss"]
    return Joint(name, table["type"], first, second, unit, drive, *give)


def _poses(path: Entry) -> Array:
    if path["poses"] is not None:
        return np.array(path["poses"], dtype=float).reshape(len(path["poses"]), -1)
    if path["counts"] is None:
        return np.linspace(path["from"], path["to"], path["count"])
    return np.array(list(product(*_grid(path))))


def _grid(path: Entry) -> tuple[Array, ...]:
    """Values along each move; none where poses are no grid."""
    if path["counts"] is None:
        return ()
    steps = zip(path["from"], path["to"], path["counts"], strict=True)
    return tuple(np.linspace(*one) for one in steps)


def leg_of(table: Entry, name: str) -> Leg:
    """The leg of a table."""
    length, section, given, mass = (table[key] for key in ("length", "section", "material", "mass"))
    if table["compliance"] is not None:
        about = table["inertia"], table["mass_centre"]
        return GivenLeg(length, mass, table["compliance"], *about, name)
    density = given["rho"] if mass is None else mass / (section.area * length)
    material = isotropic_of(given | {"rho": density})
    if given["G"] is not None:
        material = replace(material, G=given["G"])
    return ConstantLeg(length, section, material, table["ends"], name)


def loss_of(table: Entry) -> float:
    """The loss factor of a leg or a part: its material's, or its own beside a compliance."""
    own = table["loss"] if table["material"] is None else table["material"]["loss"]
    return own or 0.0


def isotropic_of(material: Entry) -> Material:
    """The isotropic material of a table."""
    return Material.isotropic(material["E"], material["nu"], material["rho"])


def interface_of(table: Entry) -> PartInterface:
    """The interface of a part that a table describes."""
    selection: Selection
    if table["faces"] is not None:
        selection = ByFaces(table["faces"])
    elif table["name"] is not None:
        selection = ByName(table["name"])
    elif table["cylinder"] is not None:
        selection = ByCylinder(**table["cylinder"])
    else:
        selection = ByPlane(**table["plane"])
    return PartInterface(selection, table["coupling"])
