"""A validation case as a typed record, and what it measures.

The error of a comparison is E = value − reference. Named differences between the two models may
be allowed for; what is left, E less the allowances, is held against the tolerance (vocabulary of
ASME V&V 10 and 20).
"""

import sys
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from math import hypot, isfinite
from typing import Literal, TypeAlias

from fem.calculix.run import CalculixMissing
from lumped.errors import ComputationError, InputError
from validation.context import PRESETS, About, Context, Preset
from validation.published_statements import Claim
from validation.studies_and_figures import Study

# A comparison of two models, of a model with its own refinement, or of all formulations of one leg.
CaseKind: TypeAlias = Literal["comparison", "convergence", "agreement"]
ReferenceKind: TypeAlias = Literal[
    "closed-form", "published", "paper-statement", "finer-model", "independent-solver"
]

# Remedy if memory ran out.
OUT_OF_MEMORY = "choose a smaller preset or fewer --jobs"


class Relation(Enum):
    """What the case claims of the value: equal to the reference, at most, or at least as large."""

    EQUAL = "equal"
    AT_MOST = "at most"
    AT_LEAST = "at least"

    def excess(self, difference: float) -> float:
        """How far `difference` (value − reference) lies on the wrong side; negative: right side."""
        match self:
            case Relation.EQUAL:
                return abs(difference)
            case Relation.AT_MOST:
                return difference
            case Relation.AT_LEAST:
                return -difference


@dataclass(frozen=True)
class Absolute:
    """Tolerance as an amount in the unit of the case."""

    amount: float

    def __post_init__(self) -> None:
        _require_positive(self.amount)

    def at(self, reference: float) -> float:  # noqa: ARG002  the same whatever the reference
        """Amount in the unit of the case."""
        return self.amount


@dataclass(frozen=True)
class Relative:
    """Tolerance as a fraction of the reference."""

    fraction: float

    def __post_init__(self) -> None:
        _require_positive(self.fraction)

    def at(self, reference: float) -> float:
        """Amount in the unit of the case. Raises ValueError for a reference of zero."""
        if reference == 0.0:
            raise ValueError("a relative tolerance needs a reference other than zero")
        return self.fraction * abs(reference)


Tolerance: TypeAlias = Absolute | Relative


@dataclass(frozen=True)
class Allowance:
    """A named cause and the part of value − reference that it explains (signed, unit of the case).

    `source` says how the amount was found (section, equation, or function).
    """

    cause: str
    amount: float
    source: str = ""


@dataclass(frozen=True)
class Elsewhere:
    """The same comparison at another place than the measurement's own: in another pose or mode.

    `uncertainty` is that of what is judged there, None where exact.
    """

    where: str
    value: float
    reference: float
    uncertainty: float | None = None

    @property
    def difference(self) -> float:
        """E = value − reference."""
        return self.value - self.reference


@dataclass(frozen=True)
class UnjudgedValue:
    """A value beside its reference that is shown and not judged, in `unit`.

    `model` and `label` of the quantity as of a case; `half_width`: numerical uncertainty of the
    reference, None if unknown; `elements` as of a case.
    """

    model: str
    label: str
    unit: str
    value: float
    reference: float
    half_width: float | None = None
    elements: int = 0

    @property
    def share(self) -> float:
        """(value − reference)/reference."""
        return self.value / self.reference - 1.0


