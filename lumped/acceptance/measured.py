"""Measured values of a robot: what was measured, where, how well, and by whom.

Quantities: x y z phi_x phi_y phi_z, the deflection (m) or rotation (rad) of the loaded point under
its own force or moment; f1 f2 …, natural frequencies (Hz); leg1.c22 …, entries of a leg's 6×6
compliance at its tip, root clamped, leg axes (SI); response:NAME, response:NAME.frequency and
response:NAME.at, what is judged of a response (m/N, Hz, m/N).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.acceptance.requirement import (
    AXES,
    FREQUENCIES,
    MOST_MODES,
    RESPONSE,
    ROTATIONS,
    SMALLEST_MEASURED,
)
from lumped.arrays import Array, ComplexArray
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import fingerprint
from lumped.models.bodies import legs_of
from lumped.text import shown

_OF_LEG = re.compile(r"([\w-]{1,40})\.c([1-6])([1-6])")
# Units of translations, then of rotations, under a force and under a moment.
_OF_COMPLIANCE = (("m/N", "1/N"), ("1/N", "rad/(N m)"))
_NAMES = (
    f"{' '.join(AXES)}, f1 to f{MOST_MODES}, an entry of a leg's 6×6 like leg1.c22 or a response "
    f"like {RESPONSE}NAME"
)


def leg_entry(quantity: str) -> tuple[str, int, int] | None:
    """Leg, row and column (from 0) of "leg1.c22"; None for a quantity of the robot."""
    found = _OF_LEG.fullmatch(quantity)
    return (found[1], int(found[2]) - 1, int(found[3]) - 1) if found else None


@dataclass(frozen=True, eq=False)
class Freedoms:
    """Motions of `places` (k×3, m, axes of the `bodies`) along `directions` (k×3, base axes)."""

    bodies: tuple[str, ...]
    places: Array
    directions: Array


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """A frequency response function of a test: `receptance` (n, m/N) at `frequencies` (n, Hz).

    Of the motion of the first of two freedoms, `ends`, by a force along the second.
    """

    name: str
    ends: Freedoms
    frequencies: Array
    receptance: ComplexArray


@dataclass(frozen=True, eq=False)
class ModalTest:
    """Modes of a test in a `pose`: real `shapes` (k×m) of the freedoms `at`, `frequencies` (m, Hz).

    `ratios` (m) are their damping ratios; `responses` those that are held against models.
    """

    pose: tuple[float, ...]
    at: Freedoms
    shapes: Array
    frequencies: Array
    ratios: Array
    responses: tuple[MeasuredResponse, ...] = ()


@dataclass(frozen=True)
class Measured:
    """One measured value with its standard uncertainty (unit of the value) and its source.

    `pose` is where (empty for a leg alone), `load` the force (N) or moment (N m) of a deflection;
    of a frequency that has a shape `column` is that of the mode in its `test`. A response of the
    test has the number `response` there and a `phase` (rad); it is that at the mode, or at a
    `frequency` (Hz).
    """

    quantity: str
    value: float
    uncertainty: float
    source: str
    pose: tuple[float, ...] = ()
    load: float = 1.0
    test: ModalTest | None = None
    column: int = 0
    response: int | None = None
    phase: float = 0.0
    frequency: float | None = None

    @property
    def leg_entry(self) -> tuple[str, int, int] | None:
        """Leg, row and column (from 0) of an entry of its 6×6; None for a quantity of the robot."""
        return leg_entry(self.quantity)

    @property
    def unit(self) -> str:
        """SI unit of the value: of a deflection or rotation under its load, Hz, of a compliance."""
        if self.leg_entry is not None:
            _, row, column = self.leg_entry
            return _OF_COMPLIANCE[row > 2][column > 2]
        if self.mode is not None or (self.of_response and self.quantity.endswith(".frequency")):
            return "Hz"
        if self.of_response:
            return "m/N"
        return "rad" if self.quantity in ROTATIONS else "m"

    @property
    def of_response(self) -> bool:
        """Whether it is one of the numbers that are judged of a response."""
        return self.quantity.startswith(RESPONSE)

    @property
    def mode(self) -> int | None:
        """Number of the natural frequency, from 1; None for any other quantity."""
        return FREQUENCIES.get(self.quantity)


def measured_faults(one: Measured, place: str) -> list[str]:
    """What is wrong with a measured value, one line each, starting with its place."""
    faults = []
    known = one.quantity in AXES or one.leg_entry is not None or one.of_response
    if not known and one.mode is None:
        faults.append(f"{place}.quantity = {shown(one.quantity)}: must be one of {_NAMES}")
    elif one.leg_entry is not None and one.pose:
        faults.append(f"{place}.pose: must be left out, a leg alone has none")
    positive = _why_positive(one)
    if positive and one.value <= 0.0:
        faults.append(f"{place}.value = {one.value}: must be above 0, {positive}")
    elif abs(one.value) < SMALLEST_MEASURED:
        allowed = f"must be at least {SMALLEST_MEASURED:g} in size"
        faults.append(f"{place}.value = {one.value}: {allowed}")
    return faults


def _why_positive(one: Measured) -> str:
    """What the value is of which no elastic robot has a negative one; "" for couplings."""
    if one.of_response:
        return "the size or the frequency of a response"
    if one.leg_entry is None:
        return "a natural frequency" if one.mode else "a deflection along its load"
    _, row, column = one.leg_entry
    return "an entry on the diagonal of a compliance" if row == column else ""


def digest(ones: Sequence[Measured]) -> str:
    """Digest (hexadecimal) of measured values: equal for equal ones."""
    return fingerprint(tuple(ones))


def pose_faults(robot: Mechanism, one: Measured, place: str) -> list[str]:
    """Why this robot has no such leg, or cannot be where a value was measured; nothing else."""
    if one.leg_entry is not None:
        legs = tuple(legs_of(robot))
        known = one.leg_entry[0] in legs
        allowed = f"must be of one of {', '.join(legs) or 'no legs'}"
        return [] if known else [f"{place}.quantity = {shown(one.quantity)}: {allowed}"]
    responses = [f"{RESPONSE}{name}" for asked in robot.excitations for name in asked.judged]
    if one.of_response and one.quantity not in responses:
        allowed = f"must be one of {', '.join(responses)}" if responses else "has no [[responses]]"
        return [f"{place}.quantity = {shown(one.quantity)}: {allowed}"]
    moves = robot.tool.moves
    if len(one.pose) != len(moves):
        said = f"as many numbers as the tool's moves ({', '.join(moves) or 'none'}; m, rad)"
        return [f"{place}.pose: must hold {said}"]
    try:
        posture(robot, np.array(one.pose))
    except InputError as error:
        return [f"{place}.pose: {fault}" for fault in error.faults]
    return []
