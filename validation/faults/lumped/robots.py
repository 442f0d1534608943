"""Mistakes in the assembled robot, rigid segments, modes and the simplified model."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide
from lumped.biglide_assembly import Mechanism
from lumped.leg_matrices import LegMatrices
from lumped.modes import Modes
from validation.faults.fault import Faulty, fault_around, fault_in_value


@fault_around(
    "robot.platform-twice", "Mass of the platform counted twice", "lumped.biglide_assembly.assemble"
)
def _mass_twice(sound: Faulty, robot: Biglide, *rest: Any) -> Mechanism:
    whole: Mechanism = sound(robot, *rest)
    platform = csr_matrix(np.diag([robot.platform_mass] * 3 + [0.0] * 3))
    return replace(whole, mass=whole.mass + whole.loaded.T @ platform @ whole.loaded)


@fault_around(
    "robot.platform-at-joint",
    "Mass of platform and tool at B instead of at the loaded point",
    "lumped.biglide_assembly.assemble",
)
def _mass_at_joint(
    sound: Faulty, robot: Biglide, x: float, leg1: LegMatrices, leg2: LegMatrices, *rest: Any
) -> Mechanism:
    whole: Mechanism = sound(robot, x, leg1, leg2, *rest)
    at_joint: Mechanism = sound(replace(robot, tool_offset=np.zeros(3)), x, leg1, leg2, *rest)
    return replace(whole, mass=at_joint.mass)


@fault_around(
    "robot.offset-sign", "Tool offset in the opposite direction", "lumped.biglide_assembly._loaded"
)
def _offset_turned(sound: Faulty, robot: Biglide, unknowns: Any) -> SparseMatrix:
    return sound(replace(robot, tool_offset=-robot.tool_offset), unknowns)


@fault_around(
    "robot.printed-release",
    "Joints released as eq. (25) is printed: row and column of φz zeroed",
    "lumped.biglide_assembly.assemble",
)
def _printed(sound: Faulty, robot: Biglide, x: float, leg1: Any, leg2: Any, *_: Any) -> Mechanism:
    found: Mechanism = sound(robot, x, leg1, leg2, "printed")
    return found


@fault_in_value(
    "robot.one-foot-rigid",
    "Foot 2 a thousand thousand times too stiff (mm for m)",
    "lumped.biglide_assembly._springs",
)
def _one_foot(springs: dict[str, SparseMatrix]) -> dict[str, SparseMatrix]:
    return springs | {"foot 2": 1e6 * springs["foot 1"]} if "foot 1" in springs else springs


@fault_around(
    "robot.foot-diagonal",
    "Coupling terms of the foot's compliance left out",
    "lumped.biglide_assembly._springs",
)
def _foot_entrywise(sound: Faulty, robot: Biglide, *rest: Any) -> dict[str, SparseMatrix]:
    foot = robot.foot_compliance
    if foot is not None:
        robot = replace(robot, foot_compliance=np.diag(np.diag(foot)))
    found: dict[str, SparseMatrix] = sound(robot, *rest)
    return found


@fault_around(
    "robot.foot-unsymmetrised",
    "Foot's matrix read from its upper triangle without symmetrising",
    "lumped.biglide_assembly._springs",
)
def _foot_half_coupled(sound: Faulty, robot: Biglide, *rest: Any) -> dict[str, SparseMatrix]:
    foot = robot.foot_compliance
    if foot is not None:
        robot = replace(robot, foot_compliance=np.triu(foot))
    found: dict[str, SparseMatrix] = sound(robot, *rest)
    return found


@fault_around(
    "robot.foot-in-leg-axes",
    "Feet's compliance in the axes of leg 1",
    "lumped.biglide_assembly.assemble",
)
def _foot_in_leg_axes(
    sound: Faulty, robot: Biglide, x: float, leg1: Any, leg2: Any, *rest: Any
) -> Mechanism:
    foot = robot.foot_compliance
    if foot is not None:
        block = np.kron(np.eye(2), robot.posture(x).rotation1)
        robot = replace(robot, foot_compliance=block @ foot @ block.T)
    found: Mechanism = sound(robot, x, leg1, leg2, *rest)
    return found


@fault_around(
    "robot.joint-forgotten",
    "Revolute joints forgotten: the leg's φz shared with its neighbour",
    "lumped.biglide_assembly._Unknowns._released",
)
def _held_joint(sound: Faulty, self: Any, body: Any) -> Any:
    sound(self, body)
    return body


@fault_around(
    "robot.leg-turned-back", "Rotation of the legs transposed", "lumped.biglide_assembly._leg_map"
)
def _turned_back(
    sound: Faulty, leg: Any, rotation: Array, unknowns: Any, which: int
) -> SparseMatrix:
    return sound(leg, rotation.T, unknowns, which)


@fault_around(
    "robot.leg-one-twice", "Matrices of leg 1 used for leg 2", "lumped.biglide_assembly.assemble"
)
def _first_leg_twice(
    sound: Faulty, robot: Biglide, x: float, leg1: Any, _leg2: Any, *rest: Any
) -> Mechanism:
    found: Mechanism = sound(robot, x, leg1, leg1, *rest)
    return found


@fault_around(
    "segments.literal-layout",
    "Segments without half springs at both ends",
    "lumped.segments.segment_chain",
)
def _literal(sound: Faulty, properties: Any, length: float, elements: int, *_: Any) -> Any:
    return sound(properties, length, max(elements, 2), "literal")


@fault_around(
    "segments.lever-at-element",
    "Springs at the centre of the next element instead of between two",
    "lumped.segments._spring_matrix",
)
def _element_levers(sound: Faulty, chain: Any, block: Array, rows: Any) -> SparseMatrix:
    springs = tuple(
        replace(s, position=float(chain.bodies[s.second].position)) for s in chain.springs
    )
    return sound(replace(chain, springs=springs), block, rows)


@fault_around(
    "segments.spring-missing",
    "A spring of the chain missing: two elements rigid with each other",
    "lumped.segments.segment_leg",
)
@fault_around(
    "segments.static-spring-missing",
    "The same in the condensed chain",
    "lumped.segments.static_leg",
)
def _one_spring_missing(sound: Faulty, chain: Any) -> Any:
    middle = len(chain.springs) // 2
    stiff = replace(chain.springs[middle], stiffness=1e6 * chain.springs[middle].stiffness)
    springs = (*chain.springs[:middle], stiff, *chain.springs[middle + 1 :])
    return sound(replace(chain, springs=springs))


@fault_around(
    "segments.point-masses",
    "Elements without the inertia m l²/12 of their own length",
    "lumped.segments._element_mass",
)
def _without_slender(sound: Faulty, properties: Any, piece: float) -> Array:
    mass: Array = sound(properties, piece).copy()
    mass[4, 4], mass[5, 5] = properties.rho_Iy * piece, properties.rho_Iz * piece
    return mass


@fault_around(
    "segments.no-rotary-inertia",
    "Elements without the section's rotary inertia",
    "lumped.segments._element_mass",
)
def _without_rotary(sound: Faulty, properties: Any, piece: float) -> Array:
    found: Array = sound(replace(properties, rho_Iy=0.0, rho_Iz=0.0), piece)
    return found


@fault_in_value(
    "modes.angular-frequency", "Frequencies in rad/s for Hz", "lumped.modes.solve_modes"
)
def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


@fault_in_value(
    "simplified.inverse-jacobian", "Simplified model: J⁻¹ for J", "lumped.simplified.jacobian"
)
def _inverse_jacobian(jacobian: Array) -> Array:
    return np.asarray(np.linalg.pinv(jacobian))


fault_in_value(
    "simplified.transposed-jacobian",
    "Simplified model: JᵀK⁻¹J for JK⁻¹Jᵀ",
    "lumped.simplified.jacobian",
)(lambda J: np.swapaxes(J, -1, -2))
fault_around(
    "simplified.drives-in-parallel",
    "Simplified model: stiffness of both drives for each",
    "lumped.simplified.drive_compliance",
)(lambda sound, J, K: sound(J, 2.0 * K))
fault_in_value(
    "simplified.angular-frequency",
    "Simplified model: 2π forgotten",
    "lumped.simplified.natural_frequencies",
)(lambda frequencies: 2.0 * np.pi * frequencies)
