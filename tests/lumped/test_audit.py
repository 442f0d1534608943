"""Audit of data: every misprint of the paper is reported, and valid data give no finding."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.audit import DescribedPart, audit, data_findings, parts
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import as_printed, load_robot
from lumped.sections import Rectangle

IFW = load_robot("ifw")
# Findings on the paper's data by key and check: severity, and numbers of an independent
# computation, to half a unit of their last digit.
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
# Value that the paper's robot uses in place of a misprint; all other values are used as printed.
USED = {
    "foot.compliance": "foot.compliance[6,6] = 3.16e-07 in place of 3.16e-09",
    "tool.compliance": "tool.compliance[2,1] = -9.7e-11",
    "leg1.inertia": "-0.094",
}


def test_paper_misprints_are_reported():
    """Each printed number with an error, its severity and the number used instead."""
    findings = {(finding.where, finding.check): finding for finding in audit(IFW)}
    assert findings.keys() == PRINTED.keys()
    for key, (severity, numbers) in PRINTED.items():
        assert findings[key].severity == severity, key
        assert USED.get(key[0], "as printed") in findings[key].used, key
        assert numbers.items() <= dict(findings[key].numbers).items(), key
    assert findings["tool.compliance", "symmetry"].printed == "(2,1) = 9.7e-11, (1,2) = -9.7e-11"
    assert "smallest moment of inertia about z" in findings["leg2.inertia", "slender axis"].wrong
    assert {finding.used for finding in audit(replace(IFW, corrections=()))} == {"as given"}


def test_corrected_paper_data_has_no_errors():
    """As printed there are three errors."""
    for tables, count in ((as_printed(IFW), 3), (IFW.tables, 0)):
        findings = [finding for part in parts(tables) for finding in data_findings(part)]
        severities = [finding.severity for finding in findings]
        assert severities.count("error") == count


def checks(name, **data):
    """Return the names of the checks that report a finding on one part with these data."""
    return [finding.check for finding in data_findings(DescribedPart(name, **data))]


def with_entries(matrix, **entries):
    """Return the symmetric matrix with some entries scaled: `c26=-1.0` reverses the sign of c26."""
    changed = matrix.copy()
    for name, factor in entries.items():
        i, j = int(name[1]) - 1, int(name[2]) - 1
        changed[i, j] = changed[j, i] = factor * matrix[i, j]
    return changed


@pytest.mark.parametrize(
    ("length", "width", "height", "nu"),
    [(0.8, 0.2, 0.02, 0.0), (1.3, 0.1, 0.16, 0.3), (2.0, 0.02, 0.2, 0.45)],
)
def test_wrong_compliance_sign_is_reported(length, width, height, nu):
    """c26 > 0 and c35 < 0 in a right-handed beam; c55 and c66 are L/EI."""
    leg = ConstantLeg(length, Rectangle(width, height), Material.isotropic(2e11, nu, 7850.0))
    beam = tip_compliance(leg.timoshenko, length)
    inertia = np.diag([0.01, 1.0, 1.0]) * leg.mass * length**2 / 12.0
    assert checks("leg1", compliance=beam, inertia=inertia, length=length, mass_centre=0.4) == []
    # A foot of unknown direction may have both couplings reversed but not one; the tool's
    # compliance has no lever arm and may have any couplings.
    assert checks("foot", compliance=with_entries(beam, c26=-1.0, c35=-1.0)) == []
    for entry in ("c26", "c35"):
        wrong = with_entries(beam, **{entry: -1.0})
        assert checks("leg1", compliance=wrong, length=length) == ["couplings"]
        assert checks("foot", compliance=wrong) == ["couplings"]
        assert checks("tool", compliance=wrong) == []
    for entry in ("c55", "c66"):
        # 20 times the tip rotation of a beam; shear changes it by less than a tenth here.
        wrong = with_entries(beam, **{entry: 20.0})
        assert checks("leg1", compliance=wrong, length=length) == [f"tip rotation {entry}"]


@pytest.mark.parametrize(
    ("data", "findings"),
    [
        ({"inertia": np.diag([1.0, 3.0, 1.9])}, ["triangle inequality"]),
        ({"inertia": np.diag([1.0, 2.8, 1.9])}, []),
        ({"inertia": np.diag([1.0, 0.1, 1.05]), "length": 1.0}, ["slender axis"]),
        ({"inertia": np.diag([1.0, 0.1, 1.05])}, []),
        ({"length": 0.85, "mass_centre": 0.85}, ["mass centre"]),
        ({"length": 0.85, "mass_centre": -0.1}, ["mass centre"]),
    ],
)
def test_impossible_inertia_is_reported(data, findings):
    """Moments of a body satisfy I1 ≤ I2 + I3; the mass centre lies within the leg."""
    assert checks("leg1", **data) == findings


def test_audit_findings_have_keys():
    """A finding names the key of the robot file. Three built-in robots have none."""
    beam = np.diag([1e-9, 1e-7, 1e-7, 1e-6, 6e-7, 6e-7])
    # A leg of 0.5 m with couplings of the wrong sign, a body with an impossible inertia, and a
    # joint with a negative compliance.
    beam[1, 5] = beam[5, 1] = beam[2, 4] = beam[4, 2] = -1.5e-7
    tables = {
        "points": {"A": [0.0, 0.0, 0.0], "B": [0.3, 0.4, 0.0]},
        "bodies": {
            "rod": {"from": "A", "to": "B", "mass": 3.0, "compliance": beam},
            "platform": {"points": ["B"], "inertia": np.diag([1.0, 1.0, 3.0])},
        },
        "joints": {"a": {"compliance": np.diag([1e-9, 1e-9, -1e-9, 1e-8, 1e-8, 1e-8])}},
    }
    findings = {(f.where, f.check): f for part in parts(tables) for f in data_findings(part)}
    assert findings.keys() == {
        ("bodies.rod.compliance", "couplings"),
        ("bodies.platform.inertia", "triangle inequality"),
        ("joints.a.compliance", "definiteness"),
    }
    # 3 · 1e-7 / (2 · 0.5) by hand, with the distance of 0.5 m between points A and B.
    numbers = findings["bodies.rod.compliance", "couplings"].numbers
    assert numbers["c26 of a beam"] == pytest.approx(3e-7)
    assert all(audit(load_robot(robot)) == () for robot in ("biglide", "five-bar", "delta"))
