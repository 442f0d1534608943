"""Sections within outlines: exact moments of area, torsion and flexure on the rim."""

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

# Boundary elements: J of walls is the difference of I_p and a term as large; 1e-5 at most.
ON_RIM = 2e-5


def box(width, height, y=0.0, z=0.0):
    """Corners of a rectangle from (y, z) on."""
    return ((y, z), (y + width, z), (y + width, z + height), (y, z + height))


def transformed(points, move):
    return tuple(move(*point) for point in points)


@pytest.mark.parametrize("thickness", [1.0, 0.3, 0.05, 0.01])
def test_rectangle_on_its_rim_is_that_of_the_series(thickness):
    """J by Timoshenko's series; κ by energy, 5/6 exactly without contraction."""
    outlined, exact = Polygon(box(1.0, thickness)), Rectangle(1.0, thickness)
    assert outlined.torsion_constant == pytest.approx(
        rectangle_torsion_constant(1.0, thickness), rel=ON_RIM
    )
    for name in ("area", "second_moment_y", "second_moment_z"):
        assert getattr(outlined, name) == pytest.approx(getattr(exact, name), rel=1e-12)
    assert outlined.shear_coefficients(0.0) == pytest.approx((5.0 / 6.0, 5.0 / 6.0), rel=ON_RIM)
    assert outlined.shear_centre == (0.0, 0.0)
    assert outlined.product_moment == 0.0
    assert outlined.shear_coupling(0.3) == 0.0


def test_triangle_twists_as_saint_venant_has_it():
    """Equilateral: J = √3 a⁴/80 (Timoshenko & Goodier, Theory of Elasticity, §109)."""
    a = 0.1
    triangle = Polygon(((0.0, 0.0), (a, 0.0), (a / 2.0, a * sqrt(3.0) / 2.0)))
    assert triangle.torsion_constant == pytest.approx(sqrt(3.0) * a**4 / 80.0, rel=ON_RIM)
    assert np.allclose(triangle.shear_centre, 0.0, atol=1e-5 * a)
    # Isosceles with a right angle: 0.0261 a⁴ (W. C. Young, R. G. Budynas, Roark's Formulas for
    # Stress and Strain, table 10.1).
    right = Polygon(((0.0, 0.0), (a, 0.0), (0.0, a)))
    assert right.torsion_constant == pytest.approx(0.0261 * a**4, rel=2e-3)


def test_polygon_of_many_corners_becomes_the_tube():
    """Inner and outer circle as polygons of equal areas: bending and torsion of the tube."""
    count, outer, inner = 48, 0.05, 0.04
    # The polygon's corners lie farther out, so that its area is the circle's.
    wider = sqrt(2.0 * pi / (count * sin(tau / count)))

    def ring(radius):
        turns = np.arange(count) * tau / count
        return tuple((radius * wider * cos(t), radius * wider * sin(t)) for t in turns)

    tube = Polygon(ring(outer), (ring(inner),))
    assert tube.area == pytest.approx(pi * (outer**2 - inner**2), rel=1e-12)
    # Second moments and J differ by the corners, by 1/count² of themselves.
    polar = pi / 2.0 * (outer**4 - inner**4)
    assert tube.torsion_constant == pytest.approx(polar, rel=4.0 / count**2)
    assert 2.0 * tube.second_moment_y == pytest.approx(polar, rel=4.0 / count**2)


def test_channel_has_the_shear_centre_of_thin_walls():
    """e = 3b²f/(h w + 6 b f) behind the web's middle line (Timoshenko, Strength of Materials).

    Walls between middle lines; what is left is of the second order in the thickness.
    """
    left = []
    for wall in (0.02, 0.01):
        section = Channel(width=0.5, height=1.0, flange=wall, web=wall)
        b, h = section.width - wall / 2.0, section.height - wall
        e = 3.0 * b**2 / (h + 6.0 * b)
        centroid = (section.width**2 * wall + (section.height - 2.0 * wall) * wall**2 / 2.0) / (
            section.area
        )
        left.append(section.shear_centre[0] + centroid - (wall / 2.0 - e))
        assert section.shear_centre[1] == 0.0
    assert abs(left[1]) < 1e-4
    assert left[0] / left[1] == pytest.approx(4.0, abs=1.0)


