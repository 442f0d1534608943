"""Which mode of one model of a mechanism is which of another, by their shapes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.partners import Partners, partners
from validation.models.mechanism import PostureModes, mechanism_modes
from validation.models.options import ModelName, ModelOptions

# Modes of the other model besides as many as asked: a partner may come later in its order.
_BESIDES = 6


@dataclass(frozen=True, eq=False)
class Pairs:
    """Partners of a model's modes among those of the model `against`, posture by posture."""

    against: ModelName
    partners: Partners

    def record(self, place: int) -> dict[str, Any]:
        """The partner of every mode in the posture of that number, for programs; null for none."""
        found = self.partners
        ofs = zip(found.number[place], found.frequency[place], found.likeness[place], strict=True)
        return {
            "against": self.against,
            "pairs": [
                {"mode": mode, "partner": None, "frequency": None, "mac": float(mac)}
                if number < 0
                else {
                    "mode": mode,
                    "partner": int(number) + 1,
                    "frequency": float(frequency),
                    "mac": float(mac),
                }
                for mode, (number, frequency, mac) in enumerate(ofs, start=1)
            ],
        }


def paired(found: Sequence[PostureModes], against: ModelName, options: ModelOptions) -> Pairs:
    """Partners of all modes of `found` by mass-weighted MAC.

    Modes that lie close together count by the space that they span.
    """
    postures = [one.posture for one in found]
    mechanism = postures[0].mechanism
    samples, count = samples_of(mechanism), len(found[0].modes.frequencies)
    others = mechanism_modes(against, postures, count + _BESIDES, options)
    own, other = (vibration_of(samples, ones) for ones in (found, others))
    return Pairs(against, partners(own, other, samples.weights, count))
