"""What the references of all robots have in common, whatever computes them."""

from collections.abc import Sequence

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, Leg
from validation.adequacy.legs import step_uncertainty
from validation.adequacy.partners import partners
from validation.adequacy.response import Alternative, Reference, Response, Vibration, finer_by
from validation.context import Preset
from validation.solids.legs import divisions_across
from validation.solids.size import larger_preset, too_large
from validation.studies.paired_robot_modes import DIVISIONS, WALL_DIVISIONS

_OPEN_MASS = "where the legs' mass lies"
_SAY_MASS = "the legs' mass distribution: a section and a material in place of the 6×6"


def meshed_alternative(
    name: str,
    coarse: Vibration,
    fine: Vibration,
    weights: Array,
    judged: int,
    ratio: float,
    further: Array | float,
) -> Alternative:
    """An alternative known on two meshes whose sizes are as `ratio`.

    `further` (relative) is what else its frequencies leave open. A mode that the coarser mesh does
    not have is known to no digit.
    """
    found = partners(fine, coarse, weights, judged).frequency
    step = step_uncertainty(found, fine.frequencies[:, :judged], ratio)
    dynamic = np.where(np.isnan(step), 1.0, step + further)
    return Alternative(name, Response(vibration=fine), dynamic=dynamic)


def largest_change(coarse: Vibration, fine: Vibration, weights: Array, judged: int) -> Array:
    """Largest relative change of the first frequencies from one to the other, by shape (p×1)."""
    found = partners(fine, coarse, weights, judged).frequency
    change = np.abs(found / fine.frequencies[:, :judged] - 1.0)
    return np.asarray(np.nanmax(change, axis=1, keepdims=True, initial=0.0))


def dynamic_reference_of(
    title: str,
    alternatives: Sequence[Alternative],
    computed_by: str,
    *,
    left_open: str,
    says: str,
    finer: str,
    given: bool,
) -> Reference:
    """The reference of frequencies: where legs are `given` without their mass, a bracket alone.

    `left_open` and what `says` it are of ends and interfaces, empty where the file says all;
    `finer` is what would leave less of the meshes.
    """
    masses = given * [_OPEN_MASS], given * [_SAY_MASS]
    return Reference(
        title=title,
        alternatives=alternatives,
        open=" and ".join([*filter(None, [left_open]), *masses[0]]),
        decides="; ".join([*filter(None, [says]), *masses[1]]),
        finer=finer,
        bracket=given,
        computed_by=(computed_by,),
    )


def why_unmeshed(legs: Sequence[Leg], preset: Preset) -> str:
    """Why a preset does not mesh those of the legs that are prisms; or ""."""
    prisms = [leg for leg in legs if isinstance(leg, ConstantLeg)]
    numbers = DIVISIONS[preset], WALL_DIVISIONS[preset]
    return too_large(prisms, [divisions_across(leg, *numbers) for leg in prisms], preset)


def finer_preset(legs: Sequence[Leg], preset: Preset) -> str:
    """What would leave less of the meshes of these legs: a larger preset, if one meshes them."""
    return finer_by(larger_preset(preset, lambda one: not why_unmeshed(legs, one)))


def bracketed_frequencies(reference: Reference, modes: int, where: str) -> str:
    """What plausible masses leave open of the frequencies in the middle of the path, in words.

    Empty where they are known.
    """
    if not reference.bracket:
        return ""
    answers = [one.response.vibration for one in reference.alternatives]
    found = np.array([one.frequencies[len(one.frequencies) // 2, :modes] for one in answers if one])
    spans = [
        f"f{k + 1} {low:.4g} to {high:.4g} Hz"
        for k, (low, high) in enumerate(zip(found.min(axis=0), found.max(axis=0), strict=True))
    ]
    return (
        "frequencies cannot be judged without the legs' mass distribution; plausible ones give "
        f"{', '.join(spans)} {where}"
    )
