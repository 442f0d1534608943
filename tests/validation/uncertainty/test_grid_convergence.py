"""Observed orders, extrapolation and uncertainty, also of irregular sequences.

Sources: NASA Glenn, NPARC Alliance, "Examining spatial (grid) convergence"; P. J. Roache, J. Fluids
Eng. 116 (1994) 405.
"""

from itertools import count
from math import isnan

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from lumped.errors import InputError
from validation.solids.solid_legs import Refinement
from validation.uncertainty import refinement
from validation.uncertainty.grid_convergence import (
    analyse,
    classify,
    fit_order,
    pairwise_orders,
    richardson,
    three_grid_order,
    uncertainty_of_known_orders,
)
from validation.uncertainty.half_widths import MeshPolicy
from validation.uncertainty.refinement import Accuracy, refined

HALVING = 0.4 / 2.0 ** np.arange(10)
COARSE = HALVING[:6]


def test_pure_power_has_exact_order():
    """f = limit + 0.7 h^p on grids of unequal ratios, five random p."""
    draws = np.random.default_rng(0).uniform([0.5, 1.2, 1.2, -5.0], [8.0, 3.0, 3.0, 5.0], (5, 4))
    for order, first, second, limit in draws:
        sizes = np.array([first * second, second, 1.0])
        values = limit + 0.7 * sizes**order
        # Differences lose digits where the coarse value is large beside them: far below 1e-6.
        assert pairwise_orders(sizes, values) == pytest.approx([order], rel=1e-6)


@pytest.mark.parametrize(
    ("values", "behaviour"),
    [
        (1.0 + COARSE**2, "monotone"),
        (1.0 + COARSE**2 * (-1.0) ** np.arange(6), "oscillating"),
        (1.0 + (-2.0) ** np.arange(6), "diverging"),
        (np.log(COARSE), "diverging"),
        (np.array([1.2, 1.1, 1.05, 1.0, 1.0 + 1e-14, 1.0 - 1e-14]), "round-off plateau"),
    ],
)
def test_convergence_behaviour_is_classified(values, behaviour):
    """Monotone, oscillating, diverging or constant sequences."""
    assert classify(COARSE, values, 1e-12) == behaviour


@pytest.mark.parametrize(("order", "safety"), [(2.0, 1.25), (1.85, 1.25), (1.7, 3.0), (2.4, 3.0)])
def test_safety_factor_is_small_near_formal_order(order, safety):
    """1.25 within 10 % of the formal order 2, otherwise 3 (Roache)."""
    study = analyse(COARSE, 3.0 + 0.7 * COARSE**order, formal_order=2.0)
    assert study.observed_order == pytest.approx(order, rel=1e-6)
    # The true error of the finest value, 0.7 hᵖ, times the safety factor; with an order above the
    # formal one the last step is taken for one of the formal order.
    error = 0.7 * COARSE[-1] ** order * (2.0**order - 1.0) / (2.0 ** min(order, 2.0) - 1.0)
    assert study.extrapolated == pytest.approx(study.values[-1] - error, rel=1e-9)
    assert study.uncertainty == pytest.approx(safety * error, rel=1e-5)
    assert study.refusal == ""


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (1.0 + 2.0 ** np.arange(6), "diverging"),
        # The difference pattern 1, 1/2, 1/4, 1/8, 1/64 has orders 1, 1, 1, 3.
        (np.cumsum([0.0, 1.0, 0.5, 0.25, 0.125, 0.125 / 8.0]), "outside the asymptotic range"),
    ],
)
def test_non_asymptotic_range_is_undecided(values, reason):
    """No order, limit and half-width, but a reason."""
    study = analyse(COARSE, values, formal_order=2.0)
    assert (study.uncertainty, study.extrapolated, study.observed_order) == (None, None, None)
    assert reason in study.refusal


def test_uncertainty_of_equal_values_is_round_off():
    """Changes below the round-off of 1e-9: the half-width is that of the round-off."""
    study = analyse(HALVING, 3.0 + 0.7 * HALVING**4, formal_order=4.0, round_off=1e-9)
    assert study.uncertainty == pytest.approx(3e-9, rel=1e-6)
    assert study.extrapolated == study.values[-1]
    # The grids before it still tell their order.
    assert study.observed_order == pytest.approx(4.0, abs=0.01)


