"""Loads on a mechanism: wrenches on the interfaces of bodies, and displacements of the tool.

Gravity and inertia forces on a body are represented by forces M a on its interfaces. M is the mass
matrix condensed to the interfaces (Guyan 1965), and a contains the accelerations of the interfaces.
Condensation preserves rigid motions, so that these forces are consistent for gravity, and for any
field of accelerations that has the form of a rigid displacement. The displacement of the tool under
these forces is exact, because unit loads at the tool do not act inside bodies (Maxwell–Betti).

Centripetal accelerations of a rotating body do not have the form of a rigid displacement. Their
resultant wrench follows from the equations of Newton and Euler. It is distributed in proportion to
the accelerations of the interfaces, which is exact along a slender leg.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from lumped.arrays import Array
from lumped.beam_properties import prism_sections
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg, NoBeamTheoryError
from lumped.line_sections import LineSections
from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import drive_in, free_twists, interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.accelerations import REST, Motion, accelerations
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import (
    AppliedLine,
    AppliedWrench,
    DistributedLoad,
    InterfaceLoads,
    LineLoad,
    Load,
    Loading,
)
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.model_choices import Theory
from lumped.screws import shift, skew, turn
from lumped.system.assembly import System, rigid_mass
from lumped.system.joint_motion import Portion
from lumped.system.line_loads import InertiaLoad, end_wrenches, inertia_load, linear_load
from lumped.system.solution import Solved, with_idle


def loading(
    posture: Posture,
    load: Load,
    bodies: InterfaceLoads,
    theory: Theory = "timoshenko",
) -> Loading:
    """Wrenches of a load in one posture.

    `bodies` contains the masses of deformable bodies and the wrenches of pressures on their faces.
    Loads along legs are represented by wrenches on their ends, computed by the beam theory
    `theory` unless `bodies` contains others. Raises ComputationError if the tool cannot perform the
    motion in the load, or if the load has no wrench for this pose.
    """
    mechanism = posture.mechanism
    load_position = interface_position(posture, Side(load.body, load.point))
    point_wrenches = [AppliedWrench(load.body, load.point, load_position, _wrench(posture, load))]
    body_wrenches: list[AppliedWrench] = []
    line_loads: dict[str, list[DistributedLoad]] = {}
    for line in load.lines:
        along = _along_leg(posture, line)
        line_loads.setdefault(line.leg, []).append(along)
        wrenches = _line_wrenches(mechanism, line.leg, along, bodies, theory)
        body_wrenches += _on_interfaces(posture, line.leg, wrenches)
    for on_faces in load.pressures:
        unit = bodies.unit_pressures[on_faces.body, on_faces.faces]
        body_wrenches += _on_interfaces(posture, on_faces.body, on_faces.pressure * unit)
    if not load.acts_on_mass:
        return Loading(point_wrenches, body_wrenches, line_loads=line_loads)
    motions: Mapping[str, Motion] = dict.fromkeys(mechanism.bodies, REST)
    if load.moves_tool:
        motions = accelerations(posture, load.speed, load.acceleration)
    for name, body in mechanism.bodies.items():
        points = np.array([interface.position for interface in body.interfaces.values()])
        if isinstance(body.shape, Rigid):
            mass, points = rigid_mass(body.shape), np.zeros((1, 3))
        else:
            mass = bodies.masses[name]
        if name == GROUND or not mass.any():
            continue
        frame = posture.frames[name]
        axes = turn(frame.rotation)
        motion = _in_axes(frame.rotation, motions[name], load.gravity)
        in_body_axes = _inertia(mass, points, motion).reshape(-1, 6)
        if isinstance(body.shape, ConstantLeg | GivenLeg | LineLeg):
            line_load = _line_load(body.shape, in_body_axes, motion)
            line_loads.setdefault(name, []).append(line_load)
        wrenches = in_body_axes @ axes.T
        if isinstance(body.shape, Rigid):
            # The point of application affects the geometric stiffness.
            points = body.shape.centre[None]
            arm = frame.rotation @ body.shape.centre
            wrenches = wrenches @ shift(-arm)
        positions = frame.position + points @ frame.rotation.T
        body_wrenches += [
            AppliedWrench(name, point, position, wrench)
            for point, position, wrench in zip(body.interfaces, positions, wrenches, strict=False)
        ]
    tool = mechanism.tool
    tool_position = interface_position(posture, Side(tool.body, tool.point))
    tool_arm = tool_position - posture.frames[tool.body].position
    force = tool.mass * (load.gravity - motions[tool.body].acceleration_at(tool_arm))
    rotor_forces = {
        joint.name: -joint.drive.inertia * _acceleration(posture, joint, motions)
        for joint in mechanism.joints
        if joint.drive is not None and joint.drive.inertia and load.moves_tool
    }
    point_wrenches.append(
        AppliedWrench(tool.body, tool.point, tool_position, np.append(force, np.zeros(3)))
    )
    return Loading(point_wrenches, body_wrenches, rotor_forces, line_loads)


def _loaded_leg(mechanism: Mechanism, name: str) -> ConstantLeg | GivenLeg | LineLeg:
    leg = mechanism.bodies[name].shape
    if not isinstance(leg, ConstantLeg | GivenLeg | LineLeg):
        raise InputError(f"bodies.{name}: a distributed load needs a leg")
    return leg


def _line_wrenches(
    mechanism: Mechanism, name: str, load: LineLoad, bodies: InterfaceLoads, theory: Theory
) -> Array:
    """Wrenches (2×6, leg axes) on the ends of the leg `name` that represent a load along it."""
    if by_body := bodies.line_wrenches.get(name):
        return by_body(load)
    return end_wrenches(_sections(_loaded_leg(mechanism, name), theory), load)


def _along_leg(posture: Posture, line: AppliedLine) -> LineLoad:
    """Load of the robot file along a leg, in leg axes."""
    rotation = posture.frames[line.leg].rotation
    return line.load.in_axes(rotation) if line.in_base else line.load


def _sections(leg: Leg, theory: Theory) -> LineSections:
    """Sections along a leg by the beam theory `theory`.

    Euler–Bernoulli theory is used for a section that has no Timoshenko beam. A leg known by its 6×6
    has the sections of its equivalent prism.
    """
    try:
        return _sections_by(leg, theory)
    except NoBeamTheoryError:
        return _sections_by(leg, "euler-bernoulli")


def _sections_by(leg: Leg, theory: Theory) -> LineSections:
    if isinstance(leg, LineLeg):
        return leg.sections(theory)
    prism = equivalent_leg(leg)
    return prism_sections(prism.properties(theory), prism.length)


def _on_interfaces(posture: Posture, name: str, wrenches: Array) -> list[AppliedWrench]:
    """Wrenches in base axes on the m interfaces of the body `name`.

    `wrenches` (6m or m×6) are the same wrenches in body axes.
    """
    axes = turn(posture.frames[name].rotation)
    return [
        AppliedWrench(name, point, interface_position(posture, Side(name, point)), axes @ wrench)
        for point, wrench in zip(
            posture.mechanism.bodies[name].interfaces, wrenches.reshape(-1, 6), strict=True
        )
    ]


def _line_load(leg: Leg, at_ends: Array, motion: Motion) -> DistributedLoad:
    """Load along a leg due to inertia and gravity, for a leg that moves as a rigid body.

    `motion` is its motion in leg axes, minus the acceleration of gravity. The load is exact for
    legs with sections. For a leg known by its 6×6 it varies linearly and has the resultant of the
    wrenches `at_ends` (2×6, leg axes).
    """
    if isinstance(leg, LineLeg):
        return InertiaLoad(_sections(leg, "timoshenko"), motion)
    if isinstance(leg, GivenLeg):
        return linear_load(at_ends[0], at_ends[1], leg.length)
    try:
        properties = leg.timoshenko
    except NoBeamTheoryError:
        properties = leg.properties("euler-bernoulli")
    return inertia_load(properties, leg.length, motion)


def _acceleration(posture: Posture, joint: Joint, motions: Mapping[str, Motion]) -> float:
    """Acceleration (m/s² or rad/s²) of the coordinate of a joint with one free twist.

    `motions` contains the motion of each body, by name.
    """
    along, about = np.split(free_twists(posture, joint)[:, 0], 2)
    first, second = (motions[side.body] for side in (joint.first, joint.second))
    if about.any():
        return float(about @ (second.angular_acceleration - first.angular_acceleration))
    positions = [interface_position(posture, side) for side in (joint.first, joint.second)]
    distance = along @ (positions[1] - positions[0])
    interface_accelerations = [
        motion.acceleration_at(position - posture.frames[side.body].position)
        for motion, position, side in zip(
            (first, second), positions, (joint.first, joint.second), strict=True
        )
    ]
    # The axis turns with the first body, at some distance along the axis from the second body.
    axis_rate = np.cross(first.angular_velocity, along)
    return float(
        along @ (interface_accelerations[1] - interface_accelerations[0])
        + distance * axis_rate @ axis_rate
    )


def _wrench(posture: Posture, load: Load) -> Array:
    """Wrench (6, SI, base axes) of a load in one posture.

    Raises ComputationError if the load has no wrench for this pose.
    """
    if load.path_wrenches is None:
        return load.wrench
    mechanism = posture.mechanism
    number = mechanism.pose_number(posture.pose)
    if number is None:
        pose = shown_pose(mechanism, posture.pose)
        raise ComputationError(f"{mechanism.name}: {load.name} has no wrench for {pose}")
    return np.asarray(load.path_wrenches[number])


def _in_axes(rotation: Array, motion: Motion, gravity: Array) -> Motion:
    """Motion in body axes, with the acceleration of `gravity` subtracted.

    `motion` and `gravity` (3, in m/s²) are in base axes. The columns of `rotation` (3×3) are the
    body axes.
    """
    return Motion(
        rotation.T @ (motion.linear_acceleration - gravity),
        rotation.T @ motion.angular_acceleration,
        rotation.T @ motion.angular_velocity,
    )


def _inertia(mass: Array, points: Array, motion: Motion) -> Array:
    """Forces (6k, body axes) on k interfaces that represent inertia and gravity of a body.

    `points` (k×3, in m) are the positions of the interfaces. `mass` (6k×6k) is the mass matrix of
    the body for their twists. `motion` is the motion of the body minus the acceleration of gravity,
    in body axes.
    """
    rigid = np.vstack([shift(point) for point in points])
    twist = np.concatenate([motion.linear_acceleration, motion.angular_acceleration])
    loads = -mass @ (rigid @ twist)
    if not motion.angular_velocity.any():
        return np.asarray(loads)
    # Across a leg, centripetal accelerations vary linearly, like those of an angular acceleration
    # (`slope`), which is fitted by least squares.
    centripetal = skew(motion.angular_velocity) @ skew(motion.angular_velocity)
    arms = -skew(points).reshape(-1, 3)
    slope = np.linalg.lstsq(arms, (points @ centripetal).ravel(), rcond=None)[0]
    accelerations = [np.concatenate([centripetal @ point, slope]) for point in points]
    loads -= mass @ np.concatenate(accelerations)
    rigid_mass_matrix = rigid.T @ mass @ rigid
    momentum = (rigid_mass_matrix[:, 3:] @ motion.angular_velocity).reshape(2, 3)
    resultant = rigid_mass_matrix @ twist + np.cross(motion.angular_velocity, momentum).ravel()
    correction = np.linalg.lstsq(rigid_mass_matrix, resultant + rigid.T @ loads, rcond=None)[0]
    return np.asarray(loads - mass @ (rigid @ correction))


def work_on(system: System, load: Loading) -> Array:
    """Generalised forces (n) of a load on the n unknowns of a system.

    Each is the work of the load for a unit of the unknown.
    """
    work = np.zeros(system.size)
    outer = work[: system.outer]
    for applied in load.wrenches:
        twists = system.motions.at(applied.body, applied.point, applied.position)
        outer += twists.T @ applied.wrench
    for joint in system.motions.structure.mechanism.joints:
        force = load.rotor_forces.get(joint.name, 0.0)
        drive = drive_in(system.posture, joint)
        if force and drive is not None and drive.stiffness is not None:
            # The drive has the energy ½|D y|² and hence the deflection D y/√k.
            (rows,) = system.motions.springs[Portion(joint.name, "drive")]
            outer += force / np.sqrt(drive.stiffness) * rows
    return work


def tool_displacements(solution: Solved, loads: Sequence[Loading]) -> Array:
    """Displacements (l×6, in m and rad, base axes) of the loaded point under each of l loads.

    A load that does work on an idle motion accelerates it freely.
    """
    system = solution.system
    # The shape is given because a rigid mechanism has no unknowns and hence empty rows.
    work = np.reshape([work_on(system, load) for load in loads], (len(loads), system.size))
    return np.asarray(work @ with_idle(solution, solution.displacements(system.tool.T)))
