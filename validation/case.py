"""A validation case as a typed record, and its measurement.

The error of a comparison is E = value − reference. Named differences between the two models may
be allowed for. The unexplained difference, E less the allowances, is compared with the tolerance
(vocabulary of ASME V&V 10 and 20).
"""

import sys
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields
from enum import Enum
from math import hypot, isfinite
from typing import Annotated, Literal, TypeAlias

import msgspec

from fem.calculix.run import CalculixMissing
from lumped.errors import ComputationError, InputError
from validation.context import About, Context, ScheduledTask
from validation.published_statements import Claim
from validation.record_fields import LISTING, RESULTS
from validation.studies_and_figures import Study

# A comparison of two models, of a model with its own refinement, or of all formulations of one leg.
CaseKind: TypeAlias = Literal["comparison", "convergence", "agreement"]
ReferenceKind: TypeAlias = Literal[
    "closed-form", "published", "paper-statement", "finer-model", "independent-solver"
]

# Remedy if memory ran out.
OUT_OF_MEMORY = "choose a smaller preset or fewer --jobs"


class Relation(Enum):
    """Claimed relation of value to reference: equal, at most, or at least as large."""

    EQUAL = "equal"
    AT_MOST = "at most"
    AT_LEAST = "at least"

    def excess(self, difference: float) -> float:
        """Violation of the relation by `difference` (value − reference). Negative if it holds."""
        match self:
            case Relation.EQUAL:
                return abs(difference)
            case Relation.AT_MOST:
                return difference
            case Relation.AT_LEAST:
                return -difference


class Absolute(msgspec.Struct, frozen=True, tag="absolute", tag_field="kind"):
    """Tolerance as an amount in the unit of the case."""

    amount: float

    def __post_init__(self) -> None:
        _require_positive(self.amount)

    def at(self, reference: float) -> float:  # noqa: ARG002  independent of the reference
        """Amount in the unit of the case."""
        return self.amount


class Relative(msgspec.Struct, frozen=True, tag="relative", tag_field="kind"):
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

    `source`: section, equation or function that the amount is from.
    """

    cause: str
    amount: float
    source: str = ""


@dataclass(frozen=True)
class Elsewhere:
    """A measurement's comparison repeated in another pose or mode, named by `where`.

    `uncertainty`: half-width of the unexplained difference. None if the numbers are exact.
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
    """A value and its reference in `unit`, shown without a verdict.

    `model`, `label` and `elements` have the meaning that they have in `Case`. `half_width`:
    numerical uncertainty of the reference. None if it is unknown.
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
    """Result of a case, in the unit of the case.

    `value_uncertainty`, `reference_uncertainty` and `judged_uncertainty` are the numerical
    uncertainties of both sides and of the unexplained difference (half-widths of a 95 % interval).
    The last is stated if both sides have one mesh, whose errors cancel. Otherwise it follows from
    the other two. Either one of them is stated, or the numbers are `exact`: nothing is discretised,
    and round-off is the only error. Neither, or both, raise ValueError. `table` maps column
    headings to equally long columns. `studies` are convergence studies and sweeps to be shown with
    the case. `pose` is the pose of the numbers. If a case compares several poses or modes, it is
    fixed beforehand, so that runs can be compared, and `elsewhere` contains the others, which are
    judged as well. Values `shown` are reported beside it without a verdict.
    `claim`: statement of a source on this result, read as printed and as corrected. `decides`:
    action or information that would decide the case if the uncertainty is too large.
    """

    value: Annotated[float, RESULTS]
    reference: Annotated[float, RESULTS]
    value_uncertainty: Annotated[float | None, RESULTS] = None
    reference_uncertainty: Annotated[float | None, RESULTS] = None
    judged_uncertainty: float | None = None
    allowances: Annotated[tuple[Allowance, ...], RESULTS] = ()
    notes: Annotated[tuple[str, ...], RESULTS] = ()
    table: Annotated[Mapping[str, tuple[float | str, ...]], RESULTS] = field(default_factory=dict)
    studies: tuple[Study, ...] = ()
    pose: Annotated[tuple[float, ...], RESULTS] = ()
    elsewhere: Annotated[tuple[Elsewhere, ...], RESULTS] = ()
    shown: Annotated[tuple[UnjudgedValue, ...], RESULTS] = ()
    claim: Claim | None = None
    exact: Annotated[bool, RESULTS] = False
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
        """Half-width of the unexplained difference: as stated, or of both sides in quadrature.

        None if the numbers are exact to rounding.
        """
        if self.judged_uncertainty is not None:
            return self.judged_uncertainty
        half_widths = (self.value_uncertainty, self.reference_uncertainty)
        stated = [half_width for half_width in half_widths if half_width is not None]
        return hypot(*stated) if stated else None


class Skip(Exception):  # noqa: N818  not an error: it has the reason why the case cannot be run
    """Raised by a case that cannot be run on this machine or for this robot, with the reason."""


@dataclass(frozen=True, kw_only=True)
class Declaration(ScheduledTask):
    """A comparison without its numbers: the claim, its source and its tolerance.

    `id` is dotted, with parameters in brackets: "robot.beam-vjm.planar[x=0.4975]". `quantity` and
    `unit` name the value ("largest planar deflection", "µm"; "1" for ratios), `model` the model
    of the value ("segments", "solid"; "" if it is from no model). `subject` is the subject of the
    case: the run's robot, or one of its legs, whose name is `body`. `label` is the quantity in the
    few words for which an axis has room. `figure` is the id of the figure that shows its result.
    `elements`: element count of each leg. 0 if the model has no elements or the case is about
    several counts. `tolerance`: None if it is unknown, as in a results.json of a failed case.
    """

    quantity: Annotated[str, RESULTS, LISTING] = ""
    unit: Annotated[str, RESULTS, LISTING] = ""
    reference_kind: Annotated[ReferenceKind | Literal[""], RESULTS, LISTING] = ""
    citation: Annotated[str, RESULTS, LISTING] = ""
    tolerance: Tolerance | None = None
    tolerance_reason: Annotated[str, RESULTS, LISTING] = ""
    relation: Annotated[Relation, RESULTS, LISTING] = Relation.EQUAL
    model: Annotated[str, RESULTS] = ""
    subject: Annotated[About, RESULTS] = "robot"
    figure: Annotated[str, RESULTS] = ""
    label: str = ""
    kind: Annotated[CaseKind, RESULTS] = "comparison"
    body: str = ""
    elements: int = 0


@dataclass(frozen=True, kw_only=True)
class Case(Declaration):
    """A declared comparison with the function that computes it.

    `compute` may raise ComputationError (the case has failed) or Skip.
    """

    compute: Callable[[Context], Measurement]
    tolerance: Tolerance
    effort: float = 0.1

    @property
    def declaration(self) -> Declaration:
        """The case without its function."""
        return Declaration(
            **{entry.name: getattr(self, entry.name) for entry in fields(Declaration)}
        )

    def measure(self, context: Context) -> Measurement:
        """Result of `compute` in the `context` of the run.

        Raises Skip also if it needs CalculiX and CalculiX is not installed.
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
    # If the disk is too full for the log, the result is kept nevertheless.
    with suppress(OSError):
        sys.stderr.write(f"\n== {subject}: {message}\n")
        traceback.print_exception(error)
        sys.stderr.flush()
    return " ".join(message.split())
