"""`run --vary`: figures of all models over a number of the robot file."""

import csv
import json

import numpy as np
import pytest
from one_arm import ONE_ARM

from lumped.acceptance.requirement import AXES
from lumped.robot_file import load_robot
from lumped.robot_file.places import unit_of
from validation.variations.curves import checked_variations, varied_robots

ARM = f"{ONE_ARM}[path]\nfrom = [0.0]\nto = [0.2]\ncount = 3\n"
WIDTH = "bodies.arm.section.width=0.04:0.08:3"
MASS = "tool.mass=1:3:2"


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(ARM, encoding="utf-8")
    return path


def table(folder, name):
    rows = csv.DictReader((folder / "figures" / f"{name}.csv").open(encoding="utf-8"))
    columns = list(rows)
    return {key: np.array([float(row[key]) for row in columns]) for key in columns[0]}


@pytest.mark.exhaustive
def test_curves_are_what_the_models_answer(arm, tmp_path, command):
    """Those of `solve --vary`; a slender bar's solid is its beam but for what held ends take."""
    folder = tmp_path / "report"
    asked = ["run", arm, "--preset", "quick", "--only", "*y.*", "--out", folder]
    command.told(*asked, "--vary", WIDTH, "--vary", MASS)
    deflections = table(folder, "vary.1.deflections")
    frequencies = table(folder, "vary.1.frequencies")
    label = "bodies.arm.section.width (m)"
    np.testing.assert_allclose(deflections[label], [0.04, 0.06, 0.08])
    for model in ("beam", "segments", "simplified"):
        asked = ["solve", arm, "--model", model, "--pose", "0.1", "--vary", WIDTH]
        found = command.json(*asked, "--modes", "2")["results"]
        compliances = np.array([one["compliance"] for one in found])
        np.testing.assert_allclose(
            deflections[f"{model}: along x (µm)"], 1e9 * compliances[:, 0, 0], rtol=1e-9
        )
        np.testing.assert_allclose(
            deflections[f"{model}: about z (µrad)"], 1e8 * compliances[:, 5, 5], rtol=1e-9
        )
        own = np.array([one["frequencies"] for one in found])
        for mode in range(own.shape[1]):
            np.testing.assert_allclose(
                frequencies[f"{model}: f{mode + 1} (Hz)"], own[:, mode], rtol=1e-6
            )
    solid = frequencies["solid, ends rigid: f1 (Hz)"]
    np.testing.assert_allclose(solid, frequencies["beam: f1 (Hz)"], rtol=5e-3)
    heavier = table(folder, "vary.2.frequencies")
    assert (np.diff(heavier["solid, ends free: f1 (Hz)"]) < 0.0).all()
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Design parameters" in page
    assert "difference from solid, ends rigid in percent" in page
    header = json.loads((folder / "results.json").read_text(encoding="utf-8"))["run"]
    assert header["options"]["vary"] == f"{WIDTH} {MASS}"


def test_a_biglide_is_varied_like_any_mechanism():
    """Feet as joints that give, legs by their 6×6: deflections fall as the feet stiffen."""
    robot_file = load_robot("ifw")
    (variation,) = checked_variations(robot_file, ["foot.compliance[3,3]=1e-9:4e-9:2"], "quick")
    units = varied_robots(robot_file, variation, "quick")[:2]
    stiff, soft = (unit.compute() for unit in units)
    assert stiff.names.tolist() == soft.names.tolist()
    along_z = AXES.index("z")
    assert (soft.values[:, along_z] > stiff.values[:, along_z])[1:].all()


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["--vary", MASS, "--vary", "points.A[2]=0.0:0.45:2"], "--vary points.A[2]=0.45: "),
        (
            ["--cluster", "tcp://127.0.0.1:1"],
            "--cluster: computes the robots of --vary and the parts",
        ),
    ],
)
def test_what_cannot_be_varied_is_one_clear_line(typed, said, arm, tmp_path, command):
    asked = ["run", arm, "--preset", "quick", "--only", "*y.*", "--out", tmp_path / "report"]
    assert said in command.refused(*asked, *typed)
    assert not (tmp_path / "report").exists()


@pytest.mark.parametrize(
    ("robot", "key", "unit"),
    [
        ("delta", "joints.motor1.drive.stiffness", "N m/rad"),
        ("orthoglide", "joints.drive_x.drive.stiffness", "N/m"),
        ("delta", "points.A1[1]", "m"),
        ("delta", "materials.steel.rho", "kg/m³"),
        ("3-rrr", "path.from[3]", "rad"),
        ("3-rrr", "bodies.platform.inertia[1,1]", "kg m²"),
        ("ifw", "leg1.compliance[2,6]", "rad/N"),
        ("ifw", "leg1.compliance[1,1]", "m/N"),
        ("ifw", "accept.deflection", ""),
    ],
)
def test_units(robot, key, unit):
    assert unit_of(load_robot(robot).tables, key) == unit
