"""Validation uncertainty in the sense of ASME V&V 20: coverage, propagation, verdicts, the run."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

from lumped.acceptance.measured import Measured
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import load_robot
from validation.context import Context
from validation.drawing.charts.plot import chart_svg
from validation.measured.comparison import Comparison, propagated
from validation.measured.matrix import measured_matrix, predicted
from validation.models.options import ModelOptions
from validation.report.figures.measured import measured_curves
from validation.report.first_screen.sentence import sentence

DRAWS = 1000
LOAD = 1000.0


@pytest.fixture(scope="module")
def robot_file():
    return load_robot("biglide")


def with_mass(robot: Mechanism, factor: float) -> Mechanism:
    return replace(robot, tool=replace(robot.tool, mass=factor * robot.tool.mass))


@pytest.mark.parametrize("quantity", ["z", "f1"])
def test_the_interval_holds_the_truth_in_95_of_100_draws_from_the_solid(robot_file, quantity):
    """Measurement noise and an uncertain mass drawn at random; truth is the solid's number.

    With 1000 draws 95 % has a standard deviation of 0.7 %.
    """
    robot = robot_file.mechanism
    (x,) = robot.reference_pose
    one = Measured(quantity, 1.0, 1.0, "drawn", (x,), LOAD)
    solid = predicted("solid", robot, one, ModelOptions(divisions=2))
    exact = predicted("beam", robot, one, ModelOptions())
    true_error = exact - solid
    noise, mass = 0.02 * solid, 0.03
    generator = np.random.default_rng(20260105)
    # Frequencies and deflections of beams are smooth in the mass: a table replaces 1000 solutions.
    factors = np.linspace(1.0 - 5.0 * mass, 1.0 + 5.0 * mass, 21)
    values = [predicted("beam", with_mass(robot, float(f)), one, ModelOptions()) for f in factors]
    held = 0
    for _ in range(DRAWS):
        factor = 1.0 + mass * generator.standard_normal()
        value = float(np.interp(factor, factors, values))
        measured = solid + noise * generator.standard_normal()
        steps = np.interp([factor - mass, factor + mass], factors, values)
        compared = Comparison(value, measured, 0.0, propagated([tuple(steps)]), noise)
        low, high = compared.interval
        held += low <= true_error <= high
    assert 0.93 * DRAWS <= held <= 0.97 * DRAWS


def test_independent_parts_add_as_squares():
    compared = Comparison(10.0, 9.0, 0.1, 0.2, 0.2)
    assert compared.error == 1.0
    assert compared.validation_uncertainty == pytest.approx(0.3)
    assert compared.interval == pytest.approx((1.0 - 0.5879892, 1.0 + 0.5879892))


def test_inputs_propagate_as_their_derivatives():
    # y = a·b² with relative uncertainties 1 % and 2 %: √(1² + (2·2)²) % to first order.
    def y(a: float, b: float) -> float:
        return a * b**2

    found = propagated([(y(0.99, 1.0), y(1.01, 1.0)), (y(1.0, 0.98), y(1.0, 1.02))])
    assert found == pytest.approx(sqrt(0.01**2 + 0.04**2))
    assert propagated([]) == 0.0


@pytest.mark.parametrize(
    ("value", "uncertainty", "verdict"),
    [
        (1.02, 0.001, "adequate"),
        (0.98, 0.001, "adequate"),
        (1.12, 0.001, "inadequate"),
        (0.90, 0.001, "inadequate"),
        (1.04, 0.02, "undecided"),
        (1.00, 0.10, "undecided"),
    ],
)
def test_the_verdict_is_that_of_the_whole_interval(value, uncertainty, verdict):
    assert Comparison(value, 1.0, 0.0, 0.0, uncertainty).verdict(0.05) == verdict


def test_measured_values_join_the_matrix_as_a_reference_of_their_own(robot_file):
    robot = robot_file.mechanism
    (x,), (first,) = robot.reference_pose, robot.poses[0]
    given = Measured("z", 1.0, 1.0, "gauge", (x,), LOAD)
    truth = predicted("vjm", robot, given, ModelOptions())
    ones = (
        replace(given, value=truth, uncertainty=1e-3 * truth),
        replace(given, value=1.2 * truth, uncertainty=1e-3 * truth, pose=(first,)),
        Measured("leg1.c33", 0.9, 1e-3, "stand"),
    )
    matrix = measured_matrix(Context(replace(robot_file, measured=ones[:1]), "quick"))
    entry = matrix.entry("vjm", "z")
    assert (entry.verdict, entry.reference, entry.pose) == ("adequate", "measured: gauge", (x,))
    assert entry.error == 0.0
    assert entry.uncertainty == pytest.approx(1.959964e-3)
    assert matrix.entry("simplified", "z").verdict == "inadequate"
    # The worst of several poses decides; a leg's entry has none.
    more = measured_matrix(Context(replace(robot_file, measured=ones), "quick"))
    assert more.entry("vjm", "z").verdict == "inadequate"
    assert more.entry("vjm", "z").pose == (first,)
    assert more.poses == ((first,), (x,))
    assert more.entry("vjm", "z").errors == pytest.approx(
        [predicted("vjm", robot, ones[1], ModelOptions()) / ones[1].value - 1.0, 0.0]
    )
    assert more.entry("beam", "leg1.c33").pose == ()
    assert more.entry("beam", "leg1.c33").errors == (None, None)
    assert more.entry("simplified", "leg1.c33") is None
    assert chart_svg(measured_curves(more).chart)
    assert "leg1.c33" in sentence(more)
