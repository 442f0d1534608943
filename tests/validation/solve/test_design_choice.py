"""Best of several varied robots: objectives and conditions of `solve --vary`."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.pages.messages import only_message
from support.robots.robot_from_text import robot_of

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation import cli
from validation.solve.answer import Answer, Place
from validation.solve.design_choice import (
    DesignChoice,
    choice_text,
    design_choice,
    purpose_of,
    total_mass,
)

# A cantilever of one prism on a rigid joint: every quantity has a closed form.
LENGTH, WIDTH, E, RHO = 0.5, 0.04, 2.1e11, 7850.0
BAR = f"""
schema = 2
name = "bar"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
[bodies.bar]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = {WIDTH}, height = 0.02 }}
material = {{ E = {E}, nu = 0.3, rho = {RHO} }}
[joints.wall]
type = "fixed"
between = ["ground", "bar"]
at = "A"
[tool]
body = "bar"
point = "P"
moves = []
"""
HEIGHTS = np.array([0.02, 0.03, 0.04, 0.05])
VARY = ["--vary", "bodies.bar.section.height=0.02:0.05:4", "--theory", "euler-bernoulli"]


def deflections():
    """Deflection F L³/(3 E I) along z under 1000 N for each height (m)."""
    return 1000.0 * LENGTH**3 / (3.0 * E * WIDTH * HEIGHTS**3 / 12.0)


def solved(tmp_path, capsys, *options):
    path = tmp_path / "bar.toml"
    path.write_text(BAR, encoding="utf-8")
    code = cli.main(["solve", str(path), "--model", "beam", "--modes", "1", *VARY, *options])
    return code, capsys.readouterr()


def test_lightest_stiff_bar_is_chosen(tmp_path, capsys):
    """Heights are 20, 30, 40 and 50 mm; the last two meet the limit of 1 mm."""
    assert (deflections() <= 1e-3).tolist() == [False, False, True, True]
    purpose = "--minimise", "mass", "--where", "deflection.z<=1e-3"
    code, printed = solved(tmp_path, capsys, *purpose, "--json")
    assert code == 0
    choice = json.loads(printed.out)["choice"]
    assert [robot["meets"] for robot in choice["robots"]] == [False, False, True, True]
    masses, compliances = (
        np.array([robot["values"][name] for robot in choice["robots"]])
        for name in ("mass", "deflection.z")
    )
    assert_allclose(masses, RHO * LENGTH * WIDTH * HEIGHTS, rtol=1e-12)
    # Cubic beam elements are exact at their nodes; round-off of a 2×2 inverse is 1e-15.
    assert_allclose(compliances, deflections(), rtol=1e-9)
    assert choice["best"] == choice["robots"][2]
    assert choice["units"] == {"mass": "kg", "deflection.z": "m at 1000 N"}
    code, printed = solved(tmp_path, capsys, *purpose)
    last = printed.out.splitlines()[-2:]
    assert last[0] == "2 of 4 robots meet deflection.z<=1e-3"
    assert last[1].startswith("least mass: bodies.bar.section.height=0.04 (mass 6.28 kg, defl")


def test_impossible_limit_names_nearest_robot(tmp_path, capsys):
    """The stiffest bar deflects by 0.476 mm and exceeds the limit of 0.4 mm by 19 %."""
    code, printed = solved(tmp_path, capsys, "--minimise", "mass", "--where", "deflection.z<4e-4")
    assert code == 1
    miss = 100.0 * (deflections()[-1] / 4e-4 - 1.0)
    assert miss == pytest.approx(19.05, abs=0.01)
    expected = f"nearest: bodies.bar.section.height=0.05 misses deflection.z<4e-4 by {miss:.3g} %"
    assert printed.out.splitlines()[-1].startswith(expected)


def test_best_worst_frequency_is_chosen():
    """Two robots in two poses: the first has the higher mean, the second the higher minimum."""
    bar = load_robot("ifw").mechanism

    def answer(frequency):
        return Answer(Place(pose=()), np.eye(6), np.array([frequency, 100.0]))

    answers = [[answer(50.0), answer(20.0)], [answer(30.0), answer(25.0)]]
    purpose = purpose_of(load_robot("ifw"), None, "f1", ["f2>=99"], 2)
    choice = design_choice(purpose, [bar, bar], answers)
    assert [values.tolist() for values in choice.values.values()] == [[20.0, 25.0], [100.0] * 2]
    assert choice.best == 1
    assert "greatest f1: second (f1 25 Hz, f2 100 Hz)" in choice_text(choice, ["first", "second"])


def test_missing_mode_meets_no_condition():
    """A robot without the mode does not meet a lower limit on its frequency."""
    purpose = purpose_of(load_robot("ifw"), "mass", None, ["f1>=10"], 1)
    mass, frequency = purpose.quantities
    choice = DesignChoice(
        purpose, {mass: np.array([1.0, 2.0]), frequency: np.array([np.nan, 12.0])}
    )
    assert choice.meets.tolist() == [False, True]
    assert choice.best == 1
    none = replace(choice, values={mass: np.ones(1), frequency: np.array([np.nan])})
    assert (none.best, none.nearest) == (None, None)
    assert choice_text(none, ["bar"]) == "0 of 1 robot meet f1>=10"


def test_equally_good_robots_give_the_first():
    """Masses that differ by 1e-13 are equal."""
    purpose = purpose_of(load_robot("ifw"), "mass", None, [], 1)
    (mass,) = purpose.quantities
    choice = DesignChoice(purpose, {mass: np.array([3.0, 2.0, 2.0 * (1.0 + 1e-13)])})
    assert choice.best == 1
    assert choice.nearest is None


def test_mass_counts_bodies_and_tool(tmp_path):
    """The biglide: a platform of 46 kg, legs of 69.705 and 49.366 kg (appendix of the paper)."""
    assert total_mass(load_robot("ifw").mechanism) == pytest.approx(
        46.0 + 69.705 + 49.366, rel=1e-12
    )
    file = robot_of(BAR + "mass = 2.5\n[path]\nposes = [[]]\n", tmp_path)
    assert total_mass(file.mechanism) == pytest.approx(2.5 + RHO * LENGTH * WIDTH * 0.02)


@pytest.mark.parametrize(
    ("minimise", "where", "message"),
    [
        ("mas", (), '--minimise mas: must be one of mass, .*f2; did you mean "mass"'),
        (None, ("f3>=1",), "--where f3>=1: must be one of mass"),
        (None, ("f1=3",), "--where f1=3: must be QUANTITY>=NUMBER or QUANTITY<=NUMBER"),
        (None, ("f1>=nan",), r"--where f1>=nan: nan must be a finite number \(Hz\)"),
    ],
)
def test_invalid_objective_is_refused(minimise, where, message):
    """Unknown or missing quantities of --minimise, --maximise and --where."""
    with pytest.raises(InputError, match=message):
        purpose_of(load_robot("ifw"), minimise, None, where, 2)


def test_objective_needs_a_variation(tmp_path, capsys):
    """--where without --vary, and --maximise beside --minimise."""
    path = tmp_path / "bar.toml"
    path.write_text(BAR, encoding="utf-8")
    command = ["solve", str(path), "--model", "beam", "--where", "f1>=1"]
    assert cli.main(command) == 2
    assert "are only for --vary" in only_message(capsys.readouterr().err)
    with pytest.raises(InputError, match="--maximise: cannot be combined with --minimise"):
        purpose_of(load_robot("ifw"), "mass", "f1", (), 2)
