"""The adequacy of models as data: entries of a matrix model × quantity."""

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
# Types of an entry's quantity and causes.
Q = TypeVar("Q")
C = TypeVar("C", bound="CauseShare")
# Ids of the two assessments of a run: against computed and against measured references.
ADEQUACY, MEASURED = "adequacy", "adequacy.measured"
# The figure that shows a measured response beside those of the models.
MEASURED_RESPONSE = "measured.response"


@dataclass(frozen=True)
class Coordinate:
    """Coordinate prescribed by a pose: "x" in "m", "phi_z" in "rad"."""

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
    """A named cause and its share of an error (1: all of it; negative: it works against it)."""

    cause: str
    share: float


class Cause(CauseShare, frozen=True):
    """A cause within a run, with the computation of its amount."""

    source: str = ""


class EntryRecord(msgspec.Struct, Generic[Q, C], frozen=True, kw_only=True):
    """Verdict on one quantity of one model: an object of "adequacy" in results.json.

    The only place that lists these fields: runs, results.json, CSV tables, `compare`, the API and
    the page use this class. Fields marked as `COLUMN` are columns of CSV, in this order. Numbers
    are in SI units; errors, half-widths and shares are ratios. A number that is not finite is null
    in JSON, and null is read as None. Numbers without an index of poses are those of `pose`.
    """

    # Name of the model: "vjm".
    model: Annotated[str, COLUMN]
    # A `Quantity` within a run, its name in results.json.
    quantity: Annotated[Q, COLUMN]
    verdict: Annotated[Adequacy, COLUMN]
    # Total error. Of frequencies (model − reference)/reference with its sign, of deflections
    # |u − u*|/|u*| of the whole displacement, never negative. If the robot file allows several
    # readings, it is the error against the reading from which the model is farthest. None if the
    # model does not have the quantity, or if it is not known.
    error: Annotated[float | None, COLUMN] = None
    # Half-width of `error`.
    uncertainty: Annotated[float | None, COLUMN] = None
    # Bounds of the errors by all readings with their half-widths; they decide the verdict. Those of
    # a deflection end at zero.
    low: Annotated[float | None, COLUMN] = None
    high: Annotated[float | None, COLUMN] = None
    # Largest accepted size of the error. Infinite if every error is accepted.
    limit: Annotated[float | None, COLUMN] = None
    # Signed error of the displacement along its load. None for frequencies.
    along: Annotated[float | None, Column("error along the load")] = None
    # Number of the model (Hz; of deflections along their load, m/N, rad/(N m), or m of loads).
    value: Annotated[float | None, COLUMN] = None
    # Number of the reference in the unit of `value`.
    expected: Annotated[float | None, Column("reference value")] = None
    # Reference in words.
    reference: Annotated[str, COLUMN] = ""
    # Likeness of the modes (0 to 1) whose measured and computed frequencies are compared.
    mac: Annotated[float | None, COLUMN] = None
    # Change of the model that reduces the error; "" if there is none.
    remedy: Annotated[str, COLUMN] = ""
    # Largest error over all poses after the remedy.
    error_with_remedy: Annotated[float | None, COLUMN] = None
    # Reason of a verdict that no number gives, or of an undecided one, with what would decide it.
    reason: Annotated[str, COLUMN] = ""
    # Probability (0 to 1) of an error within the limit. None unless inputs are uncertain.
    probability: Annotated[float | None, COLUMN] = None
    # Worst direction of any force (x, y, z of the base axes); () for other quantities.
    force: Annotated[tuple[float, ...], Column("worst force")] = ()
    # Deciding pose (m, rad), in the order of the robot's moves.
    pose: Annotated[tuple[float, ...], COLUMN] = ()
    # Errors by the names of the readings; {} if there is one reading.
    readings: Annotated[Mapping[str, float], COLUMN] = {}
    # Causes of `error`, the largest first.
    causes: Annotated[tuple[C, ...], COLUMN] = ()
    # Parts of the half-width by source, and half the distance between the readings.
    uncertainties: Mapping[str, float | None] = {}
    # True if the reference is a measured value.
    measured: bool = False
    # Probability (0 to 1) of an error beyond the limit.
    probability_beyond: float | None = None
    # First-order Sobol' indices of the error by the keys of the uncertain inputs.
    input_shares: Mapping[str, float] = {}
    # Half-width (95 %) of `value` due to uncertain inputs.
    value_spread: float | None = None
    # Assumption on the reference that no computation can check; "" if there is none.
    assumed: str = ""
    # All poses, in results.json only, and the values of the model at each of them.
    poses: tuple[tuple[float, ...], ...] = ()
    values: tuple[float | None, ...] = ()
    # Part of the robot, in results.json only. Not written for the robot itself.
    part: str | UnsetType = UNSET

    @property
    def signed(self) -> bool:
        """True if errors have a sign; the error of a whole displacement has none."""
        return self.along is None


