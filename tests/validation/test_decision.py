"""Decisions by α: closed forms of the simplified model, an independent search, known ranks."""

from dataclasses import replace
from math import isnan, nan, pi, sqrt

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from lumped.biglide import scaled
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from validation.case import Skip
from validation.context import Context
from validation.models.biglide import robot_compliance
from validation.models.options import ModelOptions
from validation.studies.quantities import deflections_of
from validation.sweeps.decision import Brief, Choice, Decision, Value, decide, value_of
from validation.sweeps.plans import (
    RIGID,
    feasible_alphas,
    lumped_models,
    solid_model,
    stroke_stations,
)
from validation.sweeps.studies import decision_of
from validation.sweeps.units import SolvedPostures

IFW_FILE = load_robot("ifw")
IFW = IFW_FILE.robot
SIMPLIFIED, VJM, SEGMENTS, _ = lumped_models(6)
BRIEF = Brief(alphas=(0.4, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0), postures=11, halvings=6)
POSSIBLE = feasible_alphas(IFW, BRIEF.alphas)


@pytest.fixture(scope="module")
def found():
    return decide(IFW, (SIMPLIFIED, VJM, SEGMENTS), BRIEF, POSSIBLE)


def test_simplified_model_is_indifferent_to_long_legs(found):
    # With leg 1 or 2 horizontal one drive carries fy alone: F/K = 1 µm, √(K/m)/2π = 742.06 Hz;
    # from some α on nothing over the stroke is worse.
    by_deflection = found.choices["simplified", "deflection"]
    by_frequency = found.choices["simplified", "frequency"]
    assert by_deflection.value == pytest.approx(1.0, rel=1e-9)
    assert by_frequency.value == pytest.approx(sqrt(1e9 / 46.0) / (2.0 * pi), rel=1e-9)
    for choice in (by_deflection, by_frequency):
        # At α = 1 planar x reaches 1.063 µm and f1 713.4 Hz (known values).
        assert 1.0 < choice.best < 1.1
        assert choice.indifferent == (choice.best, 2.0)


def test_best_alpha_is_that_of_an_independent_search(found):
    def largest(alpha):
        member = scaled(IFW, alpha)
        options = ModelOptions(legs="equivalent")
        compliances = [
            robot_compliance("vjm", member, x, options) for x in stroke_stations(member, 11)
        ]
        values = deflections_of(np.array(compliances))
        return max(values.largest_planar, float(values.along_z.max()))

    brent = minimize_scalar(largest, bounds=(0.6, 0.9), method="bounded", options={"xatol": 1e-5})
    choice = found.choices["VJM", "deflection"]
    # The last interval: 0.1 halved six times, on either side.
    assert choice.best == pytest.approx(brent.x, abs=0.1 / 2**6)
    assert choice.neighbours[0] < brent.x < choice.neighbours[1]
    assert choice.value == pytest.approx(largest(choice.best), rel=1e-9)


def test_three_formulations_of_one_statics_choose_alike(found):
    vjm, segments = (found.choices[label, "deflection"] for label in ("VJM", "segments"))
    assert vjm.best == segments.best
    assert vjm.value == pytest.approx(segments.value, rel=1e-8)
    assert ("VJM", "frequency") not in found.choices
    assert all(isnan(value) for value in found.curve("VJM", "frequency"))


def test_impossible_robots_are_named_and_left_out(found):
    assert found.alphas == BRIEF.alphas[1:]
    assert len(found.impossible) == 1
    assert found.impossible[0].startswith("α = 0.4: a = -0.055 m")


def test_solid_legs_contradict_the_simplified_model():
    models = (SIMPLIFIED, VJM, SEGMENTS, solid_model(RIGID, "rigid", 1))
    found = decide(IFW, models, replace(BRIEF, halvings=2), POSSIBLE)
    # Known values: 26 µm along z at α = 1 and 85 µm at α = 2 (planar 1 µm, simplified);
    # the first frequency falls from 113 to 48 Hz, one element across the section being 1 % off.
    at = {alpha: found.values[RIGID][alpha] for alpha in (1.0, 2.0)}
    assert at[2.0].deflection == pytest.approx(85.0, rel=0.02)
    assert at[2.0].frequency == pytest.approx(48.4, rel=0.02)
    assert found.cost_at(2.0, "deflection", RIGID) > 4.0
    assert found.cost("simplified", "deflection", RIGID) > 0.5
    assert found.spearman("simplified", "deflection", RIGID) < 0.0
    assert found.spearman("VJM", "deflection", RIGID) == pytest.approx(1.0)
    assert found.cost("VJM", "deflection", RIGID) < 0.02


def decision_with(first, second):
    """Two models over α = 1, 2, 3, 4 with the given values."""
    alphas = (1.0, 2.0, 3.0, 4.0)

    def values(numbers):
        return {
            alpha: Value(number, nan, {"deflection": 0.1})
            for alpha, number in zip(alphas, numbers, strict=True)
        }

    def choice(numbers):
        at = int(np.argmin(numbers))
        return Choice(alphas[at], (alphas[at],) * 2, (alphas[max(at - 1, 0)], alphas[at + 1]),
                      numbers[at])  # fmt: skip

    return Decision(
        alphas=alphas,
        impossible=(),
        values={"one": values(first), "other": values(second)},
        choices={
            ("one", "deflection"): choice(first),
            ("other", "deflection"): choice(second),
        },
    )


def test_ranks_and_costs_of_a_known_table():
    decision = decision_with([1.0, 2.0, 4.0, 3.0], [2.0, 1.6, 3.0, 5.0])
    # Ranks 1 2 4 3 and 2 1 3 4: Σd² = 4, ρ = 1 − 6·4/60; four of six pairs agree.
    assert decision.spearman("one", "deflection", "other") == pytest.approx(0.6)
    assert decision.kendall("one", "deflection", "other") == pytest.approx(1.0 / 3.0)
    # The first model chooses α = 1, where the second has 2.0 instead of its best 1.6.
    assert decision.cost("one", "deflection", "other") == pytest.approx(0.25)
    assert decision.sampling(2.0, "deflection", "other") == pytest.approx(0.1 / 1.6)
    # Neighbours of the second's best: 2.0 and 3.0, losses 0.25 and 0.875.
    assert decision.resolution("deflection", "other") == pytest.approx(0.4375)


def test_objectives_are_extremes_over_postures_and_loads():
    compliances = np.zeros((3, 6, 6))
    # 3-4-5: 5 µm in the plane under 1000 N along x in the second posture, 4 µm along z before.
    compliances[1, :2, 0] = 3e-9, 4e-9
    compliances[0, 2, 2] = 4e-9
    value = value_of(SolvedPostures(compliances, np.array([[9.0, 12.0], [7.0, 8.0], [8.0, 9.0]])))
    assert value.deflection == pytest.approx(5.0)
    assert value.frequency == 7.0
    # Every second posture alone: 4 µm and 8 Hz; a third of the difference, second order.
    assert value.sampling == pytest.approx({"deflection": 1.0 / 3.0, "frequency": 1.0 / 3.0})


def test_cases_skip_a_robot_whose_family_is_impossible():
    # At α = 2 the legs are 1.7 m long: shorter than a section of 9 m at every α.
    leg = ConstantLeg(0.85, Rectangle(9.0, 9.0), Material.isotropic(2.1e11, 0.3, 7850.0))
    context = Context(replace(IFW_FILE, described=replace(IFW, leg1=leg)), "quick")
    with pytest.raises(Skip, match=r"α = 2, leg 1: length = 1\.7: shorter than its rectangle"):
        decision_of(context)
