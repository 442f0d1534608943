"""Reactions of joints and forces of drives: statics by hand, equilibrium and virtual work."""

from dataclasses import replace

import numpy as np
import pytest
from support.random.random_mechanisms import random_posture
from support.robots.plane_frames import BAR, BEAM, CANTILEVER, TRIANGLE, WEIGHT, B, E, H, L, Q
from support.robots.robot_from_text import described

from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.kinematics.accelerations import accelerations
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file import load_robot
from lumped.system.reactions import joint_axes
from validation.models.loads.statics import load_forces
from validation.models.options import ModelOptions

# A carriage on two slides along x, each with a drive of its own, one behind a bar.
SHARED = f"""
schema = 2
name = "shared"
points = {{ A = [0.0, 0.0, 0.0], B = [{L}, 0.0, 0.0] }}
bodies.carriage = {{ points = ["B"] }}
bodies.foot = {{ points = ["A"] }}
bodies.bar = {{ from = "A", to = "B", {BAR} }}
joints.weld = {{ type = "fixed", between = ["bar", "carriage"], at = "B" }}
joints.seat = {{ type = "fixed", between = ["foot", "bar"], at = "A" }}
[joints.far]
type = "prismatic"
between = ["ground", "foot"]
at = "A"
axis = [1, 0, 0]
drive = {{ stiffness = 3.0e8 }}
[joints.near]
type = "prismatic"
between = ["ground", "carriage"]
at = "B"
axis = [1, 0, 0]
drive = {{ stiffness = 1.0e8 }}
[tool]
body = "carriage"
point = "B"
moves = ["x"]
"""
ROBOTS = ("ifw", "five-bar", "3-rrr", "delta", "orthoglide", "hexapod")
GRAVITY = np.array([1.0, 2.0, -9.81])


def under(mechanism, *, model="beam", pose=(), **load):
    """Posture, and reactions by joint name, under one load at the loaded point."""
    tool = mechanism.tool
    robot = replace(mechanism, loads=(Load("load", tool.body, tool.point, **load),))
    loaded_posture = posture(robot, np.array(pose)) if len(pose) else reference_posture(robot)
    # Reactions of statically determinate robots do not depend on the mesh of a solid.
    ((forces,),) = load_forces(model, [loaded_posture], ModelOptions(divisions=2))
    return loaded_posture, {reaction.joint: reaction for reaction in forces.reactions}


@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam", "solid"])
def test_cantilever_reaction_balances_loads(model):
    """Force P and a torque at the tip, q per length: R = P + qL, M = PL + qL²/2, same torque."""
    wrench = np.array([5.0, 7.0, -11.0, 13.0, 0.0, 0.0])
    _, reactions = under(described(CANTILEVER), model=model, wrench=wrench, **WEIGHT)
    weight = Q * L
    due = [-5.0, -7.0, 11.0 + weight, -13.0, -11.0 * L - weight * L / 2.0, -7.0 * L]
    clamp = reactions["clamp"]
    # Masses of solids are integrated on meshes of straight cells: exact for rectangles.
    np.testing.assert_allclose(clamp.wrench, due, rtol=1e-9, atol=1e-9 * weight * L)
    assert (clamp.half_width <= 1e-9 * weight * L).all()
    assert clamp.drive is None


@pytest.mark.parametrize("model", ["links", "beam"])
def test_clamped_beam_has_equal_end_moments(model):
    """R = qL/2 and M = qL²/12 at both ends, with and without shear deformation (symmetry)."""
    beam = described(BEAM.replace("LEFT", "fixed").replace("RIGHT", "fixed"))
    _, reactions = under(beam, model=model, **WEIGHT)
    shear, moment = Q * L / 2.0, Q * L**2 / 12.0
    for joint, sign in (("a", -1.0), ("b", 1.0)):
        due = [0.0, 0.0, shear, 0.0, sign * moment, 0.0]
        np.testing.assert_allclose(reactions[joint].wrench, due, atol=1e-9 * moment)


