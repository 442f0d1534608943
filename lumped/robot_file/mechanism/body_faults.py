"""What the keys of [bodies] must say together: legs, rigid bodies, parts, and their points."""

from collections.abc import Iterator, Mapping

import numpy as np

from lumped.errors import InputError
from lumped.mechanism.mechanism import GROUND
from lumped.mechanism.placing import leg_frame
from lumped.robot_file.leg_table import leg_faults
from lumped.robot_file.mechanism.draft import Draft, Entry
from lumped.robot_file.mechanism.part_tables import choice_faults, material_faults
from lumped.robot_file.rules.tables import BODY

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


def kind_of(body: Entry) -> str | None:
    """Which description of a body its keys begin; None where they begin none or several."""
    kinds = {kind for key, kind in _TELLING.items() if body[key] is not None}
    return kinds.pop() if len(kinds) == 1 else None


def leg_length(draft: Draft, body: Entry) -> float | None:
    """Distance (m) of a leg's two points, where both are known."""
    start, to = (draft.points.get(body[end]) for end in ("from", "to"))
    return None if start is None or to is None else float(np.linalg.norm(to - start))


def with_material(draft: Draft, body: Entry) -> Entry:
    """The body with its material as a table where it is named, and sound."""
    named = draft.materials.get(body["material"]) if isinstance(body["material"], str) else None
    return body if named is None else {**body, "material": named}


def _faults(draft: Draft, name: str) -> Iterator[str]:
    body, key = draft.bodies[name], f"bodies.{name}"
    kind = kind_of(body)
    if kind is None:
        yield (
            f"{key}: must be a leg (from and to), a rigid body (points) or a part (step or mesh), "
            "and only one of them"
        )
        return
    own = [other for other in BODY.keys if kind in BODY.keys[other].of]
    yield from (
        f"{key}.{other}: does not belong to a {kind}; its keys are {', '.join(own)}"
        for other, value in body.items()
        if value is not None and other not in own
    )
    if isinstance(body["material"], str):
        yield from draft.unknown(f"{key}.material", body["material"], "materials")
    checks = {"leg": _leg_faults, "rigid body": _rigid_faults, "part": _part_faults}
    yield from checks[kind](draft, body, key)


def _leg_faults(draft: Draft, body: Entry, key: str) -> Iterator[str]:
    for end in ("from", "to"):
        if body[end] is None:
            yield f"{key}.{end}: missing; must be the name of a point"
        else:
            yield from draft.unknown(f"{key}.{end}", body[end], "points")
    length = leg_length(draft, body)
    if length is not None and length < _TOGETHER:
        yield (
            f'{key}.to = "{body["to"]}": must be apart from "{body["from"]}", where the leg begins '
            f"(they are {length:.3g} m apart)"
        )
        return
    if length is not None and body["up"] is not None:
        try:
            leg_frame(draft.points[body["from"]], draft.points[body["to"]], np.array(body["up"]))
        except InputError:
            up = list(body["up"])
            yield f"{key}.up = {up}: must be a direction that does not lie along the leg"
    named = isinstance(body["material"], str)
    place = f"materials.{body['material']}" if named else ""
    yield from leg_faults(with_material(draft, body), length, key, place)


def _rigid_faults(draft: Draft, body: Entry, key: str) -> Iterator[str]:
    points = body["points"]
    if not points:
        yield f"{key}.points = []: must name at least one point"
    for i, point in enumerate(points, start=1):
        yield from draft.unknown(f"{key}.points[{i}]", point, "points")
        if point in points[: i - 1]:
            yield f'{key}.points[{i}] = "{point}": named twice'
    if isinstance(body["centre"], str):
        yield from draft.unknown(f"{key}.centre", body["centre"], "points")
    if body["mass"] and body["centre"] is None:
        yield f"{key}.centre: missing; must be a point's name or [x, y, z], given with {key}.mass"
    for other in ("centre", "inertia"):
        if body[other] is not None and not body["mass"]:
            yield f"{key}.mass: missing; must be above 0 kg, given with {key}.{other}"


def _part_faults(draft: Draft, body: Entry, key: str) -> Iterator[str]:
    if body["step"] and body["mesh"]:
        yield f"{key}.mesh: given with {key}.step; a part is read from one file"
    material = with_material(draft, body)["material"]
    if material is None:
        yield f"{key}.material: missing; must be a name of [materials] or a table"
    if isinstance(material, Mapping):
        yield from material_faults(material, f"{key}.material.")
    if not body["interfaces"]:
        yield f"{key}.interfaces: missing; must name the points at which the part is held"
    for point, interface in (body["interfaces"] or {}).items():
        own = f"{key}.interfaces.{point}"
        yield from draft.unknown(own, point, "points")
        yield from choice_faults(interface, own)
        if interface["point"] is not None:
            yield f"{own}.point: does not belong here; the reference point is that of [points]"
    place = body["place"]
    if place is not None:
        if isinstance(place["at"], str):
            yield from draft.unknown(f"{key}.place.at", place["at"], "points")
        if np.linalg.norm(np.cross(place["x"], place["y"])) == 0.0:
            yield f"{key}.place.y = {list(place['y'])}: must not lie along {key}.place.x"
