"""Probabilities of verdicts with uncertain inputs, against closed forms and Monte Carlo."""

import re
from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
import scipy
from scipy.special import ndtr, ndtri
from support.fakes.toy_responses import reading
from support.fakes.toy_subject import toy_subject
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.probability import ErrorOfInputs, Slope, probability
from validation.adequacy.robot_verdicts import robot_subject
from validation.context import Context
from validation.references.reference import InputUncertainties, Reference
from validation.references.responses import Model, Responses, perturbed_robot

pytestmark = pytest.mark.usefixtures("coarse_legs")

LIMIT, ERROR = 0.05, 0.04
DRIVE, MODULUS = "joints.motor.drive.stiffness", "bodies.arm.material.E"


def linear(*slopes, misfit=0.0):
    """Error of 4 % that is linear in inputs with a standard uncertainty of 2 %.

    `slopes` has for each input the change of the error (per pose) by this uncertainty.
    """
    ways = [np.atleast_1d(slope) for slope in slopes]
    errors = signed(np.full(len(ways[0]), ERROR))
    sensitivities = [
        Slope(
            f"input{k}",
            0.02,
            errors - signed(direction),
            errors + signed(direction),
            np.stack([-direction, direction]),
        )
        for k, direction in enumerate(ways)
    ]
    return ErrorOfInputs(errors, sensitivities, signed=True, misfit=misfit)


def signed(errors):
    """Array of the errors of a frequency over the poses, with half-width 0, for one reading."""
    return np.stack([errors, np.zeros_like(errors)], axis=-1)[None, :, None, :]


def of_vectors(start, *ways):
    """Error vector `start` of a unit displacement; each input changes it by a vector of `ways`."""
    due = np.array([0.0, 0.0, 1.0])

    def at(deviations):
        return np.concatenate([due + deviations, due, [0.0, 0.0]])[None, None, None]

    none = np.zeros((2, 1))
    start, *ways = map(np.array, (start, *ways))
    slopes = [
        Slope(f"input{k}", 0.02, at(start - direction), at(start + direction), none)
        for k, direction in enumerate(ways)
    ]
    return ErrorOfInputs(at(start), slopes, signed=False)


# Along and across a displacement, and oblique to both.
LONG, ACROSS, OBLIQUE = (0.0, 0.0, 0.05), (0.0, 0.03, 0.0), (0.02, -0.01, 0.03)
NOTHING = (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("start", "limit", "within"),
    [
        # |0.05 ξ| has a kink at zero.
        (NOTHING, 0.08, 2.0 * ndtr(1.6) - 1.0),
        (NOTHING, 0.005, 2.0 * ndtr(0.1) - 1.0),
        # √(0.03² + 0.0025 ξ²), smallest at the inputs of the file,
        (ACROSS, 0.05, 2.0 * ndtr(0.8) - 1.0),
        (ACROSS, 0.02, 0.0),
        # |0.1 + 0.05 ξ|, which passes zero at −2.
        ((0.0, 0.0, 0.1), 0.05, ndtr(-1.0) - ndtr(-3.0)),
    ],
)
def test_probability_of_one_vector_error_is_exact(start, limit, within):
    """Size of an error vector that depends on one input ξ, for three formulas of this size."""
    probabilities = of_vectors(start, LONG).probabilities(limit)
    # Bisected to rounding; outside of the outermost of 4096 points there is nothing to be found.
    assert probabilities == pytest.approx([within, 1.0 - within], abs=1e-9)


def test_orthogonal_inputs_are_rayleigh():
    """Two orthogonal normal errors have a Rayleigh distributed size, 1 − exp(−r²/2σ²)."""
    error = of_vectors(NOTHING, LONG, (0.05, 0.0, 0.0))
    for limit in (0.01, 0.05, 0.1):
        within = 1.0 - np.exp(-0.5 * (limit / 0.05) ** 2)
        # 4096 Sobol' points: within 0.003 of two inputs.
        assert error.probabilities(limit)[0] == pytest.approx(within, abs=3e-3)


