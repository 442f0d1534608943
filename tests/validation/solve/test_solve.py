"""`flexproof solve`: options, results with half-widths, and refusals."""

import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from support.fakes.toy_runs import ENVIRONMENT, run_on_terminal
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import LOADS, ONE_ARM
from support.robots.valid_biglide import SOUND

from fem.bodies.solid import coupled_leg, solid_leg, solid_mesh
from fem.calculix.leg import with_bars
from fem.solvers.factor import analyse
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import Load
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from lumped.system import solution
from lumped.system.joint_motion import Portion
from meshes.section.section_mesh import section_mesh
from validation import cli
from validation.context import Context
from validation.models import leg_models
from validation.models.options import ModelOptions
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import robot_at
from validation.solve.answer import (
    Answer,
    HalfWidths,
    MeshUncertainty,
    PartUncertainty,
    Place,
    Solution,
)
from validation.solve.answer_json import answer_record, finite_json
from validation.solve.answer_text import as_text
from validation.solve.cost import Cost, require_affordable, solid_cost
from validation.solve.model_answers import solve
from validation.solve.question import Question
from validation.solve.solved_model import SolvedModes
from validation.solve.uncertainty import SolvedQuestion, of_prisms, second_divisions


@pytest.fixture
def robot(tmp_path):
    return robot_of(SOUND, tmp_path).source


@pytest.fixture
def bar(tmp_path):
    """Path of a robot file with rectangular legs, which need few elements."""
    text = SOUND.replace("hollow-rectangle", "rectangle").replace(", thickness = 0.008", "")
    return robot_of(text, tmp_path).source


@pytest.mark.parametrize("model", ["simplified", "segments", "beam"])
def test_one_mode_robot_has_one_frequency(tmp_path, model):
    """The pendulum is one rigid body on a spring: f = √(k/J)/2π, J = 0.11 + 3 · 0.5² kg m²."""
    question = Question(robot_of(PENDULUM, tmp_path), model, {})
    (answer,) = solve(question).answers
    frequency = np.sqrt(4.0e4 / 0.86) / (2.0 * np.pi)
    assert answer.frequencies == pytest.approx([frequency], rel=1e-9)
    with pytest.raises(ComputationError, match="3 modes requested, but fewer modes move mass"):
        solve(replace(question, model="beam", modes=3))


# Options that would change nothing, or are no number; without a name it is the robot above.
REFUSED = [
    (
        "ROBOT vjm --leg 2 --theory timoshenko",
        "--theory: no effect, because model vjm uses the legs",
    ),
    (
        "ROBOT vjm --equivalent compliance",
        "--equivalent: no effect, because model vjm uses the legs as",
    ),
    ("ROBOT vjm --leg 1 --legs equivalent", "--legs: no effect, because no leg of this answer is"),
    (
        "ROBOT segments --leg 2 --release printed",
        "--release: no effect, because a single leg has no joint",
    ),
    ("ROBOT beam --modes 1.5", 'Invalid value "1.5" for --modes. Must be a whole number'),
    ("ROBOT beam --modes 1000000000", "--modes = 1000000000: must be from 0 to 1000"),
    ("ROBOT solid --divisions 999999999999999 --leg 1", "GB of memory are available"),
    ("ROBOT beam --elements 10000000", "GB of memory are available"),
    ("delta beam --x 1", "--x: only for robot files of schema 1; give poses as --pose"),
    ("delta beam --leg 1", "--leg: only for robot files of schema 1; name a body"),
    ("ifw beam --leg 1 --body leg2", "--leg and --body: each names a body; leave out one"),
    ("ifw vjm --body leg1 --ends free-free", "model vjm of a body has no frequencies"),
    ("delta beam --pose 1,2", "--pose 1,2: must be x,y,z as finite"),
    ("delta beam --pose 0.1,0.0,-0.95 --vary tool.mass=1:2:2", "cannot be reached"),
    ("delta beam --body arm", "--body arm: does not exist; must be one of"),
    ("delta beam --body bar1", "--body bar1: is a rigid body; must be one of"),
    ("delta links --modes 3", "--modes: model links is static"),
    ("delta segments --release printed", "--release: has no effect on model segments"),
    ("five-bar beam --modes 0 --against solid", "--against: "),
    ("five-bar beam --csv table.csv", "are only for --vary"),
]


