"""Comparison error and validation uncertainty (ASME V&V 20-2009, sections 1-5 and 6).

The model's error δ lies within E ± k u_val, where E = S − D is what the model gives less what was
measured and u_val² = u_num² + u_input² + u_D², three independent standard uncertainties.
"""

from dataclasses import dataclass
from math import hypot

from validation.adequacy.matrix import Adequacy
from validation.adequacy.probability import COVERAGE


@dataclass(frozen=True)
class Comparison:
    """A model's value S and a measured one D with standard uncertainties, all in one unit.

    `numerical` is that of the model's discretisation, `inputs` what the uncertain inputs of the
    robot make of it, `measurement` that of D. What they say of the model is relative to |D|.
    """

    value: float
    measured: float
    numerical: float
    inputs: float
    measurement: float

    @property
    def error(self) -> float:
        """E = S − D."""
        return (self.value - self.measured) / abs(self.measured)

    @property
    def uncertainties(self) -> dict[str, float]:
        """Half-widths of 95 % intervals by where they come from."""
        parts = {
            "numerics": self.numerical,
            "inputs": self.inputs,
            "measurement": self.measurement,
        }
        return {name: COVERAGE * part / abs(self.measured) for name, part in parts.items()}

    @property
    def uncertainty(self) -> float:
        """K u_val: the model's error lies within E ± this with 95 % confidence."""
        return hypot(*self.uncertainties.values())

    def verdict(self, limit: float) -> Adequacy:
        """By the relative `limit`.

        Adequate where the whole interval lies within it, inadequate where all of it lies without,
        on one side; else undecided.
        """
        size = abs(self.error)
        if size + self.uncertainty <= limit:
            return "adequate"
        return "inadequate" if size - self.uncertainty > limit else "undecided"
