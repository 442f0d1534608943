"""Convergence with element count against values computed by independent code.

Leg 1 of the built-in robot, clamped–free: exact Timoshenko frequencies 114.518 and 181.806 Hz in
the two planes (Huang 1961). The values for rigid segments and beam elements come from an
independent implementation.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import scipy
from support.fakes.toy_responses import NO_ROBOT
from support.robots.robot_from_text import robot_of

from lumped.equivalent_leg import equivalent_leg
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, Rectangle, Tube
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.comparisons.convergence_series import (
    ConvergenceSeries,
    fitted_orders,
    relative_errors,
)
from validation.comparisons.discretisations import FORMULATIONS, Discretisation
from validation.comparisons.element_convergence import leg_convergence
from validation.comparisons.requested import convergence, middle_posture
from validation.models.leg_models import leg_matrices
from validation.models.robot_bodies import bodies_of

HALF, LITERAL, BEAM = FORMULATIONS
EXHAUSTIVE = pytest.mark.exhaustive
BIGLIDE = load_robot("ifw")


@pytest.fixture(scope="module")
def leg1():
    return convergence(BIGLIDE, body="leg1")


@pytest.fixture(scope="module")
def whole_robot():
    return convergence(BIGLIDE)


@pytest.mark.parametrize(
    ("layout", "count", "frequency"),
    [
        # f2 (Hz): second bending plane.
        ("half", 5, 182.056),
        ("half", 10, 181.869),
        ("half", 20, 181.822),
        ("half", 40, 181.810),
        ("literal", 5, 223.46),
        ("literal", 10, 200.96),
        ("literal", 20, 191.01),
        ("literal", 40, 186.32),
    ],
)
def test_segments_equal_independent_values(leg1, layout, count, frequency):
    """f2 of leg 1 for 5 to 40 segments, in both layouts."""
    series = leg1.of("segments", layout)
    computed = series.values[series.counts.index(count), leg1.column("f2")]
    # The source has five or six digits.
    assert computed == pytest.approx(frequency, abs=0.6 * 10.0 ** -(3 if layout == "half" else 2))


@pytest.mark.parametrize(("count", "frequency"), [(2, 181.887), (5, 181.808)])
def test_elements_equal_independent_values(leg1, count, frequency):
    """f2 of leg 1 for two and five beam elements."""
    series = leg1.of("beam")
    computed = series.values[series.counts.index(count), leg1.column("f2")]
    assert computed == pytest.approx(frequency, abs=6e-4)


def test_leg_limit_is_exact_cantilever(leg1):
    """The limit is known without refinement and has no half-width."""
    np.testing.assert_allclose(leg1.of("beam").limits[:2], [114.518, 181.806], atol=6e-4)
    assert not leg1.of("beam").limit_half_widths.any()


@pytest.mark.parametrize(
    ("model", "layout", "quantity", "count", "error"),
    [
        ("segments", "half", "f1", 20, 8.9e-5),  # the paper asks for less than 1 % at 20
        ("segments", "literal", "f2", 20, 5.06e-2),
        # Static tip compliance: pieces of length L/n are rigid at the ends in the literal layout.
        ("segments", "literal", "x", 20, -1.0 / 20.0),
        ("segments", "literal", "x", 80, -1.0 / 80.0),
    ],
)
def test_leg_errors_match_known_values(leg1, model, layout, quantity, count, error):
    """Errors of leg 1 at 5 or 20 elements, computed by independent code."""
    series = leg1.of(model, layout)
    computed = series.errors[series.counts.index(count), leg1.column(quantity)]
    assert computed == pytest.approx(error, rel=5e-3)


def test_literal_layout_has_known_error():
    """5.2 % at 20 elements against Euler–Bernoulli's cantilever (layout of §3.2 as printed)."""
    leg = equivalent_leg(legs_of(BIGLIDE.mechanism)["leg1"])
    discretisation = replace(LITERAL, theory="euler-bernoulli")
    study = leg_convergence(NO_ROBOT, "leg1", leg, [discretisation], [20])
    assert study.series[0].errors[0, 1] == pytest.approx(5.2e-2, abs=5e-4)
    # L² √(EI/μ) 1.875104²/2π: f2 is 186.8 Hz without rotary inertia.
    assert study.series[0].limits[1] == pytest.approx(186.8, abs=0.05)


