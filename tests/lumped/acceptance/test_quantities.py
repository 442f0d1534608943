"""Quantities that are compared: names in robot files and CSV files, units and column numbers."""

import numpy as np
import pytest

from lumped.acceptance.quantities import (
    ANY_FORCE,
    AXES,
    MOST_MODES,
    ORDER,
    SIZE_FAR_BELOW,
    UNIT_LOADS,
    QuantityKind,
    load_quantities,
    measured_quantity,
    quantities,
    response_quantities,
    size_at_mode,
)

LOADS, RESPONSES = ("cutting", "f1"), ("mill", "mill.frequency", "x", "x.frequency", "x.at")
JUDGED = quantities(LOADS, RESPONSES)


def measurable():
    entries = [f"leg-1.c{i}{j}" for i in range(1, 7) for j in range(1, 7)]
    names = [*AXES, *(f"f{n}" for n in range(1, MOST_MODES + 1)), *entries]
    names += [f"response:{name}" for name in RESPONSES]
    return {name: measured_quantity(name, RESPONSES) for name in names}


def test_quantity_names_match_robot_file_keys():
    """Names of all judged quantities in display order: x, …, f1, …, load:NAME, response:NAME."""
    modes = [f"f{number}" for number in range(1, MOST_MODES + 1)]
    assert [str(quantity) for quantity in JUDGED] == [
        *("x", "y", "z", "phi_x", "phi_y", "phi_z", "any_force", "load:cutting", "load:f1"),
        *(*modes, "order", "response:mill", "response:mill.frequency", "response:x"),
        *("response:x.frequency", "response:x.at"),
    ]


def test_quantity_names_are_unique():
    """Names identify quantities in files and options."""
    assert len({quantity.name for quantity in JUDGED}) == len({*JUDGED}) == len(JUDGED)


def test_measured_quantity_name_round_trips():
    """A name in a CSV file gives the quantity of this name."""
    assert {name: quantity.name for name, quantity in measurable().items()} == {
        name: name for name in measurable()
    }


UNKNOWN = (
    *("", "w", "X", "x ", "f0", "f01", "f11", "order", "any_force", "load:cutting", ".c11"),
    *("leg1.c07", "leg1.c77", "response:", "response:nail", "response:mill.at"),
    "response:hammer.f1",
)


@pytest.mark.parametrize("name", UNKNOWN)
def test_unknown_quantity_name_gives_none(name):
    """Misspelt names, and names that stand for no measured value."""
    assert measured_quantity(name, RESPONSES) is None


def test_measured_component_is_no_vector():
    """Models are judged by whole displacement vectors; a gauge measures one component."""
    for quantity in UNIT_LOADS[:6]:
        component = measured_quantity(quantity.name)
        assert component != quantity
        assert component.name == quantity.name
        assert (component.whole, quantity.whole) == (False, True)
        assert (component.column, component.rotational) == (quantity.column, quantity.rotational)


def test_quantities_have_si_units():
    """Compliances in m/N and rad/(N m), loads in m, frequencies in Hz, measured values in m."""
    units = {quantity.name: quantity.unit for quantity in JUDGED}
    assert units["x"] == units["any_force"] == units["response:mill"] == "m/N"
    assert units["phi_z"] == "rad/(N m)"
    assert units["load:cutting"] == "m"
    assert {units[n] for n in ("f1", "order", "response:mill.frequency")} == {"Hz"}
    assert units["response:x.at"] == size_at_mode(2).unit == "m/N"
    measured = {name: quantity.unit for name, quantity in measurable().items()}
    assert (measured["z"], measured["phi_x"], measured["f2"]) == ("m", "rad", "Hz")


def test_compliance_unit_is_metre_per_newton():
    """Entries c11 to c66 of a leg: m/N, 1/N or rad/(N m), by row and column."""
    displacements, loads = (
        ("m", "m", "m", "rad", "rad", "rad"),
        ("N", "N", "N", "N m", "N m", "N m"),
    )
    # Radians are dropped where a translation is divided by a moment, and in the transpose.
    reduced_units = {"m/N": "m/N", "m/N m": "1/N", "rad/N": "1/N", "rad/N m": "rad/(N m)"}
    for i, j in np.ndindex(6, 6):
        entry = measured_quantity(f"leg.c{i + 1}{j + 1}")
        assert divmod(entry.column, 6) == (i, j)
        assert entry.leg == "leg"
        assert entry.unit == reduced_units[f"{displacements[i]}/{loads[j]}"]


def test_each_quantity_has_one_kind():
    """Each is static, modal or harmonic."""
    tests = (SIZE_FAR_BELOW, *map(size_at_mode, range(1, 4)))
    for quantity in (*JUDGED, *measurable().values(), *tests):
        assert quantity.static + quantity.modal + quantity.harmonic == 1
        assert quantity.static or not quantity.whole
        assert quantity.unit
        assert quantity.label
        assert quantity.meaning


def test_quantity_columns_are_numbered_per_kind():
    """Columns of static, load, response and frequency arrays are numbered from zero each."""
    assert [quantity.static_column for quantity in JUDGED if quantity.whole] == list(range(9))
    assert [quantity.column for quantity in load_quantities(LOADS)] == [0, 1]
    assert [quantity.column for quantity in response_quantities(RESPONSES)] == [0, 1, 2, 3, 4]
    assert [
        quantity.mode for quantity in JUDGED if quantity.kind is QuantityKind.FREQUENCY
    ] == list(range(1, 11))
    assert ORDER.mode is None
    assert ANY_FORCE.static_column == 6


def test_quantities_have_labels_and_meanings():
    """Short names in tables (φx) and their meanings in words."""
    words = {quantity.name: (quantity.label, quantity.meaning) for quantity in JUDGED}
    assert words["phi_x"] == ("φx", "rotation under a moment about x")
    assert words["load:cutting"] == ("load cutting", "displacement under the load cutting")
    assert words["any_force"] == ("any force", "displacement under any force")
    assert words["f3"] == ("f3", "natural frequency 3")
    assert words["response:mill.frequency"][1] == "frequency of the peak of the response mill"
    assert measured_quantity("rod1.c22").meaning == "c22 of the 6×6 compliance of rod1"
    assert (size_at_mode(2).label, size_at_mode(2).name) == ("response at f2", "response:hammer.f2")
    assert SIZE_FAR_BELOW.label == "response at low frequency"
