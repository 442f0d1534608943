"""The designer's own loads by every model: closed forms first, then other ways to the same."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lumped.errors import ComputationError
from lumped.mechanism.kinematics.accelerations import accelerations
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.system.assembly import assemble
from lumped.system.solution import solved
from validation.models.loads.displacements import displacements
from validation.models.mechanism import static_bodies
from validation.models.options import ModelName, ModelOptions

E, RHO, LENGTH, WIDTH, HEIGHT = 2.1e11, 7850.0, 0.5, 0.06, 0.04
AREA, IX, IZ = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0, HEIGHT * WIDTH**3 / 12.0
# ν = 0: G = E/2, κ = 5/6.
SHEAR = 5.0 / 6.0 * E / 2.0 * AREA
G = 9.81
ARM = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], M = [0.0, 0.2, 0.0], P = [0.0, 0.5, 0.0] }
bodies.inner = { from = "A", to = "M", section = SECTION, material = STEEL }
bodies.outer = { from = "M", to = "P", section = SECTION, material = STEEL }
joints.weld = { type = "fixed", between = ["inner", "outer"], at = "M" }
joints.motor.type = "revolute"
joints.motor.between = ["ground", "inner"]
joints.motor.at = "A"
joints.motor.axis = [0.0, 0.0, 1.0]
joints.motor.drive = { stiffness = "rigid" }
tool = { body = "outer", point = "P", moves = ["x"] }
"""
SECTION = f'{{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}'
ARM = ARM.replace("SECTION", SECTION).replace("STEEL", f"{{ E = {E}, nu = 0.0, rho = {RHO} }}")
WEIGHT = Load("weight", "outer", "P", gravity=np.array([0.0, 0.0, -G]))
SLIDES = """
schema = 2
name = "slides"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0] }
bodies.coarse = { points = ["A", "B"], mass = 7.0, centre = "A" }
bodies.fine = { points = ["B"], mass = 2.0, centre = [0.4, 0.1, 0.2] }
joints.a.type = "prismatic"
joints.a.between = ["ground", "coarse"]
joints.a.at = "A"
joints.a.axis = [1.0, 0.0, 0.0]
joints.a.drive = { stiffness = 2.0e6 }
joints.b = { type = "fixed", between = ["coarse", "fine"], at = "B", compliance = GIVE }
tool = { body = "fine", point = "B", moves = ["x"], mass = 1.0 }
"""
SLIDES = SLIDES.replace("GIVE", str((1e-7 * np.eye(6)).tolist()))
PENDULUM = """
schema = 2
name = "pendulum"
points = { A = [0.0, 0.0, 0.0], P = [0.0, -0.8, 0.0] }
tool = { body = "bob", point = "P", moves = ["x"] }
[bodies.bob]
points = ["A", "P"]
mass = 3.0
centre = [0.0, -0.5, 0.0]
inertia = [[0.1, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.11]]
[joints.pivot]
type = "revolute"
between = ["ground", "bob"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 4.0e4 }
"""


def described(text: str) -> Mechanism:
    return described_by(tomllib.loads(text), Path())[0]


def under(
    mechanism: Mechanism, *loads: Load, model: ModelName = "beam", pose=(), **options
) -> np.ndarray:
    """Displacements (l×6) of the loaded point; in the reference posture unless posed."""
    robot = replace(mechanism, loads=loads)
    at = posture(robot, np.array(pose) if len(pose) else robot.reference_pose)
    return displacements(model, [at], ModelOptions(**options))[0]


def on(mechanism: Mechanism, **what) -> Load:
    """A load at the loaded point."""
    tool = mechanism.tool
    given = {key: np.array(value, dtype=float) for key, value in what.items()}
    return Load("load", tool.body, tool.point, **given)


@pytest.mark.parametrize(
    ("model", "close"),
    [("vjm", 1e-9), ("links", 1e-9), ("beam", 1e-9), ("segments", 2e-3), ("solid", 1e-3)],
)
def test_a_cantilever_under_its_weight_swung_and_spun(model, close):
    """qL⁴/8EI + qL²/2κGA; −αs per mass: Σ f s²(3L − s)/6EI + f s/κGA and ρI α; ρω²L³/3E."""
    arm = described(ARM)
    swung, spun = on(arm, acceleration=[5.0, 0, 0]), on(arm, speed=[2.0, 0, 0])
    weight, swing, spin = under(arm, WEIGHT, swung, spun, model=model, divisions=2)
    q = RHO * AREA * G
    bent = q * LENGTH**4 / (8.0 * E * IX) + q * LENGTH**2 / (2.0 * SHEAR)
    assert weight[2] == pytest.approx(-bent, rel=close)
    assert weight[3] == pytest.approx(-q * LENGTH**3 / (6.0 * E * IX), rel=close)
    p = RHO * AREA * 5.0 / LENGTH
    bent = p * (11.0 * LENGTH**5 / 20.0) / (6.0 * E * IZ) + p * LENGTH**3 / (3.0 * SHEAR)
    bent += RHO * IZ * (5.0 / LENGTH) * LENGTH**3 / 3.0 / (E * IZ)
    assert swing[0] == pytest.approx(-bent, rel=close)
    pulled = RHO * (2.0 / LENGTH) ** 2 * LENGTH**3 / (3.0 * E)
    assert spin[1] == pytest.approx(pulled, rel=close)
    assert np.abs(spin[[0, 2]]).max() <= 1e-6 * pulled


