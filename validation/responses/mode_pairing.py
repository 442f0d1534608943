"""Pairs of modes of two models with the same shape.

Input: frequencies and sampled shapes of two models in one pose. Output: the partner of each mode of
the first model among those of the second, if it has one. Rule: modes are assigned to each other so
that the sum of their energy-weighted MAC is largest; two assigned modes are partners if their
energy-weighted MAC is at least 0.5.

The energy-weighted MAC is (aᵀWb)² / (aᵀWa · bᵀWb), with the masses W at the sample points (Allemang
& Brown, IMAC 1982), times the smaller over the larger of the two modes' sampled shares of kinetic
energy. The samples contain all energy of a beam mode. For a beam mode and another mode, the
energy-weighted MAC is therefore the squared overlap (aᵀMb)² in the mass matrix M of the whole
robot. A local mode of a section, of whose energy the samples contain 5 %, has an energy-weighted
MAC of at most 0.05 with any beam mode.

Modes of equal frequency span a space, and any combination of them is a mode, too. Such spaces are
compared by the squared cosines of their principal angles (Björck & Golub, Math. Comput. 27 (1973)
579).
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.beam_properties import BeamProperties

# Smallest energy-weighted MAC of partners. Of several orthogonal shapes, at most one can have a MAC
# above one half with a given shape.
PARTNER_MAC = 0.5
# First number: two pairs are ambiguous if exchanging their partners keeps at least this fraction of
# their MAC, as for modes rotated into each other by 35 to 55 degrees. Second number: a pair
# above this MAC is certain, since other orthogonal shapes share at most the remainder.
_UNDECIDED, _DECIDED = 0.5, 2.0 / 3.0
# Relative frequency gap beyond which modes of mixed shapes are distinct: modes so far apart are
# rotated into each other by 35 degrees only if the models differ by as much (Davis & Kahan, SIAM J.
# Numer. Anal. 7 (1970) 1).
_FAR = 0.25
# Relative gap up to which frequencies are repeated: coordinates with six digits split them by some
# millionths.
_REPEATED = 1e-5
# Penalty on the squared difference of mode numbers. It decides only between equal values of the
# MAC, since it is smaller than any difference of the MAC that matters.
_TIE = 1e-9
# Singular values below this fraction of the largest one are round-off.
_RANK = 1e-6

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class SampledModes:
    """Modes of one model in one posture, sampled at points common to all models.

    `frequencies` (m, Hz, ascending). `shapes` (k×m): unit columns, each sample multiplied by the
    root of its mass. `energy_shares` (m): share of each mode's kinetic energy that the samples
    contain. Array sizes: m modes, k samples.
    """

    frequencies: Array
    shapes: Array
    energy_shares: Array


@dataclass(frozen=True, eq=False)
class Pairs:
    """Partners of m modes of one model among the modes of another.

    `nearest` (m): index of the assigned mode, such that the sum of energy-weighted MAC is largest;
    −1 if the other model has fewer modes. `partner` (m): index of the partner, −1 if the shape of
    `nearest` differs. Modes of equal frequency have partners in ascending order. `mac` (m): squared
    cosine between the mode and the space of its partner. Without a partner, the largest
    energy-weighted MAC with any mode. `exchange` (m×m): sum of the MAC of two pairs if their
    partners are exchanged, over that without exchange; zero for modes of equal and of well
    separated frequencies. `mixed` (m×m): true for two pairs of different frequencies whose shapes
    do not show which partner belongs to which mode. `undecided` (m): true for modes without a
    partner because several modes share the shapes of fewer modes of the other model. `ordered` (m):
    partners, of which those of mixed modes, and of modes closer than their uncertainty, are sorted
    in ascending order.
    """

    nearest: IntArray
    partner: IntArray
    mac: Array
    exchange: Array
    mixed: BoolArray
    undecided: BoolArray
    ordered: IntArray


def sampled_modes(
    frequencies: Array, samples: Array, energy_shares: Array | None = None
) -> SampledModes:
    """Modes with unit shapes, from samples (k×m) already multiplied by the root of each mass.

    `energy_shares` (m): share of kinetic energy that the samples contain. If None, they contain all
    of it. Array sizes: m modes, k samples.
    """
    sizes = np.linalg.norm(samples, axis=0)
    shapes = samples / np.where(sizes > 0.0, sizes, 1.0)
    return SampledModes(
        frequencies, shapes, np.ones_like(sizes) if energy_shares is None else energy_shares
    )


def mac_matrix(first: SampledModes, second: SampledModes) -> Array:
    """Energy-weighted MAC (m×n) of each mode of one model with each mode of another.

    Array sizes: m modes of the first model, n modes of the second model.
    """
    return np.square(_overlaps(first, second))


def space_mac(first: SampledModes, second: SampledModes) -> Array:
    """Energy-weighted MAC (m×n) of two models' modes, averaged over modes of equal frequency.

    Array sizes: m modes of the first model, n modes of the second model.
    """
    spaces = equal_frequency_groups(first.frequencies), equal_frequency_groups(second.frequencies)
    return _means(_overlaps(_in_spaces(first, spaces[0]), _in_spaces(second, spaces[1])), *spaces)


def pair_modes(
    first: SampledModes,
    second: SampledModes,
    frequency_uncertainties: Array | None = None,
    excluded: BoolArray | None = None,
) -> Pairs:
    """Partners of the modes `first` of one model among the modes `second` of another model.

    `frequency_uncertainties` (m): relative uncertainties of the first model's frequencies.
    `excluded` (m×n): pairs that cannot be partners. Array sizes: m modes of the first model, n
    modes of the second model.
    """
    first_groups, second_groups = (
        equal_frequency_groups(first.frequencies),
        equal_frequency_groups(second.frequencies),
    )
    overlaps = _overlaps(_in_spaces(first, first_groups), _in_spaces(second, second_groups))
    if excluded is not None:
        overlaps[excluded] = 0.0
    # The assignment needs at least as many columns as rows: zero overlaps stand for missing modes.
    lacking = max(len(first_groups) - len(second_groups), 0)
    overlaps = np.pad(overlaps, ((0, 0), (0, lacking)))
    second_groups = np.append(second_groups, -1 - np.arange(lacking))
    means = _means(overlaps, first_groups, second_groups)
    nearest = _assigned(means)
    blocks = _Blocks(overlaps, first_groups, second_groups, nearest)
    mac = blocks.mac()
    exchange = blocks.exchange(means, mac)
    lower, upper = (
        ufunc.outer(first.frequencies, first.frequencies) for ufunc in (np.minimum, np.maximum)
    )
    exchange[upper > (1.0 + _FAR) * lower] = 0.0
    open_pairs = mac <= _DECIDED
    linked = (exchange >= _UNDECIDED) & np.logical_and.outer(open_pairs, open_pairs)
    mac, undecided = blocks.mixture_mac(linked, mac)
    paired = (mac >= PARTNER_MAC) & ~undecided
    near = equal_frequency_groups(first.frequencies, frequency_uncertainties)
    same_frequency = np.equal.outer(near, near)
    partner = np.where(paired, nearest, -1)
    partner = _ascending(partner, linked & same_frequency)
    return Pairs(
        np.where(nearest < len(second.frequencies), nearest, -1),
        partner,
        np.where(paired, mac, means.max(axis=1, initial=0.0)),
        exchange,
        linked & ~same_frequency & np.logical_and.outer(paired, paired),
        undecided,
        _ascending(partner, linked | same_frequency),
    )


def _assigned(mac: Array) -> IntArray:
    """Column (m) assigned to each row of a matrix (m×n, m ≤ n) so that the sum is largest.

    `mac` is the matrix. The method is the Hungarian one. Equal rows and columns are assigned in
    ascending order.
    """
    distances = np.subtract.outer(*(np.arange(float(size)) for size in mac.shape))
    penalised = mac - _TIE * distances**2
    columns: IntArray = scipy.optimize.linear_sum_assignment(penalised, maximize=True)[1]
    return columns


def equal_frequency_groups(
    frequencies: Array, frequency_uncertainties: Array | None = None
) -> IntArray:
    """Index (m) of the group of equal frequencies to which each mode belongs, ascending.

    Frequencies count as equal if their relative difference is at most the smallest of the group's
    `frequency_uncertainties` (m, relative), or at most `_REPEATED` if that is larger. A chain of
    small gaps is split into several groups, so that the lowest and the highest frequency of a group
    do not differ by more than this.
    """
    width = (
        np.zeros(len(frequencies)) if frequency_uncertainties is None else frequency_uncertainties
    )
    # Lists, since numbers of arrays are slow to read one by one.
    widths, values = np.maximum(width, _REPEATED).tolist(), frequencies.tolist()
    spaces = [0] * len(values)
    group, lowest, narrowest = -1, -np.inf, 0.0
    for mode in np.argsort(frequencies, kind="stable").tolist():
        narrowest = min(narrowest, widths[mode])
        if not values[mode] <= lowest * (1.0 + narrowest):
            group, lowest, narrowest = group + 1, values[mode], widths[mode]
        spaces[mode] = group
    return np.array(spaces, dtype=int)


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Overlaps (m×n) of m modes of one model with n modes of another, see `_overlaps`.

    `first_groups` (m) and `second_groups` (n): index of the group of equal frequencies to which
    each mode of the first and of the second model belongs. `partner` (m): index of the mode of the
    second model that is assigned to each mode of the first.
    """

    overlaps: Array
    first_groups: IntArray
    second_groups: IntArray
    partner: IntArray

    def mac(self) -> Array:
        """Squared cosines (m) of the principal angles between the spaces of each pair of modes.

        Among modes of equal frequency, the first have the smallest angles.
        """
        mac = np.square(self.overlaps[np.arange(len(self.partner)), self.partner])
        pairs = np.column_stack([self.first_groups, self.second_groups[self.partner]])
        # The cosine of two single modes is their overlap.
        single = _sizes(self.first_groups) * _sizes(self.second_groups)[self.partner] == 1
        for pair in set(map(tuple, pairs[~single].tolist())):
            inside = np.flatnonzero((pairs == pair).all(axis=1))
            mac[inside] = self._cosines(inside)[: len(inside)]
        return mac

    def exchange(self, means: Array, mac: Array) -> Array:
        """Ratio (m×m) of the sums of MAC of two pairs, with exchanged partners over without.

        `means` is the result of `_means`, `mac` (m) that of the method `mac`. The ratio is zero if
        the two modes, or their partners, have equal frequencies. Array sizes: m modes of the first
        model.
        """
        crossed = means[:, self.partner] + means[:, self.partner].T
        together = np.add.outer(mac, mac)
        partner_spaces = self.second_groups[self.partner]
        separate = ~np.equal.outer(self.first_groups, self.first_groups)
        separate &= ~np.equal.outer(partner_spaces, partner_spaces) & (together > 0.0)
        return np.divide(crossed, together, out=np.zeros_like(crossed), where=separate)

    def mixture_mac(self, linked: BoolArray, mac: Array) -> tuple[Array, BoolArray]:
        """MAC (m) of each mode with its partner, or with all partners of its group of linked modes.

        `linked` (m×m): true for two modes whose shapes mix. `mac` (m): MAC of each pair. The second
        array (m) is true for modes of a group in which several modes share the shapes of fewer
        partners.
        """
        group_mac, undecided = mac.copy(), np.zeros(len(mac), dtype=bool)
        groups = _components(linked)
        for group in np.flatnonzero(np.bincount(groups) > 1):
            inside = np.flatnonzero(groups == group)
            rows, columns = self._spaces(inside)
            squares = np.square(self.overlaps[np.ix_(rows, columns)]).sum(axis=1)
            spanned = np.array(
                [squares[self.first_groups[rows] == self.first_groups[i]].mean() for i in inside]
            )
            if (self._cosines(inside)[: len(inside)] >= PARTNER_MAC).all():
                group_mac[inside] = spanned
            else:
                undecided[inside] = spanned >= 0.5 * PARTNER_MAC
        return group_mac, undecided

    def _spaces(self, modes: IntArray) -> tuple[IntArray, IntArray]:
        """Indices of the modes that span the spaces of `modes` and of their partners.

        `modes`: indices of modes of the first model. The first array has the modes of the first
        model with the same frequencies. The second has the modes of the second model with the same
        frequencies as the partners.
        """
        partner_spaces = self.second_groups[self.partner[modes]]
        return (
            np.flatnonzero(np.isin(self.first_groups, self.first_groups[modes])),
            np.flatnonzero(np.isin(self.second_groups, partner_spaces)),
        )

    def _cosines(self, modes: IntArray) -> Array:
        """Squared cosines (k) of the principal angles between the spaces of `_spaces`, descending.

        Zeros are appended if there are fewer angles than `modes`.
        """
        cosines = np.linalg.svd(self.overlaps[np.ix_(*self._spaces(modes))], compute_uv=False)
        return np.pad(np.square(cosines), (0, max(len(modes) - len(cosines), 0)))


