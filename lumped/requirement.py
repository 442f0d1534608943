"""What a designer asks of a model, set beforehand by the use (ASME V&V 10): table [accept]."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

# Deflection or rotation of the loaded point under its own unit force or unit moment, base axes.
STATIC_QUANTITIES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
ORDER = "order"
MOST_MODES = 10
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
        frequencies = tuple(f"f{number + 1}" for number in range(self.modes))
        return (*STATIC_QUANTITIES, *frequencies, ORDER)

    def limit(self, quantity: str) -> float:
        """Largest relative error that is accepted of a quantity."""
        general = self.deflection if quantity in STATIC_QUANTITIES else self.frequency
        return self.limits.get(quantity, general)
