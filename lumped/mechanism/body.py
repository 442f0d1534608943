"""Bodies of a mechanism and their frames: what they are made of, where others take hold of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.legs import Leg
from lumped.mechanism.part import Part


@dataclass(frozen=True, eq=False)
class Frame:
    """A place: `position` (3, m) of its origin and `rotation` (3×3), its axes as columns.

    Both are given in the frame that it is seen from: a body's frame in base axes, an interface's
    in the axes of its body.
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, inner: "Frame") -> "Frame":
        """A frame seen from this one, as it is seen from where this one is seen from."""
        return Frame(self.position + self.rotation @ inner.position, self.rotation @ inner.rotation)

    def inverse(self) -> "Frame":
        """Where this frame is seen from, as it is seen from this frame."""
        return Frame(-self.rotation.T @ self.position, self.rotation.T)


@dataclass(frozen=True, eq=False)
class Rigid:
    """Rigid body of `mass` (kg), `centre` (3, m) and `inertia` (3×3, kg m²) about it, body axes."""

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


Shape: TypeAlias = Leg | Part | Rigid


@dataclass(frozen=True, eq=False)
class Body:
    """A body: its shape, and its interfaces by the name of their point, in body axes.

    A leg has two interfaces, the first at the origin of the body's axes, the
    second at `length` along x; a part and a rigid body have any number.
    """

    name: str
    shape: Shape
    interfaces: Mapping[str, Frame]
