"""What a designer asks of a model, set beforehand by the use (ASME V&V 10): table [accept]."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias, get_args

from lumped.errors import InputError

# Base axes, in the order of rows and columns of every 6×6. As quantities: the displacement of the
# loaded point under a force along the axis, its rotation under a moment about it.
AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# The displacement under the force of that direction in which the model is farthest off.
ANY_FORCE = "any_force"
STATIC_QUANTITIES = (*AXES, ANY_FORCE)
# The axis of those that are rotations.
ROTATIONS = {"phi_x": "x", "phi_y": "y", "phi_z": "z"}
ORDER = "order"
MOST_MODES = 10
# Names of natural frequencies with their number.
FREQUENCIES = {f"f{number}": number for number in range(1, MOST_MODES + 1)}
# No model of a robot is known better than to this relative error.
SMALLEST_SHARE = 1e-6
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


@dataclass(frozen=True)
class Requirement:
    """Largest relative errors that are accepted, and the models that are relied on.

    `deflection` holds for all static quantities, `frequency` for the first `modes` natural
    frequencies and their order; `limits` overrides them for single quantities by name. `rely` are
    models whose inadequacy makes a run fail.
    """

    deflection: float = 0.05
    frequency: float = 0.05
    modes: int = 4
    rely: tuple[str, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all quantities that are judged."""
        return (*STATIC_QUANTITIES, *list(FREQUENCIES)[: self.modes], ORDER)

    def limit(self, quantity: str) -> float:
        """Largest relative error that is accepted of a quantity."""
        general = self.deflection if quantity in STATIC_QUANTITIES else self.frequency
        return self.limits.get(quantity, general)


def with_options(
    requirement: Requirement, accept: Sequence[str], rely: Sequence[str]
) -> Requirement:
    """The requirement as `--accept NAME=NUMBER` and `--rely MODEL` change it.

    NAME is deflection, frequency, modes or a quantity; named models take the place of the file's.
    Raises InputError with one line per fault.
    """
    faults = [
        f"--rely {model}: no such model; must be one of {', '.join(MODEL_KINDS)}"
        for model in rely
        if model not in MODEL_KINDS
    ]
    for text in accept:
        try:
            requirement = _changed(requirement, text)
        except ValueError as error:
            faults.append(f"--accept {text}: {error}")
    if faults:
        raise InputError(faults)
    return replace(requirement, rely=tuple(rely)) if rely else requirement


def _changed(requirement: Requirement, text: str) -> Requirement:
    name, _, given = text.partition("=")
    if name == "modes":
        if not (given.isascii() and given.isdecimal() and 1 <= int(given[:9]) <= MOST_MODES):
            raise ValueError(f"must be a whole number from 1 to {MOST_MODES}")
        return replace(requirement, modes=int(given))
    known = ("deflection", "frequency", "modes", *requirement.quantities)
    if name not in known:
        raise ValueError(f"must be NAME=NUMBER with a name of {', '.join(known)}")
    try:
        limit = float(given)
    except ValueError:
        raise ValueError("must be NAME=NUMBER, a relative error (0.03 is 3 %)") from None
    if not SMALLEST_SHARE <= limit <= 1.0:
        raise ValueError(f"must be from {SMALLEST_SHARE:g} to 1 (0.03 is 3 %)")
    if name == "deflection":
        return replace(requirement, deflection=limit)
    if name == "frequency":
        return replace(requirement, frequency=limit)
    return replace(requirement, limits={**requirement.limits, name: limit})
