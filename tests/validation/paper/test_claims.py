"""Statements of the paper, with its data as printed and as corrected, and the errata."""

import csv
import io
import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.oracles.shifted_references import assert_agrees_and_can_disagree
from support.robots.paper_robot_variants import IFW

from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.models.bodies import clamped_modes, legs_of
from lumped.models.segments import segment_chain, segment_leg
from lumped.robot_file import as_printed, load_robot
from lumped.system.joint_motion import printed_release
from validation import paper
from validation.context import Context
from validation.models.options import ModelOptions
from validation.paper.curves import cosine_spaced, frequencies_over_the_stroke
from validation.paper.errata import paper_findings
from validation.paper.robot import (
    RobotOnStroke,
    deflections,
    family,
    family_member,
    frequencies,
    over_stroke,
    stroke_of,
)
from validation.published_statements import Claim, ClaimedCurve, summary
from validation.report.published_statements import StatementTable
from validation.run.outcome import judge
from validation.run.records import claims_of, run_record

# Whether a curve holds as printed, and as corrected.
YES, NO, PRINTED, CORRECTED = (True, True), (False, False), (True, False), (False, True)


@pytest.mark.parametrize(
    ("curves", "standing"),
    [
        ((YES, YES), "both"),
        ((YES, PRINTED), "as printed alone"),
        ((CORRECTED,), "as corrected alone"),
        ((YES, NO), "in part"),
        ((PRINTED, CORRECTED), "in part"),
        ((NO, NO), "neither"),
    ],
)
def test_claim_holds_if_all_its_curves_hold(curves, standing):
    """As printed, as corrected, both or neither."""
    claimed = tuple(
        ClaimedCurve("", "1", 1.0, printed, 2.0, corrected) for printed, corrected in curves
    )
    assert Claim("it does", "§1", "distance", claimed).standing == standing


@pytest.fixture(scope="module")
def outcomes():
    context = Context(IFW, "quick")
    cases = (case for case in paper.cases() if "quick" in case.presets)
    return [judge(case, case.compute(context), 0.0) for case in cases]


@pytest.fixture(scope="module")
def claims(outcomes) -> dict[str, Claim]:
    return {claim.sentence: claim for claim in claims_of(outcomes)}


def claim_starting(claims: dict[str, Claim], start: str) -> Claim:
    (claim,) = (claim for sentence, claim in claims.items() if sentence.startswith(start))
    return claim


@pytest.mark.parametrize(
    ("start", "standing", "holding"),
    [
        # 5.2 % with the printed layout, below 0.01 % with half springs at the ends (physics notes).
        ("With 20 elements", "as corrected alone", (0, 1, 1)),
        ("Rigid segments: the second mode is due", "as printed alone", (1, 0, 1)),
        ("The feet's stiffness", "circular", (0, 1, 1)),
        # At the ends of the stroke one drive alone carries the platform, for every leg length.
        ("Longer legs: smaller planar", "in part", (1, 1, 6)),
        ("Simplified model: longer legs", "in part", (1, 1, 3)),
        ("Rigid segments: longer legs", "as printed alone", (6, 5, 6)),
    ],
)
def test_claim_counts_its_valid_curves(claims, start, standing, holding):
    """Numbers of curves that hold as printed and as corrected, for some claims of the paper."""
    claim = claim_starting(claims, start)
    assert (claim.printed, claim.corrected, len(claim.curves)) == holding
    assert claim.standing == standing


def test_summary_excludes_circular_claims(claims):
    """A claim is circular if it was used to correct the data."""
    assert summary(claims.values()) == (
        "22 statements: 17 true as printed and as corrected, 2 true only as printed, 1 true only "
        "as corrected, 2 true only for some of their curves; 1 circular and not counted."
    )


