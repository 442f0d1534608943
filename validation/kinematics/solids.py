"""Bodies as they are, and joints as the field draws them, as surfaces in base axes.

Prisms have their true sections, legs known by a 6×6 those of their equivalents, CAD parts their
surface.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal, TypeAlias, assert_never

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg
from lumped.mechanism.body import Body, Part
from lumped.mechanism.free_twists import across_axis, interface_position, rotation_since_reference
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import Circle, HollowRectangle, ISection, Section, Tube
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
)
from validation.models.parts import found_in

Matter: TypeAlias = Literal["leg", "rigid", "joint", "drive"]
COLOURS: dict[Matter, str] = {
    "leg": "#9db8cc",
    "rigid": "#d9c9a3",
    "joint": DARK,
    "drive": ORANGE,
}
STATIONS = 15
# Of a rigid body's bars, of the size of the mechanism.
_THIN = 0.012
# Radius of a joint's symbol, of the size of the mechanism; a drum is longer than the legs that it
# joins are thick.
SYMBOL, _THROUGH = 0.035, 1.12


@dataclass(frozen=True, eq=False)
class Solid:
    """What is drawn of a body, or the symbol of a joint, in base axes.

    It goes with the interface `carrier`; a leg or part has none, and deforms.
    """

    name: str
    surface: Surface
    matter: Matter
    carrier: Side | None = None


def solids(posture: Posture) -> list[Solid]:
    """Bodies, then joints, where they are in a posture."""
    mechanism = posture.mechanism
    bodies = (_body(posture, name) for name in mechanism.bodies if name != GROUND)
    symbols = (_symbol(posture, joint) for joint in mechanism.joints)
    return [one for one in (*bodies, *symbols) if one]


def outlines(section: Section) -> tuple[Array, Array | None]:
    """Outline (n×2, y and z, m) of a section and that of its bore."""
    if isinstance(section, Circle | Tube):
        bore = circle(section.inner_diameter / 2.0) if isinstance(section, Tube) else None
        return circle(section.diameter / 2.0), bore
    if isinstance(section, ISection):
        return _i_outline(section), None
    bore = rectangle(*section.inner.extent) if isinstance(section, HollowRectangle) else None
    return rectangle(*section.extent), bore


def on_ground(joint: Joint) -> bool:
    """Whether the first body of a joint is ground."""
    return joint.first.body == GROUND


def symbol_at(joint: Joint) -> Side:
    """Where a joint is drawn: at the end of its first body, on ground where it has slid to."""
    return joint.second if on_ground(joint) else joint.first


def tool_place(posture: Posture) -> Array:
    """The loaded point (3, m)."""
    tool = posture.mechanism.tool
    return interface_position(posture, Side(tool.body, tool.point))


def in_one_plane(posture: Posture) -> bool:
    """Whether all joints lie in one plane z = constant."""
    heights = [interface_position(posture, one.first)[2] for one in posture.mechanism.joints]
    return bool(np.ptp(heights) <= 1e-6 * posture.mechanism.size)


def is_leg(body: Body) -> bool:
    """Whether a body runs from one point to another, by its data or its shape."""
    return isinstance(body.shape, ConstantLeg | GivenLeg | Part) and len(body.interfaces) == 2


def _body(posture: Posture, name: str) -> Solid | None:
    """As it is, or a plate or bars between its points: also a part whose file cannot be read."""
    body, frame = posture.mechanism.bodies[name], posture.frames[name]
    # Others complain of the file.
    with suppress(InputError):
        if isinstance(body.shape, ConstantLeg | GivenLeg):
            outline, bore = outlines(equivalent_leg(body.shape).section)
            own = prism(outline, np.linspace(0.0, body.shape.length, STATIONS), bore)
            return Solid(name, own.placed(frame.position, frame.rotation), "leg")
        if isinstance(body.shape, Part):
            file, _ = found_in(body)
            own = faceted(file.surface, [face.facets.corners for face in file.faces])
            return Solid(name, own.placed(frame.position, frame.rotation), "leg")
    points = np.array([(frame @ place).position for place in body.interfaces.values()])
    pieces = list(_plate_or_bars(points, _THIN * posture.mechanism.size))
    if not pieces:
        return None
    return Solid(name, joined(pieces), "rigid", Side(name, next(iter(body.interfaces))))


def _plate_or_bars(points: Array, thickness: float) -> Iterator[Surface]:
    """A plate through three points and more, and bars from their middle."""
    middle = points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points - middle, full_matrices=False)
    if len(points) > 2 and spread[1] > 0.1 * spread[0]:
        flat = (points - middle) @ axes[:2].T
        around = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
        on_rim = np.linalg.norm(flat[around], axis=1) > 1e-6 * spread[0]
        yield plate(points[around][on_rim])
    for point in points:
        if np.linalg.norm(point - middle) > 0.0:
            yield _between(middle, point, rectangle(thickness, thickness))


def _symbol(posture: Posture, joint: Joint) -> Solid | None:
    """The symbol of a joint: drum, sleeve, ball, cross or plate."""
    if joint.kind == "fixed":
        return None
    side = symbol_at(joint)
    place, radius = interface_position(posture, side), SYMBOL * posture.mechanism.size
    matter: Matter = "drive" if joint.drive else "joint"
    axes = joint.axes @ rotation_since_reference(posture, joint.first.body).T
    thick = _thickness(posture.mechanism, joint)

    def along(axis: Array, outline: Array, length: float) -> Surface:
        return _between(place - 0.5 * length * axis, place + 0.5 * length * axis, outline)

    match joint.kind:
        case "spherical":
            surface = ball(max(radius, 0.6 * thick)).placed(place, np.eye(3))
        case "universal":
            second = rotation_since_reference(posture, joint.second.body) @ joint.axes[1]
            drums = (along(axis, circle(0.45 * radius), 1.5 * radius) for axis in (axes[0], second))
            surface = joined(list(drums))
        case "revolute":
            length = max(1.2 * radius, _THROUGH * thick)
            surface = along(axes[0], circle(radius), length)
        case "cylindrical":
            surface = along(axes[0], circle(0.8 * radius), 2.0 * radius)
        case "prismatic":
            half = max(2.4 * radius, _THROUGH * thick)
            surface = along(axes[0], rectangle(half, half), max(2.4 * radius, half))
        case "planar":
            surface = along(axes[0], rectangle(4.0 * radius, 4.0 * radius), 0.3 * radius)
        case _:
            assert_never(joint.kind)
    return Solid(joint.name, surface, matter, side)


def _between(start: Array, end: Array, outline: Array) -> Surface:
    """A prism from one point to another (3, m)."""
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length
    rotation = np.column_stack([axis, *across_axis(axis)])
    return prism(outline, np.array([0.0, length])).placed(start, rotation)


def _thickness(mechanism: Mechanism, joint: Joint) -> float:
    """Extent (m) of the legs that meet in a joint, 0 where there is none."""
    known = legs_of(mechanism)
    names = [side.body for side in (joint.first, joint.second) if side.body in known]
    return max((max(equivalent_leg(known[name]).section.extent) for name in names), default=0.0)


def _i_outline(section: ISection) -> Array:
    y, z, web = section.width / 2.0, section.height / 2.0, section.web / 2.0
    root = z - section.flange
    right = [(y, -z), (y, -root), (web, -root), (web, root), (y, root), (y, z)]
    return np.array(right + [(-y, z) for y, z in reversed(right)])
