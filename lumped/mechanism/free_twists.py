"""Which relative twists a joint leaves free in a posture, and where its two sides are."""

from typing import assert_never

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.mechanism import Posture


def interface_position(posture: Posture, side: Side) -> Array:
    """Where the interface of one side of a joint is (3, m, base axes)."""
    frame = posture.frames[side.body]
    interface = posture.mechanism.bodies[side.body].interfaces[side.point]
    return frame.position + frame.rotation @ interface.position


def turned_since_reference(posture: Posture, body: str) -> Array:
    """Rotation (3×3) of `body` from the reference posture, base axes."""
    rotation: Array = posture.frames[body].rotation @ posture.mechanism.reference[body].rotation.T
    return rotation


def free_twists(posture: Posture, joint: Joint) -> Array:
    """Free twists of the second side relative to the first (6×k), at the first side's interface.

    Base axes, as `twists_left_free` has them.
    """
    first, second = (
        turned_since_reference(posture, side.body) for side in (joint.first, joint.second)
    )
    return twists_left_free(joint, first, second)


def twists_left_free(joint: Joint, first: Array, second: Array) -> Array:
    """Free twists (…×6×k) with both bodies turned by rotations (…×3×3) since the reference.

    Base axes, unit rates of the joint's coordinates (m, rad), in their order: prismatic (a; 0),
    revolute (0; a), cylindrical both, universal (0; a₁) and (0; a₂) with a₁ fixed in the first
    body and a₂ in the second, spherical all rotations about the base axes, planar two translations
    across the normal and the rotation about it.
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
    """Two unit vectors (2×3) across `normal` and each other, right-handed with it."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])
