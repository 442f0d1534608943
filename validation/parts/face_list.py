"""Faces of a CAD part as a table and as JSON, for the command `faces`.

Input: a `PartFile`. Output: text in the unit of the file, or JSON in SI units.
"""

from collections.abc import Sequence
from typing import Literal

import msgspec
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from lumped.mechanism.body import METRES
from meshes.part.faces import Face
from meshes.part.reading.read import PartFile
from validation.record_fields import json_text


class FaceRecord(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """JSON object of a face. Planes have a normal, bores and bosses an axis and a radius."""

    number: int
    kind: str
    area: float
    centre: Array
    normal: Array | UnsetType = UNSET
    axis: Array | UnsetType = UNSET
    on_axis: Array | UnsetType = UNSET
    radius: float | UnsetType = UNSET
    name: str = ""


class FacesRecord(msgspec.Struct, frozen=True, kw_only=True):
    """JSON document of `faces`. `volume` is None if the file has no exact geometry."""

    schema: Literal[1] = 1
    part: str
    unit: str
    extent: Sequence[float]
    volume: float | None
    faces: Sequence[FaceRecord]


def as_text(part: PartFile) -> str:
    """Table of faces in the unit of the file, to be compared with a drawing of the part.

    The last line is an example of an interface for a robot file (lengths in m).
    """
    unit, scale = part.unit, 1.0 / METRES[part.unit]
    lines = [f"{part.path}: {part.size}", ""]
    lines.append(
        f"{'face':>5}  {'kind':<6} {'area ' + unit + '²':>12}  {'centre ' + unit:<27} "
        f"{'normal, axis':<20} {'radius ' + unit:>10}  name"
    )
    lines += [_row(face, scale) for face in part.faces]
    bores = [face for face in part.faces if face.kind == "bore"]
    if bores:
        example = bores[0]
        point = ", ".join(f"{x + 0.0:.6g}" for x in example.on_axis.round(9))
        cylinder = f"cylinder = {{ radius = {example.radius:.6g}, point = [{point}] }}"
        lines += [
            "",
            f"example of an interface: {{ {cylinder} }} or {{ faces = [{example.number}] }} "
            "(lengths in m)",
        ]
    return "\n".join(lines)


def _row(face: Face, scale: float) -> str:
    centre = face.on_axis if face.kind in ("bore", "boss") else face.centre
    position = ", ".join(f"{scale * x + 0.0:.5g}" for x in centre.round(9))
    direction = ", ".join(f"{x:.3g}" for x in face.direction) if face.direction.any() else ""
    radius = f"{scale * face.radius:.6g}" if face.radius else ""
    return (
        f"{face.number:>5}  {face.kind:<6} {scale**2 * face.area:>12.6g}  {position:<27} "
        f"{direction:<20} {radius:>10}  {face.name}"
    ).rstrip()


def as_json(part: PartFile) -> str:
    """Faces as JSON (schema 1), in SI units and the axes of the file."""
    return json_text(
        FacesRecord(
            part=str(part.path),
            unit=part.unit,
            extent=part.extent,
            volume=part.exact.volume if part.exact else None,
            faces=[_record(face) for face in part.faces],
        )
    )


def _record(face: Face) -> FaceRecord:
    is_round = face.kind in ("bore", "boss")
    return FaceRecord(
        number=face.number,
        kind=face.kind,
        area=face.area,
        centre=face.centre,
        normal=face.direction if face.kind == "plane" else UNSET,
        axis=face.direction if is_round else UNSET,
        on_axis=face.on_axis if is_round else UNSET,
        radius=face.radius if is_round else UNSET,
        name=face.name,
    )
