"""What is looked at in the data, and what is found: with the number that shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np

from lumped.arrays import Array

Kind: TypeAlias = Literal["computed", "read"]
Severity: TypeAlias = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Finding:
    """A fault of printed data or of a printed formula.

    `where` names the key of the robot file or the place in the paper, `check` the question that
    was asked; `printed` is what stands there, `wrong` what is the matter, `evidence` a sentence
    with the computed `numbers` (SI, by name), `used` what the models take instead.
    `kind`: "computed" where a computation finds it, "read" where only reading does.
    `severity`: "error" if nothing can be computed with it or the result would be wrong, "warning"
    if it is doubtful but usable, "note" if no number depends on it.
    """

    where: str
    check: str
    printed: str
    wrong: str
    evidence: str
    severity: Severity
    used: str = "as given"
    numbers: Mapping[str, float] = field(default_factory=dict)
    kind: Kind = "computed"


@dataclass(frozen=True)
class DescribedPart:
    """A part of the robot as a file describes it, SI; None where it does not.

    `compliance` 6×6, `inertia` 3×3 at the mass centre, `length` and `mass_centre` (m from the
    root, along x) of a leg.
    """

    name: str
    compliance: Array | None = None
    inertia: Array | None = None
    length: float | None = None
    mass_centre: float | None = None


def parts(tables: Mapping[str, Any]) -> tuple[DescribedPart, ...]:
    """Foot, legs and tool of a robot file's tables, or bodies and joints of a mechanism's."""
    named = {name: tables[name] for name in ("foot", "leg1", "leg2", "tool") if name in tables}
    if "bodies" in tables:
        kinds = ("bodies", "joints")
        named = {f"{k}.{name}": table for k in kinds for name, table in tables[k].items()}
    return tuple(
        DescribedPart(
            name=name,
            compliance=_matrix(table, "compliance"),
            inertia=_matrix(table, "inertia"),
            length=_length(tables, table),
            mass_centre=table.get("mass_centre"),
        )
        for name, table in named.items()
    )


def _length(tables: Mapping[str, Any], table: Mapping[str, Any]) -> float | None:
    """Length (m) of a leg, told or between its points; None of anything else."""
    if "from" not in table:
        return table.get("length")
    start, to = (tables["points"][table[end]] for end in ("from", "to"))
    return float(np.linalg.norm(np.subtract(to, start)))


def _matrix(table: Mapping[str, Any], key: str) -> Array | None:
    return np.array(table[key], dtype=float) if key in table else None
