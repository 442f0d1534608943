"""Probabilities of verdicts where inputs are uncertain: closed forms and plain Monte Carlo."""

from dataclasses import replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from one_arm import ONE_ARM
from scipy.stats import norm, qmc, sobol_indices
from written_robot import robot_of

from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import RobotFile, load_robot
from validation.adequacy.judgement import judged
from validation.adequacy.models import JUDGED
from validation.adequacy.probability import ErrorOfInputs, Slope, probability
from validation.adequacy.response import Subject
from validation.adequacy.robot import robot_subject
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.models.mechanism import answers

pytestmark = pytest.mark.usefixtures("coarse_legs")

LIMIT, ERROR = 0.05, 0.04


def linear(*slopes: float, misfit: float = 0.0) -> ErrorOfInputs:
    """An error of 4 % in one pose that is linear in some inputs, known to 2 % each."""
    own = np.full((2, 1), ERROR)
    return ErrorOfInputs(
        own,
        [
            Slope(f"input{k}", 0.02, own - slope, own + slope, np.array([[-slope], [slope]]))
            for k, slope in enumerate(slopes)
        ],
        misfit,
    )


def test_a_linear_error_is_normal() -> None:
    found = probability(linear(0.006, 0.008), "adequate", LIMIT, 0)
    assert found.within == pytest.approx(norm.cdf((LIMIT - ERROR) / 0.01), abs=2e-3)
    assert found.within + found.beyond == 1.0
    assert found.half_width == pytest.approx(1.96 * 0.01, rel=0.01)
    assert found.of_value == pytest.approx(1.96 * 0.01, rel=1e-4)
    assert found.shares == pytest.approx({"input1": 0.64, "input0": 0.36})
    assert found.settled("adequate") == "undecided"


def test_a_verdict_is_that_of_all_poses() -> None:
    """An input that raises the error in one pose and lowers it in the other."""
    own, way = np.full((2, 2), ERROR), np.array([0.01, -0.01])
    error = ErrorOfInputs(own, [Slope("input", 0.02, own - way, own + way, np.zeros((2, 2)))])
    found = probability(error, "adequate", LIMIT, 0)
    assert found.within == pytest.approx(1.0 - 2.0 * norm.sf(1.0), abs=2e-3)


def test_an_input_is_to_be_known_so_well_that_the_verdict_is_95_percent_sure() -> None:
    found = probability(linear(0.002, 0.02), "adequate", LIMIT, 0)
    # The second one's own part: what 1.645 standard uncertainties of 1 % leave beside the first.
    left = sqrt(((LIMIT - ERROR) / norm.ppf(0.95)) ** 2 - 0.002**2)
    said = float(found.decides.split("of ")[1].split(" %")[0])
    assert said == pytest.approx(2.0 * left / 0.02, rel=0.05)
    assert found.decides.startswith("input1 known")
    # Each alone leaves 1.645 times 1 %, more than there is.
    together = probability(linear(0.01, 0.01), "adequate", LIMIT, 0)
    assert together.decides == "input1 and input0 known better would decide it together"


def test_what_the_quadratic_form_misses_counts_against_both_verdicts() -> None:
    found = probability(linear(0.01, misfit=0.005), "adequate", LIMIT, 0)
    assert found.within == pytest.approx(norm.cdf(0.5), abs=2e-3)
    assert found.beyond == pytest.approx(norm.sf(1.5), abs=2e-3)


def test_draws_without_such_an_error_are_in_neither_verdict() -> None:
    error = linear(0.002)
    (slope,) = error.slopes
    lost = replace(error, slopes=[replace(slope, below=np.full((2, 1), np.nan))])
    found = probability(lost, "adequate", LIMIT, 0)
    # From half a standard uncertainty below on: it is there at none and is not at one.
    assert found.within == pytest.approx(norm.cdf(0.5), abs=2e-3)
    assert found.beyond == 0.0
    known = 2.0 * (0.5 / norm.ppf(0.95) - 0.01)
    assert found.decides.startswith(f"input0 known to a standard uncertainty of {known:.2g} %")
    assert probability(replace(error, lost=0.25), "adequate", LIMIT, 0).within == 0.75


