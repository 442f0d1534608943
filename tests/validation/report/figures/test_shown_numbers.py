"""Values in figures belong to the pose in the caption and include all uncertainties."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.fakes.toy_responses import meshes, reference
from support.pages.report_sample import quantity_of, sample_matrix

from lumped.mechanism.load import Excitation
from lumped.robot_file import load_robot
from validation.adequacy.posture_errors import Compared
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.references.modal_reference import mass_notes
from validation.references.responses import Responses
from validation.report.figures import loads_and_responses
from validation.report.figures.adequacy import measured_curves
from validation.responses.statics_and_modes import PathModes
from validation.variations import curves
from validation.verdicts import Coordinate, Entry

# Sizes of responses at three poses and two frequencies, m/N.
SIZES = 1e-6 * np.array([[1.0, 2.0], [10.0, 20.0], [100.0, 200.0]])
LEFT_OPEN = np.array([[0.5, 0.5], [0.25, 0.125], [0.9, 0.9]])
POSES = np.array([[-0.2, 0.45], [0.0, 0.55], [0.2, 0.45]])


@pytest.fixture
def robot():
    mechanism = load_robot("five-bar").mechanism
    swing = Excitation("mill", np.array([1.0, 0.0, 0.0]), 10.0, 100.0, 2)
    displayed = replace(mechanism, excitations=(swing,))
    return SimpleNamespace(
        mechanism=displayed, postures=postures_of(mechanism, POSES), judged_count=2
    )


def vibration(scale=1.0):
    """Made-up modes and responses at three poses, whose frequencies have the ratio 1 : 10 : 100."""
    frequencies = scale * np.outer([1.0, 10.0, 100.0], [1.0, 2.0])
    samples, energy_shares = np.zeros((3, 4, 2)), np.ones((3, 2))
    receptances = [scale * SIZES + 0j]
    return PathModes(frequencies, samples, np.ones(4), energy_shares, receptances=receptances)


def test_response_band_is_at_middle_pose(robot, monkeypatch):
    """Band of two references with half-widths: 10 − 2.5 to 15 + 7.5, and 20 − 2.5 to 30 + 7.5."""
    modes_by_ends = {"rigid": vibration(1.0), "free": vibration(1.5)}
    budgets = [meshes(receptances=[wide * LEFT_OPEN]) for wide in (1.0, 2.0)]
    truth = reference("s", modes_by_ends, budgets)
    monkeypatch.setattr(loads_and_responses, "robot_on_path", lambda _: robot)
    monkeypatch.setattr(loads_and_responses, "solved_modes", lambda _: {"beam": vibration(2.0)})
    monkeypatch.setattr(loads_and_responses, "dynamic_reference", lambda _: truth)
    chart = loads_and_responses._response(Context(load_robot("five-bar"), "quick"), 0)
    sizes = {series.label: series for series in chart.panels[0].series}
    # In µm/N, of the second pose.
    assert sizes["beam"].y == pytest.approx([20.0, 40.0])
    assert sizes["solid"].y == pytest.approx([10.0, 20.0])
    # 10 (1 − 0.25) and 15 (1 − 0.5), 20 (1 − 0.125) and 30 (1 − 0.25): the lower ones below,
    # 10 (1 + 0.25) and 15 (1 + 0.5), 20 (1 + 0.125) and 30 (1 + 0.25): the higher ones above.
    low, high = sizes["solid"].interval
    assert low == pytest.approx([7.5, 17.5])
    assert high == pytest.approx([22.5, 37.5])
    assert "with the tool at x = 0 m, y = 0.55 m" in chart.caption


def test_response_band_includes_all_readings(robot, monkeypatch):
    """The band covers the references for rigid and for free ends, with their half-widths."""
    modes_by_ends = {"rigid": vibration(1.0), "free": vibration(3.0)}
    truth = reference("s", modes_by_ends, [meshes(receptances=[np.full((3, 2), 0.4)])] * 2)
    monkeypatch.setattr(loads_and_responses, "robot_on_path", lambda _: robot)
    monkeypatch.setattr(loads_and_responses, "solved_modes", lambda _: {})
    monkeypatch.setattr(loads_and_responses, "dynamic_reference", lambda _: truth)
    chart = loads_and_responses._response(Context(load_robot("five-bar"), "quick"), 0)
    (solid,) = chart.panels[0].series
    assert solid.interval == pytest.approx(np.array([[6.0, 12.0], [42.0, 84.0]]))


def test_mass_note_is_at_middle_pose(robot):
    """The note on assumed mass distributions has ranges of frequencies at the middle pose."""
    robot.has_solids = True
    truth = reference("", {"wedge": vibration(1.0), "lump": vibration(0.9)}, supposed="plausible")
    (note,) = mass_notes(Responses(robot), truth)
    assert "give f1 9 to 10 Hz, f2 18 to 20 Hz at the middle pose of the path" in note


def test_varied_robot_is_at_middle_pose(monkeypatch):
    """Values and errors of the second of three poses."""
    values = {"beam": np.arange(3.0)[:, None] + 1.0, "solid": np.arange(3.0)[:, None] + 10.0}
    errors = {"beam": np.arange(3.0)[:, None] / 10.0}
    compared = Compared(values, errors, "solid", objectives=values)
    robot_file = load_robot("five-bar")
    varied = curves.VariedRobot(robot_file, "quick", "a = 1", "frequency")
    monkeypatch.setattr(curves, "path_postures", lambda _: postures_of(robot_file.mechanism, POSES))
    objective = lambda _: compared, np.min, 1.0
    monkeypatch.setattr(curves, "_OBJECTIVES", {"frequency": objective})
    answer = varied.compute()
    assert answer.pose == pytest.approx(POSES[1])
    assert answer.values[:, 0] == pytest.approx([2.0, 11.0])
    assert answer.differences[0, 0] == pytest.approx(0.1)
    assert answer.extremes == pytest.approx([1.0, 10.0])


def measured_entry(poses):
    """Entry of a model 10 % above a measured value.

    The model is uncertain by 4 % (numerics and inputs), the measurement by 3 %.
    """
    half_widths = (0.1,) * len(poses)
    return Entry(
        model="beam",
        quantity=quantity_of("z", measured=True),
        error=0.1,
        uncertainty=0.05,
        low=0.05,
        high=0.15,
        limit=0.05,
        verdict="undecided",
        pose=poses[0],
        reference="measured: gauge",
        value=1.1e-6,
        expected=1e-6,
        uncertainties={"numerics": 0.024, "inputs": 0.032, "measurement": 0.03},
        errors=half_widths,
        lows=tuple(0.05 for _ in poses),
        highs=tuple(0.15 for _ in poses),
        measured=True,
    )


def test_measured_bars_include_inputs():
    """The model's bar includes numerics and inputs, the other bar is that of the measurement."""
    pose = ((0.4,),)
    matrix = sample_matrix(entries=(measured_entry(pose),), quantities=("z",), poses=pose)
    chart = measured_curves(matrix)
    (panel,) = chart.panels
    bars = {series.label: float(np.squeeze(series.bars)) for series in panel.series}
    # √(2.4² + 3.2²) % of the model's own.
    assert bars == pytest.approx({"measured": 0.03, "beam": 0.04})
    assert chart.table["95 % of numerics and inputs"] == pytest.approx([0.04])
    assert chart.table["95 % of the measurement"] == pytest.approx([0.03])
    values = [chart.table[name][0] for name in ("value", "measured")]
    assert values == pytest.approx([1.1e-6, 1e-6])


def test_measured_path_has_full_intervals():
    """Over a path, bars combine the uncertainties of model (4 %) and measurement (3 %): 5 %."""
    poses = ((0.4,), (0.5,))
    matrix = sample_matrix(entries=(measured_entry(poses),), quantities=("z",), poses=poses)
    (panel,) = measured_curves(matrix).panels
    beam = next(series for series in panel.series if series.label == "beam")
    assert beam.y == pytest.approx([1.1, 1.1])
    assert beam.bars == pytest.approx(np.full((2, 2), 0.05))


@pytest.mark.parametrize(
    ("name", "unit", "label"), [("x", "m", "x (m)"), ("phi_z", "rad", "rotation about z (rad)")]
)
def test_coordinate_axis_has_unit(name, unit, label):
    """Labels of an axis: "x (m)" and "rotation about z (rad)"."""
    assert Coordinate(name, unit).axis == label
