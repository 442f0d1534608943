"""Cases: their declaration, their verdicts, and their records."""

import json
from dataclasses import replace
from math import hypot, inf, isnan, nan

import numpy as np
import pytest
from msgspec import to_builtins
from support.fakes import toy_catalogue
from support.oracles.shifted_references import perturbed

from validation.case import (
    Absolute,
    Allowance,
    Elsewhere,
    Measurement,
    Relation,
    Relative,
    UnjudgedValue,
)
from validation.case_group import CaseGroup, numbered
from validation.run.outcome import from_plain, judge, outcome_of
from validation.run.records import parse_run, run_json, run_record

# Keys that interface.md fixes for an entry of "cases" in results.json.
INTERFACE = {
    *("id", "title", "quantity", "unit", "value", "reference", "reference_kind", "citation"),
    *("error", "numerical_uncertainty", "tolerance", "tolerance_reason", "verdict", "seconds"),
}
EQUAL = toy_catalogue.case("toy.equal[x=1]", toy_catalogue.agrees)


def exact(*values, **fields):
    return Measurement(float(sum(values)), 1.0, exact=True, **fields)


@pytest.mark.parametrize("relation", list(Relation))
@pytest.mark.parametrize(("value", "reference"), [(nan, 1.0), (1.0, nan), (inf, 1.0), (-inf, 1.0)])
def test_non_finite_value_never_agrees(relation, value, reference):
    """NaN or infinity on either side, for each relation."""
    measured = Measurement(value, reference, exact=True)
    outcome = judge(replace(EQUAL, relation=relation), measured, 0.0)
    assert outcome.verdict == "disagree"
    assert "not finite" in outcome.message


@pytest.mark.parametrize(
    ("make", "message"),
    [
        *(
            (lambda kind=kind, amount=amount: kind(amount), "positive and finite")
            for kind in (Absolute, Relative)
            for amount in (0.0, -1.0, nan, inf)
        ),
        (lambda: Relative(0.01).at(0.0), "other than zero"),
        (lambda: replace(EQUAL, citation=" "), "citation is empty"),
        (lambda: Measurement(1.0, 1.0), "must state its numerical uncertainty"),
        (lambda: exact(1.0, value_uncertainty=0.1), "exact up to round-off"),
    ],
)
def test_invalid_tolerance_or_source_is_refused(make, message):
    """Tolerances are positive and finite, sources are not empty, half-widths are stated."""
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize("uncertainty", [0.11, inf, nan])
def test_undecided_comparison_has_remedy(uncertainty):
    """A half-width beyond the tolerance: finer models, or another remedy of the case."""
    measured = Measurement(10.0, 10.0, value_uncertainty=uncertainty)
    outcome = judge(EQUAL, measured, 0.0)
    assert outcome.verdict == "undecided"
    assert outcome.message.endswith(
        "so the comparison is undecided: refine the models until "
        "the numerical uncertainty is below the tolerance"
    )
    rounded = replace(measured, decides="no finer model narrows it")
    assert judge(EQUAL, rounded, 0.0).message.endswith(
        "the comparison is undecided: no finer model narrows it"
    )


