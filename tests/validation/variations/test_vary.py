"""Options `solve --vary` and `run --vary`, compared with robot files with the varied numbers."""

import csv
import json

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from lumped.robot_file import load_robot
from lumped.robot_file.places import unit_of
from validation.cli import main

ARM = f"{ONE_ARM}[path]\nfrom = [0.0]\nto = [0.2]\ncount = 3\n"
WIDTH = "bodies.arm.section.width=0.04:0.08:3"
MASS = "tool.mass=1:3:2"


def table(path):
    """Columns of numbers of a CSV file by heading."""
    rows = list(csv.DictReader(path.open(encoding="utf-8")))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


@pytest.mark.parametrize(
    ("name", "key", "original", "model"),
    [
        ("five-bar", "bodies.crank1.section.thickness", "thickness = 0.006", "beam"),
        ("five-bar", "points.B1[1]", "B1 = [-0.35,", "segments"),
        ("five-bar", "joints.motor1.drive.stiffness", "stiffness = 8.0e4", "simplified"),
        ("biglide", "leg2.section.diameter", "diameter = 0.12,", "beam"),
    ],
)
def test_varied_value_equals_edited_file(name, key, original, model, tmp_path, command):
    """A number 10 % larger, by --vary and in the text of the robot file."""
    text = load_robot(name).text
    assert original in text
    old = original.rsplit(" ", 1)[-1].strip("[,")
    new = repr(1.1 * float(old))
    edited = robot_of(text.replace(original, original.replace(old, new), 1), tmp_path).source
    options = ("--model", model, "--modes", 2)
    results = command.json("solve", name, *options, "--vary", f"{key}={old}:{new}:2")["results"]
    for robot, value, result in zip((name, edited), (old, new), results, strict=True):
        (expected,) = command.json("solve", robot, *options)["results"]
        assert result["vary"] == {key: float(value)}
        for numbers in ("compliance", "frequencies"):
            np.testing.assert_allclose(result[numbers], expected[numbers], rtol=1e-12, atol=0.0)


def test_variations_give_all_combinations(tmp_path, command):
    """A key with * varies all six rods together. The Delta stays symmetric: f1 and f2 are equal."""
    arguments = ["delta", "--model", "beam", "--modes", "2", "--csv", tmp_path / "table.csv"]
    keys = ("bodies.rod*.section.diameter", "tool.mass")
    arguments += ["--vary", f"{keys[0]}=0.02:0.03:2", "--vary", f"{keys[1]}=1:2:3"]
    results = command.json("solve", *arguments)["results"]
    values = [(d, m) for d in (0.02, 0.03) for m in (1, 1.5, 2)]
    assert [tuple(result["vary"].values()) for result in results] == values
    frequencies = np.array([result["frequencies"] for result in results])
    np.testing.assert_allclose(frequencies[:, 0], frequencies[:, 1], rtol=1e-9)
    assert (np.diff(frequencies[:3, 0]) < 0.0).all()
    columns = table(tmp_path / "table.csv")
    np.testing.assert_array_equal(np.transpose([columns[key] for key in keys]), values)
    np.testing.assert_array_equal(columns["f1 (Hz)"], frequencies[:, 0])
    compliances = [result["compliance"] for result in results]
    diagonals = np.diagonal(compliances, axis1=1, axis2=2)
    for name, expected in (
        ("z (µm at 1000 N)", 1e9 * diagonals[:, 2]),
        ("phi_x (µrad at 100 N m)", 1e8 * diagonals[:, 3]),
    ):
        np.testing.assert_allclose(columns[name], expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("bodies.rodd.section.width=1:2:3", "five-bar has no such number; did you mean"),
        ("bodies.rod1.from=1:2:3", '"B1" in five-bar is no number; must name a number'),
        ("points.P=1:2:3", "is no number; must name a number (entries of a list count from 1"),
        ("tool.mass", "must be KEY=FROM:TO:COUNT"),
        ("tool.mass=1:b:3", "must be KEY=FROM:TO:COUNT"),
        ("tool.mass=1:inf:3", "must be finite"),
        ("tool.mass=1:2:0", "COUNT = 0: must be from 1 to 1000"),
        ("tool.mass=1:-1:3", "tool.mass=-1: tool.mass = -1"),
        ("points.A1[1]=-0.15:-0.45:4", "points.A1[1]=-0.35: path, pose 8"),
        ("*=1:1:1", "schema"),
    ],
)
def test_invalid_variation_gives_one_error_line(typed, message, command):
    """Unknown key, no number, or wrong range."""
    line = command.error_line("solve", "five-bar", "--model", "beam", "--vary", typed)
    assert line.startswith("flexproof: --vary ")
    assert message in line


