"""Tubes and boxes with thin walls of fibre layers, by classical laminate theory.

Each layer is orthotropic and in plane stress. Its fibres (direction 1) are at an angle θ from the
leg's axis x. s is the direction along the circumference of the wall. The reduced stiffness Q̄(θ) of
a layer maps the strains (εx, εs, γxs) to the stresses (R. M. Jones, Mechanics of Composite
Materials, §2.6, eqs 2.84-2.85). All layers of a wall have the same strains, and A = Σ Q̄ t is the
sum over layers of thickness t. The wall carries no resultant force along its circumference. Its
stiffnesses in tension and shear are therefore

    E t = 1/a11        G t = 1/a66        a = A⁻¹

In a balanced layup A16 = A26 = 0, so that 1/a66 = A66 and 1/a11 = A11 − A12²/A22. Layers at +θ and
−θ lie at different radii, which leaves some coupling of tension and shear. It is of the order of
the wall's thickness over its radius and is neglected.

EA and EI, and GJ of a tube, are sums over the layers, each of which is treated as a section. The
sums are exact if all layers have the same stiffness. GJ of a box follows from Bredt's formula, and
shear stiffness from the shear flow.

An unbalanced layup couples tension and shear of the wall by a16. Tension then twists the leg, and a
shear force also bends it in the plane normal to the force. The axial force n and the shear flow q
per width of the wall follow from equilibrium alone, because the section has a single cell. The
complementary energy per length is

    ½ ∮ (a11 n² + 2 a16 n q + a66 q²) ds,   q = T/2Ω + …,   n = N/P + My z/Iy − Mz y/Iz

with the perimeter P, the enclosed area Ω and the moments Iy, Iz of the middle line (L. W. Rehfield,
A. R. Atilgan, D. H. Hodges, J. Am. Helicopter Soc. 35 (1990) 42, derive the same couplings). EA,
GJ, EI and κGA are then stiffnesses with all other stress resultants zero.
"""

from abc import abstractmethod
from dataclasses import dataclass
from math import cos, pi, radians, sin
from typing import ClassVar

import numpy as np

from lumped.arrays import Array
from lumped.sections.shapes import HollowRectangle, Section, Tube

# |A16| and |A26| of a balanced layup over A66: angles are typed with ten digits at most.
_BALANCED = 1e-9
# Largest thickness of a wall over the section's smaller side. The stresses of a bent tube then
# differ by a fifth across the wall, and those that laminate theory leaves out are of second order.
_THICKEST = 0.1


@dataclass(frozen=True)
class Layer:
    """Orthotropic layer of a wall.

    `E1` (along the fibres), `E2` (across them) and `G12` are in Pa, `rho` in kg/m³, `thickness` in
    m. `nu12` is Poisson's ratio for a stress along the fibres. `angle` (degrees) is measured from
    the leg's axis x to the fibres, positive towards the direction s along the circumference.
    """

    E1: float
    E2: float
    G12: float
    nu12: float
    rho: float
    thickness: float
    angle: float

    @property
    def stiffness(self) -> Array:
        """Q̄ (3×3, in Pa): stresses (σx, σs, τxs) from strains (εx, εs, γxs)."""
        share = 1.0 - self.nu12**2 * self.E2 / self.E1
        q11, q22 = self.E1 / share, self.E2 / share
        along_fibres = np.array(
            [[q11, self.nu12 * q22, 0.0], [self.nu12 * q22, q22, 0.0], [0, 0, self.G12]]
        )
        c, s = cos(radians(self.angle)), sin(radians(self.angle))
        # Strains along and across the fibres from those along the axis and along the wall.
        strains = np.array(
            [
                [c * c, s * s, c * s],
                [s * s, c * c, -c * s],
                [-2.0 * c * s, 2.0 * c * s, c * c - s * s],
            ]
        )
        return np.asarray(strains.T @ along_fibres @ strains)

    def faults(self) -> list[str]:
        """Faults of the constants of the layer."""
        limit = self.E1 / self.E2
        if self.nu12**2 < limit:
            return []
        return [
            f"nu12 = {self.nu12!r}: must be below √(E1/E2) in size, {limit**0.5:.4g}; no material "
            "has such constants"
        ]


