"""Text of `flexproof check` on CAD parts: their size, the faces of each interface, and pressures.

Input: a mechanism. Output: lines of text. Rule: each interface is listed with its faces and their
distance from the point of the joint, each pressure with its faces and its resultant.
"""

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.body import Body
from lumped.mechanism.mechanism import Mechanism
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.models.loads.pressures import surface_resultants
from validation.models.reduced_parts import found_in


def parts_text(mechanism: Mechanism) -> str:
    """Lines on each CAD part: its size, and the faces of each interface with their distance.

    Pressures follow with their resultants. "" if no body is a CAD part. Raises InputError
    with the faults of all parts.
    """
    texts, faults = collect_faults(_part_text, mechanism.parts.values())
    if faults:
        raise InputError(faults)
    return "\n".join([*texts, *_pressure_texts(mechanism)])


def _pressure_texts(mechanism: Mechanism) -> list[str]:
    """Lines on each pressure of the loads: its faces and its resultant."""
    rows = surface_resultants(mechanism)
    heading = "pressures, with resultants about the origin of the part, axes of the part:"
    lines = [f"  {row.load}: {resultant.text}" for row, resultant in rows]
    return [heading, *lines] if lines else []


def _part_text(body: Body) -> str:
    file, interfaces = found_in(body)
    lines = [f"{body.name}: {file.path.name}, {file.size}"]
    return "\n".join(lines + [f"  {_interface_text(file, interface)}" for interface in interfaces])


def _interface_text(file: PartFile, interface: Interface) -> str:
    faces = [file.face(number) for number in interface.faces]
    kinds = " and ".join(dict.fromkeys(face.kind for face in faces))
    numbers = ", ".join(str(face.number) for face in faces)
    text = f"{interface.name}: face{'s' if len(faces) > 1 else ''} {numbers} ({kinds}"
    text += f" of radius {faces[0].radius * 1e3:.4g} mm)" if interface.axis is not None else ")"
    condition = interface.coupling + (" by default" if interface.by_default else "")
    return f"{text}, {_offset_text(file, interface)}, {condition}"


def _offset_text(file: PartFile, interface: Interface) -> str:
    """Text with the distance of the faces of an interface from the point of the joint.

    If the faces have an axis, the distance is perpendicular to the axis.
    """
    if interface.axis is not None and interface.on_axis is not None:
        offset = interface.point - interface.on_axis
        radial_offset = offset - interface.axis * (interface.axis @ offset)
        return f"axis {_millimetres(radial_offset)} from the point"
    areas = np.array([file.face(number).area for number in interface.faces])
    centres = np.array([file.face(number).centre for number in interface.faces])
    offset = areas @ centres / areas.sum() - interface.point
    return f"centre {_millimetres(offset)} from the point"


def _millimetres(arm: Array) -> str:
    distance = 1e3 * float(np.linalg.norm(arm))
    # Round-off due to the digits of a file counts as zero.
    return f"{distance if distance > 1e-6 else 0.0:.3g} mm"
