"""Limits of a robot file: accepted errors of models, and of the agreement of formulations.

Accepted errors (table [accept]) are set beforehand by the use (ASME V&V 10). Table [agree] limits
differences between formulations of the same legs.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

from lumped.acceptance.quantities import Quantity, QuantityKind, quantities
from lumped.legs import Ends

# Smallest accepted relative error: no model of a robot is more accurate.
SMALLEST_SHARE = 1e-6
# Smallest measured value or uncertainty (SI): far below the resolution of any instrument.
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
SolidEnds: TypeAlias = Literal["as given", "rigid", "free"]
# Largest number of elements per leg. Dense matrices of more elements take minutes.
MOST_ELEMENTS = 200
MODEL_KINDS: tuple[ModelKind, ...] = get_args(ModelKind)


@dataclass(frozen=True)
class Requirement:
    """Largest relative errors that are accepted, and the models that are relied on.

    `deflection` applies to all static quantities, `frequency` to the first `modes` natural
    frequencies and their order, `response` to the judged numbers of `responses` of the file, by
    name. `limits` overrides them for single quantities by name. If `displacement` (m) is given, it
    replaces `deflection` for the `loads` of the file, by name. `rely` are models whose inadequacy
    makes a run fail. `accuracy` is the largest half-width of an error due to meshes of references.
    If it is None, the half-width of an undecided error may be a fifth of its limit.
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
    def quantities(self) -> tuple[Quantity, ...]:
        """All quantities that are judged, in display order."""
        return quantities(self.loads, self.responses, self.modes)

    def limit(self, quantity: Quantity) -> float:
        """Largest accepted relative error of a quantity."""
        general = self.deflection if quantity.static else self.frequency
        if quantity.harmonic:
            general = self.response
        return self.limits.get(quantity.name, general)

    def absolute(self, quantity: Quantity) -> float | None:
        """Largest accepted error (m) of a quantity. None if a relative limit applies."""
        is_load = quantity.kind is QuantityKind.LOAD and quantity.name not in self.limits
        return self.displacement if is_load else None


@dataclass(frozen=True)
class AgreementLimits:
    """Largest relative differences between formulations, and the models that are compared.

    `elements` per leg of segments and beams. `convergence`: error with that many elements.
    `compliance` and `frequency`: difference from solids of the same legs after its allowances.
    `ends` of these solids; "as given": those of each leg, or kept plane if the file has none.
    """

    elements: int = 20
    convergence: float = 0.01
    compliance: float = 0.001
    frequency: float = 0.01
    ends: SolidEnds = "as given"

    def ends_of(self, leg_ends: Ends | None) -> Ends:
        """End condition of the solid of a leg whose own is `leg_ends`."""
        return (leg_ends or "rigid") if self.ends == "as given" else self.ends


DEFAULT_LIMITS = AgreementLimits()
