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
    robot make of it, `measurement` that of D.
    """

    value: float
    measured: float
    numerical: float
    inputs: float
    measurement: float

    @property
    def error(self) -> float:
        """E = S − D."""
        return self.value - self.measured

    @property
    def validation_uncertainty(self) -> float:
        """u_val, standard."""
        return hypot(self.numerical, self.inputs, self.measurement)

    @property
    def interval(self) -> tuple[float, float]:
        """Lowest and highest error of the model with 95 % confidence."""
        half = COVERAGE * self.validation_uncertainty
        return self.error - half, self.error + half

    def verdict(self, limit: float) -> Adequacy:
        """By the relative `limit` of the measured value.

        Adequate where the whole interval lies within it, inadequate where all of it lies without,
        on one side; else undecided.
        """
        accepted = limit * abs(self.measured)
        low, high = self.interval
        if low >= -accepted and high <= accepted:
            return "adequate"
        return "inadequate" if low > accepted or high < -accepted else "undecided"
