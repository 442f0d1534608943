"""Which mode of a model is which of the reference, at every pose, and where there is none."""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, IntArray
from validation.adequacy.response import Vibration
from validation.agreement.mode_pairing import mac_matrix, neighbours, pair_modes

# A mode that has less than half of its (mass-weighted, squared) shape in common is another one.
ALIKE = 0.5
# From here on a shape is its partner's own, not a mixture of close ones.
_ALONE = 0.9


@dataclass(frozen=True, eq=False)
class Partners:
    """A model's partners of the reference's first K modes at p poses (p×K each).

    `frequency` (Hz, NaN where model or reference has no such mode), `number` (from 0, −1 where
    none) and `likeness`, the squared cosine between the shape and the space of its partner and
    those close to it. `by_number` is the model's K-th frequency, NaN where it has fewer.
    """

    frequency: Array
    number: IntArray
    likeness: Array
    by_number: Array


def partners(reference: Vibration, model: Vibration, weights: Array, count: int) -> Partners:
    """Partners by shape of the reference's first `count` modes."""
    rows = [
        _at_pose(weights, count, *of_pose)
        for of_pose in zip(
            reference.frequencies,
            reference.samples,
            model.frequencies,
            model.samples,
            strict=True,
        )
    ]
    frequency, number, likeness, by_number = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    return Partners(frequency, number, likeness, by_number)


def amounts_by_shape(
    reference: Vibration, other: Vibration, amounts: Array, weights: Array, count: int
) -> Array:
    """`amounts` (p×m×n, ≥ 0) of the reference's first `count` modes and their partners (p×count).

    A mode that looks like its partner alone has their amount. Close modes that mix have the sum
    over all of them: what changes such modes changes the sum of their squares alike whichever of
    them is whose partner, but not each of them. NaN where there is no partner.
    """
    missing = partners(reference, other, weights, count).number < 0
    found = np.full(missing.shape, np.nan)
    for row, frequencies, shapes, others, other_shapes, amount in zip(
        found,
        reference.frequencies,
        reference.samples,
        other.frequencies,
        other.samples,
        amounts,
        strict=True,
    ):
        there, known = (np.flatnonzero(np.isfinite(one)) for one in (frequencies, others))
        mac = mac_matrix(shapes[:, there], other_shapes[:, known], weights)
        modes, partner = np.arange(len(there)), pair_modes(mac)
        of_pairs = np.where(partner >= 0, amount[np.ix_(there, known)][modes, partner], np.nan)
        alone = np.where(partner >= 0, mac[modes, partner], 0.0) >= _ALONE
        own = frequencies[there]
        mixed = np.array([np.nansum(of_pairs[neighbours(own, k)]) for k in range(len(own))])
        amounts_of_modes = np.where(alone | np.isnan(of_pairs), of_pairs, mixed)[:count]
        row[: len(amounts_of_modes)] = amounts_of_modes
    return np.where(missing, np.nan, found)


def frequency_changes(fine: Vibration, coarse: Vibration, weights: Array, count: int) -> Array:
    """By how much the first modes' frequencies change from one mesh to a finer one (p×count).

    Relative to the finer one's, by shape; NaN for a mode that the coarser one does not have.
    """
    changes = np.abs(coarse.frequencies[:, None, :] / fine.frequencies[:, :, None] - 1.0)
    return amounts_by_shape(fine, coarse, changes, weights, count)


def _at_pose(
    weights: Array, count: int, own: Array, own_shapes: Array, others: Array, other_shapes: Array
) -> tuple[Array, IntArray, Array, Array]:
    there, known = np.isfinite(own), np.isfinite(others)
    own, others, other_shapes = own[there], others[known], other_shapes[:, known]
    mac = mac_matrix(own_shapes[:, there], other_shapes, weights)
    partner = np.full(count, -1)
    partner[: len(own)] = pair_modes(mac)[:count]
    families = [neighbours(own, mode) for mode in range(min(count, len(own)))]
    likeness = np.zeros(count)
    for mode, family in enumerate(families):
        if (found := partner[mode]) >= 0:
            # Close modes mix: what counts is the space that they span, in either model.
            beside = neighbours(others, found)
            spanned = max(mac[mode, beside].sum(), mac[family, found].sum())
            likeness[mode] = min(spanned, 1.0)
    number = np.where(likeness >= ALIKE, partner, -1)
    frequency = np.where(number >= 0, others[number], np.nan)
    for family in families:
        # Which of close modes is whose partner is an accident: they are in order of frequency.
        inside = family[family < count]
        frequency[inside] = np.sort(frequency[inside])
        if (number[inside] >= 0).all():
            number[inside] = np.sort(number[inside])
    by_number = np.full(count, np.nan)
    by_number[: len(others)] = others[:count]
    return frequency, number, likeness, by_number
