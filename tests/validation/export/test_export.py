"""Exported files match the models, as read by other programs or by linear algebra."""

import subprocess
import sys
from ast import literal_eval
from contextlib import nullcontext
from dataclasses import replace
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest
from pyvista import read as read_vtk
from scipy.io import loadmat
from scipy.linalg import eigh, eigvals
from scipy.sparse import load_npz
from support.oracles.exported_files import assert_read_back
from support.robots.crane import write_meshed_crane
from support.robots.gantry import GANTRY, MASSES, STIFFNESSES
from support.robots.robot_from_text import described
from support.robots.single_arm import ONE_ARM

from fem.calculix.leg import with_bars
from fem.calculix.run import CalculixMissing, calculix_program
from lumped.beam_properties import tip_compliance
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models.bodies import clamped_modes, legs_of, tip_compliance_of
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved
from validation.export.files import DIVISIONS, WRENCHES, export_mechanism
from validation.export.formats import as_exudyn, as_nastran, as_npz, as_simscape, as_statespace
from validation.export.reduced import reduced_body, reduced_robot
from validation.kinematics.poses import postures_of
from validation.models.leg_models import clamped_solid, leg_matrices
from validation.models.options import ModelOptions
from validation.models.reduced_parts import identified
from validation.models.robot_bodies import static_bodies
from validation.models.robot_models import answers, mechanism_modes

# A body may have the name of the files of the whole mechanism.
MECHANISM = described(load_robot("delta").text.replace("arm1", "mechanism"))
LEG = legs_of(MECHANISM)["mechanism"]


def clamped(stiffness, mass):
    squared = eigh(stiffness[6:, 6:], mass[6:, 6:], eigvals_only=True)
    return np.sqrt(squared) / (2.0 * np.pi)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("export")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(DIVISIONS, "quick", 1)
        export_mechanism(MECHANISM, "quick", path)
    return path


def test_equal_legs_are_exported_once(folder):
    """README.txt lists the rods that share one mesh; the deck has six loads and one modal step."""
    assert_read_back(folder)
    solids = {path.name for path in folder.glob("*_solid.vtu")}
    assert solids == {"mechanism_solid.vtu", "rod1l_solid.vtu"}
    readme = (folder / "README.txt").read_text(encoding="utf-8")
    assert "rod1l, rod1r, rod2l, rod2r, rod3l, rod3r" in readme
    assert "{" not in readme
    deck = (folder / "mechanism.inp").read_text(encoding="ascii")
    assert (deck.count("*STEP\n"), deck.count("*FREQUENCY\n"), deck.count("*CLOAD")) == (7, 1, 6)


def test_exported_displacement_is_compliance(folder):
    """End displacements under unit loads are those of the compliance; the root does not move."""
    mesh = read_vtk(folder / "mechanism_solid.vtu")
    assert mesh.bounds[1] == pytest.approx(LEG.length, rel=1e-12)
    assert mesh.volume == pytest.approx(LEG.section.area * LEG.length, rel=1e-9)
    compliance = clamped_solid(LEG, 1, "rigid").compliance
    end = np.flatnonzero(np.isclose(mesh.points[:, 0], LEG.length))
    arms = mesh.points[end] - [LEG.length, 0.0, 0.0]
    for column, wrench in enumerate(WRENCHES):
        # The end face is rigid.
        expected = compliance[:3, column] + np.cross(compliance[3:, column], arms)
        displacement = mesh.point_data[f"displacement {wrench}"][end]
        np.testing.assert_allclose(displacement, expected, atol=1e-7 * np.abs(expected).max())
    root = np.isclose(mesh.points[:, 0], 0.0)
    assert root.sum() > 8
    assert not mesh.point_data["displacement Mz"][root].any()
    assert not mesh.point_data["mode 1"][root].any()