def test_layout_and_eq_25_change_claims(claims):
    """The claims on layout and eq. (25) have other values as printed than as corrected."""
    (layout,) = claim_starting(claims, "With 20 elements").curves
    assert layout.printed == pytest.approx(1.05 * 181.8, rel=2e-3)
    assert layout.corrected == pytest.approx(181.8, rel=1e-3)
    # With joints that turn freely both feet and tension of leg 1 have more of the strain energy.
    rank = claim_starting(claims, "Rigid segments: the second mode is due").curves[0]
    assert (rank.printed, rank.corrected) == (1.0, 4.0)


# Value, reference from the paper and tolerance. Values are earlier ones of this project, confirmed
# to a tenth of the tolerance by independent hand calculations.
STATED = {
    "foot-stiffness": (1.063611, 1.0, 0.1),
    "simplified.largest-deflection": (1.062934, 1.1, 0.05),
    "simplified.x-zero-at-ends": (0.0, 0.0, 1e-6),
    "simplified.y-largest-at-ends": (0.0, 0.0, 1.25),
    "refined.planar-ratio": (8.308295, 10.0, 2.9),
    "refined.z-ratio": (3.160078, 3.0, 0.5),
    "refined.profile-x": (52.5, 50.0, 10.0),
    "refined.profile-y": (58.75, 47.5, 15.0),
    "simplified.first-frequency": (713.4229, 710.0, 5.0),
    "refined.first-mode-along-z": (96.89673, 100.0, 5.0),
    "refined.second-mode-planar": (99.99979, 100.0, 5.0),
    "refined.second-mode-leg1": (1.0, 1.0, 0.5),
    "refined.leg1-beam": (181.8062, 180.0, 5.0),
    "refined.twenty-elements": (181.8221, 181.8062, 1.818062),
    "refined.order-of-magnitude": (-0.2130366, 0.0, 0.5),
    "refined.actuators-alone": (0.0, 0.0, 0.5),
    "family.planar-falls": (-1.0, -1.0, 0.005),
    "family.simplified-rises": (1.0, 1.0, 0.005),
    "family.z-rises[left]": (1.0, 1.0, 0.005),
    "family.refined-falls[right]": (-1.0, -1.0, 0.005),
    "family.lowest-two[centre]": (0.0, 0.0, 0.5),
    "family.other-directions-null": (0.2496125, 0.0, 1.0),
    "family.shorter-is-best": (1.0, 1.9, 0.05),
    "decision.longest": (2.0, 2.0, 0.1),
}


def test_statement_values_equal_confirmed_ones(outcomes):
    """Value, reference and tolerance equal earlier ones, confirmed by hand calculations."""
    for outcome in outcomes:
        assert_agrees_and_can_disagree(outcome)
    outcome_by_id = {outcome.case.id.removeprefix("paper."): outcome for outcome in outcomes}
    for name, expected in STATED.items():
        outcome = outcome_by_id[name]
        measured = outcome.measurement
        numbers = (measured.value, measured.reference, outcome.tolerance)
        assert numbers == pytest.approx(expected, rel=1e-6, abs=1e-12), name


def test_results_and_report_have_all_statements(outcomes, claims):
    """Records in results.json and rows of the page's table, in order."""
    records = run_record({}, outcomes, ()).statements
    assert [record["statement"] for record in records] == list(claims)
    assert {"as_printed", "as_corrected"} <= set(records[0]["curves"][0])
    table = StatementTable(tuple(claims.values()))
    assert len(table.csv.splitlines()) == 1 + sum(len(claim.curves) for claim in claims.values())
    planar = claim_starting(claims, "Longer legs: smaller planar")
    (((_, corrected), holds, _),) = (row for claim, *row in table.rows if claim is planar)
    assert (holds, corrected.text, corrected.verdict) == ("in part", "1 of 6 curves", "inadequate")


def drive_compliance(stroke, x):
    """Compliance (m/N, 2×2) of the tool point B in x and y: rigid legs, drives of 1e9 N/m.

    For a slide at (p, y_A) with |B − A| = L: (x − p) δx + s (δy − δy_A) = 0, s the leg's height.
    """
    heights = np.sqrt([stroke.length1**2 - x**2, stroke.length2**2 - (stroke.a - x) ** 2])
    arms = np.column_stack([[x, x - stroke.a], heights])
    from_slides = np.linalg.solve(arms, np.diag(heights))
    return from_slides @ from_slides.T / 1.0e9