def test_propped_reaction_is_three_eighths():
    """R_B = 3qL/8 of Euler and Bernoulli's beam, by equal deflections qL⁴/8EI = RL³/3EI."""
    text = BEAM.replace('"RIGHT"', '"spherical"').replace("LEFT", "fixed")
    robot = described(text)
    robot = replace(robot, loads=(Load("weight", "left", "M", **WEIGHT),))
    euler = ModelOptions(theory="euler-bernoulli")
    ((forces,),) = load_forces("links", [reference_posture(robot)], euler)
    wrenches = {reaction.joint: reaction.wrench for reaction in forces.reactions}
    np.testing.assert_allclose(wrenches["b"][2], 3.0 * Q * L / 8.0, rtol=1e-9)
    np.testing.assert_allclose(wrenches["b"][3:], 0.0, atol=1e-9 * Q * L)
    np.testing.assert_allclose(wrenches["a"][2], 5.0 * Q * L / 8.0, rtol=1e-9)
    np.testing.assert_allclose(wrenches["a"][4], -Q * L**2 / 8.0, rtol=1e-9)


def test_triangle_bars_are_in_equilibrium():
    """At the pin, 4/5 N₁ = F_x and 3/5 N₁ + N₂ = F_y: N₁ = 5/4 F_x, N₂ = F_y − 3/4 F_x."""
    force = np.array([120.0, -50.0, 0.0, 0.0, 0.0, 0.0])
    loaded_posture, reactions = under(described(TRIANGLE), wrench=force)
    tension, column = 1.25 * 120.0, -50.0 - 0.75 * 120.0
    # The ground pulls each bar backwards; the axis of the pin is z.
    for joint, due in (("a", [-0.8 * tension, -0.6 * tension]), ("b", [0.0, -column])):
        wrench = in_base_axes(loaded_posture, loaded_posture.mechanism.joints, reactions[joint])
        np.testing.assert_allclose(wrench, [*due, 0.0, 0.0, 0.0, 0.0], atol=1e-7)
    # The long bar's end carries the force of the tool too: the pin takes the column's force alone.
    wrench = in_base_axes(loaded_posture, loaded_posture.mechanism.joints, reactions["p"])
    np.testing.assert_allclose(wrench[:2], [0.0, column], atol=1e-7)


