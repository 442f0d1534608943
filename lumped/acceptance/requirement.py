"""What a designer asks of a model, set beforehand by the use (ASME V&V 10): table [accept]."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

# Base axes, in the order of rows and columns of every 6×6. As quantities: the displacement of the
# loaded point under a force along the axis, its rotation under a moment about it.
AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# The displacement under the force of that direction in which the model is farthest off.
ANY_FORCE = "any_force"
STATIC_QUANTITIES = (*AXES, ANY_FORCE)
# The axis of those that are rotations.
ROTATIONS = {"phi_x": "x", "phi_y": "y", "phi_z": "z"}
# Of displacements under loads of the robot file, with the load's name behind it.
LOAD = "load:"
# Of responses of the robot file: with a name behind it the height of the peak, with ".frequency"
# behind that its frequency, with ".at" the size of the response at one frequency.
RESPONSE = "response:"
# Of measured ones: with "f2" behind it the size at that mode, with "low" far below all of them.
OF_HAMMER = f"{RESPONSE}hammer."
ORDER = "order"
MOST_MODES = 10
# Names of natural frequencies with their number.
FREQUENCIES = {f"f{number}": number for number in range(1, MOST_MODES + 1)}
# No model of a robot is known better than to this relative error.
SMALLEST_SHARE = 1e-6
# Of measured values and their uncertainties (SI): far below what any instrument resolves.
SMALLEST_MEASURED = 1e-30
ModelKind: TypeAlias = Literal[
    "simplified",
    "vjm",
    "vjm-equivalent",
    "links",
    "segments",
    "beam",
    "segments-euler-bernoulli",
    "beam-euler-bernoulli",
    "segments-condensed",
    "segments-stepped",
]
MODEL_KINDS: tuple[ModelKind, ...] = get_args(ModelKind)


def is_static(quantity: str) -> bool:
    """Whether a quantity is a deflection: under unit wrenches, or under a load of the file."""
    return quantity in STATIC_QUANTITIES or quantity.startswith(LOAD)


@dataclass(frozen=True)
class Requirement:
    """Largest relative errors that are accepted, and the models that are relied on.

    `deflection` holds for all static quantities, `frequency` for the first `modes` natural
    frequencies and their order, `response` for what is judged of `responses` of the file, by name;
    `limits` overrides them for single quantities by name. Of `loads` of the file, by name, an error
    of `displacement` (m) is accepted in place of `deflection`, where it is given. `rely` are models
    whose inadequacy makes a run fail. `accuracy` is what meshes of references may leave open of any
    error; None: of an error that they leave undecided, a fifth of its limit.
    """

    deflection: float = 0.05
    frequency: float = 0.05
    modes: int = 4
    rely: tuple[str, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)
    accuracy: float | None = None
    loads: tuple[str, ...] = ()
    displacement: float | None = None
    response: float = 0.05
    responses: tuple[str, ...] = ()

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all quantities that are judged."""
        loads = (f"{LOAD}{name}" for name in self.loads)
        responses = (f"{RESPONSE}{name}" for name in self.responses)
        return (*STATIC_QUANTITIES, *loads, *list(FREQUENCIES)[: self.modes], ORDER, *responses)

    def limit(self, quantity: str) -> float:
        """Largest relative error that is accepted of a quantity."""
        general = self.deflection if is_static(quantity) else self.frequency
        if quantity.startswith(RESPONSE):
            general = self.response
        return self.limits.get(quantity, general)

    def absolute(self, quantity: str) -> float | None:
        """Largest error (m) that is accepted of a quantity, where no share of it limits that."""
        of_load = quantity.startswith(LOAD) and quantity not in self.limits
        return self.displacement if of_load else None
