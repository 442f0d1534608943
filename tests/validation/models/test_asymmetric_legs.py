"""Frequencies of legs without two axes of symmetry: beams with shear centre against solids."""

from dataclasses import replace

import numpy as np
import pytest

from fem.beams.beam import warping_beam_leg
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import clamped_modes
from lumped.sections import Angle, Channel
from validation.solids.solid_legs import (
    computed_properties,
    computed_rod,
    solid_frequencies,
)

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Five and ten times as long as high.
LENGTHS = 0.5, 1.0


def solid(leg):
    """Return the first two frequencies (Hz) of the solid, ends free to warp."""
    return np.sort(solid_frequencies(leg, (2,), "free", 2).frequencies.values[-1])


def beam(leg, properties):
    """Return those of the beam; it shares the section mesh of the solid."""
    elements = warping_beam_leg(properties, computed_rod(leg, 2), leg.length, 40, "free")
    return clamped_modes(elements, 2).frequencies


@pytest.mark.parametrize(
    ("section", "largest"),
    [(Channel(0.05, 0.1, 0.02, 0.02), 0.0004), (Angle(0.08, 0.1, 0.02, 0.02), 0.002)],
    ids=["channel", "angle"],
)
def test_asymmetric_beam_tends_to_solid(section, largest):
    """Bending and torsion are coupled about the shear centre.

    What beam theory leaves out (distortion of the section) falls with the square of the
    slenderness: the difference of a leg of double length is a quarter. Without the offset of the
    shear centre, the second frequency is 2 to 3 % off at the larger length.
    """
    legs = [ConstantLeg(length, section, STEEL) for length in LENGTHS]
    properties = computed_properties(legs[0], 2)
    solids = [solid(leg) for leg in legs]
    short, long = (
        beam(leg, properties) / frequencies - 1.0
        for leg, frequencies in zip(legs, solids, strict=True)
    )
    assert np.abs(long).max() < largest
    assert np.log2(short / long) == pytest.approx([2.0, 2.0], abs=0.3)
    centred = replace(properties, centre_y=0.0, centre_z=0.0)
    assert abs(beam(legs[1], centred)[1] / solids[1][1] - 1.0) > 0.02
