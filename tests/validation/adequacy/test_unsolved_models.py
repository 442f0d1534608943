"""One model that cannot be solved leaves its own entries undecided, and all others judged."""

from functools import wraps

import pytest
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.errors import ComputationError
from validation.adequacy.judgement import REST
from validation.adequacy.mechanism import statics, vibration
from validation.adequacy.robot import robot_adequacy
from validation.context import Context


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """One arm in one pose, its ends said: one reference in place of two."""
    held = ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "rigid"')
    short = held.replace("nu = 0.0", "nu = 0.3").replace("P = [0.0, 0.5", "P = [0.0, 0.2")
    # So little is accepted that what held ends take from beams has to be explained.
    text = f"{short}deflection = 1e-3\n[path]\nposes = [[0.0]]\n"
    return robot_of(text, tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def sound(arm):
    return robot_adequacy(Context(arm, "quick"))


def refusing(monkeypatch, module, function, refused=lambda _: True):
    """`function` of the module refuses where `refused` says so of its first argument."""
    own = getattr(module, function)

    @wraps(own)
    def refuse(*args, **kwargs):
        if refused(args[0]):
            raise ComputationError(f"{args[0]} refused: lost in rounding")
        return own(*args, **kwargs)

    monkeypatch.setattr(module, function, refuse)


def test_a_mechanism_is_judged_without_the_model_that_refuses(monkeypatch, arm, sound):
    refusing(monkeypatch, statics, "answers", lambda model: model == "segments")
    refusing(monkeypatch, vibration, "dynamic_bodies", lambda model: model == "segments")
    matrix = robot_adequacy(Context(arm, "quick"))
    assert len(matrix.entries) == len(sound.entries)
    for now, before in zip(matrix.entries, sound.entries, strict=True):
        if now.model.startswith("segments"):
            assert now.verdict == "undecided"
            assert now.reason == f"{now.model}: segments refused: lost in rounding"
        else:
            assert now == before


def test_a_step_that_is_not_solved_ends_the_causes_and_says_why(monkeypatch, arm, sound):
    refusing(monkeypatch, statics, "own_spring")
    matrix = robot_adequacy(Context(arm, "quick"))
    for now, before in zip(matrix.entries, sound.entries, strict=True):
        assert (now.verdict, now.error) == (before.verdict, before.error)
    rests = [
        cause.source
        for entry in matrix.of_model("beam")
        if not entry.signed
        for cause in entry.causes
        if cause.cause == REST
    ]
    assert rests
    assert all("refused: lost in rounding" in source for source in rests)
