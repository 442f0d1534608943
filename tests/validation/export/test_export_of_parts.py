"""Exported CAD parts, read back by other readers, say what `identify` says of them."""

import re
from pathlib import Path

import numpy as np
import pytest
import pyvista
from exported import assert_read_back
from scipy.linalg import eigh
from scipy.sparse import load_npz

from lumped.robot_file import load_robot
from validation.export.mechanism import export_mechanism
from validation.models.parts import identified

pytestmark = pytest.mark.usefixtures("coarse_parts")
EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@pytest.fixture(
    scope="module",
    params=["rocker", pytest.param("tapered-biglide", marks=pytest.mark.exhaustive)],
)
def exported(request, tmp_path_factory):
    mechanism = load_robot(EXAMPLES / request.param / "robot.toml").mechanism
    folder = tmp_path_factory.mktemp("export")
    export_mechanism(mechanism, "quick", folder)
    return mechanism, folder


def test_every_file_is_read_back(exported):
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
