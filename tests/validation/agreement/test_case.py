"""Verdicts: when a case agrees, and that every case is able to fail."""

from dataclasses import replace
from math import hypot, inf, isnan, nan

import numpy as np
import pytest
import toy_catalogue
from msgspec.json import encode
from perturbed import perturbed

from lumped.robot_file import load_robot
from validation.case import (
    Absolute,
    Allowance,
    Case,
    Elsewhere,
    Measurement,
    Relation,
    Relative,
)
from validation.catalogue import catalogue
from validation.exhibits import PlannedFigure
from validation.results.outcome import judge
from validation.results.records import case_record, parse_run, run_record

# Keys that interface.md fixes for an entry of "cases" in results.json.
INTERFACE = {
    *("id", "title", "quantity", "unit", "value", "reference", "reference_kind", "citation"),
    *("error", "numerical_uncertainty", "tolerance", "tolerance_reason", "verdict", "seconds"),
}
EQUAL = toy_catalogue.case("toy.equal[x=1]", toy_catalogue.agrees)


@pytest.mark.parametrize("relation", list(Relation))
@pytest.mark.parametrize(("value", "reference"), [(nan, 1.0), (1.0, nan), (inf, 1.0), (-inf, 1.0)])
def test_what_is_no_finite_number_never_agrees(relation, value, reference):
    outcome = judge(
        replace(EQUAL, relation=relation), Measurement(value, reference, exact=True), 0.0
    )
    assert outcome.verdict == "disagree"
    assert "no finite number" in outcome.message


def test_a_relative_tolerance_about_zero_is_refused():
    with pytest.raises(ValueError, match="other than zero"):
        judge(replace(EQUAL, tolerance=Relative(0.01)), Measurement(0.0, 0.0, exact=True), 0.0)


@pytest.mark.parametrize("amount", [0.0, -1.0, nan, inf])
@pytest.mark.parametrize("kind", [Absolute, Relative])
def test_a_tolerance_that_cannot_judge_is_refused(kind, amount):
    with pytest.raises(ValueError, match="positive and finite"):
        kind(amount)


def test_a_case_without_a_source_is_refused():
    with pytest.raises(ValueError, match="citation is empty"):
        replace(EQUAL, citation=" ")


@pytest.mark.parametrize("uncertainty", [0.11, inf, nan])
def test_a_comparison_less_certain_than_its_tolerance_says_what_would_decide_it(uncertainty):
    measured = Measurement(10.0, 10.0, value_uncertainty=uncertainty)
    outcome = judge(EQUAL, measured, 0.0)
    assert outcome.verdict == "undecided"
    assert outcome.message.endswith("the comparison cannot decide: refine the models")
    rounded = replace(measured, decides="no finer model narrows it")
    assert judge(EQUAL, rounded, 0.0).message.endswith("cannot decide: no finer model narrows it")


