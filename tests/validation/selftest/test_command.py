"""`flexproof selftest` judges what it computes, runs quote it; its numbers are the manual's."""

import json
import re
import runpy
from math import pi
from pathlib import Path

import numpy as np
import pytest
from prism_waves import beam_wave_frequency, prism_wave_frequency

from fem.bodies.solid import section_twists
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


ROOT = Path(__file__).resolve().parents[3]
MANUAL = runpy.run_path(str(ROOT / "docs" / "pictures" / "verification.py"))
PAGE = MANUAL["PAGE"].read_text(encoding="utf-8")
OWN, FURTHER = MANUAL["listed"]()


@pytest.mark.parametrize(
    ("number", "benchmark"),
    list(enumerate((*OWN, *FURTHER), start=1)),
    ids=[benchmark.title for benchmark in (*OWN, *FURTHER)],
)
def test_the_numbers_agree_and_are_those_of_the_manual(number, benchmark):
    found = benchmarks.outcome(benchmark)
    if found.verdict == "skipped":
        pytest.skip(found.message)
    assert found.verdict == "agrees", (found.message, found.compared)
    old = "renew docs/guide/verification.md: python docs/pictures/verification.py"
    assert MANUAL["section"](number, found) in PAGE, old


def test_the_manual_has_all_benchmarks_and_no_others():
    assert PAGE.startswith(MANUAL["head"]())
    titles = re.findall(r"^## \d+\. (.*)$", PAGE, re.MULTILINE)
    assert titles == [benchmark.title for benchmark in (*OWN, *FURTHER)]


def test_the_selftest_is_short():
    of_tests = PAGE.index(f". {FURTHER[0].title}")
    assert len(re.findall(r"^\| (?!quantity)", PAGE[:of_tests], re.MULTILINE)) <= 40


def test_a_simply_supported_solid_is_held_on_average_and_turns_at_its_ends():
    beam = benchmarks.extruded(benchmarks.DEEP, 2, 6)
    shapes = benchmarks.simply_supported(beam).modes(2).shapes
    twists = section_twists(beam.mesh, np.array([0.0, 5.0, 10.0])) @ shapes
    first, middle, last = twists.reshape(3, 6, 2)
    largest = np.abs(middle[1:3]).max()
    # The conjugate of the parabolic shear is not quite the plain mean that is taken here.
    assert np.abs([first[1:3], last[1:3]]).max() < 0.01 * largest
    assert np.abs(first[[0, 3]]).max() < 0.01 * largest
    # Half a wave of amplitude 1 over 10 m turns its ends by π/10, shear taking a part of it.
    assert 0.8 * pi / 10.0 < np.abs(first[4:]).max() / largest < pi / 10.0


@pytest.mark.parametrize(
    ("mode", "kind", "halves"),
    [
        (0, "bending", 1.0),
        (1, "torsion", 0.5),
        (2, "tension", 0.5),
        (3, "bending", 2.0),
        (4, "torsion", 1.5),
        (5, "bending", 3.0),
    ],
)
def test_what_beam_theory_neglects_is_that_of_the_prisms_waves(mode, kind, halves):
    """So many half waves of each mode along the beam."""
    deep, (_, explained) = benchmarks.DEEP, benchmarks.FV5_MODES[mode]
    wavenumber = halves * pi / deep.length
    prism = prism_wave_frequency(deep.section, deep.material, kind, wavenumber)
    beam = beam_wave_frequency(deep.timoshenko, kind, wavenumber)
    assert prism / beam - 1.0 == pytest.approx(explained, abs=1e-7)