def test_three_inputs_match_monte_carlo():
    """Probability of an error vector's size, its 95 % width and input shares, by 400 000 draws."""
    ways = np.array([LONG, ACROSS, OBLIQUE])
    error = of_vectors((0.01, 0.0, -0.02), *ways)
    draws = np.random.default_rng(11).normal(size=(400_000, 3))
    sizes = np.linalg.norm((0.01, 0.0, -0.02) + draws @ ways, axis=1)
    for limit in (0.02, 0.06, 0.1):
        # Sobol' points to 0.004, Monte Carlo to 0.0016 (95 %).
        assert error.probabilities(limit)[0] == pytest.approx((sizes <= limit).mean(), abs=6e-3)
    # The radius of what inputs change, and shares of the variance summed over the components.
    changes = np.linalg.norm(draws @ ways, axis=1)
    assert error.half_width(0) == pytest.approx(np.quantile(changes, 0.95), rel=0.02)
    parts = (ways**2).sum(axis=1)
    assert error.shares(0) == pytest.approx(
        {f"input{k}": share for k, share in enumerate(parts / parts.sum())}
    )


@pytest.mark.parametrize("quantity", ["x", "phi_z", "any_force"])
def test_probability_of_exact_model_includes_inputs(quantity):
    """The beam is exact for the drive of the file, and 5 % off if it changes by its uncertainty."""
    toy = toy_subject(1)
    truth = toy.responses.statics(toy.statics.model, reading(""))

    def perturb(softness, perturbed):
        return softness * (1.0 + 0.5 * dict(perturbed.factors)["drive"])

    robot = replace(
        toy,
        models=[Model("beam", statics=lambda softness, _: softness * truth)],
        responses=Responses(1.0, perturb),
        inputs=InputUncertainties({"drive": 0.1}, np.array([[0.7]])),
    )
    entry = verdict_matrix(robot, Requirement(deflection=0.08, modes=1)).entry("beam", quantity)
    assert (entry.error, entry.verdict) == (0.0, "undecided")
    assert entry.probability == pytest.approx(2.0 * ndtr(1.6) - 1.0, abs=1e-6)
    assert entry.uncertainties["inputs"] == pytest.approx(1.96 * 0.05, rel=2e-3)


VEE = """
schema = 2
name = "vee"
[points]
A = [0.0, 0.0, 0.0]
P = [0.5, 0.0, 0.0]
[bodies.arm]
from = "A"
to = "P"
mass = 3.0
compliance = [
    [2.1e-9, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 8.113000e-06, 0.0, 0.0, 0.0, 2.4112e-5],
    [0.0, 0.0, 2.217e-7, 0.0, -6.003e-7, 0.0],
    [0.0, 0.0, 0.0, 1.217e-5, 0.0, 0.0],
    [0.0, 0.0, -6.003e-7, 0.0, 6.317e-6, 0.0],
    [0.0, 2.4112e-5, 0.0, 0.0, 0.0, 9.511e-5],
]
[joints.m1]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 20000.0, simplified = 12128.2685684 }
[tool]
body = "arm"
point = "P"
moves = ["y"]
mass = 2.0
[[input_uncertainty]]
key = "joints.m1.drive.stiffness"
relative = 0.10
[[input_uncertainty]]
key = "bodies.arm.compliance"
relative = 0.15
"""


def test_fitted_drive_depends_on_its_inputs(tmp_path):
    """The rigid model's drive is fitted to include the arm's compliance at the file's values.

    0.5²/k + c = 0.5²/k' with k = 20000 (1 + 0.1 ξ) and c = 8.113e-6 (1 + 0.15 η).
    """
    robot = robot_subject(Context(robot_of(VEE, tmp_path), "quick"))
    # Its deflection alone is judged.
    subject = replace(robot, dynamics=Reference("none"), parts=())
    drive, arm = np.random.default_rng(8).normal(size=(2, 1_000_000))
    due = 0.25 / 20000.0 / (1.0 + 0.1 * drive) + 8.113e-6 * (1.0 + 0.15 * arm)
    errors = np.abs(0.25 / 12128.2685684 / due - 1.0)
    for limit, printed in ((0.16, 0.937), (0.12, 0.842), (0.02, 0.186)):
        within = (errors <= limit).mean()
        assert within == pytest.approx(printed, abs=1e-3)
        matrix = verdict_matrix(subject, Requirement(modes=1, limits={"y": limit}))
        entry = matrix.entry("simplified", "y")
        assert entry.error == pytest.approx(0.0, abs=1e-8)
        # 4096 Sobol' points of two inputs to 0.003, and Monte Carlo to 0.0005.
        assert entry.probability == pytest.approx(within, abs=3e-3)


