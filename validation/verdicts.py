"""Data records of the adequacy of models: entries of a matrix of models by quantities.

Input: errors, verdicts and causes. Output: `Entry`, `Matrix` and their form in results.json. Rule
for the verdict of a model: inadequate if any of its entries is, adequate if all are, otherwise
undecided.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Annotated, Generic, Literal, TypeAlias, TypeVar

import msgspec
from msgspec import UNSET, UnsetType

from lumped.acceptance.quantities import ROTATIONS, Quantity
from lumped.errors import InputError
from validation.context import Context, ScheduledTask
from validation.record_fields import COLUMN, Column

Adequacy: TypeAlias = Literal["adequate", "inadequate", "undecided"]
# Types of the quantity and of the causes of an entry.
Q = TypeVar("Q")
C = TypeVar("C", bound="CauseShare")
# Ids of the two assessments of a run: against computed and against measured references.
ADEQUACY, MEASURED = "adequacy", "adequacy.measured"
# Id of the figure with a measured response and the responses of the models.
MEASURED_RESPONSE = "measured.response"


@dataclass(frozen=True)
class Coordinate:
    """Coordinate that a pose prescribes: "x" in "m", "phi_z" in "rad"."""

    name: str
    unit: str

    def __str__(self) -> str:
        return f"{self.name} ({self.unit})"

    @property
    def axis(self) -> str:
        """Label of an axis of a figure: "x (m)", "rotation about z (rad)"."""
        axis_name = ROTATIONS.get(self.name)
        return f"rotation about {axis_name} ({self.unit})" if axis_name else str(self)


class CauseShare(msgspec.Struct, frozen=True):
    """Named cause and its share of an error: 1 for all of it, negative if it reduces the error."""

    cause: str
    share: float


class Cause(CauseShare, frozen=True):
    """Cause within a run, with the computation from which its amount comes."""

    source: str = ""


class EntryRecord(msgspec.Struct, Generic[Q, C], frozen=True, kw_only=True):
    """Verdict on one quantity of one model: an object of "adequacy" in results.json.

    These fields are listed here only: runs, results.json, CSV tables, `compare`, the API and the
    page use this class. Fields annotated with `COLUMN` are columns of CSV, in this order. Numbers
    are in SI units; errors, half-widths and shares are ratios. A number that is not finite is null
    in JSON, and null is read as None. `values` are those in all `poses`, `error_with_remedy` is the
    largest over them. All other numbers belong to `pose`.
    """

    # Name of the model, such as "vjm".
    model: Annotated[str, COLUMN]
    # A `Quantity` within a run, its name in results.json.
    quantity: Annotated[Q, COLUMN]
    verdict: Annotated[Adequacy, COLUMN]
    # Error of a frequency: (model − reference)/reference, signed. Of a displacement: |u − u*|/|u*|
    # of the whole vector, never negative. If the robot file allows several readings, the error
    # against the reading from which the model is farthest. None if the model does not define the
    # quantity, or if it is unknown.
    error: Annotated[float | None, COLUMN] = None
    # Half-width of `error`.
    uncertainty: Annotated[float | None, COLUMN] = None
    # Lowest and highest error over all readings with their half-widths; they decide the verdict.
    # Those of a displacement are not below zero.
    low: Annotated[float | None, COLUMN] = None
    high: Annotated[float | None, COLUMN] = None
    # Largest accepted magnitude of the error. Infinite if any error is accepted.
    limit: Annotated[float | None, COLUMN] = None
    # Signed error of the displacement component along the load. None for frequencies.
    along: Annotated[float | None, Column("error along the load")] = None
    # Value of the model: Hz; for displacements along their load, m/N, rad/(N m), or m for loads.
    value: Annotated[float | None, COLUMN] = None
    # Value of the reference, in the unit of `value`.
    expected: Annotated[float | None, Column("reference value")] = None
    # Description of the reference.
    reference: Annotated[str, COLUMN] = ""
    # MAC (0 to 1) of the modes whose measured and computed frequencies are compared.
    mac: Annotated[float | None, COLUMN] = None
    # Change of the model that reduces the error. "" if there is none.
    remedy: Annotated[str, COLUMN] = ""
    # Largest error over all poses after the remedy.
    error_with_remedy: Annotated[float | None, COLUMN] = None
    # Reason of a verdict without numbers, or of an undecided one, with the information that would
    # decide it.
    reason: Annotated[str, COLUMN] = ""
    # Probability (0 to 1) of an error within the limit. None unless inputs are uncertain.
    probability: Annotated[float | None, COLUMN] = None
    # Worst direction of any force (x, y, z of the base axes). () for other quantities.
    force: Annotated[tuple[float, ...], Column("worst force")] = ()
    # Deciding pose (m, rad), in the order of the robot's moves.
    pose: Annotated[tuple[float, ...], COLUMN] = ()
    # Errors by the names of the readings. {} if there is one reading.
    readings: Annotated[Mapping[str, float], COLUMN] = {}
    # Causes of `error`, the largest first.
    causes: Annotated[tuple[C, ...], COLUMN] = ()
    # Half-widths by source of uncertainty, and half the distance between the readings.
    uncertainties: Mapping[str, float | None] = {}
    # True if the reference is a measured value.
    measured: bool = False
    # Probability (0 to 1) of an error beyond the limit.
    probability_beyond: float | None = None
    # Share of each uncertain input in the error's variance (first-order Sobol' index), by key.
    input_shares: Mapping[str, float] = {}
    # Half-width (95 %) of `value` due to uncertain inputs.
    value_spread: float | None = None
    # Assumption on the reference that no computation can check. "" if there is none.
    assumed: str = ""
    # All poses, in results.json only, and the values of the model at each of them.
    poses: tuple[tuple[float, ...], ...] = ()
    values: tuple[float | None, ...] = ()
    # Part of the robot, in results.json only. Not written for the robot itself.
    part: str | UnsetType = UNSET

    @property
    def signed(self) -> bool:
        """True if errors have a sign. The error of a displacement vector is never negative."""
        return self.along is None


class Entry(EntryRecord[Quantity, Cause], frozen=True, kw_only=True):
    """Entry within a run, with numbers that the page displays and results.json omits."""

    # The base class has None for infinity, which JSON lacks.
    limit: Annotated[float, COLUMN] = inf
    uncertainties: Mapping[str, float] = {}
    # Lowest and highest value of the reference over all readings, with half-widths.
    expected_range: tuple[float, ...] = ()
    # Error, bounds, and error along the load in each pose.
    errors: tuple[float | None, ...] = ()
    lows: tuple[float | None, ...] = ()
    highs: tuple[float | None, ...] = ()
    alongs: tuple[float | None, ...] = ()
    # Functions that computed the numbers.
    computed_by: tuple[str, ...] = ()

    @property
    def chance(self) -> float | None:
        """Probability that the verdict is true with uncertain inputs. None if unknown.

        If the verdict is "undecided", it is the larger of the probabilities of "adequate" and of
        "inadequate".
        """
        if self.probability is None or self.probability_beyond is None:
            return None
        probabilities = {"adequate": self.probability, "inadequate": self.probability_beyond}
        return probabilities.get(self.verdict, max(probabilities.values()))

    @property
    def signed(self) -> bool:
        """True if errors have a sign. The error of a displacement vector is never negative."""
        return not self.quantity.whole


@dataclass(frozen=True)
class ModelNote:
    """A model of the matrix: name, description, and the quantities that it does not define.

    `undefined` names those quantities with the reason. "" if there are none.
    """

    model: str
    title: str
    undefined: str = ""


@dataclass(frozen=True)
class Matrix:
    """Verdicts on all models for all quantities of one robot.

    `coordinates`: the n coordinates that a pose prescribes. `poses` (p×n): all poses of the path.
    `notes`: facts to be displayed with the matrix. `supposed`: assumption behind verdicts on
    frequencies. `parts`: matrices of each leg alone with its root clamped, whose `robot` is the
    leg's name. `formulation`: second matrix, in which models are compared with solids of the legs
    that the models use; None if the models use the robot's legs. An error that the second matrix
    lacks is due to the legs, not to the model. `faults`: names of the models, and of other
    computations, that ended with an error of the program; an entry that is undecided for this
    reason is no statement about the robot. Shapes: p poses, n coordinates.
    """

    robot: str
    coordinates: tuple[Coordinate, ...]
    poses: tuple[tuple[float, ...], ...]
    models: tuple[ModelNote, ...]
    quantities: tuple[Quantity, ...]
    entries: tuple[Entry, ...]
    notes: tuple[str, ...] = ()
    supposed: str = ""
    parts: tuple["Matrix", ...] = ()
    formulation: "Matrix | None" = None
    faults: tuple[str, ...] = ()

    @property
    def all_faults(self) -> tuple[str, ...]:
        """Faults (see `Matrix`) of this matrix and of its attached matrices, each once."""
        faults = (fault for matrix in (self, *self.attached) for fault in matrix.faults)
        return tuple(dict.fromkeys(faults))

    @property
    def attached(self) -> tuple["Matrix", ...]:
        """Matrices in `parts`, then `formulation` unless it is None (see `Matrix`)."""
        return (*self.parts, *((self.formulation,) if self.formulation else ()))

    def entry(self, model: str, name: str) -> Entry | None:
        """Entry of a model and a quantity by name. None if the model does not define it."""
        entries = (entry for entry in self.of_model(model) if entry.quantity.name == name)
        return next(entries, None)

    def known_entry(self, model: str, name: str) -> Entry:
        """Entry of a model and a quantity by name. Raises InputError if there is none."""
        if entry := self.entry(model, name):
            return entry
        models = [note.model for note in self.models]
        names = [quantity.name for quantity in self.quantities]
        for kind, word, allowed in (("model", model, models), ("quantity", name, names)):
            if word not in allowed:
                raise InputError(f'{kind} "{word}" is not judged; there are {", ".join(allowed)}')
        raise InputError(f'model "{model}" does not define "{name}"')

    def of_model(self, model: str) -> tuple[Entry, ...]:
        """All entries of a model."""
        return tuple(entry for entry in self.entries if entry.model == model)

    def verdict(self, model: str) -> Adequacy:
        """Worst verdict of a model. "undecided" is better than "inadequate"."""
        return worst_of([entry.verdict for entry in self.of_model(model)] or ["undecided"])

    def fails(self, rely: Sequence[str], *, strict: bool) -> tuple[str, ...]:
        """Models in `rely` that are inadequate. With `strict` also those that are undecided."""
        refused = {"inadequate", "undecided"} if strict else {"inadequate"}
        return tuple(model for model in rely if self.verdict(model) in refused)


@dataclass(frozen=True)
class Assessment(ScheduledTask):
    """Task that computes the matrix of a run's robot. `compute` can raise Skip."""

    compute: Callable[[Context], Matrix]


VERDICTS: tuple[Adequacy, ...] = ("adequate", "inadequate", "undecided")


def worst_of(verdicts: Sequence[Adequacy]) -> Adequacy:
    """Common verdict: inadequate if any is inadequate, adequate if all are adequate.

    Otherwise undecided.
    """
    order: tuple[Adequacy, ...] = ("inadequate", "undecided", "adequate")
    return min(verdicts, key=order.index)
