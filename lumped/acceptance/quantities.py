"""Quantities that are judged or measured: kind, name, unit and index among results.

Robot files and the command line refer to a quantity by its name; `quantities` and
`measured_quantity` are the two functions that convert names. The names of loads and responses come
from the robot file.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum, auto
from typing import NamedTuple

# Components of a twist along and about the base axes, in the order of rows and columns of a 6×6.
AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Axis about which each rotation is measured.
ROTATIONS = {"phi_x": "x", "phi_y": "y", "phi_z": "z"}
# Units of the diagonal of a compliance.
DIAGONAL_UNITS = {name: "rad/(N m)" if name in ROTATIONS else "m/N" for name in AXES}
AXIS_LABELS = {name: name.replace("phi_", "φ") for name in AXES}
MOST_MODES = 10
# Name of the responses of a modal test. A response in a robot file must have another name.
TEST_RESPONSE = "hammer"
_LEG_ENTRY = re.compile(r"([\w-]{1,40})\.c([1-6])([1-6])")


class QuantityKind(StrEnum):
    """Kinds of quantities that are judged or measured.

    Kinds after SIZE, from COMPONENT on, occur for measured values only. `_KINDS` contains the unit,
    the name and the other properties of each kind.
    """

    # Displacement vector under a unit force along an axis; rotation vector under a unit moment.
    DEFLECTION = auto()
    ROTATION = auto()
    # Displacement vector under a unit force in the direction that gives the largest model error.
    ANY_FORCE = auto()
    # Displacement vector under a load of the robot file.
    LOAD = auto()
    FREQUENCY = auto()
    # Agreement of the sequence of modes: the k-th mode of a model is the k-th of the reference.
    ORDER = auto()
    # Magnitude and frequency of the peak of a harmonic response; its magnitude at one frequency.
    PEAK = auto()
    PEAK_FREQUENCY = auto()
    SIZE = auto()
    # Signed displacement along an axis under a force along the same axis, and signed rotation about
    # an axis under a moment about the same axis.
    COMPONENT = auto()
    ANGLE = auto()
    # Entry of the 6×6 compliance of a leg at its tip, with the root clamped.
    COMPLIANCE = auto()
    # Magnitude of a measured response at a measured natural frequency, and far below all of them.
    TEST_SIZE = auto()
    LOW_SIZE = auto()


class QuantityGroup(Enum):
    """Groups of quantities in the order in which a sentence names them.

    The value has the words that stand for all quantities of the group. `SINGLE` has none: its
    quantities are always named one by one.
    """

    DEFLECTIONS = ("deflections", "rotations")
    FREQUENCIES = ("frequencies",)
    LOADS = ("loads",)
    RESPONSES = ("responses",)
    SINGLE = ()


class Domain(Enum):
    """Solution of a model in which a quantity is found."""

    STATIC = auto()
    MODAL = auto()
    HARMONIC = auto()


class _KindRow(NamedTuple):
    """Properties of a kind of quantity, and templates for four texts about a quantity of this kind.

    The templates belong to the properties `name`, `label`, `meaning` and `loading` of `Quantity`.
    They contain placeholders such as {key} and {axis}. `loading` is "" for kinds without a unit
    load. `whole`: True for vectors that are compared as a whole, so that their errors have no sign.
    `rotational`: True for rotations under a moment. `any_direction`: True if the unit load has the
    direction that gives the largest error.
    """

    group: QuantityGroup
    domain: Domain
    unit: str
    name: str
    label: str
    meaning: str
    loading: str = ""
    whole: bool = False
    rotational: bool = False
    any_direction: bool = False


_KIND, _GROUP = QuantityKind, QuantityGroup
_BY_FORCE = "{key}", "{axis_label}", "displacement under a force along {axis}", "force along {axis}"
_BY_MOMENT = "{key}", "{axis_label}", "rotation under a moment about {axis}", "moment about {axis}"
_RESPONSE = "response:{key}"
_KINDS = {
    _KIND.DEFLECTION: _KindRow(_GROUP.DEFLECTIONS, Domain.STATIC, "m/N", *_BY_FORCE, whole=True),
    _KIND.ROTATION: _KindRow(
        _GROUP.DEFLECTIONS, Domain.STATIC, "rad/(N m)", *_BY_MOMENT, whole=True, rotational=True
    ),
    _KIND.ANY_FORCE: _KindRow(
        _GROUP.DEFLECTIONS,
        Domain.STATIC,
        "m/N",
        "any_force",
        "any force",
        "displacement under any force",
        "worst direction of force",
        whole=True,
        any_direction=True,
    ),
    _KIND.LOAD: _KindRow(
        _GROUP.LOADS,
        Domain.STATIC,
        "m",
        "load:{key}",
        "load {key}",
        "displacement under the load {key}",
        whole=True,
    ),
    _KIND.FREQUENCY: _KindRow(
        _GROUP.FREQUENCIES, Domain.MODAL, "Hz", "{key}", "{key}", "natural frequency {number}"
    ),
    _KIND.ORDER: _KindRow(
        _GROUP.SINGLE, Domain.MODAL, "Hz", "order", "order of modes", "order of modes"
    ),
    _KIND.PEAK: _KindRow(
        _GROUP.RESPONSES,
        Domain.HARMONIC,
        "m/N",
        _RESPONSE,
        "{key} peak",
        "height of the peak of the response {key}",
    ),
    _KIND.PEAK_FREQUENCY: _KindRow(
        _GROUP.RESPONSES,
        Domain.HARMONIC,
        "Hz",
        f"{_RESPONSE}.frequency",
        "{key} peak frequency",
        "frequency of the peak of the response {key}",
    ),
    _KIND.SIZE: _KindRow(
        _GROUP.RESPONSES,
        Domain.HARMONIC,
        "m/N",
        f"{_RESPONSE}.at",
        "{key} at one frequency",
        "size at one frequency of the response {key}",
    ),
    _KIND.COMPONENT: _KindRow(_GROUP.DEFLECTIONS, Domain.STATIC, "m", *_BY_FORCE),
    _KIND.ANGLE: _KindRow(_GROUP.DEFLECTIONS, Domain.STATIC, "rad", *_BY_MOMENT, rotational=True),
    # The unit depends on row and column.
    _KIND.COMPLIANCE: _KindRow(
        _GROUP.SINGLE,
        Domain.STATIC,
        "",
        "{key}",
        "{key}",
        "{entry} of the 6×6 compliance of {leg}",
    ),
    _KIND.TEST_SIZE: _KindRow(
        _GROUP.RESPONSES,
        Domain.HARMONIC,
        "m/N",
        f"response:{TEST_RESPONSE}.{{key}}",
        "response at {key}",
        "response at {key}",
    ),
    _KIND.LOW_SIZE: _KindRow(
        _GROUP.RESPONSES,
        Domain.HARMONIC,
        "m/N",
        f"response:{TEST_RESPONSE}.low",
        "response at low frequency",
        "response at low frequency",
    ),
}
# Units of the 3×3 blocks of a compliance. Rows: translation, rotation. Columns: force, moment.
_COMPLIANCE_UNITS = (("m/N", "1/N"), ("1/N", "rad/(N m)"))
# Kind of quantity for each suffix after "response:NAME".
_RESPONSE_KINDS = {"": _KIND.PEAK, "frequency": _KIND.PEAK_FREQUENCY, "at": _KIND.SIZE}


@dataclass(frozen=True)
class Quantity:
    """A quantity that models are judged by, or that is measured on the robot.

    `key` identifies the quantity within its `kind`: the axis, the mode ("f2"), the entry of a leg's
    compliance ("leg1.c22"), or the name of a load or response. It is "" if the kind has a single
    quantity. `column` is the index from 0 among the results of that kind: axes, loads, modes,
    values of responses, or the 36 entries of a leg's compliance row by row.
    """

    kind: QuantityKind
    key: str = ""
    column: int = 0

    def __str__(self) -> str:
        return self.name

    @property
    def name(self) -> str:
        """Name of the quantity in files and on the command line."""
        return self._text(_KINDS[self.kind].name)

    @property
    def label(self) -> str:
        """Short heading, such as "φx", "load cutting" or "mill peak frequency"."""
        return self._text(_KINDS[self.kind].label)

    @property
    def meaning(self) -> str:
        """Description in words, such as "rotation under a moment about x"."""
        return self._text(_KINDS[self.kind].meaning)

    @property
    def loading(self) -> str:
        """Description of the load, such as "force along x" or "worst direction of force".

        "" for quantities without a unit load.
        """
        return self._text(_KINDS[self.kind].loading)

    @property
    def unit(self) -> str:
        """SI unit of the quantity.

        A deflection under a unit load is a displacement per force (m/N) or a rotation per moment.
        A displacement under a load of the robot file, and a measured deflection, are in m or rad.
        """
        if self.kind is not _KIND.COMPLIANCE:
            return _KINDS[self.kind].unit
        row, column = divmod(self.column, len(AXES))
        return _COMPLIANCE_UNITS[row > 2][column > 2]

    @property
    def group(self) -> QuantityGroup:
        """Group of quantities for which a sentence has a common word."""
        return _KINDS[self.kind].group

    @property
    def whole(self) -> bool:
        """True for displacements that are compared as vectors. Their errors have no sign."""
        return _KINDS[self.kind].whole

    @property
    def static(self) -> bool:
        """True for static displacements and rotations, and for entries of a leg's compliance."""
        return _KINDS[self.kind].domain is Domain.STATIC

    @property
    def harmonic(self) -> bool:
        """True for a quantity of a response to a harmonic force."""
        return _KINDS[self.kind].domain is Domain.HARMONIC

    @property
    def modal(self) -> bool:
        """True for natural frequencies and for the order of the modes."""
        return _KINDS[self.kind].domain is Domain.MODAL

    @property
    def rotational(self) -> bool:
        """True for rotations under a moment."""
        return _KINDS[self.kind].rotational

    @property
    def any_direction(self) -> bool:
        """True if the unit load has the direction that gives the largest error."""
        return _KINDS[self.kind].any_direction

    @property
    def static_column(self) -> int:
        """Index of the displacement of the quantity among the displacements under all loads.

        Order: `UNIT_LOADS` (unit loads along and about the axes, then unit loads in the direction
        of the largest error), loads of the robot file.
        """
        if self.any_direction:
            return len(AXES) + self.column
        return self.column + len(UNIT_LOADS) * (self.kind is _KIND.LOAD)

    @property
    def mode(self) -> int | None:
        """Number (from 1) of the mode of a natural frequency. None for other quantities."""
        return self.column + 1 if self.kind is _KIND.FREQUENCY else None

    @property
    def leg(self) -> str:
        """Name of the leg, for a quantity that is an entry of a leg's 6×6 compliance.

        It has no meaning for other quantities.
        """
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
# Displacement vectors under unit loads, in the order of `static_column`.
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
    """One quantity for each load of a robot: the displacement of the loaded point under it.

    `names` are the names of the loads, in the order of the robot file.
    """
    return tuple(Quantity(_KIND.LOAD, name, column) for column, name in enumerate(names))


