"""Every erratum of the paper's text and formulas is found with its number."""

import numpy as np
import pytest

from lumped.audit.finding import Finding
from lumped.robot_file import load_robot
from validation.paper.errata import paper_findings


@pytest.fixture(scope="module")
def findings() -> dict[tuple[str, str], Finding]:
    found = paper_findings(load_robot("ifw"))
    return {(f.where, f.check): f for f in found if f.kind == "computed"}


def test_corrected_foot_has_the_stiffness_the_paper_states(findings):
    found = findings["foot.compliance", "stiffness along y"]
    # 1.064e9 N/m: four digits stated; §2.1 of the paper says about 1e9
    assert found.numbers["corrected"] == pytest.approx(1.064e9, abs=0.0005e9)
    assert found.numbers["as printed"] < 0.0


def test_caption_is_outside_the_stroke(findings):
    numbers = findings["captions of Figs 6c, 12c, 13c", "caption"].numbers
    assert numbers["x"] == pytest.approx(-0.07)
    assert numbers["x"] < numbers["first"] == pytest.approx(0.145)


def test_work_balance_of_equation_12(findings):
    numbers = findings["eq. (12)", "work balance"].numbers
    assert numbers["error as printed"] > 0.5
    # rounding of a 2×2 inverse of condition below 10
    assert numbers["error with work balance"] < 1e-14
    assert abs(numbers["f1 difference, equal drives"]) < 1e-9
    # A t = Bq̇ at x = 0.4975 by hand, drives 1e9 and 2e9 N/m, 46 kg
    s1, s2 = np.sqrt(0.85**2 - 0.4975**2), np.sqrt(0.775**2 - 0.4225**2)
    flexibility = np.linalg.solve(np.array([[0.4975, s1], [-0.4225, s2]]), np.diag([s1, s2]))
    softest = np.linalg.eigvalsh(flexibility @ np.diag([1e-9, 0.5e-9]) @ flexibility.T)[-1]
    f1 = 1.0 / np.sqrt(46.0 * softest) / (2.0 * np.pi)
    assert numbers["f1 with work balance"] == pytest.approx(f1, rel=1e-12)
    assert abs(numbers["f1 as printed"] / f1 - 1.0) > 0.05


def test_lever_arms_of_equations_17_and_18(findings):
    numbers = findings["eqs (17), (18)", "lever arms"].numbers
    assert numbers["energy as printed"] > 1.0
    # squares of rounding errors times stiffnesses of 1e10 N/m
    assert numbers["energy turned"] < 1e-15
    assert numbers["energy of a leg along x"] < 1e-15


def test_equation_19_bends_no_spring(findings):
    numbers = findings["eqs (19), (20)", "small rotations"].numbers
    assert numbers["energy as printed"] == 0.0
    # ½ (EIz / l) φ² with EIz = 1.832e6 N m² (four digits), l = 0.85/20 m, φ = 1 mrad
    assert numbers["energy"] == pytest.approx(0.5 * 1.832e6 / 0.0425 * 1e-6, rel=5e-4)


def test_index_of_equation_23(findings):
    numbers = findings["eq. (23)", "neighbour index"].numbers
    # the arm is l/2 too long, so the spring deflects by φl/2 along y: ½ · 12EIz/l³ · (φl/2)²
    assert numbers["energy as printed"] == pytest.approx(1.5 * 1.832e6 / 0.0425 * 1e-6, rel=5e-4)
    assert numbers["energy"] < 1e-15


def test_joint_release_of_equation_25(findings):
    numbers = findings["eq. (25)", "joint release"].numbers
    # 1.06e9 and 1.7e8 N/m: digits as stated
    assert numbers["y stiffness as printed"] == pytest.approx(1.064e9, abs=0.0005e9)
    assert numbers["y stiffness condensed"] == pytest.approx(1.7e8, abs=0.05e8)


def test_longitudinal_frequencies_are_higher_not_lower(findings):
    numbers = findings["§1", "longitudinal frequencies"].numbers
    # π/2 · L √(EA/EI) / 1.8751² with the equivalent leg 1's EA, EIy and EIz (four digits)
    for axis, stiffness in (("z", 1.832e6), ("y", 4.771e6)):
        ratio = np.pi / 2.0 * 0.85 * np.sqrt(8.613e8 / stiffness) / 1.875104**2
        assert numbers[f"leg 1, bending {axis}"] == pytest.approx(ratio, rel=5e-4)
    assert min(numbers.values()) > 2.0


def test_literal_layout_is_of_first_order(findings):
    numbers = findings["§3.2", "literal layout"].numbers
    # +5.2 % at n = 20: digits as stated
    assert numbers["error at 20"] == pytest.approx(0.052, abs=0.0005)
    # first order; at n = 20 the next term still adds a few hundredths
    assert numbers["order"] == pytest.approx(1.0, abs=0.05)
    assert numbers["length deficit"] == pytest.approx(0.85 / 40.0)


def test_what_only_reading_finds_is_said_to_be_read():
    read = [f for f in paper_findings(load_robot("ifw")) if f.kind == "read"]
    assert any("§3.3" in f.where and "eq. (10)" in f.used for f in read)
    assert {f.severity for f in read} == {"note"}


@pytest.mark.parametrize("robot", ["biglide", "five-bar"])
def test_no_other_robot_has_the_papers_errata(robot):
    assert paper_findings(load_robot(robot)) == ()


def test_a_copy_of_the_papers_robot_is_a_robot_of_ones_own(tmp_path):
    path = tmp_path / "copy.toml"
    path.write_text(load_robot("ifw").text, encoding="utf-8")
    assert paper_findings(load_robot(path)) == ()
