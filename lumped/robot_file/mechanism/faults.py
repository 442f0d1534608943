"""Faults of a robot file of schema 2: first those of the description, then those of the mobility.

Faults of the mobility, such as drives that do not fix the tool or poses out of reach, are found by
closing the loops of the mechanism.
"""

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from lumped.errors import ComputationError, InputError
from lumped.mechanism.free_twists import drive_in
from lumped.mechanism.kinematics.diagnosis import off_axes, special_postures
from lumped.mechanism.kinematics.mobility import (
    Mobility,
    generic_mobility,
    indeterminacy,
    mobility,
)
from lumped.mechanism.kinematics.postures import (
    PoseError,
    posture,
    reference_posture,
    shown_pose,
)
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.mechanism.joint_relations import joint_faults
from lumped.robot_file.mechanism.relations import body_faults, path_faults, tool_faults
from lumped.robot_file.rules.rule import Text
from lumped.robot_file.rules.tables.robots import MECHANISM, MechanismEntry
from lumped.text import counted, unknown_name

# Number of poses of a path that are checked when a file is read. Others are checked when needed.
_CHECKED_POSES = 32
# Largest number of joints whose axes are tested one by one, which takes about a second.
_DIAGNOSED = 60
# Components of a unit vector below this are round-off.
_NO_SHARE = 1e-9


def description_faults(description: Draft) -> list[str]:
    """Faults of the description of a mechanism, one line each.

    They are faults of keys, of relations between keys, and of names. If there are none, they are
    faults of the topology, such as bodies without joints.
    """
    faults = list(description.faults)
    faults += [fault for body in description.bodies.values() for fault in body_faults(body)]
    faults += [fault for joint in description.joints.values() for fault in joint_faults(joint)]
    if description.tool is not None:
        faults += tool_faults(description.tool)
        if description.path is not None:
            faults += path_faults(description.path, description.tool.moves)
    faults += [*_unknown_names(description), *_missing_interfaces(description)]
    if faults or description.entry is None:
        return faults
    # The topology is defined only if all joints are valid.
    loaded = set(_loaded_points(description.entry))
    return [
        *_unconnected_bodies(description),
        *_idle_interfaces(description, loaded),
        *_idle_points(description, loaded),
    ]


def _loaded_points(entry: MechanismEntry) -> Iterator[str | None]:
    """Names of points on which loads and harmonic forces act, or whose displacement is computed.

    None stands for the tool.
    """
    for load in entry.loads:
        yield load.at
    for response in entry.responses:
        yield response.point
        yield response.motion.point


def _unknown_names(description: Draft) -> Iterator[str]:
    """Faults of names that refer to an entry which does not exist."""
    references = [*_references(description)]
    if description.tool is not None:
        references += _names_within("tool", description.tool)
    for key, name, among in references:
        known_names = description.names[among] + ((GROUND,) if among == "bodies" else ())
        if name not in known_names:
            yield unknown_name(key, name, known_names, f"the name of one of [{among}]")


def _references(description: Draft) -> Iterator[tuple[str, str, str]]:
    """References in bodies and joints to other entries, such as a body's points.

    Each contains the location of the reference, and the name and the table of the entry to which it
    refers.
    """
    bodies = {name: body.entry for name, body in description.bodies.items()}
    joints = {name: joint.entry for name, joint in description.joints.items()}
    yield from _names_within("bodies", bodies)
    yield from _names_within("joints", joints)


def _names_within(table: str, entries: object) -> Iterator[tuple[str, str, str]]:
    for key, rule, value in MECHANISM.keys[table].kind.within(entries, table):
        if isinstance(rule, Text) and rule.among:
            yield key, value, rule.among


def _missing_interfaces(description: Draft) -> Iterator[str]:
    """Faults of joints and of the tool whose point is not a point of their body."""
    references = [
        (f"{joint.key}.at" + (f"[{i}]" if joint.entry.at == joint.points else ""), body, point)
        for joint in description.joints.values()
        if not joint.repeated_point
        for i, (body, point) in enumerate(zip(joint.entry.between, joint.points, strict=True), 1)
    ]
    if (tool := description.tool) is not None:
        references.append(("tool.point", tool.body, tool.point))
    for key, body, point in references:
        interface_points = (
            description.bodies[body].interface_points
            if body in description.bodies and body != GROUND
            else None
        )
        if interface_points is None or point not in description.names["points"]:
            continue
        if point not in interface_points:
            yield unknown_name(key, point, interface_points, f"a point of {body}")


def _unconnected_bodies(description: Draft) -> Iterator[str]:
    """Faults of bodies that are not connected to ground by joints."""
    pairs = [joint.entry.between for joint in description.joints.values()]
    connected: set[str] = set()
    new = {GROUND}
    while new:
        connected |= new
        new = {body for pair in pairs if connected & set(pair) for body in pair} - connected
    for name in description.bodies:
        if name not in connected:
            yield f"bodies.{name}: no chain of joints leads to ground; must be connected to it"


def _idle_interfaces(description: Draft, loaded: Collection[str | None]) -> Iterator[str]:
    used = {
        interface
        for joint in description.joints.values()
        for interface in zip(joint.entry.between, joint.points, strict=True)
    }
    if description.tool is not None:
        used.add((description.tool.body, description.tool.point))
    joined = {body for body, _ in used}
    for name, body in description.bodies.items():
        for point in body.interface_points or ():
            if name in joined and (name, point) not in used and point not in loaded:
                yield (
                    f'bodies.{name}: no joint holds it at "{point}"; must be joined there, '
                    "or hold the tool, or end elsewhere"
                )


