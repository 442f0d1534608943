"""First and fourth moments of area of shapes with two axes of symmetry.

Tapered legs need both. Bars whose radius of curvature is of the order of their thickness need the
fourth moments.
"""

from math import pi
from typing import NamedTuple

from lumped.sections.shapes import Circle, HollowRectangle, ISection, Rectangle, Section, Tube


class SymmetricMoments(NamedTuple):
    """∫|y| dA and ∫|z| dA (m³), ∫y⁴ dA, ∫z⁴ dA and ∫y²z² dA (m⁶), about the axes of symmetry."""

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
