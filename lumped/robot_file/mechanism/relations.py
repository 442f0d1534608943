"""Rules for the relations between the keys of one entry of a robot file.

Each fault is a line that begins with the key.
"""

from collections.abc import Iterator, Sequence
from math import pi, prod
from typing import Any, get_args

import numpy as np

from lumped.mechanism.catalogue.ball_guide import PreloadClass
from lumped.mechanism.catalogue.ball_nut import has_play, nut_of_size
from lumped.mechanism.catalogue.directions import DIRECTIONS, NEED_UP
from lumped.mechanism.joint import FREEDOMS, SMALLEST_SINE, JointKind
from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.mechanism.mechanism import GROUND, Tool
from lumped.robot_file.mechanism.draft import BodyDraft, JointDraft, LegDraft
from lumped.robot_file.mechanism.rolling import bearing_preload_faults, guide_preload_faults
from lumped.robot_file.rules.rule import NO_DIRECTION, field_of, too_many
from lumped.robot_file.rules.tables.bodies import BODY, BodyEntry, InterfaceEntry
from lumped.robot_file.rules.tables.joints import (
    AlongDirections,
    BearingEntry,
    DriveEntry,
    GuideEntry,
    NutEntry,
    ScrewEntry,
)
from lumped.robot_file.rules.tables.requests import PressureEntry
from lumped.robot_file.rules.tables.robots import PathEntry
from lumped.robot_file.rules.tables.sections import (
    CompositeParts,
    LaminateWall,
    MaterialEntry,
    OwnMaterials,
)
from lumped.robot_file.rules.tables.values import MOST_POSES
from lumped.sections import Composite, Polygon
from lumped.text import counted, shown

# Distance (m) below which two points of a leg coincide.
_TOGETHER = 1e-6
# Sine of the angle below which a leg's z axis is parallel to its x axis.
_ALONG_LEG = 1e-6
# Smallest ratio of the deflection c66 L²/3 of a leg of length L under 1 N, estimated from its tip
# rotation c66 under 1 N m, to its actual deflection. Metres typed as millimetres reduce the ratio
# by 1e-6. No leg shears, or yields at its root, a thousand times more than it bends.
_SMALLEST_BENDING_SHARE = 1e-3
# Kinds of joints whose two points may be apart along the axis.
_EXTENDED = ("prismatic", "cylindrical")


def leg_faults(leg: LegDraft) -> Iterator[str]:
    """Faults of a leg of schema 1 or 2."""
    key, entry, length, unit = leg.key, leg.entry, leg.length, leg.unit
    mass, material, compliance = entry.mass, leg.material, entry.compliance
    if isinstance(leg.section, CompositeParts | LaminateWall):
        yield from _own_material_faults(leg, leg.section)
        return
    present_keys = _present_keys(entry, "compliance", "section", "sections", "material")
    if present_keys not in (["compliance"], ["section", "material"], ["sections", "material"]):
        reason = (
            f"has {' and '.join(present_keys)}"
            if present_keys
            else "neither compliance nor section"
        )
        yield f"{key}: {reason}; must have either compliance and mass, or section and material"
    elif entry.ends is not None and compliance is not None:
        yield f"{key}.ends: must be left out, because {key}.compliance includes the ends"
    elif entry.loss is not None and entry.material is not None:
        yield f"{key}.loss: must be left out, because {key}.material has a loss factor"
    if mass == 0.0:
        yield f"{key}.mass = 0.0: must be above 0 kg for a leg"
    elif compliance is not None:
        if mass is None:
            yield f"{key}.mass: missing; must be given with {key}.compliance, a number above 0 kg"
    elif material is not None and (material.rho is None) == (mass is None):
        density = f"{leg.material_key}.rho"
        yield (
            f"{density}: missing; must be a density in kg/m³, unless {key}.mass in kg is given"
            if mass is None
            else f"{key}.mass and {density}: both given; must be only one, the mass (kg) follows "
            "from the density (kg/m³)"
        )
    if length is None or length < _TOGETHER:
        return
    yield from _size_faults(leg.section, length, key, unit)
    if compliance is None:
        return
    for i, j in ((2, 6), (3, 5)):
        deflection, rotation = float(compliance[i - 1, i - 1]), float(compliance[j - 1, j - 1])
        if deflection > (largest := rotation * length**2 / _SMALLEST_BENDING_SHARE):
            yield (
                f"{key}.compliance[{i},{i}] = {deflection!r}: must be at most {largest:.3g} m/N "
                f"beside [{j},{j}] = {rotation!r} rad/(N m) and a length of "
                f"{unit.shown(length)}; "
                "is this in mm/N and rad/(N mm)?"
            )


def _own_material_faults(leg: LegDraft, section: OwnMaterials) -> Iterator[str]:
    """Faults of a leg with a composite or laminate section, which defines its own materials."""
    key, length = leg.key, leg.length
    reasons = {
        "compliance": "does not belong to a leg with a section",
        "material": "must be left out, because parts or layers of the section have materials",
        "mass": "must be left out, because the materials of the section have densities",
    }
    for name in _present_keys(leg.entry, *reasons):
        yield f"{key}.{name}: {reasons[name]}"
    faults = list(section.material_faults(f"{key}.section"))
    yield from faults
    if not faults and length is not None and length >= _TOGETHER:
        yield from _size_faults(section.section, length, key, leg.unit)


