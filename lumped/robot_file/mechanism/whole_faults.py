"""Whether bodies and joints make one mechanism, and whether its path is one of poses."""

from collections.abc import Iterator, Mapping, Sequence

from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.mechanism.joint_faults import points_of


def connection_faults(draft: Draft) -> list[str]:
    """Bodies that nothing holds, and points that nobody uses."""
    return [*_loose_bodies(draft), *_idle_interfaces(draft), *_idle_points(draft)]


def path_faults(draft: Draft) -> list[str]:
    """Faults of [path] beside the tool's moves."""
    if draft.path is None or draft.tool is None:
        return []
    path, moves = draft.path, draft.tool["moves"]
    given = [key for key in ("from", "to", "count", "counts") if path[key] is not None]
    if path["poses"] is not None:
        faults = [f"path.{key}: must not be given beside path.poses" for key in given]
        if not path["poses"]:
            faults.append("path.poses = []: must hold at least one pose")
        poses = {f"poses[{i}]": pose for i, pose in enumerate(path["poses"], start=1)}
        return faults + _length_faults(poses, moves)
    faults = [
        f"path.{key}: missing; must be a pose, {len(moves)} numbers ({', '.join(moves)})"
        for key in ("from", "to")
        if key not in given
    ]
    if ("count" in given) == ("counts" in given):
        faults.append(
            "path.count: must be given for a line (how many poses), or path.counts for a grid "
            "(how many along each move), and only one of them"
        )
    return faults + _length_faults({key: path[key] for key in given if key != "count"}, moves)


def _length_faults(lists: Mapping[str, Sequence[float]], moves: Sequence[str]) -> list[str]:
    wanted = f"one for each of tool.moves ({', '.join(moves)})" if moves else "none: no tool.moves"
    return [
        f"path.{key}: {len(values)} numbers; must be {len(moves)}, {wanted}"
        for key, values in lists.items()
        if len(values) != len(moves)
    ]


def _loose_bodies(draft: Draft) -> Iterator[str]:
    """Bodies from which no way of joints leads to ground."""
    pairs = [joint["between"] for joint in draft.joints.values()]
    reached: set[str] = set()
    new = {GROUND}
    while new:
        reached |= new
        new = {body for pair in pairs if reached & set(pair) for body in pair} - reached
    for name in draft.bodies:
        if name not in reached:
            yield f"bodies.{name}: no way of joints leads to ground; must be connected to it"


def _idle_interfaces(draft: Draft) -> Iterator[str]:
    used = {
        (body, point)
        for joint in draft.joints.values()
        for body, point in zip(joint["between"], points_of(joint), strict=True)
    }
    if draft.tool is not None:
        used.add((draft.tool["body"], draft.tool["point"]))
    for name in draft.bodies:
        joined = any(body == name for body, _ in used)
        for point in draft.interfaces(name) or ():
            if joined and (name, point) not in used:
                yield (
                    f'bodies.{name}: nothing takes hold of it at "{point}"; must be joined there, '
                    "or hold the tool, or end elsewhere"
                )


def _idle_points(draft: Draft) -> Iterator[str]:
    used = {point for name in draft.bodies for point in draft.interfaces(name) or ()}
    for body in draft.bodies.values():
        places = body["centre"], body["place"] and body["place"]["at"]
        used |= {place for place in places if isinstance(place, str)}
    used |= {point for joint in draft.joints.values() for point in points_of(joint)}
    for point in draft.points:
        if point not in used:
            yield f"points.{point}: used by no body and no joint; must be used or left out"
