"""`flexproof forces` and its record: stresses calculated by hand, half-widths, all outputs."""

import csv
import json
import tomllib
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from support.robots.plane_frames import BEAM, CANTILEVER, B, H, L, Q

import flexproof as fp
from lumped.robot_file import load_robot
from lumped.sections import rectangle_torsion_constant

LOADS = """
[[loads]]
name = "push"
wrench = [0.0, 0.0, -1000.0, 50.0, 0.0, 0.0]
[[loads]]
name = "weight"
gravity = [0.0, 0.0, -9.81]
"""


@pytest.fixture
def loaded(tmp_path):
    """Path of the robot file of a cantilever with two loads."""
    path = tmp_path / "cantilever.toml"
    path.write_text(CANTILEVER + LOADS, encoding="utf-8")
    return path


def test_cantilever_stress_is_exact(loaded):
    """Bending stress σ = 6PL/bh² at a corner. The von Mises stress is at least σ."""
    (pose,) = fp.forces(loaded, "links").poses
    stress = pose.loads["push"].stresses["bar"]
    bending = 6.0 * 1000.0 * L / (B * H**2)
    assert stress.station == 0.0
    assert abs(stress.point[1]) == pytest.approx(H / 2.0)
    assert stress.largest >= bending
    # Torsion and shear vanish at corners and grow along the side: little of either at the top.
    assert stress.largest == pytest.approx(bending, rel=0.01)
    assert stress.half_width <= 0.01 * bending
    weight = pose.loads["weight"].stresses["bar"]
    due = 6.0 * Q * L**2 / 2.0 / (B * H**2)
    assert weight.largest == pytest.approx(due, rel=1e-6)
    assert abs(weight.normal) == pytest.approx(due, rel=1e-6)
    np.testing.assert_allclose(
        weight.along, due * (1.0 - weight.stations / L) ** 2, atol=0.02 * due
    )


def test_torsion_half_width_contains_series():
    """Largest shear stress τ = k T/J (Timoshenko and Goodier §109, a series); von Mises √3 τ."""
    text = CANTILEVER + '[[loads]]\nname = "twist"\nwrench = [0.0, 0.0, 0.0, 80.0, 0.0, 0.0]\n'
    robot = fp.forces(robot_of(text), "links")
    stress = robot.poses[0].loads["twist"].stresses["bar"]
    n = np.arange(1, 99, 2)
    k = 1.0 - 8.0 / np.pi**2 * (1.0 / n**2 / np.cosh(0.5 * n * np.pi * H / B)).sum()
    due = np.sqrt(3.0) * 80.0 * B * k / rectangle_torsion_constant(B, H)
    assert abs(stress.largest - due) <= stress.half_width <= 0.02 * due


def robot_of(text):
    """Tables of a robot file with this text."""
    return tomllib.loads(text)


def test_segment_half_width_contains_moment():
    """Clamped beam under its weight, My = −qL²/12: the error of n segments is of order 1/n²."""
    text = BEAM.replace("LEFT", "fixed").replace("RIGHT", "fixed")
    text += '[[loads]]\nname = "weight"\ngravity = [0.0, 0.0, -9.81]\n'
    record = fp.forces(robot_of(text), "segments", elements=4).poses[0].loads["weight"]
    reaction = next(candidate for candidate in record.reactions if candidate.joint == "a")
    error = abs(reaction.wrench[4] + Q * L**2 / 12.0)
    assert 1e-6 * Q * L**2 < error <= reaction.half_width[4] < 0.1 * Q * L**2
    exact = fp.forces(robot_of(text), "beam").poses[0].loads["weight"]
    clamp = next(candidate for candidate in exact.reactions if candidate.joint == "a")
    assert clamp.half_width[4] <= 1e-9 * Q * L**2


