"""Pairing of the modes of two models by their shapes.

The likeness of two shapes is MAC = (aᵀWb)² / (aᵀWa · bᵀWb), W the mass at the samples (Allemang &
Brown, IMAC 1982), times the smaller over the larger of the shares of kinetic energy that the
samples see of the two modes. Against a mode that the samples see entirely, as those of beams, this
is the squared overlap (aᵀMb)² in the mass M of the whole robot, since the other mode is zero in all
that the samples do not see. A local mode of a section, of whose energy the samples see 5 %, has a
likeness of at most 0.05 with each mode of beams.

Modes of one frequency are one space: any mixture of them is a mode, too. Spaces are compared by the
squared cosines of their principal angles (Björck & Golub, Math. Comput. 27 (1973) 579).
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.legs import BeamProperties

# Two modes with less than half of their squared shapes in common are different modes. At most one
# of several orthogonal shapes has more than half in common with a given shape.
ALIKE = 0.5
# Likeness of two pairs with their partners exchanged, relative to that of the pairs, from which on
# shapes do not decide: modes turned into each other by 35 to 55 degrees. Likeness of a pair above
# which shapes decide: other orthogonal shapes share at most the rest of one.
_UNDECIDED, _DECIDED = 0.5, 2.0 / 3.0
# Relative gap beyond which frequencies distinguish modes of mixed shapes: modes so far apart are
# turned by 35 degrees only if models differ by as much (Davis & Kahan, SIAM J. Numer. Anal. 7
# (1970) 1).
_FAR = 0.25
# Relative gap of repeated frequencies: points with six digits split them by some millionths.
_REPEATED = 1e-5
# Weight of the squared distance in the order, which decides if likeness is equal: below any
# likeness.
_TIE = 1e-9
# Directions of a space below this part of the largest one are rounding.
_RANK = 1e-6

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class SampledModes:
    """Modes of one model in one posture.

    `frequencies` (m, Hz, ascending), `shapes` (k×m, unit columns, samples weighed by the root of
    their mass) and `seen` (m), the share of each mode's kinetic energy that the samples see.
    """

    frequencies: Array
    shapes: Array
    seen: Array


@dataclass(frozen=True, eq=False)
class Pairs:
    """Partners of m modes among those of another model.

    `nearest` (m): index of the mode with which the sum of all likeness is largest, −1 if there are
    fewer modes. `partner` (m): index of the partner, −1 if shapes of `nearest` are not alike. Modes
    of one frequency have theirs in ascending order. `likeness` (m): squared cosine between a mode
    and the space of its partner, or the largest likeness with any mode if there is no partner.
    `exchange` (m×m): likeness of two
    pairs with their partners exchanged, relative to that of the pairs. Zero within one space, and
    for modes that their frequencies distinguish.
    `mixed` (m×m): pairs of different frequencies whose shapes do not decide which is which.
    `undecided` (m): modes without a partner since fewer modes of the other model have their shapes
    than they are. `ordered` (m): partners in the most ascending order that modes closer than their
    uncertainty and mixed ones allow.
    """

    nearest: IntArray
    partner: IntArray
    likeness: Array
    exchange: Array
    mixed: BoolArray
    undecided: BoolArray
    ordered: IntArray


def sampled_modes(frequencies: Array, samples: Array, seen: Array | None = None) -> SampledModes:
    """Modes from `samples` (k×m) of their shapes, each weighed by the root of its mass.

    If `seen` (m) is None, the samples see all of the energy.
    """
    sizes = np.linalg.norm(samples, axis=0)
    shapes = samples / np.where(sizes > 0.0, sizes, 1.0)
    return SampledModes(frequencies, shapes, np.ones_like(sizes) if seen is None else seen)


def likeness_matrix(own: SampledModes, other: SampledModes) -> Array:
    """Likeness (m×n) of each mode with each mode of another model."""
    return np.square(_overlaps(own, other))


def space_likeness(own: SampledModes, other: SampledModes) -> Array:
    """Likeness (m×n) of each mode with each mode of another model, the mean over repeated ones."""
    spaces = one_frequency(own.frequencies), one_frequency(other.frequencies)
    return _means(_overlaps(_in_spaces(own, spaces[0]), _in_spaces(other, spaces[1])), *spaces)


def pair_modes(
    own: SampledModes,
    other: SampledModes,
    unsure: Array | None = None,
    excluded: BoolArray | None = None,
) -> Pairs:
    """Partners of the modes `own` among the modes `other`, the sum of their likeness the largest.

    `unsure` (m): relative uncertainties of the own frequencies. `excluded` (m×n): pairs that cannot
    be partners.
    """
    own_spaces, other_spaces = one_frequency(own.frequencies), one_frequency(other.frequencies)
    overlaps = _overlaps(_in_spaces(own, own_spaces), _in_spaces(other, other_spaces))
    if excluded is not None:
        overlaps[excluded] = 0.0
    # Each mode needs a partner to be compared with: missing ones are zero shapes.
    lacking = max(len(own_spaces) - len(other_spaces), 0)
    overlaps = np.pad(overlaps, ((0, 0), (0, lacking)))
    other_spaces = np.append(other_spaces, -1 - np.arange(lacking))
    means = _means(overlaps, own_spaces, other_spaces)
    nearest = _assigned(means)
    blocks = _Blocks(overlaps, own_spaces, other_spaces, nearest)
    likeness = blocks.likeness()
    exchange = blocks.exchange(means, likeness)
    lower, upper = (
        ufunc.outer(own.frequencies, own.frequencies) for ufunc in (np.minimum, np.maximum)
    )
    exchange[upper > (1.0 + _FAR) * lower] = 0.0
    open_pairs = likeness <= _DECIDED
    linked = (exchange >= _UNDECIDED) & np.logical_and.outer(open_pairs, open_pairs)
    likeness, undecided = blocks.mixture_likeness(linked, likeness)
    paired = (likeness >= ALIKE) & ~undecided
    near = one_frequency(own.frequencies, unsure)
    same_frequency = np.equal.outer(near, near)
    partner = np.where(paired, nearest, -1)
    partner = _ascending(partner, linked & same_frequency)
    return Pairs(
        np.where(nearest < len(other.frequencies), nearest, -1),
        partner,
        np.where(paired, likeness, means.max(axis=1, initial=0.0)),
        exchange,
        linked & ~same_frequency & np.logical_and.outer(paired, paired),
        undecided,
        _ascending(partner, linked | same_frequency),
    )


def _assigned(likeness: Array) -> IntArray:
    """Column (m) of every row of a matrix (m×n, m ≤ n) by its largest sum (Hungarian method).

    Rows and columns that are equal are assigned in ascending order.
    """
    distances = np.subtract.outer(*(np.arange(float(size)) for size in likeness.shape))
    penalised = likeness - _TIE * distances**2
    columns: IntArray = scipy.optimize.linear_sum_assignment(penalised, maximize=True)[1]
    return columns


def one_frequency(frequencies: Array, unsure: Array | None = None) -> IntArray:
    """Number (m) of each mode's space, by ascending frequency.

    A space spans no more than the smallest of its modes' relative uncertainties `unsure` (m), and
    repeated frequencies if these are smaller: modes in a chain of small gaps are several spaces.
    """
    width = np.zeros(len(frequencies)) if unsure is None else unsure
    width = np.maximum(width, _REPEATED)
    spaces = np.zeros(len(frequencies), dtype=int)
    number, lowest, narrowest = -1, -np.inf, 0.0
    for mode in np.argsort(frequencies, kind="stable"):
        narrowest = min(narrowest, width[mode])
        if not frequencies[mode] <= lowest * (1.0 + narrowest):
            number, lowest, narrowest = number + 1, frequencies[mode], width[mode]
        spaces[mode] = number
    return spaces


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Overlaps (m×n) of modes in their spaces (m and n), and the first assignment (m)."""

    overlaps: Array
    own_spaces: IntArray
    other_spaces: IntArray
    partner: IntArray

    def likeness(self) -> Array:
        """Squared cosines (m) of the principal angles between the spaces of each pair.

        The first of repeated modes have the smallest angles.
        """
        likeness = np.zeros(len(self.partner))
        pairs = np.column_stack([self.own_spaces, self.other_spaces[self.partner]])
        for pair in np.unique(pairs, axis=0):
            inside = np.flatnonzero((pairs == pair).all(axis=1))
            likeness[inside] = self._cosines(inside)[: len(inside)]
        return likeness

    def exchange(self, means: Array, likeness: Array) -> Array:
        """Likeness (m×m) of two pairs exchanged, relative to that of the pairs; 0 in one space."""
        crossed = means[:, self.partner] + means[:, self.partner].T
        together = np.add.outer(likeness, likeness)
        partner_spaces = self.other_spaces[self.partner]
        separate = ~np.equal.outer(self.own_spaces, self.own_spaces)
        separate &= ~np.equal.outer(partner_spaces, partner_spaces) & (together > 0.0)
        return np.divide(crossed, together, out=np.zeros_like(crossed), where=separate)

    def mixture_likeness(self, linked: BoolArray, likeness: Array) -> tuple[Array, BoolArray]:
        """Likeness (m), for linked pairs that with the space of all their partners.

        The second array (m) marks modes that share the shapes of fewer partners than modes.
        """
        group_likeness, undecided = likeness.copy(), np.zeros(len(likeness), dtype=bool)
        groups = _components(linked)
        for number in np.flatnonzero(np.bincount(groups) > 1):
            inside = np.flatnonzero(groups == number)
            rows, columns = self._spaces(inside)
            squares = np.square(self.overlaps[np.ix_(rows, columns)]).sum(axis=1)
            spanned = np.array(
                [squares[self.own_spaces[rows] == self.own_spaces[i]].mean() for i in inside]
            )
            if (self._cosines(inside)[: len(inside)] >= ALIKE).all():
                group_likeness[inside] = spanned
            else:
                undecided[inside] = spanned >= 0.5 * ALIKE
        return group_likeness, undecided

    def _spaces(self, modes: IntArray) -> tuple[IntArray, IntArray]:
        """All modes in the spaces of `modes`, and all in the spaces of their partners."""
        partner_spaces = self.other_spaces[self.partner[modes]]
        return (
            np.flatnonzero(np.isin(self.own_spaces, self.own_spaces[modes])),
            np.flatnonzero(np.isin(self.other_spaces, partner_spaces)),
        )

    def _cosines(self, modes: IntArray) -> Array:
        """Squared cosines of the principal angles between the spaces of `modes`, descending."""
        cosines = np.linalg.svd(self.overlaps[np.ix_(*self._spaces(modes))], compute_uv=False)
        return np.pad(np.square(cosines), (0, max(len(modes) - len(cosines), 0)))