@pytest.mark.parametrize("model", ["segments", "beam"])
def test_centreline_equals_timoshenko_beam(folder, model):
    """Tip displacements and rotations in the VTP file, against the closed form."""
    line = read_vtk(folder / f"mechanism_{model}.vtp")
    assert (line.n_lines, line.length) == (1, pytest.approx(LEG.length))
    tip = [
        [line.point_data[f"{kind} {wrench}"][-1] for wrench in WRENCHES]
        for kind in ("displacement", "rotation")
    ]
    # Closed form of the Timoshenko cantilever; both models are exact at the tip.
    closed = tip_compliance(LEG.properties("timoshenko"), LEG.length)
    # A dense solve of the assembled matrix loses five digits of sixteen to its condition.
    assert pytest.approx(closed, rel=1e-8, abs=1e-8 * closed.diagonal().min()) == np.hstack(tip).T


def test_leg_matrices_give_known_values(folder):
    """K and M of the NPZ files: tip compliance and first frequency of the beam."""
    leg = leg_matrices("beam", LEG)
    K, M = (load_npz(folder / f"mechanism_beam_{letter}.npz").toarray()[6:, 6:] for letter in "KM")
    compliance = np.linalg.inv(K)[:6, :6]
    assert compliance == pytest.approx(tip_compliance_of(leg), rel=1e-6, abs=1e-20)
    first = np.sqrt(1.0 / np.linalg.eigvals(np.linalg.solve(K, M)).real.max()) / (2.0 * np.pi)
    written = read_vtk(folder / "mechanism_beam.vtp").field_data["frequencies"][0]
    assert [first, written] == pytest.approx(2 * [clamped_modes(leg, 1).frequencies[0]], rel=1e-6)


def test_exported_rod_ends_follow_platform(folder):
    """Displacements of the joints on a rigid platform follow from one twist, that of the tool."""
    posture = postures_of(MECHANISM, MECHANISM.poses[4:5])[0]
    expected = answers("beam", [posture], 6)
    data = read_vtk(folder / "mechanism.vtp")
    assert data.n_lines == len(legs_of(MECHANISM))
    np.testing.assert_allclose(data.field_data["frequencies"], expected.frequencies[0], rtol=1e-9)
    for number, (name, leg) in enumerate(legs_of(MECHANISM).items(), start=1):
        (line,) = np.flatnonzero(data.cell_data["leg"] == number)
        root, direction = posture.frames[name].position, posture.frames[name].rotation[:, 0]
        ends = data.get_cell(line).points[[0, -1]]
        np.testing.assert_allclose(ends, [root, root + leg.length * direction], atol=1e-6)
    frame = posture.frames["platform"]
    interfaces = dict(MECHANISM.bodies["platform"].interfaces)
    tool = (frame @ interfaces.pop("P")).position
    for interface in interfaces.values():
        point = (frame @ interface).position
        node = data.find_closest_point(point)
        np.testing.assert_allclose(data.points[node], point, atol=1e-9)
        for wrench, twist in zip(WRENCHES, expected.compliances[0].T, strict=True):
            displacement = twist[:3] + np.cross(twist[3:], point - tool)
            written = data.point_data[f"displacement {wrench}"][node]
            np.testing.assert_allclose(written, displacement, atol=1e-8 * np.abs(twist).max())


# On the end face of the crane's arm.
HOOK = """
bodies.hook = { points = ["C"], mass = 1.0, centre = "C" }
joints.C = { type = "fixed", between = ["arm", "hook"], at = "C" }
[points]
C = [0.43, 0.0, 0.0]
"""
FACE = "radius = 0.010 } }, C = { plane = { normal = [1.0, 0.0, 0.0] } } }"


@pytest.fixture(scope="module")
def part(tmp_path_factory):
    """Identified arm of a crane with three interfaces, and the folder with its files."""
    file = write_meshed_crane(tmp_path_factory.mktemp("crane"))
    text = file.read_text("utf-8").replace("\n[points]\n", HOOK)
    file.write_text(text.replace("radius = 0.010 } } }", FACE), "utf-8")
    mechanism = load_robot(file).mechanism
    (folder := file.parent / "export").mkdir()
    export_mechanism(mechanism, "quick", folder)
    return identified(mechanism.parts["arm"]), folder


