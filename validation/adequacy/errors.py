"""Total relative errors of a model against every alternative of the reference, pose by pose."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, ORDER, Quantity
from lumped.arrays import Array, IntArray
from validation.adequacy.partners import Partners, partners
from validation.adequacy.response import Alternative, Reference, Response, Subject, Vibration
from validation.agreement.displacement import displacement, relative


@dataclass(frozen=True, eq=False)
class Loaded:
    """What belongs to errors of deflections: a alternatives of the reference by p poses.

    `load` (a×p×(6+l)) is the unit wrench, of any force the worst one, and how much there is of each
    load of the file; `along` (a×p) the signed error of the displacement along it. `off` (a×p×3) is
    the difference of displacements, relative to `length` (a×p, m/N or rad/(N m), of the
    reference's). `masses` (a×p): what the places of the legs' masses leave open of the error, and
    `linear` (a×p) that loads change the stiffness.
    """

    load: Array
    along: Array
    off: Array
    length: Array
    masses: Array
    linear: Array


@dataclass(frozen=True, eq=False)
class Paired:
    """Pairing by shape behind errors of frequencies: a alternatives of the reference by p poses.

    `below` and `above` the error lie those of other partners that shapes leave open; of the order
    those of other places. `undecided`: shapes do not decide whether the model has the mode.
    `local`: the mode is local to a leg's section, `seen` the share of its kinetic energy in
    sections and bodies that move as wholes. `likeness` with the partner, or the largest with any
    mode of the model.
    """

    below: Array
    above: Array
    undecided: NDArray[np.bool_]
    local: NDArray[np.bool_]
    seen: Array
    likeness: Array

    def of(self, rows: Sequence[int]) -> "Paired":
        """The pairing of some of the alternatives."""
        return Paired(*(getattr(self, one.name)[rows] for one in fields(self)))


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity: a alternatives of the reference, by their `names`, by p poses.

    Frequencies: `value` and `expected` in Hz, `error` = value/expected − 1; sizes of responses
    likewise, in m/N. Deflections: `value` and `expected` along the load, `error` of the whole
    displacement, never negative, and what belongs to it in `loaded`. NaN where model and reference
    have nothing that could be compared; `unknown` where the reference has fewer modes than are
    asked for, or none that is damped, and where shapes do not decide whether the model has the
    mode. `numerical` is what meshes leave open of the error, `digits` what the printed digits of
    the robot's 6×6 do, `paired` what belongs to modes. `numbers` (a×p×m, of the order alone): which
    mode of the model, from 0, has the shape of each of the reference's; −1: none has.
    """

    names: tuple[str, ...]
    value: Array
    expected: Array
    error: Array
    numerical: Array
    digits: Array
    unknown: NDArray[np.bool_]
    loaded: Loaded | None = None
    paired: Paired | None = None
    numbers: IntArray | None = None

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Where there is nothing to compare (a×p)."""
        return np.isnan(self.error)

    @property
    def spread(self) -> Array:
        """Half-width of each error (a×p) that meshes, digits and the rest leave open."""
        spread = self.numerical + self.digits
        return spread if self.loaded is None else spread + self.loaded.masses + self.loaded.linear

    @property
    def farthest(self) -> Array:
        """Distance of the farther bound from each error (a×p)."""
        if self.paired is None:
            return self.spread
        return self.spread + np.maximum(self.paired.below, self.paired.above)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Each error less and plus its half-width (a×p each), and those of other partners."""
        low, high = self.error - self.spread, self.error + self.spread
        if self.paired is None:
            return low, high
        return low - self.paired.below, high + self.paired.above

    @property
    def interval(self) -> tuple[Array, Array]:
        """Lowest and highest error (p each) of all alternatives with their half-widths.

        The error of a whole displacement is never below zero. Of the order the interval is that of
        the alternative by which it misleads most: between a mode in its place and one in another
        there is nothing.
        """
        low, high = self.bounds
        if self.numbers is not None:
            at = self.largest, np.arange(self.error.shape[1])
            return low[at], high[at]
        low, high = low.min(axis=0), high.max(axis=0)
        return (low if self.loaded is None else np.maximum(low, 0.0)), high

    @property
    def bound(self) -> Array:
        """The largest size (p) of the errors that are left open; NaN if one is missing."""
        low, high = self.interval
        bound = np.maximum(np.abs(low), np.abs(high))
        return np.where(self.missing.any(axis=0), np.nan, bound)

    @property
    def worst(self) -> Array:
        """The largest error (p) by size of all alternatives; NaN if one of them has none."""
        worst = self.error[self.largest, np.arange(self.error.shape[1])]
        return np.where(self.missing.any(axis=0), np.nan, worst)

    @property
    def largest(self) -> IntArray:
        """The alternative (p) of the largest error, of those with which there is something."""
        sizes = np.where(self.missing, -1.0, np.abs(self.error))
        return np.asarray(np.argmax(sizes, axis=0))


@dataclass(frozen=True, eq=False)
class Scale:
    """A robot's references, against which any response is measured, pairings kept.

    `modes` is the number of frequencies that are judged.
    """

    subject: Subject
    modes: int
    _pairs: dict[tuple[int, str], Partners] = field(default_factory=dict, repr=False)

    def reference(self, quantity: Quantity) -> Reference:
        """The reference of a quantity."""
        return self.subject.statics if quantity.static else self.subject.dynamics

    def errors(self, responses: Sequence[Response], quantity: Quantity) -> Errors | None:
        """Errors of a quantity; `responses` one per alternative of its reference.

        None where a response says nothing of it.
        """
        alternatives = self.reference(quantity).alternatives
        of = self._deflection if quantity.static else self._peak
        if quantity.modal:
            of = self._frequency
        rows = [
            row
            for one, response in zip(alternatives, responses, strict=True)
            if (row := of(one, response, quantity))
        ]
        if len(rows) < len(alternatives) or not rows:
            return None
        value, expected, error, numerical, digits, unknown, *further = (
            np.array(column) for column in zip(*rows, strict=True)
        )
        return Errors(
            tuple(one.name for one in alternatives),
            value,
            expected,
            error,
            numerical,
            digits,
            unknown,
            loaded=Loaded(*further) if quantity.static else None,
            paired=Paired(*further[:-1]) if quantity.modal else None,
            numbers=further[-1] if quantity == ORDER else None,
        )

    def _frequency(
        self, one: Alternative, response: Response, quantity: Quantity
    ) -> tuple[NDArray[Any], ...] | None:
        """The first fields of `Errors` for every pose, those of `Paired`, and the numbers.

        Of the order those of the mode, among all in another place, whose number misleads most.
        """
        truth, model = one.response.vibration, response.vibration
        if truth is None or model is None:
            return None
        found = self._partners(one, truth, response, model)
        own = truth.frequencies[:, : self.modes]
        poses, known = np.arange(len(own)), np.isfinite(own)
        if quantity == ORDER:
            numbers, at, value, below, above = _misplaced(found, own)
            unknown = (~known | found.undecided).any(axis=1)
            moved = (numbers[poses, at] != at) | found.loose[poses, at]
        else:
            at = np.full(len(own), quantity.column)
            value, numbers = found.frequency[poses, at], found.number
            below, above = value - found.lowest[poses, at], found.highest[poses, at] - value
            unknown = ~known[poses, at] | found.undecided[poses, at]
            moved = np.ones(len(own), bool)
        expected = own[poses, at]
        ratio = value / expected
        numerical, digits = (
            np.zeros(len(own)) if left is None else np.where(moved, left[poses, at], 0.0)
            for left in (one.dynamic, one.dynamic_digits)
        )
        sizes = np.abs(ratio)
        left = numerical * sizes, digits * sizes
        pairing = [
            np.nan_to_num(below / expected),
            np.nan_to_num(above / expected),
            *(of[poses, at] for of in (found.undecided, found.local, found.seen, found.likeness)),
        ]
        return value, expected, ratio - 1.0, *left, np.asarray(unknown), *pairing, numbers

    def _peak(
        self, one: Alternative, response: Response, quantity: Quantity
    ) -> tuple[NDArray[Any], ...] | None:
        """The first fields of `Errors` for every pose, of what is judged of responses."""
        truth, model, left = one.response.vibration, response.vibration, one.responses
        if truth is None or model is None or left is None:
            return None
        column = quantity.column
        value, own = (
            np.where(np.isfinite(of.peaks[:, column]), of.peaks[:, column], np.nan)
            for of in (model, truth)
        )
        reach = np.nan_to_num(value / own)
        numerical, digits = (of[:, column] * reach for of in (left.meshes, left.digits))
        return value, own, value / own - 1.0, numerical, digits, np.isnan(own)

    def _partners(
        self, one: Alternative, truth: Vibration, response: Response, model: Vibration
    ) -> Partners:
        key = id(response), one.name
        if key not in self._pairs:
            left = [
                of[:, : self.modes] for of in (one.dynamic, one.dynamic_digits) if of is not None
            ]
            unsure = np.sum(left, axis=0) if left else None
            self._pairs[key] = partners(truth, model, self.subject.weights, self.modes, unsure)
        return self._pairs[key]

    def _deflection(
        self, one: Alternative, response: Response, quantity: Quantity
    ) -> tuple[NDArray[Any], ...] | None:
        """The first fields of `Errors` and those of `Loaded`, for every pose."""
        reference, compliance = one.response.compliance, response.compliance
        if reference is None or compliance is None:
            return None
        found = relative(compliance - reference, reference, quantity)
        size, length = found.size, found.length
        moved, due = (displacement(c, found.load, quantity) for c in (compliance, reference))
        value, expected = (np.einsum("pi,pi->p", found.direction, u) for u in (moved, due))
        yields = length > 0
        off = np.divide(moved - due, length[:, None], out=np.zeros_like(due), where=yields[:, None])
        # What changes the reference by a part of its length changes the error by no more than that
        # part of the model's displacement; under any force by no more than that part of 1 + error.
        reach = 1.0 + size
        if quantity != ANY_FORCE:
            along = due / np.where(yields, length, np.inf)[:, None]
            reach = np.linalg.norm(off + along, axis=1)
        numerical, digits, masses, linear = (
            np.zeros(len(size))
            if left is None
            else np.multiply(
                left[:, quantity.static_column], reach, out=np.zeros_like(size), where=yields
            )
            for left in (one.static, one.digits, one.masses, one.linear)
        )
        error = np.where(np.isinf(size), np.nan, size)
        unknown = np.zeros(len(size), bool)
        of_load = found.load, found.along, off, length, masses, linear
        return value, expected, error, numerical, digits, unknown, *of_load


def _misplaced(found: Partners, own: Array) -> tuple[IntArray, IntArray, Array, Array, Array]:
    """Numbers (p×K) of the modes, and the place (p) of the one in another place that misleads most.

    Then the model's frequency (p, Hz) there, and by how much the frequency is below and above it
    that misleads most if modes stand in their places that may. `own` (p×K, Hz) are the reference's.
    """
    poses, places = np.arange(len(own)), np.arange(own.shape[1])
    known = np.isfinite(own) & ~found.undecided
    # A mode in its place does not mislead, nor does one that is not known.
    numbers = np.where(known, found.ordered, places)
    moved = numbers != places
    off = np.where(known, found.by_number / own - 1.0, 0.0)
    certain, possible = (np.where(of, off, 0.0) for of in (moved, moved | (known & found.loose)))
    (least, _), (error, at) = (_most_misleading(errors) for errors in (certain, possible))
    expected = own[poses, at]
    below, above = (np.maximum(of, 0.0) * expected for of in (error - least, least - error))
    return numbers, at, expected * (1.0 + error), below, above


def _most_misleading(errors: Array) -> tuple[Array, IntArray]:
    """The largest of the errors (p×K) by size at each pose, and its place.

    A number that does not exist (NaN) misleads more than any that does.
    """
    at = np.argmax(np.where(np.isnan(errors), np.inf, np.abs(errors)), axis=1)
    return errors[np.arange(len(errors)), at], at
