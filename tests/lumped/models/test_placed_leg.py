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


@pytest.fixture(scope="module")
def placed():
    leg = beam_leg(LEG.timoshenko, LEG.length, 3)
    return leg, placed_leg(leg, leg_frame(START, END), ("A", "B"))


def rigid_motions(model):
    """Unknowns of the body (n×6) under unit twists about its origin."""
    fields = np.zeros((model.size, 6))
    fields[:6], fields[6:12] = shift(START), shift(END)
    inner = model.stiffness[12:].toarray()
    fields[12:] = -np.linalg.solve(inner[:, 12:], inner[:, :12] @ fields[:12])
    return fields


def test_rigid_motions_of_the_body_meet_no_resistance(placed):
    _, model = placed
    fields = rigid_motions(model)
    largest = np.abs(model.stiffness.toarray()).max()
    assert np.abs(model.stiffness @ fields).max() < 1e-9 * largest
    moved = fields.T @ model.mass @ fields
    assert moved[0, 0] == pytest.approx(LEG.mass, rel=1e-12)


def test_points_before_and_behind_the_leg_move_with_it(placed):
    _, model = placed
    points = np.array([START, END, 2.0 * END - START, 2.0 * START - END + [0.1, 0.0, 0.0]])
    points[2] += [0.0, 0.03, -0.02]
    found = model.displacements(points) @ rigid_motions(model)
    expected = np.vstack([shift(point)[:3] for point in points])
    assert found == pytest.approx(expected, abs=1e-9)