def _overlaps(first: SampledModes, second: SampledModes) -> Array:
    """Cosines (m×n) between shapes, times the root of the ratio of the sampled energy shares.

    Array sizes: m modes of the first model, n modes of the second model.
    """
    smaller, larger = (
        ufunc.outer(first.energy_shares, second.energy_shares) for ufunc in (np.minimum, np.maximum)
    )
    ratio = np.divide(smaller, larger, out=np.zeros_like(smaller), where=larger > 0.0)
    overlaps: Array = (first.shapes.T @ second.shapes) * np.sqrt(ratio)
    return overlaps


def _in_spaces(modes: SampledModes, spaces: IntArray) -> SampledModes:
    """Modes with orthonormal shapes within each group of equal frequencies (`spaces`, by index).

    Shapes that depend linearly on others of their group become zero.
    """
    shapes, energy_shares = modes.shapes.copy(), modes.energy_shares.copy()
    for space in np.flatnonzero(np.bincount(spaces) > 1):
        inside = spaces == space
        basis, sizes, _ = np.linalg.svd(shapes[:, inside], full_matrices=False)
        count = basis.shape[1]
        shapes[:, inside] = 0.0
        shapes[:, np.flatnonzero(inside)[:count]] = basis * (sizes > _RANK * sizes[0])
        energy_shares[inside] = energy_shares[inside].mean()
    return SampledModes(modes.frequencies, shapes, energy_shares)


