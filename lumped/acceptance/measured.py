"""Measured values of a robot: quantity, pose, value, uncertainty and source.

Quantities: x y z phi_x phi_y phi_z, the signed deflection (m) or rotation (rad) of the loaded point
under its own force or moment; f1 f2 …, natural frequencies (Hz); leg1.c22 …, entries of a leg's 6×6
compliance at its tip, root clamped, leg axes (SI); response:NAME, response:NAME.frequency and
response:NAME.at, the judged numbers of a response (m/N, Hz, m/N).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lumped.acceptance.quantities import (
    AXES,
    MOST_MODES,
    Quantity,
    QuantityKind,
    measured_quantity,
    response_quantities,
)
from lumped.acceptance.requirement import SMALLEST_MEASURED
from lumped.arrays import Array, ComplexArray
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import fingerprint
from lumped.models.bodies import legs_of
from lumped.text import shown


@dataclass(frozen=True, eq=False)
class Freedoms:
    """Motions of `places` (k×3, m, axes of the `bodies`) along `directions` (k×3, base axes)."""

    bodies: tuple[str, ...]
    places: Array
    directions: Array


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """A frequency response function of a test: `receptance` (n, m/N) at `frequencies` (n, Hz).

    Displacement along the first of two freedoms, `ends`, per force along the second.
    """

    name: str
    ends: Freedoms
    frequencies: Array
    receptance: ComplexArray


@dataclass(frozen=True, eq=False)
class ModalTest:
    """Modes of a test in a `pose`: real `shapes` (k×m) of the freedoms `at`, `frequencies` (m, Hz).

    `ratios` (m) are their damping ratios; `responses` those that are compared with models.
    """

    pose: tuple[float, ...]
    at: Freedoms
    shapes: Array
    frequencies: Array
    ratios: Array
    responses: tuple[MeasuredResponse, ...] = ()


@dataclass(frozen=True)
class Measured:
    """A measured value with its standard uncertainty, in the unit of the quantity, and source.

    `pose` is the pose of the robot (empty for a single leg), `load` the force (N) or moment (N m)
    of a deflection. A frequency with a mode shape is that of the mode `column` of its `test`. A
    response of the test has the number `response` in it and a `phase` (rad). It is measured at the
    frequency of the mode, or at `frequency` (Hz).
    """

    quantity: Quantity
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
    def of_leg(self) -> bool:
        """True for an entry of a leg's 6×6, which has no pose."""
        return self.quantity.kind is QuantityKind.COMPLIANCE


def measured_value(table: Mapping[str, Any], place: str, responses: Sequence[str] = ()) -> Measured:
    """Measured value of a table with valid keys; `place` is its location in messages.

    `responses` are the names of the robot's judged numbers of responses. Raises InputError with one
    line per fault.
    """
    name = table["quantity"]
    if (quantity := measured_quantity(name, responses)) is None:
        raise InputError(f"{place}.quantity = {shown(name)}: must be one of {_names(responses)}")
    value = Measured(**{**table, "quantity": quantity})
    if faults := _value_faults(value, place):
        raise InputError(faults)
    return value


def _names(responses: Sequence[str]) -> str:
    """Names of all quantities that can be measured of a robot."""
    names = ", ".join(
        (
            *(quantity.name for quantity in response_quantities(responses)),
            " ".join(AXES),
            f"f1 to f{MOST_MODES} or an entry of a leg's 6×6 like leg1.c22",
        )
    )
    return names if responses else f"{names} (responses need [[responses]])"


def _value_faults(measured: Measured, place: str) -> list[str]:
    """Faults of a measured value by itself, one line each, starting with its place."""
    faults = []
    if measured.of_leg and measured.pose:
        faults.append(f"{place}.pose: must be left out, a leg alone has none")
    positive = _why_positive(measured.quantity)
    if positive and measured.value <= 0.0:
        faults.append(f"{place}.value = {measured.value}: must be above 0, {positive}")
    elif abs(measured.value) < SMALLEST_MEASURED:
        allowed = f"must be at least {SMALLEST_MEASURED:g} in size"
        faults.append(f"{place}.value = {measured.value}: {allowed}")
    return faults


def _why_positive(quantity: Quantity) -> str:
    """Reason why no elastic robot has a negative value of a quantity. "" for couplings."""
    if quantity.harmonic:
        return "the size or the frequency of a response"
    if quantity.mode is not None:
        return "a natural frequency"
    if quantity.kind is not QuantityKind.COMPLIANCE:
        return "a deflection along its load"
    row, column = divmod(quantity.column, len(AXES))
    return "an entry on the diagonal of a compliance" if row == column else ""


def digest(values: Sequence[Measured]) -> str:
    """Digest (hexadecimal) of measured values: equal for equal ones."""
    return fingerprint(tuple(values))


def pose_faults(robot: Mechanism, measured: Measured, place: str) -> list[str]:
    """Reasons why the robot has no such leg, or cannot be in the pose of a measured value."""
    if measured.of_leg:
        legs = tuple(legs_of(robot))
        is_leg = measured.quantity.leg in legs
        allowed = f"must be of one of {', '.join(legs) or 'no legs'}"
        return [] if is_leg else [f"{place}.quantity = {shown(measured.quantity.name)}: {allowed}"]
    return place_faults(robot, measured.pose, place)


def place_faults(robot: Mechanism, pose: Sequence[float], place: str) -> list[str]:
    """Reasons why the robot cannot be in a pose, one line each."""
    moves = robot.tool.moves
    if len(pose) != len(moves):
        required = f"as many numbers as the tool's moves ({', '.join(moves) or 'none'}; m, rad)"
        return [f"{place}.pose: must hold {required}"]
    try:
        posture(robot, np.array(pose))
    except InputError as error:
        return [f"{place}.pose: {fault}" for fault in error.faults]
    return []
