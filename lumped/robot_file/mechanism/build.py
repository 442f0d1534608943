"""Legs (schema 1 and 2) and mechanisms (schema 2) from tables without faults.

A table has a value for every key. The value is None if the key is omitted.
"""

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg, Material
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
from lumped.mechanism.catalogue.ball_contact import (
    BallBearing,
    bearing_compliance,
    bearing_of_size,
    bearing_stiffness,
)
from lumped.mechanism.catalogue.ball_guide import BallGuide, guide_compliance
from lumped.mechanism.catalogue.ball_nut import PRELOADED, WITH_PLAY, BallNut
from lumped.mechanism.catalogue.directions import joint_axes, joint_matrix
from lumped.mechanism.joint import BallScrew, Drive, Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import axes_along, place_leg, place_rigid_body
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.rules.relations import Entry
from lumped.robot_file.rules.several_materials import CompositeTable, LaminateTable
from lumped.screws import turn_matrix


def mechanism_of(description: Draft, name: str, folder: Path) -> Mechanism:
    """Mechanism of a draft without faults. Paths of files are relative to `folder`."""
    tool: Entry = description.tool or {}
    joints = tuple(_joint(description, name) for name in description.joints)
    sides = [side for joint in joints for side in (joint.first, joint.second)]
    base = dict.fromkeys(side.point for side in sides if side.body == GROUND)
    placed = [
        place_rigid_body(GROUND, base, description.points, origin=np.zeros(3)),
        *(_body(description, name, folder) for name in description.bodies),
    ]
    mechanism = Mechanism(
        name=name,
        bodies={body.name: body for body, _ in placed},
        joints=joints,
        tool=Tool(**tool),
        reference={body.name: frame for body, frame in placed},
        poses=np.zeros((0, len(tool["moves"]))),
        lengths=description.unit,
    )
    if description.path is None:
        return replace(mechanism, poses=mechanism.reference_pose[None])
    return replace(mechanism, poses=_poses(description.path), grid=_grid(description.path))


def _body(description: Draft, name: str, folder: Path) -> tuple[Body, Frame]:
    table = description.bodies[name]
    if table["kind"] == "part":
        return _part(description, name, table, folder)
    if table["kind"] == "rigid body":
        return _rigid(description, name, table)
    up = None if table["up"] is None else np.array(table["up"])
    body, frame = place_leg(
        name, leg_of(table, name), table["interface_points"], description.points, up
    )
    return replace(body, loss=loss_of(table)), frame


def _point(description: Draft, place: Any) -> Array:
    """Position (3, in m) of a point given by its name or its coordinates."""
    return description.points[place] if isinstance(place, str) else np.array(place)


def _part(description: Draft, name: str, table: Entry, folder: Path) -> tuple[Body, Frame]:
    placement, frame = table["place"], Frame()
    if placement is not None:
        frame = Frame(
            _point(description, placement["at"]), axes_along(placement["x"], placement["y"])
        )
    shape = Part(
        file=folder / (table["step"] or table["mesh"]),
        material=isotropic_of(table["material"]),
        interfaces={point: interface_of(entry) for point, entry in table["interfaces"].items()},
        unit=table["unit"],
    )
    file_frame = frame.inverse()
    interfaces = {
        point: Frame((file_frame @ Frame(description.points[point])).position)
        for point in shape.interfaces
    }
    return Body(name, shape, interfaces, loss_of(table)), frame


def _rigid(description: Draft, name: str, table: Entry) -> tuple[Body, Frame]:
    origin = description.points[table["points"][0]]
    centre = origin if table["centre"] is None else _point(description, table["centre"])
    inertia = np.zeros((3, 3)) if table["inertia"] is None else table["inertia"]
    shape = Rigid(table["mass"] or 0.0, centre - origin, inertia)
    return place_rigid_body(name, table["points"], description.points, shape)


def _joint(description: Draft, name: str) -> Joint:
    table = description.joints[name]
    first, second = map(Side, table["between"], table["points"])
    # The direction between two points is more accurate than one typed with six digits.
    directions = table["directions"] if table["vector"] is None else table["vector"]
    axes = np.reshape(directions, (-1, 3))
    drive = table["drive"]
    if drive is not None:
        screw = None if drive["screw"] is None else _screw(drive["screw"])
        stiffness = None if drive["stiffness"] == "rigid" else drive["stiffness"]
        stiffness = stiffness if screw is None else float(screw.stiffness(0.0))
        inertia = (drive["inertia"] or 0.0) * (drive["ratio"] or 1.0) ** 2
        drive = Drive(
            stiffness, drive["simplified"], drive["loss"], inertia, drive["damping"], screw
        )
    unit = axes / np.linalg.norm(axes, axis=1)[:, None]
    kind, up = table["type"], None if table["up"] is None else np.array(table["up"])
    own_axes = joint_axes(kind, unit, up)
    compliance, damping = table["compliance"], None
    if table["stiffness"] is not None:
        compliance = joint_matrix(kind, own_axes, _compliances(table["stiffness"]))
    if table["bearing"] is not None:
        compliance = turn_matrix(_bearing_compliance(table["bearing"]), own_axes)
    if table["guide"] is not None:
        compliance = turn_matrix(_guide_compliance(table["guide"]), own_axes)
    if table["damping"] is not None:
        damping = joint_matrix(kind, own_axes, _present(table["damping"]))
    return Joint(name, kind, first, second, unit, drive, compliance, table["loss"], damping)


