"""`flexproof solve`: what is typed is heard or refused."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from one_arm import LOADS, ONE_ARM
from sound_biglide import SOUND

from lumped.legs import ConstantLeg, Material, equivalent_leg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from lumped.system.joint_motion import Portion
from meshes.section.section_mesh import section_mesh
from validation import cli
from validation.models.options import ModelOptions
from validation.solids.bars import with_bars
from validation.solve.answer import (
    Answer,
    LeftOpen,
    MeshUncertainty,
    PartUncertainty,
    Solution,
    as_text,
    record_of,
)
from validation.solve.cost import solid_cost
from validation.solve.model_answers import solve
from validation.solve.question import Question
from validation.solve.uncertainty import beside


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(SOUND, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["vjm", "--leg", "2", "--theory", "timoshenko"], "--theory: the vjm model takes the legs"),
        (["vjm", "--equivalent", "compliance"], "--equivalent: the vjm model takes the legs as"),
        (["vjm", "--leg", "1", "--legs", "equivalent"], "--legs: no leg that is asked about is"),
        (["beam", "--leg", "1", "--equivalent", "compliance"], "no leg that is asked about is"),
        (["segments", "--leg", "2", "--release", "printed"], "--release: a leg alone has no joint"),
        (["beam", "--modes", "1.5"], 'Invalid value "1.5" for --modes. Must be a whole number'),
        (["beam", "--elements", "2.7"], 'Invalid value "2.7" for --elements. Must be a whole'),
        (["beam", "--leg", "1.4"], 'Invalid value "1.4" for --leg. Must be a whole number'),
        (["solid", "--divisions", "1e9"], 'Invalid value "1e9" for --divisions. Must be a whole'),
        (["beam", "--modes", "1000000000"], "--modes = 1000000000: must be from 0 to 1000"),
        (["beam", "--elements", "9" * 5000], "for --elements. Must be a whole number"),
    ],
)
def test_what_would_change_nothing_or_is_no_number_is_refused(robot, arguments, said, capsys):
    assert cli.main(["solve", robot, "--model", *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    (line,) = printed.err.splitlines()
    assert said in line
    assert len(line) < 200


def test_the_answer_names_the_options_that_had_a_say_and_changes_with_them(robot, capsys):
    def heard(*arguments):
        assert cli.main(["solve", robot, *arguments, "--json"]) == 0
        document = json.loads(capsys.readouterr().out)
        return document["options"], document["results"][0]["compliance"]

    vjm = ("--model", "vjm")
    assert heard(*vjm)[0] == {"legs": "given", "theory": "timoshenko"}
    assert heard(*vjm, "--leg", "2")[0] == {"legs": "given"}
    usual, compliance = heard(*vjm, "--legs", "equivalent")
    assert usual == {"legs": "equivalent", "theory": "timoshenko", "equivalent": "stiffness"}
    for name, other in (("theory", "euler-bernoulli"), ("equivalent", "compliance")):
        options, changed = heard(*vjm, "--legs", "equivalent", f"--{name}", other)
        assert options == usual | {name: other}
        assert changed != compliance
    alone = heard("--model", "beam", "--leg", "1", "--elements", "2")[0]
    assert alone == {"theory": "timoshenko", "elements": 2}


def test_a_number_that_rounding_has_eaten_is_no_answer(robot, capsys):
    text = Path(robot).read_text(encoding="utf-8")
    Path(robot).write_text(text.replace("nu = 0.3", "nu = -0.999999999"), encoding="utf-8")
    assert cli.main(["solve", robot, "--model", "solid", "--divisions", "2"]) == 3
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "material with ν = -0.999999999: changes of shape" in printed.err


def test_solids_say_the_uncertainty_of_their_mesh(robot, capsys):
    def answer(divisions):
        arguments = ["--model", "solid", "--leg", "1", "--divisions", divisions, "--modes", "1"]
        assert cli.main(["solve", robot, *arguments, "--json"]) == 0
        return json.loads(capsys.readouterr().out)["results"][0]

    text = SOUND.replace("hollow-rectangle", "rectangle").replace(", thickness = 0.008", "")
    Path(robot).write_text(text, encoding="utf-8")
    coarse, fine = answer("1"), answer("2")
    stated = fine["uncertainty"]
    assert stated["divisions"] == 1
    # Roache's factor for two meshes whose rigid faces hold contraction: order 2λ, λ = 0.71117 where
    # a fixed and a free side meet at 90° with ν = 0.3; 2 elements in the section and 6, twice as
    # many slices.
    factor = 3.0 / ((2.0 * 6.0 / 2.0) ** (2.0 * 0.71117293 / 3.0) - 1.0)
    for i in range(6):
        step = abs(coarse["compliance"][i][i] - fine["compliance"][i][i])
        assert stated["compliance"][i] == pytest.approx(factor * step)
    step = abs(coarse["frequencies"][0] - fine["frequencies"][0])
    assert stated["frequencies"][0] == pytest.approx(factor * step)


def test_solids_of_a_mechanism_say_the_uncertainty_of_their_mesh():
    """The step between both meshes by the lowest order of its legs."""
    robot_file = load_robot("five-bar")
    bars = with_bars(reference_posture(robot_file.mechanism)).mechanism
    solid = replace(robot_file, mechanism=bars)

    def answer(divisions):
        question = Question(solid, "solid", {"divisions": divisions}, 1)
        return solve(question).answers[0]

    coarse, fine = answer(1), answer(2)
    assert fine.uncertainty.divisions == 1
    steps = np.abs(np.diag(coarse.compliance) - np.diag(fine.compliance))
    factors = fine.uncertainty.compliance / steps
    # One factor for all, Roache's: orders 2λ(ν = 0.33) to 4, elements 1.5 to 2 times as large.
    assert factors == pytest.approx(factors[0])
    assert 3.0 / (2.0**4 - 1.0) < factors[0] < 3.0 / (1.5**1.3 - 1.0)
    step = abs(coarse.frequencies[0] - fine.frequencies[0])
    assert fine.uncertainty.frequencies[0] == pytest.approx(factors[0] * step, rel=1e-6)
    # Torsion of the bars, on elements one and two across, is what is known worst.
    assert np.argmax(fine.uncertainty.compliance / np.diag(fine.compliance)) in (2, 3)


def test_numbers_whose_order_meshes_show_are_extrapolated(capsys, tmp_path):
    """Torsion of a square bar with free ends: Saint-Venant's L/GJ, known to every digit."""
    side, length, G = 0.05, 0.15, 2.1e11 / 2.6
    odd = np.arange(1, 40, 2)
    J = side**4 * (1.0 / 3.0 - 64.0 / np.pi**5 * np.sum(np.tanh(0.5 * odd * np.pi) / odd**5))
    path = tmp_path / "arm.toml"
    bar = ONE_ARM.replace("nu = 0.0", "nu = 0.3").replace("P = [0.0, 0.5", f"P = [0.0, {length}")
    bar = re.sub(r"(width|height) = [0-9.]+", rf"\1 = {side}", bar)
    path.write_text(bar, encoding="utf-8")
    arguments = ["solve", str(path), "--model", "solid", "--body", "arm", "--ends", "free"]
    arguments += ["--modes", "0", "--divisions"]

    def torsion(*more):
        assert cli.main([*arguments, *more, "--json"]) == 0
        (found,) = json.loads(capsys.readouterr().out)["results"]
        return found["compliance"][3][3], found["uncertainty"]

    (fine, _), (value, stated) = torsion("5"), torsion("2", "--accuracy", "0.002")
    assert stated["extrapolated_from"] == [1, 2, 4, 5]
    exact = length / (G * J)
    assert abs(value - exact) < 0.2 * abs(fine - exact)
    # As wide as the interval of the finest mesh, whose value it holds as it holds the exact one.
    assert 1.25 * abs(value - fine) <= stated["compliance"][3] <= 0.002 * exact
    assert abs(value - exact) <= stated["compliance"][3]
    assert cli.main([*arguments, "2", "--accuracy", "0.002"]) == 0
    told = "numbers are extrapolated where the meshes of 1, 2, 4, 5 divisions show an order"
    assert told in capsys.readouterr().out


