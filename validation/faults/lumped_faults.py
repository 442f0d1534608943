"""Mistakes in postures, virtual joints, rigid segments, the assembled robot and its modes."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide, Posture
from lumped.chains import Chain, Element, Fixed, Joint, Spring
from lumped.leg_matrices import LegMatrices
from lumped.mechanism import Mechanism
from lumped.modes import Modes
from lumped.screws import rotation_z, shift
from validation.faults.fault import Fault, Faulty, around, instead, result


def _posture_with(**changes: Any) -> Any:
    def change(posture: Posture) -> Posture:
        return replace(posture, **{name: value(posture) for name, value in changes.items()})

    return result(change)


def _scaled_distance(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    return replace(member, a=alpha * robot.a)


def _softer_feet(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    foot = robot.foot_compliance
    return member if foot is None else replace(member, foot_compliance=alpha * foot)


def _one_leg_scaled(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    return replace(member, leg2=replace(member.leg2, length=member.leg2.length / alpha))


def _held(element: Element) -> Element:
    return replace(element, drive="actuated") if isinstance(element, Joint) else element


def _without_tip_joint(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    first, second = chains
    tip = max(i for i, element in enumerate(second) if isinstance(element, Joint))
    return first, (*second[:tip], _held(second[tip]), *second[tip + 1 :])


def _without_root_joints(chain: Chain) -> Chain:
    return (_held(chain[0]), *chain[1:])


def _spring_at_root(chain: Chain) -> Chain:
    joint, beam, spring = chain
    return joint, spring, beam


def _half_lever(chain: Chain) -> Chain:
    joint, beam, spring = chain
    ahead = Fixed(0.5 * beam.translation) if isinstance(beam, Fixed) else beam
    return joint, ahead, spring, ahead


def _foot_behind_joint(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    """The foot's spring turns with the leg."""

    def turned(chain: Chain) -> Chain:
        places = [i for i, element in enumerate(chain) if isinstance(element, Spring)]
        if len(places) < 2:
            return chain
        foot = places[0]
        return (*chain[:foot], chain[foot + 1], chain[foot], *chain[foot + 2 :])

    return turned(chains[0]), turned(chains[1])


