"""A comparison as a typed record (case), and its result (measurement).

Input: a function that computes a value and a reference, with tolerance, source and reason. Output:
a `Measurement`. Rule: the error is E = value − reference. Named differences between the two models
can be allowed for; the unexplained difference, E minus the allowances, is compared with the
tolerance (terms of ASME V&V 10 and 20).
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

# Comparison of two models, of a model with its own refinement, of all formulations of one leg, or
# of the designs that models choose.
CaseKind: TypeAlias = Literal["comparison", "convergence", "agreement", "decision"]
ReferenceKind: TypeAlias = Literal[
    "closed-form", "published", "paper-statement", "finer-model", "independent-solver"
]

# Remedy if memory ran out.
OUT_OF_MEMORY = "choose a smaller preset or reduce --jobs"


class Relation(Enum):
    """Claimed relation of value to reference: equal, at most, or at least as large."""

    EQUAL = "equal"
    AT_MOST = "at most"
    AT_LEAST = "at least"

    def excess(self, difference: float) -> float:
        """Amount by which `difference` (value − reference) violates the relation.

        At most zero if it holds.
        """
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
        """Tolerance in the unit of the case. Independent of the reference."""
        return self.amount


class Relative(msgspec.Struct, frozen=True, tag="relative", tag_field="kind"):
    """Tolerance as a fraction of the reference."""

    fraction: float

    def __post_init__(self) -> None:
        _require_positive(self.fraction)

    def at(self, reference: float) -> float:
        """Tolerance in the unit of the case. Raises ValueError if the reference is zero."""
        if reference == 0.0:
            raise ValueError("a relative tolerance needs a reference other than zero")
        return self.fraction * abs(reference)


Tolerance: TypeAlias = Absolute | Relative


@dataclass(frozen=True)
class Allowance:
    """Named cause and the part of value − reference that it explains (signed, unit of the case).

    `source`: section, equation or function from which the amount comes.
    """

    cause: str
    amount: float
    source: str = ""


@dataclass(frozen=True)
class Elsewhere:
    """Result of the same comparison in another pose or mode, which `where` names.

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
    """A value and its reference in `unit`, displayed without a verdict.

    `model`, `label` and `elements` as in `Case`. `half_width`: numerical uncertainty of the
    reference, None if unknown.
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
        """Relative difference (value − reference)/reference."""
        return self.value / self.reference - 1.0


@dataclass(frozen=True)
class Measurement:
    """Result of a case, in the unit of the case.

    `value_uncertainty`, `reference_uncertainty` and `judged_uncertainty`: numerical uncertainty of
    the value, of the reference and of the unexplained difference (half-widths, 95 %). The third is
    set if value and reference have the same mesh, so that its errors cancel; otherwise it follows
    from the other two. Either at least one of the three uncertainties is set, or the numbers are
    `exact`: nothing is discretised, and round-off is the only error. ValueError is raised for
    neither or both.

    `table`: columns of equal length by heading. `studies`: convergence studies and sweeps to be
    displayed with the case. `pose`: the pose of the numbers. If a case compares several poses or
    modes, one is fixed beforehand, so that runs can be compared, and `elsewhere` contains the other
    poses or modes, which are judged as well. `shown`: further values, reported without a verdict.
    `claim`: a publication's statement on this result, as printed and as corrected. `decides`:
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
    decides: str = "refine the models until the numerical uncertainty is below the tolerance"

    def __post_init__(self) -> None:
        if self.exact is (self.numerical_uncertainty is not None):
            raise ValueError(
                "a measurement must state its numerical uncertainty, or that it is exact "
                "up to round-off"
            )

    @property
    def difference(self) -> float:
        """E = value − reference."""
        return self.value - self.reference

    @property
    def unexplained(self) -> float:
        """Unexplained difference: value − reference, less the allowances for named causes."""
        return self.difference - sum(allowance.amount for allowance in self.allowances)

    @property
    def numerical_uncertainty(self) -> float | None:
        """Half-width of the unexplained difference. None if the numbers are exact up to round-off.

        It is `judged_uncertainty`. If that is None, those of value and reference are combined in
        quadrature.
        """
        if self.judged_uncertainty is not None:
            return self.judged_uncertainty
        half_widths = (self.value_uncertainty, self.reference_uncertainty)
        stated = [half_width for half_width in half_widths if half_width is not None]
        return hypot(*stated) if stated else None


class Skip(Exception):  # noqa: N818  not an error: it has the reason why the case cannot be run
    """Raised by a case that cannot be computed here or for this robot, with the reason."""


@dataclass(frozen=True, kw_only=True)
class Declaration(ScheduledTask):
    """A comparison without its numbers: the claim, its source and its tolerance.

    `id` is dotted, with parameters in brackets: "robot.beam-vjm.planar[x=0.4975]". `quantity` and
    `unit` name the value ("largest planar deflection", "µm"; "1" for ratios). `model`: model of the
    value ("segments", "solid"; "" if it comes from no model). `subject`: the run's robot, or one of
    its legs, whose name is `body`. `label`: short name of the quantity for an axis. `figure`: id of
    the figure with its result. `elements`: element count of each leg, 0 if the model has no
    elements or the case covers several counts. `tolerance` is None if it is unknown, as in a
    results.json of a failed case.
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

    `compute` can raise ComputationError (the case has failed) or Skip.
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

        Raises Skip also if the case needs CalculiX and CalculiX is not installed.
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
    """Reason of a failure in one line. The traceback goes to stderr, which is the log of a run."""
    if isinstance(error, ComputationError | InputError):
        message = str(error)
    elif isinstance(error, MemoryError):
        message = f"ran out of memory; {OUT_OF_MEMORY}"
    else:
        message = f"{type(error).__name__}: {error} (traceback in log.txt)"
    # The result is returned even if the disk is too full for the log.
    with suppress(OSError):
        sys.stderr.write(f"\n== {subject}: {message}\n")
        traceback.print_exception(error)
        sys.stderr.flush()
    return " ".join(message.split())
