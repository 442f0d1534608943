"""Doubly symmetric cross-sections of prismatic legs and their textbook constants.

A section lies in the leg's y–z plane, with the width along y, the height along z and the centroid
at the origin. Iy = ∫z² dA is for bending in the x–z plane of the leg, Iz = ∫y² dA for bending in
its x–y plane. Torsion constants and shear coefficients are closed forms. The torsion constants of
rectangle (a series), circle and tube are exact. Hollow rectangle and I-section have formulas for
thin walls; `fem.sections.section_constants` computes their constants without this assumption. The
shear coefficients are those of Cowper, J. Appl. Mech. 33 (1966) 335.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from math import pi, tanh
from typing import ClassVar

import numpy as np

from lumped.arrays import Array


@dataclass(frozen=True)
class Section(ABC):
    """Base class of all section shapes. The fields of a shape are its dimensions (m)."""

    shape: ClassVar[str]

    @property
    @abstractmethod
    def area(self) -> float:
        """Area A (m²) of the section."""

    @property
    @abstractmethod
    def second_moment_y(self) -> float:
        """Iy = ∫z² dA (m⁴)."""

    @property
    @abstractmethod
    def second_moment_z(self) -> float:
        """Iz = ∫y² dA (m⁴)."""

    @property
    @abstractmethod
    def torsion_constant(self) -> float:
        """Saint-Venant's torsion constant J (m⁴)."""

    @property
    @abstractmethod
    def extent(self) -> tuple[float, float]:
        """Size (m) of the bounding box along y and along z."""

    @abstractmethod
    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        """Shear coefficients κ for shear along y and along z at Poisson's ratio `nu`."""

    @property
    def has_outline(self) -> bool:
        """True if the outline is known, so that the section can be meshed."""
        return True

    @property
    def is_uniform(self) -> bool:
        """True if the section has one material, False if its parts have materials of their own."""
        return True

    @property
    def is_doubly_symmetric(self) -> bool:
        """True if the shape is symmetric about y and about z for all dimensions."""
        return True

    @property
    def product_moment(self) -> float:
        """Iyz = ∫yz dA (m⁴) about the centroid. 0 if y or z is an axis of symmetry."""
        return 0.0

    @property
    def shear_centre(self) -> tuple[float, float]:
        """Position (y, z, m) of the shear centre relative to the centroid.

        0 in doubly symmetric shapes.
        """
        return 0.0, 0.0

    def shear_coupling(self, nu: float) -> float:  # noqa: ARG002
        """GA times the shear strain along z due to a unit force along y, at Poisson's ratio `nu`.

        It is the off-diagonal term of the matrix whose diagonal contains 1/κ for y and for z. 0 if
        y or z is an axis of symmetry.
        """
        return 0.0

    @property
    def couplings(self) -> tuple[float, float, float]:
        """Three compliances (1/(N m)) that couple tension with torsion, and shear with bending.

        They are the rate of twist (rad/m) per axial force (N), the rate of the rotation φy per
        shear force along y, and the rate of φz per shear force along z. They are zero except for
        laminates with an unbalanced layup (helical fibres).
        """
        return 0.0, 0.0, 0.0

    @property
    def inertia_moments(self) -> tuple[float, float, float]:
        """∫z² dA, ∫y² dA, ∫yz dA (m⁴) about the centroid, weighted by density over mean density."""
        return self.second_moment_y, self.second_moment_z, self.product_moment

    @property
    def mass_centre(self) -> tuple[float, float]:
        """Centre of mass (y, z in m) relative to the centroid. Zero if there is one material."""
        return 0.0, 0.0

    def faults(self, unit: str = "m") -> list[str]:
        """Reasons why a shape with these dimensions is impossible, one line each.

        Empty if the shape is valid. `unit` is the unit of the dimensions, for messages.
        """
        sizes = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        wrong = [f"{k} = {x!r}: must be above 0 {unit}" for k, x in sizes.items() if not x > 0]
        return wrong or self._own_faults(unit)

    def _own_faults(self, unit: str) -> list[str]:  # noqa: ARG002
        """Faults of dimensions that do not fit together, although each is above zero.

        There is one line per fault. `unit` is the unit of the dimensions, for messages.
        """
        return []


@dataclass(frozen=True)
class Boxed(Section):
    """A shape with a bounding box of `width` along y and `height` along z (m)."""

    width: float
    height: float

    @property
    def extent(self) -> tuple[float, float]:
        return self.width, self.height


