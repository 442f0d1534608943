"""A leg alone: what a robot's feet hide, against numbers computed otherwise."""

from dataclasses import replace

import pytest

from fem.bodies import doubling
from fem.sections.section_constants import section_constants
from lumped.acceptance.requirement import Requirement
from lumped.legs import ConstantLeg, Leg, Material, tip_compliance
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import HollowRectangle, ISection
from meshes.section.section_mesh import section_mesh
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.robot import leg_subject
from validation.context import Context
from validation.solids.legs import COARSEST_WALLS

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
FLANGED = ConstantLeg(
    0.9, ISection(width=0.1, height=0.1, flange=0.008, web=0.006), STEEL, ends="rigid"
)


def adequacy(leg: Leg) -> Matrix:
    """The leg's matrix at preset quick."""
    subject = leg_subject(Context(load_robot("ifw"), "quick"), "leg1", leg)
    return judged(subject, Requirement())


@pytest.fixture(scope="module")
def flanged() -> Matrix:
    return adequacy(FLANGED)


def test_torsion_of_an_i_section_between_held_ends_is_inadequate_by_beams(flanged: Matrix) -> None:
    entry = flanged.entry("beam", "phi_x")
    assert entry.verdict == "inadequate"
    # 3.7 times the compliance of the solid, from a mesh of its own.
    mesh = section_mesh(FLANGED.section, 4)
    solid = doubling.tip_compliance(doubling.condensed_leg(FLANGED, mesh, 64), "rigid")[3, 3]
    own = tip_compliance(FLANGED.timoshenko, FLANGED.length)[3, 3]
    assert own / solid == pytest.approx(3.7, abs=0.05)
    assert entry.error == pytest.approx(own / solid - 1.0, abs=2.0 * (entry.uncertainty or 0.0))


def test_its_cause_is_warping_and_a_solid_has_it(flanged: Matrix) -> None:
    entry = flanged.entry("beam", "phi_x")
    first = entry.causes[0]
    assert first.cause == "warping held at the ends"
    assert first.share == pytest.approx(1.0, abs=0.05)
    assert (entry.remedy, entry.error_with_remedy) == ("use solid", 0.0)


def test_free_ends_leave_saint_venants_torsion_as_it_is() -> None:
    entry = adequacy(replace(FLANGED, ends="free")).entry("beam", "phi_x")
    # The thin-walled J alone is off; inward corners leave the quick mesh 4 % uncertain.
    assert entry.along == pytest.approx(0.0, abs=0.02)
    # Of an error that has no sign the middle of what is left open is not its best estimate.
    assert entry.error - entry.uncertainty >= 0.0
    assert entry.error < 0.03
    assert [cause.cause for cause in entry.causes] == ["textbook section constants"]


def test_unsaid_ends_leave_torsion_undecided_and_say_what_decides() -> None:
    entry = adequacy(replace(FLANGED, ends=None)).entry("beam", "phi_x")
    assert entry.verdict == "undecided"
    assert entry.reason.endswith("in [leg1]")
    assert entry.uncertainties["how the ends are held"] > 1.0


@pytest.mark.exhaustive
def test_walls_that_allow_one_section_mesh_leave_its_constants_open() -> None:
    """Of a millimetre: both solids share the coarsest mesh, and its torsion is 0.15 % uncertain."""
    section = HollowRectangle(width=0.1, height=0.16, thickness=0.001)
    entry = adequacy(ConstantLeg(0.9, section, STEEL, ends="free")).entry("beam", "phi_x")
    coarse, fine = (
        section_constants(section_mesh(section, number), 0.3).torsion_constant
        for number in (COARSEST_WALLS, 8)
    )
    # Roache's factor three for two meshes of the lowest order there can be, 4/3.
    open_of_section = 3.0 / ((8 / COARSEST_WALLS) ** (4 / 3) - 1.0) * abs(fine / coarse - 1.0)
    assert open_of_section == pytest.approx(0.00147, abs=1e-5)
    assert open_of_section <= entry.uncertainties["meshes"] <= 1.05 * open_of_section


def test_a_given_leg_is_its_own_reference() -> None:
    matrix = adequacy(legs_of(load_robot("ifw").mechanism)["leg1"])
    assert matrix.verdict("vjm") == "adequate"
    entry = matrix.entry("beam", "y")
    assert entry.verdict == "inadequate"
    assert entry.causes[0].cause.startswith("equivalent leg")
    assert "6×6" in entry.remedy
    # The digits of the file leave so much open of it, of which the middle is told.
    assert entry.error_with_remedy == pytest.approx(0.0, abs=2e-3)
