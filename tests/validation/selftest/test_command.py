"""Command `selftest`: verdicts, how runs quote them, and the values in the manual."""

import json
import re
import runpy
from math import pi
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from support.oracles.prism_waves import beam_wave_frequency, prism_wave_frequency

from fem.bodies.solid import section_twists
from fem.calculix.run import CalculixMissing
from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.run import provenance
from validation.selftest import benchmarks
from validation.selftest.benchmarks import Benchmark, KnownNumber

HEADER = provenance.header(load_robot("ifw"), "quick", {})
PASSED = f"passed on {HEADER['started'][:10]}"


def numbers(*computed):
    return [KnownNumber("q", "Hz", 2.0, value, 1e-3) for value in computed]


@pytest.fixture
def selftest(monkeypatch, tmp_path, command):
    """Function that runs `selftest` on made-up outcomes (numbers or errors); returns its text."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def run(*outcomes, code=0):
        artificial = [
            Benchmark(f"title {k}", "problem", f"source {k}", "reason", Mock(side_effect=[result]))
            for k, result in enumerate(outcomes)
        ]
        monkeypatch.setattr(benchmarks, "benchmarks", lambda: tuple(artificial))
        return command.output("selftest", code=code)

    return run


MISSING = CalculixMissing("CalculiX is not installed")


@pytest.mark.parametrize(
    ("outcomes", "code", "message"),
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
def test_selftest_result_is_quoted_by_runs(selftest, outcomes, code, message):
    """Runs quote the last self-test of this version: passed, failed or not run."""
    assert provenance.last_selftest(HEADER) == "not run"
    text = selftest(*outcomes, code=code)
    assert message in text
    assert "source 0" in text
    quoted = PASSED.replace("passed", "FAILED") if code else PASSED
    assert provenance.last_selftest(HEADER) == quoted


def test_explained_benchmark_difference_agrees():
    """A known effect of 1 %, in the benchmark or not."""
    assert KnownNumber("q", "Hz", 2.0, 2.02, 1e-3, explained=0.01).agrees
    assert not KnownNumber("q", "Hz", 2.0, 2.0, 1e-3, explained=0.01).agrees


def test_selftest_of_other_version_is_ignored(selftest, tmp_path):
    """Other libraries or sources, or a damaged record: "not run"."""
    selftest(numbers(2.0))
    changes = {"versions": {**HEADER["versions"], "numpy": "0"}, "suite_sha256": "0"}
    for name, changed in changes.items():
        assert provenance.last_selftest(HEADER | {name: changed}) == "not run"
    (record,) = (tmp_path / "cache").rglob("*.json")
    assert json.loads(record.read_bytes())["result"] == PASSED
    for content in (b"", b"[1]", b"{}", b"\xff\xfe", b'{"result": "passed"}'):
        record.write_bytes(content)
        assert provenance.last_selftest(HEADER) == "not run"


@pytest.mark.parametrize("cache", ["off", "in the way"])
def test_selftest_runs_without_a_cache(selftest, cache, tmp_path, monkeypatch):
    """Without a cache the result is printed, but not quoted by later runs."""
    monkeypatch.chdir(tmp_path)
    Path("in the way").write_text("a file")
    monkeypatch.setenv("FLEXPROOF_CACHE", cache)
    selftest(numbers(2.0))
    assert provenance.last_selftest(HEADER) == "not run"


ROOT = Path(__file__).resolve().parents[3]
MANUAL = runpy.run_path(str(ROOT / "docs" / "pictures" / "verification.py"))
PAGE = MANUAL["PAGE"].read_text(encoding="utf-8")
OWN, FURTHER = MANUAL["listed"]()
LISTED = {benchmark.title: benchmark for benchmark in (*OWN, *FURTHER)}


@pytest.mark.parametrize("title", LISTED)
def test_benchmarks_agree_with_guide(title):
    """Each benchmark agrees, and its section of verification.md has the computed numbers."""
    outcome = benchmarks.outcome(LISTED[title])
    if outcome.verdict == "skipped":
        pytest.skip(outcome.message)
    assert outcome.verdict == "agrees", (outcome.message, outcome.numbers)
    outdated = "renew docs/guide/verification.md: python docs/pictures/verification.py"
    assert MANUAL["section"](list(LISTED).index(title) + 1, outcome) in PAGE, outdated


def test_guide_has_all_benchmarks():
    """The self-test has at most 40 numbers."""
    assert PAGE.startswith(MANUAL["head"]())
    assert PAGE.endswith(MANUAL["FOOT"])
    assert re.findall(r"^## \d+\. (.*)$", PAGE, re.MULTILINE) == list(LISTED)
    end = PAGE.index(f". {FURTHER[0].title}")
    assert len(re.findall(r"^\| (?!quantity)", PAGE[:end], re.MULTILINE)) <= 40


def test_fv5_solid_rotates_at_its_ends():
    """In NAFEMS FV5 the ends are simply supported: end sections rotate, but do not move."""
    beam = benchmarks.extruded(benchmarks.DEEP, 2, 6)
    shapes = benchmarks.simply_supported(beam).modes(2).shapes
    twists = section_twists(beam.mesh, np.array([0.0, 5.0, 10.0])) @ shapes
    first, middle, last = twists.reshape(3, 6, 2)
    largest = np.abs(middle[1:3]).max()
    # The constraints weight the face by parabolic shear. Section twists are plain means, which are
    # slightly different.
    assert np.abs([first[1:3], last[1:3]]).max() < 0.01 * largest
    assert np.abs(first[[0, 3]]).max() < 0.01 * largest
    # Half a wave of amplitude 1 over 10 m rotates the ends by π/10, less the shear angle.
    assert 0.8 * pi / 10.0 < np.abs(first[4:]).max() / largest < pi / 10.0


def test_fv5_explained_part_is_beam_theory():
    """The reference values of NAFEMS FV5 are those of beam theory, from which a solid differs."""
    kinds = ("bending", "torsion", "tension", "bending", "torsion", "bending")
    # Half waves of each mode along the beam.
    halves = (1.0, 0.5, 0.5, 2.0, 1.5, 3.0)
    deep = benchmarks.DEEP
    for kind, half, (_, explained) in zip(kinds, halves, benchmarks.FV5_MODES, strict=True):
        wavenumber = half * pi / deep.length
        prism = prism_wave_frequency(deep.section, deep.material, kind, wavenumber)
        beam = beam_wave_frequency(deep.timoshenko, kind, wavenumber)
        assert prism / beam - 1.0 == pytest.approx(explained, abs=1e-7)
