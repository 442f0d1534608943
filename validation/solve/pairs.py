"""Pairs of the modes of two models of a mechanism, by shape.

Input: modes of one model in each posture, and the name of another model. Output: `PairedModes`.
"""

from collections.abc import Sequence

from validation.models.options import ModelName, ModelOptions
from validation.models.robot_models import PostureModes, mechanism_modes
from validation.references.mode_samples import samples_of
from validation.references.modes_on_path import vibration_of
from validation.responses.mode_partners import Partners, partners
from validation.solve.answer import ModePair, PairedModes

# Additional modes of the other model, since a partner can have a higher number.
_EXTRA_MODES = 6


def paired(
    modes_by_posture: Sequence[PostureModes], against: ModelName, options: ModelOptions
) -> list[PairedModes]:
    """Pairs of all modes in each posture with those of another model, by energy-weighted MAC."""
    postures = [modes.posture for modes in modes_by_posture]
    mechanism = postures[0].mechanism
    samples, count = samples_of(mechanism), len(modes_by_posture[0].modes.frequencies)
    searched = count + _EXTRA_MODES
    other_modes = mechanism_modes(against, postures, searched, options)
    vibration, other_vibration = (
        vibration_of(samples, postures_modes, searched)
        for postures_modes in (modes_by_posture, other_modes)
    )
    pairing = partners(vibration, other_vibration, count)
    return [
        PairedModes(against, tuple(_pair(pairing, index, mode) for mode in range(count)))
        for index in range(len(postures))
    ]


def _pair(pairing: Partners, posture: int, mode: int) -> ModePair:
    """Partner of a mode in a posture, both given by index."""
    partner_index = int(pairing.partner_indices[posture, mode])
    low, high = float(pairing.lowest[posture, mode]), float(pairing.highest[posture, mode])
    return ModePair(
        mode=mode + 1,
        partner=int(partner_index) + 1 if partner_index >= 0 else None,
        frequency=float(pairing.frequency[posture, mode]) if partner_index >= 0 else None,
        mac=float(pairing.mac[posture, mode]),
        seen=float(pairing.energy_shares[posture, mode]),
        local=bool(pairing.local[posture, mode]),
        open=(low, high) if high > low else None,
        undecided=bool(pairing.undecided[posture, mode]),
    )
