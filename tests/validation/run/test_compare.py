"""Comparison of two runs: changed verdicts, and drift of values. All numbers are made up."""

import dataclasses
import json
import re
from itertools import permutations

import numpy as np
import pytest
from msgspec.structs import replace

from lumped.errors import InputError
from validation.case import Absolute, Declaration, Measurement
from validation.run.compare import as_dict, as_text, compare, drift, with_drift
from validation.run.outcome import Outcome
from validation.run.records import RunRecord, StoredEntry, load_run, run_json

CASE = {"id": "steady", "verdict": "agree"}
STEADY = Outcome(
    **CASE,
    seconds=1.0,
    found=Measurement(1.0, 1.0, exact=True),
    case=Declaration(id="steady", title="", tolerance=Absolute(0.1)),
)


def changed(half_width=None, **numbers):
    """Outcome STEADY with other `numbers` in its measurement; exact if `half_width` is None."""
    exact = half_width is None
    fields = {"value": 1.0, "reference": 1.0, "judged_uncertainty": half_width, "exact": exact}
    return replace(STEADY, found=Measurement(**fields | numbers))


def run_of(*cases, adequacy=(), **header):
    return RunRecord(cases=cases, adequacy=adequacy, run={"robot": "r", "preset": "quick"} | header)


@pytest.fixture
def saved(tmp_path):
    def save(name, *cases, **fields):
        (tmp_path / name).write_text(run_json(run_of(*cases, **fields)))
        return tmp_path / name

    return save


def test_changed_verdicts_are_listed():
    """All 20 changes between five verdicts, from agree to failed; new and removed cases."""
    from_good_to_bad = ("agree", "skipped", "undecided", "disagree", "failed")
    for (i, before), (j, after) in permutations(enumerate(from_good_to_bad), 2):
        comparison = compare(
            run_of(replace(STEADY, verdict=before), replace(STEADY, id="old")),
            run_of(replace(STEADY, verdict=after), replace(STEADY, id="new")),
        )
        (change,) = comparison.verdicts
        assert (change.before, change.after, change.worse) == (before, after, j > i)
        assert comparison.worsened is (j > i)
        assert (comparison.removed, comparison.new) == (("old",), ("new",))


@pytest.mark.parametrize(
    ("values", "uncertainties", "beyond"),
    [
        # Without an uncertainty 1e-9 of the value is allowed.
        ((1.0, 1.0 + 0.9e-9), (None, None), False),
        ((1.0, 1.0 + 1.1e-9), (None, None), True),
        ((1.0, 1.0 - 1.1e-9), (None, None), True),
        # The larger of the two uncertainties counts.
        ((1.0, 1.09), (0.1, 0.01), False),
        ((1.0, 1.09), (0.01, 0.1), False),
        ((1.0, 1.09), (0.01, None), True),
        # An uncertainty of zero still rounds.
        ((1.0, 1.0 + 0.9e-9), (0.0, 0.0), False),
        # Held against zero within 1e-9: a value that is all rounding may double.
        ((1e-16, 2e-16), (None, None), False),
        ((1e-16, 2e-12), (None, None), True),
    ],
)
def test_drift_is_change_beyond_uncertainty(values, uncertainties, beyond):
    """Allowed: the larger half-width, or 1e-9 of the value for round-off."""
    reference = {} if values[0] == 1.0 else {"reference": 0.0}
    case = Declaration(id="steady", title="", tolerance=Absolute(1e-9 if reference else 0.1))
    before, after = (
        replace(changed(uncertainty, value=value, **reference), case=case)
        for value, uncertainty in zip(values, uncertainties, strict=True)
    )
    assert drift(before, after).beyond is beyond
    # In results.json beside the value, as the page shows it.
    written = with_drift(after, before)
    # Where the reference is zero, a thousandth of the tolerance is rounding.
    rounding = 1e-12 if reference else 1e-9 * max(values)
    allowed = max(
        [rounding, *(uncertainty for uncertainty in uncertainties if uncertainty is not None)]
    )
    assert (written.measurement.value, written.earlier) == values[::-1]
    assert written.drift == values[1] - values[0]
    assert written.drift_allowed == pytest.approx(allowed)
    assert written.drifted is beyond
    assert with_drift(after, None) == after


