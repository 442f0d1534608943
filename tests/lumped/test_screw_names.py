"""Words for motions and loads, on screws written down by hand."""

import numpy as np
import pytest

from lumped.screw_names import name_twists, name_wrenches

LENGTH = 0.8


@pytest.mark.parametrize(
    ("twists", "words"),
    [
        ([[0, 0, -3, 0, 0, 0]], "translate along z"),
        ([[3, 4, 0, 0, 0, 0]], "translate along (0.6, 0.8, 0)"),
        ([[0, 0, 0, 0, 5, 0]], "turn about y through the loaded point"),
        # The loaded point moves along +y when the robot turns about z at 0.5 m on its −x side.
        ([[0, 0.5, 0, 0, 0, 1]], "turn about z through (-0.5, 0, 0) m from the loaded point"),
        (
            [[0, 0, 0.02, 0, 0, 1]],
            "turn about z through the loaded point with a pitch of 0.02 m/rad",
        ),
        (
            [[1, 1, 0, 0, 0, 0], [1, -1, 0, 0, 0, 0]],
            "translate along x and translate along y",
        ),
        (
            [[0.3, 1, 0, 0, 0, 1], [0, 1, 0, 0, 0, 0]],
            "turn about z through (0, 0.3, 0) m from the loaded point and translate along y",
        ),
    ],
)
def test_twists(twists, words):
    assert name_twists(np.array(twists, dtype=float), LENGTH) == words


@pytest.mark.parametrize(
    ("wrenches", "words"),
    [
        ([[0, 7, 0, 0, 0, 0]], "a force along y through the loaded point"),
        ([[0, 0, 0, 0, 0, 2]], "a moment about z"),
        # r × F = (0.5, 0, 0) × (0, 1, 0) = (0, 0, 0.5)
        ([[0, 1, 0, 0, 0, 0.5]], "a force along y through (0.5, 0, 0) m from the loaded point"),
    ],
)
def test_wrenches(wrenches, words):
    assert name_wrenches(np.array(wrenches, dtype=float), LENGTH) == words
