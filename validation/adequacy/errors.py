"""Total relative errors of a model against each interpretation of the reference, by pose."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, ORDER, Quantity, QuantityKind
from lumped.arrays import Array, IntArray
from validation.references.reference import Interpretation, Reference, Source, Subject
from validation.references.responses import Model
from validation.references.robot_on_path import Factors, Reading
from validation.responses.displacement import difference_under, nearest_between, relative
from validation.responses.mode_pairing import one_frequency
from validation.responses.mode_partners import Partners, partners, shape_ranges
from validation.responses.statics_and_modes import PathModes, Statics

H = TypeVar("H")
# Relative difference up to which errors of two poses or interpretations tie, far above rounding.
_TIE = 1e-9


@dataclass(frozen=True, eq=False)
class DisplacementErrors:
    """Displacements behind errors of deflections: R interpretations of the reference by P poses.

    `wrench` (R×P×6) is the unit wrench. For any force it is the worst one, and for loads of the
    robot file it is zero. `along` (R×P) is the signed error of the displacement along the wrench.
    `difference` (R×P×3) is the difference of the displacements of model and reference, relative to
    `length` (R×P, m/N or rad/(N m)), the length of the reference's displacement. `between` (R×P,
    one number per pose) is the error against the reading nearest to the model that lies between two
    interpretations. It is infinite if there is one interpretation.
    """

    wrench: Array
    along: Array
    difference: Array
    length: Array
    between: Array


@dataclass(frozen=True, eq=False)
class ModePairing:
    """Pairing by shape behind errors of frequencies: R interpretations of the reference by P poses.

    `below` and `above`: distances from the error to the lowest and the highest error of other
    partners that shapes leave possible. For the order of modes, of other positions instead of other
    partners. `undecided`: shapes do not decide whether the model has the mode. `local`: the mode is
    local to a leg's section. `rigid_share`: share of its kinetic energy in whole-body motion of
    sections and bodies. `likeness`: MAC with the partner, or the largest MAC with any mode of the
    model if there is no partner. `exchange_below` and `exchange_above`: further distances, beyond
    the interval of the error, to errors of modes that take this number if the stiffness inside the
    legs lies between those of the interpretations.
    """

    below: Array
    above: Array
    undecided: NDArray[np.bool_]
    local: NDArray[np.bool_]
    rigid_share: Array
    likeness: Array
    exchange_below: Array
    exchange_above: Array


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity: R interpretations of the reference, by their `names`, by P poses.

    Frequencies: `value` and `expected` in Hz, `error` = value/expected − 1. Sizes of responses:
    the same, in m/N. Deflections: `value` and `expected` along the load, and `error` of the whole
    displacement, never negative, with its details in `displacement`. NaN if model and reference
    have no number to compare. `unknown`: the reference has fewer modes than are judged, or none
    that is damped, or shapes do not decide whether the model has the mode. `budget` (R×P each):
    half-widths of the error by source, always with that of meshes. `pairing` belongs to modes.
    `numbers` (R×P×m, for the order alone): number, from 0, of the model's mode with the shape of
    each mode of the reference. −1 if no mode has this shape.
    """

    names: tuple[str, ...]
    value: Array
    expected: Array
    error: Array
    unknown: NDArray[np.bool_]
    budget: Mapping[Source, Array]
    displacement: DisplacementErrors | None = None
    pairing: ModePairing | None = None
    numbers: IntArray | None = None

    def rows(self, rows: Sequence[int]) -> "Errors":
        """Errors against some of the interpretations."""

        def selected(record: Any) -> dict[str, Any]:
            return {name: values[rows] for name, values in _arrays(record).items()}

        return replace(
            self,
            names=tuple(self.names[row] for row in rows),
            budget={source: half_widths[rows] for source, half_widths in self.budget.items()},
            displacement=self.displacement and DisplacementErrors(**selected(self.displacement)),
            pairing=self.pairing and ModePairing(**selected(self.pairing)),
            **selected(self),
        )

    @property
    def missing(self) -> NDArray[np.bool_]:
        """True for each error without a number to compare (R×P)."""
        return np.isnan(self.error)

    @property
    def spread(self) -> Array:
        """Half-width of each error (R×P): the linear sum over its sources."""
        return np.asarray(sum(self.budget.values()))

    @property
    def farthest(self) -> Array:
        """Distance of the farther bound from each error (R×P)."""
        if self.pairing is None:
            return self.spread
        low, high = self.bounds
        return np.maximum(self.error - low, high - self.error)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Bounds of the errors (R×P each): half-widths, and errors of other possible partners."""
        low, high = self.error - self.spread, self.error + self.spread
        if self.pairing is None:
            return low, high
        pairing = self.pairing
        return (
            low - pairing.below - pairing.exchange_below,
            high + pairing.above + pairing.exchange_above,
        )

    @property
    def interval(self) -> tuple[Array, Array]:
        """Lowest and highest error (P each) of all interpretations with their half-widths.

        The error of a whole displacement is never below zero, and zero if the model lies between
        two interpretations. For the order, the interval is that of the interpretation with the
        largest error: between a mode in its position and one in another there is no continuum.
        """
        low, high = self.bounds
        if self.numbers is not None:
            largest = self.largest, np.arange(self.error.shape[1])
            return low[largest], high[largest]
        low, high = low.min(axis=0), high.max(axis=0)
        if self.displacement is not None:
            between = self.displacement.between.min(axis=0) - self.spread.max(axis=0)
            low = np.maximum(np.minimum(low, between), 0.0)
        return low, high

    @property
    def bound(self) -> Array:
        """Largest absolute error (P) within the interval. NaN if an error is missing."""
        low, high = self.interval
        bound = np.maximum(np.abs(low), np.abs(high))
        return np.where(self.missing.any(axis=0), np.nan, bound)

    @property
    def worst(self) -> Array:
        """Error (P) of largest magnitude of all interpretations. NaN if one of them has none."""
        worst = self.error[self.largest, np.arange(self.error.shape[1])]
        return np.where(self.missing.any(axis=0), np.nan, worst)

    @property
    def largest(self) -> IntArray:
        """Interpretation (P) of the error of largest magnitude, of those that have an error."""
        return first_largest(np.where(self.missing, -1.0, np.abs(self.error)))


@dataclass(frozen=True, eq=False)
class ModelErrors:
    """Errors of any model of a subject against its references. Pairings of modes are stored.

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
        by_interpretation = [
            errors
            for interpretation in interpretations
            if (errors := errors_of(interpretation, model, quantity))
        ]
        if not by_interpretation or len(by_interpretation) < len(interpretations):
            return None
        all_errors = stack_errors(by_interpretation)
        if all_errors.displacement is not None:
            between = self._between(all_errors.displacement.wrench, model, quantity)
            between = np.broadcast_to(between, all_errors.error.shape)
            return replace(
                all_errors, displacement=replace(all_errors.displacement, between=between)
            )
        if quantity.kind is not QuantityKind.FREQUENCY or not self.subject.dynamics.interior:
            return all_errors
        return self._with_exchanges(all_errors, model, quantity.column)

    def statics(self, model: Model) -> list[tuple[Statics, Statics]]:
        """Statics of the reference and of a model, for each interpretation that has both."""
        pairs = (
            self.statics_of(model, interpretation)
            for interpretation in self.subject.statics.interpretations
        )
        return [pair for pair in pairs if pair]

    def statics_of(
        self, model: Model, interpretation: Interpretation
    ) -> tuple[Statics, Statics] | None:
        """Statics of the reference and of a model. None if one of them has none."""
        return self._both(
            self.subject.statics, model, interpretation, self.subject.responses.known_statics
        )

    def modes_of(
        self, model: Model, interpretation: Interpretation
    ) -> tuple[PathModes, PathModes] | None:
        """Modes of the reference and of a model. None if one of them has none."""
        return self._both(
            self.subject.dynamics, model, interpretation, self.subject.responses.known_modes
        )

    def _both(
        self,
        reference: Reference,
        model: Model,
        interpretation: Interpretation,
        known: Callable[[Model, Reading], H | None],
    ) -> tuple[H, H] | None:
        """Halves of the responses of a reference and of a model. None if one of them has none."""
        reading = replace(interpretation.reading, factors=self.factors)
        of_reference = known(reference.model, reading) if reference.model else None
        of_model = known(model, reading)
        return (of_reference, of_model) if of_reference and of_model else None

    def _between(self, wrenches: Array, model: Model, quantity: Quantity) -> Array:
        """Relative size (P) of the difference from the nearest reading between two interpretations.

        `wrenches` (R×P×6) by interpretation. Under any force the largest one counts.
        """
        statics_pairs = self.statics(model)
        nearest = []
        for wrench in wrenches:
            differences = [
                difference_under(statics, reference, quantity, wrench)
                for reference, statics in statics_pairs
            ]
            nearest.append(
                nearest_between(*(np.array(numbers) for numbers in zip(*differences, strict=True)))
            )
        return np.asarray(np.max(nearest, axis=0))

    def _with_exchanges(self, errors: Errors, model: Model, number: int) -> Errors:
        """Extend errors by those of modes with this `number` for other stiffnesses inside the legs.

        Interpretations that differ in that stiffness alone are ends of a range. Within the range a
        mode has a frequency between those of its shape at the ends, and the mode with this number
        has one between those with this number, whatever its shape: modes pass each other there.
        """
        (low, high), spread, pairing = errors.bounds, errors.spread, errors.pairing
        poses = np.arange(low.shape[1])
        below, above = np.zeros_like(low), np.zeros_like(high)
        for rows in self.subject.dynamics.by_interior:
            lowest, highest = self._exchanged(model, rows, number)
            lowest_row, highest_row = (
                np.array(rows)[bound[rows].argmin(axis=0)] for bound in (low, -high)
            )
            lowest_at, highest_at = (lowest_row, poses), (highest_row, poses)
            below[lowest_at] = np.maximum(low[lowest_at] - (lowest - spread[lowest_at]), 0.0)
            above[highest_at] = np.maximum(highest + spread[highest_at] - high[highest_at], 0.0)
        widened = pairing and replace(pairing, exchange_below=below, exchange_above=above)
        return replace(errors, pairing=widened)

    def _exchanged(self, model: Model, rows: Sequence[int], number: int) -> tuple[Array, Array]:
        """Lowest and highest error (P each) of modes with this `number` between interpretations.

        Infinite if none of them has a partner among the modes of the model.
        """
        interpretations = self.subject.dynamics.interpretations
        solved = [
            (interpretation, *both_modes)
            for interpretation in (interpretations[row] for row in rows)
            if (both_modes := self.modes_of(model, interpretation))
        ]
        references = [reference for _, reference, _ in solved]
        numbered = np.array([reference.frequencies[:, number] for reference in references])
        first_frequency, last_frequency = (
            numbered.min(axis=0)[:, None],
            numbered.max(axis=0)[:, None],
        )
        lowest, highest = [], []
        for (interpretation, reference, modes), (low, high) in zip(
            solved, self._shape_ranges(tuple(rows), references), strict=True
        ):
            pairs = self._partners(model, interpretation, reference, modes)
            mode_spaces = np.array([one_frequency(row) for row in reference.frequencies])
            # Repeated modes are one space, in which none passes another.
            possible = (mode_spaces != mode_spaces[:, [number]]) | (
                np.arange(low.shape[1]) == number
            )
            possible &= (low <= last_frequency) & (high >= first_frequency)
            lowest.append(
                np.where(possible, pairs.lowest / np.minimum(high, last_frequency) - 1.0, np.inf)
            )
            highest.append(
                np.where(possible, pairs.highest / np.maximum(low, first_frequency) - 1.0, -np.inf)
            )
        return (
            np.fmin.reduce(np.hstack(lowest), axis=1),
            np.fmax.reduce(np.hstack(highest), axis=1),
        )

    def _shape_ranges(
        self, rows: tuple[int, ...], references: Sequence[PathModes]
    ) -> list[tuple[Array, Array]]:
        if rows not in self._ranges:
            self._ranges[rows] = shape_ranges(references)
        return self._ranges[rows]

    def _frequency(
        self, interpretation: Interpretation, model: Model, quantity: Quantity
    ) -> Errors | None:
        """Errors of a frequency, or of the order, against one interpretation.

        Errors of the order belong to the mode with the largest error, of all modes whose number
        differs.
        """
        if (both_modes := self.modes_of(model, interpretation)) is None:
            return None
        reference = both_modes[0]
        pairs = self._partners(model, interpretation, *both_modes).first(self.modes)
        frequencies = reference.frequencies[:, : self.modes]
        poses, solved = np.arange(len(frequencies)), np.isfinite(frequencies)
        if quantity == ORDER:
            order = _misplaced_modes(pairs, frequencies)
            mode, value, below, above = order.mode, order.frequency, order.below, order.above
            unknown = (~solved | pairs.undecided).any(axis=1)
            uncertain = (order.numbers[poses, mode] != mode) | pairs.loose[poses, mode]
        else:
            order, mode = None, np.full(len(frequencies), quantity.column)
            value = pairs.frequency[poses, mode]
            below = value - pairs.lowest[poses, mode]
            above = pairs.highest[poses, mode] - value
            unknown = ~solved[poses, mode] | pairs.undecided[poses, mode]
            uncertain = np.ones(len(frequencies), bool)
        expected = frequencies[poses, mode]
        ratio = value / expected
        sizes = np.abs(ratio)
        budget = {Source.MESHES: np.zeros(len(frequencies))} | {
            source: np.where(uncertain, half_widths.frequencies[poses, mode], 0.0) * sizes
            for source, half_widths in interpretation.budget.items()
            if half_widths.frequencies is not None
        }
        return Errors(
            names=(interpretation.name,),
            value=value,
            expected=expected,
            error=ratio - 1.0,
            budget=budget,
            unknown=np.asarray(unknown),
            pairing=ModePairing(
                below=np.nan_to_num(below / expected),
                above=np.nan_to_num(above / expected),
                undecided=pairs.undecided[poses, mode],
                local=pairs.local[poses, mode],
                rigid_share=pairs.seen[poses, mode],
                likeness=pairs.likeness[poses, mode],
                exchange_below=np.zeros(len(frequencies)),
                exchange_above=np.zeros(len(frequencies)),
            ),
            numbers=order and order.numbers,
        )

    def _peak(
        self, interpretation: Interpretation, model: Model, quantity: Quantity
    ) -> Errors | None:
        """Errors of a judged number of a response against one interpretation."""
        if (both_modes := self.modes_of(model, interpretation)) is None:
            return None
        expected, value = (
            np.where(np.isfinite(peaks), peaks, np.nan)
            for peaks in (modes.peaks[:, quantity.column] for modes in both_modes)
        )
        reach = np.nan_to_num(value / expected)
        budget = {
            source: relative_half_widths * reach
            for source, half_widths in interpretation.budget.items()
            if (relative_half_widths := half_widths.of(quantity)) is not None
        }
        return Errors(
            names=(interpretation.name,),
            value=value,
            expected=expected,
            error=value / expected - 1.0,
            budget={Source.MESHES: np.zeros_like(reach)} | budget,
            unknown=np.isnan(expected),
        )

    def _partners(
        self, model: Model, interpretation: Interpretation, reference: PathModes, modes: PathModes
    ) -> Partners:
        key = model, interpretation.name
        if key not in self._pairs:
            count = reference.frequencies.shape[1]
            self._pairs[key] = partners(
                reference, modes, count, interpretation.frequency_half_widths(self.modes)
            )
        return self._pairs[key]

    def _deflection(
        self, interpretation: Interpretation, model: Model, quantity: Quantity
    ) -> Errors | None:
        """Errors of a displacement against one interpretation."""
        if (both_statics := self.statics_of(model, interpretation)) is None:
            return None
        reference, model_statics = both_statics
        errors = relative(model_statics - reference, reference, quantity)
        size, length = errors.size, errors.length
        model_displacements, reference_displacements = (
            statics.displacements(quantity, errors.wrench) for statics in (model_statics, reference)
        )
        elastic = length > 0
        difference = np.divide(
            model_displacements - reference_displacements,
            length[:, None],
            out=np.zeros_like(reference_displacements),
            where=elastic[:, None],
        )
        # A change of the reference by a fraction of its length changes the error by at most that
        # fraction of the model's displacement, under any force by at most that of 1 + error.
        reach = 1.0 + size
        if quantity != ANY_FORCE:
            along = reference_displacements / np.where(elastic, length, np.inf)[:, None]
            reach = np.linalg.norm(difference + along, axis=1)

        budget = {
            source: np.multiply(half_width, reach, out=np.zeros_like(size), where=elastic)
            for source, half_widths in interpretation.budget.items()
            if (half_width := half_widths.of(quantity)) is not None
        }
        return Errors(
            names=(interpretation.name,),
            value=np.einsum("pi,pi->p", errors.direction, model_displacements),
            expected=np.einsum("pi,pi->p", errors.direction, reference_displacements),
            error=np.where(np.isinf(size), np.nan, size),
            budget={Source.MESHES: np.zeros_like(size)} | budget,
            unknown=np.zeros(len(size), bool),
            displacement=DisplacementErrors(
                wrench=errors.wrench,
                along=errors.along,
                difference=difference,
                length=length,
                between=np.full(len(size), np.inf),
            ),
        )


