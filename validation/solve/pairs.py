"""Which modes of another model are those of a mechanism, by their shapes."""

from collections.abc import Sequence
from typing import Any

from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.partners import partners
from validation.models.mechanism import PostureModes, mechanism_modes
from validation.models.options import ModelName, ModelOptions

# Modes of the other model besides as many as asked: a partner may come later in its order.
_BESIDES = 6


def paired(
    found: Sequence[PostureModes], against: ModelName, options: ModelOptions
) -> list[dict[str, Any]]:
    """Partners of all modes of `found` by mass-weighted MAC, a record of each posture's.

    Modes that lie close together count by the space that they span. None stands for no partner.
    """
    postures = [one.posture for one in found]
    mechanism = postures[0].mechanism
    samples, count = samples_of(mechanism), len(found[0].modes.frequencies)
    looked_at = count + _BESIDES
    others = mechanism_modes(against, postures, looked_at, options)
    own, other = (vibration_of(samples, ones, looked_at) for ones in (found, others))
    of_postures = partners(own, other, samples.weights, count)
    columns = of_postures.number, of_postures.frequency, of_postures.likeness
    return [
        {
            "against": against,
            "pairs": [
                {
                    "mode": mode,
                    "partner": int(number) + 1 if number >= 0 else None,
                    "frequency": float(frequency) if number >= 0 else None,
                    "mac": float(mac),
                }
                for mode, (number, frequency, mac) in enumerate(zip(*at, strict=True), start=1)
            ],
        }
        for at in zip(*columns, strict=True)
    ]
