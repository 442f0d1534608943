"""One thing that is wrong with data or formulas, with the number that shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

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