def test_solid_reactions_equal_beam_reactions():
    """Solid beam clamped at both ends: M = qL²/12, apart from effects of shear and rigid ends."""
    text = BEAM.replace("LEFT", "fixed").replace("RIGHT", "fixed")
    text += '[[loads]]\nname = "weight"\ngravity = [0.0, 0.0, -9.81]\n'
    record = fp.forces(robot_of(text), "solid", divisions=2).poses[0].loads["weight"]
    for reaction in record.reactions[1:]:
        assert reaction.wrench[2] == pytest.approx(Q * L / 2.0, rel=1e-6)
        assert abs(reaction.wrench[4]) == pytest.approx(Q * L**2 / 12.0, rel=2e-3)
        assert reaction.half_width[4] <= 0.01 * Q * L**2
    assert record.stresses["left"].largest == pytest.approx(
        6.0 * Q * L**2 / 12.0 / (B * H**2), rel=5e-3
    )


def test_json_csv_and_table_are_equal(loaded, command):
    """Reactions and stresses of a cantilever by `fp.forces` and `flexproof forces`."""
    analysis = fp.forces(loaded)
    printed = command.json("forces", str(loaded))
    assert printed == json.loads(analysis.json())
    push = printed["results"][0]["loads"]["push"]
    assert push["reactions"]["clamp"] == pytest.approx([0, 0, 1000.0, -50.0, -1000.0 * L, 0])
    assert push["drives"] == {}
    rows = list(csv.DictReader(StringIO(analysis.csv())))
    fz = next(r for r in rows if (r["load"], r["of"], r["quantity"]) == ("push", "clamp", "Fz"))
    assert float(fz["value"]) == push["reactions"]["clamp"][2]
    assert fz["unit"] == "N"
    stress = next(r for r in rows if (r["load"], r["quantity"]) == ("weight", "von Mises"))
    weight = printed["results"][0]["loads"]["weight"]
    assert float(stress["value"]) == weight["stresses"]["bar"]["von_mises"]
    assert float(stress["half-width"]) == weight["uncertainty"]["stresses"]["bar"]
    stations = weight["members"]["bar"]["stations"]
    of_bar = [r for r in rows if (r["load"], r["of"], r["quantity"]) == ("weight", "bar", "My")]
    assert [float(r["station (m)"]) for r in of_bar] == stations
    table = analysis.table()
    assert table.rows[0][:3] == ("the only posture", "push", "clamp")
    assert analysis.member_table().rows[1][9] == pytest.approx(1e-6 * float(stress["value"]))


def test_solve_json_has_reactions(loaded, command):
    """`solve` and `forces` print equal reactions."""
    solved = command.json("solve", str(loaded), "--model", "beam", "--modes", "0")
    record = command.json("forces", str(loaded))
    for name, load in solved["results"][0]["loads"].items():
        assert load["reactions"] == record["results"][0]["loads"][name]["reactions"]


def test_undetermined_force_is_a_dash(tmp_path, command):
    """Null in JSON, "–" in the text, and a member without stress with its reason."""
    robot = tmp_path / "five-bar.toml"
    text = (Path(fp.__file__).parent / "lumped/robots/five-bar.toml").read_text("utf-8")
    robot.write_text(text + LOADS, "utf-8")
    record = command.json("forces", str(robot), "--model", "simplified", "--load", "push")
    load = record["results"][0]["loads"]["push"]
    assert load["reactions"]["motor1"][0] is None
    assert load["drives"]["motor1"] is not None
    assert load["without_stress"]["rod1"] == "the section forces are statically indeterminate"
    output = command.output("forces", str(robot), "--model", "simplified", "--load", "push")
    assert "–: statically indeterminate" in output


def test_forces_command_writes_all_outputs(loaded, command, tmp_path):
    """Text, --csv and --picture."""
    table, picture = tmp_path / "forces.csv", tmp_path / "forces.png"
    output = command.output("forces", str(loaded), "--csv", str(table), "--picture", str(picture))
    assert "cantilever, beam" in output
    assert "clamp" in output
    assert "von Mises" in output
    assert "load weight" in output
    # A mark of flexproof may follow the table.
    assert table.read_text("utf-8").startswith("pose,load,of,quantity,station (m),value,unit")
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--load", "pull"], "--load pull: must be one of push, weight"),
        (["--path", "--pose", "1"], "--path: takes all poses of [path]"),
        (["--divisions", "2"], "--divisions: has no effect on model beam here"),
    ],
)
def test_invalid_request_is_refused(loaded, command, arguments, message):
    """Unknown load, and --path beside --pose."""
    assert message in command.error_line("forces", str(loaded), *arguments)


