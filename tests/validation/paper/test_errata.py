"""Every erratum of the paper's text and formulas has its numbers, which are computed here."""

import numpy as np
import pytest
from like_ifw import IFW

from lumped.legs import equivalent_leg
from lumped.models.bodies import clamped_modes, legs_of
from lumped.models.segments import segment_chain, segment_leg
from lumped.robot_file import as_printed, load_robot
from lumped.system.joint_motion import printed_release
from validation.paper.errata import paper_findings

LEG_1, LEG_2 = map(equivalent_leg, legs_of(IFW.mechanism).values())
FOUND = {(one.where, one.check): one for one in paper_findings(IFW) if one.kind == "computed"}
# A, L1, L2 (m), and B in the centre of the stroke.
A, L1, L2, CENTRE = 0.92, 0.85, 0.775, 0.4975
# Length of an element of leg 1 of 20 (m), and 1 mrad.
PIECE, TURNED = L1 / 20.0, 1e-3
# β₁L of a clamped-free beam.
ROOT = 1.8751040687


def said(where: str, check: str) -> str:
    return FOUND[where, check].evidence


def test_the_captions_put_the_right_end_of_the_stroke_outside_it():
    assert said("captions of Figs 6c, 12c, 13c", "caption") == (
        f"L1 − a = {L1 - A:.3g} m, the stroke goes from {A - L2:.3g} to {L1:.3g} m"
    )


def test_the_foot_resists_y_as_far_as_its_joint_lets_it():
    printed, used = (
        np.array(tables["foot"]["compliance"]) for tables in (as_printed(IFW), IFW.tables)
    )
    stiff, corrected = (np.linalg.inv(one) for one in (printed, used))
    foot = FOUND["foot.compliance", "stiffness along y"]
    assert foot.printed.startswith(f"c66 = {printed[5, 5]:.3g} ")
    assert foot.evidence == (
        f"(k⁻¹)₂₂ = {stiff[1, 1]:.3g} N/m as printed, {corrected[1, 1]:.4g} N/m as corrected"
    )
    # A free joint: what no moment about z compresses.
    free = np.linalg.inv(used[:5, :5])[1, 1]
    assert said("eq. (25)", "joint release") == (
        f"the foot resists y with {printed_release(corrected)[1, 1]:.3g} N/m as printed, "
        f"{free:.3g} N/m with a free joint; 1/c22 = {1.0 / used[1, 1]:.3g} N/m"
    )


def test_tension_is_higher_than_bending():
    """π/2L √(EA/μ) over (1.8751/L)² √(EI/μ)."""
    ratios = [
        f"{np.pi / 2.0 * leg.length * np.sqrt(beam.EA / stiffness) / ROOT**2:.2g} "
        f"(leg {number}, bending {plane})"
        for number, leg in enumerate((LEG_1, LEG_2), start=1)
        for beam in [leg.properties("euler-bernoulli")]
        for plane, stiffness in (("z", beam.EIz), ("y", beam.EIy))
    ]
    assert said("§1", "longitudinal frequencies").endswith(f": {', '.join(ratios)}")


def test_work_balance_of_equation_12():
    """A t = Bq̇ by hand, drives of 1e9 and 2e9 N/m, 46 kg."""
    s1, s2 = np.sqrt(L1**2 - CENTRE**2), np.sqrt(L2**2 - (A - CENTRE) ** 2)
    J = np.linalg.solve(np.array([[CENTRE, s1], [CENTRE - A, s2]]), np.diag([s1, s2]))
    K, inverse = np.diag([1e9, 2e9]), np.linalg.inv(J)
    exact = np.linalg.inv(J @ np.linalg.inv(K) @ J.T)
    printed, balanced = inverse @ K @ inverse.T, inverse.T @ K @ inverse

    assert balanced == pytest.approx(exact, rel=1e-12)
    first, due = (
        np.sqrt(np.linalg.eigvalsh(one)[0] / 46.0) / (2.0 * np.pi) for one in (printed, exact)
    )
    error = np.linalg.norm(printed - exact) / np.linalg.norm(exact)
    assert said("eq. (12)", "work balance") == (
        f"at the centre with drives of {1e9:.0e} and {2e9:.0e} N/m the inverse of eq. (1) is "
        f"missed by {error:.0%} as printed, by rounding alone with J⁻ᵀKJ⁻¹; f1 = "
        f"{first:.1f} in place of {due:.1f} Hz; equal drives give the "
        "same f1"
    )


def test_the_literal_layout_is_of_first_order():
    beam = LEG_1.properties("euler-bernoulli")
    exact = ROOT**2 / (2.0 * np.pi * L1**2) * np.sqrt(beam.EIz / beam.mu)
    coarse, fine = (
        clamped_modes(segment_leg(segment_chain(beam, L1, n, "literal")), 1).frequencies[0] / exact
        - 1.0
        for n in (20, 40)
    )
    assert said("§3.2", "literal layout") == (
        f"at m = 20 leg 1 bends from {1e3 * PIECE / 2.0:.3g} mm beyond its root and its first "
        f"frequency is {coarse:.1%} too high, at m = 40 {fine:.1%} "
        f"(order {np.log2(coarse / fine):.2f})"
    )


def test_springs_store_energy_in_rigid_rotations():
    """½ uᵀKu of a spring of EA/l, 12EI/l³, EI/l, whose elements turn as one body, or bend."""
    beam = LEG_1.properties("euler-bernoulli")
    axial, shear = beam.EA / PIECE, 12.0 * beam.EIz / PIECE**3
    cosine = CENTRE / L1
    # Arms along x in place of the leg: u = lφ ((1 − cos α) n − sin α d).
    apart = axial * (1.0 - cosine**2) + shear * (1.0 - cosine) ** 2
    stored = 0.5 * (PIECE * TURNED) ** 2 * apart
    assert f"stores {stored:.3g} J in one spring" in said("eqs (17), (18)", "lever arms")
    bent = 0.5 * beam.EIz / PIECE * TURNED**2
    assert said("eqs (19), (20)", "small rotations").endswith(f"in truth {bent:.3g} J")
    # The arm is l/2 too long: ½ · 12EI/l³ · (φl/2)².
    assert f"stores {3.0 * bent:.3g} J as printed" in said("eq. (23)", "neighbour index")
    assert len(FOUND) == 9


def test_what_only_reading_finds_is_said_to_be_read():
    read = [f for f in paper_findings(IFW) if f.kind == "read"]
    assert any("§3.3" in f.where and "eq. (10)" in f.used for f in read)
    assert {f.severity for f in read} == {"note"}


def test_no_other_robot_has_the_papers_errata(tmp_path):
    path = tmp_path / "copy.toml"
    path.write_text(IFW.text, encoding="utf-8")
    assert [paper_findings(load_robot(one)) for one in ("biglide", "five-bar", path)] == [()] * 3