@dataclass(frozen=True)
class Laminate(Section):
    """Section with a thin wall of `layers`, in order from the inside to the outside.

    Section constants times the moduli of the `mean_material` are the stiffnesses of the section:
    E times `second_moment_y` is EIy, and G times `torsion_constant` is GJ.
    """

    layers: tuple[Layer, ...]

    @property
    def is_uniform(self) -> bool:
        return False

    @property
    def thickness(self) -> float:
        """Thickness (m) of the wall."""
        return float(sum(layer.thickness for layer in self.layers))

    @property
    @abstractmethod
    def shells(self) -> tuple[Section, ...]:
        """Section that consists of one layer alone, for each layer from the inside."""

    @property
    @abstractmethod
    def torsion_stiffness(self) -> float:
        """Torsional stiffness GJ (N m²)."""

    @property
    @abstractmethod
    def shear_stiffnesses(self) -> tuple[float, float]:
        """Shear stiffnesses κGA (N) along y and along z, from the energy of the shear flow."""

    @property
    def mean_material(self) -> tuple[float, float, float, float]:
        """E and G (Pa), ν and ρ (kg/m³) of one material with the same EA, GA and mass per length.

        ν is the contraction along the circumference per axial strain, A12/A22 if the layup is
        balanced.
        """
        areas = self._of_shells("area")
        sums = self._sum(areas)
        return (
            _tension(sums) / float(areas.sum()),
            float(sums[2, 2] / areas.sum()),
            -float(self._unit_strains[1]),
            float(self._of_layers("rho") @ areas / areas.sum()),
        )

    def _of_shells(self, name: str) -> Array:
        return np.array([getattr(shell, name) for shell in self.shells])

    @property
    def thicknesses(self) -> Array:
        """Thicknesses (m) of the layers."""
        return self._of_layers("thickness")

    def _of_layers(self, name: str) -> Array:
        return np.array([getattr(layer, name) for layer in self.layers])

    def _sum(self, weights: Array) -> Array:
        """Sum (3×3) of the layers' Q̄ times `weights` (one per layer)."""
        stiffnesses = np.array([layer.stiffness for layer in self.layers])
        return np.asarray(np.tensordot(weights, stiffnesses, axes=1))

    @property
    def area(self) -> float:
        return float(self._of_shells("area").sum())

    @property
    def second_moment_y(self) -> float:
        return _tension(self._sum(self._of_shells("second_moment_y"))) / self.mean_material[0]

    @property
    def second_moment_z(self) -> float:
        return _tension(self._sum(self._of_shells("second_moment_z"))) / self.mean_material[0]

    @property
    def torsion_constant(self) -> float:
        return self.torsion_stiffness / self.mean_material[1]

    @property
    def inertia_moments(self) -> tuple[float, float, float]:
        density = self._of_layers("rho") / self.mean_material[3]
        about_y, about_z = (
            float(density @ self._of_shells(name))
            for name in ("second_moment_y", "second_moment_z")
        )
        return about_y, about_z, 0.0

    def shear_coefficients(self, nu: float) -> tuple[float, float]:  # noqa: ARG002
        along_y, along_z = self.shear_stiffnesses
        shear_stiffness = self.mean_material[1] * self.area
        return along_y / shear_stiffness, along_z / shear_stiffness

    @property
    def tensions(self) -> Array:
        """Axial stress (Pa) of each layer for εx = 1, without hoop or shear force in the wall."""
        return np.array([layer.stiffness[0] @ self._unit_strains for layer in self.layers])

    @property
    def _shears(self) -> Array:
        """Shear stress τxs (Pa) of each layer for γxs = 1 without other strains, Q̄66."""
        return np.array([layer.stiffness[2, 2] for layer in self.layers])

    @property
    def shear_ratio(self) -> float:
        """Largest in-plane shear modulus Q̄66 of the layers, divided by their smallest G12."""
        return float(self._shears.max() / self._of_layers("G12").min())

    @property
    def lone_tensions(self) -> Array:
        """Axial stress (Pa) of each layer under unit axial strain if the layers were not bonded."""
        return np.array([1.0 / np.linalg.inv(layer.stiffness)[0, 0] for layer in self.layers])

    @property
    def hoop_stresses(self) -> Array:
        """Stress (Pa) along the circumference of each layer for εx = 1 under tension alone.

        The resultant of these stresses is zero. Each is zero if all layers have the same stiffness.
        """
        return np.array([layer.stiffness[1] @ self._unit_strains for layer in self.layers])

    @property
    def _unit_strains(self) -> Array:
        """Strains (εx, εs, γxs) of the wall under tension alone, with εx = 1."""
        flexibility = np.linalg.inv(self._sum(self._of_shells("area")))
        return np.asarray(flexibility[:, 0] / flexibility[0, 0])

    @property
    def wall(self) -> Array:
        """A = Σ Q̄ t (3×3, in N/m) of the wall: forces per width from strains (εx, εs, γxs)."""
        return self._sum(self.thicknesses)

    def faults(self, unit: str = "m") -> list[str]:
        faults = [
            f"layers[{number}].{fault}"
            for number, layer in enumerate(self.layers, start=1)
            for fault in layer.faults()
        ]
        return faults or self._own_faults(unit)

    def _own_faults(self, unit: str) -> list[str]:
        smaller = min(self.extent)
        if self.thickness > _THICKEST * smaller:
            return [
                f"layers: together {self.thickness:.4g} {unit} thick; laminate theory is for thin "
                f"walls; must be at most a tenth of the smaller side, {_THICKEST * smaller:.4g} "
                f"{unit}"
            ]
        return []

    @property
    def is_balanced(self) -> bool:
        """True if tension does not shear the wall.

        This is so if the layers at −θ are together as thick as those at +θ, for each angle θ.
        """
        wall = self.wall
        return bool(np.abs(wall[:2, 2]).max() <= _BALANCED * wall[2, 2])

    @property
    def couplings(self) -> tuple[float, float, float]:
        if self.is_balanced:
            return 0.0, 0.0, 0.0
        twist, turn = self._unit_couplings
        coupling = float(np.linalg.inv(self.wall)[0, 2])
        return coupling * twist, coupling * turn, coupling * turn

    @property
    @abstractmethod
    def _unit_couplings(self) -> tuple[float, float]:
        """Two integrals ∮ n q ds (1/m²) along the middle line of the wall.

        n and q are those of the module docstring. In the first integral, n is due to N = 1 and q to
        T = 1. In the second, n is due to My = 1 and q to Qy = 1. The integral for Mz = 1 and Qz = 1
        is equal to the second.
        """

    @property
    def _free_shear(self) -> float:
        """Ratio of two shear stiffnesses of the wall: with free strains, and with εx = εs = 0.

        They are 1/a66 and A66.
        """
        wall = self.wall
        return 1.0 / float(np.linalg.inv(wall)[2, 2] * wall[2, 2])