@pytest.mark.parametrize("index", range(3))
def test_euler_bernoulli_has_formal_orders(index):
    """Errors relative to the Euler–Bernoulli cantilever.

    f1 to f4 have order 2 by segments, 1 in their literal layout, and 4 by beam elements.
    Deflections are exact except in the literal layout.
    """
    study = convergence(BIGLIDE, body="leg1", theory="euler-bernoulli")
    series = study.series[index]
    np.testing.assert_allclose(series.orders[:4], series.formal_order, atol=0.1)
    assert series.exact[4:].all() == (series.discretisation.layout == "half")
    # Half-widths without the limit contain it, from five elements on.
    fine = np.array(series.counts) >= 5
    judged = slice(2) if series.discretisation.layout == "literal" else slice(None)
    shares = np.abs(series.errors[fine, judged]) / series.half_widths[fine, judged]
    assert shares.max() <= 1.0


def test_statics_are_exact_for_every_count(leg1):
    """Deflections by half-length end springs and by beams: errors below 1e-9."""
    for model in ("segments", "beam"):
        series = leg1.of(model)
        columns = [leg1.column(axis) for axis in "xyz"]
        # Round-off of 80 elements: 2e-11 seen.
        np.testing.assert_allclose(series.errors[:, columns], 0.0, atol=1e-9)
        assert series.exact[columns].all()
        assert not series.exact[leg1.column("f1")]


@pytest.mark.parametrize(
    ("model", "layout", "order", "tolerance"),
    [
        ("segments", "half", 2.0, 0.05),
        ("segments", "literal", 1.0, 0.1),
        ("beam", "half", 4.0, 0.1),
    ],
)
def test_legs_have_formal_orders(leg1, model, layout, order, tolerance):
    """f1 to f4: order 2 by segments, 1 in their literal layout, 4 by beams."""
    series = leg1.of(model, layout)
    np.testing.assert_allclose(series.orders[:4], order, atol=tolerance)
    assert series.formal_order == order


def test_robot_equals_independent_values(whole_robot):
    """Converged f1 = 112.396 Hz and f4 = 353.2 Hz at x = 0.4975 m, and errors at 20 elements."""
    assert whole_robot.pose == {"x": pytest.approx(0.4975)}
    assert whole_robot.title == "whole robot at x = 0.4975 m"
    half, literal, beam = (
        whole_robot.of(*names) for names in (("segments",), ("segments", "literal"), ("beam",))
    )
    index = half.counts.index(20)
    assert half.limits[0] == pytest.approx(112.396, abs=6e-4)
    assert half.limits[3] == pytest.approx(353.2, abs=0.06)
    assert half.errors[index, 0] == pytest.approx(5.0e-6, rel=0.02)
    assert literal.errors[literal.counts.index(20), 0] == pytest.approx(9.71e-3, rel=1e-3)
    assert beam.errors[index, 0] == pytest.approx(5e-9, rel=0.1)
    np.testing.assert_allclose(half.orders[:4], 2.0, atol=0.05)
    np.testing.assert_allclose(beam.orders[:4], 4.0, atol=0.1)
    assert literal.orders[0] == pytest.approx(1.0, abs=0.01)


def test_sign_change_of_error_has_no_order(whole_robot):
    """f4 of the literal layout crosses its converged value near ten elements."""
    series, column = whole_robot.of("segments", "literal"), whole_robot.column("f4")
    assert np.isnan(series.orders[column])
    assert series.behaviour(column) == "not monotone"
    index = series.counts.index(10)
    # The error at ten elements is small by accident; the largest from there on counts.
    assert abs(series.errors[index, column]) == pytest.approx(1.98e-4, rel=0.01)
    assert series.largest_errors[index, column] == pytest.approx(4.96e-4, rel=0.01)


def test_reduced_robot_equals_full_one(whole_robot):
    """Reference: all elements of both legs assembled without reduction."""
    mechanism = BIGLIDE.mechanism
    posture = middle_posture(mechanism)
    for discretisation in (HALF, BEAM):
        bodies = bodies_of(
            mechanism, discretisation.options, partial(leg_matrices, discretisation.model)
        )
        solution = solved(assembly(mechanism, bodies).at(posture))
        series = whole_robot.of(discretisation.model, discretisation.layout)
        values = series.values[series.counts.index(20)]
        # Reduction 1e-11, round-off of the dense modes 1e-11.
        np.testing.assert_allclose(values[:4], modes(solution, 4).frequencies, rtol=1e-9)
        np.testing.assert_allclose(values[4:], np.diag(compliance(solution))[:3], rtol=1e-9)