@pytest.mark.parametrize(
    ("error", "within", "beyond"),
    [
        (linear(0.006, 0.008), ndtr(1.0), ndtr(-1.0)),
        # What the quadratic form misses counts against both verdicts.
        (linear(0.01, misfit=0.005), ndtr(0.5), ndtr(-1.5)),
        # An input that raises the error in one pose and lowers it in the other.
        (linear([0.01, -0.01]), 1.0 - 2.0 * ndtr(-1.0), 2.0 * ndtr(-1.0)),
        # A share of the robots has no such error: in neither verdict.
        (replace(linear(0.002), lost=0.25), 0.75, 0.0),
    ],
)
def test_linear_error_is_normally_distributed(error, within, beyond):
    """Probability within a limit by the normal distribution, for errors linear in the inputs."""
    outcome = probability(error, "adequate", LIMIT, 0)
    assert [outcome.within, outcome.beyond] == pytest.approx([within, beyond], abs=2e-3)


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_input_half_width_of_tied_errors_is_the_first(rounding):
    """Interpretations of equal errors, the second of which changes twice as much with the input."""
    first, second = (signed(np.array([number])) for number in (ERROR, ERROR + rounding))
    change = signed(np.array([0.01]))
    below = np.concatenate([first - change, second - 2.0 * change])
    above = np.concatenate([first + change, second + 2.0 * change])
    slope = Slope("input", 0.02, below, above, np.zeros((2, 1)))
    error = ErrorOfInputs(np.concatenate([first, second]), [slope], signed=True)
    assert error.half_width(0) == pytest.approx(1.96 * 0.01, rel=0.01)


def test_input_shares_equal_variance_shares():
    """Shares are squares of the slopes if the error is linear, otherwise Sobol's indices."""
    outcome = probability(linear(0.006, 0.008), "adequate", LIMIT, 0)
    assert outcome.half_width == pytest.approx(1.96 * 0.01, rel=0.01)
    assert outcome.value_half_width == pytest.approx(1.96 * 0.01, rel=1e-4)
    assert outcome.shares == pytest.approx({"input1": 0.64, "input0": 0.36})
    assert outcome.settled("adequate") == "undecided"
    # Where errors are bent, those of Sobol.
    signed_error, none = signed(np.array([ERROR])), np.zeros((2, 1))
    ends = {"a": (0.010, 0.002), "b": (-0.003, 0.006)}
    bent = [
        Slope(key, 0.1, *(signed_error + signed(np.array([change])) for change in pair), none)
        for key, pair in ends.items()
    ]
    error = ErrorOfInputs(signed_error, bent, signed=True)
    indices = scipy.stats.sobol_indices(
        func=lambda draws: error.intervals(draws.T)[:, :, 0].mean(axis=1),
        n=2**13,
        dists=[scipy.stats.norm()] * 2,
        rng=0,
    )
    shares = error.shares(0)
    assert [shares["a"], shares["b"]] == pytest.approx(indices.first_order, abs=0.02)