@pytest.mark.parametrize(("typed", "message"), REFUSED, ids=lambda words: words[:40])
def test_options_without_effect_are_refused(robot, typed, message, command):
    """Such as --elements with VJM: one line with option, model and alternative."""
    name, *words = typed.split()
    line = command.error_line("solve", robot if name == "ROBOT" else name, "--model", *words)
    assert message in line
    assert len(line) < 400


def test_answer_lists_effective_options(robot, command):
    """The key `options` in JSON has those on which the model depends, with defaults."""

    def heard(*words):
        document = command.json("solve", robot, *words)
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


def test_round_off_result_is_refused(tmp_path, capsys):
    """Solid with ν near −1: exit code 3 and the reason."""
    robot_of(SOUND.replace("nu = 0.3", "nu = -0.999999999"), tmp_path)
    words = ["solve", str(tmp_path / "robot.toml"), "--model", "solid", "--divisions", "2"]
    assert cli.main(words) == 3
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "material with ν = -0.999999999: changes of shape" in printed.err


def test_solid_leg_has_mesh_uncertainty(bar, command):
    """Change from one to two divisions times 3/(rᵖ − 1), p from a clamped edge."""

    def answer(divisions):
        words = ["--model", "solid", "--leg", 1, "--divisions", divisions, "--modes", 1]
        return command.json("solve", bar, *words)["results"][0]

    coarse, fine = answer(1), answer(2)
    stated = fine["uncertainty"]
    assert stated["divisions"] == 1
    # Roache's factor for two meshes whose rigid faces hold contraction: order 2λ, λ = 0.71117 where
    # a fixed and a free side meet at 90° with ν = 0.3; 2 elements in the section and 6, twice as
    # many slices.
    factor = 3.0 / ((2.0 * 6.0 / 2.0) ** (2.0 * 0.71117293 / 3.0) - 1.0)
    step = np.diag(coarse["compliance"]) - np.diag(fine["compliance"])
    np.testing.assert_allclose(stated["compliance"], factor * np.abs(step), rtol=1e-6)
    step = np.subtract(coarse["frequencies"], fine["frequencies"])
    np.testing.assert_allclose(stated["frequencies"], factor * np.abs(step), rtol=1e-6)


def test_solid_robot_has_mesh_uncertainty():
    """All half-widths are Roache's factor 3/(rᵖ − 1) times the change from the coarse mesh.

    Order p from 2λ of a clamped edge (ν = 0.33) to 4, ratio r of element sizes from 1.5 to 2.
    """
    robot_file = load_robot("five-bar")
    bars = with_bars(reference_posture(robot_file.mechanism)).mechanism
    push = Load("push", bars.tool.body, bars.tool.point, wrench=np.eye(6)[2])
    weight = replace(push, name="weight", wrench=np.zeros(6), gravity=np.array([1.0, 0.0, -9.81]))
    solid = replace(robot_file, mechanism=replace(bars, loads=(push, weight)))
    coarse, fine = (
        solve(Question(solid, "solid", {"divisions": divisions}, 1)).answers[0]
        for divisions in (1, 2)
    )
    assert fine.uncertainty.divisions == 1
    numbers, coarse_numbers = (
        np.concatenate([np.diag(answer.compliance), answer.frequencies, answer.loads["weight"][:3]])
        for answer in (fine, coarse)
    )
    uncertainty = fine.uncertainty
    stated = np.concatenate(
        [uncertainty.compliance, uncertainty.frequencies, uncertainty.loads["weight"][:3]]
    )
    assert uncertainty.loads["push"][2] == pytest.approx(uncertainty.compliance[2], rel=1e-9)
    factors = stated / np.abs(numbers - coarse_numbers)
    np.testing.assert_allclose(factors, factors[0], rtol=1e-6)
    assert 3.0 / (2.0**4 - 1.0) < factors[0] < 3.0 / (1.5**1.3 - 1.0)
    # Of the coarse mesh, beside the finer one, by rᵖ: 3rᵖ/(rᵖ − 1) is 3/(rᵖ − 1) and 3 more.
    assert coarse.uncertainty.divisions == 2
    step = np.abs(np.diag(fine.compliance - coarse.compliance))
    np.testing.assert_allclose(coarse.uncertainty.compliance, (factors[0] + 3.0) * step, rtol=1e-6)