def _means(overlaps: Array, first_groups: IntArray, second_groups: IntArray) -> Array:
    """Squared overlaps (m×n), averaged over groups of modes of equal frequency.

    `first_groups` (m) and `second_groups` (n): index of the group of each mode. For each pair of a
    group of the first model and a group of the second, the sum of the squared overlaps is divided
    by the size of the smaller group. Array sizes: m modes of the first model, n modes of the second
    model.
    """
    first_members, second_members = (
        (spaces[:, None] == np.unique(spaces)).astype(float)
        for spaces in (first_groups, second_groups)
    )
    sums = first_members.T @ np.square(overlaps) @ second_members
    counts = np.minimum.outer(first_members.sum(axis=0), second_members.sum(axis=0))
    means: Array = first_members @ (sums / counts) @ second_members.T
    return means


def _components(linked: BoolArray) -> IntArray:
    """Index (m) of the connected group of linked modes to which each mode belongs."""
    if np.count_nonzero(linked) == np.count_nonzero(np.diagonal(linked)):
        return np.arange(len(linked))
    numbers: IntArray = scipy.sparse.csgraph.connected_components(linked, directed=False)[1]
    return numbers


def _sizes(groups: IntArray) -> IntArray:
    """Number (m) of modes in the group of each mode, from the index of its group (`groups`, m)."""
    return np.asarray(np.equal.outer(groups, groups).sum(axis=1))


def _ascending(partner: IntArray, linked: BoolArray) -> IntArray:
    """Partners (m), sorted in ascending order within each group of linked modes.

    `linked` (m×m): true for two modes whose partners can be exchanged.
    """
    sorted_partner, groups = partner.copy(), _components(linked)
    for group in np.flatnonzero(np.bincount(groups) > 1):
        inside = np.flatnonzero((groups == group) & (partner >= 0))
        sorted_partner[inside] = np.sort(partner[inside])
    return sorted_partner


def centreline_samples(length: float, count: int) -> tuple[Array, Array]:
    """Gauss–Legendre stations (n, in m) along a leg, and lengths (n, in m) that they represent.

    `length` (m) is that of the leg, `count` the number n.
    """
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * length * (1.0 + points), 0.5 * length * weights


def centreline_weights(properties: BeamProperties, lengths: Array) -> Array:
    """Masses (kg) and rotary inertias (kg m², 6n in all) of twists sampled at n stations of a leg.

    `lengths` (n, in m): length that each station represents.
    """
    p = properties
    per_length = np.array([p.mu, p.mu, p.mu, p.rho_J, p.rho_Iy, p.rho_Iz])
    return np.outer(lengths, per_length).ravel()