def _bearing_compliance(table: Entry) -> Array:
    """Compliance (6×6, x along the shaft) of a preloaded ball bearing."""
    if table["size"] is not None:
        bearing = bearing_of_size(table["size"])
    else:
        bearing = BallBearing(
            balls=table["balls"],
            ball_diameter=table["ball_diameter"],
            pitch_diameter=table["pitch_diameter"],
            angle=float(np.radians(table["contact_angle"] or 0.0)),
            inner=table["inner_groove"] or 0.52,
            outer=table["outer_groove"] or 0.53,
        )
    return bearing_compliance(
        bearing_stiffness(
            bearing,
            table["preload"],
            table["rows"],
            table["arrangement"],
            table["distance"] or 0.0,
        )
    )


def _guide_compliance(table: Entry) -> Array:
    """Compliance (6×6, x along the rail, z normal to it) of a profile rail guide."""
    guide = BallGuide(
        balls=table["balls"],
        ball_diameter=table["ball_diameter"],
        spacing=table["spacing"],
        width=table["width"],
        height=table["height"],
        angle=float(np.radians(table["contact_angle"])),
        groove=table["groove"],
        lines=table["lines"],
    )
    return guide_compliance(guide.stiffness(table["preload"]))


def _screw(table: Entry) -> BallScrew:
    stiffnesses = table["bearing"], _nut_stiffness(table["nut"])
    bearing, nut = (0.0 if stiffness == "rigid" else 1.0 / stiffness for stiffness in stiffnesses)
    return BallScrew(
        axial=table["E"] * np.pi * table["diameter"] ** 2 / 4.0,
        length=table["length"],
        sign=1.0 if table["positive"] == "longer" else -1.0,
        span=table["span"],
        bearing=bearing,
        nut=nut,
    )


def _nut_stiffness(nut: Any) -> Any:
    """Axial stiffness (N/m) of the nut of a ball screw, or "rigid"."""
    if not isinstance(nut, dict):
        return nut
    preload, share = nut["preload"], nut["share"]
    default = WITH_PLAY if preload is None else PRELOADED
    ball_nut = BallNut(nut["rigidity"], nut["load_rating"], default if share is None else share)
    return ball_nut.stiffness(nut["load"] if preload is None else preload)


def _compliances(stiffnesses: Entry) -> dict[str, float]:
    """Compliance along each direction of a joint, from its stiffness. Zero if rigid."""
    present = _present(stiffnesses)
    return {name: 0.0 if value == "rigid" else 1.0 / value for name, value in present.items()}


def _present(table: Entry) -> Entry:
    return {name: value for name, value in table.items() if value is not None}


def _poses(path: Entry) -> Array:
    if path["poses"] is not None:
        return np.array(path["poses"], dtype=float).reshape(len(path["poses"]), -1)
    if path["counts"] is None:
        return np.linspace(path["from"], path["to"], path["count"])
    return np.array(list(product(*_grid(path))))


def _grid(path: Entry) -> tuple[Array, ...]:
    """Values along each move of the tool. Empty if the poses do not form a grid."""
    if path["counts"] is None:
        return ()
    steps = zip(path["from"], path["to"], path["counts"], strict=True)
    return tuple(np.linspace(*step) for step in steps)


def leg_of(table: Entry, name: str) -> Leg:
    """Leg described by a table of schema 1 or 2."""
    length, section, material_table, mass = (
        table[key] for key in ("length", "section", "material", "mass")
    )
    if table["compliance"] is not None:
        mass_properties = table["inertia"], table["mass_centre"]
        return GivenLeg(length, mass, table["compliance"], *mass_properties, name)
    if isinstance(section, CompositeTable | LaminateTable):
        mean = Material(*section.section.mean_material)
        return ConstantLeg(length, section.section, mean, table["ends"], name)
    density = 1.0 if material_table["rho"] is None else material_table["rho"]
    material = isotropic_of(material_table | {"rho": density})
    if material_table["G"] is not None:
        material = replace(material, G=material_table["G"])
    line = table.get("line")
    leg = (
        ConstantLeg(length, section, material, table["ends"], name)
        if line is None or line.line is None or line.stations is None
        else LineLeg(line.line, line.stations, material, table["ends"], name)
    )
    if mass is None:
        return leg
    return replace(leg, material=replace(material, rho=mass * density / leg.mass))


def loss_of(table: Entry) -> float:
    """Loss factor of a leg or part: that of its material or, for a compliance, the key `loss`."""
    loss = table["loss"] if table["material"] is None else table["material"]["loss"]
    return loss or 0.0


def isotropic_of(material: Entry) -> Material:
    """Isotropic material described by a table."""
    return Material.isotropic(material["E"], material["nu"], material["rho"])


def interface_of(table: Entry) -> PartInterface:
    """Interface of a part described by a table."""
    return PartInterface(selection_of(table), table["coupling"])


def selection_of(table: Entry) -> Selection:
    """Selection of faces of a part described by a table."""
    if table["faces"] is not None:
        return ByFaces(table["faces"])
    if table["name"] is not None:
        return ByName(table["name"])
    if table["cylinder"] is not None:
        return ByCylinder(**table["cylinder"])
    return ByPlane(**table["plane"])
