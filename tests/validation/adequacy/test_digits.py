"""Digits of a robot file as an uncertainty, against robots whose digits are drawn and read."""

import re
from pathlib import Path

import numpy as np
import pytest
from written_robot import robot_of

from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.robot_file import RobotFile, load_robot
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism import digits
from validation.adequacy.mechanism.digits import left_by_digits
from validation.adequacy.response import Subject
from validation.kinematics.poses import postures_of
from validation.models.loads.leg_masses import MASSES
from validation.models.mechanism import answers
from validation.models.options import DEFAULT_OPTIONS, ModelName
from validation.models.roundings import roundings_of
from validation.solve.answer import Answer, Solution, as_text, record_of
from validation.solve.model_answers import solve
from validation.solve.question import Question

DRAWS = 60
MATRIX = re.compile(r"(compliance = \[)(.*?)(\n\])", re.DOTALL)


def drawn(text: str, rng: np.random.Generator) -> str:
    """The text with every entry of its 6×6 anywhere within half a unit of its last digit."""

    def within(block: re.Match[str]) -> str:
        entries = [re.findall(r"-?[\d.]+e-\d+", row) for row in block[2].strip().splitlines()]
        off = rng.uniform(-0.5, 0.5, (6, 6))
        rows = []
        for i, row in enumerate(entries):
            numbers = []
            for j, entry in enumerate(row):
                digits, exponent = entry.split("e")
                unit = 10.0 ** (int(exponent) - len(digits.split(".")[1]))
                numbers.append(float(entry) + unit * off[min(i, j), max(i, j)])
            rows.append(f"[{', '.join(map(str, numbers))}]")
        return f"{block[1]}{', '.join(rows)}{block[3]}"

    return MATRIX.sub(within, text)


def virtual_joints(robot: RobotFile, poses: Array) -> Array:
    """Compliances (p×6×6) by virtual joints, which share no code with the assembler."""
    postures = postures_of(robot.mechanism, poses)
    return np.array([one.compliance for one in answers("vjm", postures, 0, DEFAULT_OPTIONS)])


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> RobotFile:
    """The paper's robot without its corrections, which have to stand in the file as they are."""
    text = load_robot("ifw").text.split("\n[[corrections]]\n")[0]
    return robot_of(text, tmp_path_factory.mktemp("printed"))


def test_95_percent_of_all_robots_with_these_digits_lie_within(
    printed: RobotFile, tmp_path: Path
) -> None:
    poses = printed.mechanism.poses[[1, 4]]
    stated = left_by_digits(printed.text, postures_of(printed.mechanism, poses))
    own, rng = virtual_joints(printed, poses), np.random.default_rng(24)
    off = []
    for _ in range(DRAWS):
        change = virtual_joints(robot_of(drawn(printed.text, rng), tmp_path), poses) - own
        columns = change[:, :3, :3], own[:, :3, :3]
        lengths = [np.linalg.norm(one, axis=1) for one in columns]
        off.append(lengths[0] / lengths[1])
    inside = np.mean(np.array(off) <= stated[:, :3], axis=0)
    # The share of 60 draws scatters by 3 %.
    assert np.abs(inside - 0.95).max() <= 0.05


def test_a_digit_moves_frequencies_as_solving_the_robot_with_it_changed_does(
    printed: RobotFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    postures = tuple(postures_of(printed.mechanism, printed.mechanism.poses[[2]]))
    # The first of the feet's joints, of leg 1 and of leg 2: extension.
    roundings = roundings_of(printed.text, postures)
    changed = {
        tuple(
            name
            for name, body in one.postures[0].mechanism.bodies.items()
            if body is not printed.mechanism.bodies[name]
        ): one
        for one in reversed(roundings)
    }
    assert len(changed) == 3
    for one in changed.values():
        monkeypatch.setattr(digits, "roundings_of", lambda *_, one=one: [one])
        found = digits.modes_by_digits(printed.text, postures, 4, MASSES[0])
        moved = digits.modes_by_digits(printed.text, tuple(one.postures), 4, MASSES[0])
        own, share = found
        off = np.abs(moved[0].frequencies / own.frequencies - 1.0) * one.factor
        # Differences of numbers that agree to 1e-6, or less.
        assert np.allclose(share, off, rtol=1e-3, atol=1e-3 * off.max())


def test_more_digits_leave_less_and_many_nothing_that_is_looked_at(printed: RobotFile) -> None:
    postures = postures_of(printed.mechanism, printed.mechanism.poses[[4]])

    def stated(digits: int) -> float:
        def longer(block: re.Match[str]) -> str:
            number = f"{{:.{digits - 1}e}}"
            return re.sub(r"-?[\d.]+e-\d+", lambda one: number.format(float(one[0])), block[0])

        return float(left_by_digits(MATRIX.sub(longer, printed.text), postures).max())

    # Two or three digits leave 1e-3.
    assert 0.0 < stated(5) < 1e-4
    assert stated(12) == 0.0


@pytest.mark.parametrize(("model", "draws"), [("vjm", 60), ("segments", 8)])
def test_solve_says_what_the_digits_leave_open_at_most(
    printed: RobotFile, tmp_path: Path, model: ModelName, draws: int
) -> None:

    def solved(robot: RobotFile, *, digits: bool = False) -> Answer:
        return solve(Question(robot, model, {}, digits=digits)).answers[0]

    def sizes(answer: Answer) -> Array:
        return np.concatenate([np.diag(answer.compliance), answer.frequencies])

    answer, rng = solved(printed, digits=True), np.random.default_rng(24)
    most = np.concatenate([answer.of_digits.compliance, answer.of_digits.frequencies])
    drawn_ones = (solved(robot_of(drawn(printed.text, rng), tmp_path)) for _ in range(draws))
    largest = np.max([np.abs(sizes(one) - sizes(answer)) for one in drawn_ones], axis=0)
    # No draw has all its roundings on one side; five numbers or so count in each.
    assert (largest <= most).all()
    assert (most <= 5.0 * largest).all()
    assert record_of(answer)["digits"]["compliance"] == most[:6].tolist()
    text = as_text(Solution(printed.mechanism.name, model, {}, (answer,)))
    assert "uncertainty from the last digits of the 6×6 in the robot file (at most):" in text


def test_what_is_not_the_robots_leaves_nothing_open() -> None:
    """Legs of a section have no 6×6; those of another file have another one."""
    five_bar = load_robot("five-bar").mechanism
    for text in (load_robot("five-bar").text, load_robot("ifw").text):
        assert not left_by_digits(text, postures_of(five_bar, five_bar.poses[:2])).any()


def test_a_limit_that_the_digits_do_not_decide_is_undecided_and_says_so(
    paper_subject: Subject,
) -> None:
    entry = judged(paper_subject, Requirement(deflection=1e-4)).entry("vjm", "y")
    assert entry.verdict == "undecided"
    assert entry.reason == "give the 6×6 in the robot file with more digits"


def test_modes_of_the_papers_robot_are_known_to_its_digits(paper: Matrix) -> None:
    for quantity in ("f1", "f2"):
        entry = paper.entry("beam", quantity)
        assert 5e-4 < entry.uncertainties["digits of the file"] < 3e-3
    assert all("digits of the file" not in one.uncertainties for one in paper.formulation.entries)