def test_compare_lists_exactly_the_changes():
    """Presets, verdicts, values, times, new and removed cases; equal runs list none."""
    before = run_of(STEADY, replace(STEADY, id="worse"), replace(STEADY, id="gone"))
    case = dataclasses.replace(STEADY.case, unit="Hz")
    after = run_of(
        replace(changed(0.02, value=1.25, reference=0.5), case=case, seconds=3.5),
        replace(STEADY, id="worse", verdict="disagree"),
        replace(STEADY, id="came"),
        preset="fine",
    )
    comparison = compare(before, after)
    lines = as_text(before, after, comparison).splitlines()
    assert "The runs differ in preset." in lines
    assert "1 verdict worse, 0 better, 1 case drifted, 1 new, 1 removed." in lines
    assert "  worse  agree   disagree  worse" in lines
    assert any(line.split()[:3] == ["1", "1.25", "+0.25"] for line in lines)
    assert any(line.split() == ["1.00", "3.50", "+2.50", "steady"] for line in lines)
    assert {"  came", "  gone"} <= set(lines)
    record, record_of_equal_runs = (
        json.loads(json.dumps(as_dict(result))) for result in (comparison, compare(before, before))
    )
    value, reference = record["drifted"]
    numbers = {"before": 1.0, "after": 1.25, "drift": 0.25, "allowed": 0.02}
    assert value == {"id": "steady", "what": "value", "unit": "Hz", **numbers}
    assert (reference["what"], reference["drift"]) == ("reference", -0.5)
    assert record["seconds"][0] == {"id": "steady", "before": 1.0, "after": 3.5}
    (change,) = record["verdicts"]
    assert change == {"id": "worse", "before": "agree", "after": "disagree", "worse": True}
    assert not any((record_of_equal_runs | {"seconds": [], "schema": 0}).values())


def test_worse_verdict_exits_with_1(tmp_path, saved, command):
    """Runs without a common case are refused."""
    (tmp_path / "bad").mkdir()
    good = saved("good.json", STEADY)
    saved("bad/results.json", replace(STEADY, verdict="failed", found=None))
    command.output("compare", good, good)
    output = command.output("compare", good, tmp_path / "bad", code=1)
    assert "agree   failed  steady" in output
    (change,) = command.json("compare", tmp_path / "bad", good)["verdicts"]
    assert (change["before"], change["worse"]) == ("failed", False)
    # Runs without a common case are not called the same.
    empty = saved("empty.json")
    for run in (good, empty):
        output = command.error_line("compare", run, empty)
        assert "have no case in common, so nothing can be compared" in output


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such run folder or file"),
        ("", "not a results.json"),
        ('{"cases": [], "run": ' + "[" * 100_000, "not a results.json"),
        ('{"schema": 2, "cases": []}', "only schema 1"),
        ('{"cases": [], "run": {"\udcf0": 1}}', "not a results.json"),
        (json.dumps({"cases": [CASE, CASE]}), "two cases in it have the same id"),
        (json.dumps({"cases": [CASE | {"value": 1e300}]}), "a number exceeds 1e+150"),
    ],
)
def test_invalid_run_exits_with_2(content, message, tmp_path, command):
    """Missing, empty or damaged results.json."""
    path = tmp_path / "x.json"
    if content is not None:
        path.write_bytes(content.encode(errors="surrogateescape"))
    assert message in command.error_line("compare", path, path)
    with pytest.raises(InputError, match=r"contains no results\.json"):
        load_run(tmp_path)


def test_nested_inputs_are_compared():
    """Inputs nested in tables or in 5000 lists are compared."""
    deep = 1.0
    for _ in range(5000):
        deep = [deep]
    runs = [run_of(robot_tables={"a": deep, "b": {"c": value}}) for value in (1, 2)]
    (change,) = compare(*runs).inputs
    assert (change.key, change.before, change.after) == ("b.c", 1, 2)


def judged(quantity, verdict, *values):
    """Stored verdict on the VJM with `values` in the first one to three poses."""
    poses = ((0.1,), (0.2,), (0.3,))[: len(values)]
    return StoredEntry(
        model="vjm", quantity=quantity, verdict=verdict, error=0.02, poses=poses, values=values
    )


def test_values_are_matched_by_pose():
    """Poses may be in any order and differ by rounding. 5000 poses are compared without delay."""
    places, values = 0.1 * np.arange(5_000.0) + 5e-10, np.arange(5_000.0)
    runs = []
    for x, y in ((places, values), (places[::-1] + 1e-13, -values[::-1])):
        entry = replace(judged("x", "adequate"), poses=tuple(zip(x, -x, strict=True)), values=y)
        runs.append(run_of(adequacy=(entry,)))
    (change,) = compare(*runs).adequacy
    before_and_after = np.array([(value.before, value.after) for value in change.values])
    np.testing.assert_array_equal(before_and_after, np.array([values, -values]).T)


@pytest.mark.parametrize("poses", [((0.1,), (0.2, 0.3)), ((), (0.1,)), ((0.1, 0.2),) * 2])
def test_other_pose_lengths_are_not_compared(poses):
    """Poses have different numbers of coordinates, as after an edit of the file."""
    entries = (
        replace(judged("x", "adequate"), poses=poses_of_run, values=(1.0, 2.0))
        for poses_of_run in (poses, ((0.1,), (0.2,)))
    )
    runs = [run_of(adequacy=(entry,)) for entry in entries]
    for pair in (runs, runs[::-1]):
        assert compare(*pair).adequacy[0].values == ()