class Entry(EntryRecord[Quantity, Cause], frozen=True, kw_only=True):
    """An entry within a run, with the numbers that the page shows and results.json omits."""

    # Numbers that are infinite here are None in the class above, as JSON has none.
    limit: Annotated[float, COLUMN] = inf
    uncertainties: Mapping[str, float] = {}
    # Lowest and highest number of the reference by all readings, with half-widths.
    expected_range: tuple[float, ...] = ()
    # Error, half-width, bounds and error along the load at each pose.
    errors: tuple[float | None, ...] = ()
    spreads: tuple[float | None, ...] = ()
    lows: tuple[float | None, ...] = ()
    highs: tuple[float | None, ...] = ()
    alongs: tuple[float | None, ...] = ()
    # Functions that computed the numbers.
    computed_by: tuple[str, ...] = ()

    @property
    def chance(self) -> float | None:
        """Probability of the verdict, or of the likelier one if undecided; None if unknown."""
        if self.probability is None or self.probability_beyond is None:
            return None
        probabilities = {"adequate": self.probability, "inadequate": self.probability_beyond}
        return probabilities.get(self.verdict, max(probabilities.values()))

    @property
    def signed(self) -> bool:
        """True if errors have a sign; the error of a whole displacement has none."""
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
    """All models by all quantities for one robot.

    `coordinates` are prescribed by a pose; `poses` (p×n) are all poses of the path.
    `notes` are facts that belong beside the matrix. `supposed` is the assumption of the verdicts on
    frequencies. `parts` are matrices of each leg alone, root clamped, with the leg's name as
    `robot`. If models use legs that differ from the robot's, `formulation` compares them with
    solids of the legs that they model: an error in the matrix that is absent there is due to the
    legs, not to the model. `faults` names the models, and other computations, that ended with an
    error of the program: an entry that they leave undecided is no statement about the robot.
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
        """Faults of this matrix and of its attached matrices, each once."""
        faults = (fault for matrix in (self, *self.attached) for fault in matrix.faults)
        return tuple(dict.fromkeys(faults))

    @property
    def attached(self) -> tuple["Matrix", ...]:
        """Matrices of the parts and of the formulation."""
        return (*self.parts, *((self.formulation,) if self.formulation else ()))

    def entry(self, model: str, name: str) -> Entry | None:
        """Entry of a model and a quantity by its name. None if the model does not define it."""
        entries = (entry for entry in self.of_model(model) if entry.quantity.name == name)
        return next(entries, None)

    def known_entry(self, model: str, name: str) -> Entry:
        """Entry of a model and a quantity by its name; raises InputError if there is none."""
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
        """The worst verdict of a model, "undecided" better than "inadequate"."""
        return worst_of([entry.verdict for entry in self.of_model(model)] or ["undecided"])

    def fails(self, rely: Sequence[str], *, strict: bool) -> tuple[str, ...]:
        """Models in `rely` that are inadequate, with `strict` also those that are undecided."""
        refused = {"inadequate", "undecided"} if strict else {"inadequate"}
        return tuple(model for model in rely if self.verdict(model) in refused)


@dataclass(frozen=True)
class Assessment(ScheduledTask):
    """The matrix of a run's robot. `compute` may raise Skip."""

    compute: Callable[[Context], Matrix]


VERDICTS: tuple[Adequacy, ...] = ("adequate", "inadequate", "undecided")


def worst_of(verdicts: Sequence[Adequacy]) -> Adequacy:
    """Verdict on a set: inadequate if any is inadequate, adequate if all are adequate."""
    order: tuple[Adequacy, ...] = ("inadequate", "undecided", "adequate")
    return min(verdicts, key=order.index)
