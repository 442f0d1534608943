"""Every misprint of the data is found with its number, every check is silent on sound data."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lumped.audit.data_checks import (
    CHECKS,
    DescribedPart,
    couplings,
    data_findings,
    definiteness,
    mass_centre,
    parts,
    slender_axis,
    symmetry,
    tip_rotation,
    triangle_inequality,
)
from lumped.audit.finding import Finding
from lumped.audit.robot_audit import audit
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.robot_file import as_printed, load_robot, write_template
from lumped.sections import Rectangle


@pytest.fixture(scope="module")
def findings() -> dict[tuple[str, str], Finding]:
    return {(f.where, f.check): f for f in audit(load_robot("ifw")) if f.kind == "computed"}


@pytest.fixture(scope="module")
def used_parts() -> dict[str, DescribedPart]:
    return {part.name: part for part in parts(load_robot("ifw").tables)}


# --- the paper's data; numbers from an independent computation, stated with the digits it gave ---


def test_foot_is_indefinite_as_printed(findings):
    found = findings["foot.compliance", "definiteness"]
    # λmin = −3.5e-8: two digits stated
    assert found.numbers["smallest eigenvalue"] == pytest.approx(-3.5e-8, abs=0.05e-8)
    assert found.severity == "error"
    assert found.used.startswith("foot.compliance[6,6] = 3.16e-07 in place of 3.16e-09")


def test_tool_is_not_symmetric_as_printed(findings):
    found = findings["tool.compliance", "symmetry"]
    # printed: +9.70e-11 and −9.70e-11
    assert found.numbers["difference"] == pytest.approx(1.94e-10, rel=1e-12)
    assert found.printed == "(2,1) = 9.7e-11, (1,2) = -9.7e-11"
    assert found.used.startswith("tool.compliance[2,1] = -9.7e-11")


def test_leg1_inertia_breaks_the_triangle_inequality_as_printed(findings):
    found = findings["leg1.inertia", "triangle inequality"]
    moments = [found.numbers[f"moment {i}"] for i in (1, 2, 3)]
    # three decimals stated
    assert moments == pytest.approx([0.324, 2.543, 3.988], abs=5e-4)
    assert "-0.094" in found.used


def test_corrected_leg1_inertia_is_that_of_a_body(used_parts):
    moments = np.linalg.eigvalsh(used_parts["leg1"].inertia)
    assert moments == pytest.approx([0.458, 3.036, 3.361], abs=5e-4)
    assert triangle_inequality(used_parts["leg1"]) == ()


def test_leg2_inertia_is_smallest_about_z(findings):
    found = findings["leg2.inertia", "slender axis"]
    # The printed diagonal 6.122, 5.848, 0.635 bounds the smallest moment from above.
    assert found.numbers["smallest moment"] < 0.635
    assert "smallest moment of inertia about z" in found.wrong
    assert found.used == "as printed"


@pytest.mark.parametrize(
    ("leg", "c26", "c35"), [("leg1", -2.90e-7, -9.94e-8), ("leg2", -2.12e-8, -2.38e-10)]
)
def test_couplings_of_both_legs_have_equal_signs(findings, leg, c26, c35):
    found = findings[f"{leg}.compliance", "couplings"]
    assert (found.numbers["c26"], found.numbers["c35"]) == (c26, c35)
    assert found.used == "as printed"


def test_beam_values_beside_the_couplings_of_leg1(findings):
    numbers = findings["leg1.compliance", "couplings"].numbers
    # cantilever: 3 · 1.77e-7 / (2 · 0.85) and 3 · 3.19e-8 / (2 · 0.85), by hand
    assert numbers["c26 of a beam"] == pytest.approx(3.1235e-7, rel=1e-4)
    assert numbers["c35 of a beam"] == pytest.approx(-5.629e-8, rel=1e-3)


def test_tip_of_leg2_turns_far_more_than_a_beam(findings):
    # 7.22e-7 · 0.775² / (3 · 1.07e-9), by hand
    ratio = findings["leg2.compliance", "tip rotation c55"].numbers["ratio"]
    assert ratio == pytest.approx(135.1, abs=0.05)


def test_nothing_else_is_wrong_with_the_printed_data(findings):
    data = {key for key in findings if key[0].split(".")[0] in {"foot", "leg1", "leg2", "tool"}}
    assert data == {
        ("foot.compliance", "definiteness"),
        ("leg1.inertia", "triangle inequality"),
        ("leg1.compliance", "couplings"),
        ("leg2.inertia", "slender axis"),
        ("leg2.compliance", "couplings"),
        ("leg2.compliance", "tip rotation c55"),
        ("tool.compliance", "symmetry"),
    }


def test_corrections_remove_every_error_of_the_data():
    loaded = load_robot("ifw")

    def errors(tables):
        return [f for part in parts(tables) for f in data_findings(part) if f.severity == "error"]

    assert len(errors(as_printed(loaded))) == 3
    assert errors(loaded.tables) == []


# --- robots of one's own ---


def test_sound_robot_has_no_findings(tmp_path):
    write_template(tmp_path / "sound.toml")
    assert audit(load_robot(tmp_path / "sound.toml")) == ()


def test_without_corrections_the_data_are_used_as_given(tmp_path):
    path = tmp_path / "copy.toml"
    text = load_robot("ifw").text
    path.write_text(text[: text.index("\n[[corrections]]")], encoding="utf-8")
    assert {f.used for f in audit(load_robot(path))} == {"as given"}


# --- each check is silent on sound data and speaks on data made unsound ---

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


@given(beams())
def test_sound_beams_have_no_findings(beam):
    assert data_findings(beam) == ()


@given(slender_bodies())
def test_sound_bodies_have_no_findings(body):
    assert data_findings(body) == ()


@given(compliances())
def test_every_positive_definite_compliance_passes(compliance):
    part = DescribedPart("tool", compliance)
    assert symmetry(part) == ()
    assert definiteness(part) == ()


@given(compliances(), st.integers(0, 5), st.integers(0, 5), st.floats(1e-3, 1.0))
def test_one_changed_entry_is_an_asymmetry(compliance, i, j, share):
    if i == j:
        j = (i + 1) % 6
    changed = compliance.copy()
    changed[i, j] += share * np.sqrt(compliance[i, i] * compliance[j, j])
    (found,) = symmetry(DescribedPart("tool", changed))
    assert f"({max(i, j) + 1},{min(i, j) + 1})" in found.printed


@given(compliances(), st.integers(0, 5), st.floats(1.01, 100.0))
def test_a_diagonal_entry_too_small_is_indefinite(compliance, i, factor):
    # 1/(k⁻¹)_ii is what is left of k_ii by Schur complement; taking more of it away turns the sign.
    changed = compliance.copy()
    changed[i, i] -= factor / np.linalg.inv(compliance)[i, i]
    (found,) = definiteness(DescribedPart("tool", changed))
    assert found.numbers["smallest eigenvalue"] < 0.0


@given(beams(), st.sampled_from([(1, 5), (2, 4)]))
def test_a_turned_sign_of_a_coupling_is_found(beam, entry):
    i, j = entry
    turned = beam.compliance.copy()
    turned[i, j] *= -1.0
    turned[j, i] *= -1.0
    (found,) = couplings(DescribedPart("leg1", turned, length=beam.length))
    assert "c26 > 0 and c35 < 0" in found.wrong


@given(beams(), st.sampled_from([(1, 5), (2, 4)]))
def test_a_foot_may_look_either_way_but_not_both(beam, entry):
    mirrored = beam.compliance * np.outer([1, -1, -1, 1, 1, 1], [1, -1, -1, 1, 1, 1])
    assert couplings(DescribedPart("foot", mirrored)) == ()
    i, j = entry
    mirrored[i, j] *= -1.0
    mirrored[j, i] *= -1.0
    assert len(couplings(DescribedPart("foot", mirrored))) == 1


@given(beams(), st.sampled_from([4, 5]))
def test_a_tip_that_turns_too_much_is_found(beam, about):
    # at least 0.9 of a beam's rotation remains after shear at these slendernesses; 20 times is 18
    turning = beam.compliance.copy()
    turning[about, about] *= 20.0
    (found,) = tip_rotation(DescribedPart("leg1", turning, length=beam.length))
    assert found.numbers["ratio"] > 10.0


@given(POSITIVE, POSITIVE, st.floats(1.01, 3.0))
def test_a_moment_above_the_sum_of_the_others_is_found(first, second, factor):
    inertia = np.diag([first, factor * (first + second), second])
    assert len(triangle_inequality(DescribedPart("foot", inertia=inertia))) == 1


@given(st.sampled_from([(1, 0, 2), (2, 1, 0)]))
def test_a_leg_along_another_axis_is_found(order):
    inertia = np.diag(np.array([0.1, 1.0, 1.05])[list(order)])
    assert len(slender_axis(DescribedPart("leg1", inertia=inertia, length=1.0))) == 1
    assert slender_axis(DescribedPart("foot", inertia=inertia)) == ()


@pytest.mark.parametrize("centre", [-0.1, 0.0, 0.85, 54.2])
def test_a_mass_centre_outside_the_leg_is_found(centre):
    assert len(mass_centre(DescribedPart("leg1", length=0.85, mass_centre=centre))) == 1


@pytest.mark.parametrize("check", CHECKS)
def test_a_part_without_data_has_no_findings(check):
    assert check(DescribedPart("leg1")) == ()


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
    assert next(parts_named(tables, "bodies.rod")).length == pytest.approx(0.5)


def parts_named(tables, name):
    return (part for part in parts(tables) if part.name == name)


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "orthoglide", "hexapod"])
def test_nothing_is_found_wrong_with_the_mechanisms_that_come_with_the_program(robot):
    assert audit(load_robot(robot)) == ()
