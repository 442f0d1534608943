"""Total relative errors of a model against each interpretation of the reference, by pose."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, ORDER, Quantity, QuantityKind
from lumped.arrays import Array, IntArray
from validation.references.reference import Interpretation, Source, Subject
from validation.references.responses import Model
from validation.references.robot_on_path import Factors
from validation.responses.displacement import difference_under, nearest_between, relative
from validation.responses.mode_pairing import one_frequency
from validation.responses.mode_partners import Partners, partners, shape_ranges
from validation.responses.statics_and_modes import PathModes, Statics

# Relative difference up to which errors of two poses or interpretations tie, far above rounding.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class Displaced:
    """Displacements behind errors of deflections: R interpretations of the reference by P poses.

    `wrench` (R×P×6) is the unit wrench, of any force the worst one, zero for loads of the file;
    `along` (R×P) the signed error of the displacement along it. `off` (R×P×3) is the difference of
    displacements, relative to `length` (R×P, m/N or rad/(N m), of the reference's). `between`
    (R×P, one number per pose): error against the reading between two interpretations that is
    nearest to the model, infinite if there is one interpretation.
    """

    wrench: Array
    along: Array
    off: Array
    length: Array
    between: Array


@dataclass(frozen=True, eq=False)
class Paired:
    """Pairing by shape behind errors of frequencies: R interpretations of the reference by P poses.

    `below` and `above` the error lie those of other partners that shapes leave open; of the order
    those of other places. `undecided`: shapes do not decide whether the model has the mode.
    `local`: the mode is local to a leg's section, `seen` the share of its kinetic energy in
    sections and bodies that move as wholes. `likeness` with the partner, or the largest with any
    mode of the model. `beyond_below` and `beyond_above`: distance from the error and what else is
    left open of it to those of modes that have this number with a stiffness inside the legs between
    those of the interpretations.
    """

    below: Array
    above: Array
    undecided: NDArray[np.bool_]
    local: NDArray[np.bool_]
    seen: Array
    likeness: Array
    beyond_below: Array
    beyond_above: Array


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity: R interpretations of the reference, by their `names`, by P poses.

    Frequencies: `value` and `expected` in Hz, `error` = value/expected − 1; sizes of responses
    likewise, in m/N. Deflections: `value` and `expected` along the load, `error` of the whole
    displacement, never negative, and what belongs to it in `displaced`. NaN where model and
    reference have nothing that could be compared; `unknown` where the reference has fewer modes
    than are asked for, or none that is damped, and where shapes do not decide whether the model has
    the mode. `budget` (R×P each): half-widths of the error by source, meshes always among them.
    `paired` belongs to modes. `numbers` (R×P×m, of the order alone): which mode of the model, from
    0, has the shape of each of the reference's; −1: none has.
    """

    names: tuple[str, ...]
    value: Array
    expected: Array
    error: Array
    unknown: NDArray[np.bool_]
    budget: Mapping[Source, Array]
    displaced: Displaced | None = None
    paired: Paired | None = None
    numbers: IntArray | None = None

    def rows(self, rows: Sequence[int]) -> "Errors":
        """Errors against some of the interpretations."""

        def chosen(record: Any) -> dict[str, Any]:
            return {name: values[rows] for name, values in _arrays(record).items()}

        return replace(
            self,
            names=tuple(self.names[row] for row in rows),
            budget={source: half_widths[rows] for source, half_widths in self.budget.items()},
            displaced=self.displaced and Displaced(**chosen(self.displaced)),
            paired=self.paired and Paired(**chosen(self.paired)),
            **chosen(self),
        )

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Where there is nothing to compare (a×p)."""
        return np.isnan(self.error)

    @property
    def spread(self) -> Array:
        """Half-width of each error (R×P): the linear sum over its sources."""
        return np.asarray(sum(self.budget.values()))

    @property
    def farthest(self) -> Array:
        """Distance of the farther bound from each error (a×p)."""
        if self.paired is None:
            return self.spread
        low, high = self.bounds
        return np.maximum(self.error - low, high - self.error)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Each error less and plus its half-width (a×p each), and those of other partners."""
        low, high = self.error - self.spread, self.error + self.spread
        if self.paired is None:
            return low, high
        paired = self.paired
        return low - paired.below - paired.beyond_below, high + paired.above + paired.beyond_above

    @property
    def interval(self) -> tuple[Array, Array]:
        """Lowest and highest error (p each) of all interpretations with their half-widths.

        The error of a whole displacement is never below zero, and zero if the model lies between
        two interpretations. Of the order the interval is that of the interpretation by which it
        misleads most: between a mode in its place and one in another there is nothing.
        """
        low, high = self.bounds
        if self.numbers is not None:
            at = self.largest, np.arange(self.error.shape[1])
            return low[at], high[at]
        low, high = low.min(axis=0), high.max(axis=0)
        if self.displaced is not None:
            between = self.displaced.between.min(axis=0) - self.spread.max(axis=0)
            low = np.maximum(np.minimum(low, between), 0.0)
        return low, high

    @property
    def bound(self) -> Array:
        """The largest size (p) of the errors that are left open; NaN if one is missing."""
        low, high = self.interval
        bound = np.maximum(np.abs(low), np.abs(high))
        return np.where(self.missing.any(axis=0), np.nan, bound)

    @property
    def worst(self) -> Array:
        """The largest error (p) by size of all interpretations; NaN if one of them has none."""
        worst = self.error[self.largest, np.arange(self.error.shape[1])]
        return np.where(self.missing.any(axis=0), np.nan, worst)

    @property
    def largest(self) -> IntArray:
        """The interpretation (p) of the largest error, of those with which there is something."""
        return first_largest(np.where(self.missing, -1.0, np.abs(self.error)))


@dataclass(frozen=True, eq=False)
class ModelErrors:
    """Errors of any model of a subject against its references, pairings of modes kept.

    `modes` is the number of frequencies that are judged. `factors`: relative changes of uncertain
    inputs with which models and references are solved.
    """

    subject: Subject
    modes: int
    factors: Factors = ()
    _pairs: dict[tuple[Model, str], Partners] = field(default_factory=dict, repr=False)
    _ranges: dict[tuple[int, ...], list[tuple[Array, Array]]] = field(
        default_factory=dict, repr=False
    )

    def errors(self, model: Model, quantity: Quantity) -> Errors | None:
        """Errors of a quantity. None if model or reference is not solved under some reading."""
        interpretations = self.subject.reference(quantity).interpretations
        errors_of = self._deflection if quantity.static else self._peak
        if quantity.modal:
            errors_of = self._frequency
        found = [errors for one in interpretations if (errors := errors_of(one, model, quantity))]
        if not found or len(found) < len(interpretations):
            return None
        all_errors = stacked(found)
        if all_errors.displaced is not None:
            between = self._between(all_errors.displaced.wrench, model, quantity)
            between = np.broadcast_to(between, all_errors.error.shape)
            return replace(all_errors, displaced=replace(all_errors.displaced, between=between))
        if quantity.kind is not QuantityKind.FREQUENCY or not self.subject.dynamics.interior:
            return all_errors
        return self._with_exchanges(all_errors, model, quantity.column)

    def statics(self, model: Model) -> list[tuple[Statics, Statics]]:
        """Statics of the reference and of a model, for each interpretation that has both."""
        pairs = (self.statics_of(model, one) for one in self.subject.statics.interpretations)
        return [pair for pair in pairs if pair]

    def statics_of(self, model: Model, one: Interpretation) -> tuple[Statics, Statics] | None:
        """Statics of the reference and of a model. None if one of them has none."""
        reference, responses = self.subject.statics.model, self.subject.responses
        reading = replace(one.reading, factors=self.factors)
        truth = responses.known_statics(reference, reading) if reference else None
        own = responses.known_statics(model, reading)
        return (truth, own) if truth and own else None

    def modes_of(self, model: Model, one: Interpretation) -> tuple[PathModes, PathModes] | None:
        """Modes of the reference and of a model. None if one of them has none."""
        reference, responses = self.subject.dynamics.model, self.subject.responses
        reading = replace(one.reading, factors=self.factors)
        truth = responses.known_modes(reference, reading) if reference else None
        own = responses.known_modes(model, reading)
        return (truth, own) if truth and own else None

    def _between(self, wrenches: Array, model: Model, quantity: Quantity) -> Array:
        """Relative size (P) of the difference from the nearest reading between two interpretations.

        `wrenches` (R×P×6) by interpretation. Under any force the largest one counts.
        """
        known = self.statics(model)
        nearest = []
        for wrench in wrenches:
            found = [difference_under(own, truth, quantity, wrench) for truth, own in known]
            nearest.append(nearest_between(*(np.array(one) for one in zip(*found, strict=True))))
        return np.asarray(np.max(nearest, axis=0))

    def _with_exchanges(self, errors: Errors, model: Model, place: int) -> Errors:
        """Add the errors of modes that stand at a `place` with another stiffness inside the legs.

        Interpretations that differ in that stiffness alone are ends of a range. Within it a mode
        has a frequency between those of its shape at the ends, and the mode at `place` one between
        those at this place, whatever its shape: modes pass each other there.
        """
        (low, high), spread, paired = errors.bounds, errors.spread, errors.paired
        poses = np.arange(low.shape[1])
        below, above = np.zeros_like(low), np.zeros_like(high)
        for rows in self.subject.dynamics.by_interior:
            lowest, highest = self._exchanged(model, rows, place)
            first, last = (np.array(rows)[of[rows].argmin(axis=0)] for of in (low, -high))
            down, up = (first, poses), (last, poses)
            below[down] = np.maximum(low[down] - (lowest - spread[down]), 0.0)
            above[up] = np.maximum(highest + spread[up] - high[up], 0.0)
        widened = paired and replace(paired, beyond_below=below, beyond_above=above)
        return replace(errors, paired=widened)

    def _exchanged(self, model: Model, rows: Sequence[int], place: int) -> tuple[Array, Array]:
        """Lowest and highest error (P each) of modes that stand at `place` between interpretations.

        Infinite if none of them has a partner among the modes of the model.
        """
        interpretations = self.subject.dynamics.interpretations
        known = [
            (one, *both)
            for one in (interpretations[row] for row in rows)
            if (both := self.modes_of(model, one))
        ]
        truths = [truth for _, truth, _ in known]
        there = np.array([truth.frequencies[:, place] for truth in truths])
        first, last = there.min(axis=0)[:, None], there.max(axis=0)[:, None]
        lowest, highest = [], []
        for (one, truth, own), (low, high) in zip(
            known, self._shape_ranges(tuple(rows), truths), strict=True
        ):
            found = self._partners(model, one, truth, own)
            spaces = np.array([one_frequency(row) for row in truth.frequencies])
            # Repeated modes are one space, in which none passes another.
            may = (spaces != spaces[:, [place]]) | (np.arange(low.shape[1]) == place)
            may &= (low <= last) & (high >= first)
            lowest.append(np.where(may, found.lowest / np.minimum(high, last) - 1.0, np.inf))
            highest.append(np.where(may, found.highest / np.maximum(low, first) - 1.0, -np.inf))
        return (
            np.fmin.reduce(np.hstack(lowest), axis=1),
            np.fmax.reduce(np.hstack(highest), axis=1),
        )

    def _shape_ranges(
        self, rows: tuple[int, ...], truths: Sequence[PathModes]
    ) -> list[tuple[Array, Array]]:
        if rows not in self._ranges:
            self._ranges[rows] = shape_ranges(truths)
        return self._ranges[rows]

    def _frequency(self, one: Interpretation, model: Model, quantity: Quantity) -> Errors | None:
        """Errors of a frequency, or of the order, against one interpretation.

        Those of the order belong to the mode, among all in another place, whose number misleads
        most.
        """
        if (both := self.modes_of(model, one)) is None:
            return None
        truth = both[0]
        found = self._partners(model, one, *both).first(self.modes)
        own = truth.frequencies[:, : self.modes]
        poses, known = np.arange(len(own)), np.isfinite(own)
        if quantity == ORDER:
            order = _misplaced(found, own)
            place, value, below, above = order.place, order.frequency, order.below, order.above
            unknown = (~known | found.undecided).any(axis=1)
            moved = (order.numbers[poses, place] != place) | found.loose[poses, place]
        else:
            order, place = None, np.full(len(own), quantity.column)
            value = found.frequency[poses, place]
            below = value - found.lowest[poses, place]
            above = found.highest[poses, place] - value
            unknown = ~known[poses, place] | found.undecided[poses, place]
            moved = np.ones(len(own), bool)
        expected = own[poses, place]
        ratio = value / expected
        sizes = np.abs(ratio)
        budget = {Source.MESHES: np.zeros(len(own))} | {
            source: np.where(moved, half_widths.frequencies[poses, place], 0.0) * sizes
            for source, half_widths in one.budget.items()
            if half_widths.frequencies is not None
        }
        return Errors(
            names=(one.name,),
            value=value,
            expected=expected,
            error=ratio - 1.0,
            budget=budget,
            unknown=np.asarray(unknown),
            paired=Paired(
                below=np.nan_to_num(below / expected),
                above=np.nan_to_num(above / expected),
                undecided=found.undecided[poses, place],
                local=found.local[poses, place],
                seen=found.seen[poses, place],
                likeness=found.likeness[poses, place],
                beyond_below=np.zeros(len(own)),
                beyond_above=np.zeros(len(own)),
            ),
            numbers=order and order.numbers,
        )

    def _peak(self, one: Interpretation, model: Model, quantity: Quantity) -> Errors | None:
        """Errors of a judged number of a response against one interpretation."""
        if (both := self.modes_of(model, one)) is None:
            return None
        expected, value = (
            np.where(np.isfinite(peaks), peaks, np.nan)
            for peaks in (modes.peaks[:, quantity.column] for modes in both)
        )
        reach = np.nan_to_num(value / expected)
        budget = {
            source: relative_half_widths * reach
            for source, half_widths in one.budget.items()
            if (relative_half_widths := half_widths.of(quantity)) is not None
        }
        return Errors(
            names=(one.name,),
            value=value,
            expected=expected,
            error=value / expected - 1.0,
            budget={Source.MESHES: np.zeros_like(reach)} | budget,
            unknown=np.isnan(expected),
        )

    def _partners(
        self, model: Model, one: Interpretation, truth: PathModes, own: PathModes
    ) -> Partners:
        key = model, one.name
        if key not in self._pairs:
            count = truth.frequencies.shape[1]
            self._pairs[key] = partners(truth, own, count, one.frequency_half_widths(self.modes))
        return self._pairs[key]

    def _deflection(self, one: Interpretation, model: Model, quantity: Quantity) -> Errors | None:
        """Errors of a displacement against one interpretation."""
        if (both := self.statics_of(model, one)) is None:
            return None
        reference, own = both
        found = relative(own - reference, reference, quantity)
        size, length = found.size, found.length
        moved, due = (statics.displacements(quantity, found.wrench) for statics in (own, reference))
        yields = length > 0
        off = np.divide(moved - due, length[:, None], out=np.zeros_like(due), where=yields[:, None])
        # What changes the reference by a part of its length changes the error by no more than that
        # part of the model's displacement; under any force by no more than that part of 1 + error.
        reach = 1.0 + size
        if quantity != ANY_FORCE:
            along = due / np.where(yields, length, np.inf)[:, None]
            reach = np.linalg.norm(off + along, axis=1)

        budget = {
            source: np.multiply(half_width, reach, out=np.zeros_like(size), where=yields)
            for source, half_widths in one.budget.items()
            if (half_width := half_widths.of(quantity)) is not None
        }
        return Errors(
            names=(one.name,),
            value=np.einsum("pi,pi->p", found.direction, moved),
            expected=np.einsum("pi,pi->p", found.direction, due),
            error=np.where(np.isinf(size), np.nan, size),
            budget={Source.MESHES: np.zeros_like(size)} | budget,
            unknown=np.zeros(len(size), bool),
            displaced=Displaced(
                wrench=found.wrench,
                along=found.along,
                off=off,
                length=length,
                between=np.full(len(size), np.inf),
            ),
        )


def first_largest(sizes: Array) -> IntArray:
    """Number along the first axis of the largest size, the first of those that tie."""
    largest = sizes.max(axis=0)
    least = np.where(largest > 0.0, (1.0 - _SAME) * largest, largest)
    return np.asarray(np.argmax(sizes >= least, axis=0))


def stacked(errors: Sequence[Errors]) -> Errors:
    """Errors against several interpretations (R×P…) from those against each of them (P…)."""
    first = errors[0]

    def columns(records: Sequence[Any]) -> dict[str, Any]:
        """Arrays of all records by field, one row each."""
        arrays = [_arrays(record) for record in records]
        return {name: np.array([one[name] for one in arrays]) for name in arrays[0]}

    none = np.zeros_like(first.error)
    sources = dict.fromkeys(source for one in errors for source in one.budget)
    return replace(
        first,
        names=tuple(name for one in errors for name in one.names),
        budget={
            source: np.array([one.budget.get(source, none) for one in errors]) for source in sources
        },
        displaced=first.displaced and Displaced(**columns([one.displaced for one in errors])),
        paired=first.paired and Paired(**columns([one.paired for one in errors])),
        **columns(errors),
    )


def _arrays(record: Any) -> dict[str, Any]:
    """Fields of a record that are arrays."""
    values = {one.name: getattr(record, one.name) for one in fields(record)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


class _Misplaced(NamedTuple):
    """Modes in other places than the reference's, at p poses.

    `numbers` (p×K) of the model's modes, and the `place` (p) of the mode in another place that
    misleads most. `frequency` (p, Hz) of the model there; `below` and `above` it (p, Hz) lie those
    that mislead most if modes stand in their places that may.
    """

    numbers: IntArray
    place: IntArray
    frequency: Array
    below: Array
    above: Array


def _misplaced(found: Partners, own: Array) -> _Misplaced:
    """Modes in other places than those (p×K, Hz) of the reference."""
    poses, places = np.arange(len(own)), np.arange(own.shape[1])
    known = np.isfinite(own) & ~found.undecided
    # A mode in its place does not mislead, nor does one that is not known.
    numbers = np.where(known, found.ordered, places)
    moved = numbers != places
    off = np.where(known, found.by_number / own - 1.0, 0.0)
    certain, possible = (np.where(of, off, 0.0) for of in (moved, moved | (known & found.loose)))
    (least, _), (error, place) = (_most_misleading(errors) for errors in (certain, possible))
    expected = own[poses, place]
    return _Misplaced(
        numbers,
        place,
        frequency=expected * (1.0 + error),
        below=np.maximum(error - least, 0.0) * expected,
        above=np.maximum(least - error, 0.0) * expected,
    )


def _most_misleading(errors: Array) -> tuple[Array, IntArray]:
    """The largest of the errors (p×K) by size at each pose, and its place.

    A number that does not exist (NaN) misleads more than any that does.
    """
    at = np.argmax(np.where(np.isnan(errors), np.inf, np.abs(errors)), axis=1)
    return errors[np.arange(len(errors)), at], at
