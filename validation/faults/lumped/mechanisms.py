"""Mistakes in mechanisms: joints, closed loops, transports between interfaces, idle motions."""

from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body import Rigid
from lumped.mechanism.joint import FREEDOMS, Drive, Joint
from lumped.mechanism.kinematics.constraints import Constraints
from lumped.mechanism.mechanism import Posture
from lumped.screws import shift, turn_matrix
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_around(
    "joint.axes-of-reference",
    "Joints: axes left as they are in the reference posture",
    "lumped.system.joint_motion.JointMotion.turned",
)
def _not_turned(sound: Faulty, self: Any, rotation: Array) -> Any:
    return sound(self, 0.0 * rotation + np.eye(3))


@fault_around(
    "joint.slides-for-turns",
    "Joints: a revolute joint slides along its axis",
    "lumped.mechanism.free_twists.twists_left_free",
)
def _sliding(sound: Faulty, joint: Joint, first: Array, second: Array) -> Any:
    twists = sound(joint, first, second)
    return np.roll(twists, 3, axis=-2) if joint.kind == "revolute" else twists


def _with_joint(change: Any) -> Faulty:
    """What a changed joint lets happen, in place of the sound one."""
    return lambda sound, joint, *turned_and_length: sound(change(joint), *turned_and_length)


def _let_nothing(joint: Joint) -> Joint:
    """A ball joint or a passive pin that lets nothing happen."""
    passive = FREEDOMS[joint.kind] and joint.drive is None
    return replace(joint, kind="fixed", axes=np.zeros((0, 3))) if passive else joint


def _driven(factor: float) -> Any:
    def changed(joint: Joint) -> Joint:
        drive = joint.drive
        if drive is None or drive.stiffness is None:
            return joint
        return replace(joint, drive=replace(drive, stiffness=factor * drive.stiffness))

    return changed


def _diagonal(joint: Joint) -> Joint:
    give = joint.compliance
    return joint if give is None else replace(joint, compliance=np.diag(np.diag(give)))


@fault_around(
    "joint.give-zeroed",
    "Joints: released by zeroing rows of the stiffness, not by condensation",
    "lumped.system.joint_motion._condensed",
)
def _zeroed(sound: Faulty, passive: Array, gives: Array) -> Any:
    across = np.linalg.qr(passive, mode="complete")[0][..., passive.shape[-1] :]
    stiffness = np.linalg.pinv(gives @ np.swapaxes(gives, -1, -2))
    values, vectors = np.linalg.eigh(np.swapaxes(across, -1, -2) @ stiffness @ across)
    return sound(passive, across @ vectors / np.sqrt(np.maximum(values, 1e-30))[..., None, :])


@fault_around(
    "joint.give-in-second-body",
    "Joints: what they let happen turns with the second body, not with the first",
    "lumped.system.motions._allowed",
)
def _in_second(sound: Faulty, structure: Any, frames: Any, number: int) -> Any:
    joint = structure.mechanism.joints[number]
    turned = dict(frames.rotations)
    own = structure.mechanism.reference[joint.first.body].rotation
    turned[joint.first.body] = frames.since_reference(joint.second.body) @ own
    return sound(structure, replace(frames, rotations=turned), number)


@fault_in_value(
    "closure.constraint-forgotten",
    "Closure: one translation less held in each joint",
    "lumped.mechanism.kinematics.constraints.constraints",
)
def _one_less_held(found: Constraints) -> Constraints:
    return replace(found, normals=found.normals[1:])


@fault_around(
    "closure.wrong-arm",
    "Closure: the arm to every second interface a thousandth too long",
    "lumped.mechanism.kinematics.closure.Closure._gaps",
)
def _longer_arm(sound: Faulty, self: Any, placement: Any) -> Any:
    first, second, gap = sound(self, placement)
    return first, 1.001 * second, gap + 0.001 * second


@fault_in_value(
    "closure.tool-arm",
    "Closure: the pose of the tool's body taken for that of its point",
    "lumped.mechanism.kinematics.closure.Closure._tool_arm_in",
)
def _no_arm(arm: Array) -> Array:
    return 0.0 * arm


@fault_in_value(
    "closure.half-angle",
    "Closure: half the coordinates of joints",
    "lumped.mechanism.kinematics.constraints.coordinates",
)
def _half(coordinates: Array) -> Array:
    return 0.5 * coordinates


@fault_around(
    "closure.path-reversed",
    "Closure: poses on the other side of the reference posture",
    "lumped.mechanism.kinematics.postures._checked",
)
def _mirrored(sound: Faulty, closure: Any, pose: Array) -> Any:
    reference = closure.mechanism.reference_pose
    return reference - 0.1 * (sound(closure, pose) - reference)


@fault_around(
    "motions.lever-forgotten",
    "Transports: twists taken at a body's own place, without the arm to the point",
    "lumped.system.motions.Motions.at",
)
def _at_own_place(sound: Faulty, self: Any, body: str, point: str, position: Array) -> Any:
    node = self.structure.node(body, point)
    return sound(self, body, point, self.places[..., node, :] if node >= 0 else position)


@fault_around(
    "motions.lever-sign",
    "Transports: the arm to the point with the wrong sign",
    "lumped.system.motions.Motions.at",
)
def _other_way(sound: Faulty, self: Any, body: str, point: str, position: Array) -> Any:
    node = self.structure.node(body, point)
    place = self.places[..., node, :] if node >= 0 else position
    return sound(self, body, point, 2.0 * place - position)


