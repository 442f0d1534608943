"""Measured values of mechanisms: read, refused, and held against their models as a biglide's."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.acceptance.measured import Measured
from lumped.errors import InputError
from lumped.legs import tip_compliance
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from validation.catalogue import catalogue
from validation.context import Context
from validation.drawing.charts.plot import chart_svg
from validation.kinematics.poses import postures_of
from validation.measured.matrix import measured_matrix, predicted
from validation.models.legs import leg_compliance
from validation.models.mechanism import answers
from validation.models.options import ModelOptions
from validation.report.figures.measured import measured_curves

OWN = """
[[measured]]
quantity = "z"
pose = [0.1, 0.525]
load = 200.0
value = {z!r}
uncertainty = {u!r}
source = "dial gauge"

[[measured]]
quantity = "f1"
pose = [0.1, 0.525]
value = 62.0
uncertainty = 0.5
source = "impact hammer"

[[measured]]
quantity = "rod1.c22"
value = 1.0e-6
uncertainty = 1.0e-8
source = "stand"

[[input_uncertainty]]
key = "joints.motor1.drive.stiffness"
relative = 0.1
"""


def written(tmp_path, changed=("", "")):
    text = load_robot("five-bar").text + OWN.format(z=1.0e-4, u=1.0e-6).replace(*changed)
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_models_are_held_against_what_was_measured(tmp_path):
    robot_file = load_robot(written(tmp_path))
    mechanism = robot_file.mechanism
    at = postures_of(mechanism, np.array([[0.1, 0.525]]))
    matrix = measured_matrix(Context(robot_file, "quick"))
    (beam,) = answers("beam", at, 1)
    entry = matrix.entry("beam", "z")
    assert entry.value == pytest.approx(200.0 * beam.compliance[2, 2], rel=1e-12)
    assert entry.pose == (0.1, 0.525)
    # Of the 1e-4 m that were measured.
    assert entry.error == pytest.approx(entry.value / 1e-4 - 1.0, rel=1e-12)
    assert entry.errors == (entry.error,)
    assert matrix.entry("beam", "f1").value == pytest.approx(beam.frequencies[0], rel=1e-9)
    assert matrix.entry("vjm", "f1") is None
    # Second order: twenty segments leave 4/3 of what twice as many change.
    coarse, fine = (
        answers("segments", at, 1, ModelOptions(elements=number))[0].frequencies[0]
        for number in (20, 40)
    )
    left = matrix.entry("segments", "f1").uncertainties["numerics"]
    assert left == pytest.approx(4.0 / 3.0 * abs(coarse - fine) / 62.0, rel=1e-6)
    expected = leg_compliance("beam", legs_of(mechanism)["rod1"])
    assert matrix.entry("beam", "rod1.c22").value == pytest.approx(expected[1, 1], rel=1e-12)
    assert chart_svg(measured_curves(matrix).chart)
    assert "adequacy.measured" in {task.id for task in catalogue(robot_file)}


def test_inputs_are_a_standard_uncertainty_off_in_every_model(tmp_path):
    """The drive turns the first frequency by what solving both robots says."""
    robot_file = load_robot(written(tmp_path))
    ((key, _, below, above),) = robot_file.with_inputs_off()
    assert key == "joints.motor1.drive.stiffness"
    stiffness = [
        next(joint for joint in robot.joints if joint.name == "motor1").drive.stiffness
        for robot in (below, above)
    ]
    assert stiffness == pytest.approx([7.2e4, 8.8e4])
    entry = measured_matrix(Context(robot_file, "quick")).entry("simplified", "f1")
    low, high = (
        answers("simplified", postures_of(robot, np.array([[0.1, 0.525]])), 1)[0].frequencies[0]
        for robot in (below, above)
    )
    assert entry.uncertainties["inputs"] == pytest.approx(1.959964 * 0.5 * (high - low) / 62.0)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            ("[0.1, 0.525]", "[0.1]"),
            "pose: must hold as many numbers as the tool's moves (x, y; m, rad)",
        ),
        (("[0.1, 0.525]", "[0.9, 0.9]"), "measured[1].pose: five-bar, pose x = 0.9 m, y = 0.9 m"),
        (("rod1.c22", "rod7.c22"), 'measured[3].quantity = "rod7.c22": must be of one of crank1'),
        (("drive.stiffness", "drive.colour"), "input_uncertainty[1].key"),
        (("62.0", "0.0"), "measured[2].value = 0.0"),
    ],
)
def test_every_fault_is_named(tmp_path, changed, said):
    with pytest.raises(InputError) as raised:
        load_robot(written(tmp_path, changed))
    assert any(said in fault for fault in raised.value.faults), raised.value.faults


def test_virtual_joints_that_branch_have_no_number():
    robot_file = load_robot("delta")
    one = Measured("z", 1e-6, 1e-8, "gauge", tuple(robot_file.mechanism.poses[0]), 1.0)
    matrix = measured_matrix(Context(replace(robot_file, measured=(one,)), "quick"))
    assert matrix.entry("vjm", "z") is None
    assert matrix.entry("links", "z") is not None


def test_an_entry_of_a_leg_a_load_and_a_mode_are_those_that_were_measured():
    mechanism = load_robot("five-bar").mechanism
    leg = legs_of(mechanism)["rod1"]
    exact = tip_compliance(leg.timoshenko, leg.length)
    for i, j in np.ndindex(6, 6):
        one = Measured(f"rod1.c{i + 1}{j + 1}", 1e-6, 1e-8, "stand")
        for model in ("vjm", "beam"):
            found = predicted(model, mechanism, one, ModelOptions())
            assert found == pytest.approx(exact[i, j], rel=1e-9, abs=1e-18)
    pose = tuple(mechanism.poses[0])
    once, twice = (
        predicted("links", mechanism, Measured("y", 1.0, 1.0, "gauge", pose, load), ModelOptions())
        for load in (30.0, 60.0)
    )
    assert twice == pytest.approx(2.0 * once, rel=1e-12)
    third = predicted("beam", mechanism, Measured("f3", 1.0, 1.0, "hammer", pose), ModelOptions())
    (beam,) = answers("beam", postures_of(mechanism, np.array([pose])), 4)
    assert third == pytest.approx(beam.frequencies[2], rel=1e-6)
