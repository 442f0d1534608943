"""`solve --vary`: what a file with that number would say, whoever computes it."""

import csv

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation.cli import main


def same(found, expected):
    for key in ("compliance", "frequencies"):
        np.testing.assert_allclose(found[key], expected[key], rtol=1e-12, atol=0.0)


@pytest.mark.parametrize(
    ("name", "key", "was", "model"),
    [
        ("delta", "bodies.arm1.section.thickness", "thickness = 0.005", "beam"),
        ("five-bar", "points.B1[1]", "B1 = [-0.35,", "segments"),
        ("five-bar", "joints.motor1.drive.stiffness", "stiffness = 8.0e4", "simplified"),
        ("biglide", "leg2.section.diameter", "diameter = 0.12,", "beam"),
    ],
)
def test_each_value_is_what_a_file_with_it_says(name, key, was, model, tmp_path, command):
    """Held against files with the number typed into them, solved one by one."""
    text = load_robot(name).text
    start = was.rsplit(" ", 1)[-1].strip("[,")
    values = np.linspace(float(start), 1.1 * float(start), 3).tolist()
    asked = ("--model", model, "--modes", 2)
    found = command.json("solve", name, *asked, "--vary", f"{key}={values[0]!r}:{values[-1]!r}:3")
    assert [one["vary"][key] for one in found["results"]] == pytest.approx(values)
    for value, one in zip(values, found["results"], strict=True):
        path = tmp_path / "typed.toml"
        assert was in text
        path.write_text(text.replace(was, was.replace(start, repr(value)), 1))
        (expected,) = command.json("solve", path, *asked)["results"]
        same(one, expected)


def test_numbers_that_match_vary_together_and_several_in_every_combination(tmp_path, command):
    """A Delta of six thicker rods keeps its symmetry: two first modes of one frequency."""
    asked = ["delta", "--model", "beam", "--modes", "2", "--csv", str(tmp_path / "table.csv")]
    asked += ["--vary", "bodies.rod*.section.diameter=0.02:0.03:2", "--vary", "tool.mass=1:2:3"]
    found = command.json("solve", *asked)
    values = [tuple(one["vary"].values()) for one in found["results"]]
    assert values == [(d, m) for d in (0.02, 0.03) for m in (1, 1.5, 2)]
    frequencies = np.array([one["frequencies"] for one in found["results"]])
    np.testing.assert_allclose(frequencies[:, 0], frequencies[:, 1], rtol=1e-9)
    assert (np.diff(frequencies[:3, 0]) < 0.0).all()
    rows = list(csv.DictReader((tmp_path / "table.csv").open(encoding="utf-8")))
    assert [float(row["f1 (Hz)"]) for row in rows] == frequencies[:, 0].tolist()
    assert [float(row["z (µm at 1000 N)"]) for row in rows] == [
        pytest.approx(1e9 * one["compliance"][2][2], rel=1e-12) for one in found["results"]
    ]
    assert [float(row["phi_x (µrad at 100 N m)"]) for row in rows] == [
        pytest.approx(1e8 * one["compliance"][3][3], rel=1e-12) for one in found["results"]
    ]
    keys = ("bodies.rod*.section.diameter", "tool.mass")
    assert [tuple(float(row[key]) for key in keys) for row in rows] == values


@pytest.mark.exhaustive
def test_processes_give_the_same_numbers(command):
    asked = ("solve", "five-bar", "--model", "beam", "--modes", "2", "--vary", "tool.mass=1:3:3")
    assert command.json(*asked) == command.json(*asked, "--jobs", "2")


@pytest.mark.parametrize(
    ("typed", "said"),
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
def test_what_cannot_be_varied_is_one_clear_line(typed, said, command):
    line = command.refused("solve", "five-bar", "--model", "beam", "--vary", typed)
    assert line.startswith("flexproof: --vary ")
    assert said in line


def test_a_number_that_changes_no_answer_is_told(capsys):
    asked = ["solve", "five-bar", "--vary", "tool.mass=1:2:2", "--model"]
    assert main([*asked, "vjm"]) == 0
    said = "flexproof: --vary tool.mass: changes no answer of the vjm model\n"
    assert capsys.readouterr().err == said
    assert main([*asked, "beam", "--modes", "1", "--vary", "path.count=3:9:2"]) == 0
    said = "flexproof: --vary path.count: changes no answer of the beam model\n"
    assert capsys.readouterr().err == said
