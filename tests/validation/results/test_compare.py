"""Two runs side by side, references apart from earlier values. The numbers are made up."""

import json
import re
from itertools import permutations

import pytest
from msgspec.json import encode
from msgspec.structs import replace

from lumped.errors import InputError
from validation.results.compare import as_dict, as_text, compare, drift
from validation.results.records import (
    AdequacyRecord,
    CaseRecord,
    RunRecord,
    load_run,
)

STEADY = CaseRecord(
    id="steady", verdict="agree", value=1.0, reference=1.0, tolerance=0.1, seconds=1.0
)


CASE = {"id": "steady", "verdict": "agree"}


def run_of(*cases, **header):
    return RunRecord(cases=cases, run={"robot": "r", "preset": "quick"} | header)


def saved(path, *cases, **header):
    path.write_bytes(encode(run_of(*cases, **header)))
    return path


def test_verdicts_worsen_in_one_direction_and_cases_come_and_go():
    from_good_to_bad = ("agree", "skipped", "undecided", "disagree", "failed")
    for (i, before), (j, after) in permutations(enumerate(from_good_to_bad), 2):
        old, new = (
            run_of(replace(STEADY, verdict=verdict), replace(STEADY, id=other))
            for verdict, other in ((before, "old"), (after, "new"))
        )
        comparison = compare(old, new)
        (change,) = comparison.verdicts
        assert (change.before, change.after, change.worse) == (before, after, j > i)
        assert comparison.worsened is (j > i)
        assert (comparison.removed, comparison.new) == (("old",), ("new",))


@pytest.mark.parametrize(
    ("value", "then", "now", "beyond"),
    [
        # Without an uncertainty 1e-9 of the value is allowed.
        (1.0 + 0.9e-9, None, None, False),
        (1.0 + 1.1e-9, None, None, True),
        (1.0 - 1.1e-9, None, None, True),
        # The larger of the two uncertainties counts.
        (1.09, 0.1, 0.01, False),
        (1.09, 0.01, 0.1, False),
        (1.09, 0.01, None, True),
        # An uncertainty of zero still rounds.
        (1.0 + 0.9e-9, 0.0, 0.0, False),
    ],
)
def test_drift_is_what_exceeds_the_uncertainty(value, then, now, beyond):
    before, after = (
        replace(STEADY, value=number, numerical_uncertainty=uncertainty)
        for number, uncertainty in ((1.0, then), (value, now))
    )
    assert drift(before, after).beyond is beyond
    # 1e-16 held against zero within 1e-9: a value that is all rounding may double.
    before, rounded, moved = (
        replace(STEADY, value=number, reference=0.0, tolerance=1e-9)
        for number in (1e-16, 2e-16, 2e-12)
    )
    assert not drift(before, rounded).beyond
    assert drift(before, moved).beyond


def test_people_and_programs_are_told_what_changed_and_nothing_else():
    before = run_of(STEADY, replace(STEADY, id="worse"), replace(STEADY, id="gone"))
    moved = replace(STEADY, value=1.25, numerical_uncertainty=0.02, seconds=3.5, unit="Hz")
    after = run_of(
        replace(moved, reference=0.5),
        replace(STEADY, id="worse", verdict="disagree"),
        replace(STEADY, id="came"),
        preset="fine",
    )
    found = compare(before, after)
    lines = as_text(before, after, found).splitlines()
    assert "The runs differ in preset." in lines
    assert "1 verdict worse, 0 better, 1 case drifted, 1 new, 1 removed." in lines
    assert "  worse  agree   disagree  worse" in lines
    assert any(line.split()[:3] == ["1", "1.25", "+0.25"] for line in lines)
    assert any(line.split() == ["1.00", "3.50", "+2.50", "steady"] for line in lines)
    assert {"  came", "  gone"} <= set(lines)
    told, same = (json.loads(json.dumps(as_dict(one))) for one in (found, compare(before, before)))
    drift = {"before": 1.0, "after": 1.25, "drift": 0.25, "allowed": 0.02}
    value, reference = told["drifted"]
    assert value == {"id": "steady", "what": "value", "unit": "Hz", **drift}
    assert (reference["what"], reference["drift"]) == ("reference", -0.5)
    assert told["seconds"][0] == {"id": "steady", "before": 1.0, "after": 3.5}
    assert told["verdicts"] == [
        {"id": "worse", "before": "agree", "after": "disagree", "worse": True}
    ]
    assert not any((same | {"seconds": [], "schema": 0}).values())


def test_compare_ends_with_1_when_a_verdict_worsened(tmp_path, command):
    good = saved(tmp_path / "good.json", STEADY)
    (tmp_path / "bad").mkdir()
    saved(tmp_path / "bad" / "results.json", replace(STEADY, verdict="failed", value=None))
    command.told("compare", good, good)
    said = command.told("compare", good, tmp_path / "bad", code=1)
    assert "agree   failed  steady" in said
    (change,) = command.json("compare", tmp_path / "bad", good)["verdicts"]
    assert (change["before"], change["worse"]) == ("failed", False)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "no such run folder or file"),
        ("", "not a results.json"),
        ('{"cases": [], "run": ' + "[" * 100_000, "not a results.json"),
        ('{"schema": 2, "cases": []}', "only schema 1"),
        ('{"cases": [], "run": {"\udcf0": 1}}', "not a results.json"),
        (json.dumps({"cases": [CASE, CASE]}), "two of its cases have the same id"),
        (json.dumps({"cases": [CASE | {"value": 1e300}]}), "Expected `float` <= 1e+150"),
    ],
)
def test_what_is_no_run_ends_with_2_and_one_line(content, said, tmp_path, command):
    path = tmp_path / "x.json"
    if content is not None:
        path.write_bytes(content.encode(errors="surrogateescape"))
    assert said in command.refused("compare", path, path)
    with pytest.raises(InputError, match=r"holds no results\.json"):
        load_run(tmp_path)


