"""Geometric stiffness of a loaded mechanism.

To second order in what the unknowns do, forces and moments do work of their own: the stiffness is
K + λ G under λ times the load. Rotations are rotation vectors θ. What a force f meets at an arm r
from a node's place goes by ½ θ × (θ × r) farther than the linear model has it; a joint's second
side, seen from the first, goes on by θ₁ × d and turns on by ½ θ₁ × ψ, where the joint lets d and ψ
happen; the inside of a body does its part. All rotate together as the forces do, so that nothing
but the loads and the ground is felt by a robot that turns as a whole.

The load keeps its direction and its place on the body, the mechanism its posture. An idle motion
costs no energy, so the load alone would decide where it comes to rest, and every deformation could
be had with any amount of it. It is held where it is, as friction holds it: the geometric stiffness
is that of motions without an idle part, the same in all base axes. What a load does along an idle
motion, the inertia of the bodies takes: with it joints carry what is left.
"""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.mechanism.free_twists import (
    free_twists,
    interface_position,
    turned_since_reference,
)
from lumped.mechanism.joint import Joint
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import GROUND
from lumped.screws import shift, skew, turn
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from lumped.system.loads import work_on
from lumped.system.solution import Solved, idle_accelerations, without_idle


class Prestressed(Protocol):
    """Geometric stiffness of a body on its own unknowns."""

    def __call__(self, ends: Array, spread: Array, *, spins: bool) -> Array:
        """Stiffness (r×r, SI) from the forces on the interfaces that the body's stiffness takes.

        `spread` is the part of them that acts along it (6m each, body axes). `spins`: the body
        spins idly about its x axis.
        """
        ...


# Without units; loops are closed to 1e-12.
_DEPENDENT = 1e-9


def geometric_stiffness(
    solution: Solved, load: Loading, bodies: Mapping[str, Prestressed]
) -> Array:
    """Stiffness that a load adds to a system (n×n); `bodies` that bend within by name.

    Others turn as a whole: theirs is the mean rotation of their interfaces. Idle motions meet none.
    """
    system = solution.system
    work = work_on(system, load)[:, None]
    moved = solution.displacements(without_idle(solution, work))[:, 0]
    accelerated = idle_accelerations(solution, work)[:, 0]
    total = np.zeros((system.size, system.size))
    outer = total[: system.outer, : system.outer]
    # What joints give to the nodes: what the bodies take, less what the load gives.
    given = np.zeros((len(system.motions.places), 6))
    for name, model in system.models.items():
        own, inside, ends = system.own(name, moved), system.inside[name], system.ends[name]
        count = len(ends)
        forces = (model.stiffness @ own)[:count]
        # A load that sets off an idle motion meets the inertia of the bodies.
        inertia = (model.mass @ system.own(name, accelerated))[:count]
        frame = system.posture.frames[name]
        for point, wrench in zip(
            system.posture.mechanism.bodies[name].interfaces,
            (forces + inertia).reshape(-1, 6),
            strict=True,
        ):
            given[system.motions.structure.node(name, point)] += turn(frame.rotation) @ wrench
        if name not in bodies:
            places = [
                one.position for one in system.posture.mechanism.bodies[name].interfaces.values()
            ]
            outer += _turned_as_a_whole(ends, np.array(places), forces)
            continue
        spins = _spins(ends @ solution.motions[: system.outer])
        found = bodies[name](forces, _spread(system, name, load) - inertia, spins=spins)
        outer += ends.T @ found[:count, :count] @ ends
        total[: system.outer, inside] += ends.T @ found[:count, count:]
        total[inside, inside] += found[count:, count:]
    for one in load.everywhere:
        node = system.motions.structure.node(one.body, one.point)
        if one.body != GROUND:
            outer += _at_arm(system, node, one.position, one.wrench)
            given[node] -= shift(one.position - system.motions.places[node]).T @ one.wrench
    for joint, wrench in _carried(system, given, moved, load):
        outer += _of_joint(system, joint, wrench)
    total[system.outer :, : system.outer] = total[: system.outer, system.outer :].T
    return _without_idle_parts(solution, 0.5 * (total + total.T))


