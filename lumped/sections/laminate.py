"""Tubes and boxes with thin walls of fibre layers, by classical laminate theory.

Each layer is orthotropic in plane stress, its fibres (direction 1) at an angle θ from the leg's
axis. Its reduced stiffness Q̄(θ) acts on the strains (εx, εs, γxs) along the axis and along the wall
(R. M. Jones, Mechanics of Composite Materials, §2.6, eqs 2.84-2.85). All layers of a wall have the
same strains. The wall carries no stress along its circumference, so that with the sums A = Σ Q̄ t

    E t = 1/a11        G t = 1/a66        a = A⁻¹

are its stiffnesses in tension and shear. In a balanced layup A16 = A26 = 0, so that 1/a66 = A66 and
1/a11 = A11 − A12²/A22. Layers at +θ and −θ lie at different radii; the coupling of tension and
shear that this leaves is of the order of the wall's thickness over its radius, and is left out.

EA and EI, and GJ of a tube, are sums over the layers, each taken as a section of its own. The sums
are exact if all layers have the same stiffness. GJ of a box follows from Bredt's formula. Shear
stiffness follows from the shear flow.

An unbalanced layup couples tension and shear of the wall, by a16: tension twists the leg, and a
shear force bends it across its direction. With the axial force n and the flow q per width, which
follow from equilibrium alone in a single cell, the complementary energy is

    ½ ∮ (a11 n² + 2 a16 n q + a66 q²) ds,   q = T/2Ω + …,   n = N/P + My z/Iy − Mz y/Iz

(L. W. Rehfield, A. R. Atilgan, D. H. Hodges, J. Am. Helicopter Soc. 35 (1990) 42, derive the same
couplings), with the perimeter P, the enclosed area Ω and the moments Iy, Iz of the middle line. EA,
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
    """Orthotropic layer: E1 along the fibres, E2, G12 (Pa), ν12, ρ (kg/m³), thickness (m).

    `angle` (degrees): from the leg's axis to the fibres, positive towards the wall's circumference.
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
    """Thin wall of `layers` from the inside outwards.

    Section constants times the moduli of the `mean_material` are the stiffnesses of the section:
    E times `second_moment_y` is EIy, G times `torsion_constant` is GJ.
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
        """The layers, each as a section of its own."""

    @property
    @abstractmethod
    def torsion_stiffness(self) -> float:
        """GJ (N m²)."""

    @property
    @abstractmethod
    def shear_stiffnesses(self) -> tuple[float, float]:
        """κGA (N) along y and along z by strain energy of the shear flow."""

    @property
    def mean_material(self) -> tuple[float, float, float, float]:
        """E = EA/A, shear modulus G (Pa), ν = A12/A22 and ρ (kg/m³) of the wall."""
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
        """Axial stresses (Pa, one per layer) for εx = 1 without hoop or shear force in the wall."""
        return np.array([layer.stiffness[0] @ self._unit_strains for layer in self.layers])

    @property
    def _shears(self) -> Array:
        """Stresses τxs (Pa, one per layer) for γxs = 1 without other strains: Q̄66."""
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
        """Stresses (Pa, one per layer) along the circumference for a unit axial strain.

        Their resultant is zero. They are zero if all layers have the same stiffness.
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
        """True if tension does not shear the wall: as much thickness at −θ as at +θ."""
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
        """Integrals ∮ n q ds (1/m²) along the middle line, for n and q of the module docstring.

        First: n due to N = 1, q due to T = 1. Second: n due to My = 1, q due to Qy = 1. Mz with Qz
        has the same integral as My with Qy.
        """

    @property
    def _free_shear(self) -> float:
        """Shear stiffness of the wall with free strains εx and εs, 1/a66, divided by A66."""
        wall = self.wall
        return 1.0 / float(np.linalg.inv(wall)[2, 2] * wall[2, 2])


def _tension(sums: Array) -> float:
    """Tensile stiffness 1/(S⁻¹)₁₁ along the axis, from the sum S = `sums` (3×3) of weighted Q̄."""
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
        """Width and height (m) of the line at the layers' mean depth, weighted by modulus · t."""
        outer_sides = np.cumsum(self.thicknesses[::-1])[::-1]
        depths = outer_sides - 0.5 * self.thicknesses
        weights = moduli * self.thicknesses
        twice = 2.0 * float(weights @ depths / weights.sum())
        return self.width - twice, self.height - twice


def _box_shear_length(flange: float, web: float) -> float:
    """κA/t = V²/∮ q² ds (m) of a thin box with the shear flow q due to a force V along its webs.

    With flanges of width b, webs of height h and wall thickness t, q I/(V t) is s h/2 in the
    flanges, at a distance s from their middles, and b h/4 + h²/8 − z²/2 in the webs.
    """
    b, h = flange, web
    moment = b * h**2 / 2.0 + h**3 / 6.0
    top = b * h / 4.0 + h**2 / 8.0
    flanges = b**3 * h**2 / 24.0
    webs = 2.0 * (top**2 * h - top * h**3 / 12.0 + h**5 / 320.0)
    return moment**2 / (flanges + webs)
