"""All benchmarks agree, stand in the verification manual, and catch models that are wrong."""

import re
import runpy
from math import pi
from pathlib import Path

import numpy as np
import pytest
from prism_waves import beam_wave_frequency, prism_wave_frequency

from fem.bodies.solid import section_twists
from validation.selftest import benchmarks

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
