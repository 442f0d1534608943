"""Limits on the agreement of formulations of the same legs: table [agree] of a robot file."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from lumped.legs import Ends

SolidEnds: TypeAlias = Literal["as given", "rigid", "free"]
# Elements per leg: more are dense matrices that take minutes.
MOST_ELEMENTS = 200


@dataclass(frozen=True)
class AgreementLimits:
    """Largest relative differences between formulations, and the models that are compared.

    `elements` per leg of segments and beams. `convergence`: error with that many elements.
    `compliance` and `frequency`: difference from solids of the same legs after its allowances.
    `ends` of these solids; "as given": those of each leg, kept plane if the file does not say.
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
