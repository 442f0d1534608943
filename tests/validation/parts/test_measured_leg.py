"""A tapered hollow leg with lugs: what its solid says, and what its idealisations make of it.

The numbers are known values: measured beforehand with another program's meshes on the same drawing,
and compared there with CalculiX. 0.3 %: both meshes leave 0.1 to 0.2 % at the edges of rigid bores.
"""

import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import held_body
from lumped.legs import GivenLeg, Material, equivalent_leg, tip_compliance
from lumped.mechanism.body import ByCylinder, PartInterface
from lumped.models.bodies import clamped_modes
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
PLATFORM = 46.0


def lowest(stiffness, mass, tip_mass=0.0):
    """Two lowest frequencies (Hz) with the first interface held, a mass at the second."""
    loaded = mass[6:, 6:].copy()
    loaded[:3, :3] += tip_mass * np.eye(3)
    squared = eigh(stiffness[6:, 6:], loaded, eigvals_only=True, subset_by_index=[0, 1])
    return np.sqrt(squared) / (2.0 * np.pi)


@pytest.mark.exhaustive
def test_a_condensed_leg_is_right_and_the_equivalent_one_is_not(tmp_path):
    drawing, path = runpy.run_path(str(EXAMPLES / "make_parts.py")), tmp_path / "leg.step"
    drawing["write"](path, lambda occ: drawing["leg"](occ, drawing["MEASURED"]))
    part = read_part(path)
    bores = {n: PartInterface(ByCylinder(r), "rigid") for n, r in (("A", 0.04), ("B", 0.028))}
    found = find_interfaces(part, bores)
    mesh = volume_mesh(part, found, Grading(0.03))
    meshed = meshed_part(mesh, STEEL)
    mass, body = meshed.properties().mass, held_part(meshed, grips_of(mesh, found), "leg")
    assert mass == pytest.approx(82.84, rel=1e-4)
    assert np.diag(body.compliance)[1:3] == pytest.approx([3.81e-8, 2.51e-8], rel=3e-3)
    alone = body.modes(2).frequencies
    assert alone == pytest.approx([199.5, 245.1], rel=3e-3)
    reduced = reduction(held_body(body), 600.0)
    assert lowest(reduced.stiffness, reduced.mass) == pytest.approx([199.5, 245.1], rel=3e-3)
    solid = lowest(reduced.stiffness, reduced.mass, PLATFORM)
    assert solid == pytest.approx([103.2, 127.1], rel=3e-3)
    condensed = lowest(body.stiffness, body.condensed_mass, PLATFORM)
    assert condensed == pytest.approx(solid, rel=1e-3)
    assert np.all(condensed >= solid * (1.0 - 1e-9))
    given = GivenLeg(0.85, mass, body.compliance)
    for by, expected, error in (
        ("stiffness", [140.6, 176.7], -0.28),
        ("compliance", [171.4, 205.6], -0.15),
    ):
        prism = equivalent_leg(given, by)
        frequencies = clamped_modes(beam_leg(prism.timoshenko, 0.85, 20), 2).frequencies
        assert frequencies == pytest.approx(expected, rel=3e-3)
        assert frequencies / alone - 1.0 == pytest.approx([error, error], abs=0.02)
    stiff = equivalent_leg(given, "stiffness")
    softer = np.diag(tip_compliance(stiff.timoshenko, 0.85)) / np.diag(body.compliance)
    assert softer[1:3] == pytest.approx([1.63, 1.54], abs=0.01)
