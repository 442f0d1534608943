"""The robot with solid legs: its cases turn, and `solve` gives the unreduced robot's numbers."""

import numpy as np
import pytest
from compliances import scaled_difference
from numpy.testing import assert_allclose

from lumped.biglide import with_equivalent_legs
from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation.context import Context
from validation.models.biglide import robot_compliance, robot_frequencies, robot_legs
from validation.models.options import ModelOptions
from validation.solids.robots import full_mac, unreduced_robot
from validation.studies.paired_robot_modes import ELEMENTS, model_modes, paired, solid_modes

ROBOT_FILE = load_robot("ifw")
ROBOT = with_equivalent_legs(ROBOT_FILE.robot)


@pytest.fixture(scope="module")
def context():
    return Context(ROBOT_FILE, "quick")


@pytest.mark.parametrize("x", [ROBOT.stroke[0], ROBOT.centre])
def test_solve_with_solid_legs_is_the_unreduced_robot(x):
    options = ModelOptions(divisions=1)
    (whole,) = unreduced_robot(ROBOT, (x,), 1, 6)
    found = robot_compliance("solid", ROBOT_FILE.robot, x, options)
    # Required: statics 1e-9, frequencies 1e-4.
    assert scaled_difference(found, whole.compliance) < 1e-9
    frequencies = robot_frequencies("solid", ROBOT_FILE.robot, x, 6, options)
    assert_allclose(frequencies, whole.modes.frequencies, rtol=1e-4)


def test_free_ends_are_softer_against_torsion_alone():
    """Known values: warping restrained at rigid faces; planar loads cause no torsion."""
    rigid, free = (
        robot_compliance("solid", ROBOT, ROBOT.centre, ModelOptions(divisions=2, ends=ends))
        for ends in ("rigid", "free")
    )
    assert_allclose(free[:2, :2], rigid[:2, :2], rtol=1e-6)
    assert 0.005 < free[2, 2] / rigid[2, 2] - 1.0 < 0.021


def test_solid_legs_are_never_silently_beams():
    with pytest.raises(InputError, match="solid"):
        robot_legs("solid", ROBOT)


def test_full_mac_pairs_shapes_in_any_order_and_sees_a_wrong_one():
    mass = np.diag([1.0, 2.0, 3.0, 4.0])
    shapes = np.eye(4)[:, :3]
    apart = np.array([1.0, 2.0, 3.0])
    assert_allclose(full_mac(mass, shapes, -2.0 * shapes[:, [2, 0, 1]], apart), 1.0)
    wrong = shapes.copy()
    wrong[:, 0] = [1.0, 0.0, 0.0, 0.5]
    # (1·1·1)² / (1 · (1 + 4/4)) = 1/2.
    assert_allclose(full_mac(mass, shapes, wrong, apart), [0.5, 1.0, 1.0])


def test_full_mac_compares_shapes_of_a_double_mode_with_their_plane():
    mass, shapes = np.diag([1.0, 2.0, 3.0]), np.diag([1.0, 0.5**0.5, 3.0**-0.5])
    turned = shapes.copy()
    turned[:, :2] = shapes[:, :2] @ np.array([[0.6, -0.8], [0.8, 0.6]])
    assert_allclose(full_mac(mass, shapes, turned, np.array([2.0, 2.0, 3.0])), 1.0)
    # The last of those compared is one of a pair, too.
    twins = np.array([1.0, 3.0, 3.0])
    turned = shapes @ np.array([[1.0, 0.0, 0.0], [0.0, 0.6, -0.8], [0.0, 0.8, 0.6]])
    assert_allclose(full_mac(mass, shapes[:, :2], turned, twins), 1.0)
    assert_allclose(full_mac(mass, shapes[:, :2], turned[:, :2], twins[:2]), [1.0, 0.36])
    # Two modes that are only near each other are themselves: 0.8².
    near = np.array([1.0, 3.0, 3.001])
    assert_allclose(full_mac(mass, shapes, turned, near), [1.0, 0.64, 0.64])


def test_close_modes_are_marked_and_compared_as_spaces():
    """At the right end modes 6 and 7 are 713 Hz and 733 Hz, 2.8 % apart (segments)."""
    segments = model_modes(ROBOT, "segments", "timoshenko", ELEMENTS, 3)
    found = paired(ROBOT, segments, solid_modes(ROBOT, (1, 1), "rigid", 3))
    assert found.close[-1].tolist() == [False] * 5 + [True]
    assert not found.close[:-1].any()