@pytest.mark.parametrize("fraction", [0.1, 0.8])
def test_simplified_family_equals_rigid_legs(fraction):
    """Deflections and frequencies equal those of the compliance J K⁻¹ Jᵀ and a mass of 46 kg.

    Eqs (1), (2) and, corrected by the balance of work, (12).
    """
    members = family(IFW, fraction, (1.1, 1.25))
    deflection = deflections("simplified", members)
    first = frequencies("simplified", members, 1)[:, 0]
    original = stroke_of(IFW.mechanism)
    for index, alpha in enumerate((1.1, 1.25)):
        stroke = stroke_of(family_member(IFW, alpha).mechanism)
        assert stroke.length == pytest.approx(original.length)
        assert [stroke.length1, stroke.length2] == pytest.approx([alpha * 0.85, alpha * 0.775])
        x = stroke.ends[0] + fraction * stroke.length
        compliance = drive_compliance(stroke, x)
        planar = np.linalg.norm(compliance, axis=0) * 1e9
        computed = [deflection.planar_x[index], deflection.planar_y[index]]
        assert computed == pytest.approx(planar, rel=1e-9)
        largest = np.linalg.eigvalsh(compliance)[-1]
        expected = 1.0 / np.sqrt(46.0 * largest) / (2.0 * np.pi)
        assert first[index] == pytest.approx(expected, rel=1e-9)
    assert np.isnan(deflection.along_z).all()


def test_longer_legs_are_softer_along_z():
    """Values calculated by hand at the centre for legs of 1 and 2 times the length."""
    slender = ModelOptions(legs="equivalent", theory="euler-bernoulli")
    deflection = deflections("vjm", family(IFW, 0.5, (1.0, 2.0)), slender)
    assert deflection.planar_x == pytest.approx([7.3, 3.0], abs=0.05)
    assert deflection.along_z == pytest.approx([23.0, 85.0], abs=0.5)


def test_simplified_model_is_rigid_along_x_at_end():
    """There √(k/m)/2π = 742 Hz along y is the only frequency."""
    stroke = stroke_of(IFW.mechanism)
    for x in stroke.ends:
        assert_allclose(drive_compliance(stroke, x)[0], 0.0, atol=1e-16)
    end_frequencies = frequencies("simplified", over_stroke(IFW.mechanism, 2), 2)
    assert_allclose(end_frequencies[:, 0], np.sqrt(1.0e9 / 46.0) / (2.0 * np.pi), rtol=1e-7)
    assert np.isinf(end_frequencies[:, 1]).all()


def test_impossible_family_member_is_refused():
    """α = 0.4 is too short; the printed foot is indefinite."""
    with pytest.raises(InputError, match=r"geometry\.alpha"):
        family_member(IFW, 0.4)
    with pytest.raises(InputError, match="foot"):
        IFW.with_values({"foot.compliance[6,6]": 3.16e-9})


def test_cosine_spacing_has_ends_and_centre():
    """21 positions over the stroke, from 0.145 to 0.85 m."""
    x = cosine_spaced(0.145, 0.85, 21)
    assert (x[0], x[10], x[-1]) == pytest.approx((0.145, 0.4975, 0.85), rel=1e-12)
    assert (np.diff(x) > 0.0).all()
    # The robot reaches every position: rounding puts none outside the stroke.
    postures = RobotOnStroke(IFW.mechanism, x).postures
    assert [posture.pose[0] for posture in postures] == pytest.approx(x)