@pytest.mark.parametrize(
    ("layout", "quantity"), [("half", "f1"), ("half", "f4"), ("literal", "f4")]
)
def test_needed_counts_are_smallest(leg1, layout, quantity):
    """The needed number of elements and each finer one meet the target.

    One element fewer does not.
    """
    leg = equivalent_leg(legs_of(BIGLIDE.mechanism)["leg1"])
    series, column = leg1.of("segments", layout), leg1.column(quantity)
    for target, needed in zip((0.01, 0.001, 0.0001), series.needed[:, column], strict=True):
        if not needed:
            assert abs(series.errors[-1, column]) > target
            continue
        study = leg_convergence(
            NO_ROBOT, "leg1", leg, [series.discretisation], [int(needed) - 1, int(needed)]
        )
        sizes = np.abs(study.series[0].errors[:, column])
        assert sizes[0] > target >= sizes[-1]


def random_leg(seed):
    draw = np.random.default_rng(seed)
    material = Material.isotropic(draw.uniform(7e10, 2.1e11), draw.uniform(0.2, 0.35), 5000.0)
    width = draw.uniform(0.03, 0.1)
    sections = (
        Rectangle(width, 1.7 * width),
        Circle(width),
        Tube(width, 0.1 * width),
        HollowRectangle(width, 1.4 * width, 0.1 * width),
    )
    return ConstantLeg(draw.uniform(6.0, 15.0) * width, sections[seed % 4], material)


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(seed, marks=EXHAUSTIVE) for seed in range(4, 10))]
)
def test_random_legs_have_formal_order(seed):
    """Random sections and lengths; half-widths contain the error of each count."""
    study = leg_convergence(NO_ROBOT, f"random {seed}", random_leg(seed))
    for series, tolerance in zip(study.series, (0.05, 0.1, 0.1), strict=True):
        np.testing.assert_allclose(series.orders[:4], series.formal_order, atol=tolerance)
        require_true_half_widths(series)


def require_true_half_widths(series):
    """From five elements on, each half-width contains the limit and the value at twice the count.

    For the literal layout only two frequencies are checked: higher modes change their order.
    """
    judged = slice(2) if series.discretisation.layout == "literal" else slice(None)
    for coarse, count in enumerate(series.counts):
        if count < 5:
            continue
        half_widths = series.half_widths[coarse, judged]
        assert (np.abs(series.errors[coarse, judged]) <= half_widths).all()
        if 2 * count in series.counts:
            fine = series.counts.index(2 * count)
            step = np.abs(series.values[fine] / series.values[coarse] - 1.0)
            assert (step[judged] <= half_widths).all()


@pytest.mark.parametrize(
    "robot",
    [
        "five-bar",
        "3-rrr",
        *(pytest.param(name, marks=EXHAUSTIVE) for name in ("delta", "orthoglide", "hexapod")),
    ],
)
def test_robots_have_formal_orders(robot):
    """f1 to f4 of whole robots: order 2 by segments, 4 by beams."""
    study = convergence(load_robot(robot))
    require_true_half_widths(study.of("segments", "literal"))
    for series, tolerance in ((study.of("segments"), 0.05), (study.of("beam"), 0.1)):
        orders = series.orders[:4]
        # Frequencies so low that even few beam elements are exact to round-off show no order.
        finite_orders = orders[~np.isnan(orders)]
        assert len(finite_orders) >= 3
        np.testing.assert_allclose(finite_orders, series.formal_order, atol=tolerance)
        require_true_half_widths(series)


@pytest.mark.soak
@pytest.mark.parametrize("body", ["leg1", None])
def test_stepped_part_has_second_order(body):
    """Each of ten prismatic pieces has a whole number of segments, one to eight."""
    path = Path(__file__).parents[3] / "examples" / "tapered-biglide" / "robot.toml"
    study = convergence(load_robot(path), body=body)
    series = study.of("segments")
    assert series.counts == (10, 20, 30, 40, 80)
    np.testing.assert_allclose(series.orders[:4], 2.0, atol=0.05)
    assert [series.discretisation.layout for series in study.series] == ["half", "half"]


def test_fitted_order_is_log_slope():
    """Errors e = 3 n^−p have order p. If one of them changes its sign, there is no order."""
    counts = np.array([5, 10, 20, 40])
    errors = 3.0 * counts[:, None] ** -np.array([1.0, 2.0, 4.0])
    np.testing.assert_allclose(fitted_orders(counts, errors, np.zeros(3)), [1.0, 2.0, 4.0])
    errors[1] *= -1.0
    assert np.isnan(fitted_orders(counts, errors, np.zeros(3))).all()
    # Two counts above round-off are no order, whatever their slope.
    assert np.isnan(fitted_orders(counts[:2], errors[2:], np.zeros(3))).all()


def test_order_is_fitted_to_finest_counts():
    """Reference: slope over the three finest counts, by scipy. Coarser counts have no effect."""
    counts = np.array([5, 8, 10, 20, 40])
    errors = 1.0 * counts**-2.0 + 20.0 * counts**-4.0
    slope = scipy.stats.linregress(np.log(counts[-3:]), np.log(errors[-3:])).slope
    order = fitted_orders(counts, errors[:, None], np.zeros(1))[0]
    assert order == pytest.approx(-slope, rel=1e-12)


