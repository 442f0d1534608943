"""Verdicts on loads and responses of the robot file, against errors computed by `solve`."""

from dataclasses import replace

import numpy as np
import pytest
from support.fakes.toy_responses import reference
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import LOADS, ONE_ARM

from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation.adequacy.judged_models import judged_model, judged_models, judged_models_of
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import robot_subject, static_subject
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.measured.matrix import measured_matrix
from validation.models.loads.stability import stabilities, stability_notes
from validation.models.loads.statics import displacements, impossible_poses
from validation.models.options import ModelOptions
from validation.models.robot_models import mechanism_modes
from validation.references.model_ladder import SOLID
from validation.references.reference import SAY_LINEAR, Source
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_on_path
from validation.report.figures import loads_and_responses
from validation.report.table import table_of
from validation.report.words import conditions, quantities_text

pytestmark = pytest.mark.usefixtures("coarse_legs")

HELD = ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "rigid"')
PATH = "[path]\nposes = [[-0.1], [0.2]]\n"
ASKED = """
[damping]
ratio = 0.02
[[responses]]
name = "hit"
direction = [0.0, 0.0, 1.0]
from = 20.0
to = 300.0
count = 60
at = 40.0
"""
OF_HIT = ("response:hit", "response:hit.frequency", "response:hit.at")
OF_LOADS = ("load:weight", "load:cutting", "load:stop")


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return robot_of(HELD + PATH + LOADS + ASKED, tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def subject(arm):
    return robot_subject(Context(arm, "quick"))


def test_load_and_peak_errors_match_solve(arm, subject):
    """The solids of `solve` differ from the reference only by their mesh."""
    names = [quantity.name for quantity in arm.requirement.quantities]
    assert [name for name in names if ":" in name] == [*OF_LOADS, *OF_HIT]
    matrix = verdict_matrix(subject, arm.requirement)
    postures = robot_on_path(Context(arm, "quick")).postures

    def answered(model, options):
        modes = mechanism_modes(model, postures, 2, options)
        peaks = np.array([answer.responses[0].judged for answer in modes])
        return displacements(model, postures, options)[:, :, :3], peaks

    due, high = answered("solid", ModelOptions(divisions=2))
    sizes = dict(zip(OF_LOADS, np.linalg.norm(due, axis=2).T, strict=True))
    largest = dict.fromkeys((*OF_LOADS, *OF_HIT), 0.0)
    for model in ("simplified", "vjm", "segments", "beam", "beam-euler-bernoulli"):
        judged = judged_models(arm.mechanism)[model]
        kind, options = judged.kind, judged.options
        solved_displacements = displacements(kind, postures, options)[:, :, :3]
        shares = np.linalg.norm(solved_displacements - due, axis=2) / np.linalg.norm(due, axis=2)
        errors = dict(zip(OF_LOADS, shares.T, strict=True))
        if model not in {"simplified", "vjm"}:
            errors |= zip(OF_HIT, (answered(kind, options)[1] / high - 1.0).T, strict=True)
        for name, error in errors.items():
            entry = matrix.entry(model, name)
            # The meshes of the two solids, one of which the spreads of deflections are about.
            tolerances = 1e-4 + (
                np.subtract(entry.highs, entry.errors) if name in OF_LOADS else 0.0
            )
            assert (np.abs(np.array(entry.errors) - error) <= tolerances).all(), (model, name)
            largest[name] = max(largest[name], np.max(np.abs(error) / tolerances))
            if name in OF_LOADS:
                expected = sizes[name][matrix.poses.index(entry.pose)]
                assert entry.expected == pytest.approx(expected, rel=5e-3)
            assert entry.limit == 0.05
    # Each quantity has a model whose error is far beyond what is left.
    assert min(largest.values()) > 5.0, largest
    matrix = verdict_matrix(subject, replace(arm.requirement, deflection=1e-4, response=1e-3))
    weight, hit = (
        matrix.entry("beam-euler-bernoulli", name)
        for name in ("load:weight", "response:hit.frequency")
    )
    assert (weight.verdict, hit.verdict) == ("undecided", "inadequate")
    assert weight.causes[0].cause == "shear deformation neglected"
    assert weight.causes[0].share == pytest.approx(1.0, abs=0.05)
    assert hit.causes[0].cause == "shear deformation and rotary inertia neglected"
    assert "--theory timoshenko" in hit.remedy


def test_impossible_load_pose_is_not_compared(tmp_path):
    """At its dead centre the arm can move along y only and cannot accelerate as load `stop`.

    Its displacement was formerly taken as zero for model and reference.
    """
    robot = robot_of(HELD + "[path]\nposes = [[0.1], [0.5]]\n" + LOADS, tmp_path)
    robot_path = robot_on_path(Context(robot, "quick"))
    assert [impossible_poses(robot_path.postures, load) for load in robot.mechanism.loads] == [
        0,
        0,
        1,
    ]

    def entries(poses):
        path = replace(robot_path, postures=[robot_path.postures[pose] for pose in poses])
        beam = judged_model(path, "beam", judged_models(robot.mechanism)["beam"])
        matrix = verdict_matrix(static_subject(path, [beam]), robot.requirement)
        compared = [matrix.entry("beam", name) for name in ("load:stop", "load:weight")]
        return *compared, conditions(matrix)

    stop, weight, condition = entries([0, 1])
    assert (stop.verdict, weight.verdict) == ("adequate", "adequate")
    assert (stop.pose, stop.errors[1]) == ((0.1,), None)
    assert 0.0 < stop.error == stop.errors[0]
    # Without this sentence beside the verdict, it would be read as one on the whole path.
    assert condition == (
        "Adequate for load stop in 1 of 2 poses: there is no comparison in the others."
    )
    # Without a pose that can follow, nothing is compared: this was adequate with an error of zero.
    stop, weight, condition = entries([1])
    assert not condition
    assert (stop.verdict, stop.error, weight.verdict) == ("undecided", None, "adequate")
    assert stop.reason == (
        "the tool cannot move as the load requires in any pose, so that nothing is compared"
    )


def test_limit_in_metres_replaces_relative(arm, subject):
    """[accept] displacement, in m, applies to loads; unit loads keep their relative limit."""
    requirement = replace(arm.requirement, deflection=1e-6, limits={OF_HIT[0]: 0.3}, response=0.01)
    matrix = verdict_matrix(subject, requirement)
    assert [matrix.entry("beam", name).limit for name in OF_HIT] == [0.3, 0.01, 0.01]
    entry = matrix.entry("simplified", "load:cutting")
    missed = entry.error * entry.expected
    for limit, verdict in ((2.0 * missed, "adequate"), (0.5 * missed, "inadequate")):
        matrix = verdict_matrix(subject, replace(requirement, displacement=limit))
        load_entry = matrix.entry("simplified", "load:cutting")
        assert load_entry.verdict == verdict
        assert load_entry.limit == pytest.approx(limit / load_entry.expected, rel=0.02)
        assert matrix.entry("simplified", "x").limit == 1e-6
    # Of two references the one that yields most has the smallest share in so many metres.
    (interpretation,) = subject.statics.interpretations
    due = subject.responses.statics(SOLID, interpretation.reading)
    two_references = replace(
        subject,
        responses=Responses(subject.responses.robot),
        statics=reference("solids", {"stiffer": due, "softer": 2.0 * due}),
        static_steps={},
    )
    matrix = verdict_matrix(two_references, replace(requirement, displacement=100.0 * missed))
    load_entry = matrix.entry("simplified", "load:cutting")
    pose_and_load = matrix.poses.index(load_entry.pose), OF_LOADS.index("load:cutting")
    displacement = due.load_displacements[pose_and_load][:3]
    assert load_entry.limit == pytest.approx(50.0 * missed / np.linalg.norm(displacement))


def test_displacements_are_in_micrometres(arm, subject):
    """Displacements are those under the load of the file, not under forces of 1000 N."""
    table = table_of(verdict_matrix(subject, arm.requirement))
    robot = dict(zip(table.headings, table.robot, strict=True))
    postures = robot_on_path(Context(arm, "quick")).postures
    solid_displacements = displacements("solid", postures, ModelOptions(divisions=2))[:, :, :3]
    lengths = 1e6 * np.linalg.norm(solid_displacements, axis=2).max(axis=0)
    for name, length in zip(OF_LOADS, lengths, strict=True):
        value, unit = robot[name.replace(":", " ")][0].split("\u00a0")
        assert unit == "µm"
        # Three digits are shown, and another mesh of the solid.
        assert float(value) == pytest.approx(length, rel=0.02), name


def test_table_shows_peaks_of_reference(arm, subject):
    """The row of the robot has peak and frequency of each response, its figure all models."""
    matrix = verdict_matrix(subject, arm.requirement)
    robot_row = dict(zip(table_of(matrix).headings, table_of(matrix).robot, strict=True))
    peak, frequency, _ = (matrix.entry("beam", name).expected for name in OF_HIT)
    assert robot_row["hit peak"][0] == f"{1e6 * peak:.3g}\u00a0µm/N"
    assert robot_row["hit peak frequency"][0] == f"{frequency:.3g}\u00a0Hz"
    assert (
        quantities_text(matrix, [quantity for quantity in matrix.quantities if quantity.harmonic])
        == "responses"
    )
    planned = {figure.id: figure for figure in loads_and_responses.figures(arm)}
    figure = planned["mechanism.response.hit"].draw(Context(arm, "quick"))
    head, *rows = figure.data.splitlines()
    columns = head.split(",")
    for name in ("segments", "beam", "solid"):
        assert {f"{name}: magnitude (µm/N)", f"{name}: phase (°)"} <= set(columns)
    values = np.array([[float(number) for number in row.split(",")] for row in rows])
    assert len(values) == 60
    size, phase = (
        values[:, columns.index(f"solid: {column}")] for column in ("magnitude (µm/N)", "phase (°)")
    )
    assert 0.6 * peak < 1e-6 * size.max() < peak
    # Below its resonance the arm follows, above it goes against the force.
    assert 0.0 >= phase[0] > -10.0 > -170.0 > phase[-1] >= -180.0


def test_mass_distribution_affects_only_weight(tmp_path):
    """The mass distribution in legs changes the displacement under weight, not under a force."""
    file = robot_of(load_robot("ifw").text + LOADS, tmp_path)
    mechanism = replace(file.mechanism, poses=file.mechanism.poses[::4])
    file = replace(file, text="", mechanism=mechanism)
    robot = robot_on_path(Context(file, "quick"))
    requirement = Requirement(deflection=0.005, loads=file.requirement.loads)
    links = judged_model(robot, "links", judged_models(mechanism)["links"])
    matrix = verdict_matrix(static_subject(robot, [links]), requirement)
    weight, push, stop = (matrix.entry("links", name) for name in OF_LOADS)
    # Links are the reference: from nothing to what other places of the mass make of it.
    assert weight.error == pytest.approx(0.0, abs=1e-9)
    assert (weight.low, weight.high) == (0.0, pytest.approx(weight.uncertainty, rel=1e-6))
    assert weight.uncertainties[Source.MASSES] > 0.01 > 10.0 * push.uncertainty
    assert Source.MASSES not in push.uncertainties
    assert weight.verdict == "undecided"
    assert weight.reason == robot.masses_instruction
    # At both ends of its stroke the robot cannot accelerate along x.
    assert stop.errors[0] is None is stop.errors[-1]
    assert stop.uncertainty > 0.0


def test_tension_stiffens_arm(tmp_path):
    """A pull of a fifth of the buckling load reduces the compliance by a sixth."""
    pull = '[[loads]]\nname = "pull"\nwrench = [10.0, 2.0e4, 0.0, 0.0, 0.0, 0.0]\n'
    arm = robot_of(HELD + "[path]\nposes = [[0.0]]\n" + pull, tmp_path)
    ((arm_stability,),) = stabilities("links", robot_on_path(Context(arm, "quick")).postures)
    assert arm_stability.extra_displacement == pytest.approx(-1.0 / 6.0, rel=0.1)


def test_softening_load_is_undecided(tmp_path):
    """A push of a fifth of the drive's buckling load k/L raises the compliance by 1/(5 − 1)."""
    press = '[[loads]]\nname = "press"\nwrench = [10.0, -2.0e4, 0.0, 0.0, 0.0, 0.0]\n'
    crush = press.replace("press", "crush").replace("-2.0e4", "-2.0e5")
    arm = robot_of(HELD + "[path]\nposes = [[0.0]]\n" + press + crush, tmp_path)
    robot = robot_on_path(Context(arm, "quick"))
    path_stabilities = stabilities("links", robot.postures)
    ((first_stability, _),) = path_stabilities
    assert first_stability.factor == pytest.approx(5.0, rel=0.1)
    assert first_stability.extra_displacement == pytest.approx(
        1.0 / (first_stability.factor - 1.0), rel=0.1
    )
    assert first_stability.stiffness_losses[0] == pytest.approx(
        1.0 / first_stability.factor, rel=0.1
    )
    note, _ = stability_notes(robot.postures, path_stabilities, arm.requirement)
    assert note.startswith("Load press: buckling at 4.")
    assert note.endswith(
        "effect that linear models neglect: more than the accepted 5\N{NO-BREAK SPACE}%"
    )
    # What takes less than a thousandth of the stiffness is not worth a line.
    small = replace(
        first_stability,
        stiffness_losses=first_stability.stiffness_losses * 1e-3,
        extra_displacement=first_stability.extra_displacement * 1e-3,
    )
    assert stability_notes(robot.postures, [[small, None]], arm.requirement) == ()
    matrix = verdict_matrix(
        static_subject(robot, judged_models_of(robot).values()), arm.requirement
    )
    pressed, free = (matrix.entry("vjm", quantity) for quantity in ("load:press", "x"))
    assert (pressed.verdict, free.verdict) == ("undecided", "adequate")
    assert pressed.reason == SAY_LINEAR
    assert pressed.uncertainties[Source.LINEARITY] == pytest.approx(
        first_stability.extra_displacement, rel=0.1
    )
    assert Source.LINEARITY not in free.uncertainties
    # Where it has buckled nothing is known.
    crushed = matrix.entry("vjm", "load:crush")
    assert crushed.uncertainties[Source.LINEARITY] == pytest.approx(1.0, rel=0.1)


MEASURED = """
[[measured]]
quantity = "response:hit"
value = 2.0e-5
uncertainty = 1.0e-7
source = "hammer"
pose = [0.0]
[[measured]]
quantity = "response:hit.frequency"
value = 130.0
uncertainty = 0.1
source = "hammer"
pose = [0.0]
[[input_uncertainty]]
key = "damping.ratio"
relative = 0.1
"""


def test_peak_includes_damping_uncertainty(tmp_path, arm):
    """The peak is proportional to 1/2ζ.

    A standard uncertainty of 10 % in ζ gives one of (1/0.9 − 1/1.1)/2 in the peak.
    """
    robot = robot_of(arm.text + MEASURED, tmp_path)
    matrix = measured_matrix(Context(robot, "quick"))
    (arm_posture,) = postures_of(robot.mechanism, np.zeros((1, 1)))
    for model in ("beam", "segments"):
        (arm_modes,) = mechanism_modes(model, [arm_posture], 2, ModelOptions())
        size, frequency, _ = arm_modes.responses[0].judged
        entry = matrix.entry(model, "response:hit")
        assert (entry.quantity.unit, entry.value) == ("m/N", pytest.approx(size, rel=1e-9))
        assert entry.error == pytest.approx(size / 2.0e-5 - 1.0, rel=1e-9)
        spread = 1.96 * 0.5 * (1.0 / 0.9 - 1.0 / 1.1) * size / 2.0e-5
        assert entry.uncertainties["inputs"] == pytest.approx(spread, rel=2e-3)
        entry = matrix.entry(model, "response:hit.frequency")
        assert (entry.quantity.unit, entry.value) == ("Hz", pytest.approx(frequency, rel=1e-9))
        # As √(1 − 2ζ²).
        assert entry.uncertainties["inputs"] == pytest.approx(1.96 * 0.1 * 2.0 * 0.02**2, rel=0.2)
    assert matrix.entry("vjm", "response:hit") is None
    with pytest.raises(InputError, match=r"response:hut\": must be one of response:hit, respon"):
        robot_of(arm.text + MEASURED.replace("hit.frequency", "hut"), tmp_path)


def test_undamped_model_has_unbounded_peak(tmp_path):
    """Only the material has losses, which a model of rigid bodies on drives does not contain."""
    lossy = HELD.replace("rho = 7850.0 }", "rho = 7850.0, loss = 0.01 }")
    response_table = (
        '[[responses]]\nname = "turn"\ndirection = [1.0, 0.0, 0.0]\nfrom = 5.0\nto = 100.0\n'
    )
    arm = robot_of(f"{lossy}[path]\nposes = [[0.0]]\n{response_table}count = 20\n", tmp_path)
    matrix = verdict_matrix(robot_subject(Context(arm, "quick")), arm.requirement)
    entry = matrix.entry("simplified", "response:turn")
    assert (entry.verdict, entry.error) == ("inadequate", None)
    assert "undamped peak" in entry.reason
    assert matrix.entry("beam", "response:turn").verdict == "adequate"
