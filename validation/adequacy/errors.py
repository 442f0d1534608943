"""Total relative errors of a model against every alternative of the reference, pose by pose."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, ORDER, Quantity, QuantityKind
from lumped.arrays import Array, IntArray
from validation.adequacy.partners import Partners, partners, shape_ranges
from validation.adequacy.response import (
    Alternative,
    Reference,
    Response,
    Subject,
    by_interior,
)
from validation.agreement.displacement import difference_under, nearest_between, relative
from validation.agreement.mode_pairing import one_frequency
from validation.agreement.responses import PathModes


@dataclass(frozen=True, eq=False)
class Loaded:
    """What belongs to errors of deflections: a alternatives of the reference by p poses.

    `wrench` (a×p×6) is the unit wrench, of any force the worst one, zero for loads of the file;
    `along` (a×p) the signed error of the displacement along it. `off` (a×p×3) is the difference of
    displacements, relative to `length` (a×p, m/N or rad/(N m), of the reference's). `masses` (a×p):
    what the places of the legs' masses leave open of the error, and `linear` (a×p) that loads
    change the stiffness. `between` (a×p, one number per pose): error
    against the reading between two alternatives that is nearest to the model, infinite if there is
    one alternative.
    """

    wrench: Array
    along: Array
    off: Array
    length: Array
    masses: Array
    linear: Array
    between: Array


@dataclass(frozen=True, eq=False)
class Paired:
    """Pairing by shape behind errors of frequencies: a alternatives of the reference by p poses.

    `below` and `above` the error lie those of other partners that shapes leave open; of the order
    those of other places. `undecided`: shapes do not decide whether the model has the mode.
    `local`: the mode is local to a leg's section, `seen` the share of its kinetic energy in
    sections and bodies that move as wholes. `likeness` with the partner, or the largest with any
    mode of the model. `beyond_below` and `beyond_above`: distance from the error and what else is
    left open of it to those of modes that have this number with a stiffness inside the legs between
    those of the alternatives.
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

    def rows(self, rows: Sequence[int]) -> "Errors":
        """Errors against some of the alternatives."""

        def chosen(record: Any) -> dict[str, Any]:
            return {name: values[rows] for name, values in _arrays(record).items()}

        return replace(
            self,
            names=tuple(self.names[row] for row in rows),
            loaded=self.loaded and Loaded(**chosen(self.loaded)),
            paired=self.paired and Paired(**chosen(self.paired)),
            **chosen(self),
        )

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
        """Lowest and highest error (p each) of all alternatives with their half-widths.

        The error of a whole displacement is never below zero, and zero if the model lies between
        two alternatives. Of the order the interval is that of the alternative by which it misleads
        most: between a mode in its place and one in another there is nothing.
        """
        low, high = self.bounds
        if self.numbers is not None:
            at = self.largest, np.arange(self.error.shape[1])
            return low[at], high[at]
        low, high = low.min(axis=0), high.max(axis=0)
        if self.loaded is not None:
            between = self.loaded.between.min(axis=0) - self.spread.max(axis=0)
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
    _ranges: dict[tuple[int, ...], list[tuple[Array, Array]]] = field(
        default_factory=dict, repr=False
    )

    def reference(self, quantity: Quantity) -> Reference:
        """The reference of a quantity."""
        return self.subject.statics if quantity.static else self.subject.dynamics

    def errors(self, responses: Sequence[Response], quantity: Quantity) -> Errors | None:
        """Errors of a quantity; `responses` one per alternative of its reference.

        None where a response says nothing of it.
        """
        alternatives = self.reference(quantity).alternatives
        errors_of = self._deflection if quantity.static else self._peak
        if quantity.modal:
            errors_of = self._frequency
        found = [
            errors
            for one, response in zip(alternatives, responses, strict=True)
            if (errors := errors_of(one, response, quantity))
        ]
        if not found or len(found) < len(alternatives):
            return None
        all_errors = stacked(found)
        if all_errors.loaded is not None:
            between = self._between(all_errors.loaded.wrench, responses, quantity)
            between = np.broadcast_to(between, all_errors.error.shape)
            return replace(all_errors, loaded=replace(all_errors.loaded, between=between))
        if quantity.kind is not QuantityKind.FREQUENCY or not self.subject.dynamics.interior:
            return all_errors
        return self._with_exchanges(all_errors, responses, quantity.column)

    def _between(self, wrenches: Array, responses: Sequence[Response], quantity: Quantity) -> Array:
        """Relative size (p) of the difference from the nearest reading between two alternatives.

        `wrenches` (a×p×6) by alternative. Under any force the one under which it is largest counts.
        """
        known = [
            (reference, model)
            for one, response in zip(self.subject.statics.alternatives, responses, strict=True)
            if (reference := one.response.solved_statics) and (model := response.solved_statics)
        ]
        nearest = []
        for wrench in wrenches:
            found = [
                difference_under(model, reference, quantity, wrench) for reference, model in known
            ]
            nearest.append(nearest_between(*(np.array(one) for one in zip(*found, strict=True))))
        return np.asarray(np.max(nearest, axis=0))

    def _with_exchanges(self, errors: Errors, responses: Sequence[Response], place: int) -> Errors:
        """Add the errors of modes that stand at a `place` with another stiffness inside the legs.

        Alternatives that differ in that stiffness alone are ends of a range. Within it a mode has a
        frequency between those of its shape at the ends, and the mode at `place` one between those
        at this place, whatever its shape: modes pass each other there.
        """
        (low, high), spread, paired = errors.bounds, errors.spread, errors.paired
        poses = np.arange(low.shape[1])
        below, above = np.zeros_like(low), np.zeros_like(high)
        for rows in by_interior(self.subject.dynamics):
            lowest, highest = self._exchanged(responses, rows, place)
            first, last = (np.array(rows)[of[rows].argmin(axis=0)] for of in (low, -high))
            down, up = (first, poses), (last, poses)
            below[down] = np.maximum(low[down] - (lowest - spread[down]), 0.0)
            above[up] = np.maximum(highest + spread[up] - high[up], 0.0)
        widened = paired and replace(paired, beyond_below=below, beyond_above=above)
        return replace(errors, paired=widened)

    def _exchanged(
        self, responses: Sequence[Response], rows: Sequence[int], place: int
    ) -> tuple[Array, Array]:
        """Lowest and highest error (p each) of modes that stand at `place` between alternatives.

        Infinite if none of them has a partner among the modes of the model.
        """
        known = [
            (one, truth, response, model)
            for one, response in (
                (self.subject.dynamics.alternatives[k], responses[k]) for k in rows
            )
            if (truth := one.response.solved_modes) and (model := response.solved_modes)
        ]
        truths = [truth for _, truth, *_ in known]
        there = np.array([truth.frequencies[:, place] for truth in truths])
        first, last = there.min(axis=0)[:, None], there.max(axis=0)[:, None]
        lowest, highest = [], []
        for (one, truth, response, model), (low, high) in zip(
            known, self._shape_ranges(tuple(rows), truths), strict=True
        ):
            found = self._partners(one, truth, response, model)
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

    def _frequency(self, one: Alternative, response: Response, quantity: Quantity) -> Errors | None:
        """Errors of a frequency, or of the order, against one alternative.

        Those of the order belong to the mode, among all in another place, whose number misleads
        most.
        """
        truth, model = one.response.solved_modes, response.solved_modes
        if truth is None or model is None:
            return None
        found = self._partners(one, truth, response, model).first(self.modes)
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
        numerical, digits = (
            np.zeros(len(own)) if left is None else np.where(moved, left[poses, place], 0.0)
            for left in (one.dynamic, one.dynamic_digits)
        )
        sizes = np.abs(ratio)
        return Errors(
            names=(one.name,),
            value=value,
            expected=expected,
            error=ratio - 1.0,
            numerical=numerical * sizes,
            digits=digits * sizes,
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

    def _peak(self, one: Alternative, response: Response, quantity: Quantity) -> Errors | None:
        """Errors of a judged number of a response against one alternative."""
        truth, model, left = one.response.solved_modes, response.solved_modes, one.responses
        if truth is None or model is None or left is None:
            return None
        column = quantity.column
        value, own = (
            np.where(np.isfinite(of.peaks[:, column]), of.peaks[:, column], np.nan)
            for of in (model, truth)
        )
        reach = np.nan_to_num(value / own)
        return Errors(
            names=(one.name,),
            value=value,
            expected=own,
            error=value / own - 1.0,
            numerical=left.meshes[:, column] * reach,
            digits=left.digits[:, column] * reach,
            unknown=np.isnan(own),
        )

    def _partners(
        self, one: Alternative, truth: PathModes, response: Response, model: PathModes
    ) -> Partners:
        key = id(response), one.name
        if key not in self._pairs:
            left = [
                of[:, : self.modes] for of in (one.dynamic, one.dynamic_digits) if of is not None
            ]
            unsure = np.sum(left, axis=0) if left else None
            count = truth.frequencies.shape[1]
            self._pairs[key] = partners(truth, model, count, unsure)
        return self._pairs[key]

    def _deflection(
        self, one: Alternative, response: Response, quantity: Quantity
    ) -> Errors | None:
        """Errors of a displacement against one alternative."""
        reference, model = one.response.solved_statics, response.solved_statics
        if reference is None or model is None:
            return None
        found = relative(model - reference, reference, quantity)
        size, length = found.size, found.length
        moved, due = (
            statics.displacements(quantity, found.wrench) for statics in (model, reference)
        )
        yields = length > 0
        off = np.divide(moved - due, length[:, None], out=np.zeros_like(due), where=yields[:, None])
        # What changes the reference by a part of its length changes the error by no more than that
        # part of the model's displacement; under any force by no more than that part of 1 + error.
        reach = 1.0 + size
        if quantity != ANY_FORCE:
            along = due / np.where(yields, length, np.inf)[:, None]
            reach = np.linalg.norm(off + along, axis=1)

        def half_width(left: Array | None) -> Array:
            found = np.zeros_like(size)
            if left is None:
                return found
            return np.multiply(left[:, quantity.static_column], reach, out=found, where=yields)

        return Errors(
            names=(one.name,),
            value=np.einsum("pi,pi->p", found.direction, moved),
            expected=np.einsum("pi,pi->p", found.direction, due),
            error=np.where(np.isinf(size), np.nan, size),
            numerical=half_width(one.static),
            digits=half_width(one.digits),
            unknown=np.zeros(len(size), bool),
            loaded=Loaded(
                wrench=found.wrench,
                along=found.along,
                off=off,
                length=length,
                masses=half_width(one.masses),
                linear=half_width(one.linear),
                between=np.full(len(size), np.inf),
            ),
        )


def stacked(errors: Sequence[Errors]) -> Errors:
    """Errors against several alternatives (a×p…) from those against each of them (p…)."""
    first = errors[0]

    def columns(records: Sequence[Any]) -> dict[str, Any]:
        """Arrays of all records by field, one row each."""
        arrays = [_arrays(record) for record in records]
        return {name: np.array([one[name] for one in arrays]) for name in arrays[0]}

    return replace(
        first,
        names=tuple(name for one in errors for name in one.names),
        loaded=first.loaded and Loaded(**columns([one.loaded for one in errors])),
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
