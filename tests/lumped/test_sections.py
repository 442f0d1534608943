"""Sections by their outline: exact moments of area; torsion and flexure by boundary elements."""

from dataclasses import astuple, replace
from math import cos, pi, sin, sqrt, tau

import numpy as np
import pytest

from lumped.legs import ConstantLeg, Material
from lumped.sections import (
    Angle,
    Channel,
    Polygon,
    Rectangle,
    SectionProperties,
    Tee,
    rectangle_torsion_constant,
)

# Relative error of the boundary elements, at most 1e-5: J of thin walls is the small difference of
# the polar moment and a term nearly as large.
BOUNDARY_ERROR = 2e-5


def box(width, height, y=0.0, z=0.0):
    """Return the corners of a rectangle of `width` and `height` with one corner at (y, z)."""
    return ((y, z), (y + width, z), (y + width, z + height), (y, z + height))


def transformed(points, move):
    return tuple(move(*point) for point in points)


@pytest.mark.parametrize("thickness", [1.0, 0.3, 0.05, 0.01])
def test_rectangle_torsion_is_series(thickness):
    """J by Timoshenko's series; κ by energy is exactly 5/6 for ν = 0."""
    outlined, exact = Polygon(box(1.0, thickness)), Rectangle(1.0, thickness)
    assert outlined.torsion_constant == pytest.approx(
        rectangle_torsion_constant(1.0, thickness), rel=BOUNDARY_ERROR
    )
    for name in ("area", "second_moment_y", "second_moment_z"):
        assert getattr(outlined, name) == pytest.approx(getattr(exact, name), rel=1e-12)
    assert outlined.shear_coefficients(0.0) == pytest.approx(
        (5.0 / 6.0, 5.0 / 6.0), rel=BOUNDARY_ERROR
    )
    assert outlined.shear_centre == (0.0, 0.0)
    assert outlined.product_moment == 0.0
    assert outlined.shear_coupling(0.3) == 0.0


def test_triangle_torsion_is_exact():
    """Equilateral triangle: J = √3 a⁴/80 (Timoshenko & Goodier, Theory of Elasticity, §109)."""
    a = 0.1
    triangle = Polygon(((0.0, 0.0), (a, 0.0), (a / 2.0, a * sqrt(3.0) / 2.0)))
    assert triangle.torsion_constant == pytest.approx(sqrt(3.0) * a**4 / 80.0, rel=BOUNDARY_ERROR)
    assert np.allclose(triangle.shear_centre, 0.0, atol=1e-5 * a)
    # Right-angled isosceles triangle: J = 0.0261 a⁴ (W. C. Young, R. G. Budynas, Roark's Formulas
    # for Stress and Strain, table 10.1).
    right = Polygon(((0.0, 0.0), (a, 0.0), (0.0, a)))
    assert right.torsion_constant == pytest.approx(0.0261 * a**4, rel=2e-3)


def test_polygon_of_circles_equals_tube():
    """Bending and torsion of a tube whose two circles are polygons of the same areas."""
    count, outer, inner = 48, 0.05, 0.04
    # The corners lie outside the circle, so that the polygon has the area of the circle.
    wider = sqrt(2.0 * pi / (count * sin(tau / count)))

    def ring(radius):
        turns = np.arange(count) * tau / count
        return tuple((radius * wider * cos(t), radius * wider * sin(t)) for t in turns)

    tube = Polygon(ring(outer), (ring(inner),))
    assert tube.area == pytest.approx(pi * (outer**2 - inner**2), rel=1e-12)
    # Second moments and J differ from those of circles by a relative 1/count².
    polar = pi / 2.0 * (outer**4 - inner**4)
    assert tube.torsion_constant == pytest.approx(polar, rel=4.0 / count**2)
    assert 2.0 * tube.second_moment_y == pytest.approx(polar, rel=4.0 / count**2)


def test_channel_shear_centre_is_textbook():
    """Shear centre at e = 3b²f/(h w + 6 b f) behind the middle line of the web.

    f and w are the thicknesses of flanges and web, b and h width and height between middle lines
    (Timoshenko, Strength of Materials). The exact shear centre differs from this thin-wall formula
    by terms of second order in the thickness.
    """
    differences = []
    for wall in (0.02, 0.01):
        section = Channel(width=0.5, height=1.0, flange=wall, web=wall)
        b, h = section.width - wall / 2.0, section.height - wall
        e = 3.0 * b**2 / (h + 6.0 * b)
        centroid = (section.width**2 * wall + (section.height - 2.0 * wall) * wall**2 / 2.0) / (
            section.area
        )
        differences.append(section.shear_centre[0] + centroid - (wall / 2.0 - e))
        assert section.shear_centre[1] == 0.0
    assert abs(differences[1]) < 1e-4
    assert differences[0] / differences[1] == pytest.approx(4.0, abs=1.0)