def test_mesh_change_follows_mode_shape(tmp_path):
    """Two modes change their order between the meshes. By shape, they change by 2 and 0.5 Hz."""
    text = ONE_ARM.replace("width = 0.06, height = 0.04", "width = 0.05, height = 0.05")
    arm = robot_of(text.replace("nu = 0.0", "nu = 0.3"), tmp_path)
    question = Question(arm, "solid", {"divisions": 2}, 2)
    robot = robot_at(Context(question.robot_file, "quick"), question.postures())

    def model(frequencies, shapes):
        record = np.array([frequencies]), shapes[None], np.ones(2), np.ones((1, 2))
        return Model("solid", modes=lambda *_: SolvedModes(*record, count=2))

    coarse, fine = model([101.5, 102.0], np.eye(2)[:, ::-1]), model([100.0, 101.0], np.eye(2))
    solved = SolvedQuestion(question, Responses(robot), {1: coarse, 2: fine})
    (half_widths,) = of_prisms(solved)
    factor = half_widths.frequencies[0] / 2.0
    assert half_widths.frequencies == pytest.approx([2.0 * factor, 0.5 * factor], rel=1e-9)
    # Roache's factor for r = 2 and an order from 1.42 (ν = 0.3, rigid ends) to 4.
    assert 3.0 / (2.0**4 - 1.0) < factor < 3.0 / (2.0**1.4 - 1.0)


def test_half_of_mode_pair_has_half_width(tmp_path):
    """The first mode of a square bar is one of a pair: on each mesh another direction of bending.

    If each mesh had one mode, round-off would decide whether the shapes agree.
    """
    square = "width = 0.05, height = 0.05"
    robot_file = robot_of(ONE_ARM.replace("width = 0.06, height = 0.04", square), tmp_path)
    single_mode, both_modes = (
        solve(Question(robot_file, "solid", {"divisions": 2}, count, body="arm")).answers[0]
        for count in (1, 2)
    )
    assert len(single_mode.frequencies) == 1
    assert single_mode.frequencies[0] == pytest.approx(both_modes.frequencies[1], rel=1e-6)
    assert single_mode.uncertainty.frequencies == pytest.approx(
        both_modes.uncertainty.frequencies[:1], rel=1e-3
    )


def test_statics_and_modes_share_system(monkeypatch):
    """A robot of beams in one pose is factorised once, for its compliance and its frequencies."""
    factorised, systems = solution.factorised, []
    monkeypatch.setattr(
        solution, "factorised", lambda matrix: systems.append(matrix) or factorised(matrix)
    )
    (answer,) = solve(Question(load_robot("five-bar"), "beam", {"elements": 4}, 2)).answers
    assert np.diag(answer.compliance).all()
    assert len(answer.frequencies) == 2
    assert len(systems) == 1


def test_statics_and_modes_share_solid(monkeypatch):
    """Condensation and reduction of a leg compute its solid once."""
    leg = ConstantLeg(0.2137, Rectangle(0.03, 0.02), Material.isotropic(2.1e11, 0.3, 7850.0))
    held_solid, calls = leg_models.held_solid, []
    monkeypatch.setattr(
        leg_models,
        "held_solid",
        lambda *arguments: calls.append(arguments) or held_solid(*arguments),
    )
    options = ModelOptions(divisions=1)
    leg_models.condensed_leg("solid", leg, replace(options, parts="condensed"))
    leg_models.reduced_leg("solid", leg, options, 1000.0, 2500.0)
    assert len(calls) == 1


def test_values_with_order_are_extrapolated(command, tmp_path):
    """Torsion of a square bar with free ends: Saint-Venant's exact L/GJ."""
    side, length, G = 0.05, 0.15, 2.1e11 / 2.6
    odd = np.arange(1, 40, 2)
    J = side**4 * (1.0 / 3.0 - 64.0 / np.pi**5 * np.sum(np.tanh(0.5 * odd * np.pi) / odd**5))
    bar = ONE_ARM.replace("nu = 0.0", "nu = 0.3").replace("P = [0.0, 0.5", f"P = [0.0, {length}")
    path = robot_of(re.sub(r"(width|height) = [0-9.]+", rf"\1 = {side}", bar), tmp_path).source
    words = ["solve", path, "--model", "solid", "--body", "arm", "--ends", "free"]
    words += ["--modes", "0", "--divisions"]

    def torsion(*options):
        (answer,) = command.json(*words, *options)["results"]
        return answer["compliance"][3][3], answer["uncertainty"]

    (fine, _), (value, stated) = torsion("5"), torsion("2", "--accuracy", "0.002")
    assert stated["extrapolated_from"] == [1, 2, 4, 5]
    exact = length / (G * J)
    assert abs(value - exact) < 0.2 * abs(fine - exact)
    # As wide as the interval of the finest mesh, whose value it holds as it holds the exact one.
    assert 1.25 * abs(value - fine) <= stated["compliance"][3] <= 0.002 * exact
    assert abs(value - exact) <= stated["compliance"][3]
    note = "values are extrapolated if the meshes with 1, 2, 4, 5 divisions show an order"
    assert note in command.output(*words, "2", "--accuracy", "0.002")