def _tension(sums: Array) -> float:
    """Stiffness 1/(S⁻¹)₁₁ in tension along the axis.

    S is `sums` (3×3), the sum of the layers' Q̄, each times its area or its second moment of area.
    """
    return float(1.0 / np.linalg.inv(sums)[0, 0])


@dataclass(frozen=True)
class LaminateTube(Laminate):
    """Round tube of outer `diameter` (m)."""

    diameter: float
    shape: ClassVar[str] = "laminate-tube"

    @property
    def extent(self) -> tuple[float, float]:
        return self.diameter, self.diameter

    @property
    def shells(self) -> tuple[Section, ...]:
        thicknesses = self.thicknesses.tolist()
        outer = self.diameter - 2.0 * (self.thickness - np.cumsum(thicknesses))
        return tuple(Tube(d, t) for d, t in zip(outer.tolist(), thicknesses, strict=True))

    @property
    def torsion_stiffness(self) -> float:
        return self._free_shear * float(self._sum(self._of_shells("torsion_constant"))[2, 2])

    @property
    def _unit_couplings(self) -> tuple[float, float]:
        radius = 0.5 * (self.diameter - self.thickness)
        # n = N/2πr and q = T/2πr²; n = My sin φ/πr² and q = −Qy sin φ/πr.
        return 1.0 / (2.0 * pi * radius**2), -1.0 / (pi * radius**2)

    @property
    def shear_stiffnesses(self) -> tuple[float, float]:
        # Bending stresses at the radius r = Σ E ∫r³dr/Σ E ∫r²dr have the flow V sin φ/πr, which
        # strains a circumference of radius R = Σ G ∫r dr/Σ Gt: V²/∮ q² ds/Gt = π Gt R (r/R)².
        outer = self._of_shells("diameter") / 2.0
        inner = outer - self.thicknesses
        third, second = (float(self.tensions @ ((outer**n - inner**n) / n)) for n in (4, 3))
        shear = float(self._sum(self._of_shells("area"))[2, 2])
        middle = shear / (2.0 * pi * float(self.wall[2, 2]))
        half = 0.5 * self._free_shear * shear * (third / second / middle) ** 2
        return half, half


