"""CAD parts of a robot: half-widths of `solve`, and the error of each idealisation."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.robots.crane import write_crane
from support.robots.robot_from_text import robot_of

from lumped.mechanism.body import Body, ByCylinder, PartInterface
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from meshes.part.volume import RATIO
from validation.adequacy.judged_models import JUDGED, judged_models, why_unable
from validation.adequacy.robot_verdicts import robot_adequacy
from validation.cases import other_solvers
from validation.context import Context
from validation.models import reduced_parts
from validation.models.loads.pressures import resultants
from validation.models.loads.statics import displacements_of
from validation.models.robot_bodies import CUTOFF, dynamic_bodies
from validation.models.robot_models import answers
from validation.parts.meshes import MIDDLE
from validation.references import mesh_uncertainty
from validation.references.reference_parts import reduction_note, solid_parts
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import holding, path_postures, robot_on_path
from validation.responses.statics_and_modes import PathModes
from validation.run.outcome import judge
from validation.solve import solved_model
from validation.solve.answer import Solution
from validation.solve.answer_text import as_text
from validation.solve.model_answers import solve
from validation.solve.question import Question

COUNT = 4


@pytest.fixture(scope="module", autouse=True)
def coarsest(coarse_parts):
    """Use meshes even coarser than `coarse_parts`, to save time."""
    coarse_parts.setattr(reduced_parts, "UNKNOWNS", 3_000)


@pytest.fixture(scope="module")
def crane(tmp_path_factory):
    return load_robot(write_crane(tmp_path_factory.mktemp("crane")))


def answer_of(robot, count=COUNT, **options):
    (answer,) = solve(Question(robot, "solid", options, count)).answers
    return answer


def values(compliance, frequencies):
    return np.concatenate([np.diag(compliance), frequencies])


def solid_values(mechanism):
    solid = answers("solid", [reference_posture(mechanism)], COUNT)
    return values(solid.compliances[0], solid.frequencies[0])


@pytest.fixture(scope="module")
def crane_answer(crane):
    return answer_of(crane)


@pytest.fixture(scope="module")
def crane_values(crane_answer):
    return values(crane_answer.compliance, crane_answer.frequencies)


@pytest.mark.soak
def test_part_half_width_covers_finer_mesh(crane_answer, crane_values, crane, coarse_parts):
    """20 000 unknowns: at most one of the values changes by more than its half-width."""
    with coarse_parts.context() as patch:
        patch.setattr(reduced_parts, "UNKNOWNS", 20_000)
        finer = solid_values(crane.mechanism)
    differences = np.abs(finer - crane_values)
    half_widths = np.concatenate(
        [crane_answer.of_parts.compliance, crane_answer.of_parts.frequencies]
    )
    # Intervals of 95 %, from the coarsest ladder that this arm has: one of ten may miss.
    assert (differences <= half_widths).sum() >= len(differences) - 1
    assert (differences <= 1.5 * half_widths).all()
    # Worth something: percents of a mesh this coarse, not more.
    assert (half_widths <= 0.1 * crane_values).all()


def test_f1_uncertainty_ignores_mode_count(crane, monkeypatch):
    """Made-up modes: errors of 1 % decrease with order 1 for the lowest mode, faster for others."""
    shapes, falls = np.eye(12), RATIO ** np.linspace(1.0, 2.0, 12)

    def modes_on(robot, reading):
        frequencies = 100.0 * np.arange(1, 13) * (1.0 + 0.01 / falls**reading.part_mesh)
        repeated = (np.array([array] * len(robot.postures)) for array in (frequencies, shapes))
        return PathModes(*repeated, np.ones(12), np.ones((len(robot.postures), 12)))

    solids = Model("solid", modes=modes_on, modal_fields=("part_mesh",))
    monkeypatch.setattr(mesh_uncertainty, "SOLID", solids)
    half_widths = []
    for count in (2, 3, 4, 6):
        requirement = replace(crane.requirement, modes=count)
        robot = robot_on_path(Context(replace(crane, requirement=requirement), "quick"))
        frequency_half_widths = mesh_uncertainty.frequency_half_widths(
            Responses(robot), robot.first_reading
        )
        half_widths.append(frequency_half_widths[:, :2])
    assert half_widths[1:] == [pytest.approx(half_widths[0], rel=1e-9)] * 3


@pytest.mark.soak
def test_accuracy_option_refines_part_meshes(crane, coarse_parts):
    """0.8 times the largest half-width is requested and reached; values change within both."""
    with coarse_parts.context() as patch:
        patch.setattr(reduced_parts, "UNKNOWNS", 1500)
        rough = answer_of(crane, 0)
        half_widths = rough.of_parts.compliance / np.diag(rough.compliance)
        accuracy = 0.8 * float(half_widths.max())
        finer = solve(Question(crane, "solid", {}, 0, accuracy=accuracy))
    assert finer.accuracy.reached <= accuracy
    assert finer.accuracy.missed == ""
    (refined,) = finer.answers
    # Other meshes, whose intervals meet those of the coarser ones; one of ten may miss.
    differences = np.abs(np.diag(refined.compliance - rough.compliance))
    assert (differences > 0.0).all()
    assert (differences <= rough.of_parts.compliance + refined.of_parts.compliance).sum() >= 5
    assert (differences <= 1.5 * rough.of_parts.compliance).all()


def test_coupling_half_width_is_its_effect(crane_answer, crane_values, crane):
    """Half-width of an unspecified coupling: difference of averaged from rigid interfaces."""
    text = crane.text.replace(" } }", ' }, coupling = "average" }')
    average = robot_of(text, Path(crane.source).parent).mechanism
    bracket = np.concatenate(
        [crane_answer.of_parts.bracket.compliance, crane_answer.of_parts.bracket.frequencies]
    )
    # Interfaces of which nothing is said are rigid.
    assert bracket == pytest.approx(solid_values(average) - crane_values, rel=1e-6)
    assert reduced_parts.has_specified_couplings(average.parts["arm"])
    assert not reduced_parts.has_specified_couplings(crane.mechanism.parts["arm"])
    # An averaged interface is the softer one.
    assert (bracket[:6] > 0.0).all()
    assert (bracket[6:] < 0.0).all()


@pytest.mark.parametrize("interfaces", ["fixed", "free"])
def test_omitted_modes_are_within_bound(crane_answer, crane, interfaces):
    """Omitted modes of a part raise frequencies by zero to the stated bound."""
    answer = crane_answer if interfaces == "fixed" else answer_of(crane, reduction="free")
    ((count, below),) = answer.of_parts.counted.values()
    highest = 4.0 * below / CUTOFF["solid"]
    arm = dynamic_bodies("solid", crane.mechanism, highest)["arm"]
    assert arm.counted > count
    posture = reference_posture(crane.mechanism)
    exact = modes(solved(assembly(crane.mechanism, {"arm": arm}).at(posture)), COUNT).frequencies
    too_high, rounding = answer.frequencies - exact, 1e-9 * exact
    assert (too_high >= -rounding).all()
    assert (too_high <= answer.of_parts.reduction + rounding).all()
    assert (answer.of_parts.reduction < 1e-3 * exact).all()
    text = as_text(Solution("crane", "solid", {}, (answer,)))
    assert (
        f"modes of the parts with interfaces {interfaces}, all kept and confirmed by a mode count"
        in text
    )


def test_part_solution_is_its_compliance(crane_answer, crane):
    """Without modes, `solve` has the compliance of the CAD part itself, with its uncertainty."""
    static = answer_of(crane, 0)
    assert static.compliance == pytest.approx(crane_answer.compliance, rel=1e-6, abs=1e-15)
    assert static.of_parts.compliance == pytest.approx(crane_answer.of_parts.compliance, rel=1e-4)
    share = crane_answer.of_parts.compliance / np.diag(crane_answer.compliance)
    assert ((share > 1e-6) & (share < 0.1)).all()


def test_pressure_has_half_width_of_part_meshes(crane):
    """The half-width of a deflection by pressure covers its change on the next coarser mesh."""
    faces = "plane = { normal = [0.0, 0.0, 1.0], point = [0.0, 0.0, 0.02] }"
    load = f'name = "press"\npressures = [{{ body = "arm", pressure = 1.0e6, {faces} }}]'
    pressed = robot_of(f"{crane.text}\n[[loads]]\n{load}\n", Path(crane.source).parent)
    answer = answer_of(pressed, 0)
    deflection, half_width = answer.loads["press"][2], answer.of_parts.loads["press"][2]
    arm = pressed.mechanism.parts["arm"]
    cutoffs = solved_model._LOWEST, CUTOFF["solid"] * solved_model._LOWEST
    coarser = {"arm": reduced_parts.reduced(arm, *cutoffs, MIDDLE)}
    change = displacements_of(coarser, [reference_posture(pressed.mechanism)])[0, 0, 2] - deflection
    assert 0.0 < abs(change) <= half_width <= 0.2 * abs(deflection)
    # The upper side of a trapezoid of 120 and 25 mm, 475 mm long, less both bores, 3 % of it. Few
    # parabolas in place of their circles miss 1 % of those.
    area = 0.475 * 0.0725 - np.pi * (0.016**2 + 0.010**2)
    (total,) = resultants(pressed.mechanism)["press"]
    assert total.force == pytest.approx([0.0, 0.0, -1.0e6 * area], rel=1e-3, abs=1e-3)


def test_load_and_compliance_share_half_width(crane):
    """A unit load and the compliance have equal half-widths of the coupling.

    Those of the mesh differ by less than a factor of two: they use different orders.
    """
    push = '[[loads]]\nname = "push"\nwrench = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]\n'
    answer = answer_of(robot_of(f"{crane.text}\n{push}", Path(crane.source).parent), 0)
    np.testing.assert_allclose(answer.loads["push"], answer.compliance[:, 1], rtol=1e-9, atol=1e-16)
    half_widths, bracket = answer.of_parts, answer.of_parts.bracket
    assert bracket.loads["push"][1] == pytest.approx(bracket.compliance[1], rel=1e-6)
    assert 0.5 < half_widths.loads["push"][1] / half_widths.compliance[1] < 2.0


def test_part_modes_have_partners(crane):
    """First mode of the crane by solids and by segments, MAC above 0.95."""
    (answer,) = solve(Question(crane, "solid", {}, 2, against="segments")).answers
    first = answer.paired.pairs[0]
    # An equivalent leg swings alike, at a frequency of its own.
    assert first.partner == 1
    assert first.mac > 0.95


@pytest.mark.parametrize("interfaces", ["fixed", "free"])
def test_incomplete_reduction_is_refused(crane, monkeypatch, interfaces):
    """A stored reduction that lacks one of the counted modes."""
    arm = crane.mechanism.bodies["arm"]
    complete = reduced_parts.reduced(arm, 1000.0, 2500.0, by=interfaces)
    entry = reduced_parts.reduced_entry(arm, 1000.0, 2500.0, by=interfaces)
    arrays = dict(entry.stored_arrays[entry.key])
    remaining = np.delete(np.arange(len(arrays["stiffness"])), 12)
    arrays |= {name: arrays[name][np.ix_(remaining, remaining)] for name in ("stiffness", "mass")}
    arrays["recovery"] = arrays["recovery"][:, remaining]
    monkeypatch.setattr(reduced_parts.CacheEntry, "value", lambda _: entry.read(arrays))
    message = f"arm, reduced: {complete.counted} modes were counted below 2500 Hz"
    with pytest.raises(reduced_parts.ComputationError, match=message):
        reduced_parts.reduced(arm, 1000.0, 2500.0, by=interfaces)


@pytest.fixture(scope="module")
def matrix(crane):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reduced_parts, "UNKNOWNS", 12_000)
        return robot_adequacy(Context(crane, "quick"))


@pytest.mark.soak
def test_uniform_leg_is_softer_than_tapered(crane, matrix):
    """Segments of one section in place of the tapered arm: over 10 % off in deflection along z."""
    assert [note.model for note in matrix.models] == list(judged_models(crane.mechanism))
    entry = matrix.entry("segments", "z")
    assert entry.verdict == "inadequate"
    assert entry.error > 0.1
    assert entry.causes[0].cause == "part replaced by a leg of one constant section"
    assert "--parts" in entry.remedy
    assert abs(entry.error_with_remedy) < abs(entry.error)
    # Its own sections, ten times along it, are nearer, on the other side: rigid up to the bores'
    # edges, where the part begins to yield.
    assert -entry.error < matrix.entry("segments-stepped", "z").along < 0.0
    assert matrix.entry("beam", "f1").error < -0.05


@pytest.mark.exhaustive
def test_condensed_part_matches_solid(matrix):
    """Exact with rigid interfaces; the error is the difference to averaged ones."""
    for model in ("vjm", "links", "segments-condensed"):
        for quantity in ("x", "y", "z"):
            entry = matrix.entry(model, quantity)
            # The model has its interfaces held rigidly, as one reading of the file has; the other,
            # averaged, is softer.
            assert set(entry.readings) == {"interfaces rigid", "interfaces averaged"}
            assert entry.readings["interfaces rigid"] == pytest.approx(0.0, abs=1e-9)
            assert entry.error == entry.readings["interfaces averaged"] > 0.0
            assert entry.along < 0.0
            assert (entry.low, entry.high) == (0.0, entry.error + entry.uncertainty)
            assert set(entry.uncertainties) == {"meshes", "coupling of the parts' interfaces"}
    first = matrix.entry("segments-condensed", "f1")
    # Guyan's mass adds its own, little where most of the mass sits on the tool.
    assert abs(first.error) <= first.uncertainty + 5e-3


def test_specified_coupling_has_no_uncertainty(crane):
    """`coupling` of all interfaces in the robot file leaves one reading."""
    mechanism = crane.mechanism
    assert list(holding(mechanism).alternatives) == ["interfaces rigid", "interfaces averaged"]
    arm = mechanism.bodies["arm"]
    radii = {"A": 0.016, "B": 0.010}
    interfaces = {
        name: PartInterface(ByCylinder(radius), "rigid") for name, radius in radii.items()
    }
    body = Body("arm", replace(arm.shape, interfaces=interfaces), arm.interfaces)
    settled = holding(replace(mechanism, bodies=dict(mechanism.bodies) | {"arm": body}))
    assert (settled.unspecified, settled.decides) == ("", "")
    assert list(settled.alternatives) == ["interfaces as in the robot file"]


def test_report_has_reduction_error(crane):
    """Number of modes kept, cut-off frequency, and bound of the omitted ones."""
    postures = path_postures(Context(crane, "quick"))
    (note,) = reduction_note(postures, 8, {"arm": "rigid"}, 4)
    (arm,) = solid_parts(postures, 8, {"arm": "rigid"}).values()
    assert f"arm {arm.counted} below {arm.cutoff:.4g} Hz; the omitted higher modes lower" in note
    # Reduced for eight frequencies, of the first four next to nothing is lost.
    assert note.endswith("frequencies by <\u00a01\u00a0×\u00a010⁻⁶\u00a0% at most")


def test_run_compares_both_part_reductions(crane):
    """The difference in frequency is within the sum of both bounds, below 0.1 %."""
    listed = {case.id: case for case in other_solvers.cases(mechanism=crane.mechanism)}
    case = listed["mechanism.parts.frequency[2]"]
    measurement = case.compute(Context(crane, "quick"))
    assert judge(case, measurement, 0.0).verdict == "agree"
    assert (
        0.0
        < measurement.value_uncertainty + measurement.reference_uncertainty
        < 1e-3 * measurement.value
    )


def test_part_of_three_interfaces_has_no_pieces():
    """Only a part between two interfaces can be divided into prismatic pieces."""
    rocker = load_robot(str(Path(__file__).parents[3] / "examples" / "rocker" / "robot.toml"))
    reason = why_unable(path_postures(Context(rocker, "quick")), JUDGED["segments-stepped"])
    assert reason.startswith("no part has exactly two interfaces")
