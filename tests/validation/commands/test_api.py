"""flexproof from Python: what the command line gives, as frozen data that shows itself."""

from dataclasses import FrozenInstanceError
from html import escape

import numpy as np
import pytest
from like_ifw import IFW

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation import api


@pytest.fixture(scope="module")
def judged(paper, paper_subject):
    return api.Adequacy(paper, IFW.requirement, paper_subject)


@pytest.mark.exhaustive
def test_solve_gives_the_numbers_of_the_command(command):
    options = ["--model", "segments", "--x", "0.3", "--theory", "euler-bernoulli", "--modes", 2]
    (printed,) = command.json("solve", "ifw", *options)["results"]
    # A pose of one coordinate may be a number.
    for pose in (0.3, [0.3]):
        asked = {"poses": [pose], "modes": 2, "theory": "euler-bernoulli"}
        (answer,) = api.solve("ifw", "segments", **asked).answers
        assert np.array_equal(answer.compliance, printed["compliance"])
        assert answer.frequencies.tolist() == printed["frequencies"]


@pytest.mark.exhaustive
def test_the_matrix_is_that_of_a_run(tmp_path):
    judged = api.adequacy("ifw", preset="quick")
    finished = api.run("ifw", out=tmp_path / "run", preset="quick", only="adequacy", jobs=1)
    assert (finished.exit_code, finished.verdicts) == (0, {})
    assert finished.report.is_file()
    assert [(e.model, e.quantity, e.verdict) for e in finished.matrix.entries] == [
        (e.model, e.quantity, e.verdict) for e in judged.matrix.entries
    ]
    # One choice of what is judged: each leg alone and the notes are there, too.
    assert [part.robot for part in judged.matrix.parts] == ["leg1", "leg2"]
    for name in ("beside", "notes", "supposed"):
        assert getattr(finished.matrix, name) == getattr(judged.matrix, name)
    assert finished.matrix.formulation.robot == "equivalent legs"
    # The paper's robot: the legs' own 6×6 hold, those of constant section do not.
    assert judged.entry("vjm", "x").verdict == "adequate"
    assert judged.entry("segments", "z").verdict == "inadequate"


def test_what_is_not_adequate_is_told_with_pose_cause_and_remedy(judged):
    with pytest.raises(AssertionError) as raised:
        judged.assert_adequate("beam", "z")
    told = str(raised.value)
    assert told.startswith("beam, z: inadequate; error 3")
    parts = "along the load −", " at x = ", "accepted 5 %", "cause: equivalent leg", "remedy: "
    assert [part for part in parts if part not in told] == []


@pytest.mark.parametrize(
    ("model", "quantity", "said"),
    [
        ("bem", "x", 'model "bem" is not judged; there are simplified'),
        ("beam", "f99", 'quantity "f99" is not judged; there are x, y'),
        ("vjm", "f1", 'model "vjm" says nothing of "f1"'),
    ],
)
def test_a_wrong_name_is_an_input_error_that_lists_the_right_ones(judged, model, quantity, said):
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        judged.entry(model, quantity)


def test_limits_are_those_of_the_file_unless_given():
    assert api.load("ifw").requirement == load_robot("ifw").requirement
    loaded = api.load("ifw", accept={"deflection": 0.2, "z": 0.5})
    assert [loaded.requirement.limit(name) for name in ("x", "z", "f1")] == [0.2, 0.5, 0.05]
    for wrong in ({"deflexion": 0.1}, {"z": 5.0}, {"z": 0.0}):
        with pytest.raises(InputError, match="accept"):
            api.load("ifw", accept=wrong)


def test_results_are_frozen_and_show_themselves(judged):
    shown = judged._repr_html_()
    assert escape(judged.sentence) in shown
    assert shown.count("<tr>") == 1 + len(judged.matrix.models)
    assert "✗" in shown
    with pytest.raises(FrozenInstanceError):
        judged.matrix = None
    solution = api.solve("ifw", "simplified")
    assert solution._repr_html_().count("<td") == 4
    assert "IFW demonstrator, simplified" in solution._repr_html_()


@pytest.mark.parametrize(
    ("robot", "asked", "said"),
    [
        ("five-bar", {"poses": [[0.1]]}, r"^poses 0\.1: must be x,y as finite numbers"),
        ("ifw", {"poses": [[0.3, 0.4]]}, "^poses 0.3,0.4: must be x as finite"),
        ("ifw", {"poses": [0.3], "leg": 1}, "leave out poses or leg$"),
        ("ifw", {"modes": -1}, "^modes = -1: must be"),
    ],
)
def test_faults_name_the_arguments_of_python(robot, asked, said):
    """Not the options of the command line, where a pose is typed as --pose or --x."""
    with pytest.raises(InputError, match=said) as raised:
        api.solve(robot, "segments", **asked)
    assert "--" not in str(raised.value)
    with pytest.raises(InputError, match=r"^accept z=9"):
        api.load("ifw", accept={"z": 9.0})


# The project's own earlier answers: errors of the matrix of ifw at quick, deflections (m/N) and
# frequencies (Hz) of others in the middle of their paths. They decide nothing; who moves them on
# purpose says why in the commit.
FROZEN = {
    "ifw simplified y": 0.89602311,
    "ifw simplified f2": 4.52114410,
    "ifw vjm x": 0.000840904763,
    "ifw vjm x uncertainty": 0.000840904763,
    "ifw vjm phi_z": 0.00051910936,
    "ifw vjm-equivalent any_force": 0.618015531,
    "ifw segments z": 0.349971038,
    "ifw segments z uncertainty": 0.000376305019,
    "ifw segments f1": 0.363165707,
    "ifw beam x": 0.615662719,
    "ifw beam phi_y": 0.854658045,
    "ifw beam f3": 1.28888645,
    "ifw beam f3 uncertainty": 0.661825923,
    "ifw segments-euler-bernoulli z": 0.359924021,
    "five-bar simplified x": 1.110012755e-06,
    "five-bar simplified f1": 91.5575915,
    "five-bar vjm x": 1.177733201e-06,
    "five-bar segments f1": 58.5972873,
    "five-bar segments f3": 125.844421,
    "hexapod simplified x": 4.597314715e-08,
    "hexapod simplified f3": 348.828427,
    "hexapod vjm x": 6.153684348e-08,
    "hexapod segments f1": 101.814433,
    "hexapod segments f3": 120.863227,
}


def test_answers_have_not_moved(judged):
    found = {}
    for name in FROZEN:
        robot, model, quantity, *what = name.split()
        if robot == "ifw":
            entry = judged.entry(model, quantity)
            found[name] = entry.uncertainty if what else entry.error
        elif quantity == "x":
            found[name] = api.solve(robot, model).answers[0].compliance[0, 0]
        else:
            number = int(quantity[1:])
            found[name] = api.solve(robot, model, modes=number).answers[0].frequencies[-1]
    # Between machines eigenvalue solvers differ by 1e-9; 1e-6 is far below any limit of a model.
    assert found == pytest.approx(FROZEN, rel=1e-6)