def test_reduced_part_equals_solid(part):
    """With the first interface clamped, the reduction has an error of 1e-5 (CUTOFF_FACTOR)."""
    arm, folder = part
    assert_read_back(folder)
    K, M = (load_npz(folder / f"arm_reduced_{letter}.npz").toarray() for letter in "KM")
    frequencies = clamped(K, M)[: len(arm.frequencies)]
    np.testing.assert_allclose(frequencies, arm.frequencies, rtol=3e-5)
    scale = np.abs(arm.stiffness).max()
    np.testing.assert_allclose(K[:18, :18], arm.stiffness, atol=1e-9 * scale)


def test_part_displacements_are_consistent(part):
    """Nodes on a rigid face move with the face's twist. Those on the first interface are fixed."""
    arm, folder = part
    mesh = read_vtk(folder / "arm_part.vtu")
    np.testing.assert_allclose(mesh.field_data["frequencies"], arm.frequencies, rtol=1e-9)
    assert sum(key.startswith("mode ") for key in mesh.point_data) == len(arm.frequencies)
    x, y, _ = mesh.points.T
    on_first = np.isclose(np.hypot(x, y), 0.016)
    faces = {"B": np.isclose(np.hypot(x - 0.4, y), 0.01), "C": np.isclose(x, 0.43)}
    for number, (name, on_face) in enumerate(faces.items()):
        arms = mesh.points[on_face] - arm.interfaces[number + 1].point
        for column, wrench in enumerate(WRENCHES):
            displacement = mesh.point_data[f"displacement {name} {wrench}"]
            twist = arm.compliance[6 * number : 6 * number + 6, 6 * number + column]
            expected = twist[:3] + np.cross(twist[3:], arms)
            largest = np.abs(displacement).max()
            np.testing.assert_allclose(displacement[on_face], expected, atol=1e-6 * largest)
            assert np.abs(displacement[on_first]).max() <= 1e-9 * largest


# Solid bars, because walls would need finer meshes.
FIVE_BAR = with_bars(reference_posture(load_robot("five-bar").mechanism)).mechanism
CRANK = np.hypot(0.2, 0.25)
COUNT, COARSE = 6, ModelOptions(divisions=1)


