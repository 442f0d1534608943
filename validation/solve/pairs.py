"""Which modes of another model are those of a mechanism, by their shapes."""

from collections.abc import Sequence

from validation.models.options import ModelName, ModelOptions
from validation.models.robot_models import PostureModes, mechanism_modes
from validation.references.mode_samples import samples_of
from validation.references.modes_on_path import vibration_of
from validation.responses.mode_partners import Partners, partners
from validation.solve.answer import ModePair, PairedModes

# Modes of the other model besides as many as asked: a partner may come later in its order.
_BESIDES = 6


def paired(
    found: Sequence[PostureModes], against: ModelName, options: ModelOptions
) -> list[PairedModes]:
    """Pair all modes of `found` by energy-weighed MAC, in each posture."""
    postures = [one.posture for one in found]
    mechanism = postures[0].mechanism
    samples, count = samples_of(mechanism), len(found[0].modes.frequencies)
    looked_at = count + _BESIDES
    others = mechanism_modes(against, postures, looked_at, options)
    own, other = (vibration_of(samples, ones, looked_at) for ones in (found, others))
    of_postures = partners(own, other, count)
    return [
        PairedModes(against, tuple(_pair(of_postures, at, mode) for mode in range(count)))
        for at in range(len(postures))
    ]


def _pair(found: Partners, at: int, mode: int) -> ModePair:
    """Partner of a mode in a posture (their indices)."""
    number = int(found.number[at, mode])
    low, high = float(found.lowest[at, mode]), float(found.highest[at, mode])
    return ModePair(
        mode=mode + 1,
        partner=int(number) + 1 if number >= 0 else None,
        frequency=float(found.frequency[at, mode]) if number >= 0 else None,
        mac=float(found.likeness[at, mode]),
        seen=float(found.seen[at, mode]),
        local=bool(found.local[at, mode]),
        open=(low, high) if high > low else None,
        undecided=bool(found.undecided[at, mode]),
    )