def series_of_errors(formulation, formal_order, counts, errors):
    """Series of one quantity with the exact limit 1 and these relative errors (n×1)."""
    return ConvergenceSeries(
        discretisation=Discretisation(formulation),
        formal_order=formal_order,
        counts=counts,
        values=1.0 + errors,
        limits=np.ones(1),
        limit_half_widths=np.zeros(1),
        orders=fitted_orders(counts, errors, np.zeros(1)),
        needed=np.zeros((3, 1), dtype=int),
    )


@pytest.mark.parametrize("deviation", [-0.03, 0.05])
@pytest.mark.parametrize("counts", [(1, 2, 3), (2, 3, 5), (5, 10, 20), (20, 30, 40)])
def test_asymptotic_order_is_formal_order(counts, deviation):
    """Errors n⁻⁴ (1 + a/n²) have the order 4 for many elements; orders fitted to few differ.

    `deviation` is a/n² for the coarsest count. Higher powers of it are neglected.
    """
    sizes = counts[0] / np.array(counts, dtype=float)[:, None]
    errors = 0.01 * sizes**4 * (1.0 + deviation * sizes**2)
    series = series_of_errors("beam", 4.0, counts, errors)
    order, half_width = series.asymptotic_order(0)
    assert order == pytest.approx(4.0, abs=0.006)
    assert half_width > 3.0 * abs(order - 4.0)
    assert abs(series.orders[0] - 4.0) > 0.02


def test_half_width_without_order_is_triple_error():
    """Half-width: three times the largest error at this and finer counts, plus the limit's own."""
    series = ConvergenceSeries(
        discretisation=Discretisation("segments"),
        formal_order=2.0,
        counts=(5, 10, 20),
        values=np.array([[1.01], [0.9999], [1.002]]),
        limits=np.ones(1),
        limit_half_widths=np.full(1, 1e-4),
        orders=np.full(1, np.nan),
        needed=np.zeros((3, 1), dtype=int),
    )
    np.testing.assert_allclose(series.half_widths[1:, 0], [0.0061, 0.0061], rtol=1e-6)


def test_half_width_by_order_uses_two_counts():
    """For errors e = n^−2, the difference of the values at counts m < n over (n/m)² − 1 is e(n).

    The safety factor is 3 until two orders are known.
    """
    counts = (10, 20, 40, 80)
    errors = np.array(counts, dtype=float)[:, None] ** -2.0
    series = series_of_errors("segments", 2.0, counts, errors)
    expected = [3.0 * errors[1, 0], 3.0 * errors[2, 0], 1.25 * errors[3, 0]]
    np.testing.assert_allclose(series.half_widths[1:, 0], expected, rtol=1e-5)


# A rod on two ball joints that carries a slide: the tool cannot move along x and y at all.
GUIDED = """
schema = 2
name = "guided rod"
[points]
A = [0.0, 0.0, 0.0]
B = [0.0, 0.0, 1.0]
[bodies.rod]
up = [1.0, 0.0, 0.0]
from = "A"
to = "B"
section = { shape = "circle", diameter = 0.01 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
[bodies.head]
points = ["B"]
[joints]
A = { type = "spherical", between = ["ground", "rod"], at = "A" }
B = { type = "spherical", between = ["rod", "head"], at = "B" }
[joints.slide]
type = "prismatic"
between = ["ground", "head"]
at = "B"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 1.0 }
[tool]
body = "head"
point = "B"
moves = []
"""


def test_zero_deflection_is_exact(tmp_path):
    """Along x and y the slide supports the tool: no deflection. Along z the rod has L/EA."""
    study = convergence(robot_of(GUIDED, tmp_path))
    across = [study.column("x"), study.column("y")]
    for series in study.series:
        assert (series.values[:, across] == 0.0).all()
        assert (series.errors[:, across] == 0.0).all()
        assert [series.behaviour(k) for k in across] == ["exact", "exact"]
        assert (series.limit_half_widths[across] == 0.0).all()
        assert np.isfinite(series.half_widths[1:]).all()
    beam = study.of("beam").values[-1, study.column("z")]
    assert beam == pytest.approx(1.0 / (2.1e11 * np.pi * 0.005**2 + 1.0), rel=1e-9)


def test_error_relative_to_zero_is_infinite():
    """Zero relative to zero has no error."""
    errors = relative_errors(np.array([[0.0, 1e-9, 2.0]]), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_array_equal(errors, [[0.0, np.inf, 1.0]])