@pytest.mark.parametrize(
    ("sizes", "values", "reason"),
    [
        ([0.4, 0.2, 0.1], [1.0, 1.1, 1.2], "four grids"),
        ([0.1, 0.2, 0.4, 0.8], [1.0, 1.1, 1.2, 1.3], "must decrease"),
        ([0.4, 0.2, 0.1, 0.0], [1.0, 1.1, 1.2, 1.3], "must decrease"),
        ([0.4, 0.2, 0.1, 0.05], [1.0, 1.1, np.nan, 1.3], "finite"),
    ],
)
def test_invalid_study_is_refused(sizes, values, reason):
    """Fewer than four grids, or sizes that do not decrease."""
    with pytest.raises(ValueError, match=reason):
        analyse(np.array(sizes), np.array(values), formal_order=2.0)


def test_fit_weights_grids_by_1_over_h():
    """Reference: normal equations with weights 1/h, grids 1, 1/2, 1/4, 1/10, two powers.

    Weights 1, 1/√h or 1/h² would give another order and limit.
    """
    sizes = np.array([1.0, 0.5, 0.25, 0.1])
    values = 5.0 + sizes**2 + np.array([0.1, -0.05, 0.02, -0.01])

    def fitted(order: float):
        """Intercept and misfit of the straight line through values over h^p, weights 1/h."""
        line = np.polynomial.Polynomial.fit(sizes**order, values, 1, w=sizes**-0.5)
        return line(0.0), line(sizes**order) - values

    least = minimize_scalar(
        lambda order: np.sum(fitted(order)[1] ** 2 / sizes), bounds=(0.5, 6.0), method="bounded"
    )
    assert fit_order(sizes, values) == pytest.approx(least.x, rel=1e-4)
    intercept, misfit = fitted(2.0)
    half_widths = uncertainty_of_known_orders(sizes, values, (2.0,))
    expected = 1.25 * abs(intercept - values[-1]) + np.abs(misfit).max()
    assert half_widths == pytest.approx(expected, rel=1e-9)
    # Two orders are told apart.
    values = 2.0 + 0.3 * sizes**1.42 - 0.5 * sizes**4
    uncertainty = uncertainty_of_known_orders(sizes, values, (1.42, 4.0))
    assert uncertainty == pytest.approx(1.25 * abs(values[-1] - 2.0), rel=1e-6)
    with pytest.raises(ValueError, match="4 grids"):
        uncertainty_of_known_orders(sizes[:3], values[:3], (1.42, 4.0))


def test_published_study_is_reproduced():
    """NPARC example: 0.96178, 0.96854, 0.97050 have order 1.78618 and limit 0.9713."""
    # NASA Glenn: pressure recovery on three grids of ratio 2, p = 1.786, limit 0.97130.
    coarse, middle, fine = 0.96178, 0.96854, 0.97050
    order = three_grid_order(coarse, middle, fine, 2.0, 2.0)
    assert order == pytest.approx(1.78618, rel=2e-5)
    assert richardson(middle, fine, 2.0, order) == pytest.approx(0.9713, rel=1e-6)
    # There is none where differences do not shrink on one side.
    for values in ((1.0, 2.0, 1.5), (1.0, 1.0, 1.0), (1.0, 2.0, 4.0)):
        assert isnan(three_grid_order(*values, 2.0, 2.0))


def test_two_grids_use_formal_order():
    """Half-width 3/(rᵖ − 1) times the change, with r = 2."""
    for order, half_width in ((2.0, 1.0), (4.0, 0.2)):
        policy = MeshPolicy.of_order(2.0, order)
        assert policy.half_width(-1.0) == pytest.approx(half_width)
    assert Refinement((1, 2), np.array([3.5, 3.125]), 2.0).uncertainty() == pytest.approx(0.375)