def test_robot_without_loads_is_refused(command):
    """A robot file without [[loads]], and a load that the robot file does not define."""
    assert "the robot file has no [[loads]]" in command.error_line("forces", "five-bar")
    with pytest.raises(fp.InputError, match="loads pull: must be one of push"):
        fp.forces(robot_of(CANTILEVER + LOADS), loads=["pull"])


def test_force_figure_has_all_elements():
    """Panels of joints, drives and stresses, with a curve over the path for each of them."""
    text = (Path(fp.__file__).parent / "lumped/robots/five-bar.toml").read_text("utf-8")
    drag = '[[loads]]\nname = "drag"\nwrench = [100.0, 50.0, -30.0, 0.0, 0.0, 0.0]\n'
    analysis = fp.forces(robot_of(text + LOADS + drag), path=True, loads=["drag", "push"])
    # A force across the plane of the robot leaves its drives and its axial forces at zero.
    across = [panel.title for panel in analysis.chart("push").panels]
    assert across == ["force in the joint (N)", "moment in the joint (N m)", across[-1]]
    chart = analysis.chart("drag")
    titles = [panel.title for panel in chart.panels]
    assert "torque of the drive (N m)" in titles
    assert "largest von Mises stress (MPa)" in titles
    drives = chart.panels[titles.index("torque of the drive (N m)")]
    assert {curve.label for curve in drives.series} == {"motor1", "motor2"}
    assert all(np.isfinite(curve.y).all() for panel in chart.panels for curve in panel.series)
    assert len(chart.panels[0].series[0].x) == len(analysis.poses) > 1


LAMINATE = """
schema = 2
name = "laminate"
[points]
A = [0.0, 0.0, 0.0]
P = [0.6, 0.0, 0.0]
[bodies.bar]
from = "A"
to = "P"
[bodies.bar.section]
shape = "laminate-tube"
diameter = 0.06
ply = { E1 = 1.81e11, E2 = 1.03e10, G12 = 7.17e9, nu12 = 0.28, rho = 1600.0, thickness = 0.25e-3 }
layers = [45, -45, 0, 0, -45, 45]
[joints.clamp]
type = "fixed"
between = ["ground", "bar"]
at = "A"
[tool]
body = "bar"
point = "P"
moves = []
[[loads]]
name = "push"
wrench = [0.0, 0.0, 100.0, 0.0, 0.0, 0.0]
"""


def test_fibre_layers_have_stresses_in_all_outputs(tmp_path, command):
    """Text, JSON, CSV and table of a tube of six layers, whose fibres along x carry M r/I."""
    robot = tmp_path / "laminate.toml"
    robot.write_text(LAMINATE, "utf-8")
    analysis = fp.forces(robot)
    (under_load,) = json.loads(analysis.json())["results"][0]["loads"].values()
    layers = under_load["layers"]["bar"]
    assert [layer["angle"] for layer in layers] == [45, -45, 0, 0, -45, 45]
    assert under_load["stresses"] == {}
    assert under_load["without_stress"] == {}
    section = load_robot(robot).mechanism.bodies["bar"].shape
    # The axial strain M r/EIy of the outer face of the fourth layer, which strains across by a12.
    strain = 100.0 * 0.6 * (0.03 - 0.5e-3) / section.timoshenko.EIy
    along = layers[3]["along_fibres"]
    assert along["max"] == pytest.approx(-along["min"]) == pytest.approx(1.81e11 * strain, rel=0.02)
    rows = analysis.layer_table().rows
    assert rows[3][2:5] == ("bar", 4, 0)
    assert rows[3][6] == pytest.approx(1e-6 * along["max"])
    assert f"max σ1 of layer 4,,{along['max']!r},Pa" in analysis.csv()
    output = command.output("forces", str(robot))
    assert "(laminate theory)" in output
    assert f"{1e-6 * along['max']:.4g}" in output