@fault(
    "motions.loop-open",
    "Transports: joints that close loops of rigid bodies left open",
    "lumped.system.motions._closed",
)
def _left_open(motions: Any, _frames: Any, _closing: Any) -> Any:
    return motions


@fault_around(
    "system.not-turned",
    "Assembly: twists of interfaces in the axes of the reference posture",
    "lumped.system.assembly._ends",
)
def _in_reference(sound: Faulty, moved: Any, frames: Any, body: str) -> Any:
    turned = dict(frames.rotations)
    turned[body] = 0.0 * turned[body] + frames.mechanism.reference[body].rotation
    return sound(moved, replace(frames, rotations=turned), body)


@fault_in_value(
    "system.interfaces-exchanged",
    "Assembly: first and second interface of a body exchanged",
    "lumped.system.assembly._ends",
)
def _exchanged(ends: Array) -> Array:
    return np.roll(ends, 6, axis=-2)


@fault_around(
    "system.border-mass",
    "Assembly: mass that couples interfaces with the inside left out",
    "lumped.system.assembly._split",
)
def _uncoupled(sound: Faulty, model: Any, matrix: str) -> Any:
    ends, border, inside = sound(model, matrix)
    return ends, 0.0 * border if matrix == "mass" else border, inside


@fault(
    "system.centre",
    "Assembly: a rigid body's mass at the origin of its axes, not at its centre",
    "lumped.system.assembly._rigid_mass",
)
def _at_origin(shape: Rigid) -> Array:
    mass = np.diag([shape.mass] * 3 + [0.0] * 3)
    mass[3:, 3:] = shape.inertia
    return mass


@fault_in_value(
    "system.inertia-left-out",
    "Assembly: rotary inertia of rigid bodies left out",
    "lumped.system.assembly._rigid_mass",
)
def _without_inertia(mass: Array) -> Array:
    total = mass[0, 0]
    arm = mass[:3, 3:] / total if total else mass[:3, 3:]
    found = mass.copy()
    found[3:, 3:] = total * arm.T @ arm
    return np.asarray(found)


@fault_around(
    "idle.mass-kept",
    "Idle motions held: their mass moves with the others",
    "lumped.system.solution._pseudo_inverse",
)
def _held_idle(sound: Faulty, mass: Array, size: float) -> Any:
    return 0.0 * sound(mass, size)


@fault_in_value(
    "idle.one-forgotten",
    "Idle motions: the last one forgotten",
    "lumped.system.idle.idle_motions",
)
def _one_less(found: Any) -> Any:
    return replace(found, motions=found.motions[:, :-1], pinned=found.pinned)


@fault_in_value(
    "idle.counted-twice",
    "Mobility: idle motions counted twice",
    "lumped.mechanism.kinematics.mobility.mobility_at",
)
def _twice_idle(found: Any) -> Any:
    return replace(found, idle=2 * found.idle)


@fault_around(
    "links.lever",
    "Links: a leg's compliance taken a thousandth of its length beyond its tip",
    "lumped.models.links.link",
)
def _short_lever(sound: Faulty, length: float, compliance: Array) -> Any:
    moved = shift(np.array([0.001 * length, 0.0, 0.0]))
    return sound(length, moved @ compliance @ moved.T)


@fault_around(
    "chains.drive-forgotten",
    "Serial chains: drives as passive joints with springs of their own left out",
    "lumped.models.serial_chains._joint",
)
def _driven_rigid(sound: Faulty, posture: Posture, joint: Joint) -> Any:
    drive = joint.drive
    if drive is not None:
        joint = replace(joint, drive=Drive(1e6 * drive.stiffness) if drive.stiffness else drive)
    return sound(posture, joint)


@fault_around(
    "chains.not-turned",
    "Serial chains: joints in the axes of the reference posture",
    "lumped.models.serial_chains._freedoms",
)
def _reference_axes(sound: Faulty, joint: Joint, *_turned: Array) -> Any:
    return sound(joint, np.eye(3), np.eye(3))


@fault_around(
    "chains.leg-not-turned",
    "Serial chains: springs of legs in the legs' own axes",
    "lumped.models.serial_chains._chain",
)
def _legs_unturned(sound: Faulty, posture: Posture, legs: Any, path: Any) -> Any:
    back = {name: turn_matrix(one, posture.frames[name].rotation.T) for name, one in legs.items()}
    return sound(posture, back, path)


fault_around(
    "joint.passive-held",
    "Joints: passive ones let nothing happen",
    "lumped.system.joint_motion.joint_motion",
)(_with_joint(_let_nothing))
fault_around(
    "joint.drive-rigid",
    "Joints: drives without springs",
    "lumped.system.joint_motion.joint_motion",
)(_with_joint(lambda joint: replace(joint, drive=joint.drive and Drive())))
fault_around(
    "joint.drive-twice",
    "Joints: the stiffness of a drive counted twice",
    "lumped.system.joint_motion.joint_motion",
)(_with_joint(_driven(2.0)))
fault_around(
    "joint.give-left-out",
    "Joints: their own give left out",
    "lumped.system.joint_motion.joint_motion",
)(_with_joint(lambda joint: replace(joint, compliance=None)))
fault_around(
    "joint.give-diagonal",
    "Joints: couplings of their give left out",
    "lumped.system.joint_motion.joint_motion",
)(_with_joint(_diagonal))
