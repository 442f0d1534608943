"""Validation uncertainty in the sense of ASME V&V 20: its parts, propagation, verdicts, models."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from lumped.acceptance.measured import Freedoms, Measured, MeasuredResponse, ModalTest
from lumped.acceptance.quantities import measured_quantity
from lumped.beam_properties import tip_compliance
from lumped.errors import ComputationError
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from validation.adequacy.probability import propagated
from validation.catalogue import catalogue
from validation.context import Context
from validation.drawing.plot import chart_svg
from validation.kinematics.poses import postures_of
from validation.measured.matrix import Comparison, Predictions, measured_matrix
from validation.models.options import ModelOptions
from validation.models.robot_models import answers
from validation.references import model_ladder
from validation.references.robot_on_path import NOMINAL
from validation.report.figures.adequacy import measured_curves
from validation.report.words import sentence

LOAD = 1000.0


def test_uncertainties_add_as_squares():
    """Numerics, inputs, measurement: 1.96 √(0.1² + 0.2² + 0.2²) over the size of the reference."""
    compared = Comparison(10.0, -8.0, 0.1, 0.2, 0.2)
    assert compared.error == pytest.approx(18.0 / 8.0)
    # 95 % of a standard uncertainty of 0.3.
    assert compared.uncertainty == pytest.approx(0.5879892 / 8.0)
    assert compared.uncertainties["numerics"] == pytest.approx(0.1959964 / 8.0)


def test_input_uncertainties_propagate_to_first_order():
    """Half the differences of two changed inputs, 0.01 and 0.04, by Pythagoras."""
    # y = a·b² with relative uncertainties 1 % and 2 %: √(1² + (2·2)²) % to first order.
    propagated_uncertainty = propagated([(0.99, 1.01), (0.98**2, 1.02**2)])
    assert propagated_uncertainty == pytest.approx(hypot(0.01, 0.04))
    assert propagated([]) == 0.0


def test_verdict_uses_whole_interval():
    """Limit of 5 %: adequate within, inadequate beyond, undecided across it."""
    for verdict, intervals in {
        "adequate": [(1.02, 0.001), (0.98, 0.001)],
        "inadequate": [(1.12, 0.001), (0.90, 0.001)],
        "undecided": [(1.04, 0.02), (1.00, 0.10), (1.06, 0.02), (0.94, 0.02)],
    }.items():
        for value, uncertainty in intervals:
            assert Comparison(value, 1.0, 0.0, 0.0, uncertainty).verdict(0.05) == verdict


def test_measured_values_are_references():
    """Each measured value is the reference of the models' values for the same pose and load."""
    robot_file = load_robot("biglide")
    robot = robot_file.mechanism
    (x,), (first,) = robot.reference_pose, robot.poses[0]
    measurement = Measured(measured_quantity("z"), 1.0, 1.0, "gauge", (x,), LOAD)
    predictions = Predictions.of(Context(robot_file, "quick"))
    truth = predictions.value("vjm", measurement)
    good = replace(measurement, value=truth, uncertainty=1e-3 * truth)
    wrong = replace(good, value=1.2 * truth, pose=(first,))
    of_leg = Measured(measured_quantity("leg1.c33"), 0.9, 1e-3, "stand")

    def matrix_of(*measurements):
        return measured_matrix(Context(replace(robot_file, measured=measurements), "quick"))

    entry = matrix_of(good).entry("vjm", "z")
    assert (entry.verdict, entry.reference, entry.pose) == ("adequate", "measured: gauge", (x,))
    assert (entry.error, entry.uncertainty) == (0.0, pytest.approx(1.959964e-3))
    # Of several with one verdict in one pose the farthest off decides, in whatever order.
    farther = replace(good, value=truth / 0.98)
    for pair in ((good, farther), (farther, good)):
        entry = matrix_of(*pair).entry("vjm", "z")
        assert (entry.verdict, entry.error) == ("adequate", pytest.approx(-0.02))
        assert entry.errors == (entry.error,)
    # The worst of several poses decides; a leg's entry has none.
    matrix = matrix_of(good, wrong, of_leg)
    assert matrix.poses == ((first,), (x,))
    entry = matrix.entry("vjm", "z")
    assert (entry.verdict, entry.pose) == ("inadequate", (first,))
    predicted = predictions.value("vjm", wrong)
    assert entry.errors == pytest.approx([predicted / wrong.value - 1.0, 0.0])
    # Every pose has its own interval, of 95 %: the gauge alone is uncertain.
    halves = [1.959964 * 1e-3 * truth / abs(measured.value) for measured in (wrong, good)]
    assert entry.lows == pytest.approx(np.subtract(entry.errors, halves), rel=1e-6)
    assert entry.highs == pytest.approx(np.add(entry.errors, halves), rel=1e-6)
    assert entry.values == pytest.approx([predicted, truth])
    assert (entry.low, entry.high) == (entry.lows[0], entry.highs[0])
    entry = matrix.entry("beam", "leg1.c33")
    assert (entry.pose, entry.errors) == ((), (None, None))
    assert matrix.entry("simplified", "leg1.c33") is None
    assert chart_svg(measured_curves(matrix))
    assert "leg1.c33" in sentence(matrix)


