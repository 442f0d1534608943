"""Total relative errors of a model against every alternative of the reference, pose by pose."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.requirement import FREQUENCIES, ORDER, STATIC_QUANTITIES
from lumped.arrays import Array
from validation.adequacy.partners import Partners, partners
from validation.adequacy.response import Alternative, Reference, Response, Subject

# Of the largest value over the poses: below it the reference itself is rigid.
_NOTHING = 1e-12


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity: a alternatives of the reference by p poses.

    `value` and `expected` in the quantity's unit, `error` = value/expected − 1 and its numerical
    uncertainty `numerical`; `missing` where the model has nothing that could be compared.
    """

    value: Array
    expected: Array
    error: Array
    numerical: Array
    missing: NDArray[np.bool_]

    @property
    def interval(self) -> tuple[Array, Array]:
        """Lowest and highest error (p each) that alternatives and uncertainties leave open."""
        low = np.min(self.error - self.numerical, axis=0)
        high = np.max(self.error + self.numerical, axis=0)
        return low, high


@dataclass(frozen=True, eq=False)
class Scale:
    """A robot's references, against which any response is measured, pairings kept.

    `modes` is the number of frequencies that are judged.
    """

    subject: Subject
    modes: int
    _pairs: dict[tuple[int, str], Partners] = field(default_factory=dict, repr=False)

    def reference(self, quantity: str) -> Reference:
        """The reference of a quantity."""
        static = quantity in STATIC_QUANTITIES
        return self.subject.statics if static else self.subject.dynamics

    def errors(self, responses: Sequence[Response], quantity: str) -> Errors | None:
        """Errors of a quantity; `responses` one per alternative of its reference.

        None where a response says nothing of it.
        """
        alternatives = self.reference(quantity).alternatives
        pairs = list(zip(alternatives, responses, strict=True))
        if quantity in STATIC_QUANTITIES:
            index = STATIC_QUANTITIES.index(quantity)
            rows = [_static(one, response, index) for one, response in pairs]
        elif quantity == ORDER:
            rows = [self._order(one, response) for one, response in pairs]
        else:
            rows = [
                self._frequency(one, response, FREQUENCIES[quantity] - 1) for one, response in pairs
            ]
        known = [row for row in rows if row is not None]
        if len(known) < len(rows) or not rows:
            return None
        value, expected, numerical = (np.array(column) for column in zip(*known, strict=True))
        missing = ~np.isfinite(value)
        error = np.where(missing, np.nan, value / expected - 1.0)
        return Errors(value, expected, error, numerical * np.abs(value / expected), missing)

    def _partners(self, one: Alternative, response: Response) -> Partners | None:
        if one.response.vibration is None or response.vibration is None:
            return None
        key = id(response), one.name
        if key not in self._pairs:
            self._pairs[key] = partners(
                one.response.vibration, response.vibration, self.subject.weights, self.modes
            )
        return self._pairs[key]

    def _frequency(
        self, one: Alternative, response: Response, mode: int
    ) -> tuple[Array, Array, Array] | None:
        found = self._partners(one, response)
        if found is None or one.response.vibration is None:
            return None
        expected = one.response.vibration.frequencies[:, mode]
        return found.frequency[:, mode], expected, _column(one.dynamic, mode, len(expected))

    def _order(self, one: Alternative, response: Response) -> tuple[Array, Array, Array] | None:
        """The mode, among those in another place, whose number misleads most about frequency."""
        found = self._partners(one, response)
        if found is None or one.response.vibration is None:
            return None
        own = one.response.vibration.frequencies[:, : self.modes]
        moved = found.number != np.arange(self.modes)
        error = np.where(moved, np.abs(found.by_number / own - 1.0), 0.0)
        # A mode in its place says nothing wrong of the order, a number that does not exist does.
        worst = np.argmax(np.where(np.isnan(error), np.inf, error), axis=1)
        at = np.arange(len(own)), worst
        value = np.where(moved[at], found.by_number[at], own[at])
        numerical = np.array([_column(one.dynamic, mode, len(own)) for mode in range(self.modes)])
        return value, own[at], np.where(moved[at], numerical[worst, at[0]], 0.0)


def _static(one: Alternative, response: Response, index: int) -> tuple[Array, Array, Array] | None:
    if one.response.compliance is None or response.compliance is None:
        return None
    expected = one.response.compliance[:, index, index]
    value = response.compliance[:, index, index]
    largest = float(np.abs(expected).max())
    # Where the reference does not yield at all, a model that does not either is right.
    rigid = np.abs(expected) <= _NOTHING * largest
    value = np.where(rigid & (np.abs(value) <= _NOTHING * largest), expected, value)
    return value, expected, _column(one.static, index, len(expected))


def _column(uncertainty: Array | None, index: int, count: int) -> Array:
    return np.zeros(count) if uncertainty is None else uncertainty[:, index]
