"""Rules for the relations between the keys of a joint of a robot file.

Each fault is a line that begins with the key. Parts of a joint have rules of their own: values
along its directions, a ball bearing, a profile rail guide, a drive with its ball screw and nut.
"""

from collections.abc import Iterator, Sequence
from math import pi
from typing import get_args

import numpy as np

from lumped.mechanism.catalogue.ball_guide import PreloadClass
from lumped.mechanism.catalogue.ball_nut import has_play, nut_of_size
from lumped.mechanism.catalogue.directions import DIRECTIONS, NEED_UP
from lumped.mechanism.joint import FREEDOMS, SMALLEST_SINE, JointKind
from lumped.robot_file.mechanism.draft import JointDraft
from lumped.robot_file.mechanism.relations import are_parallel, specified_keys
from lumped.robot_file.mechanism.rolling import bearing_preload_faults, guide_preload_faults
from lumped.robot_file.rules.rule import NO_DIRECTION
from lumped.robot_file.rules.tables.joints import (
    AlongDirections,
    BearingEntry,
    DriveEntry,
    GuideEntry,
    NutEntry,
    ScrewEntry,
)
from lumped.text import shown

# Kinds of joints whose two points may be apart along the axis.
_EXTENDED = ("prismatic", "cylindrical")
# Sine of the angle below which the direction `up` is parallel to the axis of a slide.
_ALONG_SLIDE = 1e-6


def joint_faults(joint: JointDraft) -> Iterator[str]:
    """Faults of a joint of schema 2."""
    key, entry, kind, points = joint.key, joint.entry, joint.entry.type, joint.entry.at
    first, second = entry.between
    if first == second:
        yield f'{key}.between: "{first}" twice; must be two different bodies'
    if entry.loss and not specified_keys(entry, "compliance", "stiffness", "bearing", "guide"):
        yield (
            f"{key}.loss: must be left out without {key}.compliance or {key}.stiffness, to which "
            "it belongs"
        )
    yield from _direction_faults(joint)
    if entry.drive is not None:
        yield from _drive_faults(entry.drive, f"{key}.drive", kind)
    if joint.repeated_point:
        yield f"{key}.at = {list(points)}: must be two different points, or one name"
    elif not isinstance(points, str) and kind not in _EXTENDED:
        yield (
            f"{key}.at = {list(points)}: only {' and '.join(_EXTENDED)} joints may name two "
            "points; must be one point of both bodies"
        )
    axis_key, vector, directions = joint.axis_key, joint.vector, joint.directions
    for name in specified_keys(entry, "axis", "axes"):
        if name != axis_key:
            instead = f"must have {axis_key}" if axis_key else "must have none"
            yield f"{key}.{name}: does not belong to a {kind} joint; {instead}"
    slide = vector if kind in _EXTENDED else None
    if axis_key and not directions and slide is None:
        allowed = "a direction [x, y, z]" if axis_key == "axis" else "two directions"
        yield f"{key}.{axis_key}: missing; must be {allowed}"
    for direction in directions:
        if np.linalg.norm(direction) < NO_DIRECTION:
            yield f"{key}.{axis_key} = {list(direction)}: must not be zero, it is a direction"
            return
    if len(directions) == 2 and are_parallel(directions[0], directions[1], SMALLEST_SINE):
        yield (
            f"{key}.axes = {list(map(list, directions))}: must not be parallel; "
            "a universal joint turns about two directions"
        )
    if slide is not None and directions and not are_parallel(directions[0], slide, SMALLEST_SINE):
        distance = joint.unit.shown(float(np.linalg.norm(slide)), 3)
        yield (
            f"{key}.axis = {list(directions[0])}: must point from {points[0]} to {points[1]} or "
            f"back, which are {distance} apart; or be left out"
        )


