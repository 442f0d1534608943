"""Errors of the models of a robot against its references, by quantity.

Input: statics and modes of each model and of the reference under each interpretation of the robot
file. Output: `Errors` of a quantity for all interpretations. Rule: the error of a frequency is
signed and compares modes of the same shape; the error of a displacement is the length of the
difference vector over the length of the reference's vector, and so is never negative.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

import numpy as np

from lumped.acceptance.quantities import ORDER, Quantity, QuantityKind
from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from validation.adequacy.errors import DisplacementErrors, Errors, ModePairing, stack_errors
from validation.references.reference import Interpretation, Reference, Source, Subject
from validation.references.responses import Model
from validation.references.robot_on_path import Factors, Reading
from validation.responses.displacement import difference_under, nearest_between, relative
from validation.responses.mode_pairing import equal_frequency_groups
from validation.responses.mode_partners import Partners, partners, shape_ranges
from validation.responses.statics_and_modes import PathModes, Statics

H = TypeVar("H")


@dataclass(frozen=True, eq=False)
class ModelErrors:
    """Errors of all models of one robot against its references.

    `subject`: models and references of the robot. `modes`: number of judged frequencies. `factors`:
    relative changes of uncertain inputs of the robot file, with which models and references are
    solved. Pairs of modes are stored, so that each model is paired once.
    """

    subject: Subject
    modes: int
    factors: Factors = ()
    _pairs: dict[tuple[Model, str], Partners] = field(default_factory=dict, repr=False)
    _ranges: dict[tuple[int, ...], list[tuple[Array, Array]]] = field(
        default_factory=dict, repr=False
    )

    def errors(self, model: Model, quantity: Quantity) -> Errors | None:
        """Errors of a quantity of a model.

        An interpretation is one choice of what the robot file leaves open, such as end conditions
        and mass distributions. None if the model or the reference has no solution under one or more
        of the interpretations.
        """
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

    def required_errors(self, model: Model, quantity: Quantity) -> Errors:
        """Errors of a quantity of a model. Raises ComputationError if there are none."""
        if errors := self.errors(model, quantity):
            return errors
        raise ComputationError(f"{model.name} has no error of {quantity}: it has no solution")

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
        """Statics of the reference and of a model. None if one of them is unsolved or undefined."""
        return self._both(
            self.subject.statics, model, interpretation, self.subject.responses.known_statics
        )

    def modes_of(
        self, model: Model, interpretation: Interpretation
    ) -> tuple[PathModes, PathModes] | None:
        """Modes of the reference and of a model. None if one of them is unsolved or undefined."""
        return self._both(
            self.subject.dynamics, model, interpretation, self.subject.responses.known_modes
        )

    def _both(
        self,
        reference: Reference,
        model: Model,
        interpretation: Interpretation,
        responses: Callable[[Model, Reading], H | None],
    ) -> tuple[H, H] | None:
        """Solutions of the reference and of a model: statics or modes, as `responses` returns them.

        None if one of the two is unsolved or undefined.
        """
        reading = replace(interpretation.reading, factors=self.factors)
        of_reference = responses(reference.model, reading) if reference.model else None
        of_model = responses(model, reading)
        return (of_reference, of_model) if of_reference and of_model else None

    def _between(self, wrenches: Array, model: Model, quantity: Quantity) -> Array:
        """Smallest relative error (P) against a displacement between those of two interpretations.

        `wrenches` (R×P×6) has one load for each of the R interpretations of the reference in P
        poses. The smallest error is computed under each of these R loads, and the largest of the R
        numbers is returned.
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
        """Errors of frequency `number`, widened for all stiffnesses possible inside the legs.

        Interpretations that differ only in the stiffness inside the legs are the ends of a range.
        Within this range, frequencies of different shapes can cross, so that mode `number` (index
        from 0) may have another shape than at the ends. Its frequency lies between those of mode
        `number` at the two ends, and between those of its own shape at the two ends.
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
        """Lowest and highest error (P each) of modes that can have this `number` (index from 0).

        `rows` are the interpretations at the ends of a range of stiffness inside the legs. Both are
        infinite if the model has no partner of the mode. Array sizes: P poses.
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
            mode_spaces = np.array([equal_frequency_groups(row) for row in reference.frequencies])
            # Modes of equal frequency do not exchange their numbers.
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
        """Errors of a frequency, or of the order of modes, against one interpretation.

        For the order of modes, the error is the largest frequency error that follows because a mode
        has another number than in the reference.
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
                rigid_share=pairs.energy_shares[poses, mode],
                mac=pairs.mac[poses, mode],
                exchange_below=np.zeros(len(frequencies)),
                exchange_above=np.zeros(len(frequencies)),
            ),
            numbers=order and order.numbers,
        )

    def _peak(
        self, interpretation: Interpretation, model: Model, quantity: Quantity
    ) -> Errors | None:
        """Errors of a harmonic response, such as of its peak, against one interpretation."""
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
        impossible, length = np.isnan(errors.size), errors.length
        size = errors.size if impossible.all() else np.nan_to_num(errors.size, posinf=np.inf)
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
        # If the reference's vector changes by a fraction ε of its length, the error changes by at
        # most ε |u|/|u*|, for displacements u of the model and u* of the reference. For any force,
        # |u|/|u*| is at most 1 + error.
        reach = 1.0 + size
        if not quantity.any_direction:
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
            unknown=np.full(len(size), bool(impossible.all())),
            displacement=DisplacementErrors(
                wrench=errors.wrench,
                along=errors.along,
                difference=difference,
                length=length,
                between=np.full(len(size), np.inf),
                impossible=impossible,
            ),
        )


class _MisplacedModes(NamedTuple):
    """Mode numbers of a model, and the mode whose different number causes the largest error.

    `numbers` (P×K): index of the model's mode for each mode of the reference. `mode` (P): index of
    the reference's mode whose misplacement causes the largest error. `frequency` (P, Hz): the
    model's frequency with this index. `below`, `above` (P, Hz): distance from `frequency` down or
    up to the frequency that determines the error if only modes count that are misplaced in every
    pairing that mixed shapes allow. Array sizes: P poses, K judged modes.
    """

    numbers: IntArray
    mode: IntArray
    frequency: Array
    below: Array
    above: Array


def _misplaced_modes(pairs: Partners, frequencies: Array) -> _MisplacedModes:
    """Modes whose number in a model differs from that of their partner in the reference.

    `pairs` are the partners and `frequencies` (P×K, Hz) the reference's, for K judged modes in P
    poses.
    """
    poses, modes = np.arange(len(frequencies)), np.arange(frequencies.shape[1])
    solved = np.isfinite(frequencies) & ~pairs.undecided
    # A mode with the same number as in the reference causes no error; neither does an unknown one.
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
    """Error of largest magnitude (P) among errors (P×K), and its column (P).

    A missing frequency (NaN) counts as larger than any error. Array sizes: P poses, K judged modes.
    """
    column = np.argmax(np.where(np.isnan(errors), np.inf, np.abs(errors)), axis=1)
    return errors[np.arange(len(errors)), column], column
