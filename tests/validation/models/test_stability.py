"""Mechanisms under their loads: invariance under rotations, and published buckling loads."""

import re
import tomllib
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import described
from support.robots.single_arm import ONE_ARM

from lumped.acceptance.requirement import Requirement
from lumped.errors import ComputationError
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.load import AppliedWrench, InterfaceLoads, Load, Loading
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.screws import shift
from lumped.system.assembly import assemble
from lumped.system.loads import loading
from lumped.system.solution import solved
from lumped.system.stability import geometric_stiffness, stability
from validation.models.loads.stability import prestressed_assembly, stabilities, stability_notes
from validation.models.loads.statics import interface_loads
from validation.models.options import ModelOptions
from validation.models.robot_models import answers

EULER = ModelOptions(theory="euler-bernoulli")
HELD = """
schema = 2
name = "held twice"
points = { A = [-0.5, 0.0, 0.0], O = [0.0, 0.0, 0.0], B = [0.5, 0.0, 0.0] }
bodies.bar = { points = ["A", "O", "B"], mass = 1.0, centre = [0.0, 0.0, 0.0] }
joints.first = { between = ["ground", "bar"], at = "A", FIRST }
joints.second = { type = "fixed", between = ["ground", "bar"], at = "B" }
tool = { body = "bar", point = "O", moves = [] }
"""
PORTAL = """
schema = 2
name = "portal"
points = { A = [0, 0, 0], B = [0, 1.0, 0], C = [1.0, 1.0, 0], D = [1.0, 0, 0] }
bodies.left = { from = "A", to = "B", section = SECTION, material = STEEL }
bodies.beam = { from = "B", to = "C", section = SECTION, material = STEEL }
bodies.right = { from = "D", to = "C", section = SECTION, material = STEEL }
joints.a = { type = "BASE", between = ["ground", "left"], at = "A" AXIS }
joints.d = { type = "BASE", between = ["ground", "right"], at = "D" AXIS }
joints.b = { type = "fixed", between = ["left", "beam"], at = "B" }
joints.c = { type = "fixed", between = ["beam", "right"], at = "C" }
tool = { body = "beam", point = "B", moves = [] }
"""
SECTION = '{ shape = "rectangle", width = 0.01, height = 0.05 }'
PORTAL = PORTAL.replace("SECTION", SECTION).replace("STEEL", "{ E = 2e11, nu = 0.3, rho = 7850.0 }")


def on_pedestal(name):
    """Built-in robot `name` on a pedestal with an elastic joint to the ground at the origin."""
    tables = deepcopy(load_robot(name).tables)
    joints = tables["joints"].values()
    feet = [joint["at"] for joint in joints if "ground" in joint["between"]]
    for joint in joints:
        joint["between"] = ["pedestal" if body == "ground" else body for body in joint["between"]]
    tables["points"]["O"] = [0.0, 0.0, 0.0]
    tables["bodies"]["pedestal"] = {"points": ["O", *feet]}
    base = {"type": "fixed", "between": ["ground", "pedestal"], "at": "O"}
    tables["joints"]["base"] = base | {"compliance": (1e-6 * np.eye(6)).tolist()}
    return described_by(tables, Path())[0]


def turning(force):
    """Matrix (3×3): change of a force of constant direction in axes rotated by small angles."""
    return np.cross(np.eye(3), force).T


