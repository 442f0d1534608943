"""Units of work of a sweep: one leg reduced to its ends, and one robot in some postures.

A leg only turns from posture to posture. So each leg of each model is condensed once, as a unit
of its own; what is left of it is small, and a posture then costs a few hundred microseconds.
Units and what they yield are plain data that can be sent to other processes and machines.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import floor, log10

import numpy as np

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import HeldLeg, held_leg
from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide, postures
from lumped.caches import lru_cache
from lumped.dense.modes import dense
from lumped.errors import ComputationError, InputError, each
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.body_model import ENDS, BodyModel
from lumped.system.assembly import assembly
from lumped.system.sweep import Swept, swept
from validation.models.biglide import robot_compliance, robot_frequencies, robot_legs
from validation.models.legs import filled, leg_matrices
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.solids.robots import held_solid, renewed_where_needed

# Few segments are some percent off, and frequencies between the postures may be higher.
_MARGIN = 1.5
_ESTIMATE_ELEMENTS = 4
_ESTIMATE_POSTURES = 3
_WITH_LEGS = ("segments", "beam", "solid")


@dataclass(frozen=True)
class ReducedLeg:
    """A leg on r unknowns: both ends (12) and modal amplitudes; `stiffness`, `mass` r×r, SI."""

    length: float
    stiffness: Array
    mass: Array

    def model(self) -> BodyModel:
        """The leg as whoever assembles the robot takes it, without its field of displacement."""
        return BodyModel("reduced", ENDS, self.stiffness, self.mass, _no_field)


@dataclass(frozen=True)
class SolvedPostures:
    """What a unit of m postures yields.

    `compliances` (m×6×6, or m×2×2 for `simplified`; SI, robot axes) at the loaded point and
    `frequencies` (m×k, Hz; none for `vjm`).
    """

    compliances: Array
    frequencies: Array


@dataclass(frozen=True)
class LegUnit:
    """One leg by `segments`, `beam` or `solid`, to be reduced to its ends.

    Right for frequencies up to `highest` (Hz); `cutoff` (Hz) of the modes that are kept, None for
    the reduction's own choice.
    """

    model: ModelName
    leg: ConstantLeg
    options: ModelOptions
    highest: float
    cutoff: float | None = None

    def compute(self) -> ReducedLeg:
        """Condense the leg: for a solid this is the work of the sweep."""
        reduced = craig_bampton(self._held(), self.highest, self.cutoff).matrices
        return ReducedLeg(self.leg.length, dense(reduced.stiffness), dense(reduced.mass))

    def _held(self) -> HeldLeg:
        if self.model != "solid":
            return held_leg(leg_matrices(self.model, self.leg, self.options))
        return held_solid(self.leg, self.options.divisions, self.options.ends)


@dataclass(frozen=True)
class PostureUnit:
    """One robot by one model with B at each of `x` (m): compliance and first frequencies.

    `legs` are those that `compute` needs reduced, none for `simplified` and `vjm`.
    """

    model: ModelName
    robot: Biglide
    options: ModelOptions
    x: tuple[float, ...]
    frequencies: int
    legs: tuple[LegUnit, ...]

    def compute(self, legs: tuple[ReducedLeg, ...]) -> SolvedPostures:
        """Solve the postures one after the other.

        Legs that were reduced for lower frequencies than the robot has are reduced again for its
        own. Raises InputError for a cut-off that is not above these.
        """
        if not self.legs:
            return self._lumped()
        planned = min(leg.highest for leg in self.legs)

        def solved(highest: float) -> SolvedPostures:
            return self._solved(
                legs
                if highest == planned
                else tuple(_renewed(replace(leg, highest=highest)) for leg in self.legs)
            )

        return renewed_where_needed(planned, solved, lambda found: found.frequencies)

    def _solved(self, legs: tuple[ReducedLeg, ...]) -> SolvedPostures:
        found = _swept(self.robot, [leg.model() for leg in legs], self.x, self.frequencies)
        return SolvedPostures(found.compliances, found.frequencies)

    def _lumped(self) -> SolvedPostures:
        model, robot, options = self.model, self.robot, self.options
        frequencies = np.empty((len(self.x), 0))
        if model == "simplified":
            frequencies = np.array(
                [robot_frequencies(model, robot, x, self.frequencies, options) for x in self.x]
            )
        compliances = [robot_compliance(model, robot, x, options) for x in self.x]
        return SolvedPostures(np.array(compliances), frequencies)


@lru_cache(maxsize=4)
def _renewed(unit: LegUnit) -> ReducedLeg:
    """Units of one robot come one after the other: each leg is reduced again once."""
    return unit.compute()


def posture_unit(
    model: ModelName,
    robot: Biglide,
    x: tuple[float, ...],
    frequencies: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    highest: float | None = None,
    cutoff: float | None = None,
) -> PostureUnit:
    """A unit with the legs it needs; `highest` None takes it from a coarse beam model.

    `robot` may have legs of any kind: other models than `vjm` take the equivalent ones. Raises
    InputError, naming all of them, for postures outside the stroke, for fewer than one frequency,
    and for the printed release, whose legs cannot be reduced to two ends.
    """
    _, faults = each(robot.posture, x)
    if frequencies < 1:
        faults.append(f"frequencies = {frequencies}: at least 1")
    if options.release == "printed":
        faults.append("release = printed: sweeps know the condensed release alone")
    if faults:
        raise InputError(faults)
    legs: tuple[LegUnit, ...] = ()
    if model in _WITH_LEGS:
        allowed = expected_highest(robot, frequencies, options) if highest is None else highest
        constant = (equivalent_leg(leg, options.equivalent) for leg in (robot.leg1, robot.leg2))
        legs = tuple(LegUnit(model, leg, options, allowed, cutoff) for leg in constant)
    return PostureUnit(model, robot, options, x, frequencies, legs)


def chunks(unit: PostureUnit, size: int) -> tuple[PostureUnit, ...]:
    """The unit cut into units of at most `size` postures, in order, with the same legs."""
    starts = range(0, len(unit.x), size)
    return tuple(replace(unit, x=unit.x[start : start + size]) for start in starts)


def expected_highest(robot: Biglide, count: int, options: ModelOptions = DEFAULT_OPTIONS) -> float:
    """Upper estimate (Hz, two digits) of frequency `count` over the stroke, few segments."""
    coarse = ModelOptions(elements=max(_ESTIMATE_ELEMENTS, count), equivalent=options.equivalent)
    legs = [filled(leg) for leg in robot_legs("segments", robot, coarse)]
    found = _swept(robot, legs, robot.stations(_ESTIMATE_POSTURES), count)
    estimate = _MARGIN * float(found.frequencies[:, -1].max())
    digit = 10.0 ** (floor(log10(estimate)) - 1)
    # Rounded, so that a last bit that differs between machines makes no other unit of it.
    return float(np.ceil(estimate / digit) * digit)


def _swept(
    robot: Biglide, legs: Sequence[BodyModel], positions: Iterable[float], count: int
) -> Swept:
    places = postures(robot, positions)
    bodies = dict(zip(("leg1", "leg2"), legs, strict=True))
    return swept(assembly(places[0].mechanism, bodies), places, count)


def _no_field(points: Array) -> SparseMatrix:
    raise ComputationError(f"a swept leg keeps no displacements ({len(points)} asked for)")