@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam"])
def test_a_force_within_moves_the_tip_as_one_there_moves_it(model):
    """Maxwell and Betti: P a²(3L − a)/6EI + P a/κGA, which a force at the tip does at a."""
    force = Load("within", "inner", "M", wrench=np.array([0.0, 0.0, 3.0, 0.0, 0.0, 0.0]))
    a = 0.2
    bent = 3.0 * a**2 * (3.0 * LENGTH - a) / (6.0 * E * IX) + 3.0 * a / SHEAR
    both = replace(force, gravity=WEIGHT.gravity)
    within, weight, together = under(described(ARM), force, WEIGHT, both, model=model)
    assert within[2] == pytest.approx(bent, rel=1e-9)
    np.testing.assert_allclose(together, within + weight, rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize("model", ["vjm", "links", "beam"])
def test_two_masses_in_series_and_bodies_that_translate(model):
    """(7 + 2 + 1) kg on k and 2 + 1 on a give; an acceleration is gravity the other way."""
    slides = described(SLIDES)
    pulled, weighed = on(slides, acceleration=[4.0, 0, 0]), on(slides, gravity=[-4.0, 0, 0])
    first, second = under(slides, pulled, weighed, model=model)
    assert first[0] == pytest.approx(-10.0 * 4.0 / 2.0e6 - 3.0 * 4.0 * 1e-7, rel=1e-9)
    np.testing.assert_allclose(first, second, rtol=1e-9)


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_a_pendulum_turns_its_drive_by_its_inertia_about_the_pivot(model):
    """(J + mc²) α = 0.86 α on the drive, its weight m g c where it hangs aside, nothing by spin."""
    bob = described(PENDULUM)
    swung, spun = on(bob, acceleration=[2.0, 0, 0]), on(bob, speed=[3.0, 0, 0])
    aside = on(bob, gravity=[G, 0, 0])
    swing, spin, hang = under(bob, swung, spun, aside, model=model)
    assert swing[5] == pytest.approx(-0.86 * (2.0 / 0.8) / 4.0e4, rel=1e-9)
    assert hang[5] == pytest.approx(3.0 * G * 0.5 / 4.0e4, rel=1e-9)
    assert np.abs(spin).max() <= 1e-12


@pytest.mark.parametrize("name", ["five-bar", "delta", "ifw"])
def test_bodies_accelerate_as_their_positions_do(name):
    """Second differences of postures along x = ẋt + ẍt²/2."""
    robot = load_robot(name).mechanism
    pose, step = robot.poses[len(robot.poses) // 2], 1e-3
    speed, pull = np.array([0.7, 0.0, 0.0]), np.array([3.0, 0.0, 0.0])
    along = np.array([move == "x" for move in robot.tool.moves], dtype=float)
    times = step * np.array([-1.0, 0.0, 1.0])
    ones = [posture(robot, pose + along * (0.7 * t + 1.5 * t**2)) for t in times]
    found = accelerations(ones[1], speed, pull)
    for body in robot.bodies:
        before, now, after = (one.frames[body].position for one in ones)
        linear = (after - 2.0 * now + before) / step**2
        np.testing.assert_allclose(found[body].linear, linear, rtol=2e-5, atol=2e-5)
        # Rods on ball joints may spin.
        before, axis, after = (one.frames[body].rotation[:, 0] for one in ones)
        swung, due = np.cross(found[body].turning, axis), (after - before) / (2.0 * step)
        np.testing.assert_allclose(swung, due, rtol=1e-4, atol=1e-4)


def test_what_the_mechanism_cannot_do_is_no_load():
    robot = load_robot("ifw").mechanism
    end, pull = posture(robot, robot.poses[0]), np.array([1.0, 0.0, 0.0])
    with pytest.raises(ComputationError, match="cannot move that way"):
        accelerations(end, np.zeros(3), pull)
    loads = on(robot, gravity=pull), on(robot, acceleration=pull)
    weight, stopped = under(robot, *loads, pose=end.pose)
    assert np.isfinite(weight).all()
    assert np.isnan(stopped).all()


def test_a_wrench_over_the_path_is_that_of_its_pose_and_none_beside_it():
    arm = described(ARM + "path = { poses = [[0.1], [-0.2]] }")
    rows = np.array([[3.0, 0, 5.0, 0, 0, 0], [0, 2.0, 0, 0, 0.4, 0]])
    over = Load("cutting", "inner", "M", over_path=rows)
    plain = [Load("now", "inner", "M", wrench=row) for row in rows]
    for number, pose in enumerate(arm.poses):
        (found,), due = under(arm, over, pose=pose), under(arm, *plain, pose=pose)
        np.testing.assert_array_equal(found, due[number])
    assert np.isnan(under(arm, over, pose=[0.15])).all()


@pytest.mark.parametrize("model", ["vjm", "beam"])
def test_loads_add_up_and_what_spins_pulls_with_the_square_of_its_speed(model):
    robot = load_robot("five-bar").mechanism
    kinds = (LOADS[0], LOADS[2], {"acceleration": [5.0, 0, 0]}, {"speed": [0.8, -0.3, 0]})
    whole = on(robot, **{key: value for kind in kinds for key, value in kind.items()})
    faster = on(robot, speed=[1.6, -0.6, 0])
    ones = [on(robot, **kind) for kind in kinds]
    *parts, four_times, together = under(robot, *ones, faster, whole, model=model, pose=[0.1, 0.5])
    sizes = np.abs(parts).max()
    np.testing.assert_allclose(np.sum(parts, axis=0), together, rtol=0, atol=1e-9 * sizes)
    np.testing.assert_allclose(four_times, 4.0 * parts[3], rtol=1e-7, atol=1e-9 * sizes)


LOADS = (
    {"gravity": [1.0, 2.0, -9.81]},
    {"acceleration": [5.0, 0.0, 0.0], "speed": [0.8, 0.0, 0.0]},
    {"wrench": [1.0, 2.0, 3.0, 0.4, 0.5, 0.6]},
)


@pytest.mark.parametrize("name", ["ifw", "five-bar", "3-rrr", "hexapod"])
def test_virtual_joints_and_links_give_one_answer(name):
    robot = load_robot(name).mechanism
    inside = [
        Load("inside", body.name, point, wrench=np.array([1.0, 2.0, 3.0, 0.4, 0.5, 0.6]))
        for body in robot.bodies.values()
        for point in body.interfaces
        if body.name != GROUND
    ]
    loads = [*inside, *(on(robot, **what) for what in LOADS)]
    pose = robot.poses[len(robot.poses) // 3]
    chains, assembled = (under(robot, *loads, model=m, pose=pose) for m in ("vjm", "links"))
    sizes = np.abs(assembled).max(axis=1, keepdims=True)
    assert np.abs(chains - assembled).max() <= 1e-8 * sizes.max()
    assert (np.abs(chains - assembled) <= 1e-7 * sizes).all()


@pytest.mark.parametrize("name", ["delta", "orthoglide"])
def test_inertia_is_the_work_of_all_masses_on_what_unit_loads_of_the_tool_move(name):
    """Betti again, mass by mass: Σ m a(p)·X(p), at four points of sections at Gauss points."""
    robot = load_robot(name).mechanism
    load = on(robot, **LOADS[1], gravity=[0.0, 0.0, -G])
    at = posture(replace(robot, loads=(load,)), robot.poses[1])
    (found,) = displacements("beam", [at])[0]
    system = assemble(at, static_bodies("beam", at.mechanism))
    unit = solved(system).displacements(system.tool.T)
    moving = accelerations(at, load.speed, load.acceleration)
    due = np.zeros(6)
    places, weights = np.polynomial.legendre.leggauss(12)
    for body, shape in ((name, robot.bodies[name].shape) for name in robot.bodies):
        frame, motion = at.frames[body], moving[body]
        if body in system.models:
            section = shape.section
            y, z = np.sqrt(2.0 / section.area) * np.sqrt(
                [section.second_moment_z, section.second_moment_y]
            )
            arms = np.array([[0.0, y, 0.0], [0.0, -y, 0.0], [0.0, 0.0, z], [0.0, 0.0, -z]])
            axis = np.outer(0.5 * shape.length * (1.0 + places), [1.0, 0.0, 0.0])
            points = (axis[:, None] + arms).reshape(-1, 3)
            moved = system.models[body].displacements(points) @ system.own(body, unit)
            moved = np.einsum("ij,pjk->pik", frame.rotation, moved.reshape(len(points), 3, 6))
            masses = np.repeat(0.125 * weights * shape.mass, 4)
        elif body != GROUND and shape.mass:
            points, masses = shape.centre[None], np.array([shape.mass])
            rows = system.motions.at(
                body,
                next(iter(robot.bodies[body].interfaces)),
                frame.position + frame.rotation @ shape.centre,
            )
            moved = (rows @ unit[: system.outer])[None, :3]
            swung = shape.inertia @ (frame.rotation.T @ motion.angular)
            spin = frame.rotation.T @ motion.turning
            swung += np.cross(spin, shape.inertia @ spin)
            due -= (frame.rotation @ swung) @ (rows @ unit[: system.outer])[3:]
        else:
            continue
        for point, mass, way in zip(points, masses, moved, strict=True):
            due += mass * (load.gravity - motion.at(frame.rotation @ point)) @ way
    tip = robot.bodies[robot.tool.body].interfaces[robot.tool.point].position
    frame = at.frames[robot.tool.body]
    pull = load.gravity - moving[robot.tool.body].at(frame.rotation @ tip)
    due += robot.tool.mass * pull @ (system.tool @ unit)[:3]
    np.testing.assert_allclose(found, due, rtol=0, atol=1e-7 * np.abs(due).max())
