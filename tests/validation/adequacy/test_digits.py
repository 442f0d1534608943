"""Digits of a robot file as an uncertainty, against robots whose digits are drawn and read."""

import re
from decimal import Decimal
from itertools import groupby

import numpy as np
import pytest
from written_robot import robot_of

from lumped.robot_file import load_robot
from validation.adequacy.mechanism import digits
from validation.adequacy.mechanism.digits import left_by_digits
from validation.kinematics.poses import postures_of
from validation.models.loads.leg_masses import MASSES
from validation.models.mechanism import answers
from validation.models.roundings import roundings_of
from validation.solve.answer import Solution, as_text, record_of
from validation.solve.model_answers import solve
from validation.solve.question import Question

MATRIX = re.compile(r"compliance = \[.*?\n\]", re.DOTALL)
NUMBER = re.compile(r"-?[\d.]+e-\d+")


def drawn(text, rng):
    """The text with every entry of its 6×6 anywhere within half a unit of its last digit."""

    def within(block):
        off = np.triu(rng.uniform(-0.5, 0.5, (6, 6)))
        off += np.triu(off, 1).T
        printed = [Decimal(entry) for entry in NUMBER.findall(block[0])]
        units = [10.0 ** entry.as_tuple().exponent for entry in printed]
        entries = np.array(printed, float) + units * off.ravel()
        return f"compliance = {entries.reshape(6, 6).tolist()}"

    return MATRIX.sub(within, text)


def virtual_joints(robot, poses):
    """Compliances (p×6×6) by virtual joints, which share no code with the assembler."""
    postures = postures_of(robot.mechanism, poses)
    return np.array([one.compliance for one in answers("vjm", postures, 0)])


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """The paper's robot without its corrections, which have to stand in the file as they are."""
    text = load_robot("ifw").text.split("\n[[corrections]]\n")[0]
    return robot_of(text, tmp_path_factory.mktemp("printed"))


@pytest.fixture(scope="module")
def draws(printed, tmp_path_factory):
    """Robots that are printed like it."""
    rng, folder = np.random.default_rng(24), tmp_path_factory.mktemp("draws")
    return [robot_of(drawn(printed.text, rng), folder) for _ in range(60)]


def test_95_percent_of_all_robots_with_these_digits_lie_within(printed, draws):
    poses = printed.mechanism.poses[[1, 4]]
    stated = left_by_digits(printed.text, postures_of(printed.mechanism, poses))
    own = virtual_joints(printed, poses)
    changes = np.array([virtual_joints(robot, poses) for robot in draws]) - own
    moved, due = (np.linalg.norm(one[..., :3, :3], axis=-2) for one in (changes, own))
    inside = np.mean(moved / due <= stated[:, :3], axis=0)
    # The share of 60 draws scatters by 3 %.
    assert np.abs(inside - 0.95).max() <= 0.05


def test_a_digit_moves_frequencies_as_solving_the_robot_with_it_changed_does(printed, monkeypatch):
    bodies, poses = printed.mechanism.bodies, printed.mechanism.poses[[2]]
    postures = tuple(postures_of(printed.mechanism, poses))

    def changed(rounding):
        found = rounding.postures[0].mechanism.bodies
        return [name for name in bodies if found[name] is not bodies[name]]

    # The first of the feet's joints, of leg 1 and of leg 2: extension.
    families = groupby(roundings_of(printed.text, postures), changed)
    first_ones = [next(family) for _, family in families]
    assert len(first_ones) == 3
    for one in first_ones:
        monkeypatch.setattr(digits, "roundings_of", lambda *_, one=one: [one])
        own, share = digits.modes_by_digits(printed.text, postures, 4, MASSES[0])
        moved, _ = digits.modes_by_digits(printed.text, tuple(one.postures), 4, MASSES[0])
        off = np.abs(moved.frequencies / own.frequencies - 1.0) * one.factor
        # Differences of numbers that agree to 1e-6, or less.
        assert np.allclose(share, off, rtol=1e-3, atol=1e-3 * off.max())


def test_more_digits_leave_less_and_those_of_no_leg_nothing(printed):
    postures = postures_of(printed.mechanism, printed.mechanism.poses[[4]])

    def left_with(digits):
        def longer(number):
            return f"{float(number[0]):.{digits - 1}e}"

        text = MATRIX.sub(lambda block: NUMBER.sub(longer, block[0]), printed.text)
        return left_by_digits(text, postures).max()

    # Two or three digits leave 1e-3.
    assert 0.0 < left_with(5) < 1e-4
    assert left_with(12) == 0.0
    # Legs of a section have no 6×6; those of another file have another one.
    five_bar = load_robot("five-bar")
    postures = postures_of(five_bar.mechanism, five_bar.mechanism.poses[:2])
    assert not any(left_by_digits(one.text, postures).any() for one in (five_bar, printed))


@pytest.mark.parametrize(("model", "count"), [("vjm", 60), ("segments", 8)])
def test_solve_says_what_the_digits_leave_open_at_most(printed, draws, model, count):
    def solved(robot, *, digits=False):
        return solve(Question(robot, model, {}, digits=digits)).answers[0]

    def sizes(answer):
        return np.concatenate([np.diag(answer.compliance), answer.frequencies])

    answer = solved(printed, digits=True)
    most = np.concatenate([answer.of_digits.compliance, answer.of_digits.frequencies])
    robots = map(solved, draws[:count])
    largest = np.max([np.abs(sizes(one) - sizes(answer)) for one in robots], axis=0)
    # No draw has all its roundings on one side; five numbers or so count in each.
    assert (largest <= most).all()
    assert (most <= 5.0 * largest).all()
    assert record_of(answer)["digits"]["compliance"] == most[:6].tolist()
    text = as_text(Solution(printed.mechanism.name, model, {}, (answer,)))
    assert "uncertainty from the last digits of the 6×6 in the robot file (at most):" in text