@pytest.mark.parametrize(
    ("changes", "half_width"),
    [
        # Order 2: falls by 4, 1.5 · 1/3, whether the last change or the one before leaves it.
        ((4.0, 1.0), 0.5),
        # No order is shown: the lowest, by which changes fall by 2.
        ((1.0, 1.0), 1.5),
        # Faster than the highest order: a quarter of the change before counts, not a tenth.
        ((10.0, 1.0), 1.25),
        ((1.0, 0.0), 0.125),
    ],
)
def test_three_mesh_half_width_is_exact(changes, half_width) -> None:
    """Observed order within 1 to 2, safety factor 1.5, ratio 2."""
    policy = MeshPolicy(2.0, orders=(1.0, 2.0), safety=1.5)
    half_widths = policy.half_widths(*(np.array([change]) for change in changes[::-1]))
    assert half_widths == pytest.approx([half_width], rel=1e-12)


def test_one_large_change_does_not_set_order_of_others():
    """Nine numbers show order 0.3, a tenth changes 80 times as much with order 2: order 1 counts.

    The half-width of the first number is 1.5/(√2 − 1) times its last change, as without the tenth.
    """
    policy = MeshPolicy(np.sqrt(2.0), orders=(1.0, 2.0), safety=1.5)
    before, last = np.full(10, 3.3e-3), np.full(10, 3e-3)
    before[9], last[9] = 0.25, 0.125
    expected = 1.5 * 3e-3 / (np.sqrt(2.0) - 1.0)
    for judged in (3, 9, 10):
        half_widths = policy.half_widths(last[:judged], before[:judged])
        assert half_widths[0] == pytest.approx(expected, rel=1e-12)


def test_richardson_intervals_contain_limit():
    """Powers of random order: the half-width is one to four times the error."""
    rng = np.random.default_rng(14)
    for ladder in ((1, 2, 3, 4), (2, 4, 8, 16)):
        limits, orders = rng.uniform(1.0, 3.0, 4), rng.uniform(1.0, 4.0, 4)
        values = limits + rng.choice([-0.2, 0.2], 4) * np.array(ladder)[:, None] ** -orders
        series = Refinement(ladder, values, 4.0)
        for number, limit in enumerate(limits):
            error = abs(values[-1, number] - limit)
            alone = Refinement(ladder, values[:, [number]], 4.0)
            assert series.uncertainty(number) == pytest.approx(alone.uncertainty(0), rel=1e-9)
            assert error <= series.uncertainty(number) <= 4.0 * error
            assert series.at(number).extrapolated == pytest.approx(limit, rel=1e-6)


def error_of_mesh(divisions: int) -> float:
    return 0.1 / divisions**2


def refined_to(accuracy: float):
    """Refine from 2 divisions to the half-width `accuracy`, by at most twofold steps, up to 64."""

    def finer(divisions: int, factor: float) -> int:
        needed = min(2 * divisions, int(divisions * factor**0.5) + 1)
        if needed > 64:
            raise InputError(f"--divisions {needed}: takes more memory than there is")
        return needed

    return refined(2, lambda divisions: divisions, error_of_mesh, finer, accuracy)


@pytest.mark.parametrize("accuracy", [0.2, 0.01, 1e-4])
def test_refinement_stops_if_accurate(accuracy: float) -> None:
    """The coarsest mesh that meets the accuracy, by doubling."""
    reached, note = refined_to(accuracy)
    assert error_of_mesh(reached) <= accuracy
    assert note == Accuracy(accuracy, error_of_mesh(reached))
    assert reached == 2 or error_of_mesh(reached // 2) > accuracy


def test_unreached_accuracy_is_reported() -> None:
    """Reached and requested accuracy, and the reason why there is no finer mesh."""
    reached, note = refined_to(1e-6)
    assert (reached, note.reached) == (64, error_of_mesh(64))
    assert note.text.startswith("accuracy ±0.0024 %, requested ±0.0001 %; --divisions 128: takes m")


def test_refinement_ignores_machine_speed(monkeypatch) -> None:
    """Each reading of the clock advances by 90 s. Only the size limits the refinement."""
    clock = count(step=90)
    monkeypatch.setattr(refinement, "perf_counter", lambda: float(next(clock)), raising=False)
    assert refined_to(0.01) == (4, Accuracy(0.01, error_of_mesh(4)))