def test_refused_variation_writes_nothing(tmp_path, command):
    """One value of the range makes the robot impossible."""
    arm, folder = robot_of(ARM, tmp_path).source, tmp_path / "report"
    typed, message = ["--vary", MASS, "--vary", "points.A[2]=0.0:0.45:2"], "points.A[2]=0.45: "
    refused = command.error_line("run", arm, "--preset", "quick", "--out", folder, *typed)
    assert f"--vary {message}" in refused
    assert not folder.exists()


@pytest.mark.parametrize(
    ("model", "vary"), [("vjm", "tool.mass=1:2:2"), ("beam", "path.count=3:9:2")]
)
def test_variation_without_effect_has_message(model, vary, capsys):
    """Mass in a static model, and poses of a path: results are printed, with a line on stderr."""
    assert main(["solve", "five-bar", "--vary", vary, "--model", model]) == 0
    key = vary.partition("=")[0]
    message = (
        f"flexproof: --vary {key}: has no effect on model {model}; choose another key or --model\n"
    )
    assert capsys.readouterr().err == message


@pytest.mark.parametrize("key", ["loads[1].wrench[3]=-100:-200:2", "damping.ratio=0.01:0.02:2"])
def test_variation_of_load_or_damping_has_effect(key, tmp_path, capsys):
    """The keys are accepted, although compliance and undamped frequencies do not depend on them."""
    load = '[[loads]]\nname = "push"\nwrench = [0.0, 0.0, -100.0, 0.0, 0.0, 0.0]\n'
    arm = robot_of(f"{ARM}{load}[damping]\nratio = 0.01\n", tmp_path).source
    assert main(["solve", str(arm), "--model", "beam", "--vary", key]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.soak
def test_run_curves_match_solve_vary(tmp_path, command):
    """Models match `solve --vary`. Solid and beam of a slender bar differ by end restraint only."""
    arm, folder = robot_of(ARM, tmp_path).source, tmp_path / "report"
    arguments = ["run", arm, "--preset", "quick", "--only", "*y.*", "--out", folder]
    command.output(*arguments, "--vary", WIDTH, "--vary", MASS)
    deflections, frequencies, heavier = (
        table(folder / "figures" / f"vary.{name}.csv")
        for name in ("1.deflections", "1.frequencies", "2.frequencies")
    )
    np.testing.assert_allclose(deflections["bodies.arm.section.width (m)"], [0.04, 0.06, 0.08])
    for model in ("beam", "segments", "simplified"):
        options = ["--model", model, "--pose", "0.1", "--vary", WIDTH, "--modes", "2"]
        results = command.json("solve", arm, *options)["results"]
        diagonals = np.diagonal([result["compliance"] for result in results], axis1=1, axis2=2)
        for name, expected in (
            ("along x (µm)", 1e9 * diagonals[:, 0]),
            ("about z (µrad)", 1e8 * diagonals[:, 5]),
        ):
            np.testing.assert_allclose(deflections[f"{model}: {name}"], expected, rtol=1e-9)
        solved = np.array([result["frequencies"] for result in results])
        for mode, expected in enumerate(solved.T, start=1):
            np.testing.assert_allclose(frequencies[f"{model}: f{mode} (Hz)"], expected, rtol=1e-6)
    solid = frequencies["solid, ends rigid: f1 (Hz)"]
    np.testing.assert_allclose(solid, frequencies["beam: f1 (Hz)"], rtol=5e-3)
    assert (np.diff(heavier["solid, ends free: f1 (Hz)"]) < 0.0).all()
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Design parameters" in page
    assert "difference of each curve from the reference, “solid, ends rigid”, in percent" in page
    header = json.loads((folder / "results.json").read_text(encoding="utf-8"))["run"]
    assert header["options"]["vary"] == f"{WIDTH} {MASS}"


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
def test_varied_number_has_its_unit(robot, key, unit):
    """Unit by key and kind of joint."""
    assert unit_of(load_robot(robot).tables, key) == unit
