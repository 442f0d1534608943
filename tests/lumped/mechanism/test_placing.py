"""Legs on points: x along them, z as near to the direction asked for as it can be."""

import numpy as np
import pytest

from lumped.mechanism.placing import leg_frame


@pytest.mark.parametrize(
    ("end", "up", "z"),
    [
        ([2.0, 0.0, 0.0], None, [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 3.0], None, [1.0, 0.0, 0.0]),
        ([0.0, 0.0, -3.0], None, [1.0, 0.0, 0.0]),
        ([1.0, 0.0, 1.0], None, [-np.sqrt(0.5), 0.0, np.sqrt(0.5)]),
        ([1.0, 0.0, 0.0], [5.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
    ],
)
def test_z_is_as_near_to_up_as_it_can_be(end, up, z):
    frame = leg_frame(np.zeros(3), np.array(end), None if up is None else np.array(up))
    assert frame.rotation[:, 0] == pytest.approx(np.array(end) / np.linalg.norm(end), abs=1e-15)
    assert frame.rotation[:, 2] == pytest.approx(z, abs=1e-15)
    assert np.linalg.det(frame.rotation) == pytest.approx(1.0, abs=1e-14)
