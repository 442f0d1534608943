"""What the keys of [joints] must say together, and what [tool] must say of the bodies."""

from collections.abc import Iterator

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import AXES, FREEDOMS, SMALLEST_SINE
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.mechanism.draft import Draft, wrong_name
from lumped.robot_file.mechanism.tables import JointTable

# Kinds whose two points may lie apart, along the axis.
_EXTENDED = ("prismatic", "cylindrical")
# Length of a direction below which it is none: its square would be lost.
_NO_DIRECTION = 1e-9


def joint_faults(draft: Draft) -> list[str]:
    """Faults of all joints, each line starting with its key."""
    return [
        fault
        for name, joint in draft.joints.items()
        for check in (_body_faults, _point_faults, _axis_faults, _drive_faults)
        for fault in check(draft, joint, f"joints.{name}")
    ]


def points_of(joint: JointTable) -> tuple[str, str]:
    """The names of the first and the second body's point."""
    return (joint.at, joint.at) if isinstance(joint.at, str) else joint.at


def way_between(draft: Draft, joint: JointTable) -> Array | None:
    """From the first to the second of two points (3, m); None unless two are known and apart."""
    first, second = points_of(joint)
    if first == second or first not in draft.points or second not in draft.points:
        return None
    way: Array = draft.points[second] - draft.points[first]
    return way if np.linalg.norm(way) > _NO_DIRECTION else None


def tool_faults(draft: Draft) -> list[str]:
    """Faults of [tool] with the bodies and points that it names."""
    tool = draft.tool
    if tool is None:
        return []
    if tool.body == GROUND:
        return [f'tool.body = "{GROUND}": must be a body that moves']
    faults = draft.unknown("tool.body", tool.body, "bodies")
    faults += _held_faults(draft, "tool.point", tool.point, tool.body)
    faults += [
        f'tool.moves[{i}] = "{move}": named twice'
        for i, move in enumerate(tool.moves, start=1)
        if move in tool.moves[: i - 1]
    ]
    return faults


def _held_faults(draft: Draft, key: str, point: str, body: str) -> list[str]:
    """Fault of a point that is none, or that the body does not have."""
    faults = draft.unknown(key, point, "points")
    held = draft.interfaces(body)
    if faults or held is None:
        return faults
    return wrong_name(key, point, held, f"a point of {body}")


def _body_faults(draft: Draft, joint: JointTable, key: str) -> Iterator[str]:
    for i, body in enumerate(joint.between, start=1):
        yield from draft.unknown(f"{key}.between[{i}]", body, "bodies")
    if joint.between[0] == joint.between[1]:
        yield f'{key}.between: "{joint.between[0]}" twice; must be two different bodies'


def _point_faults(draft: Draft, joint: JointTable, key: str) -> Iterator[str]:
    points = points_of(joint)
    extended = not isinstance(joint.at, str)
    if extended and points[0] == points[1]:
        yield f"{key}.at = {list(points)}: must be two different points, or one name"
        return
    for i, (point, body) in enumerate(zip(points, joint.between, strict=True), start=1):
        place = f"{key}.at[{i}]" if extended else f"{key}.at"
        faults = _held_faults(draft, place, point, body)
        yield from faults
        if faults and not extended and point not in draft.names["points"]:
            return
    if not extended:
        return
    if joint.type not in _EXTENDED:
        yield (
            f"{key}.at = {list(points)}: only {' and '.join(_EXTENDED)} joints may name two "
            "points; must be one point of both bodies"
        )


def _axis_faults(draft: Draft, joint: JointTable, key: str) -> Iterator[str]:
    needed = AXES[joint.type]
    way = way_between(draft, joint)
    given = {"axis": joint.axis is not None, "axes": joint.axes is not None}
    wanted = {0: "", 1: "axis", 2: "axes"}[needed]
    for name, present in given.items():
        if present and name != wanted:
            instead = f"must have {wanted}" if wanted else "must have none"
            yield f"{key}.{name}: does not belong to a {joint.type} joint; {instead}"
    if wanted and not given[wanted] and (way is None or joint.type not in _EXTENDED):
        allowed = "a direction [x, y, z]" if needed == 1 else "two directions"
        yield f"{key}.{wanted}: missing; must be {allowed}"
    directions = {
        "axis": [joint.axis] if joint.axis else [],
        "axes": list(joint.axes or ()),
    }.get(wanted, [])
    for direction in directions:
        if np.linalg.norm(direction) < _NO_DIRECTION:
            yield f"{key}.{wanted} = {list(direction)}: must not be zero, it is a direction"
            return
    if len(directions) == 2 and _sine(*directions) < SMALLEST_SINE:
        yield (
            f"{key}.axes = {[list(direction) for direction in directions]}: must not be parallel; "
            "a universal joint turns about two directions"
        )
    if len(directions) == 1 and way is not None and joint.type in _EXTENDED:
        first, second = points_of(joint)
        apart = float(np.linalg.norm(way))
        if _sine(directions[0], way) > SMALLEST_SINE:
            yield (
                f"{key}.axis = {list(directions[0])}: must point from {first} to {second} or back, "
                f"which are {apart:.3g} m apart; left out, it does"
            )


def _drive_faults(draft: Draft, joint: JointTable, key: str) -> Iterator[str]:  # noqa: ARG001
    if joint.drive is not None and FREEDOMS[joint.type] != 1:
        yield (
            f"{key}.drive: a {joint.type} joint has {FREEDOMS[joint.type] or 'no'} free motions; "
            "must be a revolute or a prismatic one"
        )


def _sine(first: object, second: object) -> float:
    a, b = np.array(first, dtype=float), np.array(second, dtype=float)
    return float(np.linalg.norm(np.cross(a, b)) / (np.linalg.norm(a) * np.linalg.norm(b)))
