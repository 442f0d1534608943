"""What the keys of [bodies] must say together: legs, rigid bodies, parts, and their points."""

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
import numpy as np

from lumped.errors import InputError
from lumped.mechanism.mechanism import GROUND
from lumped.mechanism.placing import leg_frame
from lumped.robot_file.leg_table import leg_faults
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.mechanism.part_tables import choice_faults
from lumped.robot_file.mechanism.tables import BodyTable
from lumped.robot_file.tables import MaterialTable

# Which keys belong to which description of a body.
KEYS = {
    "leg": (
        "from",
        "to",
        "up",
        "section",
        "material",
        "mass",
        "compliance",
        "ends",
        "mass_centre",
        "inertia",
    ),
    "rigid body": ("points", "mass", "centre", "inertia"),
    "part": ("step", "mesh", "unit", "place", "material", "interfaces"),
}
_TELLING = {"from": "leg", "to": "leg", "points": "rigid body", "step": "part", "mesh": "part"}
# Distance (m) below which two points of a leg are one.
_TOGETHER = 1e-6


def body_faults(draft: Draft) -> list[str]:
    """Faults of all bodies, each line starting with its key."""
    faults = [fault for name in draft.bodies for fault in _faults(draft, name)]
    if GROUND in draft.names["bodies"]:
        faults.append(
            f"bodies.{GROUND}: the base, on which the joints stand; must have another name"
        )
    return faults


def kind_of(body: BodyTable) -> str | None:
    """Which description of a body its keys begin; None where they begin none or several."""
    kinds = {_TELLING[key] for key in _given(body) if key in _TELLING}
    return kinds.pop() if len(kinds) == 1 else None


def leg_length(draft: Draft, body: BodyTable) -> float | None:
    """Distance (m) of a leg's two points, where both are known."""
    start, to = (draft.points.get(point or "") for point in (body.start, body.to))
    return None if start is None or to is None else float(np.linalg.norm(to - start))


def material_of(draft: Draft, body: BodyTable) -> MaterialTable | None:
    """The material of a body, its own or by name; None where there is none or it has faults."""
    if isinstance(body.material, str):
        return draft.materials.get(body.material)
    return body.material


def _given(body: BodyTable) -> Mapping[str, Any]:
    """The keys that a file gives, as it spells them."""
    table = msgspec.to_builtins(body)
    return {key: value for key, value in table.items() if value is not None}


def _faults(draft: Draft, name: str) -> Iterator[str]:
    body, key = draft.bodies[name], f"bodies.{name}"
    kind = kind_of(body)
    if kind is None:
        yield (
            f"{key}: must be a leg (from and to), a rigid body (points) or a part (step or mesh), "
            "and only one of them"
        )
        return
    yield from (
        f"{key}.{other}: does not belong to a {kind}; its keys are {', '.join(KEYS[kind])}"
        for other in _given(body)
        if other not in KEYS[kind]
    )
    if isinstance(body.material, str):
        yield from draft.unknown(f"{key}.material", body.material, "materials")
    match kind:
        case "leg":
            yield from _leg_faults(draft, body, key)
        case "rigid body":
            yield from _rigid_faults(draft, body, key)
        case "part":
            yield from _part_faults(draft, body, key)


def _leg_faults(draft: Draft, body: BodyTable, key: str) -> Iterator[str]:
    for end, point in (("from", body.start), ("to", body.to)):
        if point is None:
            yield f"{key}.{end}: missing; must be the name of a point"
        else:
            yield from draft.unknown(f"{key}.{end}", point, "points")
    length = leg_length(draft, body)
    if length is not None and length < _TOGETHER:
        yield (
            f'{key}.to = "{body.to}": must be apart from "{body.start}", where the leg begins '
            f"(they are {length:.3g} m apart)"
        )
        return
    if length is not None:
        yield from _up_faults(draft, body, key)
    if body.mass == 0.0:
        yield f"{key}.mass = 0.0: must be above 0 kg for a leg"
    material = material_of(draft, body)
    described = {k: v for k, v in _given(body).items() if k in KEYS["leg"]} | {"length": length}
    named = isinstance(body.material, str)
    if material is not None:
        described["material"] = msgspec.to_builtins(material)
        described["material"] = {k: v for k, v in described["material"].items() if v is not None}
    yield from leg_faults(described, key, f"materials.{body.material}.rho" if named else "")


def _up_faults(draft: Draft, body: BodyTable, key: str) -> Iterator[str]:
    if body.up is None or body.start is None or body.to is None:
        return
    try:
        leg_frame(draft.points[body.start], draft.points[body.to], np.array(body.up, dtype=float))
    except InputError:
        yield f"{key}.up = {list(body.up)}: must be a direction that does not lie along the leg"


def _rigid_faults(draft: Draft, body: BodyTable, key: str) -> Iterator[str]:
    points = body.points or []
    if not points:
        yield f"{key}.points = []: must name at least one point"
    for i, point in enumerate(points, start=1):
        yield from draft.unknown(f"{key}.points[{i}]", point, "points")
        if point in points[: i - 1]:
            yield f'{key}.points[{i}] = "{point}": named twice'
    if isinstance(body.centre, str):
        yield from draft.unknown(f"{key}.centre", body.centre, "points")
    if body.mass and body.centre is None:
        yield f"{key}.centre: missing; must be a point's name or [x, y, z], given with {key}.mass"
    for other in ("centre", "inertia"):
        if getattr(body, other) is not None and not body.mass:
            yield f"{key}.mass: missing; must be above 0 kg, given with {key}.{other}"


def _part_faults(draft: Draft, body: BodyTable, key: str) -> Iterator[str]:
    if body.step and body.mesh:
        yield f"{key}.mesh: given with {key}.step; a part is read from one file"
    material = material_of(draft, body)
    if body.material is None:
        yield f"{key}.material: missing; must be a name of [materials] or a table"
    if material is not None and material.rho is None:
        yield f"{key}.material.rho: missing; a part's mass follows from its density"
    if material is not None and material.G is not None:
        yield f"{key}.material.G: does not belong to a part; its material is isotropic"
    if not body.interfaces:
        yield f"{key}.interfaces: missing; must name the points at which the part is held"
    for point, interface in (body.interfaces or {}).items():
        own = f"{key}.interfaces.{point}"
        yield from draft.unknown(own, point, "points")
        yield from choice_faults(interface, own)
        if interface.point is not None:
            yield f"{own}.point: does not belong here; the reference point is that of [points]"
    place = body.place
    if place is not None:
        if isinstance(place.at, str):
            yield from draft.unknown(f"{key}.place.at", place.at, "points")
        if np.linalg.norm(np.cross(place.x, place.y)) == 0.0:
            yield f"{key}.place.y = {list(place.y)}: must not lie along {key}.place.x"
