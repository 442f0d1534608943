"""Stresses along tapered and stepped legs, against closed forms."""

import numpy as np
import pytest

from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import Rectangle
from lumped.system.members import MemberForces
from validation.forces.stresses import _loaded_sections, member_stress

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LENGTH, FORCE = 1.2, 1000.0


def cantilever(*stations):
    """A leg with sections at stations and its section forces under a force along z at the tip."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    positions = np.linspace(0.0, LENGTH, 13)
    forces = np.zeros((13, 6))
    forces[:, 2], forces[:, 4] = FORCE, -FORCE * (LENGTH - positions)
    return LineLeg(line, stations, STEEL), MemberForces("arm", positions, forces, np.zeros(6))


def test_deep_taper_stress_peaks_at_twice_tip_height():
    """S. P. Timoshenko, Strength of Materials: σ = 6Fξ/bh² is largest where h is twice the tip's.

    With h from 2 cm at the tip to 8 cm, this is L/3 from the tip, σ = FL/2bh².
    """
    leg, member = cantilever((0.0, Rectangle(0.03, 0.08)), (LENGTH, Rectangle(0.03, 0.02)))
    stress = member_stress(leg, member)
    expected = FORCE * LENGTH / (2.0 * 0.03 * 0.02**2)
    assert stress.station == pytest.approx(LENGTH * 2.0 / 3.0, rel=1e-9)
    assert stress.largest == pytest.approx(expected, rel=1e-5)
    assert stress.along[0] == pytest.approx(6.0 * FORCE * LENGTH / (0.03 * 0.08**2), rel=1e-5)
    assert abs(stress.point[1]) == pytest.approx(0.02, rel=1e-9)


def test_inclined_fibres_carry_shear_of_wedge():
    """Michell: a part F h_tip/h of the tip force F on a wedge shears the section of height h."""
    leg, member = cantilever((0.0, Rectangle(0.03, 0.1)), (LENGTH, Rectangle(0.03, 0.05)))
    heights, shearing = zip(
        *((section.height, forces[2]) for _, section, forces in _loaded_sections(leg, member)),
        strict=True,
    )
    # Rates of the taper are those of a polynomial of degree 11.
    assert np.array(shearing) == pytest.approx(FORCE * 0.05 / np.array(heights), rel=1e-7)


def test_stress_at_step_is_larger_of_both_sides():
    thick, thin = Rectangle(0.03, 0.08), Rectangle(0.03, 0.04)
    leg, member = cantilever((0.0, thick), (0.6, thick), (0.6, thin), (LENGTH, thin))
    stress = member_stress(leg, member)
    assert stress.station == pytest.approx(0.6)
    # The mesh leaves a shear stress of 2e-3 of the bending stress at the outer face.
    assert stress.largest == pytest.approx(6.0 * FORCE * 0.6 / (0.03 * 0.04**2), rel=1e-5)
