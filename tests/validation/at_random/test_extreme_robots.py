"""Extreme but sound robots: every command is right about them, or fails and says why."""

import json
from functools import partial
from itertools import combinations

import numpy as np
import pytest
from extreme_robots import extreme_robots
from like_ifw import placed_at, stations
from random_robots import SHAPES, alarms, robots
from written_robot import robot_of

from lumped.errors import ComputationError
from lumped.legs import equivalent_leg
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from lumped.system.solution import modes, solved
from validation import cli
from validation.adequacy.mechanism.statics import compliances
from validation.case import Skip
from validation.cases import ritz
from validation.cases.polynomials import path_roundings
from validation.catalogue import catalogue
from validation.context import Context
from validation.models.legs import leg_matrices
from validation.models.mechanism import bodies_of
from validation.models.options import ModelOptions
from validation.results.outcome import judge
from validation.solve import cost

SEED, COUNT, FEW = 7, 60, 6
ROBOTS = list(extreme_robots(COUNT, SEED))
# The same theory in three formulations. Each may be off by 1e-4, beyond which it would be refused
# for the balance of its energies; that is known to first order, so not to the last of them.
SAME = 3e-4


def described(number, folder):
    """The robot of that number."""
    return robot_of(ROBOTS[number], folder)


@pytest.fixture
def command(tmp_path, capsys):
    """A command on a robot: exit code, results and messages, none of them a fault of our own."""
    path = tmp_path / "robot.toml"

    def called(text, *arguments):
        path.write_text(text, encoding="utf-8")
        asked = [str(path) if argument == "ROBOT" else argument for argument in arguments]
        code = cli.main(asked)
        printed = capsys.readouterr()
        assert code in {0, 1, 2, 3}
        assert "Traceback" not in printed.err
        assert "fault of flexproof" not in printed.err
        if code in {2, 3}:
            # What failed in a run stands in its list.
            assert printed.err or "\nfailed " in f"\n{printed.out}"
        return code, printed.out, printed.err

    return called


def compliance(command, text, *options):
    """The 6×6 or 2×2 of `solve`, physically possible; None where it is refused with a reason."""
    code, out, _ = command(text, "solve", "ROBOT", "--json", *options)
    assert code != 1
    if code:
        return None
    (result,) = json.loads(out)["results"]
    found = np.array(result["compliance"])
    scale = 1.0 / np.sqrt(np.diag(found))
    assert np.linalg.eigvalsh(found * np.outer(scale, scale))[0] > 0.0
    frequencies = [f for f in result["frequencies"] if f is not None]
    assert frequencies == sorted(frequencies)
    assert all(f > 0.0 for f in frequencies)
    return found


@pytest.mark.parametrize(
    "number",
    [*range(FEW), *(pytest.param(n, marks=pytest.mark.exhaustive) for n in range(FEW, COUNT, 2))],
)
def test_lumped_models_agree_or_say_why_not(number, command):
    text = ROBOTS[number]
    code, out, _ = command(text, "check", "ROBOT")
    assert code == 0
    assert ": sound" in out.splitlines()[0]
    compliance(command, text, "--model", "simplified")
    compliance(command, text, "--model", "vjm")
    found = {
        "vjm": compliance(command, text, "--model", "vjm", "--legs", "equivalent"),
        "segments": compliance(command, text, "--model", "segments", "--elements", "4"),
        "beam": compliance(command, text, "--model", "beam", "--elements", "4"),
    }
    answered = [one for one in found.values() if one is not None]
    for one, other in combinations(answered, 2):
        size = np.sqrt(np.outer(np.diag(one), np.diag(one)))
        assert np.abs((one - other) / size).max() < SAME, found


@pytest.fixture
def no_hour(monkeypatch):
    """Solids that would take more than a minute are refused like those that take an hour."""
    monkeypatch.setattr(cost, "_LONGEST", 60.0)


@pytest.mark.soak
@pytest.mark.usefixtures("no_hour")
@pytest.mark.parametrize("number", range(COUNT))
def test_solids_and_quick_runs_are_right_or_say_why_not(number, command, tmp_path):
    compliance(command, ROBOTS[number], "--model", "solid", "--divisions", "2")
    arguments = ("run", "ROBOT", "--preset", "quick", "--out", str(tmp_path / "run"))
    command(ROBOTS[number], *arguments)
    cases = json.loads((tmp_path / "run" / "results.json").read_text(encoding="utf-8"))["cases"]
    assert len(cases) > 25
    for case in cases:
        if case["verdict"] == "failed":
            # A reason of ours, not an exception that nobody expected.
            assert "traceback in log.txt" not in case["message"], case


def planar_exactly(at):
    """Planar compliances (m/N) under loads along x and y: two bars on pins, C by hand.

    K = k₁ n₁n₁ᵀ + k₂ n₂n₂ᵀ has the inverse (m₂m₂ᵀ/k₁ + m₁m₁ᵀ/k₂) / (n₁ × n₂)², mᵢ ⟂ nᵢ: sums of
    positive terms, in which nothing is lost. Legs do not bend under loads at B.
    """
    legs = [equivalent_leg(leg) for leg in legs_of(at.mechanism).values()]
    give = [leg.length / leg.timoshenko.EA for leg in legs]
    roots = (at.frames[name].position[:2] for name in ("leg1", "leg2"))
    n1, n2 = (
        (at.frames["platform"].position[:2] - root) / leg.length
        for root, leg in zip(roots, legs, strict=True)
    )
    m1, m2 = (np.array([-n[1], n[0]]) for n in (n1, n2))
    C = (give[0] * np.outer(m2, m2) + give[1] * np.outer(m1, m1)) / np.dot(n1, m2) ** 2
    return np.hypot(C[0], C[1])