SECTIONS = [
    *(Rectangle(0.1, 0.3), Circle(1.0), Tube(1.0, 0.01), Tube(1.0, 0.1)),
    *(HollowRectangle(0.1, 0.16, 0.008), HollowRectangle(0.1, 0.16, 0.0005)),
    ISection(0.1, 0.1, 0.008, 0.006),
]


@pytest.mark.parametrize("section", SECTIONS, ids=str)
def test_uncertainty_uses_another_mesh(section):
    """The second mesh has at least 1.44 times as many, or as few, cells across the section."""
    # A circle has five elements with one to three divisions, a thin tube forty with one to four.
    leg = ConstantLeg(5.0, section, Material.isotropic(2.1e11, 0.3, 7850.0))
    for divisions in (1, 2, 4, 8):
        other = second_divisions(ModelOptions(divisions=divisions), [leg])
        meshes = (section_mesh(section, d) for d in (divisions, other))
        coarse, fine = sorted(len(mesh.cells) for mesh in meshes)
        assert fine >= 1.44 * coarse


def test_single_mesh_has_no_half_width(bar, command, monkeypatch):
    """Memory suffices for one mesh only: null in JSON, with a note in the text."""
    words = ["solve", bar, "--model", "solid", "--leg", "1", "--divisions", "1", "--modes", "0"]
    leg = equivalent_leg(legs_of(load_robot(bar).mechanism)["leg1"])
    only = 1.2 * solid_cost((leg,), 1, 0).memory
    monkeypatch.setattr("validation.solve.cost.available_memory", lambda: only)
    note = "uncertainty due to the mesh: unknown, because the second mesh"
    assert note in command.output(*words)
    assert command.json(*words)["results"][0]["uncertainty"] is None


def test_json_numbers_have_unique_names():
    """A result whose numbers are all different: each has its name in JSON."""
    numbers = iter(np.arange(1.0, 200.0))

    def take(count):
        return np.array([next(numbers) for _ in range(count)])

    bracket = HalfWidths(take(6), take(2))
    parts = PartUncertainty(take(6), take(2), bracket, take(2), {"arm": (7, 811.0)}, "fixed")
    answer = Answer(
        Place(pose=(0.1,)),
        take(36).reshape(6, 6),
        take(2),
        idle=3,
        uncertainty=MeshUncertainty(take(6), take(2), 5),
        of_parts=parts,
        strain={Portion("rod", "tension"): take(2)},
    )
    record = json.loads(finite_json(answer_record(answer)))
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
    text = as_text(solution)
    # 1000 N in µm: compliances of 19, 26 and 33 m/N on the diagonal, shares of these.
    for line in (
        "    x 1.9e+10, y 2.6e+10, z 3.3e+10",
        "     1.9000e+01  2.0000e+01  2.1000e+01  2.2000e+01  2.3000e+01  2.4000e+01",
        "natural frequencies (Hz): 55, 56",
        "idle mobilities (motions that do not move the tool): 3",
        "    x 3e+02 %, y 2.2e+02 %, z 1.8e+02 %",
        "    x +5.3 %, y +7.7 %, z +9.1 %",
        "    x 47 %, y 38 %, z 33 %",
        "    frequencies 1.1e+02 %, 1.1e+02 %",
        "    frequencies +13 %, +14 %",
        "    frequencies 27 %, 29 %",
        "omitted modes change no frequency by more than 3e+01 %",
    ):
        assert line in text
    assert "<td>1.9e+10</td><td>2.6e+10</td><td>3.3e+10</td>" in solution._repr_html_()


