"""Interfaces of a part: the faces, the reference point and the coupling of each interface."""

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
    Selection,
)
from meshes.part.faces import Face
from meshes.part.reading.read import PartFile

DEFAULT_COUPLING: Coupling = "rigid"
WHY_RIGID = (
    "rigid by default: the pin, bearing or bolted joint in it is assumed to be much stiffer than "
    "the part. This is the upper bound of stiffness; an averaged interface is the lower bound, "
    "and the difference is part of the uncertainty"
)
# Tolerances, relative to the radius, of radii and positions copied from drawings. A tolerance in
# the robot file overrides them.
_RADIUS, _PLACE = 1e-3, 1e-3
# Cosine of the angle up to which two directions count as parallel: half a degree.
_SAME_DIRECTION = float(np.cos(np.radians(0.5)))


@dataclass(frozen=True, eq=False)
class Interface:
    """Interface of a part: the `faces` to which a joint is attached, and its reference point.

    `faces` are face numbers. `point` (3, in m, file axes) is the reference point. `coupling` is the
    kind of coupling between the faces and the twist of the interface (`fem.couplings.grips`).
    `by_default` is True if the robot file does not specify the coupling. If the faces form a
    cylinder, `axis` is the unit vector of its axis and `on_axis` (3, in m) a point on the axis.
    Otherwise both are None. `area` (m²) is the total area of the faces.
    """

    name: str
    faces: tuple[int, ...]
    point: Array
    coupling: Coupling
    by_default: bool
    axis: Array | None
    on_axis: Array | None
    area: float

    @property
    def reason(self) -> str:
        """Text for the report: the reason why the interface has its coupling."""
        return WHY_RIGID if self.by_default else "as specified"


def find_interfaces(
    part: PartFile,
    specified: Mapping[str, PartInterface],
    points: Mapping[str, Array] | None = None,
) -> tuple[Interface, ...]:
    """Interfaces of a part as specified in the robot file, in the same order.

    `specified` contains their specifications by interface name, `points` (3 each, in m, file axes)
    their reference points by name. A reference point that is missing is placed in the middle of the
    axis of a cylinder, otherwise in the centre of the faces' area. Raises InputError with all
    faults at once. If a selection matches no face, its fault names the nearest face.
    """
    interfaces, faults = [], []
    for name, interface in specified.items():
        point = None if points is None else points.get(name)
        try:
            interfaces.append(_interface(part, name, interface, point))
        except InputError as error:
            faults += [f"{part.path}: interface {name}: {fault}" for fault in error.faults]
    if not specified:
        faults.append(f"{part.path}: no interface is given; a part needs one or more")
    faults += [f"{part.path}: {fault}" for fault in _shared(part, interfaces)]
    if faults:
        raise InputError(faults)
    return tuple(interfaces)


def _interface(
    part: PartFile, name: str, specified: PartInterface, point: Array | None
) -> Interface:
    faces = selected_faces(part, specified.selection, point)
    axis = _common_axis(faces)
    areas = np.array([face.area for face in faces])
    if point is None:
        centres = [face.on_axis if axis is not None else face.centre for face in faces]
        point = areas @ np.array(centres) / areas.sum()
    coupling = specified.coupling or DEFAULT_COUPLING
    if coupling == "pin" and axis is None:
        kinds = ", ".join(f"{face.number} ({face.kind})" for face in faces)
        raise InputError(
            f'coupling = "pin" is only for a bore, and the selected faces {kinds} form no '
            'cylinder; take "rigid" or "average"'
        )
    by_default = not specified.coupling
    numbers = tuple(face.number for face in faces)
    on_axis = None if axis is None else faces[0].on_axis
    total = float(areas.sum())
    return Interface(name, numbers, point, coupling, by_default, axis, on_axis, total)


def selected_faces(part: PartFile, selection: Selection, point: Array | None = None) -> list[Face]:
    """Faces of a part that match a selection.

    `point` (3, in m, file axes) is used if the selection of a cylinder or plane has no point of its
    own. Raises InputError if no face matches, with the nearest face in its message.
    """
    match selection:
        case ByFaces(faces):
            return _numbered(part.faces, faces)
        case ByName(name):
            return _faces_named(part, name)
        case ByCylinder():
            return _on_cylinder(part.faces, selection, point)
        case ByPlane():
            return _in_plane(part.faces, selection, point)


def _numbered(faces: Sequence[Face], numbers: tuple[int, ...]) -> list[Face]:
    by_number = {face.number: face for face in faces}
    unknown = [number for number in numbers if number not in by_number]
    if unknown or not numbers:
        reason = f"face {unknown[0]} does not exist" if unknown else "no face is given"
        raise InputError(f"{reason}; the part has faces {min(by_number)} to {max(by_number)}")
    return [by_number[number] for number in sorted(set(numbers))]


def _faces_named(part: PartFile, name: str) -> list[Face]:
    faces = [face for face in part.faces if face.name == name]
    if faces:
        return faces
    if part.mesh is not None and name in part.mesh.empty_sets:
        raise InputError(
            f'the set "{name}" contains no complete element face on the surface; an '
            "interface must consist of faces, not of single nodes"
        )
    names = sorted({face.name for face in part.faces if face.name})
    close = get_close_matches(name, names, n=1)
    alternatives = f"the named ones are {', '.join(names)}" if names else "the file names none"
    advice = f'did you mean "{close[0]}"?' if close else alternatives
    raise InputError(f'no face is called "{name}"; {advice}')