def _direction_faults(joint: JointDraft) -> Iterator[str]:
    """Faults of values along directions of a joint, and of `up`, on which the directions depend."""
    key, entry, kind = joint.key, joint.entry, joint.entry.type
    stiffness, damping = entry.stiffness, entry.damping
    directions = DIRECTIONS[kind]
    fixed_directions = [name for name, direction in directions.items() if not direction.free]
    if stiffness is not None:
        if entry.compliance is not None:
            yield f"{key}.stiffness: must be left out, because {key}.compliance replaces it"
        yield from _strange_directions(stiffness, fixed_directions, f"{key}.stiffness", kind)
        for name in fixed_directions:
            if name not in stiffness:
                unit = "N m/rad" if directions[name].turns else "N/m"
                yield f'{key}.stiffness.{name}: missing; must be a number in {unit}, or "rigid"'
    if damping is not None:
        yield from _strange_directions(damping, list(directions), f"{key}.damping", kind)
        elastic = specified_keys(entry, "compliance", "bearing", "guide")
        for name in fixed_directions if not elastic else ():
            if name in damping and (stiffness is None or stiffness.get(name) == "rigid"):
                yield (
                    f"{key}.damping.{name}: the joint is rigid there, a dashpot has no effect; "
                    "must be left out, or the direction be given a stiffness"
                )
    if entry.bearing is not None:
        yield from _bearing_faults(joint, entry.bearing)
    if entry.guide is not None:
        yield from _guide_faults(joint, entry.guide)
    yield from _up_faults(joint)


def _element_faults(joint: JointDraft, key: str, joint_type: str) -> Iterator[str]:
    """Faults of the bearing or guide at `key`, which belongs to a joint of type `joint_type`."""
    if joint.entry.type != joint_type:
        yield f"{key}: does not belong to a {joint.entry.type} joint; must be a {joint_type} one"
    for name in specified_keys(joint.entry, "compliance", "stiffness"):
        yield f"{key}: must be left out if {joint.key}.{name} is given, which it determines"


def _guide_faults(joint: JointDraft, guide: GuideEntry) -> Iterator[str]:
    """Faults of a profile rail guide."""
    key = f"{joint.key}.guide"
    yield from _element_faults(joint, key, "prismatic")
    inside = ("balls", "ball_diameter", "spacing", "width", "height")
    faults = [*_catalogue_faults(guide, key, inside, ("contact_angle", "groove", "lines"))]
    yield from faults
    if (guide.size is not None) != isinstance(guide.preload, str):
        classes = " or ".join(map(shown, get_args(PreloadClass)))
        required = (
            "a force in N, without a size" if guide.size is None else f"{classes}, for a size"
        )
        yield f"{key}.preload = {shown(guide.preload)}: must be {required}"
    elif guide.size is None and not faults:
        yield from guide_preload_faults(guide, key)
    if guide.spacing and guide.ball_diameter and guide.spacing < guide.ball_diameter:
        yield f"{key}.spacing: must be at least the diameter of the balls"
    if joint.entry.up is None:
        yield f"{joint.key}.up: missing; must be the direction of the normal of {key}"


def _bearing_faults(joint: JointDraft, bearing: BearingEntry) -> Iterator[str]:
    """Faults of a ball bearing."""
    key = f"{joint.key}.bearing"
    yield from _element_faults(joint, key, "revolute")
    inside = ("balls", "ball_diameter", "pitch_diameter")
    faults = [
        *_catalogue_faults(bearing, key, inside, ("contact_angle", "inner_groove", "outer_groove"))
    ]
    balls, ball, pitch = bearing.balls, bearing.ball_diameter, bearing.pitch_diameter
    if balls and ball and pitch and balls * ball > pi * pitch:
        faults.append(f"{key}.balls = {balls}: do not fit into their circle")
    yield from faults or bearing_preload_faults(bearing, key)
    if (bearing.rows > 1) != (bearing.distance is not None):
        yield f"{key}.distance: must be given for several rows, and left out for one"


def _catalogue_faults(
    entry: BearingEntry | GuideEntry | NutEntry,
    key: str,
    required: Sequence[str],
    optional: Sequence[str],
) -> Iterator[str]:
    """Faults of a machine element at `key` that is described by its size or by numbers.

    With the key `size`, the keys `required` and `optional` must be left out. Without it, all keys
    `required` must be given.
    """
    if entry.size is not None:
        for name in specified_keys(entry, *required, *optional):
            yield f"{key}.{name}: must be left out, because {key}.size determines it"
    else:
        for name in required:
            if getattr(entry, name) is None:
                yield f"{key}.{name}: missing; must be given, or {key}.size"


def _strange_directions(
    numbers: AlongDirections, directions: Sequence[str], key: str, kind: str
) -> Iterator[str]:
    """Faults of `numbers` along `directions`, the named directions of a kind of joint.

    They concern names that are not among the directions, and a table without numbers.
    """
    if not numbers:
        yield f"{key}: has no number; must have one of {', '.join(directions)}"
    for name in numbers:
        if name not in directions:
            yield (
                f"{key}.{name}: does not belong to a {kind} joint; its directions are "
                f"{', '.join(directions)}"
            )


