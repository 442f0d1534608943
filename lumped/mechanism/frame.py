"""Frames: where something is and how it is turned."""

from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array


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
