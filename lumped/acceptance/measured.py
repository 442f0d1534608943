"""Measured values of a robot: quantity, pose, value, uncertainty and source.

Names of the quantities and the units of their values:

- x y z phi_x phi_y phi_z: signed deflection (m) or rotation (rad) of the loaded point along or
  about a base axis, under a force along or a moment about the same axis;
- f1 f2 …: natural frequencies (Hz);
- leg1.c22 …: entries of the 6×6 tip compliance (SI, leg axes) of a leg with the root clamped;
- response:NAME, response:NAME.frequency, response:NAME.at: height of the peak of a harmonic
  response (m/N), frequency of the peak (Hz), and magnitude at one frequency (m/N).
"""

from collections.abc import Sequence
from dataclasses import dataclass

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
    """Measured motions: displacements of points of the robot along given directions.

    Motion i is that of the point `places[i]` (m, in the axes of the body `bodies[i]`) along the
    unit vector `directions[i]` (base axes).
    """

    bodies: tuple[str, ...]
    places: Array
    directions: Array


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """Measured frequency response function: complex displacement per harmonic force.

    `receptance` contains n values (m/N), one for each of the n `frequencies` (Hz). `ends` are two
    motions: the displacement is measured along the first, the force acts along the second.
    """

    name: str
    ends: Freedoms
    frequencies: Array
    receptance: ComplexArray


@dataclass(frozen=True, eq=False)
class ModalTest:
    """Modes measured in a modal test of the robot in the pose `pose`.

    Column j of `shapes` (k×m, real) is the shape of mode j at the k motions `at`. `frequencies`
    (Hz) and damping `ratios` have one value for each of the m modes. `responses` are the measured
    frequency response functions with which models are compared.
    """

    pose: tuple[float, ...]
    at: Freedoms
    shapes: Array
    frequencies: Array
    ratios: Array
    responses: tuple[MeasuredResponse, ...] = ()


@dataclass(frozen=True)
class Measured:
    """A measured value with its standard uncertainty and source, in the unit of the quantity.

    `pose` is the pose of the robot (empty for a single leg). `load` is the force (N) or moment (N
    m) under which a deflection was measured. The other fields are set only for values of a modal
    `test`. `column` is the index of the mode to which the value belongs. For a value of a frequency
    response, `response` is its index in the test, `phase` its phase (rad) and `frequency` its
    frequency (Hz). A `frequency` of None stands for the natural frequency of the mode.
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
        """True for an entry of the 6×6 compliance of a single leg, which has no pose."""
        return self.quantity.kind is QuantityKind.COMPLIANCE


def measured_value(
    name: str,
    place: str,
    responses: Sequence[str] = (),
    *,
    value: float,
    uncertainty: float,
    source: str,
    pose: tuple[float, ...] = (),
    load: float = 1.0,
) -> Measured:
    """Measured value of the quantity `name`, with the fields of `Measured`.

    `place` is the location of the value in the robot file or CSV file, for messages. `responses`
    are the names of all measurable values of harmonic responses in the robot file, without the
    prefix "response:". Raises InputError with one line per fault.
    """
    if (quantity := measured_quantity(name, responses)) is None:
        raise InputError(f"{place}.quantity = {shown(name)}: must be one of {_names(responses)}")
    measured = Measured(quantity, value, uncertainty, source, pose, load)
    if faults := _value_faults(measured, place):
        raise InputError(faults)
    return measured


def _names(responses: Sequence[str]) -> str:
    """Comma-separated names of all measurable quantities of a robot, for messages.

    `responses` are the names of the measurable values of harmonic responses in the robot file,
    without the prefix "response:".
    """
    names = ", ".join(
        (
            *(quantity.name for quantity in response_quantities(responses)),
            " ".join(AXES),
            f"f1 to f{MOST_MODES} or an entry of a leg's 6×6 compliance like leg1.c22",
        )
    )
    return names if responses else f"{names} (responses need [[responses]])"


def _value_faults(measured: Measured, place: str) -> list[str]:
    """Faults of a measured value that do not depend on the robot, one line each.

    Each line begins with `place`, the location of the value.
    """
    faults = []
    if measured.of_leg and measured.pose:
        faults.append(f"{place}.pose: must be left out, because a single leg has no pose")
    positive = _why_positive(measured.quantity)
    if positive and measured.value <= 0.0:
        faults.append(f"{place}.value = {measured.value}: must be above 0, {positive}")
    elif abs(measured.value) < SMALLEST_MEASURED:
        allowed = f"must be at least {SMALLEST_MEASURED:g} in size"
        faults.append(f"{place}.value = {measured.value}: {allowed}")
    return faults


def _why_positive(quantity: Quantity) -> str:
    """Reason, for messages, why a measured value of the quantity must be positive.

    "" if the value may be negative. Only off-diagonal entries of a compliance may.
    """
    if quantity.harmonic:
        return "the size or the frequency of a response"
    if quantity.mode is not None:
        return "a natural frequency"
    if quantity.kind is not QuantityKind.COMPLIANCE:
        return "a deflection along its load"
    row, column = divmod(quantity.column, len(AXES))
    return "an entry on the diagonal of a compliance" if row == column else ""


def digest(values: Sequence[Measured]) -> str:
    """Hexadecimal digest of measured values. Equal values have equal digests."""
    return fingerprint(tuple(values))


def pose_faults(robot: Mechanism, measured: Measured, place: str) -> list[str]:
    """Faults of a measured value that depend on the robot: unknown leg, pose out of reach.

    One line per fault, which begins with `place`, the location of the value.
    """
    if measured.of_leg:
        legs = tuple(legs_of(robot))
        is_leg = measured.quantity.leg in legs
        allowed = f"must be of one of {', '.join(legs) or 'no legs'}"
        return [] if is_leg else [f"{place}.quantity = {shown(measured.quantity.name)}: {allowed}"]
    return place_faults(robot, measured.pose, place)


def place_faults(robot: Mechanism, pose: Sequence[float], place: str) -> list[str]:
    """Reasons why the robot cannot take the pose `pose`, one line each, beginning with `place`."""
    moves = robot.tool.moves
    if len(pose) != len(moves):
        required = f"as many numbers as the tool's moves ({', '.join(moves) or 'none'}; m, rad)"
        return [f"{place}.pose: must be {required}"]
    try:
        posture(robot, np.array(pose))
    except InputError as error:
        return [f"{place}.pose: {fault}" for fault in error.faults]
    return []
