"""Maps over the workspace: closed forms on the grid, and worst postures between grid points."""

import csv
import io
import re
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from support.robots.gantry import GANTRY, STIFFNESSES
from support.robots.robot_from_text import robot_of

from lumped.acceptance.quantities import ANY_FORCE
from lumped.errors import ComputationError, InputError
from lumped.models.bodies import tip_compliances
from lumped.robot_file import load_robot
from validation.adequacy.judged_models import judged_models_of
from validation.adequacy.model_errors import ModelErrors
from validation.adequacy.robot_verdicts import static_subject
from validation.catalogue import catalogue
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.maps.figure import _MAX_POSES, _panels, maps
from validation.maps.quantities import _error
from validation.maps.workspace import evenly, grid_values, workspace, worst_posture
from validation.record_fields import plain_data
from validation.references.reference import Interpretation, Reference
from validation.references.reference_parts import assembled
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading, robot_at, robot_on_path
from validation.run.outcome import Result, from_plain
from validation.run.records import run_record

pytestmark = pytest.mark.usefixtures("coarse_legs")
# Two telescopic legs in a plane, rigid except for their drives: K = Σ k d dᵀ at their common pin.
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


def lowest_stiffness(x: float, y: float) -> float:
    """Smaller eigenvalue (N/m) of the bipod's stiffness."""
    directions = np.array([[x + HALF, y], [x - HALF, y]])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return float(np.linalg.eigvalsh(directions.T * [FIRST, SECOND] @ directions)[0])


def studies_by_id(figure) -> dict:
    return {study["id"]: study for study in plain_data(figure.studies)}


@pytest.fixture(scope="module")
def bipod(tmp_path_factory):
    return maps(Context(robot_of(BIPOD, tmp_path_factory.mktemp("bipod")), "quick"))


def test_bipod_maps_match_closed_form(bipod):
    """Two legs: lowest stiffness, √(k/m)/2π, and no error of `links`."""
    studies = studies_by_id(bipod)
    x, y = studies["map.stiffness"]["x"]
    stiffness = np.array([[lowest_stiffness(a, b) for b in y] for a in x])
    np.testing.assert_allclose(studies["map.stiffness"]["values"], 1e-6 * stiffness, rtol=1e-9)
    frequencies = np.sqrt(stiffness / MASS) / (2.0 * np.pi)
    np.testing.assert_allclose(studies["map.f1"]["values"], frequencies, rtol=1e-6)
    assert studies["map.stiffness"]["unit"] == "N/µm"
    assert studies["map.stiffness"]["moves"] == ("x", "y")
    # With rigid bodies all models are equal, and the file relies on links.
    assert studies["map.error"]["model"] == "links"
    assert np.abs(studies["map.error"]["values"]).max() < 1e-9


def test_worst_posture_is_between_grid_points(bipod):
    """The worst posture is on the lower edge, between columns; both legs are almost in line."""
    softest = minimize_scalar(
        lambda x: lowest_stiffness(x, 0.1), bounds=(-0.2, 0.2), method="bounded"
    )
    for name, value in (("map.stiffness", softest.fun * 1e-6), ("map.f1", None)):
        study = studies_by_id(bipod)[name]
        worst = study["worst"]
        assert worst["pose"] == pytest.approx([softest.x, 0.1], abs=2e-3)
        assert min(abs(softest.x - x) for x in study["x"][0]) > 0.02
        assert worst["value"] < np.min(study["values"])
        if value:
            assert worst["value"] == pytest.approx(value, rel=1e-5)


GRID_OF_THREE = f"{GANTRY}path = {{ from = [0, 0, 0], to = [1.0, 2.0, 0.4], counts = [4, 5, 3] }}"