def test_shares_are_the_indices_of_sobol() -> None:
    own = np.full((2, 1), ERROR)
    bent = [
        Slope("a", 0.1, own + 0.010, own + 0.002, np.zeros((2, 1))),
        Slope("b", 0.1, own - 0.003, own + 0.006, np.zeros((2, 1))),
    ]
    error = ErrorOfInputs(own, bent)

    def middle(draws: Array) -> Array:
        return np.asarray(error.at(draws.T)[:, :, 0].mean(axis=1))

    found = sobol_indices(func=middle, n=2**13, dists=[norm(), norm()], rng=0)
    own_shares = error.shares(0)
    assert [own_shares["a"], own_shares["b"]] == pytest.approx(found.first_order, abs=0.02)


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> RobotFile:
    """One arm on a drive, whose stiffness is known to 10 %, its modulus to 5 %."""
    return robot_of(
        ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "free"')
        + '[[input_uncertainty]]\nkey = "joints.motor.drive.stiffness"\nrelative = 0.1\n'
        + '[[input_uncertainty]]\nkey = "bodies.arm.material.E"\nrelative = 0.05\n'
        + "[path]\nposes = [[0.0]]\n",
        tmp_path_factory.mktemp("arm"),
    )


@pytest.fixture(scope="module")
def of_arm(arm: RobotFile) -> Subject:
    return robot_subject(Context(arm, "quick"))


def test_rigid_bodies_on_a_drive_are_judged_as_by_hand(of_arm: Subject) -> None:
    # Deflection by the drive L²/k, by the arm L³/3EI + 6L/5GA (ν = 0: G = E/2).
    length, width, height, modulus = 0.5, 0.06, 0.04, 2.1e11
    area, inertia = width * height, height * width**3 / 12.0
    by_arm = length**3 / (3 * modulus * inertia) + 1.2 * length / (0.5 * modulus * area)
    ratio = by_arm / (length**2 / 5.0e4)
    # Rigid bodies miss the arm's part; it grows with k and falls with E.
    draws = np.random.default_rng(0).normal(size=(200_000, 2)) * [0.1, 0.05]
    ratios = ratio * (1.0 + draws[:, 0]) / (1.0 + draws[:, 1])
    errors = ratios / (1.0 + ratios)
    limit = float(np.quantile(errors, 0.8))
    entry = judged(of_arm, Requirement(modes=2, limits={"x": limit})).entry("simplified", "x")
    assert entry.error == pytest.approx(ratio / (1.0 + ratio), rel=2e-3)
    # The solid's mesh is left open on both sides, and what the quadratic form misses.
    assert entry.probability == pytest.approx(0.8, abs=0.02)
    assert entry.verdict == "undecided"
    assert "joints.motor.drive.stiffness known to a standard uncertainty of" in entry.reason
    variances = np.array([0.1, 0.05]) ** 2
    first, second = variances / variances.sum()
    assert entry.input_shares["joints.motor.drive.stiffness"] == pytest.approx(first, abs=0.02)
    assert entry.input_shares["bodies.arm.material.E"] == pytest.approx(second, abs=0.02)
    assert entry.value_spread == pytest.approx(1.96 * 0.1 * entry.value, rel=0.02)


def without_modes(robot: Subject) -> Subject:
    silent = (
        replace(one, response=replace(one.response, vibration=None)) for one in robot.candidates
    )
    return replace(robot, candidates=list(silent))


def test_robots_whose_mode_is_lost_count_against_the_verdict(of_arm: Subject) -> None:
    assert of_arm.inputs
    first, *others = of_arm.inputs.alone
    alone = [replace(first, below=without_modes(first.below)), *others]
    together = [without_modes(of_arm.inputs.together[0]), *of_arm.inputs.together[1:]]
    for inputs, within, reason in (
        (replace(of_arm.inputs, alone=alone), norm.cdf(0.5), f"{first.key} known to"),
        (replace(of_arm.inputs, together=together), 1.0 - 1.0 / len(together), ""),
    ):
        entry = judged(replace(of_arm, inputs=inputs), Requirement(modes=2)).entry("beam", "f1")
        assert entry.probability == pytest.approx(within, abs=2e-3)
        assert entry.probability_beyond == 0.0
        assert entry.verdict == "undecided"
        assert entry.reason.startswith(reason)


def test_what_scales_model_and_reference_alike_leaves_the_error_as_it_is(of_arm: Subject) -> None:
    found = judged(of_arm, Requirement(modes=2))
    beam, first = found.entry("beam", "z"), found.entry("beam", "f1")
    assert beam.uncertainties["inputs"] < 1e-4
    assert (beam.probability, beam.verdict) == (1.0, "adequate")
    assert first.probability == 1.0


