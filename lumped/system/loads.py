"""Loads on a mechanism: wrenches at the interfaces of its bodies, and how far they move the tool.

What acts on a body's mass comes to its interfaces as M a: M the body's mass by their twists (its
inside condensed, Guyan 1965), a their accelerations. Since condensation reproduces rigid motions,
that is the consistent load of gravity and of a body that moves as a rigid one, and the tool's
displacement under it is exact (Maxwell and Betti: the tool's own unit loads leave the inside of all
bodies unloaded). Where a body turns, its centripetal acceleration is no rigid motion: the wrench
is Newton and Euler's, spread as the interfaces' own accelerations say, exactly along a slender leg.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.accelerations import REST, Motion, accelerations
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import Applied, Load, Loading
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.screws import shift, skew, turn
from lumped.system.assembly import System, rigid_mass
from lumped.system.joint_motion import Portion
from lumped.system.solution import Solved, with_idle


def loading(posture: Posture, load: Load, masses: Mapping[str, Array]) -> Loading:
    """All that a load does in a posture.

    `masses` (6m×6m, SI, body axes) of the bodies on the twists of their interfaces; rigid bodies
    have their own. Raises ComputationError where the tool cannot move as the load says, and where
    nothing is said of this pose.
    """
    mechanism = posture.mechanism
    place = interface_position(posture, Side(load.body, load.point))
    at_points = [Applied(load.body, load.point, place, _wrench(posture, load))]
    if not load.acts_on_mass:
        return Loading(at_points)
    along: list[Applied] = []
    motions: Mapping[str, Motion] = dict.fromkeys(mechanism.bodies, REST)
    if load.moves:
        motions = accelerations(posture, load.speed, load.acceleration)
    for name, body in mechanism.bodies.items():
        points = np.array([one.position for one in body.interfaces.values()])
        if isinstance(body.shape, Rigid):
            mass, points = rigid_mass(body.shape), np.zeros((1, 3))
        else:
            mass = masses[name]
        if name == GROUND or not mass.any():
            continue
        frame = posture.frames[name]
        axes = turn(frame.rotation)
        own = _in_axes(frame.rotation, motions[name], load.gravity)
        wrenches = _inertia(mass, points, own).reshape(-1, 6) @ axes.T
        if isinstance(body.shape, Rigid):
            # Where it acts, which matters to what turns under it.
            points = body.shape.centre[None]
            arm = frame.rotation @ body.shape.centre
            wrenches = wrenches @ shift(-arm)
        places = frame.position + points @ frame.rotation.T
        each = zip(body.interfaces, places, wrenches, strict=False)
        along += [Applied(name, *one) for one in each]
    tool = mechanism.tool
    place = interface_position(posture, Side(tool.body, tool.point))
    moved = motions[tool.body].at(place - posture.frames[tool.body].position)
    weight = np.concatenate([tool.mass * (load.gravity - moved), np.zeros(3)])
    on_rotors = {
        joint.name: -joint.drive.inertia * _acceleration(posture, joint, motions)
        for joint in mechanism.joints
        if joint.drive is not None and joint.drive.inertia and load.moves
    }
    return Loading([*at_points, Applied(tool.body, tool.point, place, weight)], along, on_rotors)


def _acceleration(posture: Posture, joint: Joint, motions: Mapping[str, Motion]) -> float:
    """Of the coordinate (m/s² or rad/s²) of a joint with one free twist."""
    along, about = np.split(free_twists(posture, joint)[:, 0], 2)
    first, second = (motions[side.body] for side in (joint.first, joint.second))
    if about.any():
        return float(about @ (second.angular - first.angular))
    places = [interface_position(posture, side) for side in (joint.first, joint.second)]
    apart = along @ (places[1] - places[0])
    moved = [
        motion.at(place - posture.frames[side.body].position)
        for motion, place, side in zip(
            (first, second), places, (joint.first, joint.second), strict=True
        )
    ]
    # The axis turns with the first body while the second is away along it.
    swung = np.cross(first.turning, along)
    return float(along @ (moved[1] - moved[0]) + apart * swung @ swung)


def _wrench(posture: Posture, load: Load) -> Array:
    """The wrench (6) in a posture; raises ComputationError where it has none for this pose."""
    if load.over_path is None:
        return load.wrench
    mechanism = posture.mechanism
    number = mechanism.number_of(posture.pose)
    if number is None:
        place = shown_pose(mechanism, posture.pose)
        raise ComputationError(f"{mechanism.name}: {load.name} has no wrench for {place}")
    return np.asarray(load.over_path[number])


def _in_axes(rotation: Array, motion: Motion, gravity: Array) -> Motion:
    """The motion in body axes, gravity as the acceleration that it is."""
    return Motion(
        rotation.T @ (motion.linear - gravity),
        rotation.T @ motion.angular,
        rotation.T @ motion.turning,
    )


def _inertia(mass: Array, points: Array, motion: Motion) -> Array:
    """Loads (6m) of a body's inertia on its interfaces at `points` (m×3), body axes."""
    rigid = np.vstack([shift(point) for point in points])
    twist = np.concatenate([motion.linear, motion.angular])
    found = -mass @ (rigid @ twist)
    if not motion.turning.any():
        return np.asarray(found)
    # Across a leg centripetal accelerations grow as those of a rigid turn do, with its slope.
    swing = skew(motion.turning) @ skew(motion.turning)
    arms = -skew(points).reshape(-1, 3)
    slope = np.linalg.lstsq(arms, (points @ swing).ravel(), rcond=None)[0]
    swung = [np.concatenate([swing @ point, slope]) for point in points]
    found -= mass @ np.concatenate(swung)
    whole = rigid.T @ mass @ rigid
    momentum = (whole[:, 3:] @ motion.turning).reshape(2, 3)
    due = whole @ twist + np.cross(motion.turning, momentum).ravel()
    missed = np.linalg.lstsq(whole, due + rigid.T @ found, rcond=None)[0]
    return np.asarray(found - mass @ (rigid @ missed))


def work_on(system: System, load: Loading) -> Array:
    """Work (n) of a load on each of the unknowns of a system."""
    work = np.zeros(system.size)
    outer = work[: system.outer]
    for one in load.everywhere:
        outer += system.motions.at(one.body, one.point, one.position).T @ one.wrench
    for joint in system.motions.structure.mechanism.joints:
        force = load.on_rotors.get(joint.name, 0.0)
        if force and joint.drive is not None and joint.drive.stiffness is not None:
            # ½|D y|² is the energy of the drive: D y over √k is how far it gives way.
            (rows,) = system.motions.springs[Portion(joint.name, "drive")]
            outer += force / np.sqrt(joint.drive.stiffness) * rows
    return work


def tool_displacements(solution: Solved, loads: Sequence[Loading]) -> Array:
    """Displacements (l×6, m and rad, base axes) of the loaded point under each of the loads.

    Where a load would set off an idle motion that follows freely.
    """
    system = solution.system
    # A rigid mechanism has no unknowns: the number of rows does not follow from the entries.
    work = np.reshape([work_on(system, load) for load in loads], (len(loads), system.size))
    return np.asarray(work @ with_idle(solution, solution.displacements(system.tool.T)))
