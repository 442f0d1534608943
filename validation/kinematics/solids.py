"""Bodies as they are, and joints as the field draws them, as polygons in base axes.

Prisms have their true sections, CAD parts their surface.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, TypeAlias, assert_never

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg
from lumped.mechanism.body import Body, Frame
from lumped.mechanism.free_twists import (
    across_axis,
    interface_position,
    turned_since_reference,
)
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.mechanism.part import Part
from lumped.sections import Circle, HollowRectangle, ISection, Section, Tube
from validation.models.parts import found_in

Matter: TypeAlias = Literal["leg", "other leg", "rigid", "hole", "joint", "drive"]
_FACETS = 20
# Of a rigid body's bars and plates, of the size of the mechanism.
_THIN = 0.012
# A joint sits inside the legs it joins; its symbol is drawn before them (radii).
_IN_FRONT = 5.0


@dataclass(frozen=True, eq=False)
class Face:
    """A flat polygon (n×3, m, base axes) of something; `nearer` (m) settles who covers whom."""

    corners: Array
    matter: Matter
    nearer: float = 0.0


def body_faces(posture: Posture, name: str, size: float) -> Iterator[Face]:
    """Faces of a body: prisms and parts as they are, else plate or bars between points.

    So a part whose file cannot be read, of which others complain.
    """
    body = posture.mechanism.bodies[name]
    frame = posture.frames[name]
    points = np.array([(frame @ place).position for place in body.interfaces.values()])
    if isinstance(body.shape, ConstantLeg):
        outline, bores = outlines(body.shape.section)
        yield from _extruded(outline, frame.position, frame.rotation, body.shape.length, bores)
        return
    if isinstance(body.shape, Part):
        with suppress(InputError):
            yield from _surface(body, frame)
            return
        yield from _plate(points, _THIN * size)
        return
    if is_leg(body):
        radius = 0.02 * float(np.linalg.norm(points[1] - points[0]))
        outline = _circle(radius)
        length = float(np.linalg.norm(points[1] - points[0]))
        yield from _extruded(outline, frame.position, frame.rotation, length, [])
        return
    yield from _plate(points, _THIN * size)


def outlines(section: Section) -> tuple[Array, list[Array]]:
    """Outline (n×2, y and z, m) of a section and its bores."""
    if isinstance(section, Circle | Tube):
        bores = [_circle(section.inner_diameter / 2.0)] if isinstance(section, Tube) else []
        return _circle(section.diameter / 2.0), bores
    if isinstance(section, ISection):
        return _i_outline(section), []
    bores = []
    if isinstance(section, HollowRectangle):
        bores = [_rectangle(*section.inner.extent)]
    return _rectangle(*section.extent), bores


def joint_faces(
    posture: Posture, joint: Joint, radius: float, reach: float = 0.0
) -> Iterator[Face]:
    """The symbol of a joint where its first body ends: drum, sleeve, ball, cross or plate.

    What slides on ground is drawn where it has slid to. Drums are at least `reach` (m) long.
    """
    place = interface_position(posture, joint.second if on_ground(joint) else joint.first)
    turn = turned_since_reference(posture, joint.first.body)
    matter: Matter = "drive" if joint.drive else "joint"
    axes = joint.axes @ turn.T
    match joint.kind:
        case "fixed":
            return
        case "spherical":
            yield from _ball(place, radius, matter)
        case "universal":
            second = turned_since_reference(posture, joint.second.body) @ joint.axes[1]
            for axis in (axes[0], second):
                yield from _drum(place, axis, 0.45 * radius, 1.5 * radius, matter)
        case "revolute":
            yield from _drum(place, axes[0], radius, max(1.2 * radius, reach), matter)
        case "cylindrical":
            yield from _drum(place, axes[0], 0.8 * radius, 2.0 * radius, matter)
        case "prismatic":
            yield from _sleeve(place, axes[0], (1.2 * radius, 2.4 * radius), matter)
        case "planar":
            yield from _sleeve(place, axes[0], (2.0 * radius, 0.3 * radius), matter)
        case _:
            assert_never(joint.kind)


def on_ground(joint: Joint) -> bool:
    """Whether the first body of a joint is ground."""
    return joint.first.body == GROUND


def is_leg(body: Body) -> bool:
    """Whether a body runs from one point to another, by its data or its shape."""
    return isinstance(body.shape, ConstantLeg | GivenLeg | Part) and len(body.interfaces) == 2


def _surface(body: Body, frame: Frame) -> Iterator[Face]:
    file, _ = found_in(body)
    places = frame.position + file.surface @ frame.rotation.T
    for face in file.faces:
        for corners in face.facets.corners:
            yield Face(places[corners], "leg")


def _circle(radius: float) -> Array:
    angles = 2.0 * np.pi * np.arange(_FACETS) / _FACETS
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _rectangle(width: float, height: float) -> Array:
    return 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])


def _i_outline(section: ISection) -> Array:
    y, z, web = section.width / 2.0, section.height / 2.0, section.web / 2.0
    root = z - section.flange
    right = [(y, -z), (y, -root), (web, -root), (web, root), (y, root), (y, z)]
    return np.array(right + [(-y, z) for y, z in reversed(right)])


def _extruded(
    outline: Array, origin: Array, rotation: Array, length: float, bores: list[Array]
) -> Iterator[Face]:
    near, far = (_placed(outline, origin, rotation, x) for x in (0.0, length))
    following = np.roll(np.arange(len(outline)), -1)
    # Pieces along the leg: whole sides of crossing legs would cover each other as a whole.
    cuts = np.linspace(0.0, 1.0, 13)
    for begin, end in pairwise(cuts):
        one, other = (near + share * (far - near) for share in (begin, end))
        for i, j in enumerate(following):
            yield Face(np.array([one[i], one[j], other[j], other[i]]), "leg")
    for x, cap in ((0.0, near), (length, far)):
        yield Face(cap, "leg")
        for bore in bores:
            yield Face(_placed(bore, origin, rotation, x), "hole", nearer=1e-4)


def _placed(outline: Array, origin: Array, rotation: Array, x: float) -> Array:
    local = np.column_stack([np.full(len(outline), x), outline])
    placed: Array = origin + local @ rotation.T
    return placed


def _plate(points: Array, thickness: float) -> Iterator[Face]:
    """A plate through three points and more, else bars from their middle."""
    middle = points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points - middle, full_matrices=False)
    if len(points) > 2 and spread[1] > 0.1 * spread[0]:
        flat = (points - middle) @ axes[:2].T
        around = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
        on_rim = np.linalg.norm(flat[around], axis=1) > 1e-6 * spread[0]
        yield Face(points[around][on_rim], "rigid")
    for point in points:
        length = float(np.linalg.norm(point - middle))
        if length > 0.0:
            x = (point - middle) / length
            rotation = np.column_stack([x, *across_axis(x)])
            bar = _rectangle(thickness, thickness)
            for face in _extruded(bar, middle, rotation, length, []):
                yield Face(face.corners, "rigid")


def _drum(
    place: Array, axis: Array, radius: float, length: float, matter: Matter
) -> Iterator[Face]:
    rotation = np.column_stack([axis, *across_axis(axis)])
    for face in _extruded(_circle(radius), place - 0.5 * length * axis, rotation, length, []):
        yield Face(face.corners, matter, nearer=_IN_FRONT * radius)


def _sleeve(
    place: Array, axis: Array, sizes: tuple[float, float], matter: Matter
) -> Iterator[Face]:
    half, length = sizes
    rotation = np.column_stack([axis, *across_axis(axis)])
    box = _rectangle(2.0 * half, 2.0 * half)
    for face in _extruded(box, place - 0.5 * length * axis, rotation, length, []):
        yield Face(face.corners, matter, nearer=0.6 * _IN_FRONT * half)


def _ball(place: Array, radius: float, matter: Matter) -> Iterator[Face]:
    rings = np.linspace(0.0, np.pi, 9)
    circle = _circle(1.0)
    levels = [
        place + radius * np.column_stack([np.sin(t) * circle, np.full(_FACETS, np.cos(t))])
        for t in rings
    ]
    following = np.roll(np.arange(_FACETS), -1)
    for one, other in pairwise(levels):
        for i, j in enumerate(following):
            yield Face(
                np.array([one[i], one[j], other[j], other[i]]), matter, nearer=_IN_FRONT * radius
            )
