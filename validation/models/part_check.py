"""What `flexproof check` says of a robot's CAD parts: what was read, and where faces are."""

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.body import Body
from lumped.mechanism.mechanism import Mechanism
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.models.reduced_parts import found_in


def parts_text(mechanism: Mechanism) -> str:
    """Lines on every part: its size and, of every interface, faces and how far they are off.

    Empty where no body is a part. Raises InputError with the faults of all parts.
    """
    texts, faults = collect_faults(_part_text, mechanism.parts.values())
    if faults:
        raise InputError(faults)
    return "\n".join(texts)


def _part_text(body: Body) -> str:
    file, interfaces = found_in(body)
    lines = [f"{body.name}: {file.path.name}, {file.size}"]
    return "\n".join(lines + [f"  {_interface(file, one)}" for one in interfaces])


def _interface(file: PartFile, interface: Interface) -> str:
    faces = [file.face(number) for number in interface.faces]
    kinds = " and ".join(dict.fromkeys(face.kind for face in faces))
    numbers = ", ".join(str(face.number) for face in faces)
    said = f"{interface.name}: face{'s' if len(faces) > 1 else ''} {numbers} ({kinds}"
    said += f" of radius {faces[0].radius * 1e3:.4g} mm)" if interface.axis is not None else ")"
    how = interface.coupling + ("" if interface.reason == "as asked for" else " by default")
    return f"{said}, {_off(file, interface)}, {how}"


def _off(file: PartFile, interface: Interface) -> str:
    """How far the faces are from the joint's point, across their axis where they have one."""
    if interface.axis is not None and interface.on_axis is not None:
        away = interface.point - interface.on_axis
        across = away - interface.axis * (interface.axis @ away)
        return f"its axis {_millimetres(across)} from the point"
    areas = np.array([file.face(number).area for number in interface.faces])
    centres = np.array([file.face(number).centre for number in interface.faces])
    away = areas @ centres / areas.sum() - interface.point
    return f"its centre {_millimetres(away)} from the point"


def _millimetres(arm: Array) -> str:
    distance = 1e3 * float(np.linalg.norm(arm))
    # Rounding of a file's digits is no distance.
    return f"{distance if distance > 1e-6 else 0.0:.3g} mm"
