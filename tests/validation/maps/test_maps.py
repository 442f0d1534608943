"""Maps over the workspace: closed forms on the grid, and the worst posture between its points."""

import csv
import io
import re
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from gantry import GANTRY, STIFFNESSES
from scipy.optimize import minimize_scalar
from written_robot import robot_of

from lumped.acceptance.quantities import ANY_FORCE
from lumped.errors import ComputationError, InputError
from lumped.models.bodies import links, tip_compliances
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from validation.adequacy.errors import ModelErrors
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.models import judged_models, judged_models_of
from validation.adequacy.robot import static_subject
from validation.catalogue import catalogue
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.maps.figure import _MOST, _panels, maps
from validation.maps.quantities import _error
from validation.maps.workspace import evenly, values_on, workspace, worst_posture
from validation.run.outcome import Result, from_plain, plain
from validation.run.records import run_record

pytestmark = pytest.mark.usefixtures("coarse_legs")
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
path = {{ from = [-0.25, 0.1], to = [0.25, 0.35], counts = [6, 4] }}
accept.rely = ["links"]
[joints]
foot1 = {{ type = "revolute", between = ["ground", "tube1"], at = "A", axis = [0, 0, 1] }}
foot2 = {{ type = "revolute", between = ["ground", "tube2"], at = "B", axis = [0, 0, 1] }}
pin = {{ type = "revolute", between = ["rod1", "rod2"], at = "P", axis = [0, 0, 1] }}
slide1 = {{ type = "prismatic", between = ["tube1", "rod1"], at = ["A", "P"], drive = DRIVE1 }}
slide2 = {{ type = "prismatic", between = ["tube2", "rod2"], at = ["B", "P"], drive = DRIVE2 }}
"""
BIPOD = BIPOD.replace("DRIVE1", f"{{ stiffness = {FIRST} }}")
BIPOD = BIPOD.replace("DRIVE2", f"{{ stiffness = {SECOND} }}")


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
    # Every model of rigid bodies is the same: the one that is relied on.
    assert found["map.error"]["model"] == "links"
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


GRID_OF_THREE = f"{GANTRY}path = {{ from = [0, 0, 0], to = [1.0, 2.0, 0.4], counts = [4, 5, 3] }}"


def test_the_search_ends_at_the_bottom_wherever_it_lies(tmp_path):
    """Bowls in three directions, one of them deeper than any point of the grid shows."""
    mechanism = robot_of(GRID_OF_THREE, tmp_path).mechanism
    space = workspace(mechanism, 100)
    bottoms, depths = np.array([[0.41, 1.17, 0.13], [0.9, 0.2, 0.33]]), np.array([2.0, 1.5])

    def solve(postures):
        poses = np.array([at.pose for at in postures])
        apart = (poses[:, None] - bottoms) / [1.0, 2.0, 0.4]
        return np.min(np.sum(6.0 * apart**2, axis=2) - depths, axis=1)

    found = worst_posture(space, values_on(space, solve), solve)
    np.testing.assert_allclose(found.pose, bottoms[0], atol=1e-9)
    assert found.value == pytest.approx(-2.0, abs=1e-9)
    highest = worst_posture(space, -values_on(space, solve), lambda at: -solve(at), largest=True)
    assert highest.value == pytest.approx(2.0, abs=1e-9)

    # What cannot be solved is blank, and costs nothing else.
    def singular(postures):
        if any(at.pose[0] == 0.0 for at in postures):
            raise ComputationError("singular")
        return solve(postures)

    values = values_on(space, singular)
    assert np.isnan(values[0]).all()
    np.testing.assert_allclose(values[1:], values_on(space, solve)[1:], rtol=1e-12)


@pytest.mark.exhaustive
def test_three_directions_are_drawn_in_slices_and_large_grids_thinned(tmp_path, monkeypatch):
    monkeypatch.setitem(_MOST, "quick", 12)
    monkeypatch.setattr("validation.maps.workspace._LOOKS", 4)
    figure = maps(Context(robot_of(GRID_OF_THREE, tmp_path), "quick"))
    stiffness = read(figure)["map.stiffness"]
    assert np.shape(stiffness["values"]) == (2, 2, 2)
    np.testing.assert_allclose(stiffness["values"], 1e-6 * min(STIFFNESSES), rtol=1e-9)
    assert "is nearest to it. 8 of the 60 poses of the grid were looked at." in figure.caption
    assert list(evenly(9, 4)) == [0, 3, 5, 8]


# The five-bar of rectangles, which are meshed faster than tubes.
PATH = "[path]\nfrom = [-0.55, 0.3]\nto = [0.2, 0.55]\ncounts = [3, 3]"
FIVE_BAR = load_robot("five-bar").text.partition("[path]")[0] + PATH
FIVE_BAR = re.sub(r'"hollow-(.*), thickness = [0-9.]+(.*)', r'"\1\2\nends = "rigid"', FIVE_BAR)


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    context = Context(robot_of(FIVE_BAR, tmp_path_factory.mktemp("five-bar")), "quick")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.maps.workspace._LOOKS", 4)
        return context, maps(context)


def test_values_on_the_grid_are_those_that_solve_gives(five_bar, command):
    context, figure = five_bar
    stiffness, frequency = (read(figure)[name] for name in ("map.stiffness", "map.f1"))
    pose = f"--pose={frequency['x'][0][2]!r},{frequency['x'][1][1]!r}"
    asked = ["solve", context.robot_file.source, pose, "--model"]
    (answer,) = command.json(*asked, stiffness["model"])["results"]
    due = 1e-6 / np.linalg.eigvalsh(np.array(answer["compliance"])[:3, :3])[-1]
    assert stiffness["values"][2][1] == pytest.approx(due, rel=1e-9)
    (answer,) = command.json(*asked, "beam", "--modes", "1")["results"]
    assert frequency["values"][2][1] == pytest.approx(answer["frequencies"][0], rel=1e-5)


def test_errors_on_the_grid_are_those_of_the_verdicts(five_bar):
    """One alternative: all ends are said to be rigid."""
    context, figure = five_bar
    study, robot = read(figure)["map.error"], robot_on_path(context)
    # Without its legs too much is missing.
    assert study["model"] == "vjm"
    models = judged_models_of(robot)
    subject = static_subject(robot, models.values())
    errors = ModelErrors(subject, 4).errors(models["vjm"], ANY_FORCE).error[0]
    assert errors.max() < context.robot_file.requirement.deflection
    known = dict(zip(product(*study["x"]), np.ravel(study["values"]), strict=True))
    due = [known[tuple(pose)] for pose in subject.poses]
    np.testing.assert_allclose(100.0 * errors, due, rtol=1e-6)


def test_an_error_is_the_largest_over_what_is_open():
    robot = load_robot("five-bar").mechanism
    own = tip_compliances(robot)
    softer = own | {"rod1": 1.1 * own["rod1"]}
    references = [assembly(robot, links(robot, tips)) for tips in (own, softer)]
    model, at = judged_models(robot)["links"], postures_of(robot, robot.poses[:2])
    errors = _error(model, references[1:], at)
    assert (errors > 0.1).all()
    np.testing.assert_allclose(_error(model, references, at), errors, rtol=1e-9)


def test_what_is_out_of_reach_is_blank_and_said(five_bar, tmp_path, command):
    context, figure = five_bar
    study = read(figure)["map.stiffness"]
    blank = np.equal(study["values"], None)
    x, y = np.meshgrid(*study["x"], indexing="ij")
    # Cranks of 0.32016 m and rods of 0.46098 m, feet at ±0.15.
    farthest = np.hypot(np.abs(x) + 0.15, y)
    np.testing.assert_array_equal(blank, farthest > 0.32016 + 0.46098)
    assert "Blank: 2 of 9 poses, out of reach or singular." in figure.caption
    assert "7 of the 9 poses of its path" in command.told("check", context.robot_file.source)
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert [row["posture"] for row in rows].count("grid") == 9
    assert sum(row["lowest stiffness (N/µm)"] == "" for row in rows[:9]) == 2
    assert rows[9]["posture"] == "worst lowest stiffness"
    far = FIVE_BAR.replace("-0.55, 0.3", "5.0, 5.0").replace("0.2, 0.55", "5.1, 5.1")
    far = far.replace("counts = [3, 3]", "counts = [2, 2]")
    with pytest.raises(InputError, match="path, pose 1, x = 5"):
        robot_of(far, tmp_path)


def test_maps_are_planned_for_grids_and_kept_with_the_run(five_bar):
    context, figure = five_bar
    planned = {task.id: task for task in catalogue(context.robot_file)}
    assert "mechanism.maps" not in {task.id for task in catalogue(load_robot("five-bar"))}
    record = plain(Result("mechanism.maps", "made", 1.0, found=figure))
    kept = from_plain(planned["mechanism.maps"], record).found
    assert run_record({}, (), (), (), [kept]).studies == figure.studies


def test_star_stands_in_the_slice_nearest_to_the_worst_posture():
    """Three directions, slices at z = 0, 1, 2, 3: the worst posture at z = 2.2."""
    axes = (np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.arange(4.0))
    space = SimpleNamespace(axes=axes, moves=(0, 1, 2))
    shown = SimpleNamespace(title="stiffness", unit="N/µm")
    values = np.arange(16.0).reshape(2, 2, 4)
    worst = SimpleNamespace(pose=np.array([0.4, 0.7, 2.2]))
    panels = _panels(space, ["x (m)", "y (m)", "z (m)"], [(shown, values, worst)])
    stars = [panel.contours.star for panel in panels]
    assert stars == [None, None, (0.4, 0.7), None]
    for k, panel in enumerate(panels):
        assert panel.y_label.startswith(f"z = {k} m")
        np.testing.assert_array_equal(panel.contours.values, values[:, :, k])