def _degrees(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    def turned(element: Element) -> Element:
        if isinstance(element, Joint) and element.kind == "revolute":
            return replace(element, coordinate=float(np.degrees(element.coordinate)))
        return element

    first, second = (tuple(turned(element) for element in chain) for chain in chains)
    return first, second


def _opposite_levers(screws: list[tuple[Array, Array]], end: Array) -> Array:
    moved = [shift(point - end) @ twists for point, twists in screws]
    return np.hstack([np.zeros((6, 0)), *moved])


def _series(sound: Faulty, chains: Sequence[Chain]) -> Array:
    flexibility = sum(np.linalg.pinv(sound([chain])) for chain in chains)
    return np.asarray(np.linalg.pinv(flexibility))


def _no_tool_spring(sound: Faulty, robot: Biglide, x: float, springs: Any) -> Array:
    found: Array = sound(replace(robot, tool_compliance=None), x, springs)
    return found


def _other_spring_first(sound: Faulty, robot: Biglide, x: float, springs: Any) -> Any:
    return sound(robot, x, springs[::-1])


def _mass_twice(sound: Faulty, robot: Biglide, *rest: Any) -> Mechanism:
    whole: Mechanism = sound(robot, *rest)
    platform = csr_matrix(np.diag([robot.platform_mass] * 3 + [0.0] * 3))
    return replace(whole, mass=whole.mass + whole.loaded.T @ platform @ whole.loaded)


def _mass_at_joint(
    sound: Faulty, robot: Biglide, x: float, leg1: LegMatrices, leg2: LegMatrices, *rest: Any
) -> Mechanism:
    whole: Mechanism = sound(robot, x, leg1, leg2, *rest)
    at_joint: Mechanism = sound(replace(robot, tool_offset=np.zeros(3)), x, leg1, leg2, *rest)
    return replace(whole, mass=at_joint.mass)


def _offset_turned(sound: Faulty, robot: Biglide, unknowns: Any) -> SparseMatrix:
    return sound(replace(robot, tool_offset=-robot.tool_offset), unknowns)


def _printed(sound: Faulty, robot: Biglide, x: float, leg1: Any, leg2: Any, *_: Any) -> Mechanism:
    found: Mechanism = sound(robot, x, leg1, leg2, "printed")
    return found


def _one_foot(springs: dict[str, SparseMatrix]) -> dict[str, SparseMatrix]:
    return springs | {"foot 2": 1e6 * springs["foot 1"]} if "foot 1" in springs else springs


def _foot_entrywise(sound: Faulty, robot: Biglide, *rest: Any) -> dict[str, SparseMatrix]:
    foot = robot.foot_compliance
    if foot is not None:
        robot = replace(robot, foot_compliance=np.diag(np.diag(foot)))
    found: dict[str, SparseMatrix] = sound(robot, *rest)
    return found


def _foot_half_coupled(sound: Faulty, robot: Biglide, *rest: Any) -> dict[str, SparseMatrix]:
    foot = robot.foot_compliance
    if foot is not None:
        robot = replace(robot, foot_compliance=np.triu(foot))
    found: dict[str, SparseMatrix] = sound(robot, *rest)
    return found


def _foot_in_leg_axes(
    sound: Faulty, robot: Biglide, x: float, leg1: Any, leg2: Any, *rest: Any
) -> Mechanism:
    foot = robot.foot_compliance
    if foot is not None:
        block = np.kron(np.eye(2), robot.posture(x).rotation1)
        robot = replace(robot, foot_compliance=block @ foot @ block.T)
    found: Mechanism = sound(robot, x, leg1, leg2, *rest)
    return found


def _held_joint(sound: Faulty, self: Any, body: Any) -> Any:
    sound(self, body)
    return body


def _turned_back(
    sound: Faulty, leg: Any, rotation: Array, unknowns: Any, which: int
) -> SparseMatrix:
    return sound(leg, rotation.T, unknowns, which)


def _first_leg_twice(
    sound: Faulty, robot: Biglide, x: float, leg1: Any, _leg2: Any, *rest: Any
) -> Mechanism:
    found: Mechanism = sound(robot, x, leg1, leg1, *rest)
    return found


def _literal(sound: Faulty, properties: Any, length: float, elements: int, *_: Any) -> Any:
    return sound(properties, length, max(elements, 2), "literal")


def _element_levers(sound: Faulty, chain: Any, block: Array, rows: Any) -> SparseMatrix:
    springs = tuple(
        replace(s, position=float(chain.bodies[s.second].position)) for s in chain.springs
    )
    return sound(replace(chain, springs=springs), block, rows)


def _one_spring_missing(sound: Faulty, chain: Any) -> Any:
    middle = len(chain.springs) // 2
    stiff = replace(chain.springs[middle], stiffness=1e6 * chain.springs[middle].stiffness)
    springs = (*chain.springs[:middle], stiff, *chain.springs[middle + 1 :])
    return sound(replace(chain, springs=springs))


def _without_slender(sound: Faulty, properties: Any, piece: float) -> Array:
    mass: Array = sound(properties, piece).copy()
    mass[4, 4], mass[5, 5] = properties.rho_Iy * piece, properties.rho_Iz * piece
    return mass


def _without_rotary(sound: Faulty, properties: Any, piece: float) -> Array:
    found: Array = sound(replace(properties, rho_Iy=0.0, rho_Iz=0.0), piece)
    return found


def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


def _shifted_back(offset: Array) -> Array:
    return np.asarray(np.linalg.inv(shift(offset)))


def _inverse_jacobian(jacobian: Array) -> Array:
    return np.asarray(np.linalg.pinv(jacobian))


FAULTS = (
    Fault(
        "posture.wrong-leg",
        "Height of leg 2 computed with the length of leg 1",
        "lumped.biglide:Biglide.posture",
        "physics",
        _posture_with(
            root2=lambda p: np.array([p.root2[0], -p.s1, 0.0]),
            rotation2=lambda p: rotation_z(float(np.arctan2(p.s1, p.x - p.root2[0]))),
        ),
    ),
    Fault(
        "posture.mirrored-leg",
        "Leg 2 on the other side of the slides",
        "lumped.biglide:Biglide.posture",
        "physics",
        _posture_with(
            root2=lambda p: p.root2 * np.array([1.0, -1.0, 1.0]),
            rotation2=lambda p: p.rotation2.T,
        ),
    ),
    Fault(
        "posture.complement",
        "Angle of leg 1 measured from y instead of x",
        "lumped.biglide:Biglide.posture",
        "physics",
        _posture_with(rotation1=lambda p: rotation_z(float(np.arctan2(p.x, p.s1)))),
    ),
    Fault(
        "screws.degrees",
        "Degrees for radians in the rotation about z",
        "lumped.screws:rotation_z",
        "physics",
        around(lambda sound, angle: sound(float(np.degrees(angle)))),
    ),
    Fault(
        "screws.shift-sign",
        "Sign of the lever arm turned in the shift of twists",
        "lumped.screws:shift",
        "physics",
        instead(_shifted_back),
    ),
    Fault(
        "screws.stiffness-for-compliance",
        "A compliance moved to another point as if it were a stiffness",
        "lumped.screws:move_compliance",
        "physics",
        instead(lambda c, offset: shift(offset).T @ c @ shift(offset)),
    ),
    Fault(
        "family.distance-scaled",
        "α scales the distance of the slides: the stroke does not stay the same",
        "lumped.biglide:scaled",
        "physics",
        around(_scaled_distance),
    ),
    Fault(
        "family.feet-scaled",
        "α scales the compliance of the feet",
        "lumped.biglide:scaled",
        "physics",
        around(_softer_feet),
    ),
    Fault(
        "family.one-leg-scaled",
        "α scales leg 1 alone",
        "lumped.biglide:scaled",
        "physics",
        around(_one_leg_scaled),
    ),
    Fault(
        "vjm.tip-joint-forgotten",
        "Virtual joints: passive joint at B forgotten",
        "lumped.vjm:biglide_chains",
        "physics",
        result(_without_tip_joint),
    ),
    Fault(
        "vjm.root-joints-forgotten",
        "Virtual joints: passive joints at A and C forgotten",
        "lumped.vjm:_leg",
        "physics",
        result(_without_root_joints),
    ),
    Fault(
        "vjm.spring-at-root",
        "Virtual joints: the leg's spring at its root",
        "lumped.vjm:_leg",
        "physics",
        result(_spring_at_root),
    ),
    Fault(
        "vjm.half-lever",
        "Virtual joints: the leg's spring with a lever arm of L/2",
        "lumped.vjm:_leg",
        "physics",
        result(_half_lever),
    ),
    Fault(
        "vjm.foot-in-leg-axes",
        "Virtual joints: the foot's compliance in leg axes",
        "lumped.vjm:biglide_chains",
        "physics",
        result(_foot_behind_joint),
    ),
    Fault(
        "vjm.degrees",
        "Virtual joints: joint angles in degrees",
        "lumped.vjm:biglide_chains",
        "physics",
        result(_degrees),
    ),
    Fault(
        "vjm.lever-sign",
        "Virtual joints: Jacobians with lever arms from the end point to the joints",
        "lumped.chains:_at_end",
        "physics",
        instead(_opposite_levers),
    ),
    Fault(
        "vjm.chains-in-series",
        "Virtual joints: compliances of the chains added, eq. (9) for stiffness",
        "lumped.vjm:robot_stiffness",
        "physics",
        around(_series),
    ),
    Fault(
        "vjm.tool-spring-forgotten",
        "Virtual joints: the tool's compliance left out",
        "lumped.vjm:compliance",
        "physics",
        around(_no_tool_spring),
    ),
    Fault(
        "vjm.legs-exchanged",
        "Virtual joints: springs of the two legs exchanged",
        "lumped.vjm:biglide_chains",
        "data",
        around(_other_spring_first),
    ),
    Fault(
        "vjm.foot-locked",
        "Virtual joints: the feet's springs left out",
        "lumped.vjm:_slide_and_foot",
        "physics",
        around(lambda s, robot, *rest: s(replace(robot, foot_compliance=None), *rest)),
    ),
    Fault(
        "robot.platform-twice",
        "Mass of the platform counted twice",
        "lumped.mechanism:assemble",
        "physics",
        around(_mass_twice),
    ),
    Fault(
        "robot.platform-at-joint",
        "Mass of platform and tool at B instead of at the loaded point",
        "lumped.mechanism:assemble",
        "physics",
        around(_mass_at_joint),
    ),
    Fault(
        "robot.offset-sign",
        "Tool offset in the opposite direction",
        "lumped.mechanism:_loaded",
        "physics",
        around(_offset_turned),
    ),
    Fault(
        "robot.printed-release",
        "Joints released as eq. (25) is printed: row and column of φz zeroed",
        "lumped.mechanism:assemble",
        "physics",
        around(_printed),
    ),
    Fault(
        "robot.joint-forgotten",
        "Revolute joints forgotten: the leg's φz shared with its neighbour",
        "lumped.mechanism:_Unknowns._released",
        "physics",
        around(_held_joint),
    ),
    Fault(
        "robot.foot-in-leg-axes",
        "Feet's compliance in the axes of leg 1",
        "lumped.mechanism:assemble",
        "physics",
        around(_foot_in_leg_axes),
    ),
    Fault(
        "robot.foot-diagonal",
        "Coupling terms of the foot's compliance left out",
        "lumped.mechanism:_springs",
        "data",
        around(_foot_entrywise),
    ),
    Fault(
        "robot.foot-unsymmetrised",
        "Foot's matrix read from its upper triangle without symmetrising",
        "lumped.mechanism:_springs",
        "data",
        around(_foot_half_coupled),
    ),
    Fault(
        "robot.one-foot-rigid",
        "Foot 2 a thousand thousand times too stiff (mm for m)",
        "lumped.mechanism:_springs",
        "data",
        result(_one_foot),
    ),
    Fault(
        "robot.leg-turned-back",
        "Rotation of the legs transposed",
        "lumped.mechanism:_leg_map",
        "physics",
        around(_turned_back),
    ),
    Fault(
        "robot.leg-one-twice",
        "Matrices of leg 1 used for leg 2",
        "lumped.mechanism:assemble",
        "data",
        around(_first_leg_twice),
    ),
    Fault(
        "segments.literal-layout",
        "Segments without half springs at both ends",
        "lumped.segments:segment_chain",
        "physics",
        around(_literal),
    ),
    Fault(
        "segments.lever-at-element",
        "Springs at the centre of the next element instead of between two",
        "lumped.segments:_spring_matrix",
        "physics",
        around(_element_levers),
    ),
    Fault(
        "segments.spring-missing",
        "A spring of the chain missing: two elements rigid with each other",
        "lumped.segments:segment_leg",
        "numerics",
        around(_one_spring_missing),
    ),
    Fault(
        "segments.static-spring-missing",
        "The same in the condensed chain",
        "lumped.segments:static_leg",
        "numerics",
        around(_one_spring_missing),
    ),
    Fault(
        "segments.point-masses",
        "Elements without the inertia m l²/12 of their own length",
        "lumped.segments:_element_mass",
        "physics",
        around(_without_slender),
    ),
    Fault(
        "segments.no-rotary-inertia",
        "Elements without the section's rotary inertia",
        "lumped.segments:_element_mass",
        "physics",
        around(_without_rotary),
    ),
    Fault(
        "modes.angular-frequency",
        "Frequencies in rad/s for Hz",
        "lumped.modes:solve_modes",
        "physics",
        result(_angular),
    ),
    Fault(
        "simplified.inverse-jacobian",
        "Simplified model: J⁻¹ for J",
        "lumped.simplified:jacobian",
        "physics",
        result(_inverse_jacobian),
    ),
    Fault(
        "simplified.transposed-jacobian",
        "Simplified model: JᵀK⁻¹J for JK⁻¹Jᵀ",
        "lumped.simplified:jacobian",
        "physics",
        result(lambda J: np.swapaxes(J, -1, -2)),
    ),
    Fault(
        "simplified.drives-in-parallel",
        "Simplified model: stiffness of both drives for each",
        "lumped.simplified:drive_compliance",
        "physics",
        around(lambda sound, J, K: sound(J, 2.0 * K)),
    ),
    Fault(
        "simplified.angular-frequency",
        "Simplified model: 2π forgotten",
        "lumped.simplified:natural_frequencies",
        "physics",
        result(lambda frequencies: 2.0 * np.pi * frequencies),
    ),
)
