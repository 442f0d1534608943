"""Exported files of a mechanism, read back by other readers, say what its models say."""

import subprocess

import numpy as np
import pytest
import pyvista
from scipy.sparse import load_npz

from fem.calculix.run import CalculixMissing, calculix_program
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from validation.export.mechanism import export_mechanism
from validation.export.models import DIVISIONS
from validation.kinematics.poses import postures_of
from validation.models.legs import leg_matrices
from validation.models.mechanism import answers

MECHANISM = load_robot("delta").mechanism


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("export")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(DIVISIONS, "quick", 1)
        export_mechanism(MECHANISM, "quick", path)
    return path


def test_legs_that_are_alike_are_written_once(folder):
    solids = {path.name for path in folder.glob("*_solid.vtu")}
    assert solids == {"arm1_solid.vtu", "rod1l_solid.vtu"}
    arm = leg_matrices("beam", legs_of(MECHANISM)["arm1"])
    written = load_npz(folder / "arm1_beam_K.npz")
    assert abs(written - arm.stiffness).max() <= 1e-12 * abs(arm.stiffness).max()
    said = (folder / "README.txt").read_text(encoding="utf-8")
    assert "rod1l, rod1r, rod2l, rod2r, rod3l, rod3r" in said
    assert "{" not in said


def test_ends_of_rods_meet_on_the_platform_which_moves_by_the_compliance(folder):
    """Three ball joints on a rigid platform: their motions are one twist, that of the tool."""
    at = postures_of(MECHANISM, MECHANISM.poses[4:5])[0]
    (expected,) = answers("beam", [at], 6)
    data = pyvista.read(folder / "mechanism_beam.vtp")
    np.testing.assert_allclose(data.field_data["frequencies"], expected.frequencies, rtol=1e-9)
    frame = at.frames["platform"]
    tool = frame.position + frame.rotation @ MECHANISM.bodies["platform"].interfaces["P"].position
    for column, wrench in enumerate(("Fx", "Fy", "Fz", "Mx", "My", "Mz")):
        twist = expected.compliance[:, column]
        for name, place in MECHANISM.bodies["platform"].interfaces.items():
            if name == "P":
                continue
            point = (frame @ place).position
            found = data.find_closest_point(point)
            np.testing.assert_allclose(data.points[found], point, atol=1e-9)
            moved = twist[:3] + np.cross(twist[3:], point - tool)
            np.testing.assert_allclose(
                data.point_data[f"displacement {wrench}"][found],
                moved,
                atol=1e-8 * np.abs(expected.compliance[:, column]).max(),
            )


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
