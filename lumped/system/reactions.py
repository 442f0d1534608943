"""Forces in a loaded mechanism: on the interfaces of its bodies, and in its joints.

The stiffness of a body balances the wrenches of the joints and the load on its interfaces. The
wrenches of the joints follow from the equilibrium of all nodes, and from λ·f = 0 for the wrench λ
in a joint and each of its passive free twists f. A load that does work on an idle motion
accelerates it, and the inertia of the bodies takes part in the equilibrium (d'Alembert).

In loops of rigid bodies, equilibrium does not determine all wrenches. If the loop has springs, the
other wrenches follow from their strain. A loop without springs is statically indeterminate: any
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

    `elastic` are the forces that the stiffness of the body balances. `load` are the forces that
    represent distributed loads: gravity, inertia, loads along a leg and pressures. `inertia` is the
    mass of the body times the acceleration of idle motions. `rounding` is the half-width of the
    round-off error of `elastic`.
    """

    elastic: Array
    load: Array
    inertia: Array
    rounding: Array

    @property
    def distributed(self) -> Array:
        """Part of the elastic forces (6m) due to loads and inertia within the body."""
        return self.load - self.inertia

    @property
    def at_interfaces(self) -> Array:
        """Forces (6m) that joints, and loads at points, exert on the interfaces."""
        return self.elastic - self.distributed


@dataclass(frozen=True, eq=False)
class JointWrench:
    """Wrench of a joint on its second body, at its first interface.

    `wrench` (6) is in N and N m, base axes. In statically indeterminate loops of rigid bodies, k
    self-balanced states can be added without a change of the loads. The columns of `undetermined`
    (6×k) are the wrenches of this joint in these states. `rounding` (N) is the half-width of the
    round-off error of the forces. Multiplied by `length` (m), it is that of the moments.
    """

    joint: Joint
    wrench: Array
    undetermined: Array
    rounding: float
    length: float


@dataclass(frozen=True, eq=False)
class Reaction:
    """Wrench of a joint on its second body, at its first interface, in joint axes.

    `wrench` (6) is in N and N m. Components that statics does not determine are NaN. `half_width`
    (6) is the half-width of the numerical uncertainty of each component. `drive` is the force or
    moment of the motor along the joint's first free twist, in `drive_unit`. It includes the force
    that accelerates the rotor. None if the joint has no drive.
    """

    joint: str
    wrench: Array
    half_width: Array
    drive: float | None
    drive_unit: Literal["N", "N m"] = "N"


@dataclass(frozen=True, eq=False)
class InternalForces:
    """Forces of a system under a load: in deformable bodies by name, and in all joints.

    `displacements` (n) are the values of the system's unknowns, with idle motions locked.
    `idle_acceleration` (n) are the accelerations of the unknowns in idle motions under the load.
    """

    displacements: Array
    idle_acceleration: Array
    bodies: Mapping[str, BodyForces]
    joints: tuple[JointWrench, ...]


def joint_axes(posture: Posture, joint: Joint) -> Array:
    """Axes x, y, z (3×3, columns, base axes) of a joint in a posture.

    The axes rotate with the first body. In the reference posture, x is the axis of the joint, or
    the normal of both axes of a universal joint (`catalogue.directions`). z of a prismatic joint is
    as close as possible to the z axis of the base, or to the x axis of the base if the joint slides
    along z. The axes of fixed and spherical joints are the base axes. In other joints, z is as
    close as possible to the base axis that is most nearly normal to x.
    """
    first = rotation_since_reference(posture, joint.first.body)
    if joint.kind in {"fixed", "spherical"}:
        return first
    axes = axes_of_kind(joint.kind, joint.axes, default_up(joint.axes[0]))
    return np.asarray(first @ axes)


def reaction(posture: Posture, transmitted: JointWrench, load: Loading) -> Reaction:
    """Reaction of a joint in joint axes, and the force of its motor.

    `transmitted` is the wrench of the joint under `load`.
    """
    joint, axes = transmitted.joint, joint_axes(posture, transmitted.joint)
    drive = None
    if joint.drive is not None:
        along = free_twists(posture, joint)[:, 0]
        force = float(along @ transmitted.wrench) - load.rotor_forces.get(joint.name, 0.0)
        drive = np.nan if (np.abs(along @ transmitted.undetermined) > _DEPENDENT).any() else force
    to_axes = turn(axes).T
    unit = np.array([1.0] * 3 + [1.0 / transmitted.length] * 3)
    free = unit[:, None] * (to_axes @ transmitted.undetermined)
    open_components = np.linalg.norm(free, axis=1) > _DEPENDENT
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
    work = work_on(system, load)[:, None]
    displacements = solution.displacements(without_idle(solution, work))[:, 0]
    idle_acceleration = idle_accelerations(solution, work)[:, 0]
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
    distributed_load = _distributed_load(system, name, load)
    unknowns = system.body_unknowns(name, displacements)
    inertia = (model.mass @ system.body_unknowns(name, idle_acceleration))[:count]
    magnitudes = (abs(model.stiffness) @ np.abs(unknowns))[:count]
    return BodyForces(
        elastic=np.asarray(model.stiffness @ unknowns)[:count],
        load=distributed_load,
        inertia=inertia,
        rounding=np.finfo(float).eps * magnitudes,
    )


def _distributed_load(system: System, body: str, load: Loading) -> Array:
    """Forces (6m, body axes) on the m interfaces of a body that represent distributed loads.

    Distributed loads are gravity, inertia, loads along a leg and pressures.
    """
    points = list(system.posture.mechanism.bodies[body].interfaces)
    wrenches = np.zeros((len(points), 6))
    for applied in load.body_wrenches:
        if applied.body == body:
            wrenches[points.index(applied.point)] += applied.wrench
    return np.asarray((wrenches @ turn(system.posture.frames[body].rotation)).ravel())


@dataclass(frozen=True, eq=False)
class _Equilibrium:
    """Linear equations for the wrenches of all joints, and their solution.

    Moments are divided by the size of the mechanism, so that all components are in N. Wrenches are
    those of joints on their second bodies, at their first interfaces, in base axes.
    `displacements`, `bodies` and `idle_acceleration` are those of `InternalForces`.
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

        If these conditions do not determine all wrenches, those of elastic joints follow from their
        strain, and those of rigid joints are the smallest possible ones.
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
        """Resultant wrenches (N×6, base axes) that the joints must exert on each of N nodes.

        They are the elastic and inertia forces of the bodies minus the loads.
        """
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
        """Matrix (e×6j) and right-hand side (e) of e equations from the strain of elastic joints.

        The unknowns are the wrenches of all j joints. There are no equations for components under
        which a joint is rigid, because its strain does not depend on them.
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