def test_load_displacements_are_named(tmp_path, command):
    """Displacements by name of the load: C F under a wrench F. A stretched arm has none (null)."""
    path = robot_of(ONE_ARM + LOADS, tmp_path).source
    for model in ("vjm", "segments"):
        words = ["solve", path, "--model", model, "--pose", "0.1", "--pose", "0.5"]
        first, last = command.json(*words)["results"]
        loads = first["loads"]
        assert list(loads) == ["weight", "cutting", "stop"]
        due = np.array(first["compliance"]) @ [100.0, 0.0, -50.0, 0.0, 0.0, 0.0]
        np.testing.assert_allclose(loads["cutting"]["displacement"], due, rtol=1e-9, atol=1e-18)
        assert last["loads"]["stop"] == {"displacement": None}
        assert loads["stop"]["displacement"][0] < 0.0
        buckling = loads["weight"]["buckling"]
        assert buckling["factor"] == pytest.approx(-buckling["reversed"], rel=1e-6)
        assert buckling["body"] == "arm" == next(iter(buckling["shares"]))
        assert np.abs(loads["weight"]["stiffness_lost"]).max() < 1e-6
        assert "frequencies" not in loads["weight"]
    assert "weight: buckles at" in command.output(*words)
    assert "stop: none: the robot cannot accelerate as required" in command.output(*words)


RIGID_DRIVE = """
schema = 2
name = "arm on a rigid drive"
points = { A = [0.0, 0.0, 0.0], P = [0.0, 0.5, 0.0] }
bodies.arm = { from = "A", to = "P", section = SECTION, material = STEEL }
joints.motor = { type = "revolute", between = ["ground", "arm"], at = "A", DRIVE }
tool = { body = "arm", point = "P", moves = ["x"] }
[[loads]]
name = "cutting"
wrench = [100.0, 0.0, -50.0, 0.0, 0.0, 0.0]
"""
RIGID_DRIVE = (
    RIGID_DRIVE.replace("SECTION", '{ shape = "rectangle", width = 0.06, height = 0.04 }')
    .replace("STEEL", "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }")
    .replace("DRIVE", 'axis = [0.0, 0.0, 1.0], drive = { stiffness = "rigid" }')
)


@pytest.mark.parametrize("driven", [True, False], ids=["rigid-drive", "no-drive"])
def test_simplified_with_rigid_drives_is_rigid(tmp_path, command, driven):
    """No displacement, no buckling factor, and the assumption in the text."""
    text = RIGID_DRIVE
    if not driven:
        text = re.sub("joints.motor = .*", "joints.root = ROOT", text).replace('["x"]', "[]")
        root = '{ type = "fixed", between = ["ground", "arm"], at = "A" }'
        text = text.replace("ROOT", root)
    words = ["solve", robot_of(text, tmp_path).source, "--model", "simplified"]
    (answer,) = command.json(*words, "--modes", "0")["results"]
    load = answer["loads"]["cutting"]
    assert load["displacement"] == [0.0] * 6
    assert load["buckling"]["factor"] is load["buckling"]["reversed"] is None
    output = command.output(*words, "--modes", "0")
    assert "stability under the loads of the robot file, rigid legs between their ends" in output
    assert "cutting: does not buckle; no loss of stiffness" in output
    assert "legs bending as beams" in command.output(*words[:3], "beam", "--modes", "0")


def test_displacement_is_in_micrometres(tmp_path, command):
    """3 N on 1 N/µm: 3 µm in the text, 3e-6 m in JSON."""
    text = """
schema = 2
name = "oscillator"
points = { A = [0.0, 0.0, 0.0] }
bodies = { mass = { points = ["A"], mass = 1.0, centre = "A" } }
tool = { body = "mass", point = "A", moves = ["x"] }
joints.s = { type = "prismatic", between = ["ground", "mass"], at = "A", AXIS }
loads = [{ name = "push", wrench = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0] }]
""".replace("AXIS", "axis = [1.0, 0.0, 0.0], drive = { stiffness = 1.0e6 }")
    words = ["solve", robot_of(text, tmp_path).source, "--model", "simplified"]
    (answer,) = command.json(*words)["results"]
    displacement = answer["loads"]["push"]["displacement"]
    assert displacement == pytest.approx([3e-6, 0, 0, 0, 0, 0], rel=1e-12, abs=1e-18)
    assert "push: x 3, y 0, z 0, magnitude 3, φx 0, φy 0, φz 0" in command.output(*words)