def test_random_verdicts_follow_rule():
    """Agreement: the signed difference less all allowances is within the tolerance.

    The uncertainty must be within it, too.
    """
    rng = np.random.default_rng(12)
    for number in range(300):
        reference, share = float(rng.uniform(0.5, 5.0)), float(10.0 ** rng.uniform(-4.0, -1.0))
        limit = share * reference
        reference *= (-1.0) ** (number // 3)
        parts = (rng.uniform(-0.2, 0.2, 2) * reference).tolist()
        unexplained = float(rng.uniform(-2.5, 2.5) * limit)
        value_half_width, reference_half_width, judged = (rng.uniform(0.0, 0.9, 3) * limit).tolist()
        relation = list(Relation)[number % 3]
        measured = Measurement(
            reference + sum(parts) + unexplained,
            reference,
            value_half_width if number % 5 else None,
            reference_half_width,
            judged if number % 2 else None,
            tuple(Allowance("made up", part) for part in parts),
        )
        spread = (
            judged
            if number % 2
            else hypot(value_half_width if number % 5 else 0.0, reference_half_width)
        )
        wrong = {"equal": abs(unexplained), "at most": unexplained, "at least": -unexplained}[
            relation.value
        ]
        expected = "agree" if wrong <= limit else "disagree"
        if spread > limit and wrong - limit <= spread:
            expected = "undecided"
        outcome = judge(replace(EQUAL, tolerance=Relative(share), relation=relation), measured, 0.0)
        assert outcome.verdict == expected
        assert outcome.share == pytest.approx(wrong / limit, abs=1e-9)
        assert expected != "agree" or perturbed(outcome, 4.5) == "disagree"
        (record,) = written(outcome)["cases"]
        assert (record["value"], record["reference"]) == (measured.value, reference)
        assert record["error"] == pytest.approx(sum(parts) + unexplained)
        assert record["unexplained"] == pytest.approx(unexplained, abs=1e-12)
        assert record["value_uncertainty"] == (value_half_width if number % 5 else None)
        assert record["reference_uncertainty"] == reference_half_width
        assert record["numerical_uncertainty"] == pytest.approx(spread)
        assert record["tolerance"] == pytest.approx(limit)
        assert not record["exact"]


def written(*outcomes):
    """Content of results.json for these outcomes."""
    return json.loads(run_json(run_record({}, outcomes, ())))


def test_json_record_has_only_finite_numbers():
    """NaN and infinity become null; the keys of all records are equal."""
    measurement = Measurement(nan, 10.0, inf, table={"x": (nan, 1.0), "name": ("a", "b")})
    other, lost = replace(EQUAL, id="toy.other"), replace(EQUAL, id="toy.lost")
    outcomes = (
        judge(EQUAL, measurement, 0.0),
        judge(other, exact(1.0), 0.0),
        outcome_of(lost, "failed", 0.0, "no licence"),
    )
    not_finite, finite, failed = written(*outcomes)["cases"]
    assert set(not_finite) == set(finite) == set(failed) >= INTERFACE
    assert not_finite["table"] == {"x": [None, 1.0], "name": ["a", "b"]}
    numbers = ("value", "error", "numerical_uncertainty")
    assert [not_finite[name] for name in numbers] == [None, None, None]
    assert (finite["exact"], finite["numerical_uncertainty"]) == (True, None)
    numbers = (*numbers, "reference", "unexplained", "exact", "tolerance", "value_uncertainty")
    assert {failed[name] for name in numbers} == {None}
    assert (failed["table"], failed["allowances"], failed["message"]) == ({}, [], "no licence")


def test_comparison_round_trips():
    """A comparison that is stored in results.json and read again is unchanged.

    Tolerances are stored as absolute values, and an infinite half-width as null.
    """
    allowed = replace(EQUAL, tolerance=Relative(0.05), model="beam", relation=Relation.AT_MOST)
    other_pose = Elsewhere("x = 0.2 m", 1.1, 1.0, 0.01)
    measurement = Measurement(
        *(1.1, 1.0, 0.01, 0.02),
        allowances=(Allowance("shear", 0.06, "Timoshenko"),),
        notes=("a note",),
        table={"x": (nan, 1.0)},
        pose=(0.3,),
        elsewhere=(other_pose,),
        shown=(UnjudgedValue("beam", "f1", "Hz", 2.0, 1.0),),
    )
    outcomes = (
        judge(allowed, measurement, 2.5),
        judge(replace(EQUAL, id="toy.wide"), Measurement(1.0, 1.0, inf), 0.0),
        outcome_of(replace(EQUAL, id="toy.lost"), "skipped", 0.0, "no licence"),
    )
    read_back = parse_run(run_json(run_record({}, outcomes, ())), "test").cases
    assert read_back[0].tolerance == pytest.approx(0.05)
    assert isnan(read_back[1].measurement.numerical_uncertainty)
    assert read_back[2].measurement is None
    rewritten = written(*read_back)["cases"]
    assert rewritten == written(*outcomes)["cases"]
    # What a worker sends has everything.
    assert from_plain(allowed, to_builtins(outcomes[0])).case == allowed.declaration


@pytest.mark.parametrize("exact_as_written", [{}, {"exact": None}, {"exact": True}])
def test_file_of_earlier_version_is_read(exact_as_written):
    """Only id and verdict are required; null replaces a number."""
    numbers = {"value": 1.0, "reference": None, "numerical_uncertainty": None, "pose": []}
    case = {"id": "old", "verdict": "disagree", **numbers, **exact_as_written}
    content = json.dumps({"cases": [case, {"id": "bare", "verdict": "agree"}]})
    old, bare = parse_run(content, "test").cases
    assert (old.measurement.value, isnan(old.measurement.reference)) == (1.0, True)
    assert old.measurement.numerical_uncertainty is None
    assert isnan(bare.measurement.value)


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
def test_case_verdict_is_worst_over_poses(value, uncertainty, expected):
    """The message names the other pose if its verdict is worse."""
    # 2.5 % of what the reference is there, not of the 1.0 in the measurement's own place.
    other_pose = Elsewhere("x = 0.2 m", value, 2.0, uncertainty)
    measured = exact(1.0, elsewhere=(Elsewhere("x = 0", 3.0, 3.0), other_pose))
    outcome = judge(replace(EQUAL, tolerance=Relative(0.025)), measured, 0.0)
    assert outcome.verdict == expected
    assert ("x = 0.2 m" in outcome.message) is (expected != "agree")
    assert isnan(value) or outcome.share == pytest.approx(abs(value - 2.0) / 0.05)


def test_worst_verdict_prevails_in_any_order():
    """Disagree is worse than undecided, whichever pose comes first."""
    undecided, wrong = Elsewhere("there", 1.0, 1.0, 1.0), Elsewhere("far", 2.0, 1.0)
    assert judge(EQUAL, exact(2.0, elsewhere=(undecided,)), 0.0).verdict == "disagree"
    outcome = judge(EQUAL, exact(1.0, elsewhere=(undecided, wrong, undecided)), 0.0)
    assert (outcome.verdict, outcome.message.split(":")[0]) == ("disagree", "disagree at far")


COMMON = {
    "quantity": "a number",
    "unit": "1",
    "reference_kind": "closed-form",
    "citation": "by hand",
    "tolerance": Absolute(0.5),
    "tolerance_reason": "a count",
    "model": "none",
}


def test_case_fields_have_priorities():
    """Fields come from the case, its parameters, its family or the group, in this priority."""
    cases = CaseGroup(over={"leg": (1, 2)}, group="all", **COMMON)

    @cases.case(
        "leg{leg}.{model}.{mode}",
        "Leg {leg}: {model}, {size:.1f}",
        over={
            "model, size": [("beam", 1.25), ("rigid", 2.5)],
            "index, mode": lambda model, modes: numbered(modes[model]),
        },
        tolerance=lambda size: Absolute(2.0 * size),
        effort=3.0,
    )
    def case_of_leg(context, leg, size, index):
        return exact(context, leg, size, 0.01 * index)

    family = cases.family(group="of {leg}")

    @cases.case("leg{leg}.last", "Leg {leg}", unit="{leg} m")
    def last(context):
        return exact(context)

    family.case("leg{leg}.one", "One", over={"model": ("own",)}, model="")(last)
    listed = cases(modes={"beam": 2, "rigid": 1})
    names = ("beam.1", "beam.2", "rigid.1", "one", "last")
    assert [case.id for case in listed] == [f"leg{leg}.{name}" for leg in (1, 2) for name in names]
    assert [case.title for case in listed[1:3]] == ["Leg 1: beam, 1.2", "Leg 1: rigid, 2.5"]
    assert [case.tolerance.amount for case in listed[:5]] == [2.5, 2.5, 5.0, 0.5, 0.5]
    assert [case.effort for case in listed[2:4]] == [3.0, 0.1]
    assert [case.model for case in listed[:5]] == ["beam", "beam", "rigid", "", "none"]
    assert [case.group for case in listed[5:]] == [*["all"] * 3, "of 2", "all"]
    assert listed[9].unit == "2 m"
    # 100 + leg + size + index; what names no parameter is given none.
    assert [case.compute(100.0).value for case in listed[:4]] == [102.25, 102.26, 103.5, 100.0]
    assert listed[4].compute is last


@pytest.mark.parametrize(
    ("declaration", "fault"),
    [
        ({"compute": lambda _context, lenght: exact(lenght)}, TypeError),
        ({"title": "{lenght}"}, KeyError),
        ({"quantity": ""}, ValueError),
        ({"effrot": 1.0}, TypeError),
    ],
)
def test_invalid_declaration_is_an_error(declaration, fault):
    """Misspelt parameters in a function, a title or a field of a case."""
    cases = CaseGroup(over={"length": (1, 2)}, **COMMON)
    fields = {"title": "One", "compute": exact, **declaration}
    compute = fields.pop("compute")
    cases.case("{length}", **fields)(compute)
    with pytest.raises(fault):
        cases()
