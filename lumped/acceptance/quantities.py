"""Quantities by which models are judged or measured: kind, name, unit and place among numbers.

Files and the command line contain the names. `quantities` and `measured_quantity` are the two
functions that read them. Loads and responses have their names from the robot file.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum, auto
from typing import NamedTuple

# Base axes, in the order of rows and columns of every 6×6.
AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Axis of each rotation.
ROTATIONS = {"phi_x": "x", "phi_y": "y", "phi_z": "z"}
AXIS_LABELS = {name: name.replace("phi_", "φ") for name in AXES}
MOST_MODES = 10
# Name of measured responses, which no response of a robot file may have.
TEST_RESPONSE = "hammer"
_LEG_ENTRY = re.compile(r"([\w-]{1,40})\.c([1-6])([1-6])")


class QuantityKind(StrEnum):
    """Kinds of quantities: those of verdicts up to SIZE, then those of measured values alone.

    A kind is one row of `_TEXTS`.
    """

    # Whole translation under a unit force along an axis, whole rotation under a unit moment.
    DEFLECTION = auto()
    ROTATION = auto()
    # Whole translation under the unit force of the direction in which the model is farthest off.
    ANY_FORCE = auto()
    # Whole translation under a load of the robot file.
    LOAD = auto()
    FREQUENCY = auto()
    # Order of the modes.
    ORDER = auto()
    # Height and frequency of the peak of a response, and its size at one frequency.
    PEAK = auto()
    PEAK_FREQUENCY = auto()
    SIZE = auto()
    # Signed component along an axis under a force along it, signed angle under a moment about it.
    COMPONENT = auto()
    ANGLE = auto()
    # Entry of a leg's 6×6 at its tip, root clamped.
    COMPLIANCE = auto()
    # Size of a measured response at a mode of the test, and far below all of them.
    TEST_SIZE = auto()
    LOW_SIZE = auto()


class _Texts(NamedTuple):
    """Unit, and templates of the texts of a kind of quantity."""

    unit: str
    name: str
    label: str
    meaning: str
    loading: str = ""


_KIND = QuantityKind
_BY_FORCE = "{key}", "{axis_label}", "displacement under a force along {axis}", "force along {axis}"
_BY_MOMENT = "{key}", "{axis_label}", "rotation under a moment about {axis}", "moment about {axis}"
_RESPONSE = "response:{key}"
_TEXTS = {
    _KIND.DEFLECTION: _Texts("m/N", *_BY_FORCE),
    _KIND.ROTATION: _Texts("rad/(N m)", *_BY_MOMENT),
    _KIND.ANY_FORCE: _Texts(
        *("m/N", "any_force", "any force", "displacement under any force"),
        "worst direction of force",
    ),
    _KIND.LOAD: _Texts("m", "load:{key}", "load {key}", "displacement under the load {key}"),
    _KIND.FREQUENCY: _Texts("Hz", "{key}", "{key}", "natural frequency {number}"),
    _KIND.ORDER: _Texts("Hz", "order", "order of modes", "order of modes"),
    _KIND.PEAK: _Texts(
        *("m/N", _RESPONSE, "{key} peak", "height of the peak of the response {key}")
    ),
    _KIND.PEAK_FREQUENCY: _Texts(
        *("Hz", f"{_RESPONSE}.frequency", "{key} peak frequency"),
        "frequency of the peak of the response {key}",
    ),
    _KIND.SIZE: _Texts(
        *("m/N", f"{_RESPONSE}.at", "{key} at one frequency"),
        "size at one frequency of the response {key}",
    ),
    _KIND.COMPONENT: _Texts("m", *_BY_FORCE),
    _KIND.ANGLE: _Texts("rad", *_BY_MOMENT),
    # The unit depends on the entry.
    _KIND.COMPLIANCE: _Texts("", "{key}", "{key}", "{entry} of the 6×6 of {leg}"),
    _KIND.TEST_SIZE: _Texts(
        *("m/N", f"response:{TEST_RESPONSE}.{{key}}", "response at {key}", "response at {key}")
    ),
    _KIND.LOW_SIZE: _Texts(
        *("m/N", f"response:{TEST_RESPONSE}.low"),
        *("response at low frequency", "response at low frequency"),
    ),
}
# Units of a compliance: translations, then rotations, under a force and under a moment.
_COMPLIANCE_UNITS = (("m/N", "1/N"), ("1/N", "rad/(N m)"))
_WHOLE = {_KIND.DEFLECTION, _KIND.ROTATION, _KIND.ANY_FORCE, _KIND.LOAD}
_STATIC = {*_WHOLE, _KIND.COMPONENT, _KIND.ANGLE, _KIND.COMPLIANCE}
_MODAL = {_KIND.FREQUENCY, _KIND.ORDER}
# Kinds by the ends of the names of judged numbers of a response.
_RESPONSE_KINDS = {"": _KIND.PEAK, "frequency": _KIND.PEAK_FREQUENCY, "at": _KIND.SIZE}


@dataclass(frozen=True)
class Quantity:
    """A quantity: its `kind`, `key` within the kind, and `column` among numbers of that kind.

    The key is the axis, the mode ("f2"), the leg's entry ("leg1.c22"), or the name of a load or
    response; "" for the kinds that have one quantity each. Columns count from 0: axes, loads,
    modes, judged numbers of all responses, and entries of a 6×6 row by row.
    """

    kind: QuantityKind
    key: str = ""
    column: int = 0

    def __str__(self) -> str:
        return self.name

    @property
    def name(self) -> str:
        """Name in files and on the command line."""
        return self._text(_TEXTS[self.kind].name)

    @property
    def label(self) -> str:
        """Short heading: "φx", "load cutting", "mill peak frequency"."""
        return self._text(_TEXTS[self.kind].label)

    @property
    def meaning(self) -> str:
        """Meaning in words: "rotation under a moment about x"."""
        return self._text(_TEXTS[self.kind].meaning)

    @property
    def loading(self) -> str:
        """Load along or about an axis, or of the worst direction. "" for any other quantity."""
        return self._text(_TEXTS[self.kind].loading)

    @property
    def unit(self) -> str:
        """SI unit: per unit load for deflections of verdicts, under its load for measured ones."""
        if self.kind is not _KIND.COMPLIANCE:
            return _TEXTS[self.kind].unit
        row, column = divmod(self.column, len(AXES))
        return _COMPLIANCE_UNITS[row > 2][column > 2]

    @property
    def whole(self) -> bool:
        """True for displacements compared as vectors: their errors are never negative."""
        return self.kind in _WHOLE

    @property
    def static(self) -> bool:
        """True for displacements and compliances."""
        return self.kind in _STATIC

    @property
    def harmonic(self) -> bool:
        """True for numbers of a response to a harmonic force."""
        return not self.static and not self.modal

    @property
    def modal(self) -> bool:
        """True for frequencies and their order."""
        return self.kind in _MODAL

    @property
    def rotational(self) -> bool:
        """True for rotations under a moment."""
        return self.kind in {_KIND.ROTATION, _KIND.ANGLE}

    @property
    def static_column(self) -> int:
        """Column among all whole displacements: axes, any force, loads."""
        first = {_KIND.ANY_FORCE: len(AXES), _KIND.LOAD: len(AXES) + 1}
        return first.get(self.kind, 0) + self.column

    @property
    def mode(self) -> int | None:
        """Number of the natural frequency, from 1. None for any other quantity."""
        return self.column + 1 if self.kind is _KIND.FREQUENCY else None

    @property
    def leg(self) -> str:
        """Name of the leg that an entry of a 6×6 belongs to."""
        return self.key.rpartition(".")[0]

    def _text(self, template: str) -> str:
        return template.format(
            key=self.key,
            axis=ROTATIONS.get(self.key, self.key),
            axis_label=AXIS_LABELS.get(self.key, ""),
            number=self.column + 1,
            leg=self.leg,
            entry=self.key.rpartition(".")[2],
        )


ANY_FORCE, ORDER = Quantity(_KIND.ANY_FORCE), Quantity(_KIND.ORDER)
# Whole displacements under unit loads, in the order of `static_column`.
UNIT_LOADS = (
    *(
        Quantity(_KIND.ROTATION if axis in ROTATIONS else _KIND.DEFLECTION, axis, column)
        for column, axis in enumerate(AXES)
    ),
    ANY_FORCE,
)
FREQUENCIES = tuple(
    Quantity(_KIND.FREQUENCY, f"f{column + 1}", column) for column in range(MOST_MODES)
)
_COMPONENTS = tuple(
    Quantity(_KIND.ANGLE if axis in ROTATIONS else _KIND.COMPONENT, axis, column)
    for column, axis in enumerate(AXES)
)


def load_quantities(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Displacements under the loads of a robot, by their names in its order."""
    return tuple(Quantity(_KIND.LOAD, name, column) for column, name in enumerate(names))


