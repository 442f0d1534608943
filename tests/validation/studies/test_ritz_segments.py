"""What theory says that rigid segments miss of frequencies, against segments and polynomials."""

import numpy as np
import pytest
from extreme_robots import extreme_robots

from lumped.robot_file import load_robot
from validation.studies.quantities import rounded_frequencies
from validation.studies.ritz import biglide as ritz

ROBOTS = list(extreme_robots(30, 7))
# Legs that bend and shear (the paper's), that bend alone, stretch and twist.
CHOSEN = {"ifw": "ifw", "slender": 28, "stretch": 16, "twist": 29}


@pytest.fixture(params=CHOSEN.values(), ids=CHOSEN)
def robot(request, tmp_path):
    if isinstance(request.param, str):
        return load_robot(request.param).robot
    path = tmp_path / "robot.toml"
    path.write_text(ROBOTS[request.param], encoding="utf-8")
    return load_robot(path).robot


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_it_is_what_polynomials_miss_in_segments(robot, share):
    x = robot.stroke[0] + share * robot.stroke_length
    own, rounding = rounded_frequencies("segments", robot, x, 4)
    expected = own - ritz.frequencies(robot, x, 4)
    second = np.abs(expected)
    known = second > 1e-5 * own + 50.0 * rounding
    assert known.any()
    # What is left is of fourth order: of twenty segments some percent of the second.
    assert np.all(
        np.abs(ritz.missed_by_segments(robot, x, 4) - expected)[known] < 0.03 * second[known]
    )


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_twice_the_segments_leave_a_quarter(robot, theory):
    few, many = (
        ritz.missed_by_segments(robot, robot.centre, 4, theory, segments) for segments in (20, 40)
    )
    known = np.abs(few) > 1e-6 * ritz.frequencies(robot, robot.centre, 4, theory)
    assert known.any()
    assert (few / many)[known] == pytest.approx(4.0, rel=0.05)
