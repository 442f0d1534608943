"""Figures of mechanisms: positions, displacements and names of drawn objects."""

import csv
import gzip
import io
import tomllib
from functools import cache

import numpy as np
import pytest
from support.fakes.toy_responses import reference
from support.robots.crane import write_crane
from support.robots.robot_from_text import described

import flexproof as fp
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from validation.adequacy.posture_errors import Compared
from validation.catalogue import catalogue
from validation.context import Context
from validation.drawing import opengl
from validation.drawing.chart import chart_table
from validation.kinematics.poses import postures_of
from validation.models import reduced_parts
from validation.models.robot_models import answers, mechanism_modes
from validation.report.figures import curves, loads_and_responses, modes, pictures
from validation.report.figures.bodies import compared_points, displaced_solids
from validation.report.figures.mode_names import kinetic_energies, mode_names
from validation.report.figures.modes import finite_elements, segments
from validation.responses.statics_and_modes import PathModes

pytestmark = pytest.mark.usefixtures("coarse_parts")


@pytest.fixture(scope="module")
def five_bar():
    return Context(load_robot("five-bar"), "quick")


@pytest.fixture(autouse=True)
def no_opengl(monkeypatch):
    monkeypatch.setenv(opengl.SWITCH, "off")


def table(figure):
    return list(csv.DictReader(io.StringIO(figure.data)))


@cache
def modes_of(name, model="beam", count=6):
    (solved_modes,) = mechanism_modes(model, [reference_posture(load_robot(name).mechanism)], count)
    return solved_modes


def carried(twist, arms):
    return twist[:3] + np.cross(twist[3:], arms)


def drawn_alike(fine, coarse, mode):
    """True if the drawn shape of the coarse model's mode is that of the fine model within 2 %.

    Repeated modes are drawn as the combination that is closest to the fine model's.
    """
    _, fine_points = compared_points(fine.system, fine.modes.shapes[:, mode])
    _, coarse_points = compared_points(coarse.system, pictures._matching_shape(fine, coarse, mode))
    return np.linalg.norm(fine_points - coarse_points) <= 0.02 * np.linalg.norm(fine_points)


@pytest.mark.parametrize(
    "name", ["ifw", "delta", pytest.param("hexapod", marks=pytest.mark.exhaustive)]
)
def test_drawn_points_follow_tool(name):
    """The nearest drawn points move with the tool's twist. Modes are mass-normalised."""
    solved_modes = modes_of(name)
    system = solved_modes.system
    # Modes are mass-normalised; beams' own mass matrices differ by their shape functions.
    kinetic = kinetic_energies(system, solved_modes.modes.shapes).sum(axis=0)
    np.testing.assert_allclose(kinetic, 1.0, rtol=1e-3)
    tool = system.posture.mechanism.tool
    point = interface_position(system.posture, Side(tool.body, tool.point))
    for shape in solved_modes.modes.shapes.T:
        twist = system.tool @ shape
        nearest = []
        for solid in displaced_solids(system, shape):
            arms = solid.solid.surface.points - point
            errors = np.linalg.norm(solid.displacements - carried(twist, arms), axis=1)
            near = np.linalg.norm(arms, axis=1) < 0.3
            nearest.append(errors[near].min(initial=np.inf))
            if solid.solid.name == tool.body and not solid.deforms:
                assert errors.max() <= 1e-11 * np.abs(twist).max()
        assert min(nearest) <= 1e-12 * np.abs(twist).max()


