"""Interfaces of a part: from what was said of them to faces, a reference point and a coupling."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.body import (
    ByCylinder,
    ByFaces,
    ByName,
    ByPlane,
    Coupling,
    PartInterface,
)
from meshes.part.faces import Face
from meshes.part.reading.read import PartFile

DEFAULT_COUPLING: Coupling = "rigid"
WHY_RIGID = (
    "rigid by default: the pin, bearing or bolted joint in it is taken as much stiffer than the "
    "part; that is the bound from above, and the distance to the averaged interface, the bound "
    "from below, is part of the uncertainty"
)
# Radii and places as people copy them from drawings; a tolerance of their own overrides it.
_RADIUS, _PLACE = 1e-3, 1e-3
# Cosine of the angle up to which two directions are one: half a degree.
_SAME_DIRECTION = float(np.cos(np.radians(0.5)))


@dataclass(frozen=True, eq=False)
class Interface:
    """Where others take hold of a part: `faces` of it, its reference `point` (3, m, file axes).

    `axis` (unit vector) of the cylinder that the faces form, through `on_axis` (3, m); both None
    where they form none. `because`: why the coupling is what it is.
    """

    name: str
    faces: tuple[int, ...]
    point: Array
    coupling: Coupling
    because: str
    axis: Array | None
    on_axis: Array | None
    area: float


def find_interfaces(
    part: PartFile, wanted: Mapping[str, PartInterface], points: Mapping[str, Array] | None = None
) -> tuple[Interface, ...]:
    """The interfaces `wanted` of a part, in their order.

    `points` (m, file axes) are the reference points by name; where one is missing it lies in the
    middle of a cylinder's axis, else in the centre of the faces' area. Raises InputError, all
    faults at once, each with the nearest face that might have been meant.
    """
    found, faults = [], []
    for name, interface in wanted.items():
        place = None if points is None else points.get(name)
        try:
            found.append(_interface(part, name, interface, place))
        except InputError as error:
            faults += [f"{part.path}: interface {name}: {fault}" for fault in error.faults]
    if not wanted:
        faults.append(f"{part.path}: no interface is given; a part needs one or more")
    faults += [f"{part.path}: {fault}" for fault in _shared(part, found)]
    if faults:
        raise InputError(faults)
    return tuple(found)


def _interface(part: PartFile, name: str, wanted: PartInterface, place: Array | None) -> Interface:
    chosen = _chosen(part, wanted, place)
    axis = _common_axis(chosen)
    areas = np.array([face.area for face in chosen])
    if place is None:
        centres = [face.on_axis if axis is not None else face.centre for face in chosen]
        place = areas @ np.array(centres) / areas.sum()
    coupling = wanted.coupling or DEFAULT_COUPLING
    if coupling == "pin" and axis is None:
        kinds = ", ".join(f"{face.number} ({face.kind})" for face in chosen)
        raise InputError(
            f'coupling = "pin" suits a bore alone, and the faces {kinds} form no cylinder; '
            'take "rigid" or "average"'
        )
    because = "as asked for" if wanted.coupling else WHY_RIGID
    numbers = tuple(face.number for face in chosen)
    on_axis = None if axis is None else chosen[0].on_axis
    total = float(areas.sum())
    return Interface(name, numbers, place, coupling, because, axis, on_axis, total)


def _chosen(part: PartFile, wanted: PartInterface, place: Array | None) -> list[Face]:
    match wanted.selection:
        case ByFaces(faces):
            return _numbered(part.faces, faces)
        case ByName(name):
            return _called(part, name)
        case ByCylinder():
            return _on_cylinder(part.faces, wanted.selection, place)
        case ByPlane():
            return _in_plane(part.faces, wanted.selection, place)


def _numbered(faces: Sequence[Face], numbers: tuple[int, ...]) -> list[Face]:
    by_number = {face.number: face for face in faces}
    unknown = [number for number in numbers if number not in by_number]
    if unknown or not numbers:
        asked = f"face {unknown[0]} does not exist" if unknown else "no face is given"
        raise InputError(f"{asked}; its faces are numbered {min(by_number)} to {max(by_number)}")
    return [by_number[number] for number in sorted(set(numbers))]


def _called(part: PartFile, name: str) -> list[Face]:
    chosen = [face for face in part.faces if face.name == name]
    if chosen:
        return chosen
    if part.mesh is not None and name in part.mesh.bare:
        raise InputError(
            f'the set "{name}" holds no whole facet of the surface; an interface is a '
            "face, not single nodes"
        )
    names = sorted({face.name for face in part.faces if face.name})
    close = get_close_matches(name, names, n=1)
    known = f"the named ones are {', '.join(names)}" if names else "the file names none"
    advice = f'did you mean "{close[0]}"?' if close else known
    raise InputError(f'no face is called "{name}"; {advice}')


def _on_cylinder(faces: Sequence[Face], wanted: ByCylinder, place: Array | None) -> list[Face]:
    slack = _RADIUS * wanted.radius if wanted.tolerance is None else wanted.tolerance
    round_faces = [face for face in faces if face.kind in ("bore", "boss")]
    if not round_faces:
        raise InputError("the part has no cylindrical face; choose by number (see flexproof faces)")
    fitting = [f for f in round_faces if abs(f.radius - wanted.radius) <= slack]
    if not fitting:
        nearest = min(round_faces, key=lambda f: abs(f.radius - wanted.radius))
        raise InputError(
            f"no cylinder of radius {wanted.radius:g} m; the nearest is face {nearest.number}, a "
            f"{nearest.kind} of radius {nearest.radius:.6g} m"
        )
    if wanted.axis is not None:
        axis = _unit(wanted.axis, "axis")
        turned, fitting = fitting, [f for f in fitting if abs(f.direction @ axis) > _SAME_DIRECTION]
        if not fitting:
            along = ", ".join(f"{x:.3g}" for x in turned[0].direction)
            raise InputError(
                f"the axis of face {turned[0].number}, of this radius, runs along ({along})"
            )
    through = np.array(wanted.point) if wanted.point is not None else place
    if through is not None:
        nearest = min(fitting, key=lambda f: _from_axis(f, through))
        distance = _from_axis(nearest, through)
        allowed = wanted.tolerance if wanted.tolerance is not None else _PLACE * wanted.radius
        if distance > max(allowed, 1e-6):
            raise InputError(
                f"the nearest cylinder of radius {wanted.radius:g} m is face {nearest.number}, and "
                f"its axis passes {1e3 * distance:.4g} mm from {_said(through)}; is the part where "
                "the joints are?"
            )
        return [f for f in fitting if _coaxial(f, nearest)]
    if not all(_coaxial(f, fitting[0]) for f in fitting):
        numbers = ", ".join(str(f.number) for f in fitting)
        raise InputError(
            f"faces {numbers} are cylinders of this radius on different axes; say point = [x, y, z]"
        )
    return fitting


def _in_plane(faces: Sequence[Face], wanted: ByPlane, place: Array | None) -> list[Face]:
    normal = _unit(wanted.normal, "normal")
    turned = [f for f in faces if f.kind == "plane" and f.direction @ normal > _SAME_DIRECTION]
    if not turned:
        raise InputError(f"no plane face has the outward normal {_said(normal)}")
    through = np.array(wanted.point) if wanted.point is not None else place
    if through is None:
        raise InputError("a plane needs point = [x, y, z] too")
    slack = wanted.tolerance
    if slack is None:
        slack = _PLACE * float(np.sqrt(max(f.area for f in turned)))
    height = {f.number: float((f.centre - through) @ normal) for f in turned}
    chosen = [f for f in turned if abs(height[f.number]) <= slack]
    if not chosen:
        nearest = min(turned, key=lambda f: abs(height[f.number]))
        raise InputError(
            f"no plane with this normal passes through {_said(through)}; the nearest is face "
            f"{nearest.number}, {1e3 * abs(height[nearest.number]):.4g} mm off"
        )
    return chosen


def _unit(vector: Sequence[float], key: str) -> Array:
    length = float(np.linalg.norm(vector))
    if not length > 0.0:
        raise InputError(f"{key} = {list(vector)}: must not be zero")
    return np.asarray(vector, dtype=float) / length


def _from_axis(face: Face, point: Array) -> float:
    away = point - face.on_axis
    return float(np.linalg.norm(away - face.direction * (face.direction @ away)))


def _coaxial(first: Face, second: Face) -> bool:
    parallel = abs(first.direction @ second.direction) > _SAME_DIRECTION
    return bool(parallel) and _from_axis(second, first.on_axis) < _PLACE * second.radius


def _common_axis(faces: Sequence[Face]) -> Array | None:
    first = faces[0]
    if all(face.kind in ("bore", "boss") and _coaxial(face, first) for face in faces):
        return first.direction
    return None


def _said(place: Array) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in place) + ")"


def _shared(part: PartFile, found: Sequence[Interface]) -> list[str]:
    """Pairs of interfaces that have faces, or the edges between their faces, in common."""
    nodes = {
        interface.name: set().union(
            *(part.face(number).facets.nodes.tolist() for number in interface.faces)
        )
        for interface in found
    }
    faults = []
    for i, first in enumerate(found):
        for second in found[i + 1 :]:
            both = set(first.faces) & set(second.faces)
            if both:
                faults.append(
                    f"interfaces {first.name} and {second.name} both take face {min(both)}; a face "
                    "belongs to one of them"
                )
            elif nodes[first.name] & nodes[second.name]:
                faults.append(
                    f"interfaces {first.name} and {second.name} share the edge between their "
                    f"faces {_listed(first.faces)} and {_listed(second.faces)}; take faces that do "
                    "not touch, or make them one interface"
                )
    return faults


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))