def test_measured_leg_compliances_are_plotted():
    """Compliance entries of a leg belong to no pose, even if the robot has several poses."""
    biglide = load_robot("biglide")
    measurements = tuple(
        Measured(measured_quantity(f"leg1.{name}"), 1e-6, 1e-8, "stand") for name in ("c22", "c33")
    )
    matrix = measured_matrix(Context(replace(biglide, measured=measurements), "quick"))
    chart = measured_curves(matrix)
    assert [panel.title for panel in chart.panels] == ["leg1.c22", "leg1.c33"]
    for panel, quantity in zip(chart.panels, matrix.quantities, strict=True):
        values = {curve.label: curve.y[0] for curve in panel.series}
        entry = matrix.entry("beam", quantity.name)
        assert values["beam"] == pytest.approx(entry.value / 1e-6, rel=1e-12)
    assert chart_svg(chart)


def test_unsolved_value_affects_one_entry(monkeypatch):
    """A model without a solution in one pose is judged in the other."""
    robot_file = load_robot("five-bar")
    robot = robot_file.mechanism
    first, last = (tuple(map(float, robot.poses[index])) for index in (0, -1))
    measurements = tuple(
        Measured(measured_quantity("x"), 1e-6, 1e-9, "gauge", pose) for pose in (first, last)
    )

    value = Predictions.value

    def refusing(self, model, measured, *reading):
        if model == "simplified" or (model == "beam" and measured.pose == last):
            raise ComputationError("the drives do not hold the tool")
        return value(self, model, measured, *reading)

    monkeypatch.setattr(Predictions, "value", refusing)
    requirement = replace(robot_file.requirement, deflection=0.99)
    robot_file = replace(robot_file, measured=measurements, requirement=requirement)
    matrix = measured_matrix(Context(robot_file, "quick"))
    entry = matrix.entry("simplified", "x")
    assert (entry.verdict, entry.error, entry.pose) == ("undecided", None, first)
    assert entry.reason == "simplified has no solution: the drives do not hold the tool"
    # What is known of one pose is no verdict on both.
    beam, links = (matrix.entry(model, "x") for model in ("beam", "links"))
    assert (links.verdict, links.reason) == ("adequate", "")
    assert (beam.verdict, beam.errors[1]) == ("undecided", None)
    assert "do not hold the tool" in beam.reason
    assert matrix.entry("vjm", "x").value == pytest.approx(links.value, rel=1e-6)
    assert chart_svg(measured_curves(matrix))


def test_program_error_affects_one_value(monkeypatch, capsys):
    """Undecided with the error as reason; the model is listed as faulty."""
    robot_file = load_robot("five-bar")
    pose = tuple(map(float, robot_file.mechanism.poses[0]))
    measurements = tuple(
        Measured(measured_quantity(axis), 1e-6, 1e-9, "gauge", pose) for axis in "xy"
    )

    value = Predictions.value

    def faulty(self, model, measured, *reading):
        if (model, measured.quantity.name) == ("beam", "x"):
            return 1 / 0
        return value(self, model, measured, *reading)

    robot_file = replace(robot_file, measured=measurements)
    due = measured_matrix(Context(robot_file, "quick"))
    monkeypatch.setattr(Predictions, "value", faulty)
    matrix = measured_matrix(Context(robot_file, "quick"))
    lost = matrix.entry("beam", "x")
    assert (lost.verdict, lost.error) == ("undecided", None)
    assert "ZeroDivisionError: division by zero" in lost.reason
    assert matrix.faults == ("beam",)
    assert due.faults == ()
    other_entries = [
        entry for entry in due.entries if (entry.model, entry.quantity.name) != ("beam", "x")
    ]
    assert [entry for entry in matrix.entries if entry is not lost] == other_entries
    assert "return 1 / 0" in capsys.readouterr().err


