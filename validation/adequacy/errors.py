"""Relative errors of a model, by quantity, pose and interpretation of the robot file.

Input: errors computed in `validation.adequacy.model_errors`. Output: `Errors`, arrays of R
interpretations by P poses, with the half-width due to each source of uncertainty, and the verdict
in each pose. Rule: the interval that contains the true error covers all interpretations and
half-widths.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from validation.references.reference import Source
from validation.verdicts import Adequacy

# Relative difference up to which errors of two poses or interpretations count as equal, far above
# round-off.
_TIE = 1e-9


@dataclass(frozen=True, eq=False)
class DisplacementErrors:
    """Displacement vectors from which errors are computed (R interpretations, P poses).

    `wrench` (R×P×6): unit wrench on the loaded point. For the quantity "any force" it is the force
    with the largest error; for loads of the robot file it is zero. `along` (R×P): signed error of
    the displacement component along the wrench. `difference` (R×P×3): displacement of the model
    minus that of the reference. `length` (R×P, m/N or rad/(N m)): length of the reference's
    displacement, by which the difference is divided. `between` (R×P, equal for all R): smallest
    error of the model against any displacement that lies between those of two interpretations;
    infinite if there is one interpretation. `impossible` (R×P): true if the tool cannot move as the
    load requires in this pose. Such poses are not compared; their errors are zero, or NaN if the
    load is impossible in all poses.
    """

    wrench: Array
    along: Array
    difference: Array
    length: Array
    between: Array
    impossible: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ModePairing:
    """Comparison of modes paired for frequency errors (arrays of R interpretations by P poses).

    `below`, `above`: distances from the error down to the lowest and up to the highest error with
    any partner that the shapes allow; zero if the shapes allow only one partner. For the quantity
    "order of modes", they are the distances to the errors with other mode numbers. `undecided`:
    true if the shapes do not show whether the model has the mode. `local`: true if the mode is
    local to the cross-section of a leg. `rigid_share`: share of the mode's kinetic energy in
    cross-sections and bodies that move as rigid wholes. `mac`: modal assurance criterion (MAC) with
    the partner; without a partner, the largest MAC with any mode of the model. `exchange_below`,
    `exchange_above`: further distances for a stiffness inside the legs that lies between those of
    two interpretations: to the errors of other modes that can then have this mode's number.
    """

    below: Array
    above: Array
    undecided: NDArray[np.bool_]
    local: NDArray[np.bool_]
    rigid_share: Array
    mac: Array
    exchange_below: Array
    exchange_above: Array


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity of a model: R interpretations of the reference by P poses (R×P).

    For frequencies (Hz) and peaks of responses (m/N), `error` is `value`/`expected` − 1. For
    displacements, `value` and `expected` are the components along the load, `error` is that of the
    whole vector, never negative, and `displacement` has the details. `value`, `expected` and
    `error` are NaN if model or reference has no number to compare. `names`: names of the
    interpretations. `unknown`: true if the reference has fewer modes than are judged, or no damping
    that bounds the peak of a response; if the shapes do not show whether the model has the mode; or
    if there is no pose in which the tool can move as a load of the robot file requires. `budget`:
    half-width of the error by source of uncertainty, the meshes among them. `pairing`: partners of
    the modes, for frequencies only. `numbers` (R×P×m), for the order of modes only: index from 0 of
    the model's mode with the shape of each of the m modes of the reference, −1 if there is none.
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
        """Errors against the interpretations with the indices `rows` only."""

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
        """True (R×P) for errors that do not exist because there is no number to compare.

        Array sizes: R interpretations of the reference, P poses.
        """
        return np.isnan(self.error)

    @property
    def compared(self) -> NDArray[np.bool_]:
        """True (P) for the poses in which the load is possible, so that errors are compared.

        If the load is impossible in all poses, all poses are compared.
        """
        if self.displacement is None:
            return np.ones(self.error.shape[1], dtype=bool)
        possible = ~self.displacement.impossible.all(axis=0)
        return np.asarray(possible | ~possible.any())

    @property
    def spread(self) -> Array:
        """Half-width of each error (R×P), summed over all sources of uncertainty.

        Array sizes: R interpretations of the reference, P poses.
        """
        return np.asarray(sum(self.budget.values()))

    @property
    def farthest(self) -> Array:
        """Distance (R×P) from each error to the farther end of its interval.

        Array sizes: R interpretations of the reference, P poses.
        """
        if self.pairing is None:
            return self.spread
        low, high = self.bounds
        return np.maximum(self.error - low, high - self.error)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper end of each error's interval (R×P each).

        The interval covers the half-widths of all sources of uncertainty, and the errors that
        follow if modes are paired in other possible ways. Array sizes: R interpretations of the
        reference, P poses.
        """
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
        """Lowest and highest error (P each) over all interpretations, half-widths included.

        The error of a displacement vector is never below zero. The lower end is zero if the model
        lies between two interpretations. For the order of modes, the interval is that of the
        interpretation with the largest error, since there is nothing between two mode numbers.
        Array sizes: P poses.
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
        """Largest absolute value (P) in the interval of the error. NaN if an error is missing.

        Array sizes: P poses.
        """
        low, high = self.interval
        bound = np.maximum(np.abs(low), np.abs(high))
        return np.where(self.missing.any(axis=0), np.nan, bound)

    @property
    def worst(self) -> Array:
        """Error (P) of largest magnitude over all interpretations. NaN if an error is missing.

        Array sizes: P poses.
        """
        worst = self.error[self.largest, np.arange(self.error.shape[1])]
        return np.where(self.missing.any(axis=0), np.nan, worst)

    @property
    def largest(self) -> IntArray:
        """Index (P) of the interpretation with the error of largest magnitude.

        Missing errors are skipped. Array sizes: P poses.
        """
        return first_largest(np.where(self.missing, -1.0, np.abs(self.error)))


def first_largest(sizes: Array) -> IntArray:
    """Index (…) of the largest of the numbers `sizes` (n×…) along the first axis.

    If several numbers equal the largest up to round-off, it is the index of the first of them.
    """
    largest = sizes.max(axis=0)
    threshold = np.where(largest > 0.0, (1.0 - _TIE) * largest, largest)
    return np.asarray(np.argmax(sizes >= threshold, axis=0))


def verdicts_of(errors: Errors, limits: Array) -> list[Adequacy]:
    """Verdict in each pose from the interval of errors and the accepted errors `limits` (P).

    The order of modes is judged for each interpretation alone, and is undecided if the verdicts
    differ. Array sizes: P poses.
    """
    poses = range(errors.error.shape[1])
    if errors.numbers is None:
        low, high = errors.interval
        return [
            _verdict(low[p], high[p], errors.missing[:, p], errors.unknown[:, p], limits[p])
            for p in poses
        ]
    low, high = errors.bounds
    by_interpretation = [
        {
            _verdict(low[k, p], high[k, p], errors.missing[k, p], errors.unknown[k, p], limits[p])
            for k in range(len(errors.names))
        }
        for p in poses
    ]
    return [verdicts.pop() if len(verdicts) == 1 else "undecided" for verdicts in by_interpretation]


def _verdict(
    low: float,
    high: float,
    missing: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    limit: float,
) -> Adequacy:
    if missing.any():
        return "inadequate" if missing.all() and not unknown.any() else "undecided"
    if low >= -limit and high <= limit:
        return "undecided" if unknown.any() else "adequate"
    return "inadequate" if low > limit or high < -limit else "undecided"


def stack_errors(errors: Sequence[Errors]) -> Errors:
    """Combine the errors against each of R interpretations (P×…) into arrays (R×P×…).

    Array sizes: P poses.
    """
    first = errors[0]

    def columns(records: Sequence[Any]) -> dict[str, Any]:
        """Arrays by field name, in which the values of all records are stacked as rows."""
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
    """Fields of a record whose values are arrays, by name."""
    values = {field_.name: getattr(record, field_.name) for field_ in fields(record)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}