def test_search_finds_minimum_between_points(tmp_path):
    """Minimum of two paraboloids in three variables; the deeper one has it between grid points."""
    mechanism = robot_of(GRID_OF_THREE, tmp_path).mechanism
    space = workspace(mechanism, 100)
    bottoms, depths = np.array([[0.41, 1.17, 0.13], [0.9, 0.2, 0.33]]), np.array([2.0, 1.5])

    def solve(postures):
        poses = np.array([posture.pose for posture in postures])
        distances = (poses[:, None] - bottoms) / [1.0, 2.0, 0.4]
        return np.min(np.sum(6.0 * distances**2, axis=2) - depths, axis=1)

    lowest = worst_posture(space, grid_values(space, solve), solve)
    np.testing.assert_allclose(lowest.pose, bottoms[0], atol=1e-9)
    assert lowest.value == pytest.approx(-2.0, abs=1e-9)
    highest = worst_posture(
        space, -grid_values(space, solve), lambda postures: -solve(postures), largest=True
    )
    assert highest.value == pytest.approx(2.0, abs=1e-9)

    # Values of singular postures are NaN, those of the others are not affected.
    def singular(postures):
        if any(posture.pose[0] == 0.0 for posture in postures):
            raise ComputationError("singular")
        return solve(postures)

    values = grid_values(space, singular)
    assert np.isnan(values[0]).all()
    np.testing.assert_allclose(values[1:], grid_values(space, solve)[1:], rtol=1e-12)


@pytest.mark.exhaustive
def test_large_3d_grid_is_thinned(tmp_path, monkeypatch):
    """At most 12 of 60 poses here, evenly chosen; the caption states their number."""
    monkeypatch.setitem(_MAX_POSES, "quick", 12)
    monkeypatch.setattr("validation.maps.workspace._EVALUATIONS", 4)
    figure = maps(Context(robot_of(GRID_OF_THREE, tmp_path), "quick"))
    stiffness = studies_by_id(figure)["map.stiffness"]
    assert np.shape(stiffness["values"]) == (2, 2, 2)
    np.testing.assert_allclose(stiffness["values"], 1e-6 * min(STIFFNESSES), rtol=1e-9)
    assert (
        "slice nearest to its pose. 8 of the 60 poses of the grid are computed." in figure.caption
    )
    assert list(evenly(9, 4)) == [0, 3, 5, 8]


# Five-bar with rectangular sections, which are meshed faster than tubes.
PATH = "[path]\nfrom = [-0.55, 0.3]\nto = [0.2, 0.55]\ncounts = [3, 3]"
FIVE_BAR = load_robot("five-bar").text.partition("[path]")[0] + PATH
FIVE_BAR = re.sub(r'"hollow-(.*), thickness = [0-9.]+(.*)', r'"\1\2\nends = "rigid"', FIVE_BAR)


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    context = Context(robot_of(FIVE_BAR, tmp_path_factory.mktemp("five-bar")), "quick")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.maps.workspace._EVALUATIONS", 4)
        return context, maps(context)


def test_grid_values_match_solve(five_bar, command):
    """Lowest stiffness and f1 of one pose, by `flexproof solve`."""
    context, figure = five_bar
    stiffness, frequency = (studies_by_id(figure)[name] for name in ("map.stiffness", "map.f1"))
    pose = f"--pose={frequency['x'][0][2]!r},{frequency['x'][1][1]!r}"
    arguments = ["solve", context.robot_file.source, pose, "--model"]
    (result,) = command.json(*arguments, stiffness["model"])["results"]
    expected = 1e-6 / np.linalg.eigvalsh(np.array(result["compliance"])[:3, :3])[-1]
    assert stiffness["values"][2][1] == pytest.approx(expected, rel=1e-9)
    (result,) = command.json(*arguments, "beam", "--modes", "1")["results"]
    assert frequency["values"][2][1] == pytest.approx(result["frequencies"][0], rel=1e-5)


def test_grid_errors_equal_verdict_errors(five_bar):
    """The reference is unique, because the robot file specifies all ends as rigid."""
    context, figure = five_bar
    study, robot = studies_by_id(figure)["map.error"], robot_on_path(context)
    # The error of the simplified model, with rigid legs, is beyond the limit.
    assert study["model"] == "vjm"
    models = judged_models_of(robot)
    subject = static_subject(robot, models.values())
    errors = ModelErrors(subject, 4).errors(models["vjm"], ANY_FORCE).error[0]
    assert errors.max() < context.robot_file.requirement.deflection
    error_of_pose = dict(zip(product(*study["x"]), np.ravel(study["values"]), strict=True))
    mapped = [error_of_pose[tuple(pose)] for pose in subject.poses]
    np.testing.assert_allclose(100.0 * errors, mapped, rtol=1e-6)