@pytest.mark.parametrize("name", ["3-rrr", "orthoglide", "hexapod"])
def test_rotation_has_load_stiffness_only(name):
    """Loads keep their direction if the robot rotates rigidly by θ, with or without bent legs.

    The only terms are θ × F of a force and ½ θ × M of a moment, at the tool and at the pedestal.
    """
    robot = on_pedestal(name)
    robot_posture, tool = posture(robot, robot.poses[len(robot.poses) // 3]), robot.tool
    wrench, gravity = np.array([3.0, -2.0, 5.0, 0.4, 0.5, -0.6]), np.array([1.0, 2.0, -9.81])
    prepared, legs = prestressed_assembly("links", [robot_posture], ModelOptions())
    system = prepared.at(robot_posture)
    solution, motions, outer = solved(system), system.motions, system.outer
    rigid = np.vstack([shift(position)[:, 3:] for position in motions.places])
    turned = np.zeros((system.size, 3))
    turned[:outer] = np.linalg.lstsq(motions.twists.reshape(-1, outer), rigid)[0]
    assert np.abs(motions.twists.reshape(-1, outer) @ turned[:outer] - rigid).max() < 1e-9

    load = loading(robot_posture, Load("forces", tool.body, tool.point, wrench), InterfaceLoads())
    (force,) = load.point_wrenches
    rows = motions.at(force.body, force.point, force.position)
    base = motions.at("pedestal", "O", np.zeros(3))
    due = np.zeros((system.size, 3))
    for where, load_wrench in ((rows, wrench), (base, -shift(force.position).T @ wrench)):
        due[:outer] += where[:3].T @ turning(load_wrench[:3]) + 0.5 * where[3:].T @ turning(
            load_wrench[3:]
        )
    # Whether legs bend within or turn as wholes.
    for bent in (legs, {}):
        stiffness = geometric_stiffness(solution, load, bent)
        np.testing.assert_allclose(
            stiffness @ turned, due, rtol=0, atol=1e-7 * np.abs(stiffness).max()
        )

    # Weight acts along the legs: by the bodies' centres, where all of it turns.
    weight = Load("weight", tool.body, tool.point, gravity=gravity)
    load = loading(robot_posture, weight, interface_loads(replace(robot, loads=(weight,))))
    stiffness = turned.T @ geometric_stiffness(solution, load, legs) @ turned
    masses = [(tool.mass, load.point_wrenches[-1].position)]
    for name_of, body in robot.bodies.items():
        shape, frame = body.shape, robot_posture.frames[name_of]
        centre = shape.centre if isinstance(shape, Rigid) else np.array([shape.length / 2, 0, 0])
        masses.append((shape.mass, frame.position + frame.rotation @ centre))
    due = sum(mass * shift(position)[:3, 3:].T @ turning(gravity) for mass, position in masses)
    moment = sum(mass * np.cross(position, gravity) for mass, position in masses)
    due -= 0.5 * turning(moment)
    np.testing.assert_allclose(stiffness, due, rtol=0, atol=1e-7 * np.abs(due).max())


def held_twice(first, wrench, *compliances):
    """Joints, twists and geometric stiffness of a rigid bar under a wrench (6) on its middle."""
    robot = described(HELD.replace("FIRST", first))
    gives = zip(robot.joints, compliances, strict=True)
    joints = tuple(replace(joint, compliance=give) for joint, give in gives)
    solution = solved(assemble(reference_posture(replace(robot, joints=joints)), {}))
    load = Loading([AppliedWrench("bar", "O", np.zeros(3), np.array(wrench))])
    return joints, solution.system.motions.twists[0], geometric_stiffness(solution, load, {})


def test_axial_force_splits_by_end_stiffness():
    """Of a force P in the middle of a bar, ¼ pulls on one half and ¾ push on the other.

    The joint at one end is three times as stiff. The energy of a rotation θ of the bar of length L
    is −½ (¾ − ¼) P L/2 θ².
    """
    give = 1e-6 * np.eye(6)
    _, twists, stiffness = held_twice('type = "fixed"', [8.0, 0, 0, 0, 0, 0], give, give / 3.0)
    due = twists.T @ np.diag([0, 0, 0, 0, -2.0, -2.0]) @ twists
    np.testing.assert_allclose(stiffness, due, rtol=0, atol=1e-9 * np.abs(due).max())


def test_cardan_moment_couples_angles():
    """Work M·θ(α, β) of a moment M, with the angles α and β of the joint about its axes a₁ and a₂.

    The rotation vector θ has the mixed second derivative ½ a₁ × a₂.
    """
    first = 'type = "universal", axes = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]]'
    give, moment = np.diag([1e3, 1e3, 1e3, 1e-4, 1e-4, 1e-4]), [0, 0, 0, 0, 0, 7.0]
    (hook, _), twists, stiffness = held_twice(first, moment, None, give)
    angles = np.linalg.pinv(hook.axes.T) @ twists[3:]
    due = -0.5 * 7.0 * 0.8 * angles.T @ np.array([[0, 1], [1, 0]]) @ angles
    np.testing.assert_allclose(stiffness, due, rtol=0, atol=1e-9 * np.abs(due).max())


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_inverted_pendulum_buckles_at_k_over_mgh(model):
    """Factor k/Σ m g h; half the load has twice the factor. A hanging one does not buckle.

    The frequencies under load are compared, too.
    """
    up = Load("up", "bob", "P", gravity=np.array([0.0, 9.81, 0.0]))
    down, twice = replace(up, gravity=-up.gravity), replace(up, gravity=2.0 * up.gravity)
    heavier = described(PENDULUM.replace("moves", "mass = 1.0, moves"))
    pendulum_posture = reference_posture(replace(heavier, loads=(up, down, twice)))
    ((above, below, double),) = stabilities(model, [pendulum_posture], count=1)
    due = 4.0e4 / (9.81 * (3.0 * 0.5 + 1.0 * 0.8))
    assert above.factor == pytest.approx(due, rel=1e-9)
    assert (above.reversed, below.factor) == (None, None)
    assert below.reversed == pytest.approx(-due, rel=1e-9)
    assert double.factor == pytest.approx(due / 2.0, rel=1e-9)
    assert above.shares == pytest.approx({"pivot": 1.0})
    assert above.stiffness_losses == pytest.approx([1.0 / due, 0, 0, 0, 0, 1.0 / due], abs=1e-9)
    if model != "links":
        free = answers(model, [pendulum_posture], 1)
        due = free.frequencies[0, 0] * np.sqrt(1.0 - 1.0 / due)
        assert above.frequencies[0] == pytest.approx(due, rel=1e-9)


@pytest.mark.parametrize(
    ("base", "axis", "due"),
    [("revolute", ", axis = [0, 0, 1]", 1.8213), ("fixed", "", 7.3787)],
    ids=["hinged", "fixed"],
)
def test_portal_frame_buckling_is_published(base, axis, due):
    """kh tan kh = 6 and −kh cot kh = 6 (Timoshenko and Gere, 1961, §2.4), P = (kh)² EI/h² each."""
    frame = described(PORTAL.replace("BASE", base).replace(" AXIS", axis))
    frame_posture = reference_posture(frame)
    prepared, legs = prestressed_assembly("links", [frame_posture], EULER)
    push = np.array([0, -1.0, 0, 0, 0, 0])
    tops = [
        AppliedWrench("beam", p, np.array([x, 1.0, 0]), push) for p, x in (("B", 0.0), ("C", 1.0))
    ]
    solution = solved(prepared.at(frame_posture))
    frame_stiffness = geometric_stiffness(solution, Loading(tops), legs)
    frame_stability = stability(solution, frame_stiffness, Loading(tops))
    bending = 2e11 * 0.05 * 0.01**3 / 12.0
    assert frame_stability.factor == pytest.approx(due * bending, rel=1e-3)
    # Loads add up.
    stiffness_by_load = [geometric_stiffness(solution, Loading([top]), legs) for top in tops]
    np.testing.assert_allclose(
        sum(stiffness_by_load), frame_stiffness, rtol=0, atol=1e-9 * np.abs(frame_stiffness).max()
    )


ROD = """
schema = 2
name = "rod on two ball joints"
points = { A = [0.0, 0.0, 0.0], B = [0.0, 0.0, 1.0] }
bodies.rod = { from = "A", to = "B", up = [1.0, 0.0, 0.0], section = SECTION, material = STEEL }
bodies.head = { points = ["B"] }
joints.f = { type = "spherical", between = ["ground", "rod"], at = "A" }
joints.b = { type = "spherical", between = ["rod", "head"], at = "B" }
joints.s = { type = "prismatic", between = ["ground", "head"], at = "B", SLIDE }
tool = { body = "head", point = "B", moves = [] }
"""
ROD = (
    ROD.replace("SECTION", '{ shape = "circle", diameter = 0.01 }')
    .replace("STEEL", "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }")
    .replace("SLIDE", "axis = [0.0, 0.0, 1.0], drive = { stiffness = 1.0 }")
)


def turned_robot(tables, rotation):
    """Robot of the tables, all rotated by `rotation`, with the reference posture as only pose."""
    tables = deepcopy(tables)

    def turn(vector):
        return (rotation @ vector).tolist()

    tables["points"] = {name: turn(point) for name, point in tables["points"].items()}
    for body in tables["bodies"].values():
        if "from" in body:
            body["up"] = turn(body.get("up", [0.0, 0.0, 1.0]))
        if isinstance(body.get("centre"), list):
            body["centre"] = turn(body["centre"])
        if "inertia" in body:
            body["inertia"] = (rotation @ body["inertia"] @ rotation.T).tolist()
    for joint in tables["joints"].values():
        if "axis" in joint:
            joint["axis"] = turn(joint["axis"])
    tables.pop("path", None)
    tables["tool"]["moves"] = []
    return described_by(tables, Path())[0]


def buckled(tables, rotation, force, gravity, model="beam"):
    """Stability of the robot of the tables if robot, force and gravity are rotated alike."""
    robot = turned_robot(tables, rotation)
    tool = robot.tool
    wrench = np.concatenate([rotation @ force, np.zeros(3)])
    load = Load("load", tool.body, tool.point, wrench, rotation @ gravity)
    ((result,),) = stabilities(model, [reference_posture(replace(robot, loads=(load,)))], count=3)
    return result


@pytest.mark.parametrize("across", [0.0, 2.0, 20.0])
def test_idle_rod_keeps_euler_load(across):
    """The rod buckles at π²EI/L² (Engesser: 1e-4 lower) for each orientation of the base axes."""
    tables = tomllib.loads(ROD)
    euler = np.pi**3 * 2.1e11 * 0.01**4 / 64.0
    push, gravity = np.array([0, 0, -10.0]), np.array([across, 0, 0])
    factors = []
    for rotation in (np.eye(3), *Rotation.random(4, random_state=43).as_matrix()):
        result = buckled(tables, rotation, push, gravity)
        assert result.factor == pytest.approx(euler / 10.0, rel=3e-4)
        factors.append([result.factor, *result.frequencies])
    np.testing.assert_allclose(factors, factors[0] * np.ones((5, 1)), rtol=1e-6)


@pytest.mark.parametrize("kind", ["rods", "elastic balls", "rigid rod"])
def test_buckling_is_frame_invariant(kind):
    """The built-in Delta with six freely spinning rods, under a wrench and gravity across them."""
    tables = deepcopy(load_robot("delta").tables)
    if kind == "elastic balls":
        for name in ("elbow1l", "elbow2r"):
            tables["joints"][name]["compliance"] = (1e-6 * np.eye(6)).tolist()
    if kind == "rigid rod":
        ends = [tables["bodies"]["rod1l"][end] for end in ("from", "to")]
        middle = np.array([tables["points"][end] for end in ends]).mean(axis=0)
        tables["bodies"]["rod1l"] = {"points": ends, "mass": 2.0, "centre": middle.tolist()}
    force, gravity = np.array([30.0, -20.0, -200.0]), np.array([20.0, 10.0, -60.0])
    factors = []
    for rotation in (np.eye(3), *Rotation.random(2, random_state=8).as_matrix()):
        result = buckled(tables, rotation, force, gravity, "links")
        factors.append([result.factor, -result.reversed, result.extra_displacement])
    # Round-off of factors is 1e-9; before, they differed by up to 9 %.
    np.testing.assert_allclose(factors, factors[0] * np.ones((3, 1)), rtol=1e-5)


def test_idle_rod_torque_is_frame_invariant():
    """The inertia of the spinning rod balances the torque. Its ball joints transmit no moment."""
    tables, factors = load_robot("delta").tables, []
    axis = np.subtract(tables["points"]["C1l"], tables["points"]["E1l"]) / 0.56
    for rotation in (np.eye(3), *Rotation.random(2, random_state=8).as_matrix()):
        robot = turned_robot(deepcopy(tables), rotation)
        wrench = np.concatenate([rotation @ [0, 0, -50.0], 5.0 * rotation @ axis])
        load = Load("load", "rod1l", "E1l", wrench)
        ((result,),) = stabilities("links", [reference_posture(replace(robot, loads=(load,)))])
        factors.append([result.factor, -result.reversed, result.extra_displacement])
    # Round-off is 1e-9; without the inertia they differed by 4e-5, and the factor by 17 %.
    np.testing.assert_allclose(factors, factors[0] * np.ones((3, 1)), rtol=1e-7)


def rods_under_acceleration(acceleration, tables, leg):
    """Buckling factor of the built-in Delta's rods with fixed end positions (Ritz, Engesser).

    The tool starts downwards. In the plane of an arm the elbow then moves along its circle as fast
    as a rigid rod lets it; a rod carries its share of platform and tool and its own inertia.
    """
    hip, elbow, wrist = (np.array(tables["points"][name])[[0, 2]] for name in ("A1", "E1l", "C1l"))
    down, arm, length = (wrist - elbow) / leg.length, elbow - hip, leg.length
    circle = np.array([arm[1], -arm[0]]) / np.linalg.norm(arm)
    low = np.array([0.0, -acceleration])
    per_length = leg.mass / length
    last = -per_length * low
    first = -per_length * (low @ down) / (circle @ down) * circle
    side = np.array([-down[1], down[0]])
    push = acceleration * (tables["bodies"]["platform"]["mass"] + tables["tool"]["mass"]) / 6.0
    # No moment about the elbow.
    across = -length * (first @ side / 6.0 + last @ side / 3.0)
    tip = np.array([(across - push * side[1]) / side[0], push])
    points, weights = np.polynomial.legendre.leggauss(40)
    x, weights = 0.5 * length * (1.0 + points), 0.5 * length * weights
    beyond = np.outer(length - x, first) + np.outer(length**2 - x**2, last - first) / (2.0 * length)
    pressed = -(tip + beyond) @ down
    waves = np.arange(0, 12) * np.pi / length
    turning, bending = np.cos(np.outer(x, waves)), -waves * np.sin(np.outer(x, waves))
    slopes = turning[:, 1:]
    sheared = np.hstack([slopes, -turning])
    p, rows = leg.timoshenko, np.zeros((len(x), slopes.shape[1]))
    bent, slopes = np.hstack([rows, bending]), np.hstack([slopes, 0.0 * turning])
    stiffness = sum(
        factor.T @ (weights[:, None] * constant * factor)
        for factor, constant in ((sheared, p.GAy), (bent, p.EIy))
    )
    geometric = slopes.T @ ((weights * pressed)[:, None] * slopes)
    return float(1.0 / eigh(geometric, stiffness, eigvals_only=True)[-1])


def test_accelerated_delta_buckles_as_its_rods():
    """Factor 230.6 at 100 m/s² with rigid drives, 229.6 with elastic drives.

    Elastic drives let the ends of the compressed rods move sideways: 0.4 %.
    """
    tables = deepcopy(load_robot("delta").tables)
    robot, factors = load_robot("delta").mechanism, []
    due = rods_under_acceleration(100.0, tables, legs_of(robot)["rod1l"])
    tables["materials"]["stiff"] = tables["materials"]["aluminium"] | {"E": 2e12}
    for number in "123":
        tables["joints"][f"motor{number}"]["drive"]["stiffness"] = 1e9
        tables["bodies"][f"arm{number}"]["material"] = "stiff"
    for mechanism in (robot, described_by(tables, Path())[0]):
        load = Load("starts", "platform", "P", acceleration=np.array([0, 0, -100.0]))
        ((result,),) = stabilities("beam", [reference_posture(replace(mechanism, loads=(load,)))])
        factors.append(result.factor)
    # Ten elements leave 2e-5, arms of 2000 GPa as much.
    assert factors[1] == pytest.approx(due, rel=2e-4)
    assert factors[0] / factors[1] == pytest.approx(0.9958, abs=5e-4)


@pytest.mark.parametrize("up", [[0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [1, 0, 0]])
def test_column_buckles_by_own_weight(up):
    """Q L²/EI = 7.837 (Greenhill). A hanging column does not buckle."""
    section = '{ shape = "circle", diameter = 0.01 }'
    text = ONE_ARM.replace("P = [0.0, 0.5, 0.0]", f"P = {[0.5 * component for component in up]}")
    text = re.sub("section = .*", f"section = {section}", text).replace("mass = 1.0", "mass = 0.0")
    text = text.replace('from = "A"', f'from = "A"\nup = {[up[1], up[2], up[0]]}')
    text = text.replace('type = "revolute"', 'type = "fixed"').replace('["x"]', "[]")
    text = re.sub("(axis|drive) = .*", "", text)
    arm = described(text)
    weight = 7850.0 * np.pi * 0.01**2 / 4.0 * 0.5 * 9.81
    loads = tuple(
        Load(name, "arm", "P", gravity=sign * 9.81 * np.array(up, dtype=float))
        for name, sign in (("stands", -1.0), ("hangs", 1.0))
    )
    ((standing, hanging),) = stabilities("beam", [reference_posture(replace(arm, loads=loads))])
    due = 7.837347 * 2.1e11 * np.pi * 0.01**4 / 64.0 / 0.5**2 / weight
    assert standing.factor == pytest.approx(due, rel=1e-3)
    assert hanging.factor is None


def test_models_with_equal_statics_buckle_alike():
    """Paper's robot under weight: VJM and links exactly, segments and beams to 1e-3."""
    robot = load_robot("ifw").mechanism
    weight = Load("weight", robot.tool.body, robot.tool.point, gravity=np.array([0, 0, -9.81]))
    stop = replace(weight, gravity=np.zeros(3), acceleration=np.array([1.0, 0, 0]))
    robot_posture = posture(replace(robot, loads=(weight, stop)), robot.poses[0])
    stability_by_model = {
        m: stabilities(m, [robot_posture])[0] for m in ("vjm", "links", "beam", "segments")
    }
    assert all(stopped is None for _, stopped in stability_by_model.values())
    factors = {m: first.factor for m, (first, _) in stability_by_model.items()}
    assert factors["vjm"] == factors["links"]
    assert factors["segments"] == pytest.approx(factors["beam"], rel=1e-3)


WIDE = '{ shape = "i-section", width = 0.06, height = 0.02, flange = 0.004, web = 0.004 }'


def test_solid_buckles_without_shear_formula():
    """κ of this section is negative at such a Poisson's ratio. The solid does not need it."""
    arm = ONE_ARM.replace("nu = 0.0", "nu = -0.9").replace("P = [0.0, 0.5", "P = [0.0, 0.3")
    press = '[[loads]]\nname = "press"\nwrench = [0.0, -1.0, 0.0, 0.0, 0.0, 0.0]\n'
    post = described(f"{re.sub(r'section = .*', f'section = {WIDE}', arm)}{press}")
    with pytest.raises(ComputationError, match="κ"):
        answers("beam", [reference_posture(post)], 0)
    ((result,),) = stabilities("solid", [reference_posture(post)], ModelOptions(divisions=1))
    assert result.factor > 0.0


BRACKET = """
schema = 2
name = "bracket"
points = { A = [0.0, 0.0, 0.0], K = [0.0, 0.0, 0.8], P = [0.3, 0.0, 0.8] }
tool = { body = "bracket", point = "P", moves = [] }
joints.clamp = { type = "fixed", between = ["ground", "bracket"], at = "A" }
materials.steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
[bodies.bracket]
from = "A"
to = "P"
up = [0.0, 1.0, 0.0]
through = ["K"]
section = { shape = "rectangle", width = 0.02, height = 0.06 }
material = "steel"
[[loads]]
name = "press"
wrench = [0.0, 0.0, -2000.0, 0.0, 0.0, 0.0]
"""


@pytest.mark.parametrize("model", ["links", "beam"])
def test_bracket_buckles_as_its_column(model):
    """The load along the column on the end of the arm buckles it at π²EI/4H².

    The note states that the bracket bends before.
    """
    postures = [reference_posture(described(BRACKET))]
    rows = stabilities(model, postures, EULER)
    euler = np.pi**2 * 2.1e11 * 0.06 * 0.02**3 / 12.0 / (4.0 * 0.8**2)
    assert rows[0][0].factor == pytest.approx(euler / 2000.0, rel=1e-3)
    (note,) = stability_notes(postures, rows, Requirement())
    assert note.endswith("deflection of bent legs before buckling is neglected: bracket")