def _on_cylinder(faces: Sequence[Face], selection: ByCylinder, point: Array | None) -> list[Face]:
    slack = _RADIUS * selection.radius if selection.tolerance is None else selection.tolerance
    round_faces = [face for face in faces if face.kind in ("bore", "boss")]
    if not round_faces:
        raise InputError(
            "the part has no cylindrical face; select a face by its number (see flexproof faces)"
        )
    fitting = [f for f in round_faces if abs(f.radius - selection.radius) <= slack]
    if not fitting:
        nearest = min(round_faces, key=lambda f: abs(f.radius - selection.radius))
        raise InputError(
            f"no cylinder of radius {selection.radius:g} m; the nearest is face {nearest.number}, "
            f"a {nearest.kind} of radius {nearest.radius:.6g} m"
        )
    if selection.axis is not None:
        axis = _unit(selection.axis, "axis")
        candidates = fitting
        fitting = [f for f in candidates if abs(f.direction @ axis) > _SAME_DIRECTION]
        if not fitting:
            along = ", ".join(f"{x:.3g}" for x in candidates[0].direction)
            raise InputError(
                f"the axis of face {candidates[0].number}, of radius {selection.radius:g} m, runs "
                f"along ({along})"
            )
    through = np.array(selection.point) if selection.point is not None else point
    if through is not None:
        nearest = min(fitting, key=lambda f: _from_axis(f, through))
        distance = _from_axis(nearest, through)
        allowed = (
            selection.tolerance if selection.tolerance is not None else _PLACE * selection.radius
        )
        if distance > max(allowed, 1e-6):
            raise InputError(
                f"the nearest cylinder of radius {selection.radius:g} m is face {nearest.number}, "
                f"and its axis passes {1e3 * distance:.4g} mm from {_point_text(through)}; check "
                "the position of the part"
            )
        return [f for f in fitting if _coaxial(f, nearest)]
    if not all(_coaxial(f, fitting[0]) for f in fitting):
        numbers = ", ".join(str(f.number) for f in fitting)
        raise InputError(
            f"faces {numbers} are cylinders of radius {selection.radius:g} m on different axes; "
            "give point = [x, y, z]"
        )
    return fitting


def _in_plane(faces: Sequence[Face], selection: ByPlane, point: Array | None) -> list[Face]:
    normal = _unit(selection.normal, "normal")
    candidates = [f for f in faces if f.kind == "plane" and f.direction @ normal > _SAME_DIRECTION]
    if not candidates:
        raise InputError(f"no plane face has the outward normal {_point_text(normal)}")
    through = np.array(selection.point) if selection.point is not None else point
    if through is None:
        raise InputError("a plane needs point = [x, y, z] too")
    slack = selection.tolerance
    if slack is None:
        slack = _PLACE * float(np.sqrt(max(f.area for f in candidates)))
    height = {f.number: float((f.centre - through) @ normal) for f in candidates}
    selected = [f for f in candidates if abs(height[f.number]) <= slack]
    if not selected:
        nearest = min(candidates, key=lambda f: abs(height[f.number]))
        raise InputError(
            f"no plane of normal {_point_text(normal)} passes through {_point_text(through)}; the "
            f"nearest is face {nearest.number}, {1e3 * abs(height[nearest.number]):.4g} mm off"
        )
    return selected


def _unit(vector: Sequence[float], key: str) -> Array:
    length = float(np.linalg.norm(vector))
    if not length > 0.0:
        raise InputError(f"{key} = {list(vector)}: must not be zero")
    return np.asarray(vector, dtype=float) / length


def _from_axis(face: Face, point: Array) -> float:
    offset = point - face.on_axis
    return float(np.linalg.norm(offset - face.direction * (face.direction @ offset)))


def _coaxial(first: Face, second: Face) -> bool:
    parallel = abs(first.direction @ second.direction) > _SAME_DIRECTION
    return bool(parallel) and _from_axis(second, first.on_axis) < _PLACE * second.radius


def _common_axis(faces: Sequence[Face]) -> Array | None:
    first = faces[0]
    if all(face.kind in ("bore", "boss") and _coaxial(face, first) for face in faces):
        return first.direction
    return None


def _point_text(point: Array) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ")"


def _shared(part: PartFile, interfaces: Sequence[Interface]) -> list[str]:
    """Messages about pairs of interfaces that have a common face or a common edge."""
    nodes = {
        interface.name: set().union(
            *(part.face(number).facets.nodes.tolist() for number in interface.faces)
        )
        for interface in interfaces
    }
    faults = []
    for i, first in enumerate(interfaces):
        for second in interfaces[i + 1 :]:
            common_faces = set(first.faces) & set(second.faces)
            if common_faces:
                faults.append(
                    f"interfaces {first.name} and {second.name} both take face "
                    f"{min(common_faces)}; a face belongs to one of them"
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