@pytest.mark.exhaustive
def test_figure_has_release_of_eq_25_as_printed():
    """f2 at the centre: 184 Hz, about 300 Hz with joints released by eq. (25) as printed."""
    figure = frequencies_over_the_stroke(Context(IFW, "quick"))
    centre = list(csv.DictReader(io.StringIO(figure.data)))[10]
    # Values of an independent computation: 184 Hz, and about 300 Hz as printed.
    for column, number, tolerance in (
        ("x (m)", 0.4975, 1e-6),
        ("beam FE: frequency 2 (Hz)", 184.0, 0.005),
        ("segments, eq. (25) as printed: frequency 2 (Hz)", 300.0, 0.02),
    ):
        assert float(centre[column]) == pytest.approx(number, rel=tolerance)
    assert figure.svg.startswith("<svg")


def test_planned_figures_can_be_pickled():
    """Workers draw figures, so that their plans are sent to other processes."""
    figures = pickle.loads(pickle.dumps(paper.figures()))  # noqa: S301  our own
    assert len({figure.id for figure in figures}) == len(figures) == 4


LEG_1, LEG_2 = map(equivalent_leg, legs_of(IFW.mechanism).values())
FINDINGS = {
    (finding.where, finding.check): finding
    for finding in paper_findings(IFW)
    if finding.kind == "computed"
}
# A, L1, L2 (m), and B in the centre of the stroke.
A, L1, L2, CENTRE = 0.92, 0.85, 0.775, 0.4975
# Length (m) of an element of leg 1 with 20 elements, and a rotation of 1 mrad.
ELEMENT_LENGTH, ROTATION = L1 / 20.0, 1e-3
# β₁L of a clamped-free beam.
ROOT = 1.8751040687


def evidence(where: str, check: str) -> str:
    return FINDINGS[where, check].evidence


def test_caption_erratum_gives_stroke_ends():
    """The erratum on the captions of Figs 6c, 12c, 13c has L1 − a and the ends of the stroke."""
    assert evidence("captions of Figs 6c, 12c, 13c", "caption") == (
        f"L1 − a = {L1 - A:.3g} m, the stroke goes from {A - L2:.3g} to {L1:.3g} m"
    )


def test_foot_misprint_changes_y_stiffness():
    """c66 of the foot as printed and as corrected: (k⁻¹)₂₂, and y with a free joint by eq. (25)."""
    printed, used = (
        np.array(tables["foot"]["compliance"]) for tables in (as_printed(IFW), IFW.tables)
    )
    printed_stiffness, corrected = np.linalg.inv(printed), np.linalg.inv(used)
    foot = FINDINGS["foot.compliance", "stiffness along y"]
    assert foot.printed.startswith(f"c66 = {printed[5, 5]:.3g} ")
    assert foot.evidence == (
        f"(k⁻¹)₂₂ = {printed_stiffness[1, 1]:.3g} N/m as printed, "
        f"{corrected[1, 1]:.4g} N/m as corrected"
    )
    # With a free joint no moment about z acts: the inverse without row and column 6.
    free = np.linalg.inv(used[:5, :5])[1, 1]
    assert evidence("eq. (25)", "joint release") == (
        f"the foot resists y with {printed_release(corrected)[1, 1]:.3g} N/m as printed, "
        f"{free:.3g} N/m with a free joint; 1/c22 = {1.0 / used[1, 1]:.3g} N/m"
    )


def test_longitudinal_erratum_states_frequency_ratio():
    """The erratum states the ratio of longitudinal to bending frequency of a clamped-free beam:

    π/2L √(EA/μ) over (1.8751/L)² √(EI/μ).
    """
    ratios = [
        f"{np.pi / 2.0 * leg.length * np.sqrt(beam.EA / stiffness) / ROOT**2:.2g} "
        f"(leg {number}, bending {plane})"
        for number, leg in enumerate((LEG_1, LEG_2), start=1)
        for beam in [leg.properties("euler-bernoulli")]
        for plane, stiffness in (("z", beam.EIz), ("y", beam.EIy))
    ]
    assert evidence("§1", "longitudinal frequencies").endswith(f": {', '.join(ratios)}")


