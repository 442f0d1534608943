"""Moments of area, and moments of shear stresses, of shapes with two axes of symmetry.

All of them occur in the stiffness of tapered legs. The fourth moments of area also occur in that of
curved legs, where they matter if the radius of curvature is of the order of the thickness.
"""

from math import pi
from typing import NamedTuple

from lumped.sections.shapes import Circle, HollowRectangle, ISection, Rectangle, Section, Tube


class SymmetricMoments(NamedTuple):
    """Moments of area about the axes of symmetry.

    `y` and `z` are ∫|y| dA and ∫|z| dA (m³). `yyyy`, `zzzz` and `yyzz` are ∫y⁴ dA, ∫z⁴ dA and
    ∫y²z² dA (m⁶).
    """

    y: float
    z: float
    yyyy: float
    zzzz: float
    yyzz: float


def symmetric_moments(section: Section) -> SymmetricMoments | None:
    """Moments of area of a shape. None for a shape without two axes of symmetry."""
    match section:
        case Rectangle():
            return _of_rectangle(section.width, section.height)
        case HollowRectangle():
            outer, inner = section.outer, section.inner
            return _difference(
                _of_rectangle(outer.width, outer.height), _of_rectangle(inner.width, inner.height)
            )
        case ISection():
            hollow = section.height - 2.0 * section.flange
            both_sides = _difference(
                _of_rectangle(section.width, hollow), _of_rectangle(section.web, hollow)
            )
            return _difference(_of_rectangle(section.width, section.height), both_sides)
        case Circle():
            return _of_circle(section.diameter)
        case Tube():
            return _difference(_of_circle(section.diameter), _of_circle(section.inner_diameter))
    return None


def flexure_moments(section: Section, poisson_shear_ratio: float) -> tuple[float, float]:
    """Two products (m⁶): Iz ∫yz τxz dA for a unit force Qy, and Iy ∫yz τxy dA for a unit force Qz.

    τxz and τxy are shear stresses normal to the force, in Saint-Venant's flexure. Those of circles
    and tubes are exact for νG/E = `poisson_shear_ratio`. Those of flanges follow from equilibrium
    with the bending stress. Those of a rectangle are zero for ν = 0 and small otherwise, and are
    neglected. The products are zero for a shape without two axes of symmetry.
    """
    match section:
        case HollowRectangle():
            y, z = section.width - section.thickness, section.height - section.thickness
            inner = section.inner
            return (
                _of_flanges(z, section.width, inner.width),
                _of_flanges(y, section.height, inner.height),
            )
        case ISection():
            # Between the tips of the flanges and the web, τ = Q z (width/2 − |y|)/I.
            inside = section.height - 2.0 * section.flange
            return 0.0, section.width**3 / 24.0 * (section.height**3 - inside**3) / 12.0
        case Circle():
            moment = _of_annulus(0.5 * section.diameter, 0.0, poisson_shear_ratio)
            return moment, moment
        case Tube():
            radii = 0.5 * section.diameter, 0.5 * section.inner_diameter
            moment = _of_annulus(*radii, poisson_shear_ratio)
            return moment, moment
    return 0.0, 0.0


def _of_flanges(across: float, outside: float, inside: float) -> float:
    """Product (m⁶) of I and ∫yz τ dA in the flanges of a box, for a unit force along its webs.

    Between the middle lines of the webs, the shear stress normal to the force is τ = −y z/I.
    `across` is the distance (m) of these middle lines. `outside` and `inside` are the distances (m)
    between the outer faces and between the inner faces of the two flanges.
    """
    return -(across**3) / 12.0 * (outside**3 - inside**3) / 12.0


def _of_annulus(a: float, b: float, poisson_shear_ratio: float) -> float:
    """Product (m⁶) of I and ∫yz τ dA for a unit force on a ring with the radii a > b (m).

    In polar coordinates r, α and with n = νG/E the shear stresses are τr = (3 − 2n)(a² + b² −
    a²b²/r² − r²) sin α/8I and τα = ((3 − 2n)(a² + b² + a²b²/r²) − (1 − 6n) r²) cos α/8I (A. E. H.
    Love, ch. XV). τ = τr cos α − τα sin α is their component normal to the force.
    """
    solid = (1.0 + 2.0 * poisson_shear_ratio) / 4.0 * pi * (a**6 - b**6) / 24.0
    ring = (3.0 - 2.0 * poisson_shear_ratio) * pi / 32.0 * (a * b) ** 2 * (a**2 - b**2)
    return -(solid + ring)


def _of_rectangle(width: float, height: float) -> SymmetricMoments:
    return SymmetricMoments(
        y=height * width**2 / 4.0,
        z=width * height**2 / 4.0,
        yyyy=height * width**5 / 80.0,
        zzzz=width * height**5 / 80.0,
        yyzz=(width * height) ** 3 / 144.0,
    )


def _of_circle(diameter: float) -> SymmetricMoments:
    first, fourth = diameter**3 / 6.0, pi * diameter**6 / 512.0
    return SymmetricMoments(first, first, fourth, fourth, fourth / 3.0)


def _difference(outer: SymmetricMoments, inner: SymmetricMoments) -> SymmetricMoments:
    return SymmetricMoments(*(a - b for a, b in zip(outer, inner, strict=True)))
