"""Mechanisms under their loads: what turns as a whole feels nothing, and published buckling."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.load import Applied, Load, Loading
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.screws import shift
from lumped.system.loads import loading
from lumped.system.prestress import geometric_stiffness
from lumped.system.solution import solved
from lumped.system.stability import stability
from validation.models.loads.displacements import masses_of
from validation.models.loads.stability import prestressed_assembly, stabilities
from validation.models.mechanism import answers
from validation.models.options import ModelOptions

EULER = ModelOptions(theory="euler-bernoulli")
PENDULUM = """
schema = 2
name = "pendulum"
points = { A = [0.0, 0.0, 0.0], P = [0.0, 0.8, 0.0] }
bodies.bob = { points = ["A", "P"], mass = 3.0, centre = [0.0, 0.5, 0.0] }
joints.pivot.type = "revolute"
joints.pivot.between = ["ground", "bob"]
joints.pivot.at = "A"
joints.pivot.axis = [0.0, 0.0, 1.0]
joints.pivot.drive = { stiffness = 4.0e3 }
tool = { body = "bob", point = "P", moves = ["x"], mass = 1.0 }
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
THIN = '{ shape = "i-section", width = 0.069, height = 0.01, flange = 0.001, web = 0.001 }'
PORTAL = PORTAL.replace("SECTION", SECTION).replace("STEEL", "{ E = 2e11, nu = 0.3, rho = 7850.0 }")


def described(text: str) -> Mechanism:
    return described_by(tomllib.loads(text), Path())[0]


def on_pedestal(at: Posture) -> Posture:
    """The same robot on a body that something elastic holds to the ground at its origin."""
    old = at.mechanism
    points = {**old.bodies[GROUND].interfaces, "O": Frame()}
    bodies = {**old.bodies, GROUND: Body(GROUND, Rigid(), {"O": Frame()})}
    bodies["pedestal"] = Body("pedestal", Rigid(), points)

    def moved(side: Side) -> Side:
        return Side("pedestal", side.point) if side.body == GROUND else side

    joints = [replace(j, first=moved(j.first), second=moved(j.second)) for j in old.joints]
    sides = Side(GROUND, "O"), Side("pedestal", "O")
    joints.append(Joint("base", "fixed", *sides, np.zeros((0, 3)), None, 1e-6 * np.eye(6)))
    mechanism = replace(
        old,
        bodies=bodies,
        joints=tuple(joints),
        reference={**old.reference, "pedestal": Frame()},
    )
    frames = {**at.frames, "pedestal": Frame()}
    coordinates = {**at.coordinates, "base": np.zeros(0)}
    return replace(at, mechanism=mechanism, frames=frames, coordinates=coordinates)