# Soft beside stiff (20), legs that nearly align (7), thin tubes and blades (0, 9, 26) among them.
@pytest.mark.parametrize("number", [0, 7, 9, 20, 26])
@pytest.mark.parametrize("model", ["vjm", "segments", "beam"])
def test_what_rounding_leaves_open_covers_the_error_against_the_closed_form(
    number, model, tmp_path
):
    robot = described(number, tmp_path).mechanism
    options = ModelOptions(legs="equivalent", theory="euler-bernoulli")
    for at in placed_at(robot, *stations(robot, 5)):
        exact = planar_exactly(at)
        try:
            found = compliances((at,), model, options)[0]
        except ComputationError:
            # Refused, since its energies are out of balance.
            continue
        left_open = path_roundings((at,), model, options)[0]
        off = np.abs(np.linalg.norm(found[:2, :2], axis=0) - exact)
        # Beside the roundings of the matrix those of its solution, some in the last place.
        known = np.linalg.norm(left_open[:2, :2], axis=0) + 1e-13 * exact
        assert (off < known).all(), at.pose


# Tubes and blades of 10⁶ Pa in legs that nearly align (2), where three formulations differ by
# 1e-7 to 1e-4, as what the rounding of the stiffnesses alone leaves open foretells; 10¹⁵ between
# both legs (42), 3e-5 of every deflection lost in segments; leg 2 horizontal at the end of the
# stroke (9), which by the nearest float it was not.
@pytest.mark.parametrize(
    ("number", "cases"),
    [
        (2, ("statics[",)),
        (42, ("statics[segments-euler", "statics[vjm,")),
        (9, ("frequencies[simplified", "statics[simplified")),
    ],
)
def test_what_rounding_hides_is_undecided_or_told(number, cases, tmp_path):
    context = Context(described(number, tmp_path), "quick")
    verdicts, refused = [], []
    for case in catalogue(context.robot_file):
        if case.id.removeprefix("mechanism.anchor.").startswith(cases):
            try:
                outcome = judge(case, case.measure(context), 0.0)
            except Skip:
                continue
            except ComputationError as error:
                refused.append(str(error))
                continue
            verdicts.append(outcome.verdict)
            # Finer models have rounding as well: nobody is sent to refine them.
            assert ("no finer model" in outcome.message) is (outcome.verdict == "undecided")
    assert all("more than double precision resolves" in reason for reason in refused)
    assert verdicts or refused
    assert "disagree" not in verdicts
    assert number != 9 or set(verdicts) == {"agree"}


def test_a_free_joint_loses_nothing_of_a_soft_leg_on_a_stiff_one(tmp_path):
    # Leg 1 of 41 bends on a hinge at the tip of a leg 10¹³ times as stiff about z: in sums of both
    # legs' rotations it was 2 % off.
    (at,) = placed_at(described(41, tmp_path).mechanism)
    beams = bodies_of(at.mechanism, ModelOptions(), partial(leg_matrices, "beam"))
    found = modes(solved(assemble(at, beams)), 1).frequencies
    assert found == pytest.approx(ritz.frequencies(at, 1, degree=14), rel=1e-4)


@pytest.mark.parametrize("number", [18, 41, 59])
def test_polynomials_of_robots_keep_their_digits(number, tmp_path):
    # Legs that nearly align, stiffnesses 10¹² to 10¹⁵ apart: frequencies moved by 1e-2 from degree
    # to degree, and once there were none.
    robot = described(number, tmp_path).mechanism
    for at in placed_at(robot, *stations(robot, 3)):
        high, low = (ritz.frequencies(at, 3, degree=degree) for degree in (16, 13))
        assert high == pytest.approx(low, rel=1e-7)


def test_a_negative_shear_stiffness_is_named(tmp_path):
    # Cowper's κ of a wide-flanged I changes its sign at a Poisson's ratio far below zero.
    robot_file = described(27, tmp_path)
    (case,) = (c for c in catalogue(robot_file) if c.id == "leg2.frequency.solid[1]")
    with pytest.raises(ComputationError, match=r"^leg2, i-section: .* κGA = -3.06 N is neg"):
        case.measure(Context(robot_file, "quick"))


LUMPED = ("mechanism.lumped",)
SOLIDS = (
    *(f"leg{n}.{group}" for n in (1, 2) for group in ("solid", "modes")),
    "robot.solid.modes",
)
TYPICAL = ("rectangle", "tube", "i-section")


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(2))
def test_random_robots_raise_no_alarm(chunk):
    for robot in robots(20, chunk):
        assert not alarms(robot, LUMPED), robot


@pytest.mark.soak
def test_two_hundred_robots_raise_no_alarm_at_standard():
    for robot in robots(200, chunk=2):
        assert not alarms(robot, LUMPED, "standard"), robot


@pytest.mark.parametrize(
    ("shape", "count", "chunk"),
    [
        # Solid, with walls all round, and open.
        *(pytest.param(s, 1, 5, marks=pytest.mark.exhaustive) for s in TYPICAL),
        *(pytest.param(s, 6, 7, marks=pytest.mark.soak) for s in SHAPES),
    ],
)
def test_random_robots_raise_no_alarm_with_solid_legs(shape, count, chunk):
    """A quarter of a minute each."""
    for robot in robots(count, chunk, shape):
        assert not alarms(robot, SOLIDS), robot