def test_errors_are_compared_in_percent(saved, command):
    """Printed errors have sign, half-width, bound, range over readings, and part along the load."""
    entry = {"model": "vjm", "verdict": "undecided", "limit": 0.05}
    numbers = {"error": 0.0325, "uncertainty": 0.0125, "low": 0.02, "high": 0.045}
    entries = [
        {**entry, **numbers, "quantity": "f1"},
        {**entry, **numbers, "quantity": "x", "along": -0.0225},
        {**entry, **numbers, "quantity": "f2", "error": -0.0325, "low": -0.045, "high": -0.02},
        {**entry, "quantity": "y", "error": 0.0, "uncertainty": 0.044, "low": 0.0, "high": 0.044}
        | {"along": 0.0},
        {**entry, "quantity": "z", "error": 0.33, "uncertainty": 0.0, "low": 0.0, "high": 0.33}
        | {"along": -0.33, "readings": {"rigid pins": 0.0, "averaged ones": 0.33}},
    ]
    before = saved(
        "before.json", adequacy=[{**fields, "verdict": "adequate"} for fields in entries]
    )
    output = command.output("compare", before, saved("after.json", adequacy=entries))
    lines = {line.split()[1]: line for line in output.splitlines() if line.startswith("  vjm ")}
    assert {
        name: " ".join(line.split()).partition(" adequate")[0] for name, line in lines.items()
    } == {
        "f1": "vjm f1 +3.25 % ± 1.25 %",
        "x": "vjm x 3.25 % ± 1.25 % (-2.25 % along)",
        "f2": "vjm f2 -3.25 % ± 1.25 %",
        "y": "vjm y below 4.40 % (+0.00 % along)",
        "z": "vjm z 0.00 % with rigid pins, 33.00 % with averaged ones (-33.00 % along)",
    }


def test_runs_without_cases_compare_models(saved, command):
    """Errors and verdicts of both runs, model by model."""
    verdicts = ("adequate", "inadequate")
    paths = [saved(f"{verdict}.json", adequacy=(judged("x", verdict),)) for verdict in verdicts]
    output = command.output("compare", *paths)
    assert re.search(r"vjm +x +\+2\.00 % +adequate +\+2\.00 % +inad", output)


def test_variants_have_no_drift():
    """Runs with different inputs have no drift. Their values in common poses are listed."""
    tables = [{"leg1": {"section": {"t": [4, t]}, "length": 0.8}} for t in (0.004, 0.003)]
    thick = run_of(
        STEADY,
        robot_tables=tables[0],
        adequacy=(judged("x", "adequate", 1.0, 2.0, 3.0), judged("y", "adequate", 1.0)),
    )
    thin = run_of(
        changed(value=2.0),
        robot_tables=tables[1],
        adequacy=(judged("x", "inadequate", 1.5, None, 4.0), judged("f1", "adequate")),
    )
    comparison = compare(thick, thin)
    (change,) = comparison.inputs
    assert (change.key, change.before, change.after) == ("leg1.section.t[2]", 0.004, 0.003)
    assert comparison.drifted == ()
    assert compare(thick, replace(thin, run=thick.run)).drifted != ()
    x, y, f1 = comparison.adequacy
    values = [(value.pose, value.before, value.after) for value in x.values]
    assert values == [((0.1,), 1.0, 1.5), ((0.3,), 3.0, 4.0)]
    assert (x.before.verdict, x.after.verdict, x.after.error) == ("adequate", "inadequate", 0.02)
    assert (y.after, f1.before) == (None, None)
    output = as_text(thick, thin, comparison)
    assert "The input differs" in output
    # What reads the same is left out: of a built-in robot some hundred lines.
    assert "vjm    x " in output
    equal_adequacy = replace(thin, adequacy=thick.adequacy)
    assert "Adequacy" not in as_text(thick, equal_adequacy, compare(thick, equal_adequacy))
    assert "leg1.section.t[2]" in output
    assert as_dict(comparison)["adequacy"][0]["values"][0].keys() == {"pose", "before", "after"}
    comparison_with_itself = compare(thick, thick)
    assert comparison_with_itself.inputs == ()
    assert "Adequacy" not in as_text(thick, thick, comparison_with_itself)


def test_different_postures_are_not_compared():
    """Equal poses drift; values of different poses have no drift."""
    at_start = changed(pose=(0.21,))
    at_equal_pose, at_other_pose = (changed(value=2.0, pose=(x,)) for x in (0.21, 0.6))
    assert drift(at_start, at_equal_pose).beyond
    assert drift(at_start, at_other_pose) is None


def test_different_robots_have_no_ranking(saved, tmp_path, command):
    """Cases of equal name in runs of two robots are not related: no ranking, no drift."""
    wrong = replace(changed(value=9.0), verdict="disagree")
    first = saved("first.json", wrong, robot="five-bar", robot_tables={"a": 1})
    second = saved("second.json", STEADY, robot="delta", robot_tables={"b": 1})
    for pair in ((first, second), (second, first)):
        output = command.output("compare", *pair)
        assert "Two different robots, " in output
        assert not re.search(r"\d+ (better|verdicts worse)|drifted|New cases|Removed", output)
        record = command.json("compare", *pair)
        assert record["different_robots"] == [load_run(path).run["robot"] for path in pair]
        assert not any(record[key] for key in ("verdicts", "new", "removed", "worsened"))
    words = ["run", "five-bar", "--preset", "quick", "--only", "adequacy", "--out"]
    assert "is a run of another robot" in command.error_line(
        *words, tmp_path / "out", "--baseline", second
    )
    assert not (tmp_path / "out").exists()
