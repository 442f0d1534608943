"""The numbers that tables show: units, directions and postures, by hand and solved once more."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from lumped.dense.modes import dense
from lumped.robot_file import load_robot
from validation.models.biglide import robot_system
from validation.studies.quantities import (
    deflections_of,
    farthest,
    robot_modes,
    stroke_deflections,
    stroke_frequencies,
)

ROBOT = load_robot("ifw").robot


def test_deflections_are_in_micrometres_at_1000_newton():
    matrix = np.diag([0.0, 0.0, 3e-8, 0.0, 0.0, 0.0])
    matrix[:2, :2] = [[3e-9, 4e-9], [4e-9, 12e-9]]
    found = deflections_of(np.array([matrix, 2.0 * matrix]))
    assert found.planar_x == pytest.approx([5.0, 10.0])
    assert found.planar_y == pytest.approx([np.sqrt(160.0), 2.0 * np.sqrt(160.0)])
    assert found.along_z == pytest.approx([30.0, 60.0])
    assert found.largest_planar == pytest.approx(2.0 * np.sqrt(160.0))
    assert np.isnan(deflections_of(matrix[None, :2, :2]).along_z).all()


@pytest.mark.parametrize("off", [0.01, -0.01])
@pytest.mark.parametrize("place", range(4))
def test_the_posture_shown_is_the_one_that_is_farthest_off(off, place):
    even = np.array([2.0, 4.0, 8.0, 16.0])
    found = even * (1.0 + off * np.where(np.arange(4) == place, 1.0, 0.5))
    assert farthest(found, even) == place


def on_drives(robot, x):
    """Displacements (µm, 2×2) of B under 1000 N along x and y: legs rigid, drives elastic.

    A slide at (p, y_A) with |B − A| = L: (x − p) δx + s (δy − δy_A) = 0, s the leg's height.
    """
    heights = np.sqrt([robot.leg1.length**2 - x**2, robot.leg2.length**2 - (robot.a - x) ** 2])
    from_slides = np.linalg.solve(np.column_stack([[x, x - robot.a], heights]), np.diag(heights))
    return from_slides @ from_slides.T / robot.actuator_stiffness * 1e9


def test_the_simplified_model_over_the_stroke_is_virtual_power():
    shown = stroke_deflections("simplified", ROBOT, 5)
    moved = [np.linalg.norm(on_drives(ROBOT, x), axis=0) for x in ROBOT.stations(5)]
    assert_allclose(np.column_stack([shown.planar_x, shown.planar_y]), moved, rtol=1e-5)


def test_deflections_do_the_work_that_the_parts_hold():
    shown = stroke_deflections("beam", ROBOT, 3)
    for number, x in enumerate(ROBOT.stations(3)):
        whole = robot_system("beam", ROBOT, x)
        motion = np.linalg.solve(dense(whole.stiffness), 1e3 * whole.tool.T[:, :3])
        moved = 1e6 * whole.tool[:3] @ motion
        assert shown.planar_x[number] == pytest.approx(np.hypot(*moved[:2, 0]), rel=1e-7)
        assert shown.planar_y[number] == pytest.approx(np.hypot(*moved[:2, 1]), rel=1e-7)
        assert shown.along_z[number] == pytest.approx(abs(moved[2, 2]), rel=1e-7)


@pytest.mark.parametrize("model", ["segments", "beam"])
def test_frequencies_are_rayleigh_quotients_in_hertz_and_shares_sum_to_one(model):
    shown = stroke_frequencies(model, ROBOT, 3, 4)
    for number, x in enumerate(ROBOT.stations(3)):
        whole = robot_system(model, ROBOT, x)
        # 1/ω² of M against K: bodies without mass have none.
        squares = eigh(dense(whole.mass), dense(whole.stiffness), eigvals_only=True)[::-1][:4]
        assert_allclose(shown[number], 1.0 / (2.0 * np.pi * np.sqrt(squares)), rtol=1e-5)
    found = robot_modes(model, ROBOT, ROBOT.centre, 4)
    shapes, whole = found.modes.shapes, found.system
    energies = [np.sum(shapes * (dense(m) @ shapes), axis=0) for m in (whole.stiffness, whole.mass)]
    quotients = np.sqrt(energies[0] / energies[1]) / (2.0 * np.pi)
    assert_allclose(quotients, found.modes.frequencies, rtol=1e-6)
    for shares in (found.strain, found.kinetic):
        assert_allclose(sum(shares.values()), 1.0)
        assert np.min(list(shares.values())) >= -1e-9