def response_quantities(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Judged values of harmonic responses, such as the peak and its frequency.

    `names` are the names of these values without the prefix "response:", such as "mill.frequency".
    """
    parts = (name.partition(".") for name in names)
    return tuple(
        Quantity(_RESPONSE_KINDS[end], key, column) for column, (key, _, end) in enumerate(parts)
    )


def size_at_mode(number: int) -> Quantity:
    """Magnitude of a measured response at the natural frequency of mode `number` (from 1)."""
    return Quantity(_KIND.TEST_SIZE, f"f{number}", number - 1)


SIZE_FAR_BELOW = Quantity(_KIND.LOW_SIZE)


def quantities(
    loads: Sequence[str] = (), responses: Sequence[str] = (), modes: int = MOST_MODES
) -> tuple[Quantity, ...]:
    """Quantities that are judged for a robot, in display order.

    `loads` and `responses` are the names of the loads and of the judged values of harmonic
    responses. `modes` is the number of natural frequencies.
    """
    return (
        *UNIT_LOADS,
        *load_quantities(loads),
        *FREQUENCIES[:modes],
        ORDER,
        *response_quantities(responses),
    )


def measured_quantity(name: str, responses: Sequence[str] = ()) -> Quantity | None:
    """Measurable quantity with the name `name`. None if there is no such quantity.

    `responses` are the names of the measurable values of harmonic responses in the robot file,
    without the prefix "response:".
    """
    if entry := _LEG_ENTRY.fullmatch(name):
        column = 6 * (int(entry[2]) - 1) + int(entry[3]) - 1
        return Quantity(_KIND.COMPLIANCE, name, column)
    known_quantities = (*_COMPONENTS, *FREQUENCIES, *response_quantities(responses))
    return {quantity.name: quantity for quantity in known_quantities}.get(name)