@dataclass(frozen=True)
class Measurement:
    """What a case computed, in the unit of the case.

    `value_uncertainty`, `reference_uncertainty` and `judged_uncertainty` are the numerical
    uncertainties of both sides and of the unexplained difference (half-widths of a 95 % interval).
    The last is stated where both sides have one mesh, whose errors cancel; else it follows from the
    other two. Either one of them is stated, or the numbers are `exact`: nothing is discretised, and
    rounding alone is left; ValueError for neither and for both. `table` maps column headings to
    equally long columns; `studies` are convergence studies and sweeps to be shown with the case.
    `pose` is the one that the numbers belong to. Where a case looks at several places it is fixed
    beforehand, so that runs can be compared, and `elsewhere` has the others, judged as well. values
    `shown` are reported beside it and not judged.
    `claim`: what a source says of it, read as printed and as corrected. `decides`: what there is to
    do, or to know, where the uncertainty is too large to judge.
    """

    value: float
    reference: float
    value_uncertainty: float | None = None
    reference_uncertainty: float | None = None
    judged_uncertainty: float | None = None
    allowances: tuple[Allowance, ...] = ()
    notes: tuple[str, ...] = ()
    table: Mapping[str, tuple[float | str, ...]] = field(default_factory=dict)
    studies: tuple[Study, ...] = ()
    pose: tuple[float, ...] = ()
    elsewhere: tuple[Elsewhere, ...] = ()
    shown: tuple[UnjudgedValue, ...] = ()
    claim: Claim | None = None
    exact: bool = False
    decides: str = "refine the models"

    def __post_init__(self) -> None:
        if self.exact is (self.numerical_uncertainty is not None):
            raise ValueError(
                "a measurement states its numerical uncertainty, or that it is exact to rounding"
            )

    @property
    def difference(self) -> float:
        """E = value − reference."""
        return self.value - self.reference

    @property
    def unexplained(self) -> float:
        """E less the allowances for named causes."""
        return self.difference - sum(allowance.amount for allowance in self.allowances)

    @property
    def numerical_uncertainty(self) -> float | None:
        """Uncertainty of what is judged: its own, or of both sides, root sum of squares.

        None where the numbers are exact to rounding.
        """
        if self.judged_uncertainty is not None:
            return self.judged_uncertainty
        known = [u for u in (self.value_uncertainty, self.reference_uncertainty) if u is not None]
        return hypot(*known) if known else None


class Skip(Exception):  # noqa: N818  not an error: the case says why it cannot be run here
    """Raised by a case that cannot be run on this machine or for this robot, with the reason."""


@dataclass(frozen=True)
class Case:
    """One comparison: what is claimed, from which source, how closely, and how to compute it.

    `id` is dotted, with parameters in brackets: "robot.beam-vjm.planar[x=0.4975]". `quantity` and
    `unit` name the value ("largest planar deflection", "µm"; "1" for ratios), `model` whose value
    it is ("segments", "solid"; empty where it is no model's). `subject` tells what a case says
    something about: the run's robot, or one of its legs, whose name is `body`. `label` is what an
    axis has room for of the quantity. `section` is the heading under which the report shows the
    case, `figure` the id of the figure that shows what it measured. `elements`: element count of
    each leg; 0 if the model has no elements or the case is about several counts. `group` names what
    expensive results the case shares: cases of one group run in the same process, one after the
    other. `effort` is the expected time in seconds, for the order of work and the time left.
    `compute` may raise ComputationError (the case has failed) or Skip.
    """

    id: str
    title: str
    quantity: str
    unit: str
    reference_kind: ReferenceKind
    citation: str
    tolerance: Tolerance
    tolerance_reason: str
    compute: Callable[[Context], Measurement]
    relation: Relation = Relation.EQUAL
    presets: tuple[Preset, ...] = PRESETS
    section: str = ""
    group: str = ""
    effort: float = 0.1
    model: str = ""
    subject: About = "robot"
    figure: str = ""
    label: str = ""
    kind: CaseKind = "comparison"
    body: str = ""
    elements: int = 0

    def measure(self, context: Context) -> Measurement:
        """What `compute` finds in the `context` of the run.

        Raises Skip also where it needs CalculiX, and there is none.
        """
        try:
            return self.compute(context)
        except CalculixMissing as missing:
            raise Skip(str(missing)) from None

    def __post_init__(self) -> None:
        for name in ("id", "title", "quantity", "unit", "citation", "tolerance_reason"):
            if not getattr(self, name).strip():
                raise ValueError(f"case {self.id!r}: {name} is empty")


def _require_positive(number: float) -> None:
    if not (isfinite(number) and number > 0.0):
        raise ValueError(f"a tolerance must be positive and finite, not {number}")


def failure_reason(subject: str, error: Exception) -> str:
    """One line that gives the reason of a failure; the traceback goes to stderr, a run's log."""
    if isinstance(error, ComputationError | InputError):
        message = str(error)
    elif isinstance(error, MemoryError):
        message = f"ran out of memory; {OUT_OF_MEMORY}"
    else:
        message = f"{type(error).__name__}: {error} (traceback in log.txt)"
    # A disk that is too full for the log must not take the result with it.
    with suppress(OSError):
        sys.stderr.write(f"\n== {subject}: {message}\n")
        traceback.print_exception(error)
        sys.stderr.flush()
    return " ".join(message.split())