def test_drawn_leg_root_follows_interface():
    """Points at the leg's root move with its interface. Displacements are magnified, in colour."""
    solved_modes = modes_of("delta")
    system, shape = solved_modes.system, solved_modes.modes.shapes[:, 3]
    legs = [solid for solid in displaced_solids(system, shape) if solid.deforms]
    assert len(legs) == len(system.models)
    for leg in legs:
        points, frame = leg.solid.surface.points, system.posture.frames[leg.solid.name]
        root_twist = system.body_unknowns(leg.solid.name, shape[:, None])[:6, 0]
        arms = points - frame.position
        root = np.abs(arms @ frame.rotation[:, 0]) < 1e-9
        assert root.sum() >= 4
        expected = carried(np.kron(np.eye(2), frame.rotation) @ root_twist, arms[root])
        np.testing.assert_allclose(
            leg.displacements[root], expected, atol=1e-12 * np.abs(shape).max()
        )
        drawn_body = leg.body(factor=0.5, unit=1e-2)
        assert drawn_body.motion == pytest.approx(0.5 * leg.displacements, abs=1e-14)
        assert drawn_body.surface.points == pytest.approx(points + drawn_body.motion, abs=1e-14)
        assert drawn_body.values == pytest.approx(1e2 * np.linalg.norm(leg.displacements, axis=1))


def test_mode_pictures_of_segments_equal_beams():
    """Repeated modes of a Delta are drawn alike, whatever combination each solver returns."""
    for mode in range(6):
        assert drawn_alike(modes_of("delta"), modes_of("delta", "segments", 8), mode), mode


def test_scenes_move_by_mode_and_load(five_bar):
    """Frequencies in the titles, and displacements in the caption, are those of the beams."""
    shapes, deformed = pictures.mode_shapes(five_bar), pictures.deformed(five_bar)
    mechanism = five_bar.robot_file.mechanism
    expected = answers("beam", postures_of(mechanism, mechanism.poses[4:5]), 4)
    for scene, frequency in zip(shapes.scenes, expected.frequencies[0], strict=True):
        assert f"{frequency:.1f} Hz" in scene.title
        header = gzip.decompress(scene.state)
        assert b'"motion": "swing"' in header
        assert b'"motion": {"step"' in header
    assert (shapes.png, shapes.left_out) == (b"", opengl.MESSAGE)
    assert {row["body"] for row in table(shapes)} == {"crank1", "crank2", "rod1", "rod2"}
    for axis in range(3):
        far = 1e9 * np.linalg.norm(expected.compliances[0][:3, axis])
        assert f"{far:.4g} µm under the force along {'xyz'[axis]}" in deformed.caption


def test_strain_energies_of_mode_sum_to_one(five_bar, monkeypatch):
    """Shares of drives, and of torsion, tension and bending of the legs, for twelve modes."""
    monkeypatch.setattr(modes, "ENERGY_MODES", 12)
    rows = table(modes.energies(five_bar))
    assert len(rows) == 12
    shares = [name for name in rows[0] if name.endswith("(%)")]
    assert {"motor1 drive (%)", "crank1 torsion (%)", "rod2 bending y (%)"} <= set(shares)
    for row in rows:
        assert sum(float(row[name]) for name in shares) == pytest.approx(100.0, abs=1e-9)


def test_mode_pairs_are_at_middle_pose(five_bar, monkeypatch):
    """Made-up model with modes 1 and 2 exchanged and frequencies a tenth too high."""
    shapes = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 12, 4)))[0]
    frequencies = np.outer([1.0, 2.0, 3.0], [10.0, 20.0, 40.0, 80.0])
    weights, energy_shares = np.full(12, 1.0 / 12.0), np.ones((3, 4))
    model = PathModes(1.1 * frequencies, shapes[:, :, [1, 0, 2, 3]], weights, energy_shares)
    reference_modes = PathModes(frequencies, shapes, weights, energy_shares)
    truth = reference("solid", {"": reference_modes})
    monkeypatch.setattr(modes, "robot_on_path", lambda _: None)
    monkeypatch.setattr(modes, "dynamic_reference", lambda _: truth)
    monkeypatch.setattr(modes, "modes_by_model", lambda *_: model)
    rows = table(modes.pairs(five_bar))
    for name, expected in {
        "mode": [1.0, 2.0, 3.0, 4.0],
        "reference (Hz)": [20.0, 40.0, 80.0, 160.0],
        "beam: partner": [2.0, 1.0, 3.0, 4.0],
        "segments (Hz)": [44.0, 22.0, 88.0, 176.0],
        "beam: MAC": [1.0] * 4,
    }.items():
        assert [float(row[name]) for row in rows] == pytest.approx(expected), name