def test_equal_angle_has_axes_at_45_degrees():
    """Thin legs: J = Σ b t³/3, and the shear centre is the intersection of their middle lines."""
    t, b = 0.01, 1.0
    angle = Angle(width=b, height=b, flange=t, web=t)
    assert angle.second_moment_y == pytest.approx(angle.second_moment_z, rel=1e-12)
    moments = np.array(
        [
            [angle.second_moment_z, angle.product_moment],
            [angle.product_moment, angle.second_moment_y],
        ]
    )
    values, axes = np.linalg.eigh(moments)
    assert np.abs(axes) == pytest.approx(np.full((2, 2), sqrt(0.5)), rel=1e-9)
    # Thin legs of middle-line length b: I_max = t b³/3 and I_min = t b³/12 up to a relative t/b.
    middle = b - t / 2.0
    assert values == pytest.approx([t * middle**3 / 12.0, t * middle**3 / 3.0], rel=2.0 * t / b)
    assert angle.torsion_constant == pytest.approx(2.0 * middle * t**3 / 3.0, rel=t / b)
    centroid = (b**2 * t / 2.0 + (b - t) * t**2 / 2.0) / angle.area
    from_corner = np.array(angle.shear_centre) + centroid
    assert from_corner == pytest.approx([t / 2.0, t / 2.0], abs=0.02 * t)


def test_zed_product_moment_is_exact():
    """By the parallel-axis theorem each flange of area A_f at (y, z) contributes A_f y z."""
    b, h, t = 0.05, 0.1, 0.005
    points = [(0, 0), (b, 0), (b, t), (t, t), (t, h), (t - b, h), (t - b, h - t), (0, h - t)]
    zed = Polygon(tuple(points))
    by_walls = 2.0 * (b - t) * t * -(b / 2.0) * (h - t) / 2.0
    assert zed.product_moment == pytest.approx(-abs(by_walls), rel=1e-12)
    # By symmetry centroid and shear centre coincide.
    assert zed.shear_centre == (0.0, 0.0)


def test_tee_shear_centre_is_in_flange():
    """In a thin tee it is where the middle lines of flange and web meet."""
    tee = Tee(width=1.0, height=1.0, flange=0.02, web=0.02)
    weights = np.array([1.0 * 0.02, 0.98 * 0.02])
    centroid = weights @ [0.99, 0.49] / weights.sum()
    assert tee.shear_centre[0] == 0.0
    assert tee.shear_centre[1] == pytest.approx(0.99 - centroid, abs=1e-3)


def test_section_ignores_outline_origin():
    """The outline is shifted, listed clockwise and from another corner, then rotated by 90°."""
    angle = Angle(width=0.06, height=0.1, flange=0.006, web=0.008)
    points = tuple(map(tuple, angle.loops[0].tolist()))
    moved_outlines = [
        Polygon(transformed(points, lambda y, z: (y + 3.0, z - 2.0))),
        Polygon(points[::-1]),
        Polygon(points[2:] + points[:2]),
    ]
    for other in moved_outlines:
        assert other.product_moment == pytest.approx(angle.product_moment, rel=1e-9)
        assert other.torsion_constant == pytest.approx(angle.torsion_constant, rel=1e-8)
        assert other.shear_centre == pytest.approx(angle.shear_centre, rel=1e-8)
        assert other.shear_coupling(0.3) == pytest.approx(angle.shear_coupling(0.3), rel=1e-7)
    turned = Polygon(transformed(points, lambda y, z: (-z, y)))
    y, z = angle.shear_centre
    assert turned.shear_centre == pytest.approx((-z, y), rel=1e-8)
    assert turned.second_moment_y == pytest.approx(angle.second_moment_z, rel=1e-9)
    assert turned.product_moment == pytest.approx(-angle.product_moment, rel=1e-9)
    assert turned.shear_coefficients(0.3) == pytest.approx(
        angle.shear_coefficients(0.3)[::-1], rel=1e-7
    )


