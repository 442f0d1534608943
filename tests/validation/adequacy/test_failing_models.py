"""Verdicts on other models do not change if one model fails."""

import pytest
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import LOADS, ONE_ARM

from lumped.errors import ComputationError
from validation.adequacy import robot_verdicts
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import robot_subject
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS
from validation.references import model_ladder, uncertainty_sources

pytestmark = pytest.mark.usefixtures("coarse_legs")

ARM = ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "rigid"') + LOADS
FAULT = "ZeroDivisionError: division by zero"


@pytest.fixture
def arm(tmp_path):
    return robot_of(ARM + "[path]\nposes = [[0.0]]\n", tmp_path)


def verdicts_of(arm):
    matrix = verdict_matrix(robot_subject(Context(arm, "quick")), arm.requirement)
    return matrix, {(entry.model, entry.quantity.name): entry.verdict for entry in matrix.entries}


def raising(*_):
    """Raise ZeroDivisionError. Defined in the module because the cache needs a fixed name."""
    return 1 / 0


def failing(function, position, model, options):
    """Wrap `function` to raise if its arguments from `position` on are `model` and `options`."""

    def computed(*arguments):
        if arguments[position : position + 2] == (model, options):
            return 1 / 0
        return function(*arguments)

    return computed


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_failing_model_keeps_other_verdicts(arm, monkeypatch, capsys, model):
    """A program error makes this model undecided in all quantities, with the error as reason."""
    due = verdicts_of(arm)[1]
    for name in ("model_statics", "modes_by_model"):
        function = failing(getattr(model_ladder, name), 1, model, DEFAULT_OPTIONS)
        monkeypatch.setattr(model_ladder, name, function)
    matrix, verdicts = verdicts_of(arm)
    assert {key: verdict for key, verdict in verdicts.items() if key[0] != model} == {
        key: verdict for key, verdict in due.items() if key[0] != model
    }
    failed = matrix.of_model(model)
    assert {entry.quantity.name for entry in failed} >= {"x", "y", "z", "load:cutting"}
    for entry in failed:
        assert (entry.verdict, entry.error) == ("undecided", None)
        assert FAULT in entry.reason
    # A run of it ends with exit code 3: nothing of this is about the robot.
    assert matrix.faults == (model,)
    # Whoever repairs it finds the traceback in the run's log.
    assert "return 1 / 0" in capsys.readouterr().err


def test_missing_stability_keeps_verdicts(arm, monkeypatch):
    """The effect of loads on the stiffness is then part of the uncertainty under these loads."""
    due = verdicts_of(arm)[1]
    for module in (robot_verdicts, uncertainty_sources):
        monkeypatch.setattr(module, "stabilities", raising)
    matrix, verdicts = verdicts_of(arm)
    under_loads = {key for key in due if key[1].startswith("load:")}
    assert {key: verdicts[key] for key in due if key not in under_loads} == {
        key: verdict for key, verdict in due.items() if key not in under_loads
    }
    assert under_loads
    assert not [key for key in under_loads if verdicts[key] == "adequate"]
    assert any(FAULT in note for note in matrix.notes)
    assert matrix.faults == ("stability under loads",)


def test_refused_model_is_undecided_without_fault(arm, monkeypatch):
    """A refusal with a reason, such as a thin arm, is no error of the program."""

    def refusing(*_):
        raise ComputationError("the arm is too thin")

    monkeypatch.setattr(model_ladder, "model_statics", refusing)
    matrix, verdicts = verdicts_of(arm)
    assert verdicts["beam", "x"] == "undecided"
    assert "too thin" in matrix.entry("beam", "x").reason
    assert matrix.faults == ()


def test_simplified_rigid_drive_robot_is_inadequate(tmp_path):
    """With rigid drives the simplified model has no compliance and is inadequate."""
    text = ARM.replace("stiffness = 5.0e4", 'stiffness = "rigid"') + "[path]\nposes = [[0.0]]\n"
    matrix, verdicts = verdicts_of(robot_of(text, tmp_path))
    assert verdicts["beam", "load:cutting"] == verdicts["links", "load:cutting"] == "adequate"
    assert verdicts["simplified", "load:cutting"] == verdicts["simplified", "z"] == "inadequate"
    assert matrix.entry("simplified", "load:cutting").value == 0.0