def _up_faults(joint: JointDraft) -> Iterator[str]:
    """Faults of the direction `up` of a joint."""
    key, entry, kind, up = joint.key, joint.entry, joint.entry.type, joint.entry.up
    numbers = [table for table in (entry.stiffness, entry.damping) if table is not None]
    directed = bool(numbers) or entry.guide is not None
    unequal = [
        (first, second)
        for first, second in NEED_UP.get(kind, ())
        if any(table.get(first) != table.get(second) for table in numbers)
    ]
    if up is None:
        for first, second in unequal[:1]:
            yield (
                f"{key}.up: missing; must be the direction of the "
                f"{'normal' if kind == 'prismatic' else 'axis'}, because {first} and {second} "
                "differ"
            )
        return
    axis = joint.vector if joint.vector is not None else next(iter(joint.directions), None)
    if kind not in NEED_UP:
        yield f"{key}.up: does not belong to a {kind} joint, which is equal all around its axis"
    elif not directed:
        yield (
            f"{key}.up: must be left out without {key}.stiffness or {key}.damping, whose "
            "directions it gives"
        )
    elif np.linalg.norm(up) < NO_DIRECTION:
        yield f"{key}.up = {list(up)}: must not be zero, it is a direction"
    elif kind == "prismatic" and axis is not None and are_parallel(up, axis, _ALONG_SLIDE):
        yield f"{key}.up = {list(up)}: must be a direction that does not lie along the slide"


def _drive_faults(drive: DriveEntry, key: str, kind: JointKind) -> Iterator[str]:
    """Faults of a drive: wrong kind of joint, missing stiffness, and keys without effect."""
    if FREEDOMS[kind] != 1:
        yield (
            f"{key}: a {kind} joint has {FREEDOMS[kind] or 'no'} free motions; "
            "must be a revolute or a prismatic one"
        )
    if drive.screw is not None:
        yield from _screw_faults(drive, drive.screw, f"{key}.screw", kind)
    elif drive.stiffness is None:
        yield f'{key}.stiffness: missing; must be a number in N/m or N m/rad, or "rigid"'
    if drive.ratio is not None and drive.inertia is None:
        yield f"{key}.ratio: must be left out without `inertia`, which it multiplies"
    rigid = drive.stiffness == "rigid" and drive.simplified is None
    if rigid and drive.inertia is not None:
        yield (
            f"{key}.inertia: the rotor of a rigid drive stands still; "
            "must be left out, or the drive be given a stiffness"
        )
    if rigid and drive.damping:
        yield (
            f"{key}.damping: a rigid drive does not move; must be left out, or the drive be given "
            "a stiffness"
        )


def _screw_faults(drive: DriveEntry, screw: ScrewEntry, key: str, kind: str) -> Iterator[str]:
    """Faults of a ball screw."""
    if drive.stiffness is not None:
        yield f"{key}: must be left out if a stiffness is given, which it determines"
    if kind != "prismatic":
        yield f"{key}: does not belong to a {kind} joint; must be a prismatic one"
    if screw.span is not None and screw.span <= screw.length:
        yield f"{key}.span: must be above {key}.length, the length to the nut"
    nut = screw.nut
    if isinstance(nut, NutEntry):
        yield from _nut_faults(nut, f"{key}.nut")
        if nut.size is not None:
            if screw.diameter is not None:
                yield f"{key}.diameter: must be left out, because {key}.nut.size determines it"
            return
    if screw.diameter is None:
        yield f"{key}.diameter: missing; must be given, or {key}.nut.size"


def _nut_faults(nut: NutEntry, key: str) -> Iterator[str]:
    """Faults of the nut of a ball screw."""
    yield from _catalogue_faults(nut, key, ("rigidity", "load_rating"), ("share",))
    load_keys = specified_keys(nut, "preload", "load")
    if len(load_keys) != 1:
        reason = "has preload and load" if load_keys else "has no load"
        yield f"{key}: {reason}; must have one of preload, load (with play)"
    elif nut.size is not None:
        required, kind = ("load", "has play") if has_play(nut.size) else ("preload", "is preloaded")
        if required not in load_keys:
            yield f"{key}.{load_keys[0]}: {nut.size} {kind}; must be {key}.{required}"
    rating = nut.load_rating if nut.size is None else nut_of_size(nut.size).load_rating
    # Under Ca the rated life of a nut is 1e6 revolutions. Tables give K under at most 0.1 Ca.
    if rating is not None and nut.preload is not None and nut.preload > rating:
        yield f"{key}.preload = {shown(nut.preload)}: must be at most the load rating, {rating:g} N"
