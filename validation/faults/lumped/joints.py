"""Mistakes in postures, lever arms, the family of robots and virtual joints."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, Places
from lumped.models.chains import Chain, ChainJoint, Element, Fixed, VirtualSpring
from lumped.screws import rotation_z, shift
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


def _posture_with(**changes: Any) -> Any:
    def change(posture: Places) -> Places:
        return replace(posture, **{name: value(posture) for name, value in changes.items()})

    return change


@fault_around(
    "family.distance-scaled",
    "α scales the distance of the slides: the stroke does not stay the same",
    "lumped.biglide.scaled",
)
def _scaled_distance(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    return replace(member, a=alpha * robot.a)


@fault_around("family.feet-scaled", "α scales the compliance of the feet", "lumped.biglide.scaled")
def _softer_feet(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    foot = robot.foot_compliance
    return member if foot is None else replace(member, foot_compliance=alpha * foot)


@fault_around("family.one-leg-scaled", "α scales leg 1 alone", "lumped.biglide.scaled")
def _one_leg_scaled(sound: Faulty, robot: Biglide, alpha: float, by: str = "stiffness") -> Biglide:
    member: Biglide = sound(robot, alpha, by)
    return replace(member, leg2=replace(member.leg2, length=member.leg2.length / alpha))


def _held(element: Element) -> Element:
    return replace(element, drive="actuated") if isinstance(element, ChainJoint) else element


@fault_in_value(
    "vjm.tip-joint-forgotten",
    "Virtual joints: passive joint at B forgotten",
    "lumped.models.vjm.biglide_chains",
)
def _without_tip_joint(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    first, second = chains
    tip = max(i for i, element in enumerate(second) if isinstance(element, ChainJoint))
    return first, (*second[:tip], _held(second[tip]), *second[tip + 1 :])


@fault_in_value(
    "vjm.root-joints-forgotten",
    "Virtual joints: passive joints at A and C forgotten",
    "lumped.models.vjm._leg",
)
def _without_root_joints(chain: Chain) -> Chain:
    return (_held(chain[0]), *chain[1:])


@fault_in_value(
    "vjm.spring-at-root", "Virtual joints: the leg's spring at its root", "lumped.models.vjm._leg"
)
def _spring_at_root(chain: Chain) -> Chain:
    joint, beam, spring = chain
    return joint, spring, beam


@fault_in_value(
    "vjm.half-lever",
    "Virtual joints: the leg's spring with a lever arm of L/2",
    "lumped.models.vjm._leg",
)
def _half_lever(chain: Chain) -> Chain:
    joint, beam, spring = chain
    ahead = Fixed(0.5 * beam.translation) if isinstance(beam, Fixed) else beam
    return joint, ahead, spring, ahead


@fault_in_value(
    "vjm.foot-in-leg-axes",
    "Virtual joints: the foot's compliance in leg axes",
    "lumped.models.vjm.biglide_chains",
)
def _foot_behind_joint(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    """The foot's spring turns with the leg."""

    def turned(chain: Chain) -> Chain:
        places = [i for i, element in enumerate(chain) if isinstance(element, VirtualSpring)]
        if len(places) < 2:
            return chain
        foot = places[0]
        return (*chain[:foot], chain[foot + 1], chain[foot], *chain[foot + 2 :])

    return turned(chains[0]), turned(chains[1])


@fault_in_value(
    "vjm.degrees", "Virtual joints: joint angles in degrees", "lumped.models.vjm.biglide_chains"
)
def _degrees(chains: tuple[Chain, Chain]) -> tuple[Chain, Chain]:
    def turned(element: Element) -> Element:
        if isinstance(element, ChainJoint) and element.kind == "revolute":
            return replace(element, coordinate=float(np.degrees(element.coordinate)))
        return element

    first, second = (tuple(turned(element) for element in chain) for chain in chains)
    return first, second


@fault(
    "vjm.lever-sign",
    "Virtual joints: Jacobians with lever arms from the end point to the joints",
    "lumped.models.chains._at_end",
)
def _opposite_levers(screws: list[tuple[Array, Array]], end: Array) -> Array:
    moved = [shift(point - end) @ twists for point, twists in screws]
    return np.hstack([np.zeros((6, 0)), *moved])


@fault_around(
    "vjm.chains-in-series",
    "Virtual joints: compliances of the chains added, eq. (9) for stiffness",
    "lumped.models.vjm.robot_stiffness",
)
def _series(sound: Faulty, chains: Sequence[Chain]) -> Array:
    flexibility = sum(np.linalg.pinv(sound([chain])) for chain in chains)
    return np.asarray(np.linalg.pinv(flexibility))


@fault_around(
    "vjm.tool-spring-forgotten",
    "Virtual joints: the tool's compliance left out",
    "lumped.models.vjm.compliance",
)
def _no_tool_spring(sound: Faulty, robot: Biglide, x: float, springs: Any) -> Array:
    found: Array = sound(replace(robot, tool_compliance=None), x, springs)
    return found


@fault_around(
    "vjm.legs-exchanged",
    "Virtual joints: springs of the two legs exchanged",
    "lumped.models.vjm.biglide_chains",
)
def _other_spring_first(sound: Faulty, robot: Biglide, x: float, springs: Any) -> Any:
    return sound(robot, x, springs[::-1])


@fault(
    "screws.shift-sign",
    "Sign of the lever arm turned in the shift of twists",
    "lumped.screws.shift",
)
def _shifted_back(offset: Array) -> Array:
    return np.asarray(np.linalg.inv(shift(offset)))


fault_in_value(
    "posture.wrong-leg",
    "Height of leg 2 computed with the length of leg 1",
    "lumped.biglide.Biglide.posture",
)(
    _posture_with(
        root2=lambda p: np.array([p.root2[0], -p.s1, 0.0]),
        rotation2=lambda p: rotation_z(float(np.arctan2(p.s1, p.x - p.root2[0]))),
    )
)
fault_in_value(
    "posture.mirrored-leg",
    "Leg 2 on the other side of the slides",
    "lumped.biglide.Biglide.posture",
)(
    _posture_with(
        root2=lambda p: p.root2 * np.array([1.0, -1.0, 1.0]),
        rotation2=lambda p: p.rotation2.T,
    )
)
fault_in_value(
    "posture.complement",
    "Angle of leg 1 measured from y instead of x",
    "lumped.biglide.Biglide.posture",
)(_posture_with(rotation1=lambda p: rotation_z(float(np.arctan2(p.x, p.s1)))))
fault_around(
    "screws.degrees", "Degrees for radians in the rotation about z", "lumped.screws.rotation_z"
)(lambda sound, angle: sound(float(np.degrees(angle))))
fault(
    "screws.stiffness-for-compliance",
    "A compliance moved to another point as if it were a stiffness",
    "lumped.screws.move_compliance",
)(lambda c, offset: shift(offset).T @ c @ shift(offset))
fault_around(
    "vjm.foot-locked",
    "Virtual joints: the feet's springs left out",
    "lumped.models.vjm._slide_and_foot",
)(lambda s, robot, *rest: s(replace(robot, foot_compliance=None), *rest))
