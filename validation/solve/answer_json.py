"""Solutions as JSON (schema 1), made by records whose fields are the keys of the JSON.

Input: a `Solution`. Output: the text of the JSON. Rule: keys without a value are omitted, and
numbers have the units of the answers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.load import PressureResultant
from lumped.system.response import HarmonicResponse
from lumped.system.stability import Stability
from validation.record_fields import CountRecord, finite, finite_items, json_text
from validation.solve.answer import (
    Answer,
    HalfWidths,
    MeshUncertainty,
    PairedModes,
    PartUncertainty,
    Place,
    Solution,
)


class HalfWidthRecord(msgspec.Struct, frozen=True, omit_defaults=True):
    """JSON object of `HalfWidths`: half-widths (95 %) of compliance, frequencies and loads.

    The half-widths of a displacement are None if one of its components has none; that of a
    frequency is None if its mode has no partner on another mesh.
    """

    compliance: Array
    frequencies: Sequence[float | None]
    loads: Mapping[str, Array | None] = {}


class MeshRecord(HalfWidthRecord, frozen=True, omit_defaults=True, kw_only=True):
    """JSON object of `MeshUncertainty`: half-widths due to the mesh of prisms."""

    divisions: int
    extrapolated_from: tuple[int, ...] = ()


class PartRecord(msgspec.Struct, frozen=True):
    """JSON object of `PartUncertainty`: what CAD parts contribute to half-widths of an answer.

    `uncertainty` is due to the meshes of the parts, None if unknown. `averaged_less_rigid` is the
    change of the answer from rigid to averaged interfaces.
    """

    uncertainty: HalfWidthRecord | None
    averaged_less_rigid: HalfWidthRecord
    reduction: Array
    modes_counted: Mapping[str, CountRecord]


class BucklingRecord(msgspec.Struct, frozen=True):
    """Buckling factors of a load and of the reversed load, from `Stability`.

    `body` has the largest of the `shares` of the buckling mode's strain energy.
    """

    factor: float | None
    reversed: float | None
    body: str | None
    shares: Mapping[str, float]


class PressureRecord(msgspec.Struct, frozen=True):
    """JSON object of a pressure (Pa) on faces of a CAD part, whose area is in m².

    `force` (3, N) and `moment` (3, N m) about the origin of the part, in the axes of the part.
    """

    body: str
    faces: tuple[int, ...]
    pressure: float
    area: float
    force: Array
    moment: Array


class LoadRecord(msgspec.Struct, frozen=True):
    """JSON object of a load: displacement of the tool, reactions, buckling and lost stiffness.

    The displacement is None if there is no solution. `reactions` (6, N and N m, joint axes) by
    joint; None for a statically indeterminate component. `pressures` on faces of CAD parts.
    `stiffness_lost` (6): relative loss of the tool's stiffness due to the load. `farther`: relative
    increase of the displacement due to this loss. Both are None if the mechanism buckles below the
    load. `frequencies` (Hz): those under the load.
    """

    displacement: Array | None
    reactions: Mapping[str, tuple[float | None, ...]] | UnsetType = UNSET
    pressures: tuple[PressureRecord, ...] | UnsetType = UNSET
    buckling: BucklingRecord | UnsetType = UNSET
    stiffness_lost: Array | UnsetType | None = UNSET
    farther: float | UnsetType | None = UNSET
    frequencies: Array | UnsetType = UNSET


class SizeRecord(msgspec.Struct, frozen=True):
    """Magnitude of a receptance (m/N) at a frequency (Hz). None for an infinite number."""

    size: float | None
    frequency: float | None


class ResponseRecord(msgspec.Struct, frozen=True):
    """JSON object of a `HarmonicResponse`: receptance (m/N) over frequencies (Hz), and its peak.

    `force` and `displacement` are points of the robot file (body and point), omitted for the tool.
    """

    frequencies: Array
    real: Array
    imaginary: Array
    peak: SizeRecord
    at: SizeRecord | UnsetType = UNSET
    force: tuple[str, ...] | UnsetType = UNSET
    displacement: tuple[str, ...] | UnsetType = UNSET


class DampedRecord(msgspec.Struct, frozen=True):
    """Frequencies (Hz) and loss factors of complex modes."""

    frequencies: Array
    losses: Array


class AnswerRecord(Place, frozen=True, omit_defaults=True, kw_only=True):
    """JSON object of an `Answer`: an entry of the list "results".

    The keys of `Place` identify the pose or the body, the others are fields of `Answer`. A key with
    the value UNSET is left out. An infinite frequency is None. `uncertainty` is None if the second
    mesh, from which it follows, is too large.
    """

    compliance: Array | UnsetType = UNSET
    frequencies: tuple[float | None, ...]
    idle: int | None = None
    rigid: int | None = None
    loads: Mapping[str, LoadRecord] = {}
    damped: DampedRecord | None = None
    responses: Mapping[str, ResponseRecord] = {}
    uncertainty: MeshRecord | UnsetType | None = UNSET
    parts: PartRecord | None = None
    digits: HalfWidthRecord | None = None
    strain: Mapping[str, Array] = {}
    partners: PairedModes | None = None


def as_json(solution: Solution) -> str:
    """Solution as JSON (schema 1)."""
    document: dict[str, Any] = {
        "schema": 1,
        "robot": solution.robot,
        "model": solution.model,
        "options": solution.options,
        "results": [answer_record(answer) for answer in solution.answers],
    }
    if solution.accuracy:
        document["accuracy"] = asdict(solution.accuracy)
    return finite_json(document)


def finite_json(document: Any) -> str:
    """Document as JSON, which has no infinite numbers.

    Raises ComputationError if the document contains an infinite number or NaN.
    """
    try:
        return json_text(document)
    except ValueError as error:
        raise ComputationError(
            "a result is not a finite number, because a mass or a stiffness of the robot "
            "is extremely small or large; check the units of the robot file"
        ) from error


def answer_record(answer: Answer) -> AnswerRecord:
    """Record of an answer."""
    mesh, parts, digits = answer.uncertainty, answer.of_parts, answer.of_digits
    return AnswerRecord(
        **msgspec.structs.asdict(answer.place),
        compliance=answer.compliance if answer.rigid is None else UNSET,
        frequencies=tuple(finite_items(answer.frequencies)),
        idle=answer.idle,
        rigid=answer.rigid,
        loads={
            name: _load_record(
                displacement,
                answer.reactions.get(name, {}),
                answer.pressures.get(name, ()),
                answer.stability.get(name),
            )
            for name, displacement in answer.loads.items()
        },
        damped=DampedRecord(*answer.damped) if answer.damped else None,
        responses={values.excitation.name: _response_record(values) for values in answer.responses},
        uncertainty=UNSET if mesh is None else _mesh_record(mesh),
        parts=None if parts is None else _part_record(parts),
        digits=None if digits is None else _half_width_record(digits),
        strain={str(part): share for part, share in answer.strain.items()},
        partners=answer.paired,
    )


def _half_width_record(half_widths: HalfWidths) -> HalfWidthRecord:
    return HalfWidthRecord(
        half_widths.compliance, finite_items(half_widths.frequencies), _known_loads(half_widths)
    )


def _mesh_record(mesh: MeshUncertainty) -> MeshRecord | None:
    if not mesh.known:
        return None
    return MeshRecord(
        mesh.compliance,
        finite_items(mesh.frequencies),
        _known_loads(mesh),
        divisions=mesh.divisions,
        extrapolated_from=mesh.meshes,
    )


def _known_loads(half_widths: HalfWidths) -> dict[str, Array | None]:
    return {name: _known(sizes) for name, sizes in half_widths.loads.items()}


def _part_record(parts: PartUncertainty) -> PartRecord:
    return PartRecord(
        uncertainty=_half_width_record(parts) if parts.known else None,
        averaged_less_rigid=_half_width_record(parts.bracket),
        reduction=parts.reduction,
        modes_counted={name: CountRecord(*count) for name, count in parts.counted.items()},
    )


def _load_record(
    displacement: Array,
    wrenches: Mapping[str, Array],
    resultants: Sequence[PressureResultant],
    stability: Stability | None,
) -> LoadRecord:
    reactions = {joint: tuple(finite_items(wrench)) for joint, wrench in wrenches.items()} or UNSET
    pressures = tuple(PressureRecord(**vars(resultant)) for resultant in resultants) or UNSET
    if stability is None:
        return LoadRecord(_known(displacement), reactions, pressures)
    losses = _known(stability.stiffness_losses)
    return LoadRecord(
        displacement=_known(displacement),
        reactions=reactions,
        pressures=pressures,
        buckling=BucklingRecord(
            stability.factor,
            stability.reversed,
            next(iter(stability.shares), None),
            stability.shares,
        ),
        stiffness_lost=losses,
        farther=None if losses is None else stability.extra_displacement,
        frequencies=stability.frequencies if len(stability.frequencies) else UNSET,
    )


def _response_record(response: HarmonicResponse) -> ResponseRecord:
    excitation = response.excitation
    height, frequency, *size_at = response.judged
    return ResponseRecord(
        frequencies=excitation.frequencies,
        real=response.receptance.real,
        imaginary=response.receptance.imag,
        peak=SizeRecord(finite(height), finite(frequency)),
        at=SizeRecord(size_at[0], excitation.at) if size_at else UNSET,
        force=excitation.loaded or UNSET,
        displacement=excitation.moved or UNSET,
    )


def _known(values: Array) -> Array | None:
    """The values themselves, or None if any of them is infinite or NaN."""
    return values if np.isfinite(values).all() else None
