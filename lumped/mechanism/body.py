"""Bodies of a mechanism and their frames: what they are made of, where others take hold of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends, Leg, Material
from lumped.mechanism.part import Part
from lumped.sections import Section


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


@dataclass(frozen=True)
class Prism:
    """Constant section along the body's x axis over `length` (m), from its first interface.

    `ends`: whether its end faces are kept plane by what they are bolted to or may warp; None where
    nobody said so.
    """

    length: float
    section: Section
    material: Material
    ends: Ends | None = None


@dataclass(frozen=True, eq=False)
class Given:
    """Leg known by its 6×6 `compliance` at the second interface, the first clamped (SI, body axes).

    `length` (m) along the body's x axis, `mass` (kg); of where the mass lies, if known,
    `mass_centre` (m from the first interface along x) and `inertia` (3×3, kg m², body axes) about
    it.
    """

    length: float
    mass: float
    compliance: Array
    mass_centre: float | None = None
    inertia: Array | None = None


@dataclass(frozen=True, eq=False)
class Rigid:
    """Rigid body of `mass` (kg), `centre` (3, m) and `inertia` (3×3, kg m²) about it, body axes."""

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


Shape: TypeAlias = Prism | Given | Part | Rigid


def leg_shape(leg: Leg) -> Prism | Given:
    """The shape of a leg: of constant section, or known by its 6×6."""
    if isinstance(leg, ConstantLeg):
        return Prism(leg.length, leg.section, leg.material, leg.ends)
    return Given(leg.length, leg.mass, leg.compliance, leg.mass_centre, leg.inertia)


@dataclass(frozen=True, eq=False)
class Body:
    """A body: its shape, and its interfaces by the name of their point, in body axes.

    A prism and a given leg have two interfaces, the first at the origin of the body's axes, the
    second at `length` along x; a part and a rigid body have any number.
    """

    name: str
    shape: Shape
    interfaces: Mapping[str, Frame]
