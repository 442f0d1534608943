"""`flexproof selftest` judges what it computes, runs quote it; its numbers are the manual's."""

import json
import re
import runpy
from math import pi
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from prism_waves import beam_wave_frequency, prism_wave_frequency

from fem.bodies.solid import section_twists
from fem.calculix.run import CalculixMissing
from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.run import provenance
from validation.selftest import benchmarks
from validation.selftest.benchmarks import Benchmark, KnownNumber

HEADER = provenance.header(load_robot("ifw"), "quick", {})
PASSED = f"passed on {HEADER['started'][:10]}"


def numbers(*found):
    return [KnownNumber("q", "Hz", 2.0, one, 1e-3) for one in found]


@pytest.fixture
def selftest(monkeypatch, tmp_path, command):
    """`flexproof selftest` of made-up benchmarks, each of numbers or an error: what it prints."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def run(*outcomes, code=0):
        listed = [
            Benchmark(f"title {k}", "problem", f"source {k}", "reason", Mock(side_effect=[found]))
            for k, found in enumerate(outcomes)
        ]
        monkeypatch.setattr(benchmarks, "benchmarks", lambda: tuple(listed))
        return command.told("selftest", code=code)

    return run


MISSING = CalculixMissing("CalculiX is not installed")


@pytest.mark.parametrize(
    ("outcomes", "code", "said"),
    [
        ([numbers(2.0, 2.0019), numbers(1.9981)], 0, "passed: 3 of 3 numbers agree"),
        ([numbers(2.0, 2.0021)], 1, "FAILED: 1 of 2 numbers agree"),
        ([numbers(2.0, 1.9979)], 1, "DIFFERS"),
        ([numbers(float("nan"))], 1, "DIFFERS"),
        ([[]], 1, "FAILED: 0 of 0 numbers agree"),
        ([numbers(2.0), MISSING], 0, "passed: 1 of 1 numbers agree; skipped: title 1"),
        ([numbers(2.0), MISSING], 0, "skipped: CalculiX is not installed"),
        ([ComputationError("no mesh")], 1, "failed: ComputationError: no mesh"),
    ],
)
def test_it_says_what_agrees_and_runs_quote_it(selftest, outcomes, code, said):
    assert provenance.last_selftest(HEADER) == "not run"
    printed = selftest(*outcomes, code=code)
    assert said in printed
    assert "source 0" in printed
    quoted = PASSED.replace("passed", "FAILED") if code else PASSED
    assert provenance.last_selftest(HEADER) == quoted


def test_what_is_explained_is_no_difference():
    assert KnownNumber("q", "Hz", 2.0, 2.02, 1e-3, explained=0.01).agrees
    assert not KnownNumber("q", "Hz", 2.0, 2.0, 1e-3, explained=0.01).agrees


def test_of_another_installation_or_in_a_damaged_record_it_is_not_known(selftest, tmp_path):
    selftest(numbers(2.0))
    other = {"versions": {**HEADER["versions"], "numpy": "0"}, "suite_sha256": "0"}
    for name, changed in other.items():
        assert provenance.last_selftest(HEADER | {name: changed}) == "not run"
    (kept,) = (tmp_path / "cache").rglob("*.json")
    assert json.loads(kept.read_bytes())["said"] == PASSED
    for content in (b"", b"[1]", b"{}", b"\xff\xfe", b'{"said": "passed"}'):
        kept.write_bytes(content)
        assert provenance.last_selftest(HEADER) == "not run"


@pytest.mark.parametrize("place", ["off", "in the way"])
def test_where_nothing_can_be_kept_it_is_not_in_the_way(selftest, place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("in the way").write_text("a file")
    monkeypatch.setenv("FLEXPROOF_CACHE", place)
    selftest(numbers(2.0))
    assert provenance.last_selftest(HEADER) == "not run"


ROOT = Path(__file__).resolve().parents[3]
MANUAL = runpy.run_path(str(ROOT / "docs" / "pictures" / "verification.py"))
PAGE = MANUAL["PAGE"].read_text(encoding="utf-8")
OWN, FURTHER = MANUAL["listed"]()
LISTED = {benchmark.title: benchmark for benchmark in (*OWN, *FURTHER)}


@pytest.mark.parametrize("title", LISTED)
def test_the_numbers_agree_and_are_those_of_the_manual(title):
    found = benchmarks.outcome(LISTED[title])
    if found.verdict == "skipped":
        pytest.skip(found.message)
    assert found.verdict == "agrees", (found.message, found.compared)
    old = "renew docs/guide/verification.md: python docs/pictures/verification.py"
    assert MANUAL["section"](list(LISTED).index(title) + 1, found) in PAGE, old


def test_the_manual_has_all_benchmarks_and_no_others_and_the_selftest_is_short():
    assert PAGE.startswith(MANUAL["head"]())
    assert PAGE.endswith(MANUAL["FOOT"])
    assert re.findall(r"^## \d+\. (.*)$", PAGE, re.MULTILINE) == list(LISTED)
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


def test_what_beam_theory_neglects_is_that_of_the_prisms_waves():
    kinds = ("bending", "torsion", "tension", "bending", "torsion", "bending")
    # Half waves of each mode along the beam.
    halves = (1.0, 0.5, 0.5, 2.0, 1.5, 3.0)
    deep = benchmarks.DEEP
    for kind, half, (_, explained) in zip(kinds, halves, benchmarks.FV5_MODES, strict=True):
        wavenumber = half * pi / deep.length
        prism = prism_wave_frequency(deep.section, deep.material, kind, wavenumber)
        beam = beam_wave_frequency(deep.timoshenko, kind, wavenumber)
        assert prism / beam - 1.0 == pytest.approx(explained, abs=1e-7)
