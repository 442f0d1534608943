"""Deflections and frequencies of any mechanism of prisms and rigid bodies by Ritz's method.

Input: a closed posture of a mechanism. Output: the 6×6 compliance at the loaded point and natural
frequencies, as an independent reference. Rule: legs are polynomials (`validation.cases.ritz_legs`).
Unknowns are the coefficients of the legs, the twists of the rigid bodies and the free motions of
the joints; joints are linear constraints between them, and all constraints are eliminated at once.
Body positions are those of their frames, and the gaps of the joints are checked here again. CAD
parts are not represented by polynomials: they are rigid and massless.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from scipy.linalg import block_diag, eigh, null_space, pinvh

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg
from lumped.mechanism.body import Rigid
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.model_choices import Theory
from validation.cases.ritz_legs import (
    RitzLeg,
    point_transfer,
    ritz_beam,
    ritz_compliance_leg,
    ritz_rigid_leg,
)

# Static deflections of Timoshenko beams are cubic polynomials; modes converge geometrically.
STATIC_DEGREE = 3
# Accurate to six digits for the first two modes of each bar between its joints.
DEGREE = 8
# Eigenvalues of stiffness below this fraction of the largest are idle motions.
_IDLE = 1e-15
# A joint is rigid along a compliance below this fraction of its largest. Round-off is 1e-16.
_RIGID = 1e-14
# A motion has no mass if its ratio of inertia to stiffness is below this fraction of the largest.
_MASSLESS = 1e-14
# Largest gap of a closed joint, over the size of the mechanism or in rad. Kinematics closes loops
# to 1e-12.
_CLOSED = 1e-9


def padded(block: Array, first: int, total: int) -> Array:
    """Matrix with `total` columns: zeros, with the columns of `block` placed from `first` on."""
    wide = np.zeros((len(block), total))
    wide[:, first : first + block.shape[1]] = block
    return wide


def free_basis(stiffness: Array, conditions: Array) -> Array:
    """Basis (n×k) of all vectors of n unknowns that satisfy homogeneous `conditions` (c×n).

    Each unknown is scaled by its diagonal entry of the `stiffness` (n×n), each condition to unit
    length. Without scaling, torsion of a thin wall would be lost in the round-off of its axial
    stiffness, and a small lever arm would count as zero. Shapes: c conditions, k vectors.
    """
    diagonal = np.diag(stiffness)
    # Rigid motions have no stiffness and are scaled by the softest unknown.
    softest = np.min(diagonal[diagonal > 0.0], initial=np.max(diagonal) or 1.0)
    units = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, softest))
    scaled = conditions * units
    free = null_space(scaled / np.linalg.norm(scaled, axis=1, keepdims=True))
    return np.asarray(units[:, None] * free)


@dataclass(frozen=True, eq=False)
class _System:
    """Stiffness and mass (n×n), and twist of the loaded point (6×n, base axes), in SI units.

    Shapes: n unknowns.
    """

    stiffness: Array
    mass: Array
    loaded: Array


def compliance(
    posture: Posture,
    theory: Theory = "timoshenko",
    degree: int = STATIC_DEGREE,
    *,
    given: bool = True,
) -> Array:
    """6×6 compliance (SI, base axes) at the loaded point, with prisms as beams of `theory`.

    Legs specified by a 6×6 have this compliance if `given`, otherwise they are their equivalent
    prisms. Raises ComputationError if a joint of the posture is open.
    """
    legs = {
        name: ritz_compliance_leg(shape.compliance, shape.length)
        if given and isinstance(shape, GivenLeg)
        else _beam(shape, theory, degree)
        for name, shape in _legs(posture.mechanism)
    }
    return _compliance(_system(posture, legs))


def frequencies(
    posture: Posture, count: int, theory: Theory = "timoshenko", degree: int = DEGREE
) -> Array:
    """First natural frequencies (Hz, ascending) without idle motions.

    Prisms are beams of `theory`, represented by polynomials of this `degree`.
    """
    legs = {name: _beam(shape, theory, degree) for name, shape in _legs(posture.mechanism)}
    return _frequencies(_system(posture, legs), count)


def simplified_response(posture: Posture, count: int) -> tuple[Array, Array]:
    """Compliance and frequencies with rigid massless legs on elastic drives.

    The compliance (6×6, SI, base axes) is at the loaded point. There are at most `count`
    frequencies (Hz, ascending).
    """
    legs = {name: ritz_rigid_leg(shape.length) for name, shape in _legs(posture.mechanism)}
    system = _system(posture, legs, simplified=True)
    return _compliance(system), _frequencies(system, count)


def _legs(mechanism: Mechanism) -> list[tuple[str, Leg]]:
    shapes = ((name, body.shape) for name, body in mechanism.bodies.items())
    return [
        (name, shape)
        for name, shape in shapes
        if isinstance(shape, ConstantLeg | GivenLeg | LineLeg)
    ]


def _beam(shape: Leg, theory: Theory, degree: int) -> RitzLeg:
    if isinstance(shape, GivenLeg):
        leg = equivalent_leg(GivenLeg(shape.length, shape.mass, shape.compliance))
    elif isinstance(shape, ConstantLeg):
        leg = ConstantLeg(shape.length, shape.section, shape.material)
    else:
        raise InputError(
            "Ritz's polynomials apply to straight legs of constant section only", part=shape.name
        )
    return ritz_beam(leg.properties(theory), leg.length, degree)


def _compliance(system: _System) -> Array:
    # Forces at the tool do no work on idle motions.
    elastic, _ = _elastic_and_idle(system)
    tool_motions = system.loaded @ elastic
    return np.asarray(tool_motions @ tool_motions.T)


def _frequencies(system: _System, count: int) -> Array:
    elastic, idle = _elastic_and_idle(system)
    momenta = system.mass @ elastic
    mass = elastic.T @ momenta
    if idle.shape[1]:
        # Each elastic motion is combined with idle motions so that the momentum along them is zero.
        coupling = idle.T @ momenta
        mass -= coupling.T @ pinvh(idle.T @ system.mass @ idle) @ coupling
    inverse = np.linalg.eigvalsh(mass)[::-1]
    squares = 1.0 / inverse[inverse > _MASSLESS * inverse.max(initial=0.0)][:count]
    return np.asarray(np.sqrt(squares) / (2.0 * np.pi))


def _elastic_and_idle(system: _System) -> tuple[Array, Array]:
    """Basis (n×k) in which the stiffness is a unit matrix, and idle motions (n×i).

    The i idle motions have no stiffness. Shapes: n unknowns, k + i = n.
    """
    values, vectors = eigh(system.stiffness)
    idle = values < _IDLE * len(values) * values.max(initial=0.0)
    return vectors[:, ~idle] / np.sqrt(values[~idle]), vectors[:, idle]


def _system(posture: Posture, legs: Mapping[str, RitzLeg], *, simplified: bool = False) -> _System:
    """Stiffness and mass of a mechanism, for motions that satisfy the constraints of all joints.

    `legs`: polynomials of legs by name; other bodies are rigid. If `simplified`, only drives are
    elastic.
    """
    _require_closed(posture)
    mechanism = posture.mechanism
    shapes = {name: body.shape for name, body in mechanism.bodies.items() if name != GROUND}
    joints = [_Joint.of(posture, joint, simplified=simplified) for joint in mechanism.joints]
    sizes = [legs[name].size if name in legs else 6 for name in shapes]
    sizes += [joint.motions.shape[1] for joint in joints]
    firsts = np.concatenate([[0], np.cumsum(sizes)])
    total = int(firsts[-1])
    first_of = dict(zip(shapes, firsts.tolist(), strict=False))

    def twist(side: Side, position: Array) -> Array:
        """Twist, at `position`, of the body on one side of a joint, for each unknown (6×total)."""
        if side.body == GROUND:
            return np.zeros((6, total))
        frame, first = posture.frames[side.body], first_of[side.body]
        if side.body not in legs:
            return point_transfer(position - frame.position) @ padded(np.eye(6), first, total)
        names = list(mechanism.bodies[side.body].interfaces)
        end = legs[side.body].root if side.point == names[0] else legs[side.body].tip
        rotated = block_diag(frame.rotation, frame.rotation) @ end
        offset = position - _point_position(posture, side)
        return point_transfer(offset) @ padded(rotated, first, total)

    stiffness, mass = (
        block_diag(
            *(getattr(legs[name], kind) if name in legs else np.zeros((6, 6)) for name in shapes),
            *(
                np.diag(joint.springs if kind == "stiffness" else joint.inertias)
                for joint in joints
            ),
        )
        for kind in ("stiffness", "mass")
    )
    for name, shape in shapes.items():
        if isinstance(shape, Rigid):
            frame = posture.frames[name]
            centre = twist(Side(name, ""), frame.position + frame.rotation @ shape.centre)
            inertia = frame.rotation @ shape.inertia @ frame.rotation.T
            mass += shape.mass * centre[:3].T @ centre[:3] + centre[3:].T @ inertia @ centre[3:]
    tool = Side(mechanism.tool.body, mechanism.tool.point)
    loaded = twist(tool, _point_position(posture, tool))
    mass += mechanism.tool.mass * loaded[:3].T @ loaded[:3]
    conditions = []
    for joint, first in zip(joints, firsts[len(shapes) :].tolist(), strict=False):
        opening = twist(joint.second, joint.position) - twist(joint.first, joint.position)
        conditions.append(opening - padded(joint.motions, first, total))
    free = free_basis(stiffness, np.vstack(conditions))
    return _System(free.T @ stiffness @ free, free.T @ mass @ free, loaded @ free)


@dataclass(frozen=True, eq=False)
class _Joint:
    """Relative twists that a joint allows, at its `position` (3, m).

    `motions` (6×k, base axes): k independent relative twists. `springs`, `inertias` (k each):
    stiffness against each motion, and inertia that moves with it.
    """

    first: Side
    second: Side
    position: Array
    motions: Array
    springs: Array
    inertias: Array

    @classmethod
    def of(cls, posture: Posture, joint: Joint, *, simplified: bool) -> "_Joint":
        rotation, _ = _rotations(posture, joint)
        motions, springs, inertias = [], [], []
        for number, twist in enumerate(_free_twists(posture, joint).T):
            stiffness: float | None = 0.0
            inertia = 0.0
            if joint.drive is not None and number == 0:
                special = joint.drive.simplified if simplified else None
                drive = joint.drive.at(float(posture.coordinates[joint.name][0]))
                stiffness = drive.stiffness if special is None else special
                inertia = joint.drive.inertia
            if stiffness is not None:
                motions.append(twist)
                springs.append(stiffness)
                inertias.append(inertia)
        if joint.compliance is not None and not simplified:
            # Springs along the eigenvectors of the joint's compliance. Their motions add to the
            # free ones.
            compliances, along = np.linalg.eigh(joint.compliance)
            twists = block_diag(rotation, rotation) @ along
            for value, twist in zip(compliances, twists.T, strict=True):
                if value > _RIGID * compliances[-1]:
                    motions.append(twist)
                    springs.append(1.0 / value)
                    inertias.append(0.0)
        columns = np.array(motions).reshape(len(motions), 6).T
        position = _point_position(posture, joint.first)
        return cls(
            joint.first, joint.second, position, columns, np.array(springs), np.array(inertias)
        )


def _free_twists(posture: Posture, joint: Joint) -> Array:
    """Free relative twists (6×k, base axes) for the kind of a joint.

    In a driven joint, the driven twist is the first. Shapes: k twists.
    """
    first, second = _rotations(posture, joint)
    axes = joint.axes @ first.T
    along, about = (
        np.vstack([np.eye(3), np.zeros((3, 3))]),
        np.vstack([np.zeros((3, 3)), np.eye(3)]),
    )
    slide, turn = along @ axes[:1].T, about @ axes[:1].T
    match joint.kind:
        case "fixed":
            free = np.zeros((6, 0))
        case "prismatic":
            free = slide
        case "revolute":
            free = turn
        case "cylindrical":
            free = np.hstack([slide, turn])
        case "universal":
            free = about @ np.column_stack([axes[0], second @ joint.axes[1]])
        case "spherical":
            free = about
        case "planar":
            free = np.hstack([along @ null_space(axes[:1]), turn])
        case _:
            assert_never(joint.kind)
    return free


def _rotations(posture: Posture, joint: Joint) -> tuple[Array, Array]:
    """Rotation (3×3 each) of the two bodies of a joint since the reference posture."""
    first, second = (
        posture.frames[side.body].rotation @ posture.mechanism.reference[side.body].rotation.T
        for side in (joint.first, joint.second)
    )
    return first, second


def _point_position(posture: Posture, side: Side) -> Array:
    frame = posture.frames[side.body]
    local = posture.mechanism.bodies[side.body].interfaces[side.point].position
    return np.asarray(frame.position + frame.rotation @ local)


def _require_closed(posture: Posture) -> None:
    """Raise ComputationError if the sides of a joint are apart in a direction that is not free."""
    for joint in posture.mechanism.joints:
        if (gap := max(_joint_gaps(posture, joint))) > _CLOSED:
            raise ComputationError(
                f"joint {joint.name}: the two sides of the joint are {gap:.2g} apart (relative "
                "to the robot's size, or rad); they must coincide"
            )


def _joint_gaps(posture: Posture, joint: Joint) -> tuple[float, float]:
    """Gap of a joint in position (relative to the mechanism's size) and in direction (rad)."""
    first, second = _rotations(posture, joint)
    gap = _point_position(posture, joint.second) - _point_position(posture, joint.first)
    gap = gap / posture.mechanism.size
    axis = first @ joint.axes[0] if len(joint.axes) else np.zeros(3)
    relative = first.T @ second
    match joint.kind:
        case "prismatic" | "cylindrical":
            gap = np.cross(axis, gap)
        case "planar":
            gap = np.atleast_1d(axis @ gap)
    match joint.kind:
        case "spherical":
            angles = np.zeros(1)
        case "universal":
            angle = joint.axes[0] @ relative @ joint.axes[1] - joint.axes[0] @ joint.axes[1]
            angles = np.atleast_1d(angle)
        case "fixed" | "prismatic":
            angles = (relative - np.eye(3)).ravel()
        case "revolute" | "cylindrical" | "planar":
            angles = (relative - np.eye(3)) @ joint.axes[0]
        case _:
            assert_never(joint.kind)
    return float(np.linalg.norm(gap)), float(np.linalg.norm(angles))