def test_models_with_mass_have_responses(tmp_path, command):
    """Every loss factor is twice the damping ratio.

    At low frequency the response is the static compliance.
    """
    response_table = '{ name = "hit", direction = [2, 0, 0], from = 0.01, to = 90.0, at = 30.0 }'
    text = f"damping.ratio = 0.02\nresponses = [{response_table}]\n{ONE_ARM}"
    path = robot_of(text, tmp_path).source
    words = ["solve", path, "--model"]
    (answer,) = command.json(*words, "beam")["results"]
    np.testing.assert_allclose(answer["damped"]["losses"], 0.04, rtol=1e-9)
    np.testing.assert_allclose(answer["damped"]["frequencies"], answer["frequencies"], rtol=1e-9)
    hit = answer["responses"]["hit"]
    assert len(hit["frequencies"]) == len(hit["real"]) == len(hit["imaginary"]) == 400
    assert hit["real"][0] == pytest.approx(answer["compliance"][0][0], rel=1e-6)
    assert hit["peak"]["size"] >= np.hypot(hit["real"], hit["imaginary"]).max()
    assert hit["at"]["frequency"] == 30.0
    output = command.output(*words, "beam")
    assert "loss factors of the modes (%): 4, 4, 4, 4, 4, 4" in output
    assert f"hit: peak {1e6 * hit['peak']['size']:.4g} at" in output
    assert "responses" not in command.json(*words, "links")["results"][0]


def test_round_off_is_printed_as_zero():
    """1.8e-52 beside −15.7 µm."""
    compliance, displacement = np.zeros((6, 6)), np.array([1.8e-52, -1.57e-5, 0.0, 0.0, 0.0, 0.0])
    np.fill_diagonal(compliance, [5e-7, 2e-7, 3e-71])
    answer = Answer(Place(pose=()), compliance, np.zeros(0), loads={"weight": displacement})
    text = as_text(Solution("gantry", "beam", {}, (answer,)))
    assert "reference posture, at the loaded point" in text
    assert "x 500, y 200, z 0\n" in text
    assert "weight: x 0, y -15.7, z 0, magnitude 15.7" in text


@pytest.mark.parametrize(
    "section",
    [
        *(Rectangle(0.1, 0.14), Tube(0.12, 0.01), Circle(0.1), ISection(0.1, 0.14, 0.02, 0.02)),
    ],
    ids=lambda section: section.shape,
)
def test_cost_estimate_is_near_true_cost(section):
    """Estimated unknowns are within a factor of 1.7, estimated memory within 4."""
    leg = ConstantLeg(0.3, section, Material.isotropic(2.1e11, 0.3, 7850.0))
    solid = solid_leg(leg, solid_mesh(leg, 4))
    unknowns = solid.stiffness.shape[0]
    coupled = coupled_leg(solid)
    factor = analyse(coupled.stiffness)
    cost = solid_cost((leg,), 4, modes=0)
    # Nodes that blocks share count twice: in a circle's small blocks half of them.
    assert unknowns <= cost.unknowns < 1.7 * unknowns
    assert factor.peak_bytes < cost.memory
    # Assembly, which the factor's own count leaves out, comes to as much in a leg as small as this.
    assert cost.memory < 4.0 * factor.peak_bytes


def test_answer_above_one_hour_is_refused():
    """3599 s are allowed, 3601 s are not."""
    require_affordable(Cost(9.0, 1.0, 3599.0), "--elements 9")
    with pytest.raises(InputError, match="and 1 h, more than the allowed 60 minutes"):
        require_affordable(Cost(9.0, 1.0, 3601.0), "--elements 9")


def test_ctrl_c_ends_long_solve(robot):
    """Exit code 3 and the word "interrupted", while a solid is factorised."""
    program = "import sys; from validation.cli import main; sys.exit(main())"
    words = [sys.executable, "-c", program, "solve", robot, "--model", "solid", "--divisions", "6"]
    # What is computed, and what it will take, is shown while one waits.
    code, screen = run_on_terminal(words, ENVIRONMENT, pressed=lambda screen: "unknowns" in screen)
    assert code == 3
    assert "interrupted" in screen
    assert "Traceback" not in screen


def test_non_finite_json_number_is_refused():
    """Infinity and NaN have no form in JSON."""
    for document in ({"frequencies": [1.0, float("inf")]}, {"compliance": float("nan")}):
        with pytest.raises(ComputationError, match="a result is not a finite number"):
            finite_json(document)
    assert finite_json({"f": [1.5]}) == '{"f": [1.5]}'
