"""Maps over the workspace: closed forms on the grid, and the worst posture between its points."""

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from written_robot import robot_of

from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from validation import cli
from validation.adequacy.errors import Scale
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.models import judged_models
from validation.adequacy.robot import static_subject
from validation.catalogue import catalogue
from validation.context import Context
from validation.maps.figure import maps
from validation.maps.workspace import evenly, values_on, workspace, worst_posture
from validation.results.outcome import Result, from_plain, plain
from validation.results.records import run_record

# Two telescopes in a plane, all rigid but for their drives: K = Σ k d dᵀ at their common pin.
HALF, FIRST, SECOND, MASS = 0.3, 2.0e6, 3.0e6, 5.0
BIPOD = f"""
schema = 2
name = "bipod"
points = {{ A = [-{HALF}, 0.0, 0.0], B = [{HALF}, 0.0, 0.0], P = [0.0, 0.4, 0.0] }}
bodies.tube1 = {{ points = ["A"] }}
bodies.tube2 = {{ points = ["B"] }}
bodies.rod1 = {{ points = ["P"] }}
bodies.rod2 = {{ points = ["P"] }}
tool = {{ body = "rod1", point = "P", moves = ["x", "y"], mass = {MASS} }}
path = {{ from = [-0.25, 0.1], to = [0.25, 0.35], counts = [6, 5] }}
[joints]
foot1 = {{ type = "revolute", between = ["ground", "tube1"], at = "A", axis = [0, 0, 1] }}
foot2 = {{ type = "revolute", between = ["ground", "tube2"], at = "B", axis = [0, 0, 1] }}
pin = {{ type = "revolute", between = ["rod1", "rod2"], at = "P", axis = [0, 0, 1] }}
[joints.slide1]
type = "prismatic"
between = ["tube1", "rod1"]
at = ["A", "P"]
drive = {{ stiffness = {FIRST} }}
[joints.slide2]
type = "prismatic"
between = ["tube2", "rod2"]
at = ["B", "P"]
drive = {{ stiffness = {SECOND} }}
"""
_SLIDE = """
[joints.{move}]
type = "prismatic"
between = ["{first}", "{second}"]
at = "O"
axis = {axis}
drive = {{ stiffness = {stiffness} }}
"""
_SLIDES = (
    ("x", "ground", "bridge", [1, 0, 0], 3.0e6),
    ("y", "bridge", "carriage", [0, 1, 0], 2.0e6),
    ("z", "carriage", "quill", [0, 0, 1], 4.0e6),
)
_KEYS = ("move", "first", "second", "axis", "stiffness")
GANTRY = """
schema = 2
name = "gantry"
points = { O = [0.0, 0.0, 0.0] }
bodies = { bridge = { points = ["O"] }, carriage = { points = ["O"] }, quill = { points = ["O"] } }
tool = { body = "quill", point = "O", moves = ["x", "y", "z"], mass = 2.0 }
path = { from = [0, 0, 0], to = [1.0, 2.0, 0.4], counts = [4, 5, 3] }
""" + "".join(_SLIDE.format(**dict(zip(_KEYS, one, strict=True))) for one in _SLIDES)


def softest(x: float, y: float) -> float:
    """The smaller eigenvalue (N/m) of the bipod's stiffness."""
    ways = np.array([[x + HALF, y], [x - HALF, y]])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return float(np.linalg.eigvalsh(ways.T * [FIRST, SECOND] @ ways)[0])


def read(figure) -> dict:
    return {study["id"]: study for study in figure.studies}


@pytest.fixture(scope="module")
def bipod(tmp_path_factory):
    return maps(Context(robot_of(BIPOD, tmp_path_factory.mktemp("bipod")), "quick"))


