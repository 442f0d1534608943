"""First six frequencies of mechanisms of beams held against EXUDYN, a multibody code.

Its beams are of second order: 8 and 16 a leg extrapolate to within 1e-4 (seen: 7e-5).
"""

import sys
from pathlib import Path

import numpy as np
import pytest

from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.robot_file import load_robot
from validation.models.mechanism import answers

pytest.importorskip("exudyn", reason="EXUDYN (extra exudyn) is not installed")
sys.path.insert(0, str(Path(__file__).parent))

from exudyn_mechanism import frequencies

COARSE, FINE, COUNT = 8, 16, 6


@pytest.mark.slow
@pytest.mark.parametrize("place", ["reference", "off it"])
@pytest.mark.parametrize("name", ["five-bar", "delta", "hexapod"])
def test_first_six_frequencies(name, place):
    mechanism = load_robot(name).mechanism
    off = place == "off it"
    at = posture(mechanism, mechanism.poses[0]) if off else reference_posture(mechanism)
    (expected,) = answers("beam", [at], COUNT)
    count = COUNT + expected.idle
    coarse, fine = (frequencies(at, elements, count) for elements in (COARSE, FINE))
    # What idles stands first, with the frequency that rounding gives it.
    assert (fine[: expected.idle] < 0.1 * expected.frequencies[0]).all()
    extrapolated = (fine + (fine - coarse) / ((FINE / COARSE) ** 2 - 1.0))[expected.idle :]
    np.testing.assert_allclose(extrapolated, expected.frequencies, rtol=2e-4)
