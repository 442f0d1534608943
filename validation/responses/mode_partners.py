"""Partners of the reference's modes among those of a model, pose by pose."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np

from lumped.arrays import Array, IntArray
from validation.responses.mode_pairing import (
    ALIKE,
    BoolArray,
    Pairs,
    SampledModes,
    pair_modes,
)
from validation.responses.statics_and_modes import PathModes

# Modes are local if the samples, cross-sections and bodies moving as wholes, have less than this
# share of their kinetic energy.
_LOCAL = ALIKE
# Likeness of exchanged partners, relative, from which on modes share their changes: shapes with
# 0.9 and 0.1 in common.
_SHARED = 0.1


@dataclass(frozen=True, eq=False)
class Partners:
    """A model's partners of the reference's first K modes at p poses (p×K each).

    `frequency` (Hz) of the partner, NaN without one, and its `number` from 0, −1 without one.
    `lowest` and `highest` (Hz) are the frequencies among which shapes that mix leave the partner
    open, equal to `frequency` if they do not mix. `undecided`: shapes do not decide whether the
    model has the mode. `likeness` is the squared cosine between the shape and the space of its
    partner, without partner the largest with any mode; `seen` the share of the reference's kinetic
    energy in cross-sections and bodies that move as wholes. `ordered` are the numbers in the most
    ascending order that shapes and uncertainties allow, `loose` the modes whose place in the order
    is open. `by_number` is the model's K-th frequency, NaN if it has fewer.
    """

    frequency: Array
    number: IntArray
    lowest: Array
    highest: Array
    undecided: BoolArray
    likeness: Array
    seen: Array
    ordered: IntArray
    loose: BoolArray
    by_number: Array

    def first(self, count: int) -> "Partners":
        """Partners of the first `count` modes alone."""
        return Partners(**{item.name: getattr(self, item.name)[:, :count] for item in fields(self)})

    @property
    def local(self) -> BoolArray:
        """Modes (p×K) that the model does not have since they are local to a leg's section."""
        return (self.number < 0) & ~self.undecided & (self.seen < _LOCAL)


def partners(
    reference: PathModes,
    model: PathModes,
    count: int,
    unsure: Array | None = None,
) -> Partners:
    """Partners by shape of the reference's first `count` modes.

    `unsure` (p×K): relative uncertainties of the reference's frequencies.
    """
    poses = len(reference.frequencies)
    rows = [
        _at_pose(own, other, count, None if unsure is None else unsure[pose])
        for pose, (own, other) in zip(range(poses), _sampled(reference, model), strict=True)
    ]
    return Partners(
        **{item.name: np.array([row[item.name] for row in rows]) for item in fields(Partners)}
    )


def amounts_by_shape(reference: PathModes, other: PathModes, amounts: Array, count: int) -> Array:
    """`amounts` (p×m×n, ≥ 0) of the reference's first `count` modes and their partners (p×count).

    A mode with the shape of its partner alone has the amount of the pair. Modes that mix have the
    sum over all of them: a perturbation fixes the sum of the squares of their changes, whichever is
    the partner of which, but not each change. NaN if there is no partner.
    """
    partner_amounts = np.full((len(amounts), count), np.nan)
    poses = zip(
        partner_amounts,
        _sampled(reference, other),
        reference.frequencies,
        other.frequencies,
        amounts,
        strict=True,
    )
    for row, modes, frequencies, other_frequencies, amount in poses:
        reference_modes, other_modes = (
            np.flatnonzero(np.isfinite(values)) for values in (frequencies, other_frequencies)
        )
        pairs = pair_modes(*modes)
        paired = np.flatnonzero(pairs.partner >= 0)
        pair_amounts = np.zeros(len(reference_modes))
        pair_amounts[paired] = amount[reference_modes[paired], other_modes[pairs.partner[paired]]]
        sums = pair_amounts + (pairs.exchange >= _SHARED) @ pair_amounts
        inside = paired[paired < count]
        row[inside] = sums[inside]
    return partner_amounts


def shape_ranges(readings: Sequence[PathModes]) -> list[tuple[Array, Array]]:
    """Lowest and highest frequency (p×m each, Hz) of the modes of each reading, by their shapes.

    The range covers all readings of one robot that have a mode of that shape.
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


def frequency_changes(fine: PathModes, coarse: PathModes, count: int) -> Array:
    """Changes of the first modes' frequencies from one mesh to a finer one (p×count).

    Relative to the finer mesh, paired by shape. NaN for a mode that the coarser mesh does not have.
    """
    changes = np.abs(coarse.frequencies[:, None, :] / fine.frequencies[:, :, None] - 1.0)
    return amounts_by_shape(fine, coarse, changes, count)


def _sampled(reference: PathModes, model: PathModes) -> Iterator[tuple[SampledModes, SampledModes]]:
    """Modes of reference and model at each pose."""
    for pose in range(len(reference.frequencies)):
        yield reference.at(pose), model.at(pose)


def _at_pose(
    own: SampledModes, other: SampledModes, count: int, unsure: Array | None
) -> dict[str, Array | IntArray | BoolArray]:
    """Fields of `Partners` at one pose."""
    uncertainties = np.zeros(len(own.frequencies))
    if unsure is not None:
        judged = min(len(uncertainties), len(unsure))
        uncertainties[:judged] = unsure[:judged]
    pairs = pair_modes(own, other, uncertainties)
    frequency, lowest, highest = _frequencies(pairs, other.frequencies)
    loose = pairs.mixed.any(axis=1) | (pairs.ordered != pairs.partner)

    def first(values: Array | IntArray | BoolArray, missing: float) -> Array:
        padded: Array = np.full(count, missing, dtype=values.dtype)
        padded[: len(values)] = values[:count]
        return padded

    return {
        "frequency": first(frequency, np.nan),
        "number": first(pairs.partner, -1),
        "lowest": first(lowest, np.nan),
        "highest": first(highest, np.nan),
        "undecided": first(pairs.undecided, missing=False),
        "likeness": first(pairs.likeness, 0.0),
        "seen": first(own.seen, 1.0),
        "ordered": first(pairs.ordered, -1),
        "loose": first(loose, missing=False),
        "by_number": first(other.frequencies, np.nan),
    }


def _frequencies(pairs: Pairs, model_frequencies: Array) -> tuple[Array, Array, Array]:
    """Frequencies (m, Hz) of the partners, and the lowest and highest that shapes leave open."""
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
