"""Partner of each mode of the reference among the modes of a model, in each pose.

Input: `PathModes` of the reference and of a model. Output: `Partners`, with the partner's frequency
and the range of frequencies that ambiguous shapes allow. Further functions compute a number for
each mode of the reference from its partners, such as its change of frequency between two meshes.
Rule: modes are partners if they have the same shape (`mode_pairing`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np

from lumped.arrays import Array, IntArray
from validation.responses.mode_pairing import (
    PARTNER_MAC,
    BoolArray,
    Pairs,
    SampledModes,
    pair_modes,
)
from validation.responses.statics_and_modes import PathModes

# A mode is local to a section if the samples, in which cross-sections and bodies move as wholes,
# contain less than this share of its kinetic energy.
_LOCAL = PARTNER_MAC
# Relative MAC of exchanged partners from which on modes count as mixed: shapes with 0.9 and
# 0.1 in common.
_SHARED = 0.1


@dataclass(frozen=True, eq=False)
class Partners:
    """A model's partners of the first K modes of the reference, in p poses (all arrays p×K).

    `frequency` (Hz) of the partner, NaN without one; `partner_indices`, counted from 0, −1 without
    one. `lowest`, `highest` (Hz): range of frequencies that the partner can have if shapes mix;
    both equal `frequency` if they do not. `undecided`: true if shapes do not show whether the model
    has the mode. `mac`: squared cosine between the shape and the space of its partner; without a
    partner, the largest energy-weighted MAC with any mode. `energy_shares`: share of the reference
    mode's kinetic energy in cross-sections and bodies that move rigidly. `ordered`: partners'
    indices, ascending as far as shapes and uncertainties allow. `loose`: true for modes whose place
    in that order is not determined. `by_number`: in column k, the k-th frequency (Hz) of the model
    regardless of shape, NaN if it has fewer.
    """

    frequency: Array
    partner_indices: IntArray
    lowest: Array
    highest: Array
    undecided: BoolArray
    mac: Array
    energy_shares: Array
    ordered: IntArray
    loose: BoolArray
    by_number: Array

    def first(self, count: int) -> "Partners":
        """Partners of the first `count` modes only."""
        return Partners(**{item.name: getattr(self, item.name)[:, :count] for item in fields(self)})

    @property
    def local(self) -> BoolArray:
        """True (p×K) for modes that the model lacks because they are local to a leg's section.

        Array sizes: p poses, K modes.
        """
        return (self.partner_indices < 0) & ~self.undecided & (self.energy_shares < _LOCAL)


def partners(
    reference: PathModes,
    model: PathModes,
    count: int,
    frequency_uncertainties: Array | None = None,
) -> Partners:
    """Partners in a model of the first `count` modes of the reference, by shape, in each pose.

    `frequency_uncertainties` (p×K): relative uncertainties of the reference's frequencies. Array
    sizes: p poses, K modes.
    """
    poses = len(reference.frequencies)
    rows = [
        _at_pose(
            of_reference,
            of_model,
            count,
            None if frequency_uncertainties is None else frequency_uncertainties[pose],
        )
        for pose, (of_reference, of_model) in zip(
            range(poses), _sampled(reference, model), strict=True
        )
    ]
    return Partners(
        **{item.name: np.array([row[item.name] for row in rows]) for item in fields(Partners)}
    )


def shares_by_shape(reference: PathModes, other: PathModes, shares: Array, count: int) -> Array:
    """Numerical values of another model's modes, assigned to the reference's modes by shape.

    `shares` (p×n, ≥ 0): a value for each mode of `other`, such as a relative half-width; NaN if
    unknown. The result (p×count) has the value of the partner of each of the first `count` modes of
    the reference, and NaN for a mode without a partner. Modes that mix have the sum over all of
    them, see `_sums`. Array sizes: p poses, n modes of `other`.
    """
    indices, mixed = _pairs(reference, other)
    partner_shares = np.take_along_axis(shares, np.maximum(indices, 0), axis=1)
    return _sums(partner_shares, indices >= 0, mixed)[:, :count]


def shape_ranges(readings: Sequence[PathModes]) -> list[tuple[Array, Array]]:
    """Range of each mode's frequency over several `readings` of the robot file.

    The list has a pair of arrays for each reading: the lowest and the highest frequency (p×m each,
    Hz) of the mode that this reading's mode becomes under any of the readings. Modes under
    different readings belong together if they have the same shape. Array sizes: p poses, m modes of
    the reading.
    """
    ranges = []
    for reading in readings:
        lowest, highest = reading.frequencies.copy(), reading.frequencies.copy()
        for other in readings:
            if other is reading:
                continue
            count = reading.frequencies.shape[1]
            frequency = partners(reading, other, count).frequency
            lowest, highest = np.fmin(lowest, frequency), np.fmax(highest, frequency)
        ranges.append((lowest, highest))
    return ranges


def frequency_changes(
    fine: PathModes, coarse: PathModes, count: int, middle: PathModes | None = None
) -> Array:
    """Relative changes of the first frequencies from a coarse mesh to a middle one (p×count, ≥ 0).

    They are relative to the frequencies of the `fine` mesh. If `middle` is None, the changes are
    those from the coarse to the fine mesh. Modes of `coarse` and `middle` are paired by shape with
    those of `fine`. NaN for a mode that is missing on one of the meshes. Array sizes: p poses.
    """
    changes, mixed = np.zeros_like(fine.frequencies), np.zeros((1, 1, 1), dtype=bool)
    paired = np.isfinite(fine.frequencies)
    for sign, modes in ((1.0, coarse), (-1.0, middle or fine)):
        # A mesh does not differ from itself.
        if modes is not fine:
            indices, mixed_here = _pairs(fine, modes)
            frequencies = np.take_along_axis(modes.frequencies, np.maximum(indices, 0), axis=1)
            changes += sign * (frequencies / fine.frequencies - 1.0)
            paired, mixed = paired & (indices >= 0), mixed | mixed_here
    return _sums(np.abs(changes), paired, mixed)[:, :count]


def _pairs(reference: PathModes, other: PathModes) -> tuple[IntArray, BoolArray]:
    """Index of each reference mode's partner in `other` (p×m), and reference modes that mix.

    The index is −1 if a mode has no partner. The second array (p×m×m) is true for two modes of the
    reference whose shapes are combined with each other in the modes of `other`. Array sizes: p
    poses, m modes of the reference.
    """
    poses, modes = reference.frequencies.shape
    indices, mixed = np.full((poses, modes), -1), np.zeros((poses, modes, modes), dtype=bool)
    for pose, sampled in enumerate(_sampled(reference, other)):
        own_modes, other_modes = (
            np.flatnonzero(np.isfinite(record.frequencies[pose])) for record in (reference, other)
        )
        pairs = pair_modes(*sampled)
        paired = pairs.partner >= 0
        indices[pose, own_modes[paired]] = other_modes[pairs.partner[paired]]
        mixed[pose][np.ix_(own_modes, own_modes)] = pairs.exchange >= _SHARED
    return indices, mixed


def _sums(amounts: Array, paired: BoolArray, mixed: BoolArray) -> Array:
    """Sum (p×m) of the `amounts` (p×m) of each mode and of all modes that mix with it.

    `paired` (p×m): true for modes with a partner. `mixed` (p×m×m): true for two modes that mix. The
    sum is NaN for a mode without a partner, and for a mode that mixes with a mode whose amount is
    unknown (NaN). Other sums stay known: the last computed modes often have no partner, because
    only some of the modes of a multiple frequency are computed.

    Sums are used because a perturbation determines the sum of the squares of the changes of modes
    that mix, but not each change. Array sizes: p poses, m modes.
    """
    amounts = np.where(paired, amounts, np.nan)
    return np.asarray(amounts + np.where(mixed, amounts[:, None, :], 0.0).sum(axis=2))


def _sampled(reference: PathModes, model: PathModes) -> Iterator[tuple[SampledModes, SampledModes]]:
    """Modes of the reference and of the model, for one pose after the other."""
    for pose in range(len(reference.frequencies)):
        yield reference.at(pose), model.at(pose)


def _at_pose(
    reference: SampledModes, model: SampledModes, count: int, frequency_uncertainties: Array | None
) -> dict[str, Array | IntArray | BoolArray]:
    """Fields of `Partners` (K each, K = `count`) in one pose, by name."""
    uncertainties = np.zeros(len(reference.frequencies))
    if frequency_uncertainties is not None:
        judged = min(len(uncertainties), len(frequency_uncertainties))
        uncertainties[:judged] = frequency_uncertainties[:judged]
    pairs = pair_modes(reference, model, uncertainties)
    frequency, lowest, highest = _frequencies(pairs, model.frequencies)
    loose = pairs.mixed.any(axis=1) | (pairs.ordered != pairs.partner)

    def first(values: Array | IntArray | BoolArray, missing: float) -> Array:
        padded: Array = np.full(count, missing, dtype=values.dtype)
        padded[: len(values)] = values[:count]
        return padded

    return {
        "frequency": first(frequency, np.nan),
        "partner_indices": first(pairs.partner, -1),
        "lowest": first(lowest, np.nan),
        "highest": first(highest, np.nan),
        "undecided": first(pairs.undecided, missing=False),
        "mac": first(pairs.mac, 0.0),
        "energy_shares": first(reference.energy_shares, 1.0),
        "ordered": first(pairs.ordered, -1),
        "loose": first(loose, missing=False),
        "by_number": first(model.frequencies, np.nan),
    }


def _frequencies(pairs: Pairs, model_frequencies: Array) -> tuple[Array, Array, Array]:
    """Partners' frequencies (m, Hz), and the lowest and highest that mixed shapes allow."""
    frequency = np.full(len(pairs.partner), np.nan)
    paired = pairs.partner >= 0
    frequency[paired] = model_frequencies[pairs.partner[paired]]
    candidates = np.where(
        pairs.mixed | np.eye(len(frequency), dtype=bool), frequency[None, :], np.nan
    )
    lowest, highest = frequency.copy(), frequency.copy()
    lowest[paired] = np.nanmin(candidates[paired], axis=1)
    highest[paired] = np.nanmax(candidates[paired], axis=1)
    return frequency, lowest, highest
