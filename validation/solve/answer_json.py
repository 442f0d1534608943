"""Solutions of `solve` as JSON (schema 1).

Input: a `Solution`. Output: text, in SI units.
"""

import json
from dataclasses import asdict
from typing import Any

import msgspec
import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.system.response import HarmonicResponse
from lumped.system.stability import Stability
from validation.solve.answer import Answer, HalfWidths, MeshUncertainty, Solution


def as_json(solution: Solution) -> str:
    """Solution as JSON (schema 1). An infinite frequency is null."""
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

    Raises ComputationError if it contains one.
    """
    try:
        return json.dumps(document, allow_nan=False)
    except ValueError as error:
        raise ComputationError(
            "a result is no finite number: a mass or a stiffness of the robot is extremely small "
            "or large"
        ) from error


def answer_record(answer: Answer) -> dict[str, Any]:
    """Record of an answer. An infinite frequency is null."""
    record: dict[str, Any] = {
        **answer.place,
        "compliance": answer.compliance.tolist(),
        "frequencies": [f if np.isfinite(f) else None for f in answer.frequencies.tolist()],
    }
    if answer.idle is not None:
        record["idle"] = answer.idle
    if answer.rigid is not None:
        del record["compliance"]
        record["rigid"] = answer.rigid
    if answer.loads:
        record["loads"] = {
            name: {"displacement": _numbers(displacement)}
            | _stability_record(answer.stability.get(name))
            for name, displacement in answer.loads.items()
        }
    if answer.damped:
        frequencies, losses = (values.tolist() for values in answer.damped)
        record["damped"] = {"frequencies": frequencies, "losses": losses}
    if answer.responses:
        record["responses"] = {
            values.excitation.name: _response_record(values) for values in answer.responses
        }
    if (mesh := answer.uncertainty) is not None:
        record["uncertainty"] = _mesh_record(mesh) if mesh.known else None
    if (parts := answer.of_parts) is not None:
        record["parts"] = {
            "uncertainty": _half_widths(parts) if parts.known else None,
            "averaged_less_rigid": _half_widths(parts.bracket),
            "reduction": parts.reduction.tolist(),
            "modes_counted": {
                name: {"count": count, "below": below}
                for name, (count, below) in parts.counted.items()
            },
        }
    if (digits := answer.of_digits) is not None:
        record["digits"] = _half_widths(digits)
    if answer.strain:
        record["strain"] = {str(part): share.tolist() for part, share in answer.strain.items()}
    if answer.paired:
        record["partners"] = msgspec.to_builtins(answer.paired)
    return record


def _half_widths(half_widths: HalfWidths) -> dict[str, Any]:
    """Half-widths of the diagonal of a compliance, of frequencies and of displacements."""
    record: dict[str, Any] = {
        "compliance": half_widths.compliance.tolist(),
        "frequencies": half_widths.frequencies.tolist(),
    }
    if half_widths.loads:
        record["loads"] = {name: _numbers(sizes) for name, sizes in half_widths.loads.items()}
    return record


def _mesh_record(mesh: MeshUncertainty) -> dict[str, Any]:
    """Half-widths with the divisions of the meshes from which they follow."""
    extrapolation = {"extrapolated_from": list(mesh.meshes)} if mesh.meshes else {}
    return {"divisions": mesh.divisions} | _half_widths(mesh) | extrapolation


def _response_record(response: HarmonicResponse) -> dict[str, Any]:
    """Receptance (m/N) over frequencies (Hz), and its peak. None for an infinite number."""
    height, frequency, *excitation_point = response.judged
    record: dict[str, Any] = {
        "frequencies": response.excitation.frequencies.tolist(),
        "real": response.receptance.real.tolist(),
        "imaginary": response.receptance.imag.tolist(),
        "peak": {
            name: number if np.isfinite(number) else None
            for name, number in (("size", height), ("frequency", frequency))
        },
    }
    excitation = response.excitation
    points = {"force": excitation.loaded, "displacement": excitation.moved}
    record |= {name: list(point) for name, point in points.items() if point is not None}
    return record | (
        {"at": {"size": excitation_point[0], "frequency": response.excitation.at}}
        if excitation_point
        else {}
    )


def _stability_record(stability: Stability | None) -> dict[str, Any]:
    """Buckling factor and loss of stiffness under a load. A buckled mechanism has no stiffness."""
    if stability is None:
        return {}
    stands = bool(np.isfinite(stability.stiffness_losses).all())
    record: dict[str, Any] = {
        "buckling": {
            "factor": stability.factor,
            "reversed": stability.reversed,
            "body": next(iter(stability.shares), None),
            "shares": stability.shares,
        },
        "stiffness_lost": stability.stiffness_losses.tolist() if stands else None,
        "farther": stability.extra_displacement if stands else None,
    }
    if len(stability.frequencies):
        record["frequencies"] = stability.frequencies.tolist()
    return record


def _numbers(values: Array) -> list[float] | None:
    return values.tolist() if np.isfinite(values).all() else None
