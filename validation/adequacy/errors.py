"""Total relative errors of a model against every alternative of the reference, pose by pose."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.requirement import ANY_FORCE, FREQUENCIES, ORDER, STATIC_QUANTITIES
from lumped.arrays import Array, IntArray
from validation.adequacy.partners import Partners, partners
from validation.adequacy.response import Alternative, Reference, Response, Subject
from validation.agreement.displacement import displacement, relative


@dataclass(frozen=True, eq=False)
class Loaded:
    """What belongs to errors of deflections: a alternatives of the reference by p poses.

    `load` (a×p×6) is the unit wrench, of any force the worst one; `along` (a×p) the signed error of
    the displacement along it. `off` (a×p×3) is the difference of displacements, relative to
    `length` (a×p, m/N or rad/(N m), of the reference's).
    """

    load: Array
    along: Array
    off: Array
    length: Array


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one quantity: a alternatives of the reference, by their `names`, by p poses.

    Frequencies: `value` and `expected` in Hz, `error` = value/expected − 1. Deflections: `value`
    and `expected` along the load, `error` of the whole displacement, never negative, and what
    belongs to it in `loaded`. `numerical` is what meshes leave open of the error, `digits` what the
    printed digits of the robot's 6×6 do; `missing` where
    model and reference have nothing that could be compared. `numbers` (a×p×m, of the order alone):
    which mode of the model, from 0, has the shape of each of the reference's; −1: none has.
    """

    names: tuple[str, ...]
    value: Array
    expected: Array
    error: Array
    numerical: Array
    digits: Array
    missing: NDArray[np.bool_]
    loaded: Loaded | None = None
    numbers: IntArray | None = None

    @property
    def spread(self) -> Array:
        """What meshes and digits leave open of each error (a×p)."""
        return self.numerical + self.digits

    @property
    def interval(self) -> tuple[Array, Array]:
        """Lowest and highest error (p each) that alternatives and uncertainties leave open.

        Of the order that of the alternative by which it misleads most: between a mode in its place
        and one in another there is nothing.
        """
        low, high = self.error - self.spread, self.error + self.spread
        if self.numbers is not None:
            at = self.largest, np.arange(self.error.shape[1])
            return low[at], high[at]
        low, high = low.min(axis=0), high.max(axis=0)
        return (low if self.loaded is None else np.maximum(low, 0.0)), high

    @property
    def middle(self) -> Array:
        """The error (p) in the middle of what is left open."""
        low, high = self.interval
        return np.asarray(0.5 * (low + high))

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
            return _of_deflections(pairs, quantity)
        numbers = None
        if quantity == ORDER:
            found = [self._partners(one, response) for one, response in pairs]
            numbers = np.array([one.number for one in found if one is not None])
            rows = [self._order(one, response) for one, response in pairs]
        else:
            rows = [
                self._frequency(one, response, FREQUENCIES[quantity] - 1) for one, response in pairs
            ]
        known = [row for row in rows if row is not None]
        if len(known) < len(rows) or not rows:
            return None
        value, expected, *left = (np.array(column) for column in zip(*known, strict=True))
        missing = ~np.isfinite(value)
        error = np.where(missing, np.nan, value / expected - 1.0)
        numerical, digits = (share * np.abs(value / expected) for share in left)
        names = tuple(one.name for one in alternatives)
        return Errors(names, value, expected, error, numerical, digits, missing, numbers=numbers)

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
    ) -> tuple[Array, ...] | None:
        found = self._partners(one, response)
        if found is None or one.response.vibration is None:
            return None
        expected = one.response.vibration.frequencies[:, mode]
        left = (
            _column(stated, mode, len(expected)) for stated in (one.dynamic, one.dynamic_digits)
        )
        return found.frequency[:, mode], expected, *left

    def _order(self, one: Alternative, response: Response) -> tuple[Array, ...] | None:
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
        left = (
            np.zeros(len(own)) if stated is None else np.where(moved[at], stated[at], 0.0)
            for stated in (one.dynamic, one.dynamic_digits)
        )
        return value, own[at], *left


def _of_deflections(pairs: Sequence[tuple[Alternative, Response]], quantity: str) -> Errors | None:
    rows = [_deflection(one, response, quantity) for one, response in pairs]
    known = [row for row in rows if row is not None]
    if len(known) < len(rows) or not rows:
        return None
    value, expected, error, numerical, digits, *loaded = (
        np.array(column) for column in zip(*known, strict=True)
    )
    missing = np.isinf(error)
    error = np.where(missing, np.nan, error)
    names = tuple(one.name for one, _ in pairs)
    return Errors(names, value, expected, error, numerical, digits, missing, Loaded(*loaded))


def _deflection(one: Alternative, response: Response, quantity: str) -> tuple[Array, ...] | None:
    """Value, expected, error, numerical, digits, and the fields of `Loaded`, for every pose."""
    reference, compliance = one.response.compliance, response.compliance
    if reference is None or compliance is None:
        return None
    size, along, load, length = relative(compliance - reference, reference, quantity)
    moved, due = (displacement(c, load, quantity) for c in (compliance, reference))
    direction = displacement(np.eye(6), load, quantity)
    value, expected = (np.einsum("pi,pi->p", direction, u) for u in (moved, due))
    off = np.divide(moved - due, length[:, None], out=np.zeros_like(due), where=length[:, None] > 0)
    # What changes the reference by a part of its length changes the error by no more than that part
    # of the model's displacement; under any force by no more than that part of 1 + error.
    reach = 1.0 + size
    if quantity != ANY_FORCE:
        reach = np.linalg.norm(off + due / np.where(length > 0, length, np.inf)[:, None], axis=1)
    column = STATIC_QUANTITIES.index(quantity)
    numerical, digits = (
        np.multiply(
            _column(stated, column, len(size)), reach, out=np.zeros_like(size), where=length > 0
        )
        for stated in (one.static, one.digits)
    )
    return value, expected, size, numerical, digits, load, along, off, length


def _column(uncertainty: Array | None, index: int, count: int) -> Array:
    return np.zeros(count) if uncertainty is None else uncertainty[:, index]
