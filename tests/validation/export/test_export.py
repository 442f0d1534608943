"""Exported files, read back by other readers, say what the models say."""

import subprocess

import numpy as np
import pytest
import pyvista
from crane import write_meshed_crane
from exported import assert_read_back
from scipy.linalg import eigh
from scipy.sparse import load_npz

from fem.calculix.run import CalculixMissing, calculix_program
from lumped.legs import tip_compliance
from lumped.models.bodies import clamped_modes, legs_of, tip_compliance_of
from lumped.robot_file import load_robot
from validation.export.files import DIVISIONS, WRENCHES, export_mechanism
from validation.kinematics.poses import postures_of
from validation.models.legs import clamped_solid, leg_matrices
from validation.models.mechanism import answers
from validation.models.parts import identified

MECHANISM = load_robot("delta").mechanism
LEG = legs_of(MECHANISM)["arm1"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("export")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(DIVISIONS, "quick", 1)
        export_mechanism(MECHANISM, "quick", path)
    return path


def test_every_file_is_read_back_and_legs_that_are_alike_are_written_once(folder):
    assert_read_back(folder)
    solids = {path.name for path in folder.glob("*_solid.vtu")}
    assert solids == {"arm1_solid.vtu", "rod1l_solid.vtu"}
    said = (folder / "README.txt").read_text(encoding="utf-8")
    assert "rod1l, rod1r, rod2l, rod2r, rod3l, rod3r" in said
    assert "{" not in said


def test_the_tip_of_the_solid_moves_by_its_compliance(folder):
    mesh = pyvista.read(folder / "arm1_solid.vtu")
    assert mesh.bounds[1] == pytest.approx(LEG.length, rel=1e-12)
    assert mesh.volume == pytest.approx(LEG.section.area * LEG.length, rel=1e-9)
    compliance = clamped_solid(LEG, 1, "rigid").compliance
    end = np.flatnonzero(np.isclose(mesh.points[:, 0], LEG.length))
    arms = mesh.points[end] - [LEG.length, 0.0, 0.0]
    for column, wrench in enumerate(WRENCHES):
        # The end face is rigid.
        expected = compliance[:3, column] + np.cross(compliance[3:, column], arms)
        moved = mesh.point_data[f"displacement {wrench}"][end]
        np.testing.assert_allclose(moved, expected, atol=1e-7 * np.abs(expected).max())
    root = np.isclose(mesh.points[:, 0], 0.0)
    assert root.sum() > 8
    assert not mesh.point_data["displacement Mz"][root].any()
    assert not mesh.point_data["mode 1"][root].any()


@pytest.mark.parametrize("model", ["segments", "beam"])
def test_centrelines_deflect_as_a_cantilever(folder, model):
    line = pyvista.read(folder / f"arm1_{model}.vtp")
    assert (line.n_lines, line.length) == (1, pytest.approx(LEG.length))
    tip = [
        [line.point_data[f"{kind} {wrench}"][-1] for wrench in WRENCHES]
        for kind in ("displacement", "rotation")
    ]
    # Closed form of the Timoshenko cantilever; both models are exact at the tip.
    closed = tip_compliance(LEG.properties("timoshenko"), LEG.length)
    # A dense solve of the assembled matrix loses five digits of sixteen to its condition.
    assert pytest.approx(closed, rel=1e-8, abs=1e-8 * closed.diagonal().min()) == np.hstack(tip).T


def test_the_matrices_give_the_models_compliance_and_frequencies(folder):
    leg = leg_matrices("beam", LEG)
    K, M = (load_npz(folder / f"arm1_beam_{letter}.npz").toarray()[6:, 6:] for letter in "KM")
    found = np.linalg.inv(K)[:6, :6]
    assert found == pytest.approx(tip_compliance_of(leg), rel=1e-6, abs=1e-20)
    values = np.linalg.eigvals(np.linalg.solve(K, M)).real
    first = 1.0 / (2.0 * np.pi * np.sqrt(values.max()))
    written = pyvista.read(folder / "arm1_beam.vtp").field_data["frequencies"][0]
    assert [first, written] == pytest.approx(2 * [clamped_modes(leg, 1).frequencies[0]], rel=1e-6)


def test_ends_of_rods_meet_on_the_platform_which_moves_by_the_compliance(folder):
    """Three ball joints on a rigid platform: their motions are one twist, that of the tool."""
    at = postures_of(MECHANISM, MECHANISM.poses[4:5])[0]
    (expected,) = answers("beam", [at], 6)
    data = pyvista.read(folder / "mechanism_beam.vtp")
    assert data.n_lines == len(legs_of(MECHANISM))
    np.testing.assert_allclose(data.field_data["frequencies"], expected.frequencies, rtol=1e-9)
    frame, places = at.frames["platform"], dict(MECHANISM.bodies["platform"].interfaces)
    tool = (frame @ places.pop("P")).position
    for place in places.values():
        point = (frame @ place).position
        found = data.find_closest_point(point)
        np.testing.assert_allclose(data.points[found], point, atol=1e-9)
        for wrench, twist in zip(WRENCHES, expected.compliance.T, strict=True):
            moved = twist[:3] + np.cross(twist[3:], point - tool)
            written = data.point_data[f"displacement {wrench}"][found]
            np.testing.assert_allclose(written, moved, atol=1e-8 * np.abs(twist).max())


@pytest.mark.exhaustive
def test_calculix_reads_the_deck(folder, tmp_path):
    try:
        program = calculix_program()
    except CalculixMissing as missing:
        pytest.skip(str(missing))
    text = (folder / "mechanism.inp").read_text(encoding="utf-8")
    # Statics alone: modes of the deck are compared elsewhere.
    (tmp_path / "deck.inp").write_text(text[: text.rindex("*STEP")], encoding="utf-8")
    done = subprocess.run(
        [program, "deck"], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stdout[-2000:]
    assert "*ERROR" not in done.stdout


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
    """A crane's arm between three interfaces, and its files."""
    file = write_meshed_crane(tmp_path_factory.mktemp("crane"))
    text = file.read_text("utf-8").replace("\n[points]\n", HOOK)
    file.write_text(text.replace("radius = 0.010 } } }", FACE), "utf-8")
    mechanism = load_robot(file).mechanism
    (folder := file.parent / "export").mkdir()
    export_mechanism(mechanism, "quick", folder)
    return identified(mechanism.parts["arm"]), folder


def test_reduced_matrices_of_a_part_have_its_frequencies_and_stiffness(part):
    """With the first interface clamped; what the reduction drops leaves 1e-5 (CUTOFF_FACTOR)."""
    found, folder = part
    assert_read_back(folder)
    K, M = (load_npz(folder / f"arm_reduced_{one}.npz").toarray() for one in "KM")
    squared = eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[: len(found.frequencies)]
    frequencies = np.sqrt(squared) / (2.0 * np.pi)
    np.testing.assert_allclose(frequencies, found.frequencies, rtol=3e-5)
    scale = np.abs(found.stiffness).max()
    np.testing.assert_allclose(K[:18, :18], found.stiffness, atol=1e-9 * scale)


def test_a_part_leaves_its_first_interface_and_moves_with_the_others(part):
    """Nodes on a rigid face move as its twist."""
    found, folder = part
    mesh = pyvista.read(folder / "arm_part.vtu")
    np.testing.assert_allclose(mesh.field_data["frequencies"], found.frequencies, rtol=1e-9)
    assert sum(key.startswith("mode ") for key in mesh.point_data) == len(found.frequencies)
    x, y, _ = mesh.points.T
    first = np.isclose(np.hypot(x, y), 0.016)
    others = {"B": np.isclose(np.hypot(x - 0.4, y), 0.01), "C": np.isclose(x, 0.43)}
    for place, (name, on_face) in enumerate(others.items()):
        arms = mesh.points[on_face] - found.interfaces[place + 1].point
        for column, wrench in enumerate(WRENCHES):
            moved = mesh.point_data[f"displacement {name} {wrench}"]
            twist = found.compliance[6 * place : 6 * place + 6, 6 * place + column]
            expected = twist[:3] + np.cross(twist[3:], arms)
            largest = np.abs(moved).max()
            np.testing.assert_allclose(moved[on_face], expected, atol=1e-6 * largest)
            assert np.abs(moved[first]).max() <= 1e-9 * largest
