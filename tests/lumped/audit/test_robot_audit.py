"""Every misprint of the data is found with its number, every check is silent on sound data."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.audit import DescribedPart, Finding, audit, data_findings, parts
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.robot_file import as_printed, load_robot
from lumped.sections import Rectangle


@pytest.fixture(scope="module")
def findings() -> dict[tuple[str, str], Finding]:
    return {(f.where, f.check): f for f in audit(load_robot("ifw")) if f.kind == "computed"}


# The paper's data, from an independent computation, stated with the digits it gave.
# By place and check: numbers with the half unit of the digits that are stated, severity and words.
PRINTED = {
    ("foot.compliance", "definiteness"): (
        {"smallest eigenvalue": (-3.5e-8, 0.05e-8)},
        "error",
        "foot.compliance[6,6] = 3.16e-07 in place of 3.16e-09",
    ),
    ("tool.compliance", "symmetry"): (
        {"difference": (1.94e-10, 1e-21)},
        "error",
        "tool.compliance[2,1] = -9.7e-11",
    ),
    ("leg1.inertia", "triangle inequality"): (
        {"moment 1": (0.324, 5e-4), "moment 2": (2.543, 5e-4), "moment 3": (3.988, 5e-4)},
        "error",
        "-0.094",
    ),
    # The printed diagonal 6.122, 5.848, 0.635 bounds the smallest moment from above.
    ("leg2.inertia", "slender axis"): (
        {"smallest moment": (0.3175, 0.3175)},
        "warning",
        "as printed",
    ),
    # Cantilever: 3 · 1.77e-7 / (2 · 0.85) and 3 · 3.19e-8 / (2 · 0.85), by hand.
    ("leg1.compliance", "couplings"): (
        {
            "c26": (-2.90e-7, 0.0),
            "c35": (-9.94e-8, 0.0),
            "c26 of a beam": (3.1235e-7, 3e-11),
            "c35 of a beam": (-5.629e-8, 5e-11),
        },
        "warning",
        "as printed",
    ),
    ("leg2.compliance", "couplings"): (
        {"c26": (-2.12e-8, 0.0), "c35": (-2.38e-10, 0.0)},
        "warning",
        "as printed",
    ),
    # 7.22e-7 · 0.775² / (3 · 1.07e-9), by hand.
    ("leg2.compliance", "tip rotation c55"): ({"ratio": (135.1, 0.05)}, "note", "as printed"),
}


def test_misprints_are_found_with_their_numbers(findings):
    data = {key for key in findings if key[0].split(".")[0] in {"foot", "leg1", "leg2", "tool"}}
    assert data == set(PRINTED)
    for key, (numbers, severity, used) in PRINTED.items():
        found = findings[key]
        assert (found.severity, used in found.used) == (severity, True), key
        for name, (value, half) in numbers.items():
            assert found.numbers[name] == pytest.approx(value, abs=half, rel=0.0), (key, name)
    assert findings["tool.compliance", "symmetry"].printed == "(2,1) = 9.7e-11, (1,2) = -9.7e-11"
    assert "smallest moment of inertia about z" in findings["leg2.inertia", "slender axis"].wrong


def test_corrections_remove_every_error_of_the_data():
    loaded = load_robot("ifw")

    def errors(tables):
        return [f for part in parts(tables) for f in data_findings(part) if f.severity == "error"]

    assert len(errors(as_printed(loaded))) == 3
    assert errors(loaded.tables) == []


def test_without_corrections_the_data_are_used_as_given():
    without = replace(load_robot("ifw"), corrections=())
    assert {f.used for f in audit(without)} == {"as given"}


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
def test_a_beam_is_sound_until_a_coupling_or_a_rotation_is_wrong(length, width, height, nu):
    leg = ConstantLeg(length, Rectangle(width, height), Material.isotropic(2e11, nu, 7850.0))
    beam = tip_compliance(leg.timoshenko, length)
    across = leg.mass * length**2 / 12.0
    inertia = np.diag([0.01 * across, across, across])
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


@pytest.mark.parametrize("seed", range(6))
def test_compliances_are_sound_until_an_entry_is_changed(seed):
    rng = np.random.default_rng(seed)
    i, j, *_ = rng.permutation(6)
    share, factor = 10.0 ** rng.uniform(-3.0, 0.0), 10.0 ** rng.uniform(0.005, 2.0)
    root, scale = rng.uniform(-1.0, 1.0, (6, 6)), 10.0 ** rng.uniform(-10.0, -6.0, 6)
    compliance = (root @ root.T + 0.1 * np.eye(6)) * np.sqrt(np.outer(scale, scale))
    assert checks("tool", compliance=compliance) == []
    changed = compliance.copy()
    changed[i, j] += share * np.sqrt(compliance[i, i] * compliance[j, j])
    first, *_ = data_findings(DescribedPart("tool", changed))
    assert first.check == "symmetry"
    assert f"({max(i, j) + 1},{min(i, j) + 1})" in first.printed
    # 1/(k⁻¹)_ii is what is left of k_ii by Schur complement; taking more of it away turns the sign.
    changed = compliance.copy()
    changed[i, i] -= factor / np.linalg.inv(compliance)[i, i]
    (found,) = data_findings(DescribedPart("tool", changed))
    assert found.numbers["smallest eigenvalue"] < 0.0


@pytest.mark.parametrize(
    ("data", "found"),
    [
        ({"inertia": np.diag([1.0, 3.0, 1.9])}, ["triangle inequality"]),
        ({"inertia": np.diag([1.0, 2.8, 1.9])}, []),
        ({"inertia": np.diag([1.0, 0.1, 1.05]), "length": 1.0}, ["slender axis"]),
        ({"inertia": np.diag([1.0, 0.1, 1.05])}, []),
        ({"length": 0.85, "mass_centre": 0.85}, ["mass centre"]),
        ({"length": 0.85, "mass_centre": 54.2}, ["mass centre"]),
        ({"length": 0.85, "mass_centre": -0.1}, ["mass centre"]),
    ],
)
def test_masses_that_no_such_body_has_are_found(data, found):
    assert checks("leg1", **data) == found


def test_bodies_and_joints_of_a_mechanism_are_audited_under_their_keys():
    beam = np.diag([1e-9, 1e-7, 1e-7, 1e-6, 6e-7, 6e-7])
    # A leg of 0.5 m whose tip turns the wrong way under a force along y, a body that is none.
    beam[1, 5] = beam[5, 1] = -1.5e-7
    beam[2, 4] = beam[4, 2] = -1.5e-7
    tables = {
        "points": {"A": [0.0, 0.0, 0.0], "B": [0.3, 0.4, 0.0]},
        "bodies": {
            "rod": {"from": "A", "to": "B", "mass": 3.0, "compliance": beam.tolist()},
            "platform": {"points": ["B"], "inertia": np.diag([1.0, 1.0, 3.0]).tolist()},
        },
        "joints": {"a": {"compliance": np.diag([1e-9, 1e-9, -1e-9, 1e-8, 1e-8, 1e-8]).tolist()}},
    }
    found = {(f.where, f.check) for part in parts(tables) for f in data_findings(part)}
    assert found == {
        ("bodies.rod.compliance", "couplings"),
        ("bodies.platform.inertia", "triangle inequality"),
        ("joints.a.compliance", "definiteness"),
    }
    lengths = {part.name: part.length for part in parts(tables)}
    assert lengths["bodies.rod"] == pytest.approx(0.5)


@pytest.mark.parametrize("robot", ["biglide", "five-bar", "delta"])
def test_nothing_is_found_wrong_with_the_mechanisms_that_come_with_the_program(robot):
    assert audit(load_robot(robot)) == ()