@pytest.mark.parametrize("missing", ["inputs", "elements"])
def test_value_unsolved_for_input_change_is_undecided(monkeypatch, tmp_path, missing):
    """The model has no solution for a changed input, or for twice the elements.

    If this missing value were counted as zero, the half-width would be zero or 67 %.
    """
    robot_file = robot_of(load_robot("five-bar").text + OWN, tmp_path)
    predictions = Predictions.of(Context(robot_file, "quick"))
    (f1,) = (measured for measured in robot_file.measured if measured.quantity.name == "f1")
    exact_f1 = replace(f1, value=predictions.value("beam", f1), uncertainty=1e-3)
    value = Predictions.value

    def without(self, model, measured, reading=NOMINAL):
        changed = reading.factors if missing == "inputs" else reading.elements != 1
        return None if changed else value(self, model, measured, reading)

    monkeypatch.setattr(Predictions, "value", without)
    matrix = measured_matrix(Context(replace(robot_file, measured=(exact_f1,)), "quick"))
    entry = matrix.entry("beam", "f1")
    assert (entry.verdict, entry.error) == ("undecided", None)
    changed = "joints.motor1.drive.stiffness" if missing == "inputs" else "40 elements"
    assert changed in entry.reason
    assert "uncertainty unknown: the model has no solution with " in entry.reason
    assert matrix.faults == ()


def test_mode_above_measured_range_is_kept(tmp_path):
    """The axial mode of the arm is far above the modes that a hammer excites."""
    robot_file = robot_of(ONE_ARM + "[path]\nposes = [[0.0]]\n", tmp_path)
    places, along = np.array([[0.5, 0.0, 0.0], [0.25, 0.0, 0.0]]), np.eye(3)[[1, 1]]
    frequencies = np.linspace(5.0, 200.0, 50)
    ends = Freedoms(("arm", "arm"), places[[0, 0]], along)
    response = MeasuredResponse("tip", ends, frequencies, np.full(50, 1e-6 + 0j))
    test = ModalTest(
        (0.0,),
        Freedoms(("arm", "arm"), places, along),
        np.array([[1.0], [0.7]]),
        np.array([50.0]),
        np.array([0.01]),
        (response,),
    )
    mode = Measured(measured_quantity("f1"), 50.0, 0.5, "hammer", (0.0,), 1.0, test, 0)
    push = Measured(measured_quantity("x"), 1e-6, 1e-8, "gauge", (0.0,))
    matrix = measured_matrix(Context(replace(robot_file, measured=(mode, push)), "quick"))
    assert matrix.entry("simplified", "x").value is not None
    # √(E/ρ)/4L = 2586 Hz of the arm alone, less with 1 kg at its end; 50 Hz is none of it.
    entry = matrix.entry("beam", "f1")
    assert (entry.verdict, entry.value > 1000.0) == ("inadequate", True)