@dataclass(frozen=True)
class _Round(Section):
    """An axially symmetric shape of outer `diameter` (m), with or without a bore."""

    diameter: float

    @property
    def inner_diameter(self) -> float:
        """Diameter (m) of the bore."""
        return 0.0

    @property
    def extent(self) -> tuple[float, float]:
        return self.diameter, self.diameter

    @property
    def area(self) -> float:
        return pi * (self.diameter**2 - self.inner_diameter**2) / 4.0

    @property
    def second_moment_y(self) -> float:
        return pi * (self.diameter**4 - self.inner_diameter**4) / 64.0

    @property
    def second_moment_z(self) -> float:
        return self.second_moment_y

    @property
    def torsion_constant(self) -> float:
        return 2.0 * self.second_moment_y

    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        ratio = (self.inner_diameter / self.diameter) ** 2
        squared = (1.0 + ratio) ** 2
        kappa = (
            6.0 * (1.0 + nu) * squared / ((7.0 + 6.0 * nu) * squared + (20.0 + 12.0 * nu) * ratio)
        )
        return kappa, kappa


def rectangle_torsion_constant(width: float, height: float) -> float:
    """Saint-Venant's torsion constant J (m⁴) of a solid rectangle with sides in m.

    J = a b³ [1/3 − (64/π⁵)(b/a) Σ_odd tanh(kπa/2b)/k⁵] with the smaller side b (Timoshenko &
    Goodier, Elasticity, §109).
    """
    b, a = sorted((width, height))
    series = sum(tanh(k * pi * a / (2.0 * b)) / k**5 for k in range(1, 200, 2))
    return a * b**3 * (1.0 / 3.0 - 64.0 / pi**5 * (b / a) * series)


@dataclass(frozen=True)
class Rectangle(Boxed):
    """Solid rectangle, `width` along y, `height` along z (m)."""

    shape: ClassVar[str] = "rectangle"

    @property
    def area(self) -> float:
        return self.width * self.height

    @property
    def second_moment_y(self) -> float:
        return self.width * self.height**3 / 12.0

    @property
    def second_moment_z(self) -> float:
        return self.height * self.width**3 / 12.0

    @property
    def torsion_constant(self) -> float:
        return rectangle_torsion_constant(self.width, self.height)

    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
        return kappa, kappa


@dataclass(frozen=True)
class HollowRectangle(Boxed):
    """Rectangular tube of outer `width` (y), `height` (z) and wall `thickness` (m)."""

    thickness: float
    shape: ClassVar[str] = "hollow-rectangle"

    @property
    def inner(self) -> Rectangle:
        """Rectangle of the hole inside the walls."""
        return Rectangle(self.width - 2.0 * self.thickness, self.height - 2.0 * self.thickness)

    @property
    def outer(self) -> Rectangle:
        """Outer rectangle of the walls, filled."""
        return Rectangle(self.width, self.height)

    @property
    def area(self) -> float:
        return self.outer.area - self.inner.area

    @property
    def second_moment_y(self) -> float:
        return self.outer.second_moment_y - self.inner.second_moment_y

    @property
    def second_moment_z(self) -> float:
        return self.outer.second_moment_z - self.inner.second_moment_z

    @property
    def torsion_constant(self) -> float:
        """J (m⁴) by Bredt's formula for a closed thin wall, 4 A_m² t / P.

        A_m is the area within the middle line of the wall, and P is the perimeter of this line.
        """
        b, h = self.width - self.thickness, self.height - self.thickness
        return 2.0 * (b * h) ** 2 * self.thickness / (b + h)

    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        b, h = self.width - self.thickness, self.height - self.thickness
        return _box_shear(h, b, nu), _box_shear(b, h, nu)

    def _own_faults(self, unit: str) -> list[str]:
        smaller = min(self.extent)
        if 2.0 * self.thickness < smaller:
            return []
        return [
            f"thickness = {self.thickness!r}: closes the hollow; must be below half the "
            f"smaller side, {smaller / 2.0:g} {unit}"
        ]


def _box_shear(flange: float, web: float, nu: float) -> float:
    """Cowper's κ of a box with a thin wall of uniform thickness, for shear along the webs.

    In Cowper's notation n = m = flange/web, the ratio of width to height of the middle line.
    """
    n = m = flange / web
    return _thin_walled_shear(m, nu, 10.0 * n**2 * ((3.0 + nu) * m + 3.0 * m**2))