SECTIONS = [
    *(Rectangle(0.1, 0.3), Circle(1.0), Tube(1.0, 0.01), Tube(1.0, 0.1)),
    *(HollowRectangle(0.1, 0.16, 0.008), HollowRectangle(0.1, 0.16, 0.0005)),
    ISection(0.1, 0.1, 0.008, 0.006),
]


@pytest.mark.parametrize("section", SECTIONS, ids=str)
def test_the_mesh_that_says_the_uncertainty_is_another_one(section):
    # A circle has five elements with one to three divisions, a thin tube forty with one to four.
    leg = ConstantLeg(5.0, section, Material.isotropic(2.1e11, 0.3, 7850.0))
    for divisions in (1, 2, 4, 8):
        other = beside(ModelOptions(divisions=divisions), [leg])
        meshes = (section_mesh(section, d) for d in (divisions, other))
        coarse, fine = sorted(len(mesh.cells) for mesh in meshes)
        assert fine >= 1.44 * coarse


def test_a_coarse_round_leg_says_how_wrong_it_is(robot, capsys):
    """ν = −0.9: two divisions bend 20 % too little; to one division, the same mesh, 0.007 %."""
    text = SOUND.replace('"hollow-rectangle", width = 0.10, height = 0.16', '"circle"')
    text = text.replace("thickness = 0.008", "diameter = 0.25").replace("nu = 0.3", "nu = -0.9")
    Path(robot).write_text(text, encoding="utf-8")

    def answer(*arguments):
        assert cli.main(["solve", robot, "--leg", "1", "--modes", "0", "--json", *arguments]) == 0
        return json.loads(capsys.readouterr().out)["results"][0]

    coarse = answer("--model", "solid", "--ends", "free", "--divisions", "2")
    # Free ends of a round leg: Timoshenko's beam is right to a thousandth.
    exact = answer("--model", "beam")["compliance"][1][1]
    error = abs(coarse["compliance"][1][1] - exact)
    assert error > 0.1 * exact
    assert coarse["uncertainty"]["compliance"][1] > error


