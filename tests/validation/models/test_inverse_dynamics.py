"""Inverse dynamics against EXUDYN: there the drives' forces move the tool as the load says."""

from dataclasses import replace

import numpy as np
import pytest

from fem import multibody
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import free_twists
from lumped.mechanism.kinematics.accelerations import accelerations
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import GROUND
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.loads import loading, work_on
from lumped.system.solution import solved

exudyn = pytest.importorskip("exudyn", reason="EXUDYN (extra exudyn) is not installed")
SPEED, ACCELERATION = np.array([0.4, -0.3, 0.2]), np.array([3.0, 2.0, -4.0])


def of_rigid_legs(robot):
    """Every leg as a rigid body of its prism's mass and inertia."""
    bodies = dict(robot.bodies)
    for name, body in robot.bodies.items():
        if isinstance(leg := body.shape, ConstantLeg):
            line, y, z = leg.mass / leg.section.area, *second_moments(leg.section)
            along = leg.mass * leg.length**2 / 12.0
            inertia = np.diag([line * (y + z), line * y + along, line * z + along])
            shape = Rigid(leg.mass, np.array([0.5 * leg.length, 0.0, 0.0]), inertia)
            bodies[name] = replace(body, shape=shape)
    return replace(robot, bodies=bodies)


def second_moments(section):
    return section.second_moment_y, section.second_moment_z


def forces_of_drives(at, load):
    """Forces (N) and moments (N m) that the drives must give: what deflects their springs."""
    system = assemble(at, {})
    moved = solved(system).displacements(work_on(system, loading(at, load, {}))[:, None])
    return {
        joint.name: -np.sqrt(joint.drive.stiffness)
        * float((system.motions.springs[Portion(joint.name, "drive")] @ moved)[0, 0])
        for joint in at.mechanism.joints
        if joint.drive
    }


def test_forces_of_the_drives_move_the_tool_of_another_program_as_the_load_says():
    """A hexapod that moves and accelerates: rigid bodies, forces instead of drives.

    Mean of a short time on and as long back, when speeds are the other way round.
    """
    robot = of_rigid_legs(load_robot("hexapod").mechanism)
    tool = robot.tool
    load = Load("stop", tool.body, tool.point, speed=SPEED, acceleration=ACCELERATION)
    at = posture(robot, robot.poses[2])
    forces = forces_of_drives(at, load)
    time, ways = 1e-3, [moved_in_exudyn(at, forces, sign, 1e-3) for sign in (1.0, -1.0)]
    np.testing.assert_allclose(sum(ways) / time**2, ACCELERATION, rtol=1e-4)


def moved_in_exudyn(at, forces, sign, time):
    """How far the tool goes (3, m) with such forces of the drives and `sign` times the speeds."""
    robot = at.mechanism
    joints = [replace(joint, drive=None) for joint in robot.joints]
    model = multibody._ExudynModel(replace(at, mechanism=replace(robot, joints=joints)), 1)
    for joint in robot.joints:
        if joint.drive:
            way = free_twists(at, joint)[:3, 0]
            for side, end in ((joint.first, -1.0), (joint.second, 1.0)):
                marker, _ = model.markers[side.body, side.point]
                pull = end * forces[joint.name] * way
                model.mbs.AddLoad(model.items.Force(markerNumber=marker, loadVector=pull))
    model.mbs.Assemble()
    velocities = sign * np.array([*rates(robot, at), *SPEED, *np.zeros(3)])
    initial = exudyn.ConfigurationType.Initial
    model.mbs.systemData.SetODE2Coordinates_t(velocities, configuration=initial)
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.numberOfSteps = 50
    settings.timeIntegration.endTime = time
    model.mbs.SolveDynamic(settings)
    return np.array(model.mbs.systemData.GetODE2Coordinates())[-6:-3]


def rates(robot, at):
    """Velocities of the bodies' centres and, in their own axes, of their turn, body by body."""
    step = 1e-5
    along = np.zeros(len(robot.tool.moves))
    along[:3] = SPEED
    before, after = (posture(robot, at.pose + sign * step * along, at) for sign in (-1.0, 1.0))
    motions = accelerations(at, SPEED, np.zeros(3))
    found = []
    for name, body in robot.bodies.items():
        if name != GROUND:
            places = [
                one.frames[name].position + one.frames[name].rotation @ body.shape.centre
                for one in (before, after)
            ]
            turning = at.frames[name].rotation.T @ motions[name].turning
            found += [*(places[1] - places[0]) / (2.0 * step), *turning]
    return found
