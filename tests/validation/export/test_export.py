"""Exported files, read back by other readers, say what the models say."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
import pyvista
from exported import assert_read_back
from scipy.linalg import eigh
from scipy.sparse import load_npz

from fem.calculix.run import CalculixMissing, calculix_program
from lumped.legs import tip_compliance
from lumped.models.bodies import clamped_modes, legs_of, tip_compliance_of
from lumped.robot_file import load_robot
from validation.export.files import DIVISIONS, WRENCHES, export_mechanism
from validation.kinematics.poses import postures_of
from validation.models import parts
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


ROCKER = Path(__file__).resolve().parents[3] / "examples" / "rocker" / "robot.toml"


@pytest.fixture(scope="module")
def exported(tmp_path_factory, coarse_parts):
    coarse_parts.setattr(parts, "UNKNOWNS", 3_000)
    mechanism = load_robot(ROCKER).mechanism
    folder = tmp_path_factory.mktemp("export")
    export_mechanism(mechanism, "quick", folder)
    return mechanism, folder


def test_every_file_of_parts_is_read_back(exported):
    mechanism, folder = exported
    assert_read_back(folder)
    assert all((folder / f"{name}_part.vtu").exists() for name in mechanism.parts)


def test_reduced_matrices_have_the_frequencies_and_compliance_of_identify(exported):
    """With the first interface clamped; what the reduction drops leaves 1e-5 (CUTOFF_FACTOR)."""
    mechanism, folder = exported
    for name, body in mechanism.parts.items():
        found = identified(body)
        K, M = (load_npz(folder / f"{name}_reduced_{one}.npz").toarray() for one in "KM")
        squared = eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[: len(found.frequencies)]
        frequencies = np.sqrt(squared) / (2.0 * np.pi)
        np.testing.assert_allclose(frequencies, found.frequencies, rtol=3e-5)
        mesh = pyvista.read(folder / f"{name}_part.vtu")
        np.testing.assert_allclose(mesh.field_data["frequencies"], found.frequencies, rtol=1e-9)
        twists = 6 * len(found.interfaces)
        scale = np.abs(found.stiffness).max()
        np.testing.assert_allclose(K[:twists, :twists], found.stiffness, atol=1e-9 * scale)


def test_deflections_and_modes_leave_the_first_interface_and_move_the_others(exported):
    """Nodes on a rigid face move as its twist; modes have the unit of mass that they claim."""
    mechanism, folder = exported
    for name, body in mechanism.parts.items():
        found = identified(body)
        mesh = pyvista.read(folder / f"{name}_part.vtu")
        size = np.ptp(mesh.points, axis=0).max()
        first, *others = found.interfaces
        for place, one in enumerate(others):
            if one.coupling != "rigid" or first.coupling != "rigid" or one.axis is None:
                continue
            for column, wrench in enumerate(("Fx", "Fy", "Fz")):
                moved = mesh.point_data[f"displacement {one.name} {wrench}"]
                twist = found.compliance[6 * place : 6 * place + 6, 6 * place + column]
                on_face = _nearest_to_axis(mesh.points, one, size)
                expected = twist[:3] + np.cross(twist[3:], mesh.points[on_face] - one.point)
                largest = np.abs(moved).max()
                np.testing.assert_allclose(moved[on_face], expected, atol=1e-6 * largest)
                still = moved[_nearest_to_axis(mesh.points, first, size)]
                assert np.abs(still).max() <= 1e-9 * largest
        masses = re.findall("mode [0-9]+", " ".join(mesh.point_data.keys()))
        assert len(masses) == len(found.frequencies)


def _nearest_to_axis(points, interface, size):
    """Nodes of a bore: those as near to its axis as the nearest of all, within its length."""
    arms = points - interface.on_axis
    along = arms @ interface.axis
    radial = np.linalg.norm(arms - np.outer(along, interface.axis), axis=1)
    near = np.abs(along) < 0.2 * size
    return np.flatnonzero(near & (radial < radial[near].min() * (1.0 + 1e-6)))
