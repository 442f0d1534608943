"""Verdicts on responses: peaks and sizes against solids, and what a model without losses misses."""

from dataclasses import replace

import numpy as np
import pytest
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from validation.adequacy.judgement import judged
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.robot import robot_subject
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.measured.matrix import measured_matrix
from validation.models.mechanism import mechanism_modes
from validation.models.options import ModelOptions
from validation.report.figures import responses
from validation.report.table import table_of
from validation.report.words import quantities_text

PATH = """
[path]
from = [-0.1]
to = [0.2]
count = 2
"""
ASKED = """
[[responses]]
name = "hit"
direction = [0.0, 0.0, 1.0]
from = 20.0
to = 300.0
count = 60
at = 40.0
"""
DAMPED = "[damping]\nratio = 0.02\n"
NAMES = ("response:hit", "response:hit.frequency", "response:hit.at")


@pytest.fixture(scope="module")
def arm(tmp_path_factory) -> RobotFile:
    folder = tmp_path_factory.mktemp("responses")
    return robot_of(ONE_ARM + PATH + DAMPED + ASKED, folder)


@pytest.fixture(scope="module")
def subject(arm):
    return robot_subject(Context(arm, "quick"))


def test_errors_of_peaks_are_those_against_the_solid_of_solve(arm, subject):
    """Which differs from the reference by its mesh; solids are both within what is left open."""
    assert arm.requirement.quantities[-3:] == NAMES
    matrix = judged(subject, arm.requirement)
    postures = robot_on_path(Context(arm, "quick")).postures

    def of(model, **options):
        found = mechanism_modes(model, postures, 2, ModelOptions(**options))
        return np.array([one.responses[0].judged for one in found])

    truth = of("solid", divisions=4)
    for model, options in (
        ("segments", {}),
        ("beam", {}),
        ("beam-euler-bernoulli", {"theory": "euler-bernoulli"}),
    ):
        errors = of(model.partition("-")[0], **options) / truth - 1.0
        for column, name in enumerate(NAMES):
            entry = matrix.entry(model, name)
            told, left = np.array(entry.errors), np.array(entry.spreads)
            assert (np.abs(told - errors[:, column]) <= left + 2e-3).all(), (model, name)
            assert entry.limit == 0.05
    strict = replace(arm.requirement, response=1e-3)
    entry = judged(subject, strict).entry("beam-euler-bernoulli", "response:hit.frequency")
    assert entry.verdict == "inadequate"
    (first, *_) = entry.causes
    assert first.cause == "shear deformation and rotary inertia neglected"
    assert "--theory timoshenko" in entry.remedy


def test_a_limit_of_its_own_and_one_for_all(arm, subject):
    wanted = replace(arm.requirement, limits={NAMES[0]: 0.3}, response=0.01)
    matrix = judged(subject, wanted)
    assert [matrix.entry("beam", name).limit for name in NAMES] == [0.3, 0.01, 0.01]


def test_the_table_tells_peaks_in_micrometres_and_the_sentence_all_responses_at_once(arm, subject):
    matrix = judged(subject, arm.requirement)
    told = dict(zip(table_of(matrix).headings, table_of(matrix).robot, strict=True))
    peak, frequency, _ = (matrix.entry("beam", name).expected for name in NAMES)
    assert told["response hit"][0] == f"{1e6 * peak:.3g}\u00a0µm/N"
    assert told["response hit.frequency"][0] == f"{frequency:.3g}\u00a0Hz"
    assert quantities_text(matrix, NAMES) == "responses"


def test_the_chart_has_all_models_the_reference_and_its_band(arm):
    (planned,) = responses.figures(arm.mechanism)
    figure = planned.draw(Context(arm, "quick"))
    assert figure.id == "mechanism.response.hit"
    head, *rows = figure.data.splitlines()
    columns = head.split(",")
    for name in ("segments", "beam", "solid"):
        assert {f"{name}: size (m/N)", f"{name}: phase (°)"} <= set(columns)
    values = np.array([[float(one) for one in row.split(",")] for row in rows])
    assert len(values) == 60
    size, phase = (
        values[:, columns.index(f"solid: {what}")] for what in ("size (m/N)", "phase (°)")
    )
    assert ((phase <= 0.0) & (phase >= -180.0)).all()
    # Below its resonance the arm follows, above it goes against the force.
    assert phase[0] > -10.0 > -170.0 > phase[-1] or size.argmax() == len(size) - 1


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


def test_measured_peaks_are_compared_with_what_the_damping_leaves_open(tmp_path, arm):
    """A peak is as 1/2ζ, of which (1/0.9 − 1/1.1)/2 is a standard uncertainty of a tenth."""
    robot = robot_of(arm.text + MEASURED, tmp_path)
    matrix = measured_matrix(Context(robot, "quick"))
    (at,) = postures_of(robot.mechanism, np.zeros((1, 1)))
    for model, options in (("beam", ModelOptions()), ("segments", ModelOptions())):
        (found,) = mechanism_modes(model, [at], 2, options)
        size, frequency, _ = found.responses[0].judged
        entry = matrix.entry(model, "response:hit")
        assert (entry.unit, entry.value) == ("m/N", pytest.approx(size, rel=1e-9))
        assert entry.error == pytest.approx(size / 2.0e-5 - 1.0, rel=1e-9)
        spread = 1.96 * 0.5 * (1.0 / 0.9 - 1.0 / 1.1) * size / 2.0e-5
        assert entry.uncertainties["inputs"] == pytest.approx(spread, rel=2e-3)
        entry = matrix.entry(model, "response:hit.frequency")
        assert (entry.unit, entry.value) == ("Hz", pytest.approx(frequency, rel=1e-9))
        # As √(1 − 2ζ²).
        assert entry.uncertainties["inputs"] == pytest.approx(1.96 * 0.1 * 2.0 * 0.02**2, rel=0.2)
    assert matrix.entry("vjm", "response:hit") is None
    with pytest.raises(InputError, match=r"response:hut\": must be one of response:hit, respon"):
        robot_of(arm.text + MEASURED.replace("hit.frequency", "hut"), tmp_path)


LOSSES = """
[[responses]]
name = "turn"
direction = [1.0, 0.0, 0.0]
from = 5.0
to = 100.0
count = 20
"""


def test_a_model_whose_parts_lose_nothing_has_a_peak_without_bound(tmp_path):
    """The material alone loses: rigid bodies on the drive know nothing of it."""
    lossy = ONE_ARM.replace("rho = 7850.0 }", "rho = 7850.0, loss = 0.01 }")
    arm = robot_of(lossy + PATH + LOSSES, tmp_path)
    matrix = judged(robot_subject(Context(arm, "quick")), arm.requirement)
    entry = matrix.entry("simplified", "response:turn")
    assert (entry.verdict, entry.error) == ("inadequate", None)
    assert "nothing damps" in entry.reason
    assert matrix.entry("beam", "response:turn").verdict == "adequate"