def test_figure_has_load_deflections():
    """Displacements (µm) under forces and rotations (µrad) under moments, with differences."""
    rng = np.random.default_rng(4)
    names = ("simplified", "vjm", "beam", "solid, ends rigid")
    values = {name: rng.uniform(1e-9, 1e-6, (3, 6)) for name in names}
    differences = {name: rng.uniform(-0.3, 0.3, (3, 6)) for name in names[:-1]}
    x = np.array([0.1, 0.2, 0.4])
    compared = Compared(values, differences, names[-1])
    chart = curves.deflection_chart(compared, x, "x (m)", {"x (m)": x.tolist()})
    rows = list(csv.DictReader(io.StringIO(chart_table(chart))))
    columns = {name: [float(row[name]) for row in rows] for name in rows[0]}
    assert columns["x (m)"] == x.tolist()
    for column, (panel, axis) in enumerate(zip(chart.panels, "xyzxyz", strict=True)):
        scale, title = (1e9, f"along {axis} (µm)") if column < 3 else (1e8, f"about {axis} (µrad)")
        assert panel.title == title
        below = {curve.label: curve for curve in panel.below}
        assert below.keys() == differences.keys()
        for name, curve in below.items():
            np.testing.assert_allclose(curve.y, 100.0 * differences[name][:, column])
            np.testing.assert_array_equal(curve.x, x)
        for name in names:
            np.testing.assert_allclose(columns[f"{name}: {title}"], scale * values[name][:, column])


@pytest.mark.exhaustive
def test_part_is_drawn_solid_and_condensed(tmp_path):
    """The surface of a rigidly coupled bore moves with the twist of its interface."""
    crane = Context(load_robot(write_crane(tmp_path)), "quick")
    solved_modes = finite_elements(crane, 4)
    system, shape = solved_modes.system, solved_modes.modes.shapes[:, 1]
    (arm,) = (solid for solid in displaced_solids(system, shape) if solid.deforms)
    for name, radius in (("A", 0.016), ("B", 0.010)):
        point = interface_position(solved_modes.posture, Side("arm", name))
        twist = system.motions.at("arm", name, point) @ shape[: system.outer]
        arms = arm.solid.surface.points - point
        bore = np.abs(np.linalg.norm(arms[:, :2], axis=1) - radius) < 1e-6
        assert bore.sum() > 20
        # Its coarsest mesh has nodes of its own: displacements come from those around them.
        largest_error = np.abs(arm.displacements[bore] - carried(twist, arms[bore])).max()
        assert largest_error <= 0.02 * arm.sizes.max(), name
    assert drawn_alike(solved_modes, segments(crane, 8), 0)
    figure = pictures.mode_shapes(crane)
    assert "Parts as solids at the middle pose of the path" in figure.caption
    assert {row["body"] for row in table(figure)} == {"arm"}
    assert len(figure.scenes) == 4
    rows = table(modes.energies(crane))
    assert len(rows) >= 4
    for row in rows:
        assert float(row["A drive (%)"]) + float(row["arm (%)"]) == pytest.approx(100.0, abs=1e-9)


def test_linear_fields_are_interpolated_exactly():
    """Any field is exact at its nodes."""
    rng = np.random.default_rng(5)
    nodes, points, gradient = rng.random((300, 3)), rng.random((40, 3)), rng.random((3, 3))
    interpolated = reduced_parts.interpolated(nodes, (nodes @ gradient + 2.0).reshape(-1, 1))(
        points
    ).toarray()
    np.testing.assert_allclose(interpolated.reshape(-1, 3), points @ gradient + 2.0, atol=1e-12)
    bent = np.sin(9.0 * nodes).reshape(-1, 1)
    at_nodes = reduced_parts.interpolated(nodes, bent)(nodes[:7]).toarray()
    np.testing.assert_array_equal(at_nodes, bent[:21])


