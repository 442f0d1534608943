"""What the keys of [joints] must say together, and what [tool] must say of the bodies."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import AXES, FREEDOMS, SMALLEST_SINE
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.mechanism.draft import Draft, Entry, wrong_name

# Kinds whose two points may lie apart, along the axis.
_EXTENDED = ("prismatic", "cylindrical")
# Length of a direction below which it is none: its square would be lost.
_NO_DIRECTION = 1e-9


def joint_faults(draft: Draft) -> list[str]:
    """Faults of all joints, each line starting with its key."""
    return [
        fault
        for name, joint in draft.joints.items()
        for check in (_body_faults, _point_faults, _axis_faults)
        for fault in check(draft, joint, f"joints.{name}")
    ]


def points_of(joint: Entry) -> tuple[str, str]:
    """The names of the first and the second body's point."""
    at = joint["at"]
    return (at, at) if isinstance(at, str) else at


def directions_of(joint: Entry) -> tuple[Any, ...]:
    """The directions that a joint gives, as many as it does."""
    return joint["axes"] or ((joint["axis"],) if joint["axis"] else ())


def way_between(draft: Draft, joint: Entry) -> Array | None:
    """From the first to the second of two points (3, m); None unless two are known and apart."""
    first, second = points_of(joint)
    if first == second or first not in draft.points or second not in draft.points:
        return None
    way: Array = draft.points[second] - draft.points[first]
    return way if np.linalg.norm(way) > _NO_DIRECTION else None


def tool_faults(draft: Draft) -> list[str]:
    """Faults of [tool] with the bodies and points that it names."""
    if draft.tool is None:
        return []
    body, moves = draft.tool["body"], draft.tool["moves"]
    if body == GROUND:
        return [f'tool.body = "{GROUND}": must be a body that moves']
    faults = draft.unknown("tool.body", body, "bodies")
    faults += _held_faults(draft, "tool.point", draft.tool["point"], body)
    return faults + [
        f'tool.moves[{i}] = "{move}": named twice'
        for i, move in enumerate(moves, start=1)
        if move in moves[: i - 1]
    ]


def _held_faults(draft: Draft, key: str, point: str, body: str) -> list[str]:
    """Fault of a point that is none, or that the body does not have."""
    faults = draft.unknown(key, point, "points")
    held = draft.interfaces(body)
    if faults or held is None:
        return faults
    return wrong_name(key, point, held, f"a point of {body}")


def _body_faults(draft: Draft, joint: Entry, key: str) -> Iterator[str]:
    first, second = joint["between"]
    for i, body in enumerate((first, second), start=1):
        yield from draft.unknown(f"{key}.between[{i}]", body, "bodies")
    if first == second:
        yield f'{key}.between: "{first}" twice; must be two different bodies'
    freedoms = FREEDOMS[joint["type"]]
    if joint["drive"] is not None and freedoms != 1:
        yield (
            f"{key}.drive: a {joint['type']} joint has {freedoms or 'no'} free motions; "
            "must be a revolute or a prismatic one"
        )


def _point_faults(draft: Draft, joint: Entry, key: str) -> Iterator[str]:
    points = points_of(joint)
    extended = not isinstance(joint["at"], str)
    if extended and points[0] == points[1]:
        yield f"{key}.at = {list(points)}: must be two different points, or one name"
        return
    for i, (point, body) in enumerate(zip(points, joint["between"], strict=True), start=1):
        place = f"{key}.at[{i}]" if extended else f"{key}.at"
        faults = _held_faults(draft, place, point, body)
        yield from faults
        if faults and not extended and point not in draft.names["points"]:
            return
    if extended and joint["type"] not in _EXTENDED:
        yield (
            f"{key}.at = {list(points)}: only {' and '.join(_EXTENDED)} joints may name two "
            "points; must be one point of both bodies"
        )


def _axis_faults(draft: Draft, joint: Entry, key: str) -> Iterator[str]:
    kind, way = joint["type"], way_between(draft, joint)
    wanted = ("", "axis", "axes")[AXES[kind]]
    for name in ("axis", "axes"):
        if joint[name] is not None and name != wanted:
            instead = f"must have {wanted}" if wanted else "must have none"
            yield f"{key}.{name}: does not belong to a {kind} joint; {instead}"
    if not wanted:
        return
    if joint[wanted] is None:
        if way is None or kind not in _EXTENDED:
            allowed = "a direction [x, y, z]" if wanted == "axis" else "two directions"
            yield f"{key}.{wanted}: missing; must be {allowed}"
        return
    directions = directions_of(joint)
    for direction in directions:
        if np.linalg.norm(direction) < _NO_DIRECTION:
            yield f"{key}.{wanted} = {list(direction)}: must not be zero, it is a direction"
            return
    if len(directions) == 2 and _sine(*directions) < SMALLEST_SINE:
        yield (
            f"{key}.axes = {list(map(list, directions))}: must not be parallel; "
            "a universal joint turns about two directions"
        )
    if kind in _EXTENDED and way is not None and _sine(directions[0], way) > SMALLEST_SINE:
        first, second = points_of(joint)
        yield (
            f"{key}.axis = {list(directions[0])}: must point from {first} to {second} or back, "
            f"which are {np.linalg.norm(way):.3g} m apart; left out, it does"
        )


def _sine(first: object, second: object) -> float:
    a, b = np.array(first, dtype=float), np.array(second, dtype=float)
    return float(np.linalg.norm(np.cross(a, b)) / (np.linalg.norm(a) * np.linalg.norm(b)))
