"""Rules for the relations between the keys of a leg, a body, the tool or the path of a robot file.

Each fault is a line that begins with the key. `joint_relations` has the rules for joints.
"""

from collections.abc import Iterator, Sequence
from math import prod
from typing import Any

import numpy as np

from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.mechanism.mechanism import GROUND, Tool
from lumped.robot_file.mechanism.draft import BodyDraft, LegDraft
from lumped.robot_file.rules.rule import field_of, too_many
from lumped.robot_file.rules.tables.bodies import BODY, BodyEntry, InterfaceEntry
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


def leg_faults(leg: LegDraft) -> Iterator[str]:
    """Faults of a leg of schema 1 or 2."""
    key, entry, length, unit = leg.key, leg.entry, leg.length, leg.unit
    mass, material, compliance = entry.mass, leg.material, entry.compliance
    if isinstance(leg.section, CompositeParts | LaminateWall):
        yield from _own_material_faults(leg, leg.section)
        return
    present_keys = specified_keys(entry, "compliance", "section", "sections", "material")
    if present_keys not in (["compliance"], ["section", "material"], ["sections", "material"]):
        reason = (
            f"has {' and '.join(present_keys)}"
            if present_keys
            else "neither compliance nor section"
        )
        section = "one of section and sections" if "sections" in present_keys else "section"
        yield f"{key}: {reason}; must have either compliance and mass, or {section} and material"
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
    for name in specified_keys(leg.entry, *reasons):
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
    for name in specified_keys(body.entry, *BODY.keys):
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
        if not specified_keys(entry, end):
            yield f"{key}.{end}: missing; must be the name of a point"
    if length is not None and length < _TOGETHER:
        yield (
            f'{key}.to = "{entry.to}": must be apart from "{entry.from_}", where the leg begins '
            f"(they are {leg.unit.shown(length, 3)} apart)"
        )
    elif length is not None and up is not None and are_parallel(up, leg.vector, _ALONG_LEG):
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
    for name in () if body.mass else specified_keys(body, "centre", "inertia"):
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
    if placement and are_parallel(placement.x, placement.y, 0.0):
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
    present_keys = specified_keys(entry, *choices)
    if len(present_keys) != 1:
        reason = f"has {' and '.join(present_keys)}" if present_keys else "does not specify faces"
        yield f"{key}: {reason}; must have one of {', '.join(choices)}"


def tool_faults(tool: Tool) -> Iterator[str]:
    """Faults of the table [tool]."""
    if tool.body == GROUND:
        yield f'tool.body = "{GROUND}": must be a body that moves'
    yield from named_twice(tool.moves, "tool.moves[{}]")


def path_faults(path: PathEntry, moves: Sequence[str]) -> Iterator[str]:
    """Faults of the table [path] for the `moves` of the tool."""
    present_keys = specified_keys(path, "from", "to", "count", "counts")
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


def specified_keys(entry: object, *names: str) -> list[str]:
    """Keys among `names` that have a value in `entry`."""
    return [name for name in names if getattr(entry, field_of(name), None) is not None]


def named_twice(names: Sequence[str], key: str) -> Iterator[str]:
    """Faults of names that are listed twice.

    `key` is the location of a name, in which its number (from 1) replaces {}.
    """
    for i, name in enumerate(names):
        if name in names[:i]:
            yield f"{key.format(i + 1)} = {shown(name)}: named twice"


def are_parallel(first: object, second: object, sine: float) -> bool:
    """True if two directions (3 each) are parallel, or one is zero.

    `sine` is the sine of the largest angle between directions that count as parallel.
    """
    a, b = np.array(first, dtype=float), np.array(second, dtype=float)
    return bool(np.linalg.norm(np.cross(a, b)) <= sine * np.linalg.norm(a) * np.linalg.norm(b))
