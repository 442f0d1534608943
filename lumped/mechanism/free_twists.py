"""Free relative twists of a joint, its constraints, and its coordinates when closed.

A joint compares its second interface with its first. Vectors fixed to a body are given in base
axes of the reference posture; the body's *turn* (3×3) rotates them to the current posture. With
turns R₁, R₂ and interfaces at P₁, P₂ the second lies at p = R₁ᵀ(P₂ − P₁), rotated by
R = R₁ᵀR₂. Each constraint has one of two forms,

    n·p = 0            n fixed in the first body,
    b·R c = b·c        b fixed in the first body, c in the second,

which hold if the joint is closed, for any rotation, and whose derivatives are screws.
"""

from typing import assert_never

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.mechanism import Posture
from lumped.screws import rotation_about, rotation_vector, skew


def interface_position(posture: Posture, side: Side) -> Array:
    """Position (3, m, base axes) of the interface of one side of a joint."""
    frame = posture.frames[side.body]
    interface = posture.mechanism.bodies[side.body].interfaces[side.point]
    return frame.position + frame.rotation @ interface.position


def rotation_since_reference(posture: Posture, body: str) -> Array:
    """Rotation (3×3) of `body` from the reference posture, base axes."""
    rotation: Array = posture.frames[body].rotation @ posture.mechanism.reference[body].rotation.T
    return rotation


def free_twists(posture: Posture, joint: Joint) -> Array:
    """Free twists of the second side relative to the first (6×k), at the first side's interface.

    Base axes, in the order of `joint_twists`.
    """
    first, second = (
        rotation_since_reference(posture, side.body) for side in (joint.first, joint.second)
    )
    return joint_twists(joint, first, second)


def joint_twists(joint: Joint, first: Array, second: Array) -> Array:
    """Free twists (…×6×k) with both bodies rotated by `first` and `second` (…×3×3).

    Rotations are counted from the reference posture. Base axes, unit rates of the joint's
    coordinates (m, rad), in their order: prismatic (a; 0), revolute (0; a), cylindrical both,
    universal (0; a₁) and (0; a₂) with a₁ fixed in the first body and a₂ in the second, spherical
    all rotations about the base axes, planar two translations across the normal and the rotation
    about it.
    """
    slides, turns = free_axes(joint)
    twists = np.zeros((*first.shape[:-2], 6, FREEDOMS[joint.kind]))
    twists[..., :3, : len(slides)] = first @ slides.T
    twists[..., 3:, len(slides) :] = first @ turns.T
    if joint.kind == "spherical":
        twists[..., 3:, :] = np.eye(3)
    if joint.kind == "universal":
        twists[..., 3:, 1] = second @ turns[1]
    return twists


def free_axes(joint: Joint) -> tuple[Array, Array]:
    """Axes (n×3, base axes of the reference posture) of free translations and free rotations."""
    none = np.zeros((0, 3))
    match joint.kind:
        case "fixed":
            return none, none
        case "spherical":
            return none, np.eye(3)
        case "prismatic":
            return joint.axes, none
        case "cylindrical":
            return joint.axes, joint.axes
        case "planar":
            return across_axis(joint.axes[0]), joint.axes
        case "revolute" | "universal":
            return none, joint.axes
        case _:
            assert_never(joint.kind)


def across_axis(normal: Array) -> Array:
    """Two orthogonal unit vectors (2×3) across `normal`, right-handed with it."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])


def constraints(joint: Joint) -> tuple[Array, Array, Array]:
    """The 6 − f constraints of a joint with f free twists: n (t×3), and b and c (r×3 each).

    All rows are unit vectors.
    """
    slides, turns = free_axes(joint)
    all_axes = np.eye(3)
    normals = all_axes
    if len(slides):
        normals = across_axis(slides[0]) if len(slides) == 1 else joint.axes
    if len(turns) == 0:
        return normals, all_axes, np.roll(all_axes, -1, axis=0)
    if len(turns) == 1:
        return normals, across_axis(turns[0]), np.vstack([turns, turns])
    # Two axes remain across each other; three leave no constraint.
    rotation_pairs = turns if len(turns) == 2 else turns[:0]
    return normals, rotation_pairs[:1], rotation_pairs[1:]


def coordinates(joint: Joint, p: Array, R: Array) -> Array:
    """Coordinates (f, m and rad) of a closed joint; angles within half a turn.

    A spherical joint's are the rotation vector, a universal joint's the angles about its first
    and then its second axis.
    """
    translations, rotations = free_axes(joint)
    match joint.kind:
        case "spherical":
            angles = rotation_vector(R)
        case "universal":
            first_axis, second_axis = joint.axes
            first_angle = _angle(first_axis, second_axis, R @ second_axis)
            remaining_rotation = rotation_about(-first_angle * first_axis) @ R
            angles = np.array(
                [first_angle, _angle(second_axis, first_axis, remaining_rotation @ first_axis)]
            )
        case _:
            # R − Rᵀ is 2 sin θ times the cross product with the axis, the trace 1 + 2 cos θ.
            double = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
            angles = np.arctan2(rotations @ double, R[0, 0] + R[1, 1] + R[2, 2] - 1.0)
    return np.concatenate([translations @ p, angles])


def whole_turn_flags(joint: Joint) -> Array:
    """1.0 for each coordinate that counts whole turns, 0.0 for lengths and rotation vectors."""
    translations, rotations = free_axes(joint)
    flag = 0.0 if joint.kind == "spherical" else 1.0
    return np.repeat([0.0, flag], [len(translations), len(rotations)])


def axes_of_drive(joint: Joint) -> tuple[Array, Array]:
    """Unit vectors (3 each, one of them zero) along and about which the drive of a joint acts.

    Raises InputError for a joint with more or less than one free twist.
    """
    if FREEDOMS[joint.kind] != 1:
        raise InputError(f"joint {joint.name}: a {joint.kind} joint has no single motion to drive")
    translations, rotations = free_axes(joint)
    return translations.sum(axis=0), rotations.sum(axis=0)


def _angle(axis: Array, start: Array, end: Array) -> float:
    """Angle (rad) about the unit vector `axis` that turns `start` into `end`."""
    across = skew(axis) @ start
    return float(np.arctan2(across @ end, (start - (axis @ start) * axis) @ end))