def test_stiffness_and_frequency_are_those_of_the_closed_form(bipod):
    found = read(bipod)
    x, y = found["map.stiffness"]["x"]
    due = np.array([[softest(a, b) for b in y] for a in x])
    np.testing.assert_allclose(found["map.stiffness"]["values"], 1e-6 * due, rtol=1e-9)
    frequencies = np.sqrt(due / MASS) / (2.0 * np.pi)
    np.testing.assert_allclose(found["map.f1"]["values"], frequencies, rtol=1e-6)
    assert found["map.stiffness"]["unit"] == "N/µm"
    assert found["map.stiffness"]["moves"] == ["x", "y"]
    # Every model of rigid bodies is the same: the simplest.
    assert found["map.error"]["model"] == "simplified"
    assert np.abs(found["map.error"]["values"]).max() < 1e-9


def test_the_worst_posture_is_found_between_the_points_of_the_grid(bipod):
    """On the lower edge, where telescopes come nearest to one line: in no column of the grid."""
    at = minimize_scalar(lambda x: softest(x, 0.1), bounds=(-0.2, 0.2), method="bounded")
    for name, value in (("map.stiffness", at.fun * 1e-6), ("map.f1", None)):
        study = read(bipod)[name]
        worst = study["worst"]
        assert worst["pose"] == pytest.approx([at.x, 0.1], abs=2e-3)
        assert min(abs(at.x - x) for x in study["x"][0]) > 0.02
        assert worst["value"] < np.min(study["values"])
        if value:
            assert worst["value"] == pytest.approx(value, rel=1e-5)


def test_the_search_ends_at_the_bottom_wherever_it_lies(tmp_path):
    """Bowls in three directions, one of them deeper than any point of the grid shows."""
    mechanism = robot_of(GANTRY, tmp_path).mechanism
    space = workspace(mechanism, 100)
    bottoms, depths = np.array([[0.41, 1.17, 0.13], [0.9, 0.2, 0.33]]), np.array([2.0, 1.5])

    def solve(postures):
        poses = np.array([at.pose for at in postures])
        apart = (poses[:, None] - bottoms) / [1.0, 2.0, 0.4]
        return np.min(np.sum(6.0 * apart**2, axis=2) - depths, axis=1)

    found = worst_posture(space, values_on(space, solve), solve)
    np.testing.assert_allclose(found.pose, bottoms[0], atol=2e-2)
    assert found.value == pytest.approx(-2.0, abs=2e-3)
    highest = worst_posture(space, -values_on(space, solve), lambda at: -solve(at), largest=True)
    assert highest.value == pytest.approx(2.0, abs=2e-3)

    # What cannot be solved is blank, and costs nothing else.
    def singular(postures):
        if any(at.pose[0] == 0.0 for at in postures):
            raise ComputationError("singular")
        return solve(postures)

    values = values_on(space, singular)
    assert np.isnan(values[0]).all()
    np.testing.assert_allclose(values[1:], values_on(space, solve)[1:], rtol=1e-12)


def test_three_directions_are_drawn_in_slices_and_large_grids_thinned(tmp_path):
    robot = robot_of(GANTRY, tmp_path)
    figure = maps(Context(robot, "quick"))
    stiffness = read(figure)["map.stiffness"]
    assert np.shape(stiffness["values"]) == (4, 5, 3)
    np.testing.assert_allclose(stiffness["values"], 2.0, rtol=1e-9)
    assert "in the nearest slice" in figure.caption
    assert workspace(robot.mechanism, 12).shape == (2, 2, 2)
    assert list(evenly(9, 4)) == [0, 3, 5, 8]


FIVE_BAR = load_robot("five-bar").text
GRID = FIVE_BAR.replace(
    FIVE_BAR[FIVE_BAR.index("[path]") :],
    "[path]\nfrom = [-0.6, 0.3]\nto = [0.2, 0.55]\ncounts = [5, 3]\n",
).replace('material = "', 'ends = "rigid"\nmaterial = "')


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    robot = robot_of(GRID, tmp_path_factory.mktemp("five-bar"))
    context = Context(robot, "quick")
    return context, maps(context)


