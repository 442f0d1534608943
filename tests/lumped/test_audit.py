"""Every misprint of the data is found with its number, every check is silent on sound data."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.audit import DescribedPart, audit, data_findings, parts
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.robot_file import as_printed, load_robot
from lumped.sections import Rectangle

IFW = load_robot("ifw")
# The paper's data, from an independent computation, to half a unit of the digits that it gave.
# By place and check: severity and numbers.
PRINTED = {
    ("foot.compliance", "definiteness"): (
        "error",
        {"smallest eigenvalue": pytest.approx(-3.5e-8, abs=0.05e-8)},
    ),
    ("tool.compliance", "symmetry"): ("error", {"difference": pytest.approx(1.94e-10, rel=1e-9)}),
    ("leg1.inertia", "triangle inequality"): (
        "error",
        {
            f"moment {i}": pytest.approx(J, abs=5e-4)
            for i, J in enumerate((0.324, 2.543, 3.988), start=1)
        },
    ),
    # The printed diagonal 6.122, 5.848, 0.635 bounds the smallest moment from above.
    ("leg2.inertia", "slender axis"): (
        "warning",
        {"smallest moment": pytest.approx(0.3175, abs=0.3175), "about x": pytest.approx(6.122)},
    ),
    # Cantilever: 3 · 1.77e-7 / (2 · 0.85) and 3 · 3.19e-8 / (2 · 0.85), by hand.
    ("leg1.compliance", "couplings"): (
        "warning",
        {
            "c26": -2.90e-7,
            "c35": -9.94e-8,
            "c26 of a beam": pytest.approx(3.1235e-7, abs=3e-11),
            "c35 of a beam": pytest.approx(-5.629e-8, abs=5e-11),
        },
    ),
    ("leg2.compliance", "couplings"): ("warning", {"c26": -2.12e-8, "c35": -2.38e-10}),
    # 7.22e-7 · 0.775² / (3 · 1.07e-9), by hand.
    ("leg2.compliance", "tip rotation c55"): ("note", {"ratio": pytest.approx(135.1, abs=0.05)}),
}
# Words of what is used in place of errors; all else is used as it is printed.
USED = {
    "foot.compliance": "foot.compliance[6,6] = 3.16e-07 in place of 3.16e-09",
    "tool.compliance": "tool.compliance[2,1] = -9.7e-11",
    "leg1.inertia": "-0.094",
}


def test_misprints_are_reported_with_numbers():
    found = {(one.where, one.check): one for one in audit(IFW)}
    assert found.keys() == PRINTED.keys()
    for key, (severity, numbers) in PRINTED.items():
        assert found[key].severity == severity, key
        assert USED.get(key[0], "as printed") in found[key].used, key
        assert numbers.items() <= dict(found[key].numbers).items(), key
    assert found["tool.compliance", "symmetry"].printed == "(2,1) = 9.7e-11, (1,2) = -9.7e-11"
    assert "smallest moment of inertia about z" in found["leg2.inertia", "slender axis"].wrong
    assert {one.used for one in audit(replace(IFW, corrections=()))} == {"as given"}


def test_corrections_remove_all_data_errors():
    for tables, count in ((as_printed(IFW), 3), (IFW.tables, 0)):
        severities = [one.severity for part in parts(tables) for one in data_findings(part)]
        assert severities.count("error") == count


def checks(name, **data):
    """The checks of which a part's data have findings."""
    return [finding.check for finding in data_findings(DescribedPart(name, **data))]


def with_entries(matrix, **entries):
    """The symmetric matrix with entries, "c26" say, times a factor."""
    changed = matrix.copy()
    for name, factor in entries.items():
        i, j = int(name[1]) - 1, int(name[2]) - 1
        changed[i, j] = changed[j, i] = factor * matrix[i, j]
    return changed


@pytest.mark.parametrize(
    ("length", "width", "height", "nu"),
    [(0.8, 0.2, 0.02, 0.0), (1.3, 0.1, 0.16, 0.3), (2.0, 0.02, 0.2, 0.45)],
)
def test_wrong_coupling_or_rotation_is_found(length, width, height, nu):
    leg = ConstantLeg(length, Rectangle(width, height), Material.isotropic(2e11, nu, 7850.0))
    beam = tip_compliance(leg.timoshenko, length)
    inertia = np.diag([0.01, 1.0, 1.0]) * leg.mass * length**2 / 12.0
    assert checks("leg1", compliance=beam, inertia=inertia, length=length, mass_centre=0.4) == []
    # A foot may look either way, but not both; a tool has no arm.
    assert checks("foot", compliance=with_entries(beam, c26=-1.0, c35=-1.0)) == []
    for one in ("c26", "c35"):
        wrong = with_entries(beam, **{one: -1.0})
        assert checks("leg1", compliance=wrong, length=length) == ["couplings"]
        assert checks("foot", compliance=wrong) == ["couplings"]
        assert checks("tool", compliance=wrong) == []
    for one in ("c55", "c66"):
        # At least 0.9 of a beam's rotation remains after shear at these slendernesses.
        turning = with_entries(beam, **{one: 20.0})
        assert checks("leg1", compliance=turning, length=length) == [f"tip rotation {one}"]


@pytest.mark.parametrize(
    ("data", "found"),
    [
        ({"inertia": np.diag([1.0, 3.0, 1.9])}, ["triangle inequality"]),
        ({"inertia": np.diag([1.0, 2.8, 1.9])}, []),
        ({"inertia": np.diag([1.0, 0.1, 1.05]), "length": 1.0}, ["slender axis"]),
        ({"inertia": np.diag([1.0, 0.1, 1.05])}, []),
        ({"length": 0.85, "mass_centre": 0.85}, ["mass centre"]),
        ({"length": 0.85, "mass_centre": -0.1}, ["mass centre"]),
    ],
)
def test_impossible_inertias_are_found(data, found):
    assert checks("leg1", **data) == found


def test_mechanism_findings_carry_their_keys():
    beam = np.diag([1e-9, 1e-7, 1e-7, 1e-6, 6e-7, 6e-7])
    # A leg of 0.5 m whose tip turns the wrong way under a force along y, a body that is none.
    beam[1, 5] = beam[5, 1] = beam[2, 4] = beam[4, 2] = -1.5e-7
    tables = {
        "points": {"A": [0.0, 0.0, 0.0], "B": [0.3, 0.4, 0.0]},
        "bodies": {
            "rod": {"from": "A", "to": "B", "mass": 3.0, "compliance": beam},
            "platform": {"points": ["B"], "inertia": np.diag([1.0, 1.0, 3.0])},
        },
        "joints": {"a": {"compliance": np.diag([1e-9, 1e-9, -1e-9, 1e-8, 1e-8, 1e-8])}},
    }
    found = {(one.where, one.check): one for part in parts(tables) for one in data_findings(part)}
    assert found.keys() == {
        ("bodies.rod.compliance", "couplings"),
        ("bodies.platform.inertia", "triangle inequality"),
        ("joints.a.compliance", "definiteness"),
    }
    # 3 · 1e-7 / (2 · 0.5), by hand: the length is that between the points.
    numbers = found["bodies.rod.compliance", "couplings"].numbers
    assert numbers["c26 of a beam"] == pytest.approx(3e-7)
    assert all(audit(load_robot(robot)) == () for robot in ("biglide", "five-bar", "delta"))