def test_without_a_table_moduli_lengths_and_stiffnesses_can_be_supposed_uncertain(
    arm: RobotFile,
) -> None:
    five_bar, ifw = (load_robot(name) for name in ("five-bar", "ifw"))
    assert five_bar.uncertain_inputs == {}
    drives = [f"joints.motor{k}.drive.stiffness" for k in (1, 2)]
    supposed = ["materials.steel.E", "materials.aluminium.E", *drives]
    assert replace(five_bar, supposed=0.05).uncertain_inputs == dict.fromkeys(supposed, 0.05)
    of_legs = [f"leg{k}.{what}" for k in (1, 2) for what in ("length", "compliance")]
    assert list(replace(ifw, supposed=0.1).uncertain_inputs) == [
        *("actuators.stiffness", "foot.compliance", *of_legs, "tool.compliance")
    ]
    # What the file says goes before.
    assert replace(arm, supposed=0.5).uncertain_inputs == arm.uncertain_inputs


# Of robots a model, a quantity, the limit in errors of its own, and the uncertain inputs.
UNCERTAIN: dict[str, tuple[str, str, float, dict[str, float]]] = {
    "ifw": (
        *("vjm-equivalent", "y", 1.04),
        {"foot.compliance": 0.1, "leg1.compliance": 0.1, "leg2.compliance": 0.15},
    ),
    "five-bar": (
        *("simplified", "f1", 1.03),
        {"joints.motor1.drive.stiffness": 0.1, "materials.steel.E": 0.05, "tool.mass": 0.1},
    ),
    "3-rrr": (
        *("simplified", "x", 1.03),
        {"joints.motor1.drive.stiffness": 0.1, "joints.motor2.drive.stiffness": 0.15}
        | {"materials.steel.E": 0.05},
    ),
}


@pytest.mark.soak
@pytest.mark.parametrize("name", UNCERTAIN)
def test_probabilities_are_those_of_2000_robots(name: str, tmp_path: Path) -> None:
    model, quantity, times, inputs = UNCERTAIN[name]
    said = "".join(
        f"[[input_uncertainty]]\nkey = '{k}'\nrelative = {u}\n" for k, u in inputs.items()
    )
    robot = robot_of(load_robot(name).text.replace("count = 9", "count = 3") + said, tmp_path)
    subject = robot_subject(Context(robot, "quick"))
    limit = times * abs(judged(subject, robot.requirement).entry(model, quantity).error)
    entry = judged(subject, Requirement(limits={quantity: limit})).entry(model, quantity)
    own = errors_of(robot.mechanism, subject.poses, model, quantity)
    told, spread = (np.array(one, dtype=float) for one in (entry.errors, entry.spreads))
    within = 0
    # As many robots drawn by a random generator scatter by 0.01, these by 0.002.
    points = norm.ppf(qmc.Sobol(len(inputs), seed=7).random_base2(11))
    for draw in points * list(inputs.values()):
        off = robot.with_factors(dict(zip(inputs, draw, strict=True)))
        # What the reference has beyond its beams stays, as a factor of 1 + error.
        found = errors_of(off, subject.poses, model, quantity)
        errors = (1.0 + told) * (1.0 + found) / (1.0 + own) - 1.0
        within += bool((np.abs(errors) + spread <= limit).all())
    assert entry.probability == pytest.approx(within / len(points), abs=0.02)


def errors_of(robot: Mechanism, poses: Array, model: str, quantity: str) -> Array:
    """Errors of a model against beams in frequency, against links in deflections."""
    at = postures_of(robot, poses)
    if quantity == "f1":
        rigid, beams = (answers(kind, at, 2) for kind in ("simplified", "beam"))
        pairs = zip(rigid, beams, strict=True)
        return np.array([a.frequencies[0] / b.frequencies[0] - 1.0 for a, b in pairs])
    asked, axis = JUDGED[model], "xyz".index(quantity)
    both = answers(asked.kind, at, 0, asked.options), answers("links", at, 0)
    own, due = (np.array([one.compliance[:3, axis] for one in found]) for found in both)
    off, size = (np.linalg.norm(one, axis=1) for one in (own - due, due))
    return np.asarray(off / size)
