"""The adequacy of models as data: entries of a matrix model × quantity."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from lumped.acceptance.quantities import ROTATIONS, Quantity
from validation.context import PRESETS, Context, Preset

Adequacy: TypeAlias = Literal["adequate", "inadequate", "undecided"]
# The two assessments of a run by id: against what is computed, and against what was measured.
ADEQUACY, MEASURED = "adequacy", "adequacy.measured"
# The figure that shows a measured response beside those of the models.
MEASURED_RESPONSE = "measured.response"


@dataclass(frozen=True)
class Coordinate:
    """What a pose prescribes: "x" in "m", "phi_z" in "rad"."""

    name: str
    unit: str

    def __str__(self) -> str:
        return f"{self.name} ({self.unit})"

    @property
    def axis(self) -> str:
        """What an axis of a figure is labelled: "x (m)", "rotation about z (rad)"."""
        about = ROTATIONS.get(self.name)
        return f"rotation about {about} ({self.unit})" if about else str(self)


@dataclass(frozen=True)
class Cause:
    """A named cause and its share of an error (1: all of it, negative: it works against it).

    `source` says what the amount was computed from.
    """

    cause: str
    share: float
    source: str = ""


@dataclass(frozen=True)
class Entry:
    """What one model says of one quantity, judged over all poses.

    `error` is total and relative at `pose`, the one that decides: of frequencies (model −
    reference)/reference, of deflections |u − u*|/|u*| of the whole displacement, never negative.
    None where the model does not have the quantity at all or nothing is known. It is against one
    reading of the reference: where the robot file leaves something open, against the one from which
    the model is farthest. `uncertainty` is the half-width of that error. From `low` to `high` is
    every error that the readings with their half-widths leave open, by which the verdict is given;
    that of a deflection ends at zero. `readings` are the errors by the names of the readings, where
    there are several. `uncertainties` are parts by name: those of the half-width, and half of what
    lies between the readings. `value` and `expected` are the model's and the reference's numbers
    there (Hz, of "order", too; of deflections along their load, m/N or rad/(N m)), `expected_range`
    (lowest, highest) what is left open of the latter, `along` the signed error that they show,
    `force` (x, y, z) the worst direction of any force. `errors`, `spreads`, `lows` and `highs` are
    error, uncertainty, low and high at every pose, `values` the model's numbers there, `alongs` the
    signed errors along the load. `reason` says why a verdict is not "adequate" where no number
    does, and what would decide where it is undecided. `measured`: the reference is a measured
    value, `mac` how like the modes are of which it is the frequency. Where inputs are uncertain:
    `probability` (0 to 1) of being within the limit, `probability_beyond` it, `input_shares`, the
    first-order indices of Sobol' of the error by the inputs' keys, and `value_spread`, the half-
    width (95 %) that they leave open of `value`. `assumed`: what the reference is taken to cover,
    where nothing that could be computed would tell.
    """

    model: str
    quantity: Quantity
    error: float | None
    uncertainty: float | None
    limit: float
    verdict: Adequacy
    pose: tuple[float, ...]
    reference: str
    low: float | None = None
    high: float | None = None
    readings: Mapping[str, float] = field(default_factory=dict)
    causes: tuple[Cause, ...] = ()
    remedy: str = ""
    error_with_remedy: float | None = None
    reason: str = ""
    value: float | None = None
    expected: float | None = None
    expected_range: tuple[float, ...] = ()
    uncertainties: Mapping[str, float] = field(default_factory=dict)
    errors: tuple[float | None, ...] = ()
    spreads: tuple[float | None, ...] = ()
    lows: tuple[float | None, ...] = ()
    highs: tuple[float | None, ...] = ()
    values: tuple[float | None, ...] = ()
    along: float | None = None
    alongs: tuple[float | None, ...] = ()
    force: tuple[float, ...] = ()
    computed_by: tuple[str, ...] = ()
    measured: bool = False
    probability: float | None = None
    probability_beyond: float | None = None
    input_shares: Mapping[str, float] = field(default_factory=dict)
    value_spread: float | None = None
    assumed: str = ""
    mac: float | None = None

    @property
    def chance(self) -> float | None:
        """How probable the verdict is, of one that is undecided the likelier one; None if unknown.

        That is where inputs of the robot are uncertain.
        """
        if self.probability is None or self.probability_beyond is None:
            return None
        both = {"adequate": self.probability, "inadequate": self.probability_beyond}
        return both.get(self.verdict, max(both.values()))

    @property
    def signed(self) -> bool:
        """True if errors have a sign; the error of a whole displacement has none."""
        return not self.quantity.whole


@dataclass(frozen=True)
class ModelNote:
    """A model of the matrix: its name, what it is, and what it says nothing of (and why)."""

    model: str
    title: str
    silent: str = ""


@dataclass(frozen=True)
class Matrix:
    """All models by all quantities for one robot.

    `coordinates` are what a pose prescribes; `poses` (p×n) are all that were looked at.
    `notes` are facts that belong beside the matrix, `supposed` is what verdicts on frequencies
    suppose, `parts` are the matrices of the robot's parts alone, named as `robot`: each leg's, root
    clamped. Where models stand on legs that are not the robot's, `formulation` holds them against
    solids of the legs that they model: what is off in the matrix and not there is the fault of the
    legs, not of the model. `faults` name the models, and other computations, that ended with an
    error of the program: what is undecided of them says nothing about the robot.
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
        """The faults of this matrix and of those beside it, each once."""
        own = (fault for one in (self, *self.beside) for fault in one.faults)
        return tuple(dict.fromkeys(own))

    @property
    def beside(self) -> tuple["Matrix", ...]:
        """All matrices that stand beside this one."""
        return (*self.parts, *((self.formulation,) if self.formulation else ()))

    def entry(self, model: str, name: str) -> Entry | None:
        """Entry of a model and a quantity by its name. None if the model does not define it."""
        entries = (one for one in self.of_model(model) if one.quantity.name == name)
        return next(entries, None)

    def of_model(self, model: str) -> tuple[Entry, ...]:
        """All entries of a model."""
        return tuple(entry for entry in self.entries if entry.model == model)

    def verdict(self, model: str) -> Adequacy:
        """The worst verdict of a model, "undecided" better than "inadequate"."""
        return worst_of([entry.verdict for entry in self.of_model(model)] or ["undecided"])

    def fails(self, rely: Sequence[str], *, strict: bool) -> tuple[str, ...]:
        """Models relied on that are inadequate, with `strict` also those that are undecided."""
        refused = {"inadequate", "undecided"} if strict else {"inadequate"}
        return tuple(model for model in rely if self.verdict(model) in refused)


@dataclass(frozen=True)
class Assessment:
    """The matrix of a run's robot; fields as of `Case`. `compute` may raise Skip."""

    id: str
    title: str
    compute: Callable[[Context], Matrix]
    presets: tuple[Preset, ...] = PRESETS
    section: str = ""
    group: str = ""
    effort: float = 1.0


VERDICTS: tuple[Adequacy, ...] = ("adequate", "inadequate", "undecided")


def worst_of(verdicts: Sequence[Adequacy]) -> Adequacy:
    """What holds of all: inadequate where it is so of any, adequate where of all."""
    order: tuple[Adequacy, ...] = ("inadequate", "undecided", "adequate")
    return min(verdicts, key=order.index)