def _spins(idle: Array) -> bool:
    """Whether idle motions (12×k, twists of a leg's ends) spin it about its axis."""
    spin = np.zeros(12)
    spin[[3, 9]] = 1.0
    return bool(np.linalg.norm(spin - idle @ np.linalg.lstsq(idle, spin)[0]) < _DEPENDENT)


def _without_idle_parts(solution: Solved, geometric: Array) -> Array:
    """PᵀGP: P takes the idle part out of a motion, by the twists of all nodes (least squares)."""
    if not solution.idle:
        return geometric
    motions, outer = solution.system.motions, solution.system.outer
    unit = np.array([1.0 / motions.structure.length] * 3 + [1.0] * 3)
    twists = (unit[:, None] * motions.twists).reshape(-1, outer)
    idle = solution.motions
    part = np.linalg.lstsq(twists @ idle[:outer], twists)[0]
    projection = np.eye(len(idle))
    projection[:, :outer] -= idle @ part
    return np.asarray(projection.T @ geometric @ projection)


def _spread(system: System, body: str, load: Loading) -> Array:
    """What acts along a body, at its interfaces (6m, body axes)."""
    points = list(system.posture.mechanism.bodies[body].interfaces)
    found = np.zeros((len(points), 6))
    for one in load.along:
        if one.body == body:
            found[points.index(one.point)] += one.wrench
    return (found @ turn(system.posture.frames[body].rotation)).ravel()


def _longer_way(force: Array, arm: Array) -> Array:
    """Hessian (3×3) in θ of the energy −½ f·(θ × (θ × r))."""
    both = np.outer(force, arm)
    return np.asarray(float(force @ arm) * np.eye(3) - 0.5 * (both + both.T))


def _at_arm(system: System, node: int, place: Array, wrench: Array) -> Array:
    rotation = system.motions.twists[node, 3:]
    arm = place - system.motions.places[node]
    return np.asarray(rotation.T @ _longer_way(wrench[:3], arm) @ rotation)


def _turned_as_a_whole(ends: Array, places: Array, forces: Array) -> Array:
    """Of a body whose interfaces (m×3, body axes) carry `forces` (6m); `ends` as in `System`.

    Seen from axes that turn with it by θ its interfaces move by −θ × u + ½ θ × (θ × r) and turn by
    −½ θ × θᵢ to second order.
    """
    arms = places - places.mean(axis=0)
    size = float(np.abs(arms).max(initial=0.0)) or 1.0
    unit = np.tile([1.0 / size] * 3 + [1.0] * 3, len(arms))
    rigid = np.vstack([shift(arm) for arm in arms])
    mean = np.linalg.pinv(unit[:, None] * rigid) @ (unit[:, None] * ends)
    turned = mean[3:]
    total = np.zeros((ends.shape[1],) * 2)
    for arm, twist, wrench in zip(
        arms, ends.reshape(len(arms), 6, -1), forces.reshape(-1, 6), strict=True
    ):
        half = turned.T @ (skew(wrench[:3]) @ twist[:3] + 0.5 * skew(wrench[3:]) @ twist[3:])
        total += half + half.T - turned.T @ _longer_way(wrench[:3], arm) @ turned
    return total