def test_parallel_drives_share_by_stiffness():
    """A bar in series with a drive, 1/k = L/EA + 1/3e8, is parallel to a drive of 1e8 N/m.

    Shares of the force F are proportional to k and 1e8.
    """
    through_bar = 1.0 / (L / (E * B * H) + 1.0 / 3.0e8)
    share = through_bar / (through_bar + 1.0e8)
    force = np.array([1000.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    _, reactions = under(described(SHARED), wrench=force)
    assert reactions["far"].drive == pytest.approx(-1000.0 * share, rel=1e-9)
    assert reactions["near"].drive == pytest.approx(-1000.0 * (1.0 - share), rel=1e-9)
    # The drive acts along the joint's axis x, and the slide carries nothing else.
    along = np.array([-1000.0 * share, 0.0, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(reactions["far"].wrench, along, atol=1e-7)


def in_base_axes(loaded_posture, joints, reaction):
    """Wrench (6) of a joint on its second body in base axes."""
    (joint,) = (candidate for candidate in joints if candidate.name == reaction.joint)
    return (joint_axes(loaded_posture, joint) @ reaction.wrench.reshape(2, 3).T).T.ravel()


def equilibrium(loaded_posture, reactions, load, *, uniform=True):
    """Largest resultant (N) on a body, and largest force (N). Moments are divided by the size.

    If `uniform`, legs known by their 6×6 have their mass along the leg, as equivalent legs do;
    otherwise they have the mass centres of the file.
    """
    mechanism, tool = loaded_posture.mechanism, loaded_posture.mechanism.tool
    motions = (
        accelerations(loaded_posture, load.speed, load.acceleration) if load.moves_tool else {}
    )
    unit = np.array([1.0] * 3 + [1.0 / mechanism.size] * 3)
    resultants = {name: np.zeros(6) for name in mechanism.bodies}
    largest = 0.0

    def act(body, wrench, position):
        moment = wrench[3:] + np.cross(position, wrench[:3])
        resultants[body] += unit * np.append(wrench[:3], moment)

    for joint in mechanism.joints:
        wrench = in_base_axes(loaded_posture, [joint], reactions[joint.name])
        largest = max(largest, np.abs(unit * wrench).max())
        position = interface_position(loaded_posture, joint.first)
        act(joint.second.body, wrench, position)
        act(joint.first.body, -wrench, position)
        # No work on passive motions.
        passive = free_twists(loaded_posture, joint)[:, int(joint.drive is not None) :]
        assert (np.abs(passive.T @ wrench) <= 1e-8 * (1.0 + np.abs(wrench).max())).all()
    for name, body in mechanism.bodies.items():
        frame, shape = loaded_posture.frames[name], body.shape
        if name == GROUND or not getattr(shape, "mass", 0.0):
            continue
        centre = leg_centre(shape, uniform=uniform)
        arm = frame.rotation @ centre
        force, moment = shape.mass * load.gravity, np.zeros(3)
        if name in motions:
            force = force - shape.mass * motions[name].acceleration_at(arm)
            turned = frame.rotation @ leg_inertia(shape) @ frame.rotation.T
            moment = -turned @ motions[name].angular_acceleration
            spin = motions[name].angular_velocity
            moment -= np.cross(spin, turned @ spin)
        act(name, np.append(force, moment), frame.position + arm)
    position = interface_position(loaded_posture, Side(tool.body, tool.point))
    force = tool.mass * load.gravity
    if motions:
        arm = position - loaded_posture.frames[tool.body].position
        force = force - tool.mass * motions[tool.body].acceleration_at(arm)
    act(tool.body, load.wrench + np.append(force, np.zeros(3)), position)
    del resultants[GROUND]
    return max(np.abs(resultant).max() for resultant in resultants.values()), largest


def leg_centre(shape, *, uniform):
    if isinstance(shape, Rigid):
        return shape.centre
    mass_centre = None if uniform else getattr(shape, "mass_centre", None)
    return np.array([mass_centre or shape.length / 2.0, 0.0, 0.0])


def leg_inertia(shape):
    """Inertia (3×3) about the mass centre, body axes; of a prism: a line plus its sections."""
    if isinstance(shape, Rigid):
        return shape.inertia
    beam = shape.timoshenko
    line = shape.mass * shape.length**2 / 12.0
    iy, iz = beam.rho_Iy * shape.length, beam.rho_Iz * shape.length
    return np.diag([beam.rho_J * shape.length, line + iy, line + iz])


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam"])
def test_built_in_robots_are_in_equilibrium(robot, model):
    """Forces of joints, tool and weight sum to zero, as do their moments."""
    mechanism = load_robot(robot).mechanism
    wrench = np.array([100.0, 50.0, -30.0, 1.0, 2.0, 3.0])
    loaded_posture, reactions = under(mechanism, model=model, wrench=wrench, gravity=GRAVITY)
    uniform = model not in ("vjm", "links")
    resultant, largest = equilibrium(
        loaded_posture, reactions, loaded_posture.mechanism.loads[0], uniform=uniform
    )
    assert resultant <= 1e-9 * largest
    half_width = max(reaction.half_width[0] for reaction in reactions.values())
    assert half_width <= 1e-9 * largest


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "hexapod"])
def test_moving_bodies_are_in_equilibrium(robot):
    """Newton's and Euler's equations, with the accelerations of rigid bodies."""
    mechanism = load_robot(robot).mechanism
    motion = {"acceleration": np.array([5.0, 0.0, 0.0]), "speed": np.array([0.5, 0.0, 0.0])}
    loaded_posture, reactions = under(mechanism, gravity=GRAVITY, **motion)
    resultant, largest = equilibrium(loaded_posture, reactions, loaded_posture.mechanism.loads[0])
    # Velocities' part of accelerations is a difference quotient, 1e-10 of itself.
    assert resultant <= 1e-8 * largest


# Random mechanisms whose drives hold the tool and that have no idle motions.
SEEDS = (2, 3, 5, 16, 17, 20, 26, 29, 31, 32, 45, 46, 51, 52, 55, 58, 59, 66, 71, 72)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_bodies_are_in_equilibrium(seed):
    """Reactions, a wrench on the tool and weight sum to zero on each body."""
    loaded_posture = random_posture(seed)
    tool = loaded_posture.mechanism.tool
    load = Load("load", tool.body, tool.point, np.array([7.0, 5.0, -3.0, 1.0, 2.0, 3.0]), GRAVITY)
    loaded_posture = replace(
        loaded_posture, mechanism=replace(loaded_posture.mechanism, loads=(load,))
    )
    ((forces,),) = load_forces("beam", [loaded_posture])
    reactions = {reaction.joint: reaction for reaction in forces.reactions}
    assert not any(np.isnan(reaction.wrench).any() for reaction in forces.reactions)
    resultant, largest = equilibrium(loaded_posture, reactions, load)
    assert resultant <= 1e-9 * largest


@pytest.mark.parametrize(("robot", "pose"), [("five-bar", (0.05, 0.5)), ("3-rrr", ())])
def test_drive_forces_do_work_of_load(robot, pose):
    """Virtual work of drives and load, Σ τ δq + F δx = 0; δq and δx between two postures."""
    mechanism = load_robot(robot).mechanism
    force = np.array([100.0, -60.0, 0.0, 0.0, 0.0, 0.0])
    loaded_posture, reactions = under(mechanism, pose=pose, wrench=force)
    step = 1e-5
    for number, move in enumerate(mechanism.tool.moves):
        component = ("x", "y", "z", "phi_x", "phi_y", "phi_z").index(move)
        forward_pose = np.array(loaded_posture.pose)
        forward_pose[number] += step
        backward_pose = 2.0 * np.array(loaded_posture.pose) - forward_pose
        after, before = (
            posture(loaded_posture.mechanism, forward_pose),
            posture(loaded_posture.mechanism, backward_pose),
        )
        work = sum(
            reaction.drive * float((after.coordinates[name] - before.coordinates[name])[0])
            for name, reaction in reactions.items()
            if reaction.drive is not None
        )
        # Central differences err by the square of the step.
        assert work / (2.0 * step) == pytest.approx(-force[component], rel=1e-6, abs=1e-6)


def test_rigid_loop_reactions_are_undetermined():
    """Rigid planar loops leave three components undetermined, elastic loops none."""
    mechanism = load_robot("five-bar").mechanism
    wrench = np.array([100.0, -60.0, 0.0, 0.0, 0.0, 0.0])
    _, rigid = under(mechanism, model="simplified", wrench=wrench)
    _, elastic = under(mechanism, model="links", wrench=wrench)
    for name, reaction in rigid.items():
        in_plane = [1, 2, 3]
        assert np.isnan(reaction.wrench[[0, 4, 5]]).any()
        np.testing.assert_allclose(
            reaction.wrench[in_plane], elastic[name].wrench[in_plane], atol=1e-7
        )
        assert not np.isnan(elastic[name].wrench).any()
        assert (reaction.drive is None) == (elastic[name].drive is None)


@pytest.mark.parametrize("robot", ROBOTS)
def test_joint_frame_has_x_along_axis(robot):
    """Right-handed orthonormal axes of each joint of all built-in robots."""
    robot_posture = reference_posture(load_robot(robot).mechanism)
    for joint in robot_posture.mechanism.joints:
        axes = joint_axes(robot_posture, joint)
        np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1.0)
        if len(joint.axes) == 1:
            np.testing.assert_allclose(axes[:, 0], joint.axes[0], atol=1e-9)
