"""Which modes of another model are those of a mechanism, by their shapes."""

from collections.abc import Sequence
from typing import Any

from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.partners import Partners, partners
from validation.models.mechanism import PostureModes, mechanism_modes
from validation.models.options import ModelName, ModelOptions

# Modes of the other model besides as many as asked: a partner may come later in its order.
_BESIDES = 6


def paired(
    found: Sequence[PostureModes], against: ModelName, options: ModelOptions
) -> list[dict[str, Any]]:
    """Partners of all modes of `found` by energy-weighed MAC, a record of each posture's.

    `seen` is the share of a mode's kinetic energy in cross-sections and bodies that move as wholes.
    None stands for no partner.
    """
    postures = [one.posture for one in found]
    mechanism = postures[0].mechanism
    samples, count = samples_of(mechanism), len(found[0].modes.frequencies)
    looked_at = count + _BESIDES
    others = mechanism_modes(against, postures, looked_at, options)
    own, other = (vibration_of(samples, ones, looked_at) for ones in (found, others))
    of_postures = partners(own, other, count)
    return [
        {
            "against": against,
            "pairs": [_record(of_postures, at, mode) for mode in range(count)],
        }
        for at in range(len(postures))
    ]


def _record(found: Partners, at: int, mode: int) -> dict[str, Any]:
    """Partner of a mode in a posture (their indices)."""
    number = int(found.number[at, mode])
    ends = found.lowest[at, mode], found.highest[at, mode]
    return {
        "mode": mode + 1,
        "partner": int(number) + 1 if number >= 0 else None,
        "frequency": float(found.frequency[at, mode]) if number >= 0 else None,
        "mac": float(found.likeness[at, mode]),
        "seen": float(found.seen[at, mode]),
        "local": bool(found.local[at, mode]),
        # Frequencies (Hz) of all modes that may be the partner, if shapes do not decide.
        "open": [float(end) for end in ends] if ends[1] > ends[0] else None,
        "undecided": bool(found.undecided[at, mode]),
    }
