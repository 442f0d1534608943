"""One model that cannot be solved leaves its own entries undecided, and all others judged."""

import re
from functools import cache, wraps
from typing import Any

import pytest
from ingredients import Asked

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.adequacy.judgement import REST
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism import statics, vibration
from validation.adequacy.robot import robot_adequacy
from validation.context import Context

# References are made of these, and of no model that is refused here.
SOLIDS = (
    "validation.solids.legs.two_meshes ",
    "validation.adequacy.mechanism.vibration.solid_vibration ",
)


@cache
def untouched(robot: str) -> tuple[Matrix, dict[str, Any]]:
    """The matrix, and the solids that it is made of."""
    context = Asked(load_robot(robot), "quick")
    matrix = robot_adequacy(context)
    solids = {key: context.entry(key) for key in context.asked if key.startswith(SOLIDS)}
    assert solids
    return matrix, solids


def matrix_on(robot: str, solids: dict[str, Any]) -> Matrix:
    """The matrix with solids that need not be made again."""
    return robot_adequacy(Context(load_robot(robot), "quick", {}, dict(solids)))


def refusing(monkeypatch, module, function, refused, *, place=0):
    """`function` of the module refuses where `refused` says so of its argument at `place`."""
    own = getattr(module, function)

    @wraps(own)
    def refuse(*args, **kwargs):
        if refused(args[place]):
            raise ComputationError(f"{args[place]} refused: lost in rounding")
        return own(*args, **kwargs)

    monkeypatch.setattr(module, function, refuse)


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    """The five-bar on two poses, its ends said: one reference in place of two."""
    text = load_robot("five-bar").text.replace("count = 9", "count = 2")
    text, legs = re.subn(r"(\nsection = .*)", r'\1\nends = "rigid"', text)
    assert legs == 4
    path = tmp_path_factory.mktemp("five-bar") / "five-bar.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.exhaustive
def test_a_mechanism_is_judged_without_the_model_that_refuses(monkeypatch, five_bar):
    sound, solids = untouched(five_bar)
    refusing(monkeypatch, statics, "answers", lambda model: model == "segments")
    refusing(monkeypatch, vibration, "dynamic_bodies", lambda model: model == "segments")
    matrix = matrix_on(five_bar, solids)
    assert len(matrix.entries) == len(sound.entries)
    for now, before in zip(matrix.entries, sound.entries, strict=True):
        if now.model.startswith("segments"):
            assert now.verdict == "undecided"
            assert now.reason == f"{now.model}: segments refused: lost in rounding"
        else:
            assert now == before


def test_a_step_that_is_not_solved_ends_the_causes_and_says_why(monkeypatch, five_bar):
    sound, solids = untouched(five_bar)
    refusing(monkeypatch, statics, "own_spring", lambda _: True)
    matrix = matrix_on(five_bar, solids)
    for now, before in zip(matrix.entries, sound.entries, strict=True):
        assert (now.verdict, now.error) == (before.verdict, before.error)
    wrong = next(one for one in matrix.of_model("simplified") if one.error is not None)
    (rest,) = (cause for cause in wrong.causes if cause.cause == REST)
    assert "refused: lost in rounding" in rest.source
