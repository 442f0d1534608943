"""General serial chains of rigid links, joints and 6-DOF springs, and their Jacobians (eqs 3–7).

A chain is the tuple of its elements from the base to the loaded point, as in eq. (6). Jacobians
come from twists (product of exponentials): the screw of each joint or spring coordinate, at its
own frame in the chain's posture, moved to the end point. Springs are undeflected in that posture.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.screws import shift, skew, turn

# Rounding in a matrix of order one that was computed in double precision, with some margin.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Fixed:
    """Constant transform: `translation` (m) in the previous frame, then `rotation` (3×3)."""

    translation: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, eq=False)
class ChainJoint:
    """One-DOF joint along or about `axis` (3, its own frame, any length but zero).

    `coordinate` in m (prismatic) or rad (revolute) is its value in the posture. An actuated joint
    is held by its drive, a passive one moves freely. Raises InputError for an axis without
    direction.
    """

    kind: Literal["prismatic", "revolute"]
    axis: Array
    coordinate: float = 0.0
    drive: Literal["actuated", "passive"] = "passive"

    def __post_init__(self) -> None:
        axis = np.asarray(self.axis, dtype=float)
        length = float(np.linalg.norm(axis)) if axis.shape == (3,) else 0.0
        if not (np.isfinite(length) and length > 0.0):
            raise InputError(f"{self.kind} joint: axis = {self.axis!r} gives no direction")
        object.__setattr__(self, "axis", axis / length)

    @property
    def twist(self) -> Array:
        """Twist (6) of a unit rate of the coordinate, in the joint's frame."""
        nothing = np.zeros(3)
        parts = (self.axis, nothing) if self.kind == "prismatic" else (nothing, self.axis)
        return np.concatenate(parts)


@dataclass(frozen=True, eq=False)
class VirtualSpring:
    """Virtual 6-DOF spring: `compliance` 6×6 (SI) in its own frame, k⁻¹ of eq. (5).

    It may be singular (rigid in some directions). Raises InputError where it is not a symmetric
    6×6 matrix or has a negative eigenvalue. `name` is for messages.
    """

    compliance: Array
    name: str = "spring"

    def __post_init__(self) -> None:
        compliance = np.asarray(self.compliance, dtype=float)
        if compliance.shape != (6, 6) or not np.isfinite(compliance).all():
            raise InputError(f"{self.name}: compliance must be a finite 6×6 matrix")
        # Translations and rotations each in units of their softest direction: no units are left.
        softest = np.abs(np.diag(compliance)).reshape(2, 3).max(axis=1)
        root = np.sqrt(np.maximum(np.repeat(softest, 3), np.finfo(float).tiny))
        scaled = compliance / root[:, None] / root
        if np.abs(scaled - scaled.T).max() > _ROUNDING:
            raise InputError(f"{self.name}: compliance is not symmetric")
        if np.linalg.eigvalsh(scaled)[0] < -_ROUNDING:
            raise InputError(
                f"{self.name}: compliance has a negative eigenvalue; no elastic body has that"
            )
        object.__setattr__(self, "compliance", 0.5 * (compliance + compliance.T))


Element: TypeAlias = Fixed | ChainJoint | VirtualSpring
Chain: TypeAlias = tuple[Element, ...]


@dataclass(frozen=True, eq=False)
class ChainJacobians:
    """What eq. (3) needs of a chain, at its end point in base axes (SI).

    `end` (3, m) is the end point in base axes; `passive` Jq (6×n), `springs` Jθ (6×6m),
    `compliance` Kθ⁻¹ (6m×6m) of eq. (5), `reach` (m) the largest distance of a passive joint or a
    spring from the end point.
    """

    end: Array
    passive: Array
    springs: Array
    compliance: Array
    reach: float

    @property
    def spring_compliance(self) -> Array:
        """Sθ = Jθ Kθ⁻¹ Jθᵀ of eq. (3), 6×6."""
        S: Array = self.springs @ self.compliance @ self.springs.T
        return S


def axis_rotation(axis: Array, angle: float) -> Array:
    """3×3 rotation by `angle` (rad) about the unit vector `axis` (Rodrigues' formula)."""
    cross = skew(axis)
    rotation: Array = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return rotation


def chain_jacobians(chain: Sequence[Element]) -> ChainJacobians:
    """End point, Jq, Jθ and Kθ⁻¹ of a chain in its posture (eqs 3–7, no finite differences)."""
    position, rotation = np.zeros(3), np.eye(3)
    passive: list[tuple[Array, Array]] = []
    springs: list[tuple[Array, Array]] = []
    compliances: list[Array] = []
    for element in chain:
        match element:
            case Fixed():
                position = position + rotation @ element.translation
                rotation = rotation @ element.rotation
            case ChainJoint():
                if element.drive == "passive":
                    passive.append((position, (turn(rotation) @ element.twist)[:, None]))
                if element.kind == "prismatic":
                    position = position + element.coordinate * (rotation @ element.axis)
                else:
                    rotation = rotation @ axis_rotation(element.axis, element.coordinate)
            case VirtualSpring():
                springs.append((position, turn(rotation)))
                compliances.append(element.compliance)
    distances = [float(np.linalg.norm(position - point)) for point, _ in passive + springs]
    return ChainJacobians(
        end=position,
        passive=_at_end(passive, position),
        springs=_at_end(springs, position),
        compliance=_block_diagonal(compliances),
        reach=max(distances, default=0.0),
    )


def _at_end(screws: list[tuple[Array, Array]], end: Array) -> Array:
    """Twists (columns, base axes) given at points, moved to the end point."""
    return np.hstack([np.zeros((6, 0))] + [shift(end - point) @ twists for point, twists in screws])


def _block_diagonal(blocks: list[Array]) -> Array:
    matrix = np.zeros((6 * len(blocks), 6 * len(blocks)))
    for i, block in enumerate(blocks):
        matrix[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = block
    return matrix