@dataclass(frozen=True)
class LaminateBox(Laminate):
    """Rectangular tube of outer `width` along y and `height` along z (m)."""

    width: float
    height: float
    shape: ClassVar[str] = "laminate-box"

    @property
    def extent(self) -> tuple[float, float]:
        return self.width, self.height

    @property
    def shells(self) -> tuple[Section, ...]:
        thicknesses = self.thicknesses.tolist()
        less = 2.0 * (self.thickness - np.cumsum(thicknesses))
        return tuple(
            HollowRectangle(self.width - inside, self.height - inside, t)
            for inside, t in zip(less.tolist(), thicknesses, strict=True)
        )

    @property
    def _middle(self) -> tuple[float, float]:
        """Width and height (m) of the middle line of the wall."""
        return self.width - self.thickness, self.height - self.thickness

    @property
    def torsion_stiffness(self) -> float:
        b, h = self._middle
        return float(2.0 * (b * h) ** 2 / (b + h) * self._free_shear * self.wall[2, 2])

    @property
    def _unit_couplings(self) -> tuple[float, float]:
        b, h = self._middle
        # For Qy = 1, −q Iz is b h/4 + b²/8 − y²/2 at the top and z b/2 at the sides, positive from
        # y to z.
        first = (b * h / 2.0) ** 2 + b * h**3 / 12.0 + h * b**3 / 12.0
        moments = (b**2 * h / 2.0 + b**3 / 6.0) * (h**2 * b / 2.0 + h**3 / 6.0)
        return 1.0 / (2.0 * b * h), -first / moments

    @property
    def shear_stiffnesses(self) -> tuple[float, float]:
        # The line (b, h) is at the layers' mean depth weighted by E, at which bending stresses act.
        # The line (of_b, of_h) is weighted by G. The flow of the first strains the second's wall.
        (b, h), (of_b, of_h) = (self._line(weights) for weights in (self.tensions, self._shears))
        shear = self._free_shear * float(self.wall[2, 2]) * (b + h) / (of_b + of_h)
        return shear * _box_shear_length(h, b), shear * _box_shear_length(b, h)

    def _line(self, moduli: Array) -> tuple[float, float]:
        """Width and height (m) of the closed line at the mean depth of the layers in the wall.

        The depth of each layer is weighted by its modulus (one of `moduli`) times its thickness.
        """
        outer_sides = np.cumsum(self.thicknesses[::-1])[::-1]
        depths = outer_sides - 0.5 * self.thicknesses
        weights = moduli * self.thicknesses
        twice = 2.0 * float(weights @ depths / weights.sum())
        return self.width - twice, self.height - twice


def _box_shear_length(flange: float, web: float) -> float:
    """κA/t = V²/∮ q² ds (m) of a thin box with the shear flow q due to a force V along its webs.

    The wall has the thickness t, and I is the second moment of area. The flanges have the width b
    (`flange`) and the webs the height h (`web`), both in m. In the flanges, q I/(V t) is s h/2 at
    the distance s from their middles. In the webs it is b h/4 + h²/8 − z²/2.
    """
    b, h = flange, web
    moment = b * h**2 / 2.0 + h**3 / 6.0
    top = b * h / 4.0 + h**2 / 8.0
    flanges = b**3 * h**2 / 24.0
    webs = 2.0 * (top**2 * h - top * h**3 / 12.0 + h**5 / 320.0)
    return moment**2 / (flanges + webs)
