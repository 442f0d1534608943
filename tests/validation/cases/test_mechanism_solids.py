"""Comparisons of a mechanism's solids: which of its modes a beam can have."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation.case import Skip
from validation.cases.mechanism import solids
from validation.context import Context

MODES = np.ones(solids.MODES)
BEAMS = solids.FreeModes(100.0 * MODES, 100.0 * MODES, 0.0 * MODES, 1.0 * MODES)


@pytest.mark.parametrize(
    ("changes", "mode", "likeness"),
    [
        ([0.0] * 6, 5, 0.97),
        # Walls of a thin box that bend in its fifth mode.
        ([0.0, 0.0, 0.0, -0.009, 0.0355, 0.0], 4, 0.998),
        ([np.nan] * 6, 5, 0.97),
    ],
)
def test_a_mode_in_which_walls_bend_need_not_look_like_a_beam_s(
    changes, mode, likeness, monkeypatch
):
    found = replace(BEAMS, changes=np.array(changes), likeness=np.array([1, 1, 1, 0.998, 0.97, 1]))
    monkeypatch.setattr(solids, "_both", lambda _: (found, found, 1.0))
    measured = solids._likeness(Context(load_robot("five-bar"), "quick"))
    assert measured.value == likeness
    assert measured.notes == (f"mode {mode}",)


def test_a_robot_all_of_whose_walls_bend_has_nothing_to_compare(monkeypatch):
    found = replace(BEAMS, changes=0.02 * MODES)
    monkeypatch.setattr(solids, "_both", lambda _: (found, found, 1.0))
    with pytest.raises(Skip, match="walls"):
        solids._likeness(Context(load_robot("five-bar"), "quick"))