@pytest.fixture(scope="module", autouse=True)
def coarse_meshes():
    """Use meshes with one element across the section."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.export.reduced.DEFAULT_OPTIONS", COARSE)
        yield


@pytest.fixture(scope="module")
def robot():
    return reduced_robot(reference_posture(FIVE_BAR), COUNT)


@pytest.fixture(scope="module")
def crank():
    return reduced_body(FIVE_BAR, "crank1", 1000.0)


@pytest.mark.exhaustive
def test_exported_deck_runs_in_calculix(folder, tmp_path):
    """CalculiX reads the deck's meshes, couplings and static steps without an error."""
    try:
        program = calculix_program()
    except CalculixMissing as missing:
        pytest.skip(str(missing))
    text = (folder / "mechanism.inp").read_text(encoding="utf-8")
    # Statics only: test_other_solvers.py compares modes of such decks.
    (tmp_path / "deck.inp").write_text(text[: text.rindex("*STEP")], encoding="utf-8")
    completed = subprocess.run(
        [program, "deck"], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert completed.returncode == 0, completed.stdout[-2000:]
    assert "*ERROR" not in completed.stdout


def test_state_space_has_modes_and_statics(robot):
    """Poles and gain at zero frequency, by NumPy and by the package `control`."""
    arrays = np.load(BytesIO(as_statespace(robot, ".npz")))
    A, B, C, D = (arrays[name] for name in "ABCD")
    (solid,) = mechanism_modes("solid", [reference_posture(FIVE_BAR)], COUNT, COARSE)
    frequencies = np.sort(np.abs(eigvals(A).imag))[::2] / (2.0 * np.pi)
    # Both sides are reduced for the same number of frequencies of the robot.
    assert np.allclose(frequencies, solid.modes.frequencies, rtol=1e-6)
    assert np.allclose(frequencies, arrays["frequencies"], rtol=1e-9)
    # Legs condensed to their ends without modes are exact in statics.
    bodies = static_bodies("solid", FIVE_BAR, COARSE)
    statics = compliance(solved(assemble(reference_posture(FIVE_BAR), bodies)))
    system = pytest.importorskip("control").ss(A, B, C, D)
    poles = np.sort(np.abs(system.poles().imag))[::2] / (2.0 * np.pi)
    assert np.allclose(poles, arrays["frequencies"], rtol=1e-9)
    assert np.allclose(system.dcgain()[:, -6:], statics, rtol=1e-7, atol=1e-9 * statics.max())


def test_state_space_has_modal_damping():
    """At ω = √(k/m) each of the gantry's independent slides has the receptance 1/iηk.

    Its loss factor η is that of its drive plus twice the damping ratio of the robot.
    """
    lossy = GANTRY.replace(f"{STIFFNESSES[0]}", f"{STIFFNESSES[0]}, loss = 0.06")
    gantry = described(f"damping.ratio = 0.01\n{lossy}")
    arrays = np.load(BytesIO(as_statespace(reduced_robot(reference_posture(gantry), 3), ".npz")))
    A, B, C, D = (arrays[name] for name in "ABCD")
    tool = list(arrays["inputs"]).index("tool Fx")
    springs = zip(STIFFNESSES, MASSES, (0.08, 0.02, 0.02), strict=True)
    for axis, (stiffness, mass, loss) in enumerate(springs):
        angular_frequency = np.sqrt(stiffness / mass)
        receptance = C @ np.linalg.solve(1j * angular_frequency * np.eye(6) - A, B) + D
        assert receptance[axis, tool + axis] == pytest.approx(-1j / (loss * stiffness), rel=1e-9)


def test_drive_torque_is_stiffness_times_angle(robot):
    """Virtual work: the torque under a tool force is ∂x/∂q, by differences of postures."""
    ports, solution = robot.matrices.ports, robot.solution
    joint = next(joint for joint in FIVE_BAR.joints if joint.name == "motor1")
    reference, step = reference_posture(FIVE_BAR), 1e-6
    slopes = []
    for change in np.eye(2) * step:
        plus, minus = (
            posture(FIVE_BAR, reference.pose + sign * change, reference) for sign in (1.0, -1.0)
        )
        rotations = [
            plus.coordinates[name] - minus.coordinates[name] for name in ("motor1", "motor2")
        ]
        slopes.append(np.ravel(rotations) / (2.0 * step))
    # Virtual work of the tool's rigid motions, J = dθ/dp: f = Jᵀ τ, and the drive deflects by τ/k.
    torques = np.linalg.inv(np.array(slopes))
    deflections = (ports["drive motor1"] @ solution.displacements(ports["tool"].T))[0, :2]
    assert np.allclose(joint.drive.stiffness * deflections, torques[0], rtol=1e-6)


def test_frequency_bounds_cover_finer_reduction(crank):
    """Reference: modes up to 4000 Hz. Frequencies are upper bounds, within the stated error."""
    finer = reduced_body(FIVE_BAR, "crank1", 4000.0)
    count = len(crank.frequencies)
    assert count >= 2
    errors = crank.frequencies - finer.frequencies[:count]
    assert (errors >= -1e-9 * crank.frequencies).all()
    assert (errors <= crank.bounds + 1e-9 * crank.frequencies).all()
    # The bounds are narrow: 8e-7 and 5e-5 of the frequencies.
    assert (crank.bounds < 1e-4 * crank.frequencies).all()


def test_npz_and_simscape_have_matrices(crank):
    """Equal matrices; unknowns are named, origins are those of the interfaces."""
    arrays = np.load(BytesIO(as_npz(crank)))
    assert np.array_equal(arrays["K"], crank.stiffness)
    assert np.array_equal(arrays["M"], crank.mass)
    components = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
    unknowns = [*(f"A1 {component}" for component in components), "B1 x"]
    assert list(arrays["unknowns"][:7]) == unknowns
    block = loadmat(BytesIO(as_simscape(crank)))
    frequencies = clamped(block["stiffness"], block["mass"])[: len(crank.frequencies)]
    assert np.allclose(frequencies, crank.frequencies, rtol=1e-9)
    assert np.allclose(block["origins"], [[0.0, 0.0, 0.0], [CRANK, 0.0, 0.0]])
    assert not block["damping"].any()


def test_nastran_deck_has_matrices(crank):
    """DMIG cards read by pyyeti: frequencies and positions of the interfaces."""
    nastran = pytest.importorskip("pyyeti.nastran", reason="pyyeti is not installed")
    text = as_nastran(crank).decode()
    matrices = nastran.rddmig(StringIO(text))
    stiffness, mass = matrices["kred"].to_numpy(), matrices["mred"].to_numpy()
    # The deck has ten digits.
    frequencies = clamped(stiffness, mass)[: len(crank.frequencies)]
    assert np.allclose(frequencies, crank.frequencies, rtol=1e-6)
    coordinates = [line[40:72] for line in text.splitlines() if line.startswith("GRID*")]
    x = [float(fields[:16]) for fields in coordinates]
    assert x == pytest.approx([0.0, CRANK], abs=1e-9)


def test_exudyn_script_prints_frequencies(robot, tmp_path):
    """The exported script runs; a robot name with quotes does no harm."""
    pytest.importorskip("exudyn", reason="EXUDYN (extra exudyn) is not installed")
    script = tmp_path / "robot.py"
    renamed = replace(robot.matrices, name='end""" + 1 / 0 \\N{')
    script.write_bytes(as_exudyn(renamed))
    line = [sys.executable, str(script)]
    output = subprocess.run(line, capture_output=True, text=True, check=True, timeout=120).stdout
    frequencies = np.array(literal_eval(output.splitlines()[-1]))[:COUNT]
    assert np.allclose(frequencies, robot.matrices.frequencies, rtol=1e-6)


@pytest.mark.exhaustive
def test_robot_with_few_modes_exports_all(tmp_path, monkeypatch, command):
    """The gantry has three modes, fewer than the default of twenty."""
    monkeypatch.chdir(tmp_path)
    Path("gantry.toml").write_text(GANTRY)
    command.output("export", "gantry.toml", "--to", "npz")
    expected = np.sort(np.sqrt(np.divide(STIFFNESSES, MASSES))) / (2.0 * np.pi)
    assert np.load("gantry.npz")["frequencies"] == pytest.approx(expected, rel=1e-9)
    Path("arm.toml").write_text(ONE_ARM.replace("0.5, 0.0]", "0.1, 0.0]"))
    command.output("export", "arm.toml", "--to", "simscape", "--body", "arm", "--modes", 1)
    assert "stiffness" in loadmat("arm.arm.mat")


def test_time_estimate_counts_solids_once(tmp_path, monkeypatch, command):
    """The cranks are equal, and so are the rods: two solids. Legs known by a 6×6 have none."""
    seconds = []
    monkeypatch.setattr(
        "validation.console.progress.stage", lambda _, time: seconds.append(time) or nullcontext()
    )
    monkeypatch.setattr("meshes.processes.in_own_process", lambda *_: b"")
    for number, words in enumerate(
        (["five-bar"], ["five-bar", "--body", "crank1"], ["five-bar", "--body", "rod1"])
    ):
        command.output("export", *words, "--to", "npz", "--out", tmp_path / f"{number}.npz")
    assert 0.0 < seconds[0] == pytest.approx(sum(seconds[1:]))
    command.output("export", "ifw", "--to", "npz", "--out", tmp_path / "ifw.npz")
    assert seconds[-1] == 0.0