@pytest.mark.parametrize(
    ("section", "fault"),
    [
        (Channel(0.05, 0.1, 0.05, 0.005), "flange = 0.05: leaves no web; must be below half the"),
        (Channel(0.05, 0.1, 0.005, 0.05), "web = 0.05: must be below the width, 0.05 m"),
        (Angle(0.05, 0.1, 0.1, 0.005), "flange = 0.1: leaves no web; must be below the height"),
        (Tee(0.05, 0.1, -0.01, 0.005), "flange = -0.01: must be above 0 m"),
        (Polygon(((0, 0), (1, 0), (0, 1), (1, 1))), "outline: the edges from points 2 and 4 cross"),
        (Polygon(((0, 0), (1, 0), (1, 1), (0, 0))), "outline[4]: repeats the first point"),
        (Polygon(((0, 0), (1, 0), (1, 0), (0, 1))), "outline[3]: repeats the point before it"),
        (Polygon(((0, 0), (1, 0), (0.5, 0))), "outline[1]: the line turns back on itself"),
        (Polygon(((1, 1), (1, 1), (1, 1))), "outline: all points are one"),
        (
            Polygon(box(1, 1), (box(1, 1, 2, 2),)),
            "holes[1]: lies outside the outline; must lie inside it",
        ),
        (Polygon(box(1, 1), (box(1, 1, 0.5, 0.5),)), "holes[1]: meets the outline"),
        (Polygon(box(1, 1), (box(0.2, 0.2, 0.0, 0.5),)), "holes[1]: meets the outline"),
        (
            Polygon(box(1, 1), (box(0.6, 0.6, 0.1, 0.1), box(0.1, 0.1, 0.3, 0.3))),
            "holes[2]: one of it and holes[1] lies in the other",
        ),
        (
            Polygon(box(1, 1), (box(0.3, 0.3, 0.1, 0.1), box(0.3, 0.3, 0.2, 0.2))),
            "holes[2]: meets holes[1]",
        ),
    ],
)
def test_impossible_section_is_refused(section, fault):
    """Walls thicker than the section and other faults: one line with value and limit."""
    (message,) = section.faults()
    assert message.startswith(fault), message


def test_constants_and_shape_give_same_beam():
    """The constants of an angle section, given as numbers, give the same beam as its shape."""
    nu, steel = 0.3, Material.isotropic(2.1e11, 0.3, 7850.0)
    angle = Angle(width=0.06, height=0.1, flange=0.006, web=0.008)
    kappa_y, kappa_z = angle.shear_coefficients(nu)
    y, z = angle.shear_centre
    constants = SectionProperties(
        A=angle.area,
        Iy=angle.second_moment_y,
        Iz=angle.second_moment_z,
        J=angle.torsion_constant,
        Iyz=angle.product_moment,
        Ay=kappa_y * angle.area,
        Az=kappa_z * angle.area,
        ys=y,
        zs=z,
    )
    assert constants.faults() == []
    shape, from_constants = (
        ConstantLeg(1.0, section, steel).timoshenko for section in (angle, constants)
    )
    # Given constants have no coupling between shear along y and along z.
    assert astuple(from_constants) == pytest.approx(
        astuple(replace(shape, shear_yz=0.0)), rel=1e-12
    )
    without = replace(constants, Ay=None, Az=None)
    bent = ConstantLeg(1.0, without, steel).timoshenko
    assert (bent.GAy, bent.GAz) == (np.inf, np.inf)
    # The extent derived from a rectangle's constants is that of the rectangle.
    rectangle = Rectangle(0.02, 0.05)
    equal_constants = SectionProperties(
        rectangle.area, rectangle.second_moment_y, rectangle.second_moment_z, 1e-8
    )
    assert equal_constants.extent == pytest.approx(rectangle.extent, rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"A": -1.0}, "A = -1.0: must be above 0"),
        ({"Iyz": -3e-7}, "Iyz = -3e-07: must be below √(Iy Iz) in size, 2.449e-07 m⁴"),
        ({"J": 6e-7}, "J = 6e-07: must be at most Iy + Iz, 5e-07 m⁴"),
        ({"Az": None}, "Az: missing; must be given with the other shear area"),
        ({"Ay": 2e-3}, "Ay = 0.002: must be above 0 and at most A, 0.001 m²"),
    ],
)
def test_invalid_constants_are_refused(changed, fault):
    """Constants that no section has, such as |Iyz| above √(Iy Iz)."""
    sound = SectionProperties(1e-3, 2e-7, 3e-7, 1e-8, Ay=8e-4, Az=7e-4)
    assert sound.faults() == []
    (message,) = replace(sound, **changed).faults()
    assert message.startswith(fault), message


def test_product_moment_equals_peery():
    """D. J. Peery, Aircraft Structures (1950), §6.2: web 2 × 12 in, flanges 4 × 2 in.

    Moments of inertia 693.3 and 173.3 in⁴, product of inertia 240 in⁴ in size.
    """
    zed = Polygon(
        ((-1, -6), (1, -6), (1, 4), (5, 4), (5, 6), (-1, 6), (-1, -4), (-5, -4), (-5, -6))
    )
    assert zed.area == pytest.approx(2 * 12 + 2 * 4 * 2)
    assert zed.second_moment_y == pytest.approx(693.3, abs=0.05)
    assert zed.second_moment_z == pytest.approx(173.3, abs=0.05)
    assert abs(zed.product_moment) == pytest.approx(240.0, abs=0.05)
