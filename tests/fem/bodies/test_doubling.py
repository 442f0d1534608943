"""Condensation by doubling, held against direct solves, beam theory and extended precision."""

import numpy as np
import pytest
from compliances import scaled_difference

from fem.bodies.doubling import condensed_leg, tip_compliance
from fem.bodies.solid import clamped_leg, solid_leg
from fem.sections.section_constants import beam_properties, section_constants
from lumped.legs import ConstantLeg, Material
from lumped.legs import tip_compliance as beam_tip_compliance
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism.hexahedra import extrude, stations
from meshes.section.section_mesh import section_mesh

CUBIC = Material(E=2.1e11, G=1.2e11, nu=0.25, rho=7850.0)
SECTIONS = [
    (Rectangle(0.10, 0.16), 2),
    (Tube(0.12, 0.012), 4),
    (ISection(0.10, 0.16, 0.012, 0.008), 3),
]


@pytest.mark.parametrize(
    ("section", "divisions"), SECTIONS, ids=[section.shape for section, _ in SECTIONS]
)
def test_tip_compliance_is_that_of_the_direct_solve(section, divisions):
    leg = ConstantLeg(0.8, section, CUBIC)
    face = section_mesh(section, divisions)
    # Doubled, and a slice joined: 7 is 111 in binary.
    slices = 7
    condensed = condensed_leg(leg, face, slices)
    solid = solid_leg(leg, extrude(face, stations(leg.length, slices)))
    for ends in ("rigid", "free"):
        direct = clamped_leg(solid, ends).compliance
        # The limit. Slices hundred times as long as a wall is thick come closest to it:
        # there the direct solve loses digits to the condition of single elements.
        assert scaled_difference(tip_compliance(condensed, ends), direct) < 1e-9


def test_free_ends_reach_beam_theory():
    """Saint-Venant's solution but for the cubic deflection on quadratic slices: error ~ n⁻⁴."""
    leg = ConstantLeg(8.0, Rectangle(0.16, 0.08), CUBIC)
    section = section_mesh(leg.section, (2, 1))
    constants = section_constants(section, CUBIC.nu, CUBIC.G / CUBIC.E)
    beam = beam_tip_compliance(beam_properties(constants, CUBIC), leg.length)
    coarse, fine = (
        scaled_difference(tip_compliance(condensed_leg(leg, section, n), "free"), beam)
        for n in (256, 1024)
    )
    # (L/h)² of slenderness stands before n⁻⁴.
    assert coarse < 1e-7
    assert fine < 1e-9
    assert np.log(coarse / fine) / np.log(4.0) == pytest.approx(4.0, abs=0.2)