def _idle_points(description: Draft, loaded: Collection[str | None]) -> Iterator[str]:
    used = {name for _, name, among in _references(description) if among == "points"}
    for point in description.points:
        if point not in used and point not in loaded:
            yield f"points.{point}: used by no body and no joint; must be used or left out"


def motion_faults(mechanism: Mechanism) -> list[str]:
    """Faults of the mobility in the reference posture. If it has none, faults of the path."""
    result = mobility(reference_posture(mechanism))
    if faults := list(_mobility_faults(mechanism, result)):
        return faults
    if faults := list(_path_faults(mechanism)):
        # With a wrong axis, the tool may be able to move in the reference posture only.
        barred = generic_mobility(mechanism).barred
        return [*_axis_faults(mechanism, barred), *faults] if barred else faults
    return []


def _mobility_faults(mechanism: Mechanism, result: Mobility) -> Iterator[str]:
    moves = f"tool.moves = {list(mechanism.tool.moves)}"
    free_motions = indeterminacy(result, mechanism.size, singular=True)
    uncontrolled = bool(len(result.uncontrolled_twists))
    if uncontrolled or result.barred:
        nearby = generic_mobility(mechanism)
        if not (nearby.barred or nearby.at_limit or len(nearby.uncontrolled_twists)):
            yield _singular(mechanism, result, free_motions)
            return
    if uncontrolled:
        yield f"joints: {free_motions}"
    if result.barred:
        yield from _axis_faults(mechanism, result.barred) or [_barred(moves, result)]
    if free_motions and not uncontrolled:
        yield f"{moves}: {free_motions}"


def _singular(mechanism: Mechanism, result: Mobility, free_motions: str) -> str:
    """Error message for a singular reference posture. It names legs that are stretched or folded.

    `free_motions` describes the motions that neither drives nor moves determine.
    """
    reasons = [
        f"{' and '.join(legs)} {'are' if len(legs) > 1 else 'is'} {posture}"
        for legs, posture in special_postures(mechanism)
    ]
    if result.at_limit:
        reasons.append(
            f"drives {', '.join(result.stirring)} move while the tool cannot move along "
            f"{', '.join(result.barred)}"
        )
    elif result.barred:
        reasons.append(f"the tool cannot move along {', '.join(result.barred)}")
    if len(result.uncontrolled_twists):
        reasons.append(free_motions)
    return (
        f"points: the reference posture is singular: {'; '.join(reasons)}; must be a posture "
        "inside the workspace"
    )


def _barred(moves: str, result: Mobility) -> str:
    allowed = (
        f"{counted(result.almost_redundant, 'constraint repeats', 'constraints repeat')} others "
        "almost; are parallel axes given with all their digits?"
        if result.almost_redundant
        else "must name motions that they allow, each by itself"
    )
    barred = ", ".join(result.barred)
    return f"{moves}: the joints do not let the tool move along {barred}; {allowed}"


def _axis_faults(mechanism: Mechanism, barred: Sequence[str]) -> list[str]:
    """Fault of the joint whose axis prevents motions of the tool. Empty if there is no such joint.

    `barred` names the coordinates of the tool that cannot be prescribed. The message also names
    other joints that could be the cause.
    """
    if len(mechanism.joints) > _DIAGNOSED:
        return []
    first, *alternatives = off_axes(mechanism) or (None,)
    if first is None:
        return []
    needed = [float(f"{x:.6g}") for x in np.where(np.abs(first.axis) < _NO_SHARE, 0.0, first.axis)]
    names = " or ".join(alternative.joint.name for alternative in alternatives)
    also = f" (or the axis of {names} is off as much)" if alternatives else ""
    return [
        f"joints.{first.joint.name}.axis = {[float(f'{x:.6g}') for x in first.joint.axes[0]]}: "
        f"keeps the tool from moving along {', '.join(barred)}; along {needed}, "
        f"{np.degrees(first.angle):.3g}° from it, it would move{also}"
    ]


def _screw_faults(posture: Posture, location: str) -> Iterator[str]:
    """Faults of ball screws whose nut would be beyond a bearing in `posture`."""
    for joint in posture.mechanism.joints:
        try:
            drive_in(posture, joint)
        except ComputationError as error:
            pose = shown_pose(posture.mechanism, posture.pose)
            yield f"{location}, {pose}: joints.{joint.name}.drive.screw: {error}"


def _path_faults(mechanism: Mechanism) -> Iterator[str]:
    count = len(mechanism.poses)
    checked = np.unique(np.linspace(0, count - 1, min(count, _CHECKED_POSES)).round().astype(int))
    faults: dict[int, list[str]] = {}
    for i in checked:
        try:
            yield from _screw_faults(posture(mechanism, mechanism.poses[i]), f"path, pose {i + 1}")
        except PoseError as error:
            faults[i] = [f"path, pose {i + 1}, {error.pose}: {error.reason}"]
        except InputError as error:
            faults[i] = [f"path, pose {i + 1}, {fault}" for fault in error.faults]
    # Poses of a grid that are out of reach are omitted, unless all of them are.
    if len(faults) == len(checked) or not mechanism.grid:
        yield from (fault for pose_faults in faults.values() for fault in pose_faults)