def _overlaps(own: SampledModes, other: SampledModes) -> Array:
    """Cosines (m×n) times the root of the ratio of the shares of energy that the samples see."""
    smaller, larger = (ufunc.outer(own.seen, other.seen) for ufunc in (np.minimum, np.maximum))
    ratio = np.divide(smaller, larger, out=np.zeros_like(smaller), where=larger > 0.0)
    overlaps: Array = (own.shapes.T @ other.shapes) * np.sqrt(ratio)
    return overlaps


def _in_spaces(modes: SampledModes, spaces: IntArray) -> SampledModes:
    """Modes with an orthonormal basis of each space; dependent directions are zero."""
    shapes, seen = modes.shapes.copy(), modes.seen.copy()
    for number in np.flatnonzero(np.bincount(spaces) > 1):
        inside = spaces == number
        basis, sizes, _ = np.linalg.svd(shapes[:, inside], full_matrices=False)
        count = basis.shape[1]
        shapes[:, inside] = 0.0
        shapes[:, np.flatnonzero(inside)[:count]] = basis * (sizes > _RANK * sizes[0])
        seen[inside] = seen[inside].mean()
    return SampledModes(modes.frequencies, shapes, seen)


def _means(overlaps: Array, own_spaces: IntArray, other_spaces: IntArray) -> Array:
    """Squared overlaps (m×n), the mean over the smaller of two spaces."""
    own_members, other_members = (
        (spaces[:, None] == np.unique(spaces)).astype(float)
        for spaces in (own_spaces, other_spaces)
    )
    sums = own_members.T @ np.square(overlaps) @ other_members
    counts = np.minimum.outer(own_members.sum(axis=0), other_members.sum(axis=0))
    means: Array = own_members @ (sums / counts) @ other_members.T
    return means


def _components(linked: BoolArray) -> IntArray:
    """Number (m) of each mode's group of linked modes."""
    numbers: IntArray = scipy.sparse.csgraph.connected_components(linked, directed=False)[1]
    return numbers


def _ascending(partner: IntArray, linked: BoolArray) -> IntArray:
    """Partners (m), in ascending order within each group of linked modes that have one."""
    sorted_partner, groups = partner.copy(), _components(linked)
    for number in np.flatnonzero(np.bincount(groups) > 1):
        inside = np.flatnonzero((groups == number) & (partner >= 0))
        sorted_partner[inside] = np.sort(partner[inside])
    return sorted_partner


def centreline_samples(length: float, count: int) -> tuple[Array, Array]:
    """Gauss–Legendre stations (m) along a leg and the share of its length that each represents."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * length * (1.0 + points), 0.5 * length * weights


def centreline_weights(properties: BeamProperties, lengths: Array) -> Array:
    """Mass weights (6m) of twists sampled on a centreline: mass and rotary inertia per station."""
    p = properties
    per_length = np.array([p.mu, p.mu, p.mu, p.rho_J, p.rho_Iy, p.rho_Iz])
    return np.outer(lengths, per_length).ravel()