E, NU, RHO = 2.1e11, 0.3, 7850.0
# Slender, so that shear and rotary inertia take little from the closed forms below.
LENGTH, WIDTH, HEIGHT = 1.0, 0.1, 0.01
AREA, ALONG_Y, ALONG_Z = WIDTH * HEIGHT, HEIGHT * WIDTH**3 / 12.0, WIDTH * HEIGHT**3 / 12.0
BLADE = f"""
schema = 2
name = "blade"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
joints.clamp = {{ type = "fixed", between = ["ground", "blade"], at = "A" }}
tool = {{ body = "blade", point = "P", moves = [] }}
[bodies.blade]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}
material = {{ E = {E}, nu = {NU}, rho = {RHO} }}
"""


def closed_forms():
    """(Frequency (Hz), name) of a cantilever's lowest bending modes and first torsional mode.

    Euler–Bernoulli bending in both planes, four modes each, and Saint-Venant torsion.
    """
    squared_frequencies = []
    for name, moment in (("along z", ALONG_Z), ("in the plane", ALONG_Y)):
        speed = np.sqrt(E * moment / (RHO * AREA)) / (2.0 * np.pi * LENGTH**2)
        roots = (1.8751041, 4.6940911, 7.8547574, 10.9955407)
        squared_frequencies += [(root**2 * speed, name) for root in roots]
    stiffness = E / (2.0 * (1.0 + NU)) * Rectangle(WIDTH, HEIGHT).torsion_constant
    speed = np.sqrt(stiffness / (RHO * (ALONG_Y + ALONG_Z)))
    return [*squared_frequencies, (speed / (4.0 * LENGTH), "torsion")]


@pytest.mark.parametrize("model", ["beam", "segments"])
def test_cantilever_mode_names_are_correct(model):
    """Names by strain energy, against the closed form of nearest frequency."""
    (solved_modes,) = mechanism_modes(model, [reference_posture(described(BLADE))], 6)
    names = mode_names(solved_modes.system, solved_modes.modes.shapes)
    texts = [names.name(mode) for mode in range(6)]
    assert {"along z", "in the plane", "torsion"} <= set(texts)
    for mode, frequency in enumerate(solved_modes.modes.frequencies):
        expected, name = min(
            closed_forms(), key=lambda closed_form: abs(np.log(closed_form[0] / frequency))
        )
        # Twenty segments and the slenderness of the blade leave less than 4 % in these modes.
        assert frequency == pytest.approx(expected, rel=0.04)
        assert texts[mode] == name
        assert names.sentence(mode).startswith(f"Mode {mode + 1}, {name}: ")
    # A section that turns moves its mass along y and z as its second moments are.
    turning = names.kinetic[:, texts.index("torsion")]
    share = ALONG_Z / (ALONG_Y + ALONG_Z)
    np.testing.assert_allclose(turning, [0.0, share, 1.0 - share], atol=1e-9)
    np.testing.assert_allclose(names.kinetic[2, texts.index("along z")], 1.0, atol=1e-3)


LOADS = """
[[loads]]
name = "cutting"
wrench = [100.0, 50.0, -30.0, 0.0, 0.0, 0.0]
[[loads]]
name = "weight"
gravity = [0.0, 0.0, -9.81]
"""


def test_each_load_has_a_figure_of_forces():
    """Drive torques in the CSV data are those of `fp.forces` in each pose.

    A robot without loads, responses and measured values has no requested figure.
    """
    assert not loads_and_responses.figures(load_robot("five-bar"))
    robot = fp.load(tomllib.loads(load_robot("five-bar").text + LOADS))
    planned = {task.id: task for task in catalogue(robot)}
    names = [name for name in planned if name.startswith("mechanism.forces.")]
    assert names == ["mechanism.forces.cutting", "mechanism.forces.weight"]
    figure = planned["mechanism.forces.cutting"].draw(Context(robot, "quick"))
    analysis = fp.forces(robot, path=True, loads=["cutting"])
    rows = table(figure)
    assert len(rows) == len(analysis.poses)
    for motor in ("motor1", "motor2"):
        reactions = [pose.loads["cutting"].reactions for pose in analysis.poses]
        due = [next(r.drive for r in listed if r.joint == motor) for listed in reactions]
        column = [float(row[f"{motor}: torque of the drive (N m)"]) for row in rows]
        np.testing.assert_allclose(column, due, rtol=1e-9)
    assert "load cutting" in figure.caption
