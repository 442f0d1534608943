"""A leg in the axes of another body: what turns, what does not, and what lies beyond its ends."""

import numpy as np
import pytest

from fem.beams.beam import beam_leg
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.placing import leg_frame
from lumped.screws import shift
from lumped.sections import Rectangle
from validation.models.part_legs import placed_leg

LEG = ConstantLeg(0.6, Rectangle(0.04, 0.07), Material.isotropic(2.1e11, 0.3, 7850.0))
START, END = np.array([0.1, -0.2, 0.05]), np.array([0.3, 0.2, 0.45])


def test_a_leg_moves_rigidly_with_its_body_and_points_beyond_its_ends_with_it():
    leg = beam_leg(LEG.timoshenko, LEG.length, 3)
    model = placed_leg(leg, leg_frame(START, END), ("A", "B"))
    # Unknowns of the body under unit twists about its origin.
    fields = np.zeros((model.size, 6))
    fields[:6], fields[6:12] = shift(START), shift(END)
    stiffness = model.stiffness.toarray()
    fields[12:] = -np.linalg.solve(stiffness[12:, 12:], stiffness[12:, :12] @ fields[:12])
    assert np.abs(stiffness @ fields).max() < 1e-9 * np.abs(stiffness).max()
    assert (fields.T @ model.mass @ fields)[0, 0] == pytest.approx(LEG.mass, rel=1e-12)
    points = np.array([START, END, 2.0 * END - START, 2.0 * START - END + [0.1, 0.0, 0.0]])
    points[2] += [0.0, 0.03, -0.02]
    expected = np.vstack([shift(point)[:3] for point in points])
    assert model.displacements(points) @ fields == pytest.approx(expected, abs=1e-9)
