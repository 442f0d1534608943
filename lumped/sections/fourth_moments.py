"""Fourth moments of area, which bars need that are as thick as their radius is short."""

from math import pi

from lumped.sections.shapes import Circle, HollowRectangle, ISection, Rectangle, Section, Tube


def fourth_moments(section: Section) -> tuple[float, float, float] | None:
    """∫y⁴ dA, ∫z⁴ dA and ∫y²z² dA (m⁶). None for a shape without two axes of symmetry."""
    match section:
        case Rectangle():
            return _of_rectangle(section.width, section.height)
        case HollowRectangle():
            return _difference(fourth_moments(section.outer), fourth_moments(section.inner))
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


def _of_rectangle(width: float, height: float) -> tuple[float, float, float]:
    return (
        height * width**5 / 80.0,
        width * height**5 / 80.0,
        (width * height) ** 3 / 144.0,
    )


def _of_circle(diameter: float) -> tuple[float, float, float]:
    fourth = pi * diameter**6 / 512.0
    return fourth, fourth, fourth / 3.0


def _difference(
    outer: tuple[float, float, float] | None, inner: tuple[float, float, float] | None
) -> tuple[float, float, float] | None:
    if outer is None or inner is None:
        return None
    return outer[0] - inner[0], outer[1] - inner[1], outer[2] - inner[2]