def first_largest(sizes: Array) -> IntArray:
    """Index along the first axis of the largest size, the first of those that tie."""
    largest = sizes.max(axis=0)
    least = np.where(largest > 0.0, (1.0 - _TIE) * largest, largest)
    return np.asarray(np.argmax(sizes >= least, axis=0))


def stack_errors(errors: Sequence[Errors]) -> Errors:
    """Stack errors against each interpretation (P…) to errors against all of them (R×P…)."""
    first = errors[0]

    def columns(records: Sequence[Any]) -> dict[str, Any]:
        """Arrays of all records by field, one row each."""
        arrays = [_arrays(record) for record in records]
        return {name: np.array([row[name] for row in arrays]) for name in arrays[0]}

    zeros = np.zeros_like(first.error)
    sources = dict.fromkeys(source for row in errors for source in row.budget)
    return replace(
        first,
        names=tuple(name for row in errors for name in row.names),
        budget={
            source: np.array([row.budget.get(source, zeros) for row in errors])
            for source in sources
        },
        displacement=first.displacement
        and DisplacementErrors(**columns([row.displacement for row in errors])),
        pairing=first.pairing and ModePairing(**columns([row.pairing for row in errors])),
        **columns(errors),
    )


def _arrays(record: Any) -> dict[str, Any]:
    """Fields of a record that are arrays."""
    values = {field_.name: getattr(record, field_.name) for field_ in fields(record)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


class _MisplacedModes(NamedTuple):
    """Modes whose numbers differ from those of the reference, at P poses.

    `numbers` (P×K) of the model's modes. `mode` (P): number of the reference's mode whose
    misplacement causes the largest error. `frequency` (P, Hz): the model's frequency with this
    number. `below` and `above` (P, Hz): distances to the frequencies of the largest error if modes
    take the other numbers that shapes leave possible.
    """

    numbers: IntArray
    mode: IntArray
    frequency: Array
    below: Array
    above: Array


def _misplaced_modes(pairs: Partners, frequencies: Array) -> _MisplacedModes:
    """Misplaced modes of a model, for `frequencies` (P×K, Hz) of the reference."""
    poses, modes = np.arange(len(frequencies)), np.arange(frequencies.shape[1])
    solved = np.isfinite(frequencies) & ~pairs.undecided
    # A mode with its own number causes no error, nor does one whose frequency is unknown.
    numbers = np.where(solved, pairs.ordered, modes)
    misplaced = numbers != modes
    errors = np.where(solved, pairs.by_number / frequencies - 1.0, 0.0)
    certain, possible = (
        np.where(mask, errors, 0.0) for mask in (misplaced, misplaced | (solved & pairs.loose))
    )
    (least, _), (error, mode) = (_largest_error(candidates) for candidates in (certain, possible))
    expected = frequencies[poses, mode]
    return _MisplacedModes(
        numbers,
        mode,
        frequency=expected * (1.0 + error),
        below=np.maximum(error - least, 0.0) * expected,
        above=np.maximum(least - error, 0.0) * expected,
    )


def _largest_error(errors: Array) -> tuple[Array, IntArray]:
    """Error of largest magnitude (P) of errors (P×K) at each pose, and its column.

    A missing frequency (NaN) counts as larger than any error.
    """
    column = np.argmax(np.where(np.isnan(errors), np.inf, np.abs(errors)), axis=1)
    return errors[np.arange(len(errors)), column], column
