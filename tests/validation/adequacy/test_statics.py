"""Adequacy of static models of the paper's robot, against numbers computed without the matrix."""

from dataclasses import replace

import numpy as np
import pytest
from like_ifw import IFW, placed_at, stations

from fem.sections.nonuniform_torsion import held_torsion_compliance
from fem.sections.section_constants import section_constants
from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.legs import Material
from lumped.sections import ISection
from meshes.section.section_mesh import section_mesh
from validation.adequacy.matrix import Matrix
from validation.models.mechanism import answers
from validation.models.options import ModelOptions

EQUIVALENT = ("vjm-equivalent", "segments", "beam")


@pytest.mark.parametrize("quantity", STATIC_QUANTITIES)
def test_the_papers_legs_as_given_hold_in_statics(paper: Matrix, quantity: str) -> None:
    entry = paper.entry("vjm", quantity)
    assert entry.verdict == "adequate"
    # Two formulations that share the data alone, whose digits leave something open.
    digits = entry.uncertainties["digits of the file"]
    assert (entry.error or 0.0) + (entry.uncertainty or 0.0) == pytest.approx(digits, abs=1e-8)
    assert abs(entry.along or 0.0) < 1e-9


@pytest.mark.parametrize("quantity", STATIC_QUANTITIES)
@pytest.mark.parametrize("model", EQUIVALENT)
def test_constant_sections_distort_the_papers_legs(
    paper: Matrix, model: str, quantity: str
) -> None:
    entry = paper.entry(model, quantity)
    assert entry.verdict == "inadequate"
    assert entry.causes[0].cause.startswith("equivalent leg")
    assert sum(cause.share for cause in entry.causes) == pytest.approx(1.0, abs=0.02)
    assert "6×6" in entry.remedy
    # The middle between nothing and what the digits of the 6×6 leave open.
    assert 0.0 < (entry.error_with_remedy or 0.0) < 1e-3


def test_errors_are_those_of_the_models_themselves(paper: Matrix) -> None:
    # 27.9 µm along z by the legs given and 23.7 by those of constant section, at their largest.
    places = placed_at(IFW.mechanism, *stations(IFW.mechanism, 65))
    given, equivalent = (
        np.array([one.compliance for one in answers("vjm", places, 0, ModelOptions(legs=legs))])
        for legs in ("given", "equivalent")
    )
    given, equivalent = given[:, :3, 2], equivalent[:, :3, 2]
    assert given[:, 2].max() * 1e9 == pytest.approx(27.9, abs=0.05)
    assert equivalent[:, 2].max() * 1e9 == pytest.approx(23.7, abs=0.05)
    entry = paper.entry("segments", "z")
    along = (equivalent / given - 1.0)[::8, 2]
    assert entry.alongs == pytest.approx(along, rel=1e-6)
    whole = np.linalg.norm(equivalent - given, axis=1) / np.linalg.norm(given, axis=1)
    assert entry.errors == pytest.approx(whole[::8], rel=1e-6)
    assert entry.error == pytest.approx(whole[::8].max(), rel=1e-6)
    assert entry.along == pytest.approx(along[whole[::8].argmax()], rel=1e-6)


def test_a_rigid_model_knows_no_motion_along_z(paper: Matrix) -> None:
    entry = paper.entry("simplified", "z")
    assert (entry.verdict, entry.error, entry.along) == ("inadequate", 1.0, -1.0)
    assert "no drive lets the tool move this way" in entry.reason
    assert entry.remedy == "use vjm"


def test_torsion_between_held_ends_lies_between_its_two_limits() -> None:
    material = Material.isotropic(2.1e11, 0.3, 7850.0)
    section = ISection(width=0.1, height=0.1, flange=0.008, web=0.006)
    constants = section_constants(section_mesh(section, 8), material.nu)
    polar = constants.second_moment_y + constants.second_moment_z

    def relative(length: float, warping: float) -> float:
        changed = replace(constants, warping_constant=warping)
        held = held_torsion_compliance(changed, material, length)
        return held * material.G * constants.torsion_constant / length

    own = constants.warping_constant
    # Without warping stiffness Saint-Venant's, without room for warping G I_p.
    assert relative(0.9, 0.0) == pytest.approx(1.0, rel=1e-12)
    assert relative(0.9, 1e6 * own) == pytest.approx(constants.torsion_constant / polar, rel=1e-3)
    # Vlasov's factor 1 − tanh(kL/2)/(kL/2) is the limit J ≪ I_p.
    k = np.sqrt(material.G * constants.torsion_constant / (material.E * own))
    vlasov = 1.0 - np.tanh(0.45 * k) / (0.45 * k)
    # It differs by about J/I_p of what warping takes away, three times what it leaves here.
    assert relative(0.9, own) == pytest.approx(vlasov, rel=3.0 * constants.torsion_constant / polar)
