"""Uniform beams that have the 6×6 compliance of a given leg, against formulas of straight beams."""

from dataclasses import astuple, replace

import numpy as np
import pytest

from fem.beams.interior import interior_beam, interior_properties
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.beam_properties import tip_compliance
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Material
from lumped.models.bodies import tip_compliance_of
from lumped.sections import Rectangle, Tube

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
PRISM = ConstantLeg(0.5, Rectangle(width=0.08, height=0.12), STEEL)


def given_leg(leg):
    return GivenLeg(leg.length, leg.mass, tip_compliance(leg.timoshenko, leg.length))


def test_beam_from_6x6_recovers_prism():
    """The beam fitted to the 6×6 of a prism has the constants of that prism."""
    interior = interior_properties(given_leg(PRISM), "uniform")
    assert astuple(interior) == pytest.approx(astuple(PRISM.timoshenko), rel=1e-8)


@pytest.mark.parametrize("interior", ["uniform", "stiff"])
def test_beams_from_6x6_keep_end_stiffness(interior):
    """K11 to K44 are unchanged: stiffnesses for ends that do not rotate about y and z."""
    leg = given_leg(PRISM)
    expected, computed = (
        np.diag(np.linalg.inv(c))[[0, 1, 2, 3]]
        for c in (leg.compliance, tip_compliance_of(interior_beam(leg, interior, 20)))
    )
    # The discretisation error of torsion by warping is 1e-5.
    assert computed == pytest.approx(expected, rel=1e-4 if interior == "stiff" else 1e-8)


def test_fixed_warping_doubles_torsion_mode():
    """First ω: warping 22.373/L² √(EΓ/ρI_p), Saint-Venant π/L √(GJ/ρI_p); the ratio is 2.056."""
    leg = given_leg(PRISM)
    soft = leg.compliance.copy()
    soft[3, 3] *= 300.0
    torsion = replace(leg, compliance=soft)
    first = {kind: held_frequencies(torsion, kind)[0] for kind in ("uniform", "stiff")}
    # With this torsional compliance the first mode with held ends is torsional; G I_p, here 400
    # times GJ, changes it by less than 1 %.
    expected = 22.3733 / (np.pi * np.sqrt(12.0))
    assert first["stiff"] / first["uniform"] == pytest.approx(expected, rel=1e-2)


def test_tube_from_6x6_has_polar_moment():
    """The fitted beam of a tube has GJ = (EIy + EIz)/2(1 + ν), as any round section does."""
    tube = given_leg(ConstantLeg(0.5, Tube(0.1, 0.01), STEEL))
    uniform = interior_properties(tube, "uniform")
    core = (uniform.EIy + uniform.EIz) / 2.6
    assert uniform.GJ / core == pytest.approx(1.0, rel=1e-9)
    assert "torsion" in interior_beam(tube, "stiff", 4).parts
    assert interior_beam(tube, "stiff", 4).model == "beam"


def test_interior_stiffness_raises_6x6_frequencies():
    """With both ends held, frequencies rise from soft over uniform to stiff inside."""
    soft, uniform, stiff = (
        held_frequencies(given_leg(PRISM), kind)[:6] for kind in ("soft", "uniform", "stiff")
    )
    assert (soft < uniform).all()
    assert (uniform <= stiff).all()


def test_flexible_tip_keeps_transverse_stiffness():
    """A flexible tip increases c66 above L/EI. κGA is then taken from EA, and K22 is unchanged."""
    leg = given_leg(PRISM)
    turning = leg.compliance.copy()
    turning[5, 5] *= 6.0
    hinged = replace(leg, compliance=turning)
    interior = interior_properties(hinged, "uniform")
    k22 = np.linalg.inv(turning)[1, 1]
    assert interior.GAy == pytest.approx(interior.EA / 2.6)
    flexibility = leg.length**3 / (12.0 * interior.EIz) + leg.length / interior.GAy
    assert flexibility == pytest.approx(1.0 / k22, rel=1e-9)


def test_indefinite_6x6_is_refused():
    leg = given_leg(PRISM)
    with pytest.raises(InputError, match="not positive definite"):
        interior_properties(replace(leg, compliance=-leg.compliance), "uniform")


def held_frequencies(leg, interior):
    """Return the natural frequencies (Hz) with both ends held."""
    return craig_bampton(held_leg(interior_beam(leg, interior, 20)), 4000.0).frequencies