OWN = """
[[measured]]
quantity = "z"
pose = [0.1, 0.525]
load = 200.0
value = 1.0e-4
uncertainty = 1.0e-6
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


def test_predictions_are_at_pose_of_measurement(tmp_path):
    """Deflection under 200 N and f1 at a pose that is not on the path, by `answers`."""
    robot_file = robot_of(load_robot("five-bar").text + OWN, tmp_path)
    measured_postures = postures_of(robot_file.mechanism, np.array([[0.1, 0.525]]))
    matrix = measured_matrix(Context(robot_file, "quick"))
    beam = answers("beam", measured_postures, 1)
    entry = matrix.entry("beam", "z")
    assert entry.value == pytest.approx(200.0 * beam.compliances[0, 2, 2], rel=1e-12)
    assert entry.pose == (0.1, 0.525)
    # Of the 1e-4 m that were measured.
    assert entry.error == pytest.approx(entry.value / 1e-4 - 1.0, rel=1e-12)
    assert entry.errors == (entry.error,)
    assert matrix.entry("beam", "f1").value == pytest.approx(beam.frequencies[0, 0], rel=1e-9)
    assert matrix.entry("vjm", "f1") is None
    # Second order: twenty segments leave 4/3 of what twice as many change.
    coarse, fine = (
        answers("segments", measured_postures, 1, ModelOptions(elements=number)).frequencies[0, 0]
        for number in (20, 40)
    )
    numerics = matrix.entry("segments", "f1").uncertainties["numerics"]
    # Two ways to the frequencies differ by 1e-12 of them, which is 1e-6 of their change.
    assert numerics == pytest.approx(4.0 / 3.0 * abs(coarse - fine) / 62.0, rel=5e-5)
    # The drive turns the first frequency by what solving both robots says, in every model.
    ((key, share),) = robot_file.uncertain_inputs.items()
    robots = [robot_file.with_factors({key: sign * share}) for sign in (-1, 1)]
    low, high = (
        answers("simplified", postures_of(robot, measured_postures[0].pose[None]), 1).frequencies[
            0, 0
        ]
        for robot in robots
    )
    inputs = matrix.entry("simplified", "f1").uncertainties["inputs"]
    assert inputs == pytest.approx(1.959964 * 0.5 * (high - low) / 62.0)
    assert chart_svg(measured_curves(matrix))
    assert "adequacy.measured" in {task.id for task in catalogue(robot_file)}


def test_predictions_equal_values_of_models():
    """Compliance entries of legs, deflections under a force, and frequencies."""
    five_bar = load_robot("five-bar")
    mechanism = five_bar.mechanism
    predictions = Predictions.of(Context(five_bar, "quick"))
    leg = legs_of(mechanism)["rod1"]
    exact = tip_compliance(leg.timoshenko, leg.length)
    pose = tuple(mechanism.poses[0])

    def predicted(quantity, model, *where):
        measured = Measured(measured_quantity(quantity), 1.0, 1.0, "gauge", *where)
        return predictions.value(model, measured)

    for i, j in np.ndindex(6, 6):
        for model in ("vjm", "beam"):
            entry = predicted(f"rod1.c{i + 1}{j + 1}", model)
            assert entry == pytest.approx(exact[i, j], rel=1e-9, abs=1e-18)
    once, twice = (predicted("y", "links", pose, load) for load in (30.0, 60.0))
    assert twice == pytest.approx(2.0 * once, rel=1e-12)
    beam = answers("beam", postures_of(mechanism, np.array([pose])), 4)
    assert predicted("f3", "beam", pose) == pytest.approx(beam.frequencies[0, 2], rel=1e-6)
    # Virtual joints that branch have no number.
    delta = load_robot("delta")
    pose = tuple(delta.mechanism.poses[0])
    branching = Measured(measured_quantity("z"), 1e-6, 1e-8, "gauge", pose, 1.0)
    assert Predictions.of(Context(delta, "quick")).value("vjm", branching) is None


def test_program_error_in_model_is_reported(monkeypatch, capsys):
    """Other models keep their values, and the traceback is printed."""
    robot_file = load_robot("five-bar")
    pose = tuple(map(float, robot_file.mechanism.poses[0]))
    measured = Measured(measured_quantity("x"), 1e-6, 1e-9, "gauge", pose)
    model_statics = model_ladder.model_statics

    def faulty(postures, model, options):
        return 1 / 0 if model == "links" else model_statics(postures, model, options)

    monkeypatch.setattr(model_ladder, "model_statics", faulty)
    matrix = measured_matrix(Context(replace(robot_file, measured=(measured,)), "quick"))
    assert matrix.faults == ("links",)
    assert "ZeroDivisionError" in matrix.entry("links", "x").reason
    assert matrix.entry("vjm", "x").value > 0.0
    assert "return 1 / 0" in capsys.readouterr().err
