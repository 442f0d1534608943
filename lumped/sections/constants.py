"""Sections given by their constants only: a catalogue profile, or a result of another program.

Beams and segments need nothing else. The outline is not known, so that such a section cannot be
meshed. Pictures show a rectangle with the same radii of gyration.
"""

from dataclasses import dataclass
from math import inf, sqrt
from typing import ClassVar

from lumped.sections.shapes import Section


@dataclass(frozen=True)
class SectionProperties(Section):
    """Section constants about the centroid, leg axes, SI units.

    `A` is the area (m²). `Iy` = ∫z² dA, `Iz` = ∫y² dA and `Iyz` = ∫yz dA are second moments of area
    (m⁴), and `J` is the torsion constant (m⁴). `Ay` and `Az` are the shear areas κA (m²) along y
    and z. None if there is no shear deformation. (`ys`, `zs`) is the position (m) of the shear
    centre relative to the centroid. `Iw` is the warping constant (m⁶) about the shear centre. None
    if it is not known. No model depends on it. The other defaults are those of a section with two
    axes of symmetry.
    """

    A: float
    Iy: float
    Iz: float
    J: float
    Iyz: float = 0.0
    Ay: float | None = None
    Az: float | None = None
    ys: float = 0.0
    zs: float = 0.0
    Iw: float | None = None
    shape: ClassVar[str] = "properties"

    @property
    def has_outline(self) -> bool:
        return False

    @property
    def is_doubly_symmetric(self) -> bool:
        return False

    @property
    def area(self) -> float:
        return self.A

    @property
    def second_moment_y(self) -> float:
        return self.Iy

    @property
    def second_moment_z(self) -> float:
        return self.Iz

    @property
    def product_moment(self) -> float:
        return self.Iyz

    @property
    def torsion_constant(self) -> float:
        return self.J

    @property
    def shear_centre(self) -> tuple[float, float]:
        return self.ys, self.zs

    @property
    def extent(self) -> tuple[float, float]:
        """Sides (m, along y and z) of the rectangle with the same radii of gyration."""
        return sqrt(12.0 * self.Iz / self.A), sqrt(12.0 * self.Iy / self.A)

    def shear_coefficients(self, nu: float) -> tuple[float, float]:  # noqa: ARG002
        if self.Ay is None or self.Az is None:
            return inf, inf
        return self.Ay / self.A, self.Az / self.A

    def faults(self, unit: str = "m") -> list[str]:
        positive = {"A": self.A, "Iy": self.Iy, "Iz": self.Iz, "J": self.J}
        wrong = [f"{name} = {x!r}: must be above 0" for name, x in positive.items() if not x > 0.0]
        return wrong or self._own_faults(unit)

    def _own_faults(self, unit: str) -> list[str]:
        faults = []
        if self.Iyz**2 >= self.Iy * self.Iz:
            limit = sqrt(self.Iy) * sqrt(self.Iz)
            faults.append(
                f"Iyz = {self.Iyz!r}: must be below √(Iy Iz) in size, {limit:.4g} {unit}⁴; no area "
                "has such moments"
            )
        if self.Iy + self.Iz < self.J:
            faults.append(
                f"J = {self.J!r}: must be at most Iy + Iz, {self.Iy + self.Iz:.4g} {unit}⁴, that "
                "of a section that does not warp"
            )
        if (self.Ay is None) != (self.Az is None):
            missing = "Ay" if self.Ay is None else "Az"
            faults.append(f"{missing}: missing; must be given with the other shear area")
        faults += [
            f"{name} = {area!r}: must be above 0 and at most A, {self.A:.4g} {unit}²"
            for name, area in (("Ay", self.Ay), ("Az", self.Az))
            if area is not None and not 0.0 < area <= self.A
        ]
        return faults
