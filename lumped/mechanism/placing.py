"""Placement of legs and rigid bodies on named points in the reference posture; a leg alone."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Leg
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool

_X, _, _Z = np.eye(3)
# Sine of the angle below which two directions count as parallel.
_PARALLEL = 1e-6
# Names of the interfaces of a leg alone.
_ROOT, _TIP = "root", "tip"


def leg_frame(start: Array, end: Array, up: Array | None = None) -> Frame:
    """Frame at `start` (3, in m) with x towards `end` and z as near to `up` (3) as possible.

    By default `up` is the z axis of the base, or its x axis for a leg along z. Raises InputError if
    the two points coincide or `up` is parallel to the leg.
    """
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        raise InputError("the two points of a leg must be apart")
    x = (end - start) / length
    if up is None:
        up = default_up(x)
    y = np.cross(up, x)
    across = float(np.linalg.norm(y))
    if across <= _PARALLEL * float(np.linalg.norm(up)):
        raise InputError("up must not lie along the leg")
    y /= across
    return Frame(np.asarray(start, dtype=float), np.column_stack([x, y, np.cross(x, y)]))


def default_up(x: Array) -> Array:
    """Default of `up` in `leg_frame` (unit vector), for a leg along the unit vector `x`."""
    up: Array = _Z if np.linalg.norm(np.cross(x, _Z)) > _PARALLEL else _X
    return up


def axes_along(x: Sequence[float], y: Sequence[float]) -> Array:
    """Axes (3×3, columns) whose first is along `x` and whose second is as near to `y` as possible.

    `x` and `y` (3 each) need not be unit vectors and must not be parallel.
    """
    first = np.asarray(x) / np.linalg.norm(x)
    third = np.cross(first, y)
    third /= np.linalg.norm(third)
    return np.column_stack([first, np.cross(third, first), third])


def place_leg(
    name: str,
    leg: Leg,
    ends: tuple[str, str],
    points: Mapping[str, Array],
    up: Array | None = None,
) -> tuple[Body, Frame]:
    """Body of a leg between two named `points` (3, in m, base axes), and its frame in base axes.

    `ends` are the names of root and tip. The distance of the points must equal the length of the
    leg within round-off. Raises InputError as `leg_frame` does.
    """
    first, second = ends
    tip = Frame(np.array([leg.length, 0.0, 0.0]))
    body = Body(name, replace(leg, name=name), {first: Frame(), second: tip})
    return body, leg_frame(points[first], points[second], up)


def place_rigid_body(
    name: str,
    interfaces: Iterable[str],
    points: Mapping[str, Array],
    shape: Rigid | None = None,
    origin: Array | None = None,
) -> tuple[Body, Frame]:
    """Rigid body with the given `interfaces`, and its frame in base axes.

    `points` (3, in m, base axes) contains the position of each interface by its name. The axes of
    the body are parallel to the base axes. Its origin is `origin` (3, in m, base axes), or the
    first interface if `origin` is None. The body has no mass if `shape` is None.
    """
    names = tuple(interfaces)
    frame_origin = points[names[0]] if origin is None else origin
    interface_frames = {point: Frame(points[point] - frame_origin) for point in names}
    return Body(name, shape or Rigid(), interface_frames), Frame(frame_origin)


def clamped_leg(name: str, leg: Leg) -> Mechanism:
    """Mechanism of one leg in leg axes: its root is fixed to the ground, the tool is at its tip."""
    points = {_ROOT: np.zeros(3), _TIP: np.array([leg.length, 0.0, 0.0])}
    placed_bodies = [
        place_rigid_body(GROUND, [_ROOT], points, origin=np.zeros(3)),
        place_leg(name, leg, (_ROOT, _TIP), points),
    ]
    clamp = Joint("clamp", "fixed", Side(GROUND, _ROOT), Side(name, _ROOT), np.zeros((0, 3)))
    return Mechanism(
        name=name,
        bodies={body.name: body for body, _ in placed_bodies},
        joints=(clamp,),
        tool=Tool(name, _TIP),
        reference={body.name: frame for body, frame in placed_bodies},
        poses=np.zeros((1, 0)),
    )
