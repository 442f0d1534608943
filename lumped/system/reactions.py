"""Forces in a loaded mechanism: on the interfaces of its bodies, and in its joints.

The stiffness of a body balances the wrenches of the joints and the load on its interfaces. The
wrenches of the joints follow from the equilibrium of all nodes, and from λ·f = 0 for the wrench λ
in a joint on each passive free twist f. An idle motion is accelerated by the load along it, and the
inertia of the bodies (d'Alembert) takes part in the equilibrium.

In loops of rigid bodies, equilibrium leaves some wrenches undetermined. Springs in the loop
determine them by their strain. Without springs the loop is statically indeterminate: any
self-balanced wrenches can be added, for example by assembling the loop with clearance or preload.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.mechanism.body import Rigid
from lumped.mechanism.catalogue.directions import joint_axes as axes_of_kind
from lumped.mechanism.free_twists import (
    drive_in,
    free_twists,
    interface_position,
    rotation_since_reference,
)
from lumped.mechanism.joint import Joint
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.mechanism.placing import default_up
from lumped.screws import shift, turn, turn_matrix
from lumped.system.assembly import System, rigid_mass
from lumped.system.joint_motion import Portion, elastic_directions
from lumped.system.loads import work_on
from lumped.system.solution import Solved, idle_accelerations, without_idle

# Relative singular value below which conditions are dependent; loops are closed to 1e-12.
_DEPENDENT = 1e-9


@dataclass(frozen=True, eq=False)
class BodyForces:
    """Forces (6m, in N and N m, body axes) on the m interfaces of a deformable body.

    `elastic` are the forces that the stiffness of the body balances, `load` those of the load on
    its mass, and `inertia` is its mass times the acceleration of an idle motion. `rounding` is the
    half-width of their round-off error.
    """

    elastic: Array
    load: Array
    inertia: Array
    rounding: Array

    @property
    def distributed(self) -> Array:
        """Part of the elastic forces (6m) that acts on the length or volume of the body."""
        return self.load - self.inertia

    @property
    def at_interfaces(self) -> Array:
        """Forces (6m) of joints, and of loads at points, on the interfaces."""
        return self.elastic - self.distributed


@dataclass(frozen=True, eq=False)
class JointWrench:
    """Wrench (6, in N and N m, base axes) of a joint on its second body, at its first interface.

    In a statically indeterminate loop of rigid bodies, the columns of `undetermined` (6×k) are
    wrenches that can be added without a change of any load. `rounding` (N) is the half-width of the
    forces' round-off; times `length` (m) it is that of the moments.
    """

    joint: Joint
    wrench: Array
    undetermined: Array
    rounding: float
    length: float


@dataclass(frozen=True, eq=False)
class Reaction:
    """Wrench (6, in N and N m) of a joint on its second body, at its first interface, joint axes.

    Components are NaN if statics does not determine them. `half_width` (6) is the half-width of the
    numerical uncertainty. `drive` (N or N m) is the force of the motor along the joint's first free
    twist, including the inertia force of its rotor. None if the joint has no drive. `drive_unit` is
    its unit.
    """

    joint: str
    wrench: Array
    half_width: Array
    drive: float | None
    drive_unit: Literal["N", "N m"] = "N"


@dataclass(frozen=True, eq=False)
class InternalForces:
    """Forces of a system under a load: in deformable bodies by name, and in all joints.

    `displacements` (n) are the unknowns of the system with idle motions locked. `idle_acceleration`
    (n) is the acceleration of idle motions under the load.
    """

    displacements: Array
    idle_acceleration: Array
    bodies: Mapping[str, BodyForces]
    joints: tuple[JointWrench, ...]


def joint_axes(posture: Posture, joint: Joint) -> Array:
    """Axes x, y, z (3×3, columns, base axes) of a joint in a posture.

    x is the axis of the joint, or the normal of both axes of a universal joint
    (`catalogue.directions`). z of a prismatic joint is as close to the base's z axis as possible,
    or to the base's x axis if the joint slides along z. Fixed and spherical joints have the base
    axes of the reference posture. In other joints, z is as close as possible to the base axis that
    is most nearly normal to x. The axes rotate with the first body.
    """
    first = rotation_since_reference(posture, joint.first.body)
    if joint.kind in {"fixed", "spherical"}:
        return first
    axes = axes_of_kind(joint.kind, joint.axes, default_up(joint.axes[0]))
    return np.asarray(first @ axes)


def reaction(posture: Posture, transmitted: JointWrench, load: Loading) -> Reaction:
    """Reaction of a joint in its axes, and the force of its motor."""
    joint = transmitted.joint
    to_axes = turn(joint_axes(posture, joint)).T
    unit = np.array([1.0] * 3 + [1.0 / transmitted.length] * 3)
    free = unit[:, None] * (to_axes @ transmitted.undetermined)
    open_components = np.linalg.norm(free, axis=1) > _DEPENDENT
    drive = None
    if joint.drive is not None:
        along = free_twists(posture, joint)[:, 0]
        force = float(along @ transmitted.wrench) - load.rotor_forces.get(joint.name, 0.0)
        drive = np.nan if (np.abs(along @ transmitted.undetermined) > _DEPENDENT).any() else force
    return Reaction(
        joint.name,
        np.where(open_components, np.nan, to_axes @ transmitted.wrench),
        transmitted.rounding / unit,
        drive,
        "N m" if joint.kind == "revolute" else "N",
    )


def internal_forces(solution: Solved, load: Loading) -> InternalForces:
    """Forces on the interfaces of deformable bodies and in joints under a load."""
    system = solution.system
    work = without_idle(solution, work_on(system, load)[:, None])
    displacements = solution.displacements(work)[:, 0]
    idle_acceleration = idle_accelerations(solution, work_on(system, load)[:, None])[:, 0]
    bodies = {
        name: _body_forces(system, name, load, displacements, idle_acceleration)
        for name in system.models
    }
    wrenches = _Equilibrium(system, load, displacements, bodies, idle_acceleration).solution()
    return InternalForces(displacements, idle_acceleration, bodies, wrenches)


def _body_forces(
    system: System, name: str, load: Loading, displacements: Array, idle_acceleration: Array
) -> BodyForces:
    model, count = system.models[name], len(system.ends[name])
    unknowns = system.body_unknowns(name, displacements)
    inertia = (model.mass @ system.body_unknowns(name, idle_acceleration))[:count]
    magnitudes = (abs(model.stiffness) @ np.abs(unknowns))[:count]
    return BodyForces(
        elastic=np.asarray(model.stiffness @ unknowns)[:count],
        load=_load_on_mass(system, name, load),
        inertia=inertia,
        rounding=np.finfo(float).eps * magnitudes,
    )


def _load_on_mass(system: System, body: str, load: Loading) -> Array:
    """Load on the distributed mass of a body, at its interfaces (6m, body axes)."""
    points = list(system.posture.mechanism.bodies[body].interfaces)
    wrenches = np.zeros((len(points), 6))
    for applied in load.body_wrenches:
        if applied.body == body:
            wrenches[points.index(applied.point)] += applied.wrench
    return np.asarray((wrenches @ turn(system.posture.frames[body].rotation)).ravel())


@dataclass(frozen=True, eq=False)
class _Equilibrium:
    """Linear equations for the wrenches of all joints, and their solution.

    Moments are divided by the length of the mechanism, so that all components are in N. Wrenches
    are those of joints on their second bodies, at their first interfaces, base axes.
    """

    system: System
    load: Loading
    displacements: Array
    bodies: Mapping[str, BodyForces]
    idle_acceleration: Array

    @cached_property
    def _unit(self) -> Array:
        length = self.system.motions.structure.length
        return np.array([1.0] * 3 + [1.0 / length] * 3)

    @property
    def _joints(self) -> tuple[Joint, ...]:
        return tuple(self.system.posture.mechanism.joints)

    def solution(self) -> tuple[JointWrench, ...]:
        """Wrenches that balance the nodes and do no work on passive free twists.

        If this is not unique, the wrenches of elastic joints follow from their strain, and those of
        rigid joints are the smallest possible ones.
        """
        conditions, right_side = self._conditions()
        wrenches = np.linalg.lstsq(conditions, right_side)[0]
        null_basis = null_space(conditions, rcond=_DEPENDENT)
        if null_basis.size:
            rows, values = self._spring_wrenches()
            missing = values - rows @ wrenches
            wrenches += null_basis @ np.linalg.lstsq(rows @ null_basis, missing)[0]
            null_basis = null_basis @ null_space(rows @ null_basis, rcond=_DEPENDENT)
        sizes = [
            np.abs(conditions @ wrenches - right_side),
            *(
                (forces.rounding.reshape(-1, 6) * self._unit).ravel()
                for forces in self.bodies.values()
            ),
        ]
        rounding = float(np.concatenate(sizes).max(initial=0.0))
        return tuple(
            JointWrench(
                joint,
                wrench / self._unit,
                free / self._unit[:, None],
                rounding,
                float(1.0 / self._unit[-1]),
            )
            for joint, wrench, free in zip(
                self._joints,
                wrenches.reshape(-1, 6),
                null_basis.reshape(len(self._joints), 6, -1),
                strict=True,
            )
        )

    def _conditions(self) -> tuple[Array, Array]:
        """Matrix (c×6j) and right-hand side (c) of c equations for the wrenches of j joints.

        They are the equilibrium of the nodes, and zero work on passive free twists.
        """
        system, unit = self.system, self._unit
        motions, joints = system.motions, self._joints
        node_wrenches = self._node_wrenches()
        rows = np.zeros((len(node_wrenches), 6, len(joints), 6))
        passive = [np.zeros((0, len(joints), 6))]
        for number, joint in enumerate(joints):
            position = interface_position(system.posture, joint.first)
            for side, sign in ((joint.first, -1.0), (joint.second, 1.0)):
                if side.body != GROUND:
                    node = motions.structure.node(side.body, side.point)
                    arm = shift(position - motions.places[node]).T
                    rows[node, :, number] += sign * unit[:, None] * arm / unit
            free = free_twists(system.posture, joint)[:, int(joint.drive is not None) :]
            rows_of_joint = np.zeros((free.shape[1], len(joints), 6))
            rows_of_joint[:, number] = free.T / unit
            passive.append(
                rows_of_joint / np.linalg.norm(rows_of_joint, axis=(1, 2), keepdims=True)
            )
        size = 6 * len(joints)
        balance = (node_wrenches * unit).ravel()
        conditions = np.vstack([rows.reshape(-1, size), np.vstack(passive).reshape(-1, size)])
        return conditions, np.append(balance, np.zeros(len(conditions) - len(balance)))

    def _node_wrenches(self) -> Array:
        """Wrenches (N×6, base axes) of joints on nodes: wrenches on the bodies minus the loads."""
        system, load = self.system, self.load
        motions, posture = system.motions, system.posture
        wrenches = np.zeros((len(motions.places), 6))
        for name, forces in self.bodies.items():
            axes = turn(posture.frames[name].rotation)
            for point, wrench in zip(
                posture.mechanism.bodies[name].interfaces,
                (forces.elastic + forces.inertia).reshape(-1, 6),
                strict=True,
            ):
                wrenches[motions.structure.node(name, point)] += axes @ wrench
        accelerations = motions.twists @ self.idle_acceleration[: system.outer]
        for node, (name, point) in enumerate(motions.structure.nodes):
            shape = posture.mechanism.bodies[name].shape
            if not point and isinstance(shape, Rigid):
                mass = turn_matrix(rigid_mass(shape), posture.frames[name].rotation)
                wrenches[node] += mass @ accelerations[node]
        for applied in load.wrenches:
            if applied.body != GROUND:
                node = motions.structure.node(applied.body, applied.point)
                arm = applied.position - motions.places[node]
                wrenches[node] -= shift(arm).T @ applied.wrench
        return wrenches

    def _spring_wrenches(self) -> tuple[Array, Array]:
        """Matrix (e×6j) and right-hand side (e) of e equations for the strain of elastic joints.

        The unknowns are the wrenches of all j joints. Wrenches under which a joint is rigid do not
        follow from its strain.
        """
        system, unit, joints = self.system, self._unit, self._joints
        rows, values = [np.zeros((0, len(joints), 6))], [np.zeros(0)]
        for number, joint_anywhere in enumerate(joints):
            joint = replace(joint_anywhere, drive=drive_in(system.posture, joint_anywhere))
            directions, rotor = np.zeros((0, 6)), self.load.rotor_forces.get(joint.name, 0.0)
            if joint.compliance is not None and not rotor:
                first, second = (
                    rotation_since_reference(system.posture, side.body)
                    for side in (joint.first, joint.second)
                )
                wrench = turn(first) @ system.wrenches(joint, self.displacements[:, None])[:, 0]
                elastic = elastic_directions(joint, first, second)[0].T
                values.append(-elastic @ wrench)
                directions = elastic / unit
            elif joint.compliance is None and joint.drive is not None and joint.drive.stiffness:
                directions = free_twists(system.posture, joint)[:, :1].T / unit
                drive_rows = system.motions.springs[Portion(joint.name, "drive")]
                strain = drive_rows @ self.displacements[: system.outer]
                values.append(rotor - np.sqrt(joint.drive.stiffness) * strain)
            rows_of_joint = np.zeros((len(directions), len(joints), 6))
            rows_of_joint[:, number] = directions
            rows.append(rows_of_joint)
        return np.vstack(rows).reshape(-1, 6 * len(joints)), np.concatenate(values)
