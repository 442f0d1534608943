"""Legs (schema 1 and 2) and mechanisms (schema 2) from tables of robot files without faults."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg, Material
from lumped.mechanism.body import (
    Body,
    ByFaces,
    ByName,
    Frame,
    Part,
    PartInterface,
    Rigid,
    Selection,
)
from lumped.mechanism.catalogue.ball_contact import bearing_compliance, bearing_stiffness
from lumped.mechanism.catalogue.ball_guide import carriage_stiffness, guide_compliance
from lumped.mechanism.catalogue.ball_nut import (
    FIXED_BEARINGS,
    PRELOADED,
    WITH_PLAY,
    BallNut,
    nut_of_size,
    root_diameter,
)
from lumped.mechanism.catalogue.directions import joint_axes, joint_matrix
from lumped.mechanism.joint import BallScrew, Drive, Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.mechanism.placing import axes_along, place_leg, place_rigid_body
from lumped.robot_file.mechanism.draft import BodyDraft, Draft, JointDraft, LegDraft
from lumped.robot_file.mechanism.rolling import ball_bearing, ball_guide
from lumped.robot_file.rules.tables.bodies import InterfaceEntry
from lumped.robot_file.rules.tables.joints import (
    AlongDirections,
    BearingEntry,
    DriveEntry,
    GuideEntry,
    NutEntry,
    ScrewEntry,
)
from lumped.robot_file.rules.tables.requests import PressureEntry
from lumped.robot_file.rules.tables.robots import MechanismEntry, PathEntry
from lumped.robot_file.rules.tables.sections import CompositeParts, LaminateWall, MaterialEntry
from lumped.robot_file.rules.tables.values import Place, Spring, given
from lumped.screws import turn_matrix


def mechanism_of(description: Draft, entry: MechanismEntry, folder: Path) -> Mechanism:
    """Mechanism of schema 2 from its draft `description`, which has no faults.

    `entry` is the record of the whole file. Paths of files are relative to `folder`.
    """
    joints = tuple(_joint(joint, name) for name, joint in description.joints.items())
    sides = [side for joint in joints for side in (joint.first, joint.second)]
    base = dict.fromkeys(side.point for side in sides if side.body == GROUND)
    placed = [
        place_rigid_body(GROUND, base, description.points, origin=np.zeros(3)),
        *(_body(description, name, folder) for name in description.bodies),
    ]
    mechanism = Mechanism(
        name=entry.name,
        bodies={body.name: body for body, _ in placed},
        joints=joints,
        tool=entry.tool,
        reference={body.name: frame for body, frame in placed},
        poses=np.zeros((0, len(entry.tool.moves))),
        lengths=description.unit,
    )
    if entry.path is None:
        return replace(mechanism, poses=mechanism.reference_pose[None])
    grid = _grid(entry.path)
    return replace(mechanism, poses=_poses(entry.path, grid), grid=grid)


def _body(description: Draft, name: str, folder: Path) -> tuple[Body, Frame]:
    body = description.bodies[name]
    if body.kind == "part":
        return _part(description, name, body, folder)
    if body.kind == "rigid body":
        return _rigid(description, name, body)
    up = None if body.entry.up is None else np.array(body.entry.up)
    ends = given(body.entry.from_), given(body.entry.to)
    leg, frame = place_leg(name, leg_of(body, name), ends, description.points, up)
    return replace(leg, loss=loss_of(body)), frame


def _point(description: Draft, place: Place) -> Array:
    """Position (3, in m) of a point given by its name or its coordinates."""
    return description.points[place] if isinstance(place, str) else np.array(place)


def _part(description: Draft, name: str, body: BodyDraft, folder: Path) -> tuple[Body, Frame]:
    entry, placement, frame = body.entry, body.entry.place, Frame()
    if placement is not None:
        frame = Frame(_point(description, placement.at), axes_along(placement.x, placement.y))
    shape = Part(
        file=folder / given(entry.step or entry.mesh),
        material=isotropic_of(given(body.material)),
        interfaces={point: interface_of(table) for point, table in given(entry.interfaces).items()},
        unit=entry.unit,
    )
    file_frame = frame.inverse()
    interfaces = {
        point: Frame((file_frame @ Frame(description.points[point])).position)
        for point in shape.interfaces
    }
    return Body(name, shape, interfaces, loss_of(body)), frame


def _rigid(description: Draft, name: str, body: BodyDraft) -> tuple[Body, Frame]:
    entry, points = body.entry, given(body.interface_points)
    origin = description.points[points[0]]
    centre = origin if entry.centre is None else _point(description, entry.centre)
    inertia = np.zeros((3, 3)) if entry.inertia is None else entry.inertia
    shape = Rigid(entry.mass or 0.0, centre - origin, inertia)
    return place_rigid_body(name, points, description.points, shape)


def _joint(joint: JointDraft, name: str) -> Joint:
    entry = joint.entry
    first, second = map(Side, entry.between, joint.points)
    # The direction between two points is more accurate than one typed with six digits.
    directions = joint.directions if joint.vector is None else joint.vector
    axes = np.reshape(directions, (-1, 3))
    unit = axes / np.linalg.norm(axes, axis=1)[:, None]
    kind, up = entry.type, None if entry.up is None else np.array(entry.up)
    own_axes = joint_axes(kind, unit, up)
    compliance, damping = entry.compliance, None
    if entry.stiffness is not None:
        compliance = joint_matrix(kind, own_axes, _compliances(entry.stiffness))
    if entry.bearing is not None:
        compliance = turn_matrix(_bearing_compliance(entry.bearing), own_axes)
    if entry.guide is not None:
        compliance = turn_matrix(_guide_compliance(entry.guide), own_axes)
    if entry.damping is not None:
        damping = joint_matrix(kind, own_axes, entry.damping)
    drive = None if entry.drive is None else _drive(entry.drive)
    return Joint(name, kind, first, second, unit, drive, compliance, entry.loss, damping)


def _drive(entry: DriveEntry) -> Drive:
    screw = None if entry.screw is None else _screw(entry.screw)
    stiffness = None if entry.stiffness == "rigid" else entry.stiffness
    stiffness = stiffness if screw is None else float(screw.stiffness(0.0))
    inertia = (entry.inertia or 0.0) * (entry.ratio or 1.0) ** 2
    return Drive(stiffness, entry.simplified, entry.loss, inertia, entry.damping, screw)


def _bearing_compliance(entry: BearingEntry) -> Array:
    """Compliance (6×6, x along the shaft) of a preloaded ball bearing."""
    return bearing_compliance(
        bearing_stiffness(
            ball_bearing(entry), entry.preload, entry.rows, entry.arrangement, entry.distance or 0.0
        )
    )


def _guide_compliance(entry: GuideEntry) -> Array:
    """Compliance (6×6, x along the rail, z normal to it) of a profile rail guide."""
    preload = entry.preload
    if isinstance(preload, str):
        return guide_compliance(carriage_stiffness(given(entry.size), preload))
    return guide_compliance(ball_guide(entry).stiffness(preload))


def _screw(entry: ScrewEntry) -> BallScrew:
    diameter = entry.diameter
    if diameter is None and isinstance(entry.nut, NutEntry):
        diameter = root_diameter(given(entry.nut.size))
    stiffness = entry.bearing
    if isinstance(stiffness, str) and stiffness != "rigid":
        stiffness = FIXED_BEARINGS[stiffness]
    bearing, nut = (
        0.0 if isinstance(value, str) else 1.0 / value
        for value in (stiffness, _nut_stiffness(entry.nut))
    )
    return BallScrew(
        axial=entry.E * np.pi * given(diameter) ** 2 / 4.0,
        length=entry.length,
        sign=1.0 if entry.positive == "longer" else -1.0,
        span=entry.span,
        bearing=bearing,
        nut=nut,
    )


def _nut_stiffness(nut: Spring | NutEntry) -> Spring:
    """Axial stiffness (N/m) of the nut of a ball screw, or "rigid"."""
    if not isinstance(nut, NutEntry):
        return nut
    load = given(nut.load) if nut.preload is None else nut.preload
    if nut.size is not None:
        return nut_of_size(nut.size).stiffness(load)
    default = WITH_PLAY if nut.preload is None else PRELOADED
    share = default if nut.share is None else nut.share
    return BallNut(given(nut.rigidity), given(nut.load_rating), share).stiffness(load)


def _compliances(stiffnesses: AlongDirections) -> dict[str, float]:
    """Compliance along each direction of a joint, from its stiffness. Zero if rigid."""
    return {name: 0.0 if value == "rigid" else 1.0 / value for name, value in stiffnesses.items()}


def _poses(path: PathEntry, grid: tuple[Array, ...]) -> Array:
    if path.poses is not None:
        return np.array(path.poses, dtype=float).reshape(len(path.poses), -1)
    if path.counts is not None:
        return np.array(list(product(*grid)))
    return np.linspace(given(path.from_), given(path.to), given(path.count))


def _grid(path: PathEntry) -> tuple[Array, ...]:
    """Values along each move of the tool. Empty if the poses do not form a grid."""
    if path.counts is None:
        return ()
    steps = zip(given(path.from_), given(path.to), path.counts, strict=True)
    return tuple(np.linspace(*step) for step in steps)


def leg_of(leg: LegDraft, name: str) -> Leg:
    """Leg of schema 1 or 2 with the name `name`, from a draft without faults."""
    entry, section, length, mass = leg.entry, leg.section, given(leg.length), leg.entry.mass
    if entry.compliance is not None:
        mass_properties = entry.inertia, entry.mass_centre
        return GivenLeg(length, given(mass), entry.compliance, *mass_properties, name)
    if isinstance(section, CompositeParts | LaminateWall):
        mean = Material(*section.section.mean_material)
        return ConstantLeg(length, section.section, mean, entry.ends, name)
    table = given(leg.material)
    density = 1.0 if table.rho is None else table.rho
    material = isotropic_of(replace(table, rho=density))
    if table.G is not None:
        material = replace(material, G=table.G)
    line = leg.line
    if line is not None and line.line is not None and line.stations is not None:
        made: ConstantLeg | LineLeg = LineLeg(line.line, line.stations, material, entry.ends, name)
    else:
        made = ConstantLeg(length, given(section), material, entry.ends, name)
    if mass is None:
        return made
    return replace(made, material=replace(material, rho=mass * density / made.mass))


def loss_of(leg: LegDraft) -> float:
    """Loss factor of a leg or part.

    It is that of the material. Without a material it is the value of the key `loss`, or zero.
    """
    loss = leg.entry.loss if leg.material is None else leg.material.loss
    return loss or 0.0


def isotropic_of(entry: MaterialEntry) -> Material:
    """Isotropic material from a table without faults, which must have a density."""
    return Material.isotropic(entry.E, entry.nu, given(entry.rho))


def interface_of(entry: InterfaceEntry) -> PartInterface:
    """Interface of a part."""
    return PartInterface(selection_of(entry), entry.coupling)


def selection_of(entry: InterfaceEntry | PressureEntry) -> Selection:
    """Selection of the faces of a part, from the table that describes it."""
    if entry.faces is not None:
        return ByFaces(entry.faces)
    if entry.name is not None:
        return ByName(entry.name)
    return entry.cylinder or given(entry.plane)
