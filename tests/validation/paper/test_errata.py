"""Every erratum of the paper's text and formulas is found with its number."""

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation.paper.errata import paper_findings

# Stiffness between two elements of leg 1 of 20, EIz/l with EIz to four digits, and 1 mrad.
EIZ, PIECE, TURNED = 1.832e6, 0.85 / 20.0, 1e-3
# √(EA/EI) of both planes to four digits, clamped-free: π/2 · L √(EA/EI) / 1.8751².
HIGHER = {
    plane: np.pi / 2.0 * 0.85 * np.sqrt(8.613e8 / stiffness) / 1.875104**2
    for plane, stiffness in (("z", EIZ), ("y", 4.771e6))
}
# What rounding leaves of an energy (J) that vanishes: squares of its errors by 1e10 N/m.
NOTHING = pytest.approx(0.0, abs=1e-15)
FOUND = {
    # §2.1 of the paper says about 1e9 N/m; four digits.
    ("foot.compliance", "stiffness along y"): {"corrected": pytest.approx(1.064e9, abs=5e5)},
    ("captions of Figs 6c, 12c, 13c", "caption"): {
        "x": pytest.approx(-0.07),
        "first": pytest.approx(0.145),
        "last": pytest.approx(0.85),
    },
    ("eqs (17), (18)", "lever arms"): {
        "energy turned": NOTHING,
        "energy of a leg along x": NOTHING,
    },
    ("eqs (19), (20)", "small rotations"): {
        "energy as printed": 0.0,
        "energy": pytest.approx(0.5 * EIZ / PIECE * TURNED**2, rel=5e-4),
    },
    # The arm is l/2 too long, so the spring deflects by φl/2 along y: ½ · 12EIz/l³ · (φl/2)².
    ("eq. (23)", "neighbour index"): {
        "energy as printed": pytest.approx(1.5 * EIZ / PIECE * TURNED**2, rel=5e-4),
        "energy": NOTHING,
    },
    ("eq. (25)", "joint release"): {
        "y stiffness as printed": pytest.approx(1.064e9, abs=5e5),
        "y stiffness condensed": pytest.approx(1.7e8, abs=5e6),
    },
    ("§1", "longitudinal frequencies"): {
        f"leg 1, bending {plane}": pytest.approx(ratio, rel=5e-4) for plane, ratio in HIGHER.items()
    },
    # First order, but for a next term of some hundredths at 20 elements.
    ("§3.2", "literal layout"): {
        "error at 20": pytest.approx(0.052, abs=5e-4),
        "order": pytest.approx(1.0, abs=0.05),
        "length deficit": pytest.approx(0.85 / 40.0),
    },
}


@pytest.fixture(scope="module")
def numbers() -> dict[tuple[str, str], dict[str, float]]:
    found = paper_findings(load_robot("ifw"))
    return {(f.where, f.check): f.numbers for f in found if f.kind == "computed"}


@pytest.mark.parametrize("erratum", FOUND, ids=lambda erratum: erratum[0])
def test_an_erratum_has_its_number(numbers, erratum):
    found = numbers[erratum]
    assert {name: found[name] for name in FOUND[erratum]} == FOUND[erratum]


def test_what_is_printed_is_wrong_by_as_much_as_is_said(numbers):
    assert set(numbers) == {*FOUND, ("eq. (12)", "work balance")}
    assert numbers["foot.compliance", "stiffness along y"]["as printed"] < 0.0
    assert numbers["eqs (17), (18)", "lever arms"]["energy as printed"] > 1.0
    assert min(numbers["§1", "longitudinal frequencies"].values()) > 2.0


def test_work_balance_of_equation_12(numbers):
    found = numbers["eq. (12)", "work balance"]
    assert found["error as printed"] > 0.5
    # rounding of a 2×2 inverse of condition below 10
    assert found["error with work balance"] < 1e-14
    assert abs(found["f1 difference, equal drives"]) < 1e-9
    # A t = Bq̇ at x = 0.4975 by hand, drives 1e9 and 2e9 N/m, 46 kg
    s1, s2 = np.sqrt(0.85**2 - 0.4975**2), np.sqrt(0.775**2 - 0.4225**2)
    flexibility = np.linalg.solve(np.array([[0.4975, s1], [-0.4225, s2]]), np.diag([s1, s2]))
    softest = np.linalg.eigvalsh(flexibility @ np.diag([1e-9, 0.5e-9]) @ flexibility.T)[-1]
    f1 = 1.0 / np.sqrt(46.0 * softest) / (2.0 * np.pi)
    assert found["f1 with work balance"] == pytest.approx(f1, rel=1e-12)
    assert abs(found["f1 as printed"] / f1 - 1.0) > 0.05


def test_what_only_reading_finds_is_said_to_be_read():
    read = [f for f in paper_findings(load_robot("ifw")) if f.kind == "read"]
    assert any("§3.3" in f.where and "eq. (10)" in f.used for f in read)
    assert {f.severity for f in read} == {"note"}


def test_no_other_robot_has_the_papers_errata(tmp_path):
    path = tmp_path / "copy.toml"
    path.write_text(load_robot("ifw").text, encoding="utf-8")
    assert [paper_findings(load_robot(one)) for one in ("biglide", "five-bar", path)] == [()] * 3
