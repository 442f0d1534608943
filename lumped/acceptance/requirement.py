"""Limits from a robot file: accepted model errors, and accepted differences between formulations.

The accepted errors (table [accept]) are chosen from the use of the robot before any computation
(ASME V&V 10). The table [agree] limits the differences between formulations of the same legs, such
as rigid segments, beam elements and solids.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

from lumped.acceptance.quantities import Quantity, QuantityKind, quantities
from lumped.model_choices import Ends

# Smallest relative error that a file may require: no model of a robot is more accurate.
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
    """Largest accepted errors of models, and the models that must satisfy them.

    All errors are relative, unless a unit is given. `deflection` applies to static quantities,
    `frequency` to the first `modes` natural frequencies and to the sequence of modes, `response` to
    the values of harmonic responses named in `responses`. `limits` maps the names of single
    quantities to relative limits that replace the general limit for that quantity.
    `displacement` (m), if it is not None, replaces `deflection` for the loads named in `loads`.

    `rely` names the models whose inadequacy makes a run fail. `accuracy` is the largest accepted
    half-width of the uncertainty that the meshes of the reference add to an error. If `accuracy` is
    None, meshes are refined only if this half-width exceeds a fifth of the limit.
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
        """Largest accepted relative error of `quantity`."""
        general = self.deflection if quantity.static else self.frequency
        if quantity.harmonic:
            general = self.response
        return self.limits.get(quantity.name, general)

    def absolute(self, quantity: Quantity) -> float | None:
        """Largest accepted error (m) of `quantity`. None if the limit is relative."""
        is_load = quantity.kind is QuantityKind.LOAD and quantity.name not in self.limits
        return self.displacement if is_load else None


@dataclass(frozen=True)
class AgreementLimits:
    """Largest relative differences between formulations of the same legs.

    `elements` is the number of segments or beam elements per leg. `convergence` limits the
    discretisation error with that number. `compliance` and `frequency` limit the difference between
    a formulation and solids of the same legs, less the computed amounts of known causes such as
    restrained warping. `ends` is the end condition of the solids. "as given" stands for the end
    condition in the robot file, or "rigid" for a leg without one.
    """

    elements: int = 20
    convergence: float = 0.01
    compliance: float = 0.001
    frequency: float = 0.01
    ends: SolidEnds = "as given"

    def ends_of(self, leg_ends: Ends | None) -> Ends:
        """End condition of the solid of a leg.

        `leg_ends` is the condition in the robot file, None if the file does not specify it.
        """
        return (leg_ends or "rigid") if self.ends == "as given" else self.ends


DEFAULT_LIMITS = AgreementLimits()