def test_a_mesh_that_nothing_stands_beside_says_so(robot, capsys, monkeypatch):
    arguments = ["solve", robot, "--model", "solid", "--leg", "1", "--divisions", "2"]
    leg = equivalent_leg(legs_of(load_robot(robot).mechanism)["leg1"])
    only = 1.2 * solid_cost((leg,), 2, 6).memory
    monkeypatch.setattr("validation.solve.cost.available_memory", lambda: only)
    assert cli.main(arguments) == 0
    assert "uncertainty of the mesh: not known; the mesh that would tell" in capsys.readouterr().out
    assert cli.main([*arguments, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["results"][0]["uncertainty"] is None


def test_every_number_of_an_answer_stands_under_its_own_name():
    numbers = iter(np.arange(1.0, 200.0))

    def take(count):
        return np.array([next(numbers) for _ in range(count)])

    bracket = LeftOpen(take(6), take(2))
    parts = PartUncertainty(take(6), take(2), bracket, take(2), {"arm": (7, 811.0)}, "fixed")
    answer = Answer(
        {"pose": [0.1]},
        take(36).reshape(6, 6),
        take(2),
        idle=3,
        uncertainty=MeshUncertainty(take(6), take(2), 5),
        of_parts=parts,
        strain={Portion("rod", "tension"): take(2)},
    )
    record = record_of(answer)
    assert record == {
        "pose": [0.1],
        "compliance": np.arange(19.0, 55.0).reshape(6, 6).tolist(),
        "frequencies": [55.0, 56.0],
        "idle": 3,
        "uncertainty": {
            "divisions": 5,
            "compliance": list(range(57, 63)),
            "frequencies": [63.0, 64.0],
        },
        "parts": {
            "averaged_less_rigid": {"compliance": list(range(1, 7)), "frequencies": [7.0, 8.0]},
            "uncertainty": {"compliance": list(range(9, 15)), "frequencies": [15, 16]},
            "reduction": [17.0, 18.0],
            "modes_counted": {"arm": {"count": 7, "below": 811.0}},
        },
        "strain": {"rod tension": [65.0, 66.0]},
    }
    solution = Solution("robot", "beam", {}, (answer,))
    # 1000 N in µm: compliances of 19, 26 and 33 m/N on the diagonal.
    told = "x 1.9e+10, y 2.6e+10, z 3.3e+10"
    text = as_text(solution)
    assert told in text
    # In percent of 19, 26, 33 … and of 55 and 56.
    for shares in (
        "    x 3e+02 %, y 2.2e+02 %, z 1.8e+02 %",
        "    x +5.3 %, y +7.7 %, z +9.1 %",
        "    x 47 %, y 38 %, z 33 %",
        "    frequencies 1.1e+02 %, 1.1e+02 %",
        "    frequencies +13 %, +14 %",
        "    frequencies 27 %, 29 %",
        "those dropped lower no frequency by more than 3e+01 %",
    ):
        assert shares in text
    assert "<td>1.9e+10</td><td>2.6e+10</td><td>3.3e+10</td>" in solution._repr_html_()


def test_loads_of_the_file_are_answered_by_name_and_one_that_cannot_be_by_none(tmp_path, capsys):
    """Under a wrench C F, whatever the model; at the end of its reach no arm moves on."""
    path = tmp_path / "robot.toml"
    path.write_text(ONE_ARM + LOADS, encoding="utf-8")
    for model in ("vjm", "segments"):
        asked = ["solve", str(path), "--model", model, "--pose", "0.1", "--pose", "0.5"]
        assert cli.main([*asked, "--json"]) == 0
        first, last = json.loads(capsys.readouterr().out)["results"]
        loads = first["loads"]
        assert list(loads) == ["weight", "cutting", "stop"]
        due = np.array(first["compliance"]) @ [100.0, 0.0, -50.0, 0.0, 0.0, 0.0]
        np.testing.assert_allclose(loads["cutting"]["displacement"], due, rtol=1e-9, atol=1e-18)
        assert last["loads"]["stop"] == {"displacement": None}
        assert loads["stop"]["displacement"][0] < 0.0
    assert cli.main(asked) == 0
    assert "stop: none, the mechanism cannot move so here" in capsys.readouterr().out


def test_responses_and_losses_are_told_by_models_with_mass(tmp_path, capsys):
    """Every loss is twice the ratio; what hardly swings is the compliance."""
    path = tmp_path / "robot.toml"
    asked = (
        'responses = [{ name = "hit", direction = [2, 0, 0], from = 0.01, to = 90.0, at = 30.0 }]'
    )
    path.write_text(f"damping.ratio = 0.02\n{asked}\n{ONE_ARM}", encoding="utf-8")
    command = ["solve", str(path), "--model", "beam"]
    assert cli.main([*command, "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["results"]
    np.testing.assert_allclose(found["damped"]["losses"], 0.04, rtol=1e-9)
    np.testing.assert_allclose(found["damped"]["frequencies"], found["frequencies"], rtol=1e-9)
    hit = found["responses"]["hit"]
    assert len(hit["frequencies"]) == len(hit["real"]) == len(hit["imaginary"]) == 400
    assert hit["real"][0] == pytest.approx(found["compliance"][0][0], rel=1e-6)
    assert hit["peak"]["size"] >= np.hypot(hit["real"], hit["imaginary"]).max()
    assert hit["at"]["frequency"] == 30.0
    assert cli.main(command) == 0
    said = capsys.readouterr().out
    assert "loss factors of the modes (%): 4, 4, 4, 4, 4, 4" in said
    assert f"hit: peak {1e6 * hit['peak']['size']:.4g} at" in said
    assert cli.main([*command[:3], "links", "--json"]) == 0
    assert "responses" not in json.loads(capsys.readouterr().out)["results"][0]


def test_what_rounding_leaves_of_nothing_is_shown_as_nothing():
    compliance, moved = np.zeros((6, 6)), np.array([1.8e-52, -1.57e-5, 0.0, 0.0, 0.0, 0.0])
    np.fill_diagonal(compliance, [5e-7, 2e-7, 3e-71])
    answer = Answer({"pose": []}, compliance, np.zeros(0), loads={"weight": moved})
    text = as_text(Solution("gantry", "beam", {}, (answer,)))
    assert "reference posture, at the loaded point" in text
    assert "x 500, y 200, z 0\n" in text
    assert "weight: x 0, y -15.7, z 0, 15.7 in all" in text