@pytest.mark.parametrize("name", ["five-bar", "3-rrr", "delta", "orthoglide", "hexapod"])
def test_a_robot_that_turns_as_a_whole_feels_its_loads_and_its_ground_alone(name):
    """They keep their directions while all else turns: θ × F, and half of θ × M by either side."""
    robot = load_robot(name).mechanism
    at = on_pedestal(posture(robot, robot.poses[len(robot.poses) // 3]))
    tool = robot.tool
    forces = Load("forces", tool.body, tool.point, np.array([3.0, -2.0, 5.0, 0.4, 0.5, -0.6]))
    weight = Load("weight", tool.body, tool.point, gravity=np.array([1.0, 2.0, -9.81]))
    prepared, legs = prestressed_assembly("links", [at], ModelOptions())
    system = prepared.at(at)
    solution = solved(system)
    motions, outer = system.motions, system.outer
    rigid = np.vstack([shift(place)[:, 3:] for place in motions.places])
    turned = np.linalg.lstsq(motions.twists.reshape(-1, outer), rigid)[0]
    assert np.abs(motions.twists.reshape(-1, outer) @ turned - rigid).max() < 1e-9
    turned = np.vstack([turned, np.zeros((system.size - outer, 3))])
    base = motions.at("pedestal", "O", np.zeros(3))

    def half_of(moment: np.ndarray) -> np.ndarray:
        return 0.5 * np.cross(np.eye(3), moment).T

    load = loading(at, forces, {})
    (force,) = load.at_points
    rows = motions.at(force.body, force.point, force.position)
    reaction = -shift(force.position).T @ force.wrench
    due = np.zeros((system.size, 3))
    for at_rows, wrench in ((rows, force.wrench), (base, reaction)):
        due[:outer] += at_rows[:3].T @ np.cross(np.eye(3), wrench[:3]).T
        due[:outer] += at_rows[3:].T @ half_of(wrench[3:])
    found = geometric_stiffness(solution, load, legs)
    sizes = np.abs(found).max()
    np.testing.assert_allclose(found @ turned, due, rtol=0, atol=1e-7 * sizes)

    # Weight acts along the legs: by the bodies' centres, where all of it turns.
    load = loading(at, weight, masses_of(replace(at.mechanism, loads=(weight,))))
    found = turned.T @ geometric_stiffness(solution, load, legs) @ turned
    due, moment = np.zeros((3, 3)), np.zeros(3)
    masses = [(tool.mass, load.at_points[-1].position)]
    for name_of, body in at.mechanism.bodies.items():
        shape, frame = body.shape, at.frames[name_of]
        centre = shape.centre if isinstance(shape, Rigid) else np.array([shape.length / 2, 0, 0])
        masses.append((shape.mass, frame.position + frame.rotation @ centre))
    for mass, place in masses:
        due += mass * shift(place)[:3, 3:].T @ np.cross(np.eye(3), weight.gravity).T
        moment += mass * np.cross(place, weight.gravity)
    due += half_of(-moment)
    np.testing.assert_allclose(found, due, rtol=0, atol=1e-7 * np.abs(due).max())


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_a_mass_above_its_drive_falls_where_its_weight_is_stiffer(model):
    """k/Σ m g h, nothing the other way; half the load at twice the factor; frequencies under it."""
    up = Load("up", "bob", "P", gravity=np.array([0.0, -9.81, 0.0]))
    down, twice = replace(up, gravity=-up.gravity), replace(up, gravity=2.0 * up.gravity)
    robot = replace(described(PENDULUM), loads=(up, down, twice))
    at = reference_posture(robot)
    ((above, below, double),) = stabilities(model, [at], count=1)
    due = 4.0e3 / (9.81 * (3.0 * 0.5 + 1.0 * 0.8))
    assert above.factor == pytest.approx(due, rel=1e-9)
    assert (above.reversed, below.factor) == (None, None)
    assert below.reversed == pytest.approx(-due, rel=1e-9)
    assert double.factor == pytest.approx(due / 2.0, rel=1e-9)
    assert above.shares == pytest.approx({"pivot": 1.0})
    assert above.lost == pytest.approx([1.0 / due, 0, 0, 0, 0, 1.0 / due], abs=1e-9)
    (free,) = answers(model, [at], 1) if model != "links" else [None]
    if free:
        due = free.frequencies[0] * np.sqrt(1.0 - 1.0 / due)
        assert above.frequencies[0] == pytest.approx(due, rel=1e-9)


@pytest.mark.parametrize(
    ("base", "axis", "due"),
    [("revolute", ", axis = [0, 0, 1]", 1.8213), ("fixed", "", 7.3787)],
    ids=["hinged", "fixed"],
)
def test_a_portal_sways_at_its_published_load(base, axis, due):
    """kh tan kh = 6 and −kh cot kh = 6 (Timoshenko and Gere, 1961, §2.4), P = (kh)² EI/h² each."""
    frame = described(PORTAL.replace("BASE", base).replace(" AXIS", axis))
    at = reference_posture(frame)
    prepared, legs = prestressed_assembly("links", [at], EULER)
    push = np.array([0, -1.0, 0, 0, 0, 0])
    tops = [Applied("beam", p, np.array([x, 1.0, 0]), push) for p, x in (("B", 0.0), ("C", 1.0))]
    solution = solved(prepared.at(at))
    whole = geometric_stiffness(solution, Loading(tops), legs)
    found = stability(solution, whole, Loading(tops))
    bending = 2e11 * 0.05 * 0.01**3 / 12.0
    assert found.factor == pytest.approx(due * bending, rel=1e-3)
    # Loads add up.
    both = [geometric_stiffness(solution, Loading([one]), legs) for one in tops]
    np.testing.assert_allclose(sum(both), whole, rtol=0, atol=1e-9 * np.abs(whole).max())


def test_models_differ_by_their_statics_alone():
    robot = load_robot("ifw").mechanism
    weight = Load("weight", robot.tool.body, robot.tool.point, gravity=np.array([0, 0, -9.81]))
    stop = replace(weight, gravity=np.zeros(3), acceleration=np.array([1.0, 0, 0]))
    at = posture(replace(robot, loads=(weight, stop)), robot.poses[0])
    found = {m: stabilities(m, [at])[0] for m in ("vjm", "links", "beam", "segments")}
    assert all(stopped is None for _, stopped in found.values())
    factors = {m: one.factor for m, (one, _) in found.items()}
    assert factors["vjm"] == factors["links"]
    assert factors["segments"] == pytest.approx(factors["beam"], rel=1e-3)


def test_solids_buckle_where_no_formula_of_shear_holds():
    """κ of this section is negative at such a Poisson's ratio; its solid is none the worse."""
    text = """
        schema = 2
        name = "post"
        points = { A = [0, 0, 0], P = [0, 0, 1.0] }
        bodies.post.from = "A"
        bodies.post.to = "P"
        bodies.post.section = SECTION
        bodies.post.material = { E = 2e11, nu = -0.9, rho = 7850.0 }
        joints.base = { type = "fixed", between = ["ground", "post"], at = "A" }
        tool = { body = "post", point = "P", moves = [] }
        loads = [{ name = "press", wrench = [0, 0, -1.0, 0, 0, 0] }]
    """
    post = described(text.replace("SECTION", THIN))
    ((press,),) = stabilities("solid", [reference_posture(post)], ModelOptions(divisions=1))
    assert press.factor > 0.0
