"""Surfaces of the bodies and symbols of the joints of a mechanism, for pictures.

Input: a posture. Output: surfaces in base axes (m). Rule: prisms have their sections, legs
specified by a 6×6 have those of their equivalent prisms, CAD parts have their own surfaces.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from math import ceil
from typing import Literal, TypeAlias, assert_never

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg
from lumped.mechanism.body import Body, Part
from lumped.mechanism.free_twists import across_axis, interface_position, rotation_since_reference
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import (
    Circle,
    HollowRectangle,
    ISection,
    OutlinedSection,
    Section,
    Tube,
)
from meshes.stepped import stretched
from validation.drawing.scene import DARK
from validation.drawing.style import ORANGE
from validation.drawing.surfaces import (
    Surface,
    ball,
    circle,
    faceted,
    joined,
    plate,
    prism,
    rectangle,
    walled,
)
from validation.models.reduced_parts import found_in

Matter: TypeAlias = Literal["leg", "rigid", "joint", "drive"]
COLOURS: dict[Matter, str] = {
    "leg": "#9db8cc",
    "rigid": "#d9c9a3",
    "joint": DARK,
    "drive": ORANGE,
}
# Number of cross-sections drawn along a leg.
STATIONS = 15
# Number of divisions drawn along a leg's centre line, which may be curved.
_LINE_STATIONS = 40
# Thickness of the bars of a rigid body, relative to the size of the mechanism.
_BAR_THICKNESS = 0.012
# Radius of a joint's symbol, relative to the size of the mechanism.
SYMBOL = 0.035
# Length of a drum relative to the thickness of the legs that it joins. Above 1, so that its ends
# are visible.
_DRUM_OVER_LEG = 1.12


@dataclass(frozen=True, eq=False)
class Solid:
    """Surface of a body or symbol of a joint, in base axes.

    It moves rigidly with the interface `carrier`, which is None for a leg or CAD part that deforms.
    `matter`: kind of body or joint, which sets the colour.
    """

    name: str
    surface: Surface
    matter: Matter
    carrier: Side | None = None


def solids(posture: Posture) -> list[Solid]:
    """Surfaces of all bodies, then symbols of all joints, in a posture."""
    mechanism = posture.mechanism
    bodies = (_body(posture, name) for name in mechanism.bodies if name != GROUND)
    symbols = (_symbol(posture, joint) for joint in mechanism.joints)
    return [solid for solid in (*bodies, *symbols) if solid]


def section_prism(
    section: Section, stations: Array, *, scale: float = 1.0, rims: bool = False
) -> Surface:
    """Prism of a section enlarged by `scale`, divided at `stations` (m) along x.

    `rims` selects the drawn edges as in `prism`.
    """
    if isinstance(section, OutlinedSection):
        return walled([scale * loop for loop in section.centred_loops], stations, rims=rims)
    outline, bore = outlines(section)
    return prism(scale * outline, stations, None if bore is None else scale * bore, rims=rims)


def line_surface(leg: LineLeg, *, scale: float = 1.0, rims: bool = False) -> Surface:
    """Surface of a leg whose section varies along a line, in leg axes.

    Sections are enlarged by `scale`. `rims` selects the drawn edges as in `prism`.
    """
    surfaces = []
    for span in leg.spans:
        length = span.end - span.start
        share = length / leg.line.length
        stations = np.linspace(0.0, length, max(2, ceil(share * _LINE_STATIONS) + 1))
        straight = section_prism(span.first, stations, rims=rims)
        shares = np.clip(straight.points[:, 0] / length, 0.0, 1.0)
        points = np.empty_like(straight.points)
        for value in np.unique(shares):
            at_share = shares == value
            points[at_share, 1:] = scale * stretched(
                straight.points[at_share, 1:], span.first, span.section(float(value))
            )
        piece = leg.line.piece_at(np.array([0.5 * (span.start + span.end)]))
        centres, axes = leg.line.frames(span.start + shares * length, np.repeat(piece, len(shares)))
        points = centres + np.einsum("nij,nj->ni", axes[:, :, 1:], points[:, 1:])
        surfaces.append(replace(straight, points=points))
    return joined(surfaces)


def outlines(section: Section) -> tuple[Array, Array | None]:
    """Outline (n×2; y, z in m) of a section, and outline of its bore.

    The second is None if there is no bore.
    """
    if isinstance(section, Circle | Tube):
        bore = circle(section.inner_diameter / 2.0) if isinstance(section, Tube) else None
        return circle(section.diameter / 2.0), bore
    if isinstance(section, ISection):
        return section.outline, None
    bore = rectangle(*section.inner.extent) if isinstance(section, HollowRectangle) else None
    return rectangle(*section.extent), bore


def on_ground(joint: Joint) -> bool:
    """True if the first body of a joint is ground."""
    return joint.first.body == GROUND


def symbol_side(joint: Joint) -> Side:
    """Side of a joint that carries its symbol: the first, or the second if the first is ground."""
    return joint.second if on_ground(joint) else joint.first


def tool_position(posture: Posture) -> Array:
    """Position of the loaded point (3, m, base axes)."""
    tool = posture.mechanism.tool
    return interface_position(posture, Side(tool.body, tool.point))


def in_one_plane(posture: Posture) -> bool:
    """True if all interfaces lie in one plane z = constant."""
    heights = [
        (posture.frames[name] @ interface).position[2]
        for name, body in posture.mechanism.bodies.items()
        for interface in body.interfaces.values()
    ]
    return bool(np.ptp(heights) <= 1e-6 * posture.mechanism.size)


def is_leg(body: Body) -> bool:
    """True if a body is a leg, or a CAD part with two interfaces."""
    return (
        isinstance(body.shape, ConstantLeg | GivenLeg | LineLeg | Part)
        and len(body.interfaces) == 2
    )


def _body(posture: Posture, name: str) -> Solid | None:
    """Prism of a leg, surface of a CAD part, or plate or bars between the points of a rigid body.

    A part whose file cannot be read is drawn as a rigid body. None for a body with one point.
    """
    body, frame = posture.mechanism.bodies[name], posture.frames[name]
    # An unreadable file is reported by the models.
    with suppress(InputError):
        if isinstance(body.shape, LineLeg):
            surface = line_surface(body.shape)
            return Solid(name, surface.placed(frame.position, frame.rotation), "leg")
        if isinstance(body.shape, ConstantLeg | GivenLeg):
            stations = np.linspace(0.0, body.shape.length, STATIONS)
            surface = section_prism(equivalent_leg(body.shape).section, stations)
            return Solid(name, surface.placed(frame.position, frame.rotation), "leg")
        if isinstance(body.shape, Part):
            file, _ = found_in(body)
            surface = faceted(file.surface, [face.facets.corners for face in file.faces])
            return Solid(name, surface.placed(frame.position, frame.rotation), "leg")
    points = np.array([(frame @ interface).position for interface in body.interfaces.values()])
    pieces = list(_plate_or_bars(points, _BAR_THICKNESS * posture.mechanism.size))
    if not pieces:
        return None
    return Solid(name, joined(pieces), "rigid", Side(name, next(iter(body.interfaces))))


def _plate_or_bars(points: Array, thickness: float) -> Iterator[Surface]:
    """Bars from the mean of the points (n×3, m) to each, and a plate if they span an area."""
    middle = points.mean(axis=0)
    _, extents, axes = np.linalg.svd(points - middle, full_matrices=False)
    if len(points) > 2 and extents[1] > 0.1 * extents[0]:
        in_plane = (points - middle) @ axes[:2].T
        order = np.argsort(np.arctan2(in_plane[:, 1], in_plane[:, 0]))
        on_rim = np.linalg.norm(in_plane[order], axis=1) > 1e-6 * extents[0]
        yield plate(points[order][on_rim])
    for point in points:
        if np.linalg.norm(point - middle) > 0.0:
            yield _bar(middle, point, rectangle(thickness, thickness))


def _symbol(posture: Posture, joint: Joint) -> Solid | None:
    """Symbol of a joint: drum, sleeve, ball, cross or plate. None for a fixed joint."""
    if joint.kind == "fixed":
        return None
    side = symbol_side(joint)
    centre, radius = interface_position(posture, side), SYMBOL * posture.mechanism.size
    matter: Matter = "drive" if joint.drive else "joint"
    axes = joint.axes @ rotation_since_reference(posture, joint.first.body).T
    thickness = _leg_thickness(posture.mechanism, joint)

    def along(axis: Array, outline: Array, length: float) -> Surface:
        return _bar(centre - 0.5 * length * axis, centre + 0.5 * length * axis, outline)

    match joint.kind:
        case "spherical":
            surface = ball(max(radius, 0.6 * thickness)).placed(centre, np.eye(3))
        case "universal":
            second = rotation_since_reference(posture, joint.second.body) @ joint.axes[1]
            drums = (along(axis, circle(0.45 * radius), 1.5 * radius) for axis in (axes[0], second))
            surface = joined(list(drums))
        case "revolute":
            length = max(1.2 * radius, _DRUM_OVER_LEG * thickness)
            surface = along(axes[0], circle(radius), length)
        case "cylindrical":
            surface = along(axes[0], circle(0.8 * radius), 2.0 * radius)
        case "prismatic":
            width = max(2.4 * radius, _DRUM_OVER_LEG * thickness)
            surface = along(axes[0], rectangle(width, width), width)
        case "planar":
            surface = along(axes[0], rectangle(4.0 * radius, 4.0 * radius), 0.3 * radius)
        case _:
            assert_never(joint.kind)
    return Solid(joint.name, surface, matter, side)


def _bar(start: Array, end: Array, outline: Array) -> Surface:
    """Prism of an outline from one point to another (3, m)."""
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length
    rotation = np.column_stack([axis, *across_axis(axis)])
    return prism(outline, np.array([0.0, length])).placed(start, rotation)


def _leg_thickness(mechanism: Mechanism, joint: Joint) -> float:
    """Largest section dimension (m) of the legs that meet in a joint. 0 without legs."""
    legs = legs_of(mechanism)
    names = [side.body for side in (joint.first, joint.second) if side.body in legs]
    return max((_thickness(legs[name]) for name in names), default=0.0)


def _thickness(leg: Leg) -> float:
    """Largest extent (m) of the sections of a leg."""
    if isinstance(leg, LineLeg):
        return leg.largest_extent
    return max(equivalent_leg(leg).section.extent)