def test_proposed_input_uncertainty_gives_95_percent():
    """The standard uncertainty in the remedy, put into the normal distribution, gives 95 %."""
    outcome = probability(linear(0.002, 0.02), "adequate", LIMIT, 0)
    # The second one's own part: what 1.645 standard uncertainties of 1 % leave beside the first.
    allowed_deviation = sqrt(((LIMIT - ERROR) / ndtri(0.95)) ** 2 - 0.002**2)
    proposed_percent = float(re.search(r"of input1 to ([\d.e-]+) %", outcome.decides)[1])
    assert proposed_percent == pytest.approx(2.0 * allowed_deviation / 0.02, rel=0.05)
    # Each alone leaves 1.645 times 1 %, more than there is.
    together = probability(linear(0.01, 0.01), "adequate", LIMIT, 0)
    assert together.decides == (
        "undecided because of uncertain inputs; "
        "reduce the uncertainty of input1 and input0 together"
    )
    # Without an error one below it is there at none, from half a standard uncertainty on not.
    error = linear(0.002)
    lost = replace(error.slopes[0], below=np.full_like(error.nominal, np.nan))
    outcome = probability(replace(error, slopes=[lost]), "adequate", LIMIT, 0)
    assert outcome.within == pytest.approx(ndtr(0.5), abs=2e-3)
    assert outcome.beyond == 0.0
    expected_percent = 2.0 * (0.5 / ndtri(0.95) - 0.01)
    assert outcome.decides.endswith(
        f"reduce the standard uncertainty of input0 to {expected_percent:.2g} % (now 2 %)"
    )


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Robot file of an arm on a drive: uncertainty 10 % in drive stiffness, 5 % in modulus."""
    return robot_of(
        ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "free"')
        + f'[[input_uncertainty]]\nkey = "{DRIVE}"\nrelative = 0.1\n'
        + f'[[input_uncertainty]]\nkey = "{MODULUS}"\nrelative = 0.05\n'
        + "[path]\nposes = [[0.0]]\n",
        tmp_path_factory.mktemp("arm"),
    )


@pytest.fixture(scope="module")
def of_arm(arm):
    return robot_subject(Context(arm, "quick"))


def test_arm_on_uncertain_drive_matches_monte_carlo(of_arm):
    """Error of rigid bodies in the deflection of an arm, by 200 000 draws of its two inputs."""
    # Deflection by the drive L²/k, by the arm L³/3EI + 6L/5GA (ν = 0: G = E/2).
    length, width, height, modulus = 0.5, 0.06, 0.04, 2.1e11
    area, inertia = width * height, height * width**3 / 12.0
    by_arm = length**3 / (3 * modulus * inertia) + 1.2 * length / (0.5 * modulus * area)
    ratio = by_arm / (length**2 / 5.0e4)
    # Rigid bodies miss the arm's part; it grows with k and falls with E.
    drives, moduli = 1.0 + np.random.default_rng(0).normal(size=(200_000, 2)).T * [[0.1], [0.05]]
    errors = ratio * drives / moduli / (1.0 + ratio * drives / moduli)
    limit = float(np.quantile(errors, 0.8))
    matrix = verdict_matrix(of_arm, Requirement(modes=2, limits={"x": limit}))
    entry = matrix.entry("simplified", "x")
    assert entry.error == pytest.approx(ratio / (1.0 + ratio), rel=2e-3)
    # The solid's mesh is left open on both sides, and what the quadratic form misses.
    assert entry.probability == pytest.approx(0.8, abs=0.02)
    assert entry.verdict == "undecided"
    assert f"reduce the standard uncertainty of {DRIVE} to" in entry.reason
    assert entry.input_shares == pytest.approx({DRIVE: 0.8, MODULUS: 0.2}, abs=0.02)
    assert entry.value_spread == pytest.approx(1.96 * 0.1 * entry.value, rel=0.02)
    # What scales model and reference alike leaves the error as it is.
    beam, first = (matrix.entry("beam", quantity) for quantity in ("z", "f1"))
    assert beam.uncertainties["inputs"] < 1e-4
    assert (beam.probability, beam.verdict, first.probability) == (1.0, "adequate", 1.0)


OPEN_INPUTS = "undecided because of uncertain inputs; "


def test_unsolved_input_change_lowers_probability(of_arm):
    """If one input change, or one draw of all inputs, has no solution, the verdict is undecided."""
    first_below, *_ = of_arm.inputs.alone(-1)
    first_draw, *draws = of_arm.inputs.together
    for lost, within, reason in (
        (first_below, ndtr(0.5), f"{OPEN_INPUTS}reduce the standard uncertainty of {DRIVE} to"),
        (first_draw, 1.0 - 1.0 / (1 + len(draws)), ""),
    ):

        def perturb(robot, perturbed, lost=lost):
            if perturbed.factors == lost:
                raise InputError("no such robot")
            return perturbed_robot(robot, perturbed)

        robot = replace(of_arm, responses=Responses(of_arm.responses.robot, perturb))
        entry = verdict_matrix(robot, Requirement(modes=2)).entry("beam", "f1")
        assert entry.probability == pytest.approx(within, abs=2e-3)
        assert (entry.probability_beyond, entry.verdict) == (0.0, "undecided")
        assert entry.reason.startswith(reason)


def test_inputs_option_replaces_missing_table(arm):
    """`--inputs` makes moduli, stiffnesses and lengths uncertain.

    A table in the file overrides it.
    """
    five_bar, ifw = (load_robot(name) for name in ("five-bar", "ifw"))
    assert five_bar.uncertain_inputs == {}
    drives = [f"joints.motor{k}.drive.stiffness" for k in (1, 2)]
    supposed = ["materials.steel.E", "materials.aluminium.E", *drives]
    assert replace(five_bar, supposed=0.05).uncertain_inputs == dict.fromkeys(supposed, 0.05)
    of_legs = [f"leg{k}.{key}" for k in (1, 2) for key in ("length", "compliance")]
    keys = ["actuators.stiffness", "foot.compliance", *of_legs, "tool.compliance"]
    assert list(replace(ifw, supposed=0.1).uncertain_inputs) == keys
    # What the file says goes before.
    assert replace(arm, supposed=0.5).uncertain_inputs == arm.uncertain_inputs
