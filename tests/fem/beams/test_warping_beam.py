"""The beam with non-uniform torsion against closed forms and the rod it is made of."""

import numpy as np
import pytest
from prismatic_legs import STEEL

from fem.beams.beam import beam_leg
from fem.beams.warping_beam import warping_beam_leg
from fem.sections.nonuniform_torsion import cantilever_frequencies, held_torsion_compliance
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.legs import tip_compliance
from lumped.models.cantilever import clamped_modes, tip_compliance_of
from lumped.sections import Circle, ISection
from meshes.section.section_mesh import section_mesh

LENGTH = 0.9


@pytest.fixture(scope="module")
def flanged() -> SectionConstants:
    section = ISection(width=0.1, height=0.1, flange=0.008, web=0.006)
    return section_constants(section_mesh(section, 4), STEEL.nu)


def test_free_ends_leave_statics_to_saint_venant(flanged: SectionConstants) -> None:
    found = tip_compliance_of(warping_beam_leg(flanged, STEEL, LENGTH, 20, "free"))
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-16)


def test_held_ends_have_the_closed_forms_torsion_and_nothing_else(
    flanged: SectionConstants,
) -> None:
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    expected[3, 3] = held_torsion_compliance(flanged, STEEL, LENGTH)
    coarse, fine = (
        tip_compliance_of(warping_beam_leg(flanged, STEEL, LENGTH, n, "rigid")) for n in (20, 40)
    )
    # Layers of 1/k at the ends, four elements long: what the fourth order leaves.
    assert coarse == pytest.approx(expected, rel=1e-4, abs=1e-16)
    assert abs(fine[3, 3] - expected[3, 3]) < abs(coarse[3, 3] - expected[3, 3]) / 12.0


def test_torsional_frequencies_are_those_of_the_rod(flanged: SectionConstants) -> None:
    leg = warping_beam_leg(flanged, STEEL, LENGTH, 20, "free")
    modes = clamped_modes(leg, 12)
    twist = leg.centreline(np.array([LENGTH]))[3].toarray().ravel()
    twists = np.abs(twist @ modes.shapes)
    torsional = modes.frequencies[twists > 0.1 * twists.max()]
    expected = cantilever_frequencies(flanged, STEEL, LENGTH, 2)
    assert torsional[:2] == pytest.approx(expected, rel=1e-4)


def test_round_sections_have_nothing_that_warps() -> None:
    constants = section_constants(section_mesh(Circle(diameter=0.1), 8), STEEL.nu)
    found = warping_beam_leg(constants, STEEL, LENGTH, 4, "rigid")
    assert found.size == beam_leg(beam_properties(constants, STEEL), LENGTH, 4).size