def test_eq_12_as_printed_has_wrong_stiffness():
    """Reference: A t = B q̇ solved by hand, drives of 1e9 and 2e9 N/m, platform of 46 kg."""
    s1, s2 = np.sqrt(L1**2 - CENTRE**2), np.sqrt(L2**2 - (A - CENTRE) ** 2)
    J = np.linalg.solve(np.array([[CENTRE, s1], [CENTRE - A, s2]]), np.diag([s1, s2]))
    K, inverse = np.diag([1e9, 2e9]), np.linalg.inv(J)
    exact = np.linalg.inv(J @ np.linalg.inv(K) @ J.T)
    printed, balanced = inverse @ K @ inverse.T, inverse.T @ K @ inverse

    assert balanced == pytest.approx(exact, rel=1e-12)
    first, exact_first = (
        np.sqrt(np.linalg.eigvalsh(stiffness)[0] / 46.0) / (2.0 * np.pi)
        for stiffness in (printed, exact)
    )
    error = np.linalg.norm(printed - exact) / np.linalg.norm(exact)
    assert evidence("eq. (12)", "work balance") == (
        f"at the centre with drives of {1e9:.0e} and {2e9:.0e} N/m the inverse of eq. (1) is "
        f"missed by {error:.0%} as printed, by rounding alone with J⁻ᵀKJ⁻¹; f1 = "
        f"{first:.1f} in place of {exact_first:.1f} Hz; equal drives give the "
        "same f1"
    )


def test_layout_misprint_gives_order_one():
    """First frequency of leg 1 against Euler–Bernoulli's cantilever, with 20 and 40 segments."""
    beam = LEG_1.properties("euler-bernoulli")
    exact = ROOT**2 / (2.0 * np.pi * L1**2) * np.sqrt(beam.EIz / beam.mu)
    coarse, fine = (
        clamped_modes(segment_leg(segment_chain(beam, L1, n, "literal")), 1).frequencies[0] / exact
        - 1.0
        for n in (20, 40)
    )
    assert evidence("§3.2", "literal layout") == (
        f"at m = 20 leg 1 bends from {1e3 * ELEMENT_LENGTH / 2.0:.3g} mm beyond its root and its "
        f"first frequency is {coarse:.1%} too high, at m = 40 {fine:.1%} "
        f"(order {np.log2(coarse / fine):.2f})"
    )


def test_spring_errata_have_energies_of_one_spring():
    """Energies ½ uᵀKu of one spring (EA/l, 12EI/l³, EI/l) in rigid rotation and in bending."""
    beam = LEG_1.properties("euler-bernoulli")
    axial, shear = beam.EA / ELEMENT_LENGTH, 12.0 * beam.EIz / ELEMENT_LENGTH**3
    cosine = CENTRE / L1
    # Arms along x in place of the leg: u = lφ ((1 − cos α) n − sin α d).
    stiffness = axial * (1.0 - cosine**2) + shear * (1.0 - cosine) ** 2
    rigid = 0.5 * (ELEMENT_LENGTH * ROTATION) ** 2 * stiffness
    assert f"stores {rigid:.3g} J in one spring" in evidence("eqs (17), (18)", "lever arms")
    bending = 0.5 * beam.EIz / ELEMENT_LENGTH * ROTATION**2
    assert evidence("eqs (19), (20)", "small rotations").endswith(f"in truth {bending:.3g} J")
    # The arm is l/2 too long: ½ · 12EI/l³ · (φl/2)².
    assert f"stores {3.0 * bending:.3g} J as printed" in evidence("eq. (23)", "neighbour index")
    assert len(FINDINGS) == 9


def test_text_errata_are_notes():
    """Errata of kind "read", such as that on eq. (10), have the severity "note"."""
    findings = [finding for finding in paper_findings(IFW) if finding.kind == "read"]
    assert any("§3.3" in finding.where and "eq. (10)" in finding.used for finding in findings)
    assert {finding.severity for finding in findings} == {"note"}


def test_copied_robot_has_no_errata(tmp_path):
    """Errata belong to the built-in robot of the paper alone."""
    path = tmp_path / "copy.toml"
    path.write_text(IFW.text, encoding="utf-8")
    for robot in ("biglide", "five-bar", path):
        assert paper_findings(load_robot(robot)) == ()
