"""`flexproof selftest` judges what it computes, and runs quote how it ended."""

import json

import pytest

from fem.calculix.run import CalculixMissing
from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation import cli
from validation.run import provenance
from validation.selftest import benchmarks
from validation.selftest.benchmarks import Benchmark, KnownNumber

HEADER = provenance.header(load_robot("ifw"), "quick", {})
TODAY = HEADER["started"][:10]


def gives(*found):
    return lambda: [KnownNumber(f"q{k}", "Hz", 2.0, one, 1e-3) for k, one in enumerate(found)]


def raising(error):
    def compare():
        raise error

    return compare


@pytest.fixture
def with_benchmarks(monkeypatch, tmp_path):
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def put(*computations):
        listed = [
            Benchmark(f"title {k}", "problem", f"source {k}", "reason", compute)
            for k, compute in enumerate(computations)
        ]
        monkeypatch.setattr(benchmarks, "benchmarks", lambda: tuple(listed))

    return put


NOT_THERE = raising(CalculixMissing("CalculiX is not installed"))


@pytest.mark.parametrize(
    ("computations", "code", "said"),
    [
        ([gives(2.0, 2.0019), gives(1.9981)], 0, "passed: 3 of 3 numbers agree"),
        ([gives(2.0, 2.0021)], 1, "FAILED: 1 of 2 numbers agree"),
        ([gives(2.0, 1.9979)], 1, "DIFFERS"),
        ([gives(float("nan"))], 1, "DIFFERS"),
        ([gives()], 1, "FAILED: 0 of 0 numbers agree"),
        ([gives(2.0), NOT_THERE], 0, "passed: 1 of 1 numbers agree; skipped: title 1"),
        ([gives(2.0), NOT_THERE], 0, "skipped: CalculiX is not installed"),
        ([raising(ComputationError("no mesh"))], 1, "failed: ComputationError: no mesh"),
    ],
)
def test_it_says_what_agrees_and_runs_quote_it(with_benchmarks, computations, code, said, command):
    with_benchmarks(*computations)
    assert provenance.last_selftest(HEADER) == "not run"
    printed = command.told("selftest", code=code)
    assert said in printed
    assert "source 0" in printed
    assert provenance.last_selftest(HEADER) == f"{'FAILED' if code else 'passed'} on {TODAY}"


def test_what_is_explained_is_no_difference():
    assert KnownNumber("q", "Hz", 2.0, 2.02, 1e-3, explained=0.01).agrees
    assert not KnownNumber("q", "Hz", 2.0, 2.0, 1e-3, explained=0.01).agrees


@pytest.mark.parametrize("changed", ["versions", "suite_sha256"])
def test_another_installation_was_not_tested(with_benchmarks, changed):
    with_benchmarks(gives(2.0))
    assert cli.main(["selftest"]) == 0
    other = {"versions": {**HEADER["versions"], "numpy": "0"}, "suite_sha256": "0"}
    assert provenance.last_selftest(HEADER | {changed: other[changed]}) == "not run"


@pytest.mark.parametrize("content", [b"", b"[1]", b"{}", b"\xff\xfe", b'{"said": "passed"}'])
def test_a_damaged_record_is_none(with_benchmarks, content, tmp_path):
    with_benchmarks(gives(2.0))
    assert cli.main(["selftest"]) == 0
    (kept,) = (tmp_path / "cache").rglob("*.json")
    assert json.loads(kept.read_bytes())["said"] == f"passed on {TODAY}"
    kept.write_bytes(content)
    assert provenance.last_selftest(HEADER) == "not run"


@pytest.mark.parametrize("place", ["off", "in the way"])
def test_where_nothing_can_be_kept_it_is_not_in_the_way(
    with_benchmarks, place, tmp_path, monkeypatch
):
    with_benchmarks(gives(2.0))
    (tmp_path / "in the way").write_text("a file")
    told = "off" if place == "off" else str(tmp_path / "in the way")
    monkeypatch.setenv("FLEXPROOF_CACHE", told)
    assert cli.main(["selftest"]) == 0
    assert provenance.last_selftest(HEADER) == "not run"