def _doubt(unit: UnitOfLength) -> str:
    """Question to the user, for messages about lengths that are too large for `unit`."""
    return "is this in mm?" if unit == METRE else "is this in µm?"


def _size_faults(section: Any, length: float, key: str, unit: UnitOfLength) -> Iterator[str]:
    """Faults of a section that is larger than the length (m) of its leg at `key`."""
    outlined = isinstance(section, Polygon | Composite)
    name = "parts" if isinstance(section, Composite) else "outline"
    if outlined and (largest := max(section.extent)) >= length:
        yield (
            f"{key}.section.{name}: {unit.shown(largest)} from side to side; must be below the "
            f"leg's length, {unit.shown(length)}; {_doubt(unit)}"
        )
    for name in ("width", "height", "diameter"):
        if (size := getattr(section, name, 0.0)) >= length:
            yield (
                f"{key}.section.{name} = {unit.of(size)!r}: must be below the leg's length, "
                f"{unit.shown(length)}; {_doubt(unit)}"
            )


def body_faults(body: BodyDraft) -> Iterator[str]:
    """Faults of a body of schema 2: a leg, a rigid body or a part."""
    key, kind = body.key, body.kind
    if key == f"bodies.{GROUND}":
        yield f"{key}: ground is the name of the base; must have another name"
    if kind is None:
        yield (
            f"{key}: must be a leg (from and to), a rigid body (points) or a part (step or mesh), "
            "and only one of them"
        )
        return
    allowed_keys = [name for name, rule in BODY.keys.items() if kind in rule.owners]
    for name in _present_keys(body.entry, *BODY.keys):
        if name not in allowed_keys:
            names = ", ".join(allowed_keys)
            yield f"{key}.{name}: does not belong to a {kind}; its keys are {names}"
    match kind:
        case "leg":
            yield from _placed_leg(body)
        case "rigid body":
            yield from _rigid_body(body.entry, key)
        case "part":
            yield from _part(body)


def _placed_leg(leg: BodyDraft) -> Iterator[str]:
    key, entry, length, up = leg.key, leg.entry, leg.length, leg.entry.up
    for end in ("from", "to"):
        if not _present_keys(entry, end):
            yield f"{key}.{end}: missing; must be the name of a point"
    if length is not None and length < _TOGETHER:
        yield (
            f'{key}.to = "{entry.to}": must be apart from "{entry.from_}", where the leg begins '
            f"(they are {leg.unit.shown(length, 3)} apart)"
        )
    elif length is not None and up is not None and _parallel(up, leg.vector, _ALONG_LEG):
        yield f"{key}.up = {list(up)}: must be a direction that does not lie along the leg"
    yield from leg_faults(leg)
    if leg.line is not None:
        yield from leg.line.faults


def _rigid_body(body: BodyEntry, key: str) -> Iterator[str]:
    points = body.points or ()
    if not points:
        yield f"{key}.points = []: must name at least one point"
    yield from named_twice(points, f"{key}.points[{{}}]")
    if body.mass and body.centre is None:
        yield f"{key}.centre: missing; must be a point's name or [x, y, z], given with {key}.mass"
    for name in () if body.mass else _present_keys(body, "centre", "inertia"):
        yield f"{key}.mass: missing; must be above 0 kg, given with {key}.{name}"


def _part(body: BodyDraft) -> Iterator[str]:
    part, key = body.entry, body.key
    if part.step and part.mesh:
        yield f"{key}.mesh: given with {key}.step; a part is read from one file"
    if part.material is None:
        yield f"{key}.material: missing; must be a name of [materials] or a table"
    if body.material is not None:
        yield from material_faults(body.material, f"{key}.material.")
    if not part.interfaces:
        yield f"{key}.interfaces: missing; must name the points at which the part is held"
    for point, interface in (part.interfaces or {}).items():
        interface_key = f"{key}.interfaces.{point}"
        yield from interface_faults(interface, interface_key)
        if interface.point is not None:
            yield (
                f"{interface_key}.point: does not belong here; the reference point is that of "
                "[points]"
            )
    placement = part.place
    if placement and _parallel(placement.x, placement.y, 0.0):
        yield f"{key}.place.y = {list(placement.y)}: must not lie along {key}.place.x"


def material_faults(material: MaterialEntry, path: str) -> Iterator[str]:
    """Faults of the material of a part. `path` (such as "materials.steel.") precedes each key."""
    if material.rho is None:
        yield f"{path}rho: missing; a part's mass follows from its density"
    if material.G is not None:
        yield f"{path}G: does not belong to a part; its material is isotropic"


def interface_faults(entry: InterfaceEntry | PressureEntry, key: str) -> Iterator[str]:
    """Fault of an entry that does not select faces by exactly one key.

    The keys that select faces are `faces`, `name`, `cylinder` and `plane`.
    """
    choices = ("faces", "name", "cylinder", "plane")
    present_keys = _present_keys(entry, *choices)
    if len(present_keys) != 1:
        reason = f"has {' and '.join(present_keys)}" if present_keys else "does not specify faces"
        yield f"{key}: {reason}; must have one of {', '.join(choices)}"


