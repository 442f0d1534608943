"""Mistakes in the assembled robot, rigid segments, modes and the simplified model."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide, printed
from lumped.dense.modes import Modes
from lumped.mechanism.body import Rigid
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import turn
from lumped.system.motions import Frames, Motions
from validation.faults.fault import Faulty, fault_around, fault_in_value

_ROBOT = "lumped.biglide.mechanism"


@fault_in_value("robot.platform-twice", "Mass of the platform counted twice", _ROBOT)
def _mass_twice(mechanism: Mechanism) -> Mechanism:
    return replace(mechanism, tool=replace(mechanism.tool, mass=2.0 * mechanism.tool.mass))


@fault_in_value("robot.platform-missing", "Mass of the platform forgotten", _ROBOT)
def _without_platform(mechanism: Mechanism) -> Mechanism:
    return replace(mechanism, tool=replace(mechanism.tool, mass=0.0))


@fault_in_value(
    "robot.platform-at-joint",
    "Mass of platform and tool at B instead of at the loaded point",
    _ROBOT,
)
def _mass_at_joint(mechanism: Mechanism) -> Mechanism:
    platform = mechanism.bodies["platform"]
    heavy = replace(platform, shape=Rigid(mechanism.tool.mass))
    return _without_platform(replace(mechanism, bodies={**mechanism.bodies, "platform": heavy}))


@fault_around("robot.offset-sign", "Tool offset in the opposite direction", _ROBOT)
def _offset_turned(sound: Faulty, robot: Biglide) -> Mechanism:
    found: Mechanism = sound(replace(robot, tool_offset=-robot.tool_offset))
    return found


@fault_in_value(
    "robot.printed-release",
    "Joints released as eq. (25) is printed: row and column of φz zeroed",
    _ROBOT,
)
def _printed(mechanism: Mechanism) -> Mechanism:
    return printed(mechanism)


@fault_in_value(
    "robot.joint-forgotten",
    "Revolute joints forgotten: the leg's φz shared with its neighbour",
    _ROBOT,
)
def _held_joints(mechanism: Mechanism) -> Mechanism:
    joints = [
        replace(joint, kind="fixed", axes=np.zeros((0, 3))) if joint.kind == "revolute" else joint
        for joint in mechanism.joints
    ]
    return replace(mechanism, joints=joints)


def _with_feet(
    mechanism: Mechanism,
    change: Callable[[Array], Array],
    names: tuple[str, ...] = ("foot1", "foot2"),
) -> Mechanism:
    joints = [
        joint
        if joint.compliance is None or joint.name not in names
        else replace(joint, compliance=change(joint.compliance))
        for joint in mechanism.joints
    ]
    return replace(mechanism, joints=joints)


@fault_in_value(
    "robot.one-foot-rigid", "Foot 2 a thousand thousand times too stiff (mm for m)", _ROBOT
)
def _one_foot(mechanism: Mechanism) -> Mechanism:
    return _with_feet(mechanism, lambda foot: 1e-6 * foot, ("foot2",))


@fault_in_value("robot.foot-diagonal", "Coupling terms of the foot's compliance left out", _ROBOT)
def _foot_entrywise(mechanism: Mechanism) -> Mechanism:
    return _with_feet(mechanism, lambda foot: np.diag(np.diag(foot)))


@fault_in_value(
    "robot.foot-unsymmetrised",
    "Foot's matrix read from its upper triangle without symmetrising",
    _ROBOT,
)
def _foot_half_coupled(mechanism: Mechanism) -> Mechanism:
    return _with_feet(mechanism, np.triu)


@fault_around("robot.foot-in-leg-axes", "Feet's compliance in the axes of leg 1", _ROBOT)
def _foot_in_leg_axes(sound: Faulty, robot: Biglide) -> Mechanism:
    foot = robot.foot_compliance
    if foot is not None:
        block = turn(robot.posture(robot.centre).rotation1)
        robot = replace(robot, foot_compliance=block @ foot @ block.T)
    found: Mechanism = sound(robot)
    return found


@fault_around(
    "robot.leg-turned-back", "Rotation of the legs transposed", "lumped.system.assembly._ends"
)
def _turned_back(sound: Faulty, moved: Motions, frames: Frames, body: str) -> Array:
    back = {**frames.rotations, body: np.swapaxes(frames.rotations[body], -1, -2)}
    found: Array = sound(moved, replace(frames, rotations=back), body)
    return found


@fault_around(
    "robot.leg-one-twice", "Matrices of leg 1 used for leg 2", "lumped.system.assembly.assembly"
)
def _first_leg_twice(sound: Faulty, mechanism: Mechanism, models: Any) -> Any:
    return sound(mechanism, dict.fromkeys(models, next(iter(models.values()), None)))


@fault_around(
    "segments.literal-layout",
    "Segments without half springs at both ends",
    "lumped.models.segments.segment_chain",
)
def _literal(sound: Faulty, properties: Any, length: float, elements: int, *_: Any) -> Any:
    return sound(properties, length, max(elements, 2), "literal")


@fault_around(
    "segments.lever-at-element",
    "Springs at the centre of the next element instead of between two",
    "lumped.models.segments._spring_matrix",
)
def _element_levers(sound: Faulty, chain: Any, block: Array, rows: Any) -> SparseMatrix:
    springs = tuple(
        replace(s, position=float(chain.bodies[s.second].position)) for s in chain.springs
    )
    return sound(replace(chain, springs=springs), block, rows)


@fault_around(
    "segments.spring-missing",
    "A spring of the chain missing: two elements rigid with each other",
    "lumped.models.segments.segment_leg",
)
@fault_around(
    "segments.static-spring-missing",
    "The same in the condensed chain",
    "lumped.models.segments.static_leg",
)
def _one_spring_missing(sound: Faulty, chain: Any) -> Any:
    middle = len(chain.springs) // 2
    stiff = replace(chain.springs[middle], stiffness=1e6 * chain.springs[middle].stiffness)
    springs = (*chain.springs[:middle], stiff, *chain.springs[middle + 1 :])
    return sound(replace(chain, springs=springs))


@fault_around(
    "segments.point-masses",
    "Elements without the inertia m l²/12 of their own length",
    "lumped.models.segments._element_mass",
)
def _without_slender(sound: Faulty, properties: Any, piece: float) -> Array:
    mass: Array = sound(properties, piece).copy()
    mass[4, 4], mass[5, 5] = properties.rho_Iy * piece, properties.rho_Iz * piece
    return mass


@fault_around(
    "segments.no-rotary-inertia",
    "Elements without the section's rotary inertia",
    "lumped.models.segments._element_mass",
)
def _without_rotary(sound: Faulty, properties: Any, piece: float) -> Array:
    found: Array = sound(replace(properties, rho_Iy=0.0, rho_Iz=0.0), piece)
    return found


@fault_in_value(
    "modes.angular-frequency", "Frequencies in rad/s for Hz", "lumped.dense.modes.solve_modes"
)
@fault_in_value(
    "robot.angular-frequency",
    "Frequencies of the robot in rad/s for Hz",
    "lumped.system.solution.modes",
)
def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


@fault_in_value(
    "simplified.inverse-jacobian",
    "Simplified model: J⁻¹ for J",
    "lumped.models.simplified.jacobian",
)
def _inverse_jacobian(jacobian: Array) -> Array:
    return np.asarray(np.linalg.pinv(jacobian))


fault_in_value(
    "simplified.transposed-jacobian",
    "Simplified model: JᵀK⁻¹J for JK⁻¹Jᵀ",
    "lumped.models.simplified.jacobian",
)(lambda J: np.swapaxes(J, -1, -2))
fault_around(
    "simplified.drives-in-parallel",
    "Simplified model: stiffness of both drives for each",
    "lumped.models.simplified.drive_compliance",
)(lambda sound, J, K: sound(J, 2.0 * K))
fault_in_value(
    "simplified.angular-frequency",
    "Simplified model: 2π forgotten",
    "lumped.models.simplified.natural_frequencies",
)(lambda frequencies: 2.0 * np.pi * frequencies)
