"""Every misprint of the data is found with its number, every check is silent on sound data."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lumped.audit.data_checks import (
    couplings,
    data_findings,
    definiteness,
    mass_centre,
    slender_axis,
    symmetry,
    tip_rotation,
    triangle_inequality,
)
from lumped.audit.finding import DescribedPart, Finding, parts
from lumped.audit.robot_audit import audit
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.robot_file import as_printed, load_robot
from lumped.sections import Rectangle


@pytest.fixture(scope="module")
def findings() -> dict[tuple[str, str], Finding]:
    return {(f.where, f.check): f for f in audit(load_robot("ifw")) if f.kind == "computed"}


# --- the paper's data; numbers from an independent computation, stated with the digits it gave ---


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


# --- robots of one's own ---


def test_without_corrections_the_data_are_used_as_given(tmp_path):
    path = tmp_path / "copy.toml"
    text = load_robot("ifw").text
    path.write_text(text[: text.index("\n[[corrections]]")], encoding="utf-8")
    assert {f.used for f in audit(load_robot(path))} == {"as given"}


# --- each check is silent on sound data and speaks on data made unsound ---

few = settings(max_examples=30)
SIZES = st.floats(0.02, 0.2)
POSITIVE = st.floats(0.1, 10.0)


@st.composite
def beams(draw) -> DescribedPart:
    length = draw(st.floats(0.8, 2.0))
    section = Rectangle(draw(SIZES), draw(SIZES))
    material = Material.isotropic(
        draw(st.floats(1e9, 4e11)), draw(st.floats(0.0, 0.45)), draw(st.floats(1e3, 1e4))
    )
    leg = ConstantLeg(length, section, material)
    transverse = leg.mass * length**2 / 12.0
    inertia = np.diag([0.01 * transverse, transverse, transverse])
    return DescribedPart(
        "leg1", tip_compliance(leg.timoshenko, length), inertia, length, length / 2.0
    )


@st.composite
def slender_bodies(draw) -> DescribedPart:
    """Point masses in a box of 1 m along x and 0.08 m across, 0.1 kg to 10 kg, 1 kg at each end.

    About an axis nearer to y or z than to x the ends alone have at least ½ · 1 kg · 1 m² · ½ =
    0.25 kg m²; about x all others have at most 6 · 10 kg · 2 · (0.04 m)² = 0.19 kg m².
    """
    count = 8
    points = draw(arrays(float, (count, 3), elements=st.floats(-1.0, 1.0)))
    points *= np.array([0.5, 0.04, 0.04])
    points[0], points[1] = [-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]
    masses = draw(arrays(float, count, elements=POSITIVE))
    masses[:2] += 1.0
    centre = masses @ points / masses.sum()
    arms = points - centre
    squares = np.einsum("i,ij,ij->", masses, arms, arms)
    inertia = squares * np.eye(3) - np.einsum("i,ij,ik->jk", masses, arms, arms)
    return DescribedPart("leg1", inertia=inertia, length=1.0, mass_centre=float(centre[0] + 0.5))


@st.composite
def compliances(draw) -> np.ndarray:
    factor = draw(arrays(float, (6, 6), elements=st.floats(-1.0, 1.0)))
    scale = 10.0 ** draw(arrays(float, 6, elements=st.floats(-10.0, -6.0)))
    return (factor @ factor.T + 0.1 * np.eye(6)) * np.sqrt(np.outer(scale, scale))


@few
@given(beams())
def test_beams_are_sound_until_a_coupling_or_a_rotation_is_wrong(beam):
    assert data_findings(beam) == ()
    # A foot may look either way, but not both.
    ways = np.outer([1, -1, -1, 1, 1, 1], [1, -1, -1, 1, 1, 1])
    assert couplings(DescribedPart("foot", beam.compliance * ways)) == ()
    for i, j in ((1, 5), (2, 4)):
        turned = np.ones((6, 6))
        turned[i, j] = turned[j, i] = -1.0
        wrong = beam.compliance * turned
        (found,) = couplings(DescribedPart("leg1", wrong, length=beam.length))
        assert "c26 > 0 and c35 < 0" in found.wrong
        assert len(couplings(DescribedPart("foot", wrong * ways))) == 1
    for about in (4, 5):
        # At least 0.9 of a beam's rotation remains after shear at these slendernesses.
        turning = beam.compliance.copy()
        turning[about, about] *= 20.0
        (found,) = tip_rotation(DescribedPart("leg1", turning, length=beam.length))
        assert found.numbers["ratio"] > 10.0


@few
@given(slender_bodies())
def test_sound_bodies_have_no_findings(body):
    assert data_findings(body) == ()


@few
@given(compliances(), st.permutations(range(6)), st.floats(1e-3, 1.0), st.floats(1.01, 100.0))
def test_compliances_are_sound_until_an_entry_is_changed(compliance, order, share, factor):
    part = DescribedPart("tool", compliance)
    assert symmetry(part) == ()
    assert definiteness(part) == ()
    i, j, *_ = order
    changed = compliance.copy()
    changed[i, j] += share * np.sqrt(compliance[i, i] * compliance[j, j])
    (found,) = symmetry(DescribedPart("tool", changed))
    assert f"({max(i, j) + 1},{min(i, j) + 1})" in found.printed
    # 1/(k⁻¹)_ii is what is left of k_ii by Schur complement; taking more of it away turns the sign.
    changed = compliance.copy()
    changed[i, i] -= factor / np.linalg.inv(compliance)[i, i]
    (found,) = definiteness(DescribedPart("tool", changed))
    assert found.numbers["smallest eigenvalue"] < 0.0


@few
@given(POSITIVE, POSITIVE, st.floats(1.01, 3.0))
def test_a_moment_above_the_sum_of_the_others_is_found(first, second, factor):
    inertia = np.diag([first, factor * (first + second), second])
    assert len(triangle_inequality(DescribedPart("foot", inertia=inertia))) == 1


@pytest.mark.parametrize("moments", [(1.0, 0.1, 1.05), (1.05, 1.0, 0.1)])
def test_a_leg_along_another_axis_is_found(moments):
    inertia = np.diag(moments)
    assert len(slender_axis(DescribedPart("leg1", inertia=inertia, length=1.0))) == 1
    assert slender_axis(DescribedPart("foot", inertia=inertia)) == ()


@pytest.mark.parametrize("centre", [-0.1, 0.0, 0.85, 54.2])
def test_a_mass_centre_outside_the_leg_is_found(centre):
    assert len(mass_centre(DescribedPart("leg1", length=0.85, mass_centre=centre))) == 1


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