def response_quantities(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Judged numbers of a robot's responses, by their names ("mill.frequency") in its order."""
    parts = (name.partition(".") for name in names)
    return tuple(
        Quantity(_RESPONSE_KINDS[end], key, column) for column, (key, _, end) in enumerate(parts)
    )


def size_at_mode(number: int) -> Quantity:
    """Size of a measured response at the robot's mode of this number, from 1."""
    return Quantity(_KIND.TEST_SIZE, f"f{number}", number - 1)


SIZE_FAR_BELOW = Quantity(_KIND.LOW_SIZE)


def quantities(
    loads: Sequence[str] = (), responses: Sequence[str] = (), modes: int = MOST_MODES
) -> tuple[Quantity, ...]:
    """Quantities of verdicts in display order; `loads` and `responses` by their names."""
    return (
        *UNIT_LOADS,
        *load_quantities(loads),
        *FREQUENCIES[:modes],
        ORDER,
        *response_quantities(responses),
    )


def measured_quantity(name: str, responses: Sequence[str] = ()) -> Quantity | None:
    """Quantity of a measured value by its name. None if there is no such quantity.

    `responses` as in `quantities`.
    """
    if entry := _LEG_ENTRY.fullmatch(name):
        column = 6 * (int(entry[2]) - 1) + int(entry[3]) - 1
        return Quantity(_KIND.COMPLIANCE, name, column)
    known_quantities = (*_COMPONENTS, *FREQUENCIES, *response_quantities(responses))
    return {quantity.name: quantity for quantity in known_quantities}.get(name)
