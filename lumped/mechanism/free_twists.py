"""Free relative twists of a joint, its constraints, and its coordinates if it is closed.

A joint is described by the position and rotation of its second interface relative to its first.
Vectors fixed to a body are given in base axes of the reference posture. The *turn* (3×3) of a body
is the rotation from the reference posture to the current one. If the two bodies have the turns R₁
and R₂, and the interfaces are at P₁ and P₂, the second interface has the position p = R₁ᵀ(P₂ − P₁)
and the rotation R = R₁ᵀR₂ relative to the first body. Each constraint has one of two forms,

    n·p = 0            n fixed in the first body,
    b·R c = b·c        b fixed in the first body, c in the second.

All constraints hold exactly if the joint is closed, for rotations of any size. Their derivatives
are screws.
"""

from typing import assert_never

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.joint import FREEDOMS, Drive, Joint, Side
from lumped.mechanism.mechanism import Posture
from lumped.screws import rotation_about, rotation_vector, skew


def interface_position(posture: Posture, side: Side) -> Array:
    """Position (3, in m, base axes) of the interface on one side of a joint."""
    frame = posture.frames[side.body]
    interface = posture.mechanism.bodies[side.body].interfaces[side.point]
    return frame.position + frame.rotation @ interface.position


def rotation_since_reference(posture: Posture, body: str) -> Array:
    """Rotation (3×3, base axes) of `body` from the reference posture to `posture`."""
    rotation: Array = posture.frames[body].rotation @ posture.mechanism.reference[body].rotation.T
    return rotation


def drive_in(posture: Posture, joint: Joint) -> Drive | None:
    """Drive of a joint with its stiffness in a posture. None if the joint has no drive."""
    if joint.drive is None or joint.drive.screw is None:
        return joint.drive
    return joint.drive.at(float(posture.coordinates[joint.name][0]))


def free_twists(posture: Posture, joint: Joint) -> Array:
    """Free twists (6×k, base axes) of the second interface of a joint relative to the first.

    The twists are taken at the first interface, in the order that `joint_twists` describes.
    """
    first, second = (
        rotation_since_reference(posture, side.body) for side in (joint.first, joint.second)
    )
    return joint_twists(joint, first, second)


def joint_twists(joint: Joint, first: Array, second: Array) -> Array:
    """Free twists (…×6×k, base axes) of a joint whose bodies have turned by `first` and `second`.

    `first` and `second` (…×3×3) are rotations from the reference posture. Each twist (translation;
    rotation) is that of a unit rate of one coordinate of the joint (m or rad). With the axis a, a
    prismatic joint has (a; 0), a revolute joint (0; a), and a cylindrical joint both in this order.
    A universal joint has (0; a₁) and (0; a₂), with a₁ fixed in the first body and a₂ in the second.
    A spherical joint has the rotations about the three base axes. A planar joint has two
    translations perpendicular to its normal, then the rotation about the normal.
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
    """Axes of the free translations and of the free rotations of a joint.

    Both arrays are n×3, in base axes of the reference posture.
    """
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
    """Two perpendicular unit vectors (2×3) that form a right-handed system with `normal`."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])


def constraints(joint: Joint) -> tuple[Array, Array, Array]:
    """Unit vectors n (t×3), b and c (r×3 each) of the constraints of a joint.

    The t constraints n·p = 0 on the position and the r constraints b·R c = b·c on the rotation are
    explained in the module docstring. t + r is six minus the number of free twists.
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
    # Two axes of rotation must remain perpendicular. Three impose no constraint on the rotation.
    rotation_pairs = turns if len(turns) == 2 else turns[:0]
    return normals, rotation_pairs[:1], rotation_pairs[1:]


def coordinates(joint: Joint, p: Array, R: Array) -> Array:
    """Coordinates (f values, in m and rad) of a closed joint, with angles between −π and π.

    `p` (3, in m) is the position of the second interface relative to the first body, minus its
    value in the reference posture. `R` (3×3) is its rotation. The f coordinates have the order of
    the free twists. The coordinates of a spherical joint are its rotation vector. Those of a
    universal joint are the angles about its first and about its second axis.
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
    """Flags of the f coordinates of a joint: 1.0 for an angle about an axis, otherwise 0.0.

    Such an angle can exceed a whole turn. Lengths and components of rotation vectors have 0.0.
    """
    translations, rotations = free_axes(joint)
    flag = 0.0 if joint.kind == "spherical" else 1.0
    return np.repeat([0.0, flag], [len(translations), len(rotations)])


def axes_of_drive(joint: Joint) -> tuple[Array, Array]:
    """Unit vectors (3 each) along which and about which the drive of a joint acts.

    One of them is zero. Raises InputError if the joint does not have exactly one free twist.
    """
    if FREEDOMS[joint.kind] != 1:
        raise InputError(
            f"joint {joint.name}: a {joint.kind} joint cannot be driven; must have one free motion "
            "(revolute or prismatic)"
        )
    translations, rotations = free_axes(joint)
    return translations.sum(axis=0), rotations.sum(axis=0)


def _angle(axis: Array, start: Array, end: Array) -> float:
    """Angle (rad) of the rotation about the unit vector `axis` from `start` to `end` (3 each)."""
    across = skew(axis) @ start
    return float(np.arctan2(across @ end, (start - (axis @ start) * axis) @ end))