def joint_faults(joint: JointDraft) -> Iterator[str]:
    """Faults of a joint of schema 2."""
    key, entry, kind, points = joint.key, joint.entry, joint.entry.type, joint.entry.at
    first, second = entry.between
    if first == second:
        yield f'{key}.between: "{first}" twice; must be two different bodies'
    if entry.loss and not _present_keys(entry, "compliance", "stiffness", "bearing", "guide"):
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
    for name in _present_keys(entry, "axis", "axes"):
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
    if len(directions) == 2 and _parallel(directions[0], directions[1], SMALLEST_SINE):
        yield (
            f"{key}.axes = {list(map(list, directions))}: must not be parallel; "
            "a universal joint turns about two directions"
        )
    if slide is not None and directions and not _parallel(directions[0], slide, SMALLEST_SINE):
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
        elastic = _present_keys(entry, "compliance", "bearing", "guide")
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


def _guide_faults(joint: JointDraft, guide: GuideEntry) -> Iterator[str]:
    """Faults of a profile rail guide."""
    key, entry = f"{joint.key}.guide", joint.entry
    if entry.type != "prismatic":
        yield f"{key}: does not belong to a {entry.type} joint; must be a prismatic one"
    for name in _present_keys(entry, "compliance", "stiffness"):
        yield f"{key}: must be left out if {joint.key}.{name} is given, which it determines"
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
    if entry.up is None:
        yield f"{joint.key}.up: missing; must be the direction of the normal of {key}"


def _bearing_faults(joint: JointDraft, bearing: BearingEntry) -> Iterator[str]:
    """Faults of a ball bearing."""
    key, entry = f"{joint.key}.bearing", joint.entry
    if entry.type != "revolute":
        yield f"{key}: does not belong to a {entry.type} joint; must be a revolute one"
    for name in _present_keys(entry, "compliance", "stiffness"):
        yield f"{key}: must be left out if {joint.key}.{name} is given, which it determines"
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
        for name in _present_keys(entry, *required, *optional):
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
    elif kind == "prismatic" and axis is not None and _parallel(up, axis, _ALONG_LEG):
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
        yield f"{key}.span: must be above the length to the nut"
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
    load_keys = _present_keys(nut, "preload", "load")
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


def tool_faults(tool: Tool) -> Iterator[str]:
    """Faults of the table [tool]."""
    if tool.body == GROUND:
        yield f'tool.body = "{GROUND}": must be a body that moves'
    yield from named_twice(tool.moves, "tool.moves[{}]")


def path_faults(path: PathEntry, moves: Sequence[str]) -> Iterator[str]:
    """Faults of the table [path] for the `moves` of the tool."""
    present_keys = _present_keys(path, "from", "to", "count", "counts")
    if path.poses is not None:
        yield from (
            f"path.{name}: must be left out, because path.poses is given" for name in present_keys
        )
        if not path.poses:
            yield "path.poses = []: must hold at least one pose"
        lists = {f"poses[{i}]": pose for i, pose in enumerate(path.poses, start=1)}
    else:
        for name in ("from", "to"):
            if name not in present_keys:
                numbers = f"{counted(len(moves), 'number')} ({', '.join(moves)})"
                yield f"path.{name}: missing; must be a pose, {numbers}"
        if (path.count is None) == (path.counts is None):
            yield (
                "path.count: must be given for a line (how many poses), or path.counts for a grid "
                "(how many along each move), and only one of them"
            )
        poses = prod(path.counts or ())
        if poses > MOST_POSES:
            yield too_many(f"path.counts = {list(path.counts or ())}", poses, MOST_POSES)
        lists = {
            name: values
            for name, values in (("from", path.from_), ("to", path.to), ("counts", path.counts))
            if values is not None
        }
    required = (
        f"one for each of tool.moves ({', '.join(moves)})" if moves else "none: no tool.moves"
    )
    for name, values in lists.items():
        if len(values) != len(moves):
            yield f"path.{name}: {counted(len(values), 'number')}; must be {len(moves)}, {required}"


def _present_keys(entry: object, *names: str) -> list[str]:
    """Keys among `names` that have a value in `entry`."""
    return [name for name in names if getattr(entry, field_of(name), None) is not None]


def named_twice(names: Sequence[str], key: str) -> Iterator[str]:
    """Faults of names that are listed twice.

    `key` is the location of a name, in which its number (from 1) replaces {}.
    """
    for i, name in enumerate(names):
        if name in names[:i]:
            yield f"{key.format(i + 1)} = {shown(name)}: named twice"


def _parallel(first: object, second: object, sine: float) -> bool:
    """True if two directions (3 each) are parallel, or one is zero.

    `sine` is the sine of the largest angle between directions that count as parallel.
    """
    a, b = np.array(first, dtype=float), np.array(second, dtype=float)
    return bool(np.linalg.norm(np.cross(a, b)) <= sine * np.linalg.norm(a) * np.linalg.norm(b))
