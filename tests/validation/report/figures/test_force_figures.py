"""Figures of forces in the report: one for each load, with the numbers of `fp.forces`."""

import csv
import io
import tomllib
from pathlib import Path

import numpy as np
import pytest

import flexproof as fp
from validation.catalogue import catalogue
from validation.context import Context
from validation.report.figures.forces import figures

LOADS = """
[[loads]]
name = "cutting"
wrench = [100.0, 50.0, -30.0, 0.0, 0.0, 0.0]
[[loads]]
name = "weight"
gravity = [0.0, 0.0, -9.81]
"""


@pytest.fixture(scope="module")
def robot():
    text = (Path(fp.__file__).parent / "lumped/robots/five-bar.toml").read_text("utf-8")
    return fp.load(tomllib.loads(text + LOADS))


def test_each_load_has_a_figure(robot):
    """Robots without [[loads]] have none."""
    planned = [task.id for task in catalogue(robot)]
    assert [name for name in planned if name.startswith("mechanism.forces.")] == [
        "mechanism.forces.cutting",
        "mechanism.forces.weight",
    ]
    assert not figures(fp.load("five-bar").mechanism)


def test_figure_table_has_drive_torques(robot):
    """Torques in the CSV data of the figure are those of `fp.forces` in each pose."""
    cutting, _ = figures(robot.mechanism)
    figure = cutting.draw(Context(robot, "quick"))
    analysis = fp.forces(robot, path=True, loads=["cutting"])
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert len(rows) == len(analysis.poses)
    for motor in ("motor1", "motor2"):
        due = [
            next(
                reaction.drive
                for reaction in pose.loads["cutting"].reactions
                if reaction.joint == motor
            )
            for pose in analysis.poses
        ]
        column = [float(row[f"{motor}: torque of the drive (N m)"]) for row in rows]
        np.testing.assert_allclose(column, due, rtol=1e-9)
    assert "load cutting" in figure.caption
