"""Five-bars at random, read from files, in poses away from the reference, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest
from random_linkages import five_bar

from lumped.mechanism.kinematics.postures import posture
from lumped.models.bodies import legs_of
from validation import api
from validation.adequacy.mechanism import statics
from validation.adequacy.mechanism.path import robot_at
from validation.context import Context
from validation.models.mechanism import constant_legs
from validation.models.options import ModelOptions

SEEDS = (0, 1, 3)
# Rounding, grown by legs whose stiffnesses differ by 1e5.
ROUNDING = 1e-8


def difference(found, expected):
    """The largest difference of entries, each in the size of its own row and column."""
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    return np.abs((found - expected) / scale).max()


def answered(linkage, folder, model, **options):
    robot = linkage.written(folder)
    (answer,) = api.solve(robot, model, poses=[linkage.pose], **options).answers
    return answer


@pytest.mark.parametrize("seed", SEEDS)
def test_unlike_legs_and_joints_that_give_away_from_the_reference(seed, tmp_path):
    """Legs of sections alone, or one of them given by its matrix."""
    linkage = five_bar(seed, matrices=bool(seed % 2))
    for model in ("vjm", "links") if seed % 2 else ("vjm", "links", "segments", "beam"):
        found = answered(linkage, tmp_path, model, theory="euler-bernoulli")
        assert difference(found.compliance, linkage.compliance) < ROUNDING, model


def test_ends_that_the_file_says_are_those_of_their_leg_alone(tmp_path, monkeypatch):
    """Made-up legs, softer with free ends: said ends hold in every reference, others in turn."""
    said = {"crank1": "rigid", "rod1": "free", "crank2": "free"}
    softer = {"rigid": 1.0, "free": 1.1}
    linkage = five_bar(3, ends=said)

    def tip(_context, leg, ends, *, fine):
        assert fine in (True, False)
        return softer[ends] * next(
            own for name, own in linkage.tips.items() if lengths[name] == pytest.approx(leg.length)
        )

    robot = linkage.written(tmp_path)
    lengths = {name: legs_of(robot.mechanism)[name].length for name in linkage.tips}
    at = posture(robot.mechanism, np.array(linkage.pose))
    monkeypatch.setattr(statics, "solid_tip", tip)
    monkeypatch.setattr(statics, "shares_section", lambda *_: False)
    monkeypatch.setattr(statics, "solid_leg", lambda *_: SimpleNamespace(ratio=0.5))
    reference = statics.static_reference(robot_at(Context(robot, "quick"), [at]))
    found = {one.name: one.response.compliance[0] for one in reference.alternatives}
    assert list(found) == ["ends rigid", "ends free"]
    for left_open in softer:
        ends = {name: said.get(name, left_open) for name in linkage.tips}
        legs = {name: softer[ends[name]] * own for name, own in linkage.tips.items()}
        expected = five_bar(3, ends=said, legs=legs).compliance
        assert difference(found[f"ends {left_open}"], expected) < ROUNDING
        asked = constant_legs(robot.mechanism, ModelOptions(ends=left_open))
        assert {name: options.ends for name, _, options in asked} == ends