def test_values_on_the_grid_are_those_that_solve_gives(five_bar, capsys):
    context, figure = five_bar
    found = read(figure)
    model = found["map.stiffness"]["model"]
    for i, j in ((2, 0), (4, 2)):
        x, y = (values[k] for values, k in zip(found["map.f1"]["x"], (i, j), strict=True))
        asked = ["solve", context.robot_file.source, f"--pose={x!r},{y!r}", "--json"]
        assert cli.main([*asked, "--model", model]) == 0
        (answer,) = json.loads(capsys.readouterr().out)["results"]
        moved = np.array(answer["compliance"])[:3, :3]
        stiffness = 1e-6 / np.linalg.eigvalsh(moved)[-1]
        assert found["map.stiffness"]["values"][i][j] == pytest.approx(stiffness, rel=1e-9)
        assert cli.main([*asked, "--model", "beam", "--modes", "1"]) == 0
        (answer,) = json.loads(capsys.readouterr().out)["results"]
        f1 = answer["frequencies"][0]
        assert found["map.f1"]["values"][i][j] == pytest.approx(f1, rel=1e-5)


def test_errors_on_the_grid_are_those_of_the_verdicts(five_bar):
    """One alternative: all ends are said to be rigid."""
    context, figure = five_bar
    study, robot = read(figure)["map.error"], robot_on_path(context)
    subject = static_subject(robot, judged_models(robot.mechanism))
    (response,) = (one.response for one in subject.candidates if one.model == study["model"])
    errors = Scale(subject, 4).errors([response], "any_force").error[0]
    assert errors.max() < context.robot_file.requirement.deflection
    known = {
        (a, b): value
        for a, row in zip(study["x"][0], study["values"], strict=True)
        for b, value in zip(study["x"][1], row, strict=True)
    }
    for pose, error in zip(subject.poses, errors, strict=True):
        assert known[tuple(pose)] == pytest.approx(100.0 * error, rel=1e-6)
    relied = replace(context.robot_file.requirement, rely=("simplified",))
    other = replace(context, robot_file=replace(context.robot_file, requirement=relied))
    assert read(maps(other))["map.error"]["model"] == "simplified"


def test_what_is_out_of_reach_is_blank_and_said(five_bar, tmp_path, capsys):
    context, figure = five_bar
    study = read(figure)["map.stiffness"]
    blank = np.array([[one is None for one in row] for row in study["values"]])
    for i, x in enumerate(study["x"][0]):
        for j, y in enumerate(study["x"][1]):
            # Cranks of 0.32016 m and rods of 0.46098 m, feet at ±0.15.
            farthest = max(np.hypot(x - foot, y) for foot in (-0.15, 0.15))
            assert blank[i, j] == (farthest > 0.32016 + 0.46098), (x, y)
    assert f"Blank: {blank.sum()} of 15 poses, out of reach or singular." in figure.caption
    assert cli.main(["check", context.robot_file.source]) == 0
    assert f"{15 - blank.sum()} of the 15 poses of its path" in capsys.readouterr().out
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert [row["posture"] for row in rows].count("grid") == 15
    assert sum(row["lowest stiffness (N/µm)"] == "" for row in rows[:15]) == blank.sum()
    assert rows[15]["posture"] == "worst lowest stiffness"
    with pytest.raises(InputError, match="path, pose 1, x = 5"):
        robot_of(
            GRID.replace("from = [-0.6, 0.3]\nto = ", "from = [5.0, 5.0]\nto = [5.1, 5.1] # "),
            tmp_path,
        )


def test_maps_are_planned_for_grids_and_kept_with_the_run(five_bar):
    context, figure = five_bar
    planned = {task.id: task for task in catalogue(context.robot_file)}
    assert "mechanism.maps" in planned
    assert "mechanism.maps" not in {task.id for task in catalogue(load_robot("five-bar"))}
    record = plain(Result("mechanism.maps", "made", 1.0, found=figure))
    kept = from_plain(planned["mechanism.maps"], record).found
    assert run_record({}, (), (), (), [kept]).studies == figure.studies