def test_angle_has_principal_axes_at_45_degrees():
    """Equal legs; thin: J = Σ b t³/3, shear centre where the walls' middle lines meet."""
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
    # Of thin legs: I_max = t b³/3, I_min = t b³/12, in the second order with b between middles.
    middle = b - t / 2.0
    assert values == pytest.approx([t * middle**3 / 12.0, t * middle**3 / 3.0], rel=2.0 * t / b)
    assert angle.torsion_constant == pytest.approx(2.0 * middle * t**3 / 3.0, rel=t / b)
    centroid = (b**2 * t / 2.0 + (b - t) * t**2 / 2.0) / angle.area
    place = np.array(angle.shear_centre) + centroid
    assert place == pytest.approx([t / 2.0, t / 2.0], abs=0.02 * t)


def test_zed_has_the_product_of_inertia_of_its_walls():
    """By the parallel-axis theorem, flanges about the web's middle: ±A_f y z each."""
    b, h, t = 0.05, 0.1, 0.005
    points = [(0, 0), (b, 0), (b, t), (t, t), (t, h), (t - b, h), (t - b, h - t), (0, h - t)]
    zed = Polygon(tuple(points))
    by_walls = 2.0 * (b - t) * t * -(b / 2.0) * (h - t) / 2.0
    assert zed.product_moment == pytest.approx(-abs(by_walls), rel=1e-12)
    # Point-symmetric: both centres are its middle.
    assert zed.shear_centre == (0.0, 0.0)


def test_tee_has_its_shear_centre_in_the_flange():
    tee = Tee(width=1.0, height=1.0, flange=0.02, web=0.02)
    weights = np.array([1.0 * 0.02, 0.98 * 0.02])
    centroid = weights @ [0.99, 0.49] / weights.sum()
    assert tee.shear_centre[0] == 0.0
    assert tee.shear_centre[1] == pytest.approx(0.99 - centroid, abs=1e-3)


def test_outline_has_any_origin_and_direction():
    """Moved, listed clockwise, from another corner; turned by 90°, mirrored."""
    angle = Angle(width=0.06, height=0.1, flange=0.006, web=0.008)
    points = tuple(map(tuple, angle.loops[0].tolist()))
    same = [
        Polygon(transformed(points, lambda y, z: (y + 3.0, z - 2.0))),
        Polygon(points[::-1]),
        Polygon(points[2:] + points[:2]),
    ]
    for other in same:
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
def test_impossible_section_is_refused_with_one_reason(section, fault):
    (found,) = section.faults()
    assert found.startswith(fault), found


def test_section_by_its_constants_makes_the_same_beam():
    """The numbers of an angle in place of its shape: each entry of the beam, but for rounding."""
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
    shape, numbers = (ConstantLeg(1.0, one, steel).timoshenko for one in (angle, constants))
    # Constants have no coupling of both shears.
    assert astuple(numbers) == pytest.approx(astuple(replace(shape, shear_yz=0.0)), rel=1e-12)
    without = replace(constants, Ay=None, Az=None)
    bent = ConstantLeg(1.0, without, steel).timoshenko
    assert (bent.GAy, bent.GAz) == (np.inf, np.inf)
    # Of a rectangle its own sides.
    rectangle = Rectangle(0.02, 0.05)
    same = SectionProperties(
        rectangle.area, rectangle.second_moment_y, rectangle.second_moment_z, 1e-8
    )
    assert same.extent == pytest.approx(rectangle.extent, rel=1e-12)


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
def test_impossible_constants_give_one_reason(changed, fault):
    sound = SectionProperties(1e-3, 2e-7, 3e-7, 1e-8, Ay=8e-4, Az=7e-4)
    assert sound.faults() == []
    (found,) = replace(sound, **changed).faults()
    assert found.startswith(fault), found