def test_verdicts_and_records_of_measurements_at_random_are_those_of_the_rule():
    """E less all allowances, with its sign, within the tolerance, and so the uncertainty."""
    rng = np.random.default_rng(12)
    for number in range(300):
        reference, share = float(rng.uniform(0.5, 5.0)), float(10.0 ** rng.uniform(-4.0, -1.0))
        limit = share * reference
        reference *= (-1.0) ** (number // 3)
        parts = (rng.uniform(-0.2, 0.2, 2) * reference).tolist()
        left = float(rng.uniform(-2.5, 2.5) * limit)
        own, other, judged = (rng.uniform(0.0, 0.9, 3) * limit).tolist()
        relation = list(Relation)[number % 3]
        measured = Measurement(
            reference + sum(parts) + left,
            reference,
            own,
            other,
            judged if number % 2 else None,
            tuple(Allowance("made up", part) for part in parts),
        )
        spread = judged if number % 2 else hypot(own, other)
        wrong = {"equal": abs(left), "at most": left, "at least": -left}[relation.value]
        wanted = "agree" if wrong <= limit else "disagree"
        if spread > limit and wrong - limit <= spread:
            wanted = "undecided"
        outcome = judge(replace(EQUAL, tolerance=Relative(share), relation=relation), measured, 0.0)
        assert outcome.verdict == wanted
        assert outcome.share == pytest.approx(wrong / limit, abs=1e-9)
        assert wanted != "agree" or perturbed(outcome, 4.5) == "disagree"
        record = case_record(outcome)
        assert (record.value, record.reference) == (measured.value, reference)
        assert record.error == pytest.approx(sum(parts) + left)
        assert record.unexplained == pytest.approx(left, abs=1e-12)
        assert (record.value_uncertainty, record.reference_uncertainty) == (own, other)
        assert record.numerical_uncertainty == pytest.approx(spread)
        assert record.tolerance == pytest.approx(limit)


def test_the_record_has_no_numbers_that_json_cannot_carry():
    measurement = Measurement(nan, 10.0, inf, table={"x": (nan, 1.0), "name": ("a", "b")})
    (record,) = parse_run(
        encode(run_record({}, [case_record(judge(EQUAL, measurement, 0.0))], (), ())), "test"
    ).cases
    assert set(record.__struct_fields__) >= INTERFACE
    assert record.table == {"x": (None, 1.0), "name": ("a", "b")}
    assert record.value is None
    assert record.error is None
    assert record.numerical_uncertainty is None


def test_a_measurement_states_its_uncertainty_or_that_it_is_exact():
    with pytest.raises(ValueError, match="states its numerical uncertainty"):
        Measurement(1.0, 1.0)
    with pytest.raises(ValueError, match="exact to rounding"):
        Measurement(1.0, 1.0, value_uncertainty=0.1, exact=True)
    assert Measurement(1.0, 1.0, exact=True).numerical_uncertainty is None
    assert Measurement(1.0, 1.0, None, 0.4).numerical_uncertainty == 0.4
    assert case_record(judge(EQUAL, Measurement(10.0, 10.0, exact=True), 0.0)).exact is True
    stated = judge(EQUAL, Measurement(10.0, 10.0, reference_uncertainty=0.01), 0.0)
    assert case_record(stated).exact is False


@pytest.mark.parametrize(
    ("value", "uncertainty", "expected"),
    [
        (2.02, None, "agree"),
        (2.02, 0.03, "agree"),
        (2.06, None, "disagree"),
        (1.94, 0.01, "disagree"),
        (2.02, 0.06, "undecided"),
        (nan, None, "disagree"),
    ],
)
def test_a_case_is_judged_at_every_place_it_looks_at(value, uncertainty, expected):
    # 2.5 % of what the reference is there, not of the 1.0 in the measurement's own place.
    there = Elsewhere("x = 0.2 m", value, 2.0, uncertainty)
    measured = Measurement(1.0, 1.0, exact=True, elsewhere=(Elsewhere("x = 0", 3.0, 3.0), there))
    outcome = judge(replace(EQUAL, tolerance=Relative(0.025)), measured, 0.0)
    assert outcome.verdict == expected
    assert ("x = 0.2 m" in outcome.message) is (expected != "agree")
    if not isnan(value):
        assert outcome.share == pytest.approx(abs(value - 2.0) / 0.05)


def test_the_graver_verdict_is_kept_wherever_it_was_given():
    undecided = Elsewhere("there", 1.0, 1.0, 1.0)
    measured = Measurement(2.0, 1.0, exact=True, elsewhere=(undecided,))
    assert judge(EQUAL, measured, 0.0).verdict == "disagree"
    wrong = Elsewhere("far", 2.0, 1.0)
    measured = Measurement(1.0, 1.0, exact=True, elsewhere=(undecided, wrong, undecided))
    outcome = judge(EQUAL, measured, 0.0)
    assert (outcome.verdict, outcome.message.split(":")[0]) == ("disagree", "disagree at far")


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("ifw", {"mechanism.deflections", "deflection.stroke"}),
        ("five-bar", {f"mechanism.{n}" for n in ("deflections", "frequencies", "mode-shapes")}),
    ],
)
def test_figures_that_cases_lead_to_are_drawn(name, shown):
    tasks = catalogue(load_robot(name))
    drawn = {task.id for task in tasks if isinstance(task, PlannedFigure)}
    named = {task.figure for task in tasks if isinstance(task, Case) and task.figure}
    assert shown <= named
    assert named <= drawn
