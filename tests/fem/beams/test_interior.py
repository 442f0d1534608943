"""Uniform beams that have the 6×6 of a leg, by formulas of straight beams."""

from dataclasses import astuple, replace

import numpy as np
import pytest

from fem.beams.interior import interior_beam, interior_properties
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Material, tip_compliance
from lumped.models.bodies import tip_compliance_of
from lumped.sections import Rectangle, Tube

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
PRISM = ConstantLeg(0.5, Rectangle(width=0.08, height=0.12), STEEL)


def given(leg):
    return GivenLeg(leg.length, leg.mass, tip_compliance(leg.timoshenko, leg.length))


def test_uniform_interior_is_the_beam_of_the_6x6():
    found, expected = interior_properties(given(PRISM), "uniform"), PRISM.timoshenko
    assert astuple(found) == pytest.approx(astuple(expected), rel=1e-8)


@pytest.mark.parametrize("interior", ["uniform", "stiff"])
def test_interiors_have_equal_end_stiffness(interior):
    """K22, K33 and K44 of the leg: what its ends do to each other if they do not turn."""
    leg = given(PRISM)
    own, found = (
        np.diag(np.linalg.inv(c))[[0, 1, 2, 3]]
        for c in (leg.compliance, tip_compliance_of(interior_beam(leg, interior, 20)))
    )
    # Warping follows the quadratic elements to 1e-5.
    assert found == pytest.approx(own, rel=1e-4 if interior == "stiff" else 1e-8)


def test_torsion_by_warping_doubles_the_held_frequency():
    """Clamped beam 22.373/L² √(EΓ/ρI_p) by π/L √(GJ/ρI_p) with GJ = 12 EΓ/L²: 2.056."""
    leg = given(PRISM)
    soft = leg.compliance.copy()
    soft[3, 3] *= 300.0
    torsion = replace(leg, compliance=soft)
    first = {kind: held_frequencies(torsion, kind)[0] for kind in ("uniform", "stiff")}
    # The first held mode of so soft a leg is torsional; G I_p is finite, 400 times GJ.
    expected = 22.3733 / (np.pi * np.sqrt(12.0))
    assert first["stiff"] / first["uniform"] == pytest.approx(expected, rel=1e-2)


def test_round_section_resists_twist_by_its_core_alone():
    tube = given(ConstantLeg(0.5, Tube(0.1, 0.01), STEEL))
    uniform = interior_properties(tube, "uniform")
    core = (uniform.EIy + uniform.EIz) / 2.6
    assert uniform.GJ / core == pytest.approx(1.0, rel=1e-9)
    assert "torsion" in interior_beam(tube, "stiff", 4).parts
    assert interior_beam(tube, "stiff", 4).model == "beam"


def test_held_frequencies_rise_from_soft_to_stiff():
    soft, uniform, stiff = (
        held_frequencies(given(PRISM), kind)[:6] for kind in ("soft", "uniform", "stiff")
    )
    assert (soft < uniform).all()
    assert (uniform <= stiff).all()


def test_flexible_end_keeps_transverse_stiffness():
    """A tip that turns by itself raises c66, which then is not L/EI."""
    leg = given(PRISM)
    turning = leg.compliance.copy()
    turning[5, 5] *= 6.0
    hinged = replace(leg, compliance=turning)
    found = interior_properties(hinged, "uniform")
    k22 = np.linalg.inv(turning)[1, 1]
    assert found.GAy == pytest.approx(found.EA / 2.6)
    flexibility = leg.length**3 / (12.0 * found.EIz) + leg.length / found.GAy
    assert flexibility == pytest.approx(1.0 / k22, rel=1e-9)


def test_indefinite_compliance_is_refused():
    leg = given(PRISM)
    with pytest.raises(InputError, match="not positive definite"):
        interior_properties(replace(leg, compliance=-leg.compliance), "uniform")


def held_frequencies(leg, interior):
    """Frequencies (Hz) with both ends held."""
    return craig_bampton(held_leg(interior_beam(leg, interior, 20)), 4000.0).frequencies