def test_inputs_are_compared_however_deep_they_are():
    deep = 1.0
    for _ in range(5000):
        deep = [deep]
    (change,) = compare(
        run_of(robot_tables={"a": deep, "b": 1}), run_of(robot_tables={"a": deep, "b": 2})
    ).inputs
    assert (change.key, change.before, change.after) == ("b", 1, 2)


def test_runs_without_a_common_case_are_not_called_the_same(tmp_path, command):
    some, others = saved(tmp_path / "a.json", STEADY), saved(tmp_path / "b.json")
    for pair in ((some, others), (others, others)):
        said = command.refused("compare", *pair)
        assert "have no case in common: nothing compares them" in said


def test_runs_of_models_alone_are_compared_by_these(tmp_path, command):
    entry = AdequacyRecord(model="beam", quantity="x", verdict="adequate", error=0.01)
    paths = []
    for verdict in ("adequate", "inadequate"):
        run = replace(run_of(), adequacy=(replace(entry, verdict=verdict),))
        paths.append(tmp_path / f"{verdict}.json")
        paths[-1].write_bytes(encode(run))
    said = command.told("compare", *paths)
    assert re.search(r"beam +x +\+1\.00 % +adequate +\+1\.00 % +inad", said)


def judged(quantity, verdict, *values):
    poses = ((0.1,), (0.2,), (0.3,))[: len(values)]
    return AdequacyRecord(
        model="vjm", quantity=quantity, verdict=verdict, error=0.02, poses=poses, values=values
    )


def test_variants_of_a_robot_differ_in_input_and_adequacy_and_do_not_drift():
    """Values side by side where both runs have the pose; numbers of two inputs are no drift."""
    thick = replace(
        run_of(STEADY, robot_tables={"leg1": {"section": {"thickness": 0.004}, "length": 0.8}}),
        adequacy=(judged("x", "adequate", 1.0, 2.0, 3.0), judged("y", "adequate", 1.0)),
    )
    thin = replace(
        run_of(
            replace(STEADY, value=2.0),
            robot_tables={"leg1": {"section": {"thickness": 0.003}, "length": 0.8}},
        ),
        adequacy=(judged("x", "inadequate", 1.5, None, 4.0), judged("f1", "adequate")),
    )
    found = compare(thick, thin)
    (change,) = found.inputs
    assert (change.key, change.before, change.after) == ("leg1.section.thickness", 0.004, 0.003)
    assert found.drifted == ()
    assert compare(thick, replace(thin, run=thick.run)).drifted != ()
    x, y, f1 = found.adequacy
    assert [(v.pose, v.before, v.after) for v in x.values] == [
        ((0.1,), 1.0, 1.5),
        ((0.3,), 3.0, 4.0),
    ]
    assert (x.before.verdict, x.after.verdict, x.after.error) == ("adequate", "inadequate", 0.02)
    assert (y.after, f1.before) == (None, None)
    told = as_text(thick, thin, found)
    assert "The input differs" in told
    assert "leg1.section.thickness" in told
    assert as_dict(found)["adequacy"][0]["values"][0].keys() == {"pose", "before", "after"}
    same = compare(thick, thick)
    assert same.inputs == ()
    assert "Adequacy" not in as_text(thick, thick, same)


def test_values_of_two_postures_are_not_set_against_each_other():
    at_start = run_of(replace(STEADY, pose=(0.21,)))
    for pose, drifts_there in ((0.6, False), (0.21, True)):
        other = run_of(replace(STEADY, value=2.0, pose=(pose,)))
        assert bool(compare(at_start, other).drifted) is drifts_there


def test_different_robots_are_neither_better_nor_worse(tmp_path, command):
    """Cases of one name in runs of two robots have nothing to do with each other."""
    good = CaseRecord(id="steady", verdict="disagree", value=9.0, reference=1.0, tolerance=0.1)
    first = saved(tmp_path / "first.json", good, robot="five-bar", robot_tables={"a": 1})
    second = saved(tmp_path / "second.json", STEADY, robot="delta", robot_tables={"b": 1})
    for pair in ((first, second), (second, first)):
        said = command.told("compare", *pair)
        assert "Two different robots, " in said
        assert not re.search(r"\d+ (better|verdicts worse)|drifted|New cases|Removed", said)
        record = command.json("compare", *pair)
        assert record["different_robots"] == [
            json.loads(p.read_bytes())["run"]["robot"] for p in pair
        ]
        assert not any(record[key] for key in ("verdicts", "new", "removed", "worsened"))


def test_a_baseline_of_another_robot_is_refused_before_anything_is_written(tmp_path, command):
    baseline, out = saved(tmp_path / "delta.json", STEADY, robot="delta"), tmp_path / "out"
    asked = ["run", "five-bar", "--preset", "quick", "--only", "adequacy", "--out", out]
    assert "is of another robot" in command.refused(*asked, "--baseline", baseline)
    assert not out.exists()