def _carried(
    system: System, given: Array, moved: Array, load: Loading
) -> list[tuple[Joint, Array]]:
    """Wrenches (6, base axes) of joints on their second bodies, where their first interfaces are.

    They give `given` (N×6) to the nodes and do no work on passive free twists. Where that leaves
    several, in loops of rigid bodies, elastic joints carry what the unknowns `moved` strain them
    by, and of what rigid ones may carry it is the smallest.
    """
    motions = system.motions
    joints = motions.structure.mechanism.joints
    length = motions.structure.length
    unit = np.array([1.0] * 3 + [1.0 / length] * 3)
    rows = np.zeros((len(given), 6, len(joints), 6))
    passive = []
    for number, joint in enumerate(joints):
        place = interface_position(system.posture, joint.first)
        for side, sign in ((joint.first, -1.0), (joint.second, 1.0)):
            if side.body != GROUND:
                node = motions.structure.node(side.body, side.point)
                arm = shift(place - motions.places[node]).T
                rows[node, :, number] += sign * unit[:, None] * arm / unit
        free = free_twists(system.posture, joint)[:, int(joint.drive is not None) :]
        none = np.zeros((free.shape[1], len(joints), 6))
        none[:, number] = free.T / unit
        passive.append(none / np.linalg.norm(none, axis=(1, 2), keepdims=True))
    size = 6 * len(joints)
    known = (given * unit).ravel()
    conditions = np.vstack([rows.reshape(-1, size), np.vstack(passive).reshape(-1, size)])
    right = np.concatenate([known, np.zeros(len(conditions) - len(known))])
    found = np.linalg.lstsq(conditions, right)[0]
    open_ = null_space(conditions, rcond=_DEPENDENT)
    if open_.size:
        rows, right = _of_springs(system, moved, load, unit)
        found += open_ @ np.linalg.lstsq(rows @ open_, right - rows @ found)[0]
    return list(zip(joints, found.reshape(-1, 6) / unit, strict=True))


def _of_springs(system: System, moved: Array, load: Loading, unit: Array) -> tuple[Array, Array]:
    """Rows (e×6j) of the wrenches of joints, times `unit` (6), that springs know, and those (e)."""
    joints = system.motions.structure.mechanism.joints
    rows, known = [np.zeros((0, len(joints), 6))], [np.zeros(0)]
    for number, joint in enumerate(joints):
        felt, rotor = np.zeros((0, 6)), load.on_rotors.get(joint.name, 0.0)
        if joint.compliance is not None and not rotor:
            axes = turn(turned_since_reference(system.posture, joint.first.body))
            felt = np.eye(6)
            known.append(-unit * (axes @ system.wrenches(joint, moved[:, None])[:, 0]))
        elif joint.compliance is None and joint.drive is not None and joint.drive.stiffness:
            felt = free_twists(system.posture, joint)[:, :1].T / unit
            strain = system.motions.springs[Portion(joint.name, "drive")] @ moved[: system.outer]
            known.append(rotor - np.sqrt(joint.drive.stiffness) * strain)
        mine = np.zeros((len(felt), len(joints), 6))
        mine[:, number] = felt
        rows.append(mine)
    return np.vstack(rows).reshape(-1, 6 * len(joints)), np.concatenate(known)


def _of_joint(system: System, joint: Joint, wrench: Array) -> Array:
    """What a joint that carries a `wrench` (6, on its second body) adds (outer×outer)."""
    motions, place = system.motions, interface_position(system.posture, joint.first)
    first, second = (
        motions.at(side.body, side.point, place) for side in (joint.first, joint.second)
    )
    force, moment = wrench[:3], wrench[3:]
    half = (second - first)[:3].T @ skew(force) @ first[3:]
    half += 0.5 * second[3:].T @ skew(moment) @ first[3:]
    if joint.kind == "universal":
        axes = free_twists(system.posture, joint)[3:]
        angles = np.linalg.pinv(axes) @ (second - first)[3:]
        half += 0.5 * float(moment @ np.cross(*axes.T)) * np.outer(angles[0], angles[1])
    total = half + half.T
    for side, sign in ((joint.first, -1.0), (joint.second, 1.0)):
        if side.body != GROUND:
            node = motions.structure.node(side.body, side.point)
            total += _at_arm(system, node, place, sign * wrench)
    return np.asarray(total)