def _thin_walled_shear(m: float, nu: float, flanges: float) -> float:
    """Cowper's κ of a thin-walled section whose flanges have `m` times the area of its webs.

    `flanges` is the term in the denominator of κ that depends on the width of the flanges.
    """
    numerator = 10.0 * (1.0 + nu) * (1.0 + 3.0 * m) ** 2
    free_of_nu = 12.0 + 72.0 * m + 150.0 * m**2 + 90.0 * m**3
    with_nu = 11.0 + 66.0 * m + 135.0 * m**2 + 90.0 * m**3
    return numerator / (free_of_nu + nu * with_nu + flanges)


@dataclass(frozen=True)
class Circle(_Round):
    """Solid circle of `diameter` (m)."""

    shape: ClassVar[str] = "circle"


@dataclass(frozen=True)
class Tube(_Round):
    """Circular tube of outer `diameter` with wall `thickness` (m)."""

    thickness: float
    shape: ClassVar[str] = "tube"

    @property
    def inner_diameter(self) -> float:
        return self.diameter - 2.0 * self.thickness

    def _own_faults(self, unit: str) -> list[str]:
        if 2.0 * self.thickness < self.diameter:
            return []
        return [
            f"thickness = {self.thickness!r}: closes the bore; must be below half the "
            f"diameter, {self.diameter / 2.0:g} {unit}"
        ]


@dataclass(frozen=True)
class WalledProfile(Boxed):
    """An open profile in a box of `width` along y and `height` along z (m).

    `flange` is the thickness (m) of the walls along y, `web` that of the wall along z.
    """

    flange: float
    web: float

    def _web_fault(self, unit: str) -> list[str]:
        if self.web < self.width:
            return []
        return [f"web = {self.web!r}: must be below the width, {self.width:g} {unit}"]

    def _flange_fault(self, flanges: int, unit: str) -> list[str]:
        limit = self.height / flanges
        if self.flange < limit:
            return []
        part = "the height" if flanges == 1 else "half the height"
        return [f"flange = {self.flange!r}: leaves no web; must be below {part}, {limit:g} {unit}"]


@dataclass(frozen=True)
class ISection(WalledProfile):
    """Doubly symmetric I-section with flanges along y."""

    shape: ClassVar[str] = "i-section"

    @property
    def outline(self) -> Array:
        """Corners (12×2: y and z, in m) of the outline, counter-clockwise."""
        b, h, w = self.width / 2.0, self.height / 2.0, self.web / 2.0
        f = h - self.flange
        right = [(b, -h), (b, -f), (w, -f), (w, f), (b, f), (b, h)]
        return np.array(right + [(-y, z) for y, z in reversed(right)])

    @property
    def area(self) -> float:
        return 2.0 * self.width * self.flange + self._web_height * self.web

    @property
    def _web_height(self) -> float:
        return self.height - 2.0 * self.flange

    @property
    def second_moment_y(self) -> float:
        gap = self.width - self.web
        return (self.width * self.height**3 - gap * self._web_height**3) / 12.0

    @property
    def second_moment_z(self) -> float:
        return (2.0 * self.flange * self.width**3 + self._web_height * self.web**3) / 12.0

    @property
    def torsion_constant(self) -> float:
        """J (m⁴) by the formula for an open thin wall, Σ b t³/3 over flanges and web.

        The length b of the web is the distance between the middle lines of the flanges.
        """
        return (2.0 * self.width * self.flange**3 + (self.height - self.flange) * self.web**3) / 3.0

    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        return self._shear_along_flanges(nu), self._shear_along_web(nu)

    def _shear_along_web(self, nu: float) -> float:
        """Cowper's κ of a thin-walled I-section for shear along the web."""
        h = self.height - self.flange
        n = self.width / h
        m = 2.0 * self.width * self.flange / (h * self.web)
        flanges = 30.0 * n**2 * (m + m**2) + 5.0 * nu * n**2 * (8.0 * m + 9.0 * m**2)
        return _thin_walled_shear(m, nu, flanges)

    def _shear_along_flanges(self, nu: float) -> float:
        """κ for shear along the flanges, which act as two separate rectangles.

        The web carries no shear force.
        """
        kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
        return kappa * 2.0 * self.width * self.flange / self.area

    def _own_faults(self, unit: str) -> list[str]:
        return self._flange_fault(2, unit) + self._web_fault(unit)
