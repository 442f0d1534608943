"""Solutions as JSON (schema 1)."""

import json
from dataclasses import asdict
from typing import Any

import msgspec
import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.system.response import ToolResponse
from lumped.system.stability import Stability
from validation.solve.answer import Answer, LeftOpen, MeshUncertainty, Solution


def as_json(solution: Solution) -> str:
    """The answers as JSON (schema 1); an infinite frequency is null."""
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
    """The document as JSON, which has no infinite numbers; raises ComputationError for one."""
    try:
        return json.dumps(document, allow_nan=False)
    except ValueError as error:
        raise ComputationError(
            "a result is no finite number: a mass or a stiffness of the robot is extremely small "
            "or large"
        ) from error


def answer_record(answer: Answer) -> dict[str, Any]:
    """An answer's entry in the results; an infinite frequency is null."""
    found: dict[str, Any] = {
        **answer.place,
        "compliance": answer.compliance.tolist(),
        "frequencies": [f if np.isfinite(f) else None for f in answer.frequencies.tolist()],
    }
    if answer.idle is not None:
        found["idle"] = answer.idle
    if answer.rigid is not None:
        del found["compliance"]
        found["rigid"] = answer.rigid
    if answer.loads:
        found["loads"] = {
            name: {"displacement": _numbers(moved)} | _stability_record(answer.stability.get(name))
            for name, moved in answer.loads.items()
        }
    if answer.damped:
        frequencies, losses = (one.tolist() for one in answer.damped)
        found["damped"] = {"frequencies": frequencies, "losses": losses}
    if answer.responses:
        found["responses"] = {
            one.excitation.name: _response_record(one) for one in answer.responses
        }
    if (mesh := answer.uncertainty) is not None:
        found["uncertainty"] = _mesh_record(mesh) if mesh.known else None
    if (parts := answer.of_parts) is not None:
        found["parts"] = {
            "uncertainty": _half_widths(parts) if parts.known else None,
            "averaged_less_rigid": _half_widths(parts.bracket),
            "reduction": parts.reduction.tolist(),
            "modes_counted": {
                name: {"count": count, "below": below}
                for name, (count, below) in parts.counted.items()
            },
        }
    if (digits := answer.of_digits) is not None:
        found["digits"] = _half_widths(digits)
    if answer.strain:
        found["strain"] = {str(part): share.tolist() for part, share in answer.strain.items()}
    if answer.paired:
        found["partners"] = msgspec.to_builtins(answer.paired)
    return found


def _half_widths(left_open: LeftOpen) -> dict[str, Any]:
    """Half-widths of the diagonal of a compliance, of frequencies and of displacements."""
    record: dict[str, Any] = {
        "compliance": left_open.compliance.tolist(),
        "frequencies": left_open.frequencies.tolist(),
    }
    if left_open.loads:
        record["loads"] = {name: _numbers(left) for name, left in left_open.loads.items()}
    return record


def _mesh_record(mesh: MeshUncertainty) -> dict[str, Any]:
    """Half-widths with the divisions of the meshes that they are from."""
    shown = {"extrapolated_from": list(mesh.meshes)} if mesh.meshes else {}
    return {"divisions": mesh.divisions} | _half_widths(mesh) | shown


def _response_record(one: ToolResponse) -> dict[str, Any]:
    """Receptance (m/N) over frequencies (Hz), its peak, None where it has no bound or is none."""
    height, frequency, *at = one.judged
    found: dict[str, Any] = {
        "frequencies": one.excitation.frequencies.tolist(),
        "real": one.receptance.real.tolist(),
        "imaginary": one.receptance.imag.tolist(),
        "peak": {
            name: number if np.isfinite(number) else None
            for name, number in (("size", height), ("frequency", frequency))
        },
    }
    return found | ({"at": {"size": at[0], "frequency": one.excitation.at}} if at else {})


def _stability_record(found: Stability | None) -> dict[str, Any]:
    """What goes beside a displacement; a mechanism that has buckled has no stiffness."""
    if found is None:
        return {}
    stands = bool(np.isfinite(found.stiffness_losses).all())
    record: dict[str, Any] = {
        "buckling": {
            "factor": found.factor,
            "reversed": found.reversed,
            "body": next(iter(found.shares), None),
            "shares": found.shares,
        },
        "stiffness_lost": found.stiffness_losses.tolist() if stands else None,
        "farther": found.extra_displacement if stands else None,
    }
    if len(found.frequencies):
        record["frequencies"] = found.frequencies.tolist()
    return record


def _numbers(values: Array) -> list[float] | None:
    return values.tolist() if np.isfinite(values).all() else None
