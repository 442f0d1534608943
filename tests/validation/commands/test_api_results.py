"""Results in Python equal those of commands: maps, designs, measurements, parts, exports."""

import numpy as np
import pytest

from lumped.errors import InputError
from validation import api

STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
LENGTH, SIDE = 0.5, 0.02
BAR = {
    "schema": 2,
    "name": "bar",
    "points": {"A": [0.0, 0.0, 0.0], "P": [LENGTH, 0.0, 0.0]},
    "bodies": {
        "bar": {
            "from": "A",
            "to": "P",
            "section": {"shape": "rectangle", "width": SIDE, "height": SIDE},
            "material": STEEL,
        }
    },
    "joints": {"clamp": {"type": "fixed", "between": ["ground", "bar"], "at": "A"}},
    "tool": {"body": "bar", "point": "P", "moves": []},
}
STIFFNESS = 3.0 * STEEL["E"] * SIDE**4 / 12.0 / LENGTH**3


def test_structure_measurement_is_plotted():
    """Euler–Bernoulli's L³/3EI is the measured value; the pose of a structure has no coordinate."""
    value = {"quantity": "z", "pose": [], "load": 100.0, "value": 100.0 / STIFFNESS}
    measured = {**value, "uncertainty": 1e-6, "source": "dial gauge"}
    compared = api.compare_measured({**BAR, "measured": [measured]})
    assert compared.entry("beam-euler-bernoulli", "z").error == pytest.approx(0.0, abs=1e-9)
    rows = {row[0]: row[3] for row in compared.table().rows}
    assert rows["beam-euler-bernoulli"] == pytest.approx(0.0, abs=1e-7)
    assert len(compared.plot().axes) == 1
    with pytest.raises(InputError, match=r'quantity "x" is not judged; there are'):
        compared.entry("beam", "x")


def test_robot_without_measurements_is_refused():
    """`fp.compare_measured` needs [[measured]] values."""
    with pytest.raises(InputError, match=r"has no \[\[measured\]\] values"):
        api.compare_measured(BAR)


def test_displacements_are_in_table_and_plot():
    """A push of 10 N on a clamped bar: F/k along z, and its buckling factor."""
    load = {"name": "push", "wrench": [0.0, 0.0, 10.0, 0.0, 0.0, 0.0]}
    solution = api.solve({**BAR, "loads": [load]}, "beam", modes=0, theory="euler-bernoulli")
    ((pose_text, name, *numbers),) = solution.load_table().rows
    assert (pose_text, name) == ("reference posture", "push")
    assert numbers[2] == pytest.approx(10.0 / STIFFNESS, rel=1e-9)
    assert [axes.get_title(loc="left") for axes in solution.plot_loads().axes] == [
        "displacement (µm)",
        "buckling factor",
    ]


def test_robot_without_loads_has_no_load_plots():
    """Methods that need [[loads]] or [[responses]] are refused without these tables."""
    solution = api.solve(BAR, "beam", modes=0)
    for plot in (solution.load_table, solution.plot_loads, solution.plot_responses):
        with pytest.raises(InputError, match=r"has no \[\["):
            plot()


def test_abscissa_is_varying_coordinate():
    """If several coordinates vary, the abscissa is the number of the pose."""
    solution = api.solve("ifw", "vjm", poses=[0.2, 0.3])
    (axes,) = solution.plot().axes
    assert axes.get_xlabel() == "x (m)"
    assert np.array_equal(axes.get_lines()[0].get_xdata(), [0.2, 0.3])
    both = api.solve("five-bar", "vjm", poses=[[0.0, 0.5], [0.1, 0.55]])
    assert both.plot().axes[0].get_xlabel() == "pose"


def test_workspace_without_a_grid_is_refused():
    """Maps need a path with `counts`."""
    with pytest.raises(InputError, match=r"path: must be a grid of poses, counts"):
        api.workspace("five-bar")


def test_exported_matrices_equal_beam(tmp_path):
    """Tip of a clamped bar: Euler–Bernoulli's stiffness, less 3EI/(κGA L²) = 0.4 % for shear."""
    path = api.export(BAR, "npz", out=tmp_path / "bar.npz", modes=2)
    with np.load(path) as arrays:
        frequency = arrays["frequencies"][0]
    beam = 1.875104069**2 * SIDE * np.sqrt(STEEL["E"] / STEEL["rho"] / 12.0) / LENGTH**2
    assert frequency == pytest.approx(beam / (2.0 * np.pi), rel=0.005)


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ({"part": "leg.step"}, "material: missing"),
        ({"part": "leg.step", "material": STEEL, "unknowns": 10}, "unknowns = 10: must be from"),
        ({"part": BAR}, "body: missing; name a part of the robot"),
        ({"part": BAR, "body": "bar"}, "body bar: not a CAD part"),
        ({"part": BAR, "body": "bar", "material": STEEL}, "are in the robot file"),
    ],
)
def test_wrong_identify_argument_is_named(arguments, fault):
    """Missing material, too few unknowns and others: the error begins with the argument."""
    with pytest.raises(InputError, match=fault):
        api.identify(**arguments)


def test_unknown_key_cannot_be_varied():
    with pytest.raises(InputError, match="has no such number"):
        api.vary(BAR, "bodies.bar.section.depth=0.01:0.02:3", preset="quick")


def test_missing_opengl_names_packages(monkeypatch):
    """The picture then contains a text with the packages to install."""
    monkeypatch.setenv("FLEXPROOF_OPENGL", "off")
    (text,) = api.draw("five-bar").texts
    assert "libegl1" in text.get_text()


def test_pose_out_of_reach_cannot_be_drawn():
    with pytest.raises(InputError, match="five-bar"):
        api.draw("five-bar", poses=[[5.0, 5.0]])
