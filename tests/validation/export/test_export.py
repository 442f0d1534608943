"""Exported files, read back by other readers, say what the models say."""

import numpy as np
import pytest
import pyvista
from exported import assert_read_back
from like_ifw import IFW, LEG1, LEG2, placed_at
from scipy.sparse import load_npz

from lumped.legs import equivalent_leg, tip_compliance
from lumped.models.cantilever import clamped_modes, tip_compliance_of
from validation.export.mechanism import export_mechanism
from validation.export.models import DIVISIONS
from validation.export.readme import OF_PARTS, write_readme
from validation.models.legs import clamped_solid, leg_matrices
from validation.models.mechanism import answers


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("export")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(DIVISIONS, "quick", 1)
        export_mechanism(IFW.mechanism, "quick", path)
    return path


@pytest.mark.parametrize("number", [1, 2])
def test_the_tip_of_the_solid_moves_by_its_compliance(folder, number):
    leg = equivalent_leg((LEG1, LEG2)[number - 1])
    mesh = pyvista.read(folder / f"leg{number}_solid.vtu")
    assert mesh.bounds[1] == pytest.approx(leg.length, rel=1e-12)
    assert mesh.volume == pytest.approx(leg.section.area * leg.length, rel=1e-9)
    compliance = clamped_solid(leg, 1, "rigid").compliance
    tip = mesh.find_closest_point((leg.length, 0.0, 0.0))
    assert mesh.points[tip] == pytest.approx([leg.length, 0.0, 0.0], abs=1e-12)
    for column, wrench in enumerate(("Fx", "Fy", "Fz")):
        # The end face is rigid: its midpoint moves with the tip.
        assert mesh.point_data[f"displacement {wrench}"][tip] == pytest.approx(
            compliance[:3, column], rel=1e-7, abs=1e-7 * compliance[column, column]
        )
    root = np.isclose(mesh.points[:, 0], 0.0)
    assert root.sum() > 8
    assert not mesh.point_data["displacement Mz"][root].any()
    assert not mesh.point_data["mode 1"][root].any()


@pytest.mark.parametrize("model", ["segments", "beam"])
def test_centrelines_deflect_as_a_cantilever(folder, model):
    leg = equivalent_leg(LEG1)
    line = pyvista.read(folder / f"leg1_{model}.vtp")
    assert line.n_lines == 1
    assert line.length == pytest.approx(leg.length)
    # Closed form of the Timoshenko cantilever; both models are exact at the tip.
    closed = tip_compliance(leg.properties("timoshenko"), leg.length)
    tip = np.hstack(
        [
            [line.point_data[f"displacement {w}"][-1], line.point_data[f"rotation {w}"][-1]]
            for w in ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
        ]
    )  # fmt: skip
    assert tip.shape == (2, 18)
    found = np.vstack([tip[:, 3 * k : 3 * k + 3].ravel() for k in range(6)]).T
    # A dense solve of the assembled matrix loses five digits of sixteen to its condition.
    assert found == pytest.approx(closed, rel=1e-8, abs=1e-8 * closed.diagonal().min())


@pytest.mark.parametrize(("model", "along_x"), [("segments", slice(12, None, 6)), ("solid", None)])
def test_a_rigid_translation_carries_the_mass_of_the_leg(folder, model, along_x):
    for number, given in enumerate((LEG1, LEG2), start=1):
        mass = load_npz(folder / f"leg{number}_{model}_M.npz")
        translation = np.zeros(mass.shape[0])
        translation[[0, 6]] = 1.0
        translation[along_x or slice(12, None, 3)] = 1.0
        assert translation @ mass @ translation == pytest.approx(given.mass, rel=1e-9)


def test_the_matrices_give_the_models_compliance_and_frequencies(folder):
    leg = leg_matrices("beam", equivalent_leg(LEG1))
    K, M = (load_npz(folder / f"leg1_beam_{letter}.npz").toarray()[6:, 6:] for letter in "KM")
    found = np.linalg.inv(K)[:6, :6]
    assert found == pytest.approx(tip_compliance_of(leg), rel=1e-6, abs=1e-20)
    values = np.linalg.eigvals(np.linalg.solve(K, M)).real
    first = 1.0 / (2.0 * np.pi * np.sqrt(values.max()))
    assert first == pytest.approx(clamped_modes(leg, 1).frequencies[0], rel=1e-6)
    assert pyvista.read(folder / "leg1_beam.vtp").field_data["frequencies"][0] == pytest.approx(
        first, rel=1e-6
    )


def test_the_robot_deflects_at_b_by_its_compliance(folder):
    robot = pyvista.read(folder / "mechanism_beam.vtp")
    assert robot.n_lines == 2
    half = robot.n_points // 2
    (answer,) = answers("beam", placed_at(IFW.mechanism), 6)
    compliance = answer.compliance
    for tip in (half - 1, -1):
        assert robot.points[tip] == pytest.approx([0.4975, 0.0, 0.0], abs=1e-12)
        for column, wrench in enumerate(("Fx", "Fy", "Fz")):
            # The revolute joint at B lets the legs turn; they share its displacement.
            assert robot.point_data[f"displacement {wrench}"][tip] == pytest.approx(
                compliance[:3, column], rel=1e-7, abs=1e-7 * compliance[2, 2]
            )
    assert robot.field_data["frequencies"] == pytest.approx(answer.frequencies, rel=1e-9)


def test_every_file_is_read_back(folder):
    assert_read_back(folder)


def test_a_file_that_nobody_describes_is_refused(tmp_path):
    (tmp_path / "strange.dat").write_bytes(b"")
    with pytest.raises(ValueError, match="strange"):
        write_readme(tmp_path, "Head", OF_PARTS)