def test_mapped_error_is_largest_of_references():
    """With two references, one with a softer rod, the map has the larger of both errors."""
    context = Context(load_robot("five-bar"), "quick")
    robot = context.robot_file.mechanism
    compliances = tip_compliances(robot)
    softer = compliances | {"rod1": 1.1 * compliances["rod1"]}
    tips = {"rigid": compliances, "free": softer}
    solid = Model(
        "reference",
        statics=lambda robot_path, reading: assembled(
            robot_path.postures, tips[reading.ends["rod1"]]
        ),
        static_fields=("ends",),
    )
    file_tips, softer_tips = (Interpretation(ends, Reading({"rod1": ends})) for ends in tips)
    responses = Responses(robot_at(context, postures_of(robot, robot.poses[:2])), strict=True)
    model = judged_models_of(responses.robot)["links"]
    errors = _error(model, Reference("", solid, [softer_tips]), responses)
    assert (errors > 0.1).all()
    both = Reference("", solid, [file_tips, softer_tips])
    np.testing.assert_allclose(_error(model, both, responses), errors, rtol=1e-9)


def test_unreachable_poses_are_blank(five_bar, tmp_path, command):
    """Poses farther than both legs reach; the caption and `check` count them."""
    context, figure = five_bar
    study = studies_by_id(figure)["map.stiffness"]
    blank = np.equal(study["values"], None)
    x, y = np.meshgrid(*study["x"], indexing="ij")
    # Cranks of 0.32016 m and rods of 0.46098 m, feet at ±0.15.
    farthest = np.hypot(np.abs(x) + 0.15, y)
    np.testing.assert_array_equal(blank, farthest > 0.32016 + 0.46098)
    assert "Blank areas: 2 of 9 poses are out of reach or singular." in figure.caption
    assert "7 of the 9 poses of its path" in command.output("check", context.robot_file.source)
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert [row["posture"] for row in rows].count("grid") == 9
    assert sum(row["lowest stiffness (N/µm)"] == "" for row in rows[:9]) == 2
    assert rows[9]["posture"] == "worst lowest stiffness"
    far = FIVE_BAR.replace("-0.55, 0.3", "5.0, 5.0").replace("0.2, 0.55", "5.1, 5.1")
    far = far.replace("counts = [3, 3]", "counts = [2, 2]")
    with pytest.raises(InputError, match="path, pose 1, x = 5"):
        robot_of(far, tmp_path)


def test_only_grids_have_maps(five_bar):
    """A path along a line has none. Stored maps are read back unchanged."""
    context, figure = five_bar
    planned = {task.id: task for task in catalogue(context.robot_file)}
    assert "mechanism.maps" not in {task.id for task in catalogue(load_robot("five-bar"))}
    record = plain_data(Result("mechanism.maps", "made", 1.0, found=figure))
    restored = from_plain(planned["mechanism.maps"], record).found
    assert run_record({}, (), (), [restored]).studies == figure.studies


def test_star_is_in_nearest_slice():
    """A map in three directions has slices at z = 0, 1, 2, 3. The star marks the worst posture.

    It is at z = 2.2, and the star in the slice z = 2.
    """
    axes = (np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.arange(4.0))
    space = SimpleNamespace(axes=axes, varied=(0, 1, 2))
    quantity = SimpleNamespace(title="stiffness", unit="N/µm")
    values = np.arange(16.0).reshape(2, 2, 4)
    worst = SimpleNamespace(pose=np.array([0.4, 0.7, 2.2]))
    panels = _panels(space, ["x (m)", "y (m)", "z (m)"], [(quantity, values, worst)])
    stars = [panel.contours.star for panel in panels]
    assert stars == [None, None, (0.4, 0.7), None]
    for k, panel in enumerate(panels):
        assert panel.y_label.startswith(f"z = {k} m")
        np.testing.assert_array_equal(panel.contours.values, values[:, :, k])
