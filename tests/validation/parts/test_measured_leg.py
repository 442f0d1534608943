"""A tapered hollow leg with lugs: what its solid says, and what its idealisations make of it.

The numbers are known values: measured beforehand with another program's meshes on the same drawing,
and compared there with CalculiX. 0.3 %: both meshes leave 0.1 to 0.2 % at the edges of rigid bores.
"""

import runpy
from pathlib import Path

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from lumped.legs import GivenLeg, equivalent_leg, tip_compliance
from lumped.models.bodies import clamped_modes
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.parts.identify import identify
from validation.parts.request import interfaces_of

DRAWINGS = Path(__file__).resolve().parents[3] / "examples" / "make_parts.py"


@pytest.mark.exhaustive
def test_a_condensed_leg_is_right_and_the_equivalent_one_is_not(tmp_path):
    drawing, path = runpy.run_path(str(DRAWINGS)), tmp_path / "leg.step"
    drawing["write"](path, lambda occ: drawing["leg"](occ, drawing["MEASURED"]))
    bores = (f"{n} = {{ cylinder = {{ radius = {r} }} }}" for n, r in (("A", 0.04), ("B", 0.028)))
    part = read_part(path)
    found = identify(part, find_interfaces(part, *interfaces_of(bores)), STEEL, 60_000, 2)
    assert found.total == pytest.approx(82.84, rel=1e-4)
    assert np.diag(found.compliance)[1:3] == pytest.approx([3.81e-8, 2.51e-8], rel=3e-3)
    assert found.frequencies == pytest.approx([199.5, 245.1], rel=3e-3)
    # With a platform at the tip, the root clamped.
    loaded = found.mass[6:, 6:] + 46.0 * np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    squared = eigh(found.stiffness[6:, 6:], loaded, eigvals_only=True)[:2]
    assert np.sqrt(squared) / (2.0 * np.pi) == pytest.approx([103.2, 127.1], rel=3e-3)
    given = GivenLeg(0.85, found.total, found.compliance)
    for by, expected, error in (
        ("stiffness", [140.6, 176.7], -0.28),
        ("compliance", [171.4, 205.6], -0.15),
    ):
        prism = equivalent_leg(given, by)
        frequencies = clamped_modes(beam_leg(prism.timoshenko, 0.85, 20), 2).frequencies
        assert frequencies == pytest.approx(expected, rel=3e-3)
        assert frequencies / found.frequencies - 1.0 == pytest.approx([error, error], abs=0.02)
    stiff = equivalent_leg(given, "stiffness")
    softer = np.diag(tip_compliance(stiff.timoshenko, 0.85)) / np.diag(found.compliance)
    assert softer[1:3] == pytest.approx([1.63, 1.54], abs=0.01)
