"""Section constants of worked examples in textbooks, by boundary and by finite elements.

W. D. Pilkey, Analysis and Design of Elastic Beams (2002): examples of chapters 1, 5 and 6 and of
appendix B, in the units of the book. Its elements are quadrilaterals of nine nodes; it gives
1/κ, the shear centre for Poisson's ratio ν, and Γ. Roark is W. C. Young, R. G. Budynas, Roark's
Formulas for Stress and Strain (2002).
"""

from dataclasses import replace

import numpy as np
import pytest

from fem.sections.section_constants import section_constants
from lumped.legs import ConstantLeg, Material
from lumped.sections import (
    Angle,
    Channel,
    Composite,
    CompositePart,
    HollowRectangle,
    Polygon,
    Rectangle,
    Tube,
)
from meshes.section.section_mesh import section_mesh

# Relative differences of J and 1/κ from the book where the shear stress is singular, at re-entrant
# corners: of meshes with ten elements across the smaller side, and of boundary elements. J of
# meshes, the book's included, falls as they are refined, here to values 0.2 % below the book's.
SINGULAR, SINGULAR_RIM = 1e-3, 2.5e-3
# Last printed digit of quantities without such errors.
PRINTED = 1e-5


def about_centroid(section):
    """Return Iy, Iz and Iyz."""
    return section.second_moment_y, section.second_moment_z, section.product_moment


def on_mesh(section, nu):
    """Return the constants of a section by finite elements, and the shear centre from centroid."""
    constants = section_constants(section_mesh(section, 10), nu)
    return constants, np.subtract(constants.shear_centre, constants.centroid)


# Walls around their middle lines: width and height are half a thickness longer.
CHANNEL_6_2 = Channel(width=1.05, height=2.1, flange=0.1, web=0.1)
CHANNEL_B_2 = Channel(width=8.5, height=19.0, flange=1.0, web=1.0)
ANGLE_1_1 = Angle(width=1.05, height=2.05, flange=0.1, web=0.1)
ANGLE_B_3 = Angle(width=6.0, height=8.0, flange=0.75, web=0.75)
ANGLE_6_7 = Angle(width=10.5, height=15.5, flange=1.0, web=1.0)
TRAPEZOID = Polygon(((-0.5, -1.0), (0.5, -1.0), (0.5, 2.0), (-0.5, 1.0)))


@pytest.mark.parametrize(
    ("section", "area", "moments"),
    [
        (CHANNEL_B_2, 34.0, (1787.83333, 223.30208, 0.0)),
        (ANGLE_B_3, 9.9375, (63.42455, 30.72142, -25.85377)),
    ],
    ids=["B.2", "B.3"],
)
def test_moments_of_area_equal_pilkey(section, area, moments):
    """Examples B.2 and B.3: area, second moments and product of inertia about the centroid."""
    assert section.area == pytest.approx(area, rel=1e-12)
    assert about_centroid(section) == pytest.approx(moments, abs=PRINTED)


def test_thin_angle_equals_pilkey():
    """Example 1.1, with overlapping middle lines: A 0.3, I 0.1336, 0.0252, 0.0332; J 0.00099."""
    assert ANGLE_1_1.area == pytest.approx(0.3, rel=1e-12)
    y, z, product = about_centroid(ANGLE_1_1)
    assert (y, z, -product) == pytest.approx((0.1336, 0.0252, 0.0332), abs=6e-5)
    largest, smallest = np.linalg.eigvalsh([[y, product], [product, z]])[::-1]
    assert (largest, smallest) == pytest.approx((0.1430, 0.0158), abs=6e-5)
    # Example 5.14.
    computed, _ = on_mesh(ANGLE_1_1, 0.3)
    assert computed.torsion_constant == pytest.approx(0.00099, abs=5e-6)


# ν; from the centroid the shear centre; 1/κ along y and z; J and Γ.
CHANNELS = {
    "6.2": (CHANNEL_6_2, 0.3, -0.62056, (3.09621, 2.34102), 1.33e-3, None),
    "B.2": (CHANNEL_B_2, 1.0 / 3.0, -2.86769 - 1.875, (3.40789, 2.15337), 11.28862, 12763.15184),
}


@pytest.mark.parametrize("example", CHANNELS)
def test_channel_mesh_equals_pilkey(example):
    """Channels of the book: shear centre, 1/κ, torsion and warping constants by finite elements."""
    section, nu, centre, flexibilities, torsion, warping = CHANNELS[example]
    computed, offset = on_mesh(section, nu)
    assert offset == pytest.approx((centre, 0.0), abs=2e-4 * section.height)
    inverse = 1.0 / np.array(computed.shear_coefficients)
    assert inverse == pytest.approx(flexibilities, rel=SINGULAR)
    assert computed.torsion_constant == pytest.approx(torsion, rel=SINGULAR)
    if warping is not None:
        assert computed.warping_constant == pytest.approx(warping, rel=2e-4)


def test_channel_formulas_equal_pilkey():
    """Example B.2 of Pilkey (2002), whose values are by boundary elements."""
    _, nu, centre, flexibilities, torsion, _ = CHANNELS["B.2"]
    assert CHANNEL_B_2.shear_centre == pytest.approx((centre, 0.0), abs=2e-3)
    inverse = 1.0 / np.array(CHANNEL_B_2.shear_coefficients(nu))
    assert inverse == pytest.approx(flexibilities, rel=SINGULAR_RIM)
    assert CHANNEL_B_2.torsion_constant == pytest.approx(torsion, rel=SINGULAR_RIM)


def test_angle_shear_centre_equals_pilkey():
    """Example B.3: shear centre 0.003 and 0.057 beside the corner of the middle lines."""
    _, offset = on_mesh(ANGLE_B_3, 1.0 / 3.0)
    from_corner = offset + np.array([1.18868, 2.18868])
    assert from_corner == pytest.approx([0.00313, 0.05735], abs=1e-3)


def test_unequal_angle_equals_pilkey():
    """Example 6.7, ν = 0: J, shear centre, 1/κ and the coupling of both directions."""
    computed, offset = on_mesh(ANGLE_6_7, 0.0)
    assert computed.torsion_constant == pytest.approx(8.211705, rel=SINGULAR)
    assert offset == pytest.approx((-1.997641, -4.423925), abs=1e-4)
    inverse = 1.0 / np.array(computed.shear_coefficients)
    assert inverse == pytest.approx((3.058207, 1.898375), rel=SINGULAR)
    assert computed.shear_coupling == pytest.approx(0.039510, abs=1e-4)


# Example 6.6: shear centre from the centroid, 1/κ along y and z, coupling.
TRAPEZOIDS = {
    0.0: ((-0.069460, -0.072013), (1.313417, 1.169516), -0.063785),
    0.3: ((-0.071690, -0.090135), (1.465389, 1.170704), -0.076064),
    0.5: ((-0.072681, -0.098190), (1.630496, 1.171995), -0.089406),
}


@pytest.mark.parametrize("nu", TRAPEZOIDS)
def test_trapezoid_shear_equals_pilkey(nu):
    """The book's shear centre moves with ν, the centre of twist (Trefftz) used here does not.

    A force at the distance d from the centre of twist also twists: its strain energy is larger by
    the torsion d²/2GJ, so that 1/κ of the book is larger by A d²/J.
    """
    centre, flexibilities, coupling = TRAPEZOIDS[nu]
    fixed_centre = np.array(TRAPEZOIDS[0.0][0])
    assert TRAPEZOID.shear_centre == pytest.approx(fixed_centre, abs=1e-5)
    y, z = np.array(centre) - fixed_centre
    twist = TRAPEZOID.area / TRAPEZOID.torsion_constant * np.outer([-z, y], [-z, y])
    inverse = 1.0 / np.array(TRAPEZOID.shear_coefficients(nu)) + np.diag(twist)
    assert inverse == pytest.approx(flexibilities, rel=PRINTED)
    assert TRAPEZOID.shear_coupling(nu) + twist[0, 1] == pytest.approx(coupling, abs=PRINTED)


@pytest.mark.parametrize(
    ("nu", "expected"), [(0.0, (1.2, 1.2)), (0.3, (1.20056, 1.27479)), (0.5, (1.20118, 1.35605))]
)
def test_rectangle_shear_equals_pilkey(nu, expected):
    """Example 6.5: 1/κ of a rectangle of 2 × 1, along its longer and its shorter side."""
    computed, _ = on_mesh(Rectangle(2.0, 1.0), nu)
    inverse = 1.0 / np.array(computed.shear_coefficients)
    assert inverse == pytest.approx(expected, abs=3.0 * PRINTED)


def test_tube_torsion_equals_pilkey():
    """Example 5.7: 91.49 in⁴ for a tube of 8 in × 1/4 in, 0.13 in⁴ with a slit."""
    assert Tube(8.0, 0.25).torsion_constant == pytest.approx(91.49, abs=5e-3)
    assert slit_tube(3.875, 0.25).torsion_constant == pytest.approx(0.13, abs=5e-3)


def test_strip_of_two_metals_equals_pilkey():
    """Example 5.13: aluminium and copper, 2 in × 15 in each: EA/E 83.36 in², GJ/G 106.22 in⁴."""
    aluminium, copper = 10.4e6, 18.5e6
    strip = Composite(
        (
            CompositePart(Rectangle(15.0, 2.0), aluminium, 0.3, 1.0, at=(7.5, 1.0)),
            CompositePart(Rectangle(15.0, 2.0), copper, 0.3, 1.0, at=(22.5, 1.0)),
        )
    )
    beam = ConstantLeg(1.0, strip, Material(*strip.mean_material)).timoshenko
    assert beam.EA / aluminium == pytest.approx(83.36, abs=0.01)
    torsion = beam.GJ / (aluminium / 2.6)
    # The book's mesh is 0.1 % too stiff. Differences of Prandtl's function converge to 106.117.
    assert torsion == pytest.approx(106.22, rel=1.1e-3)
    assert torsion == pytest.approx(106.117, rel=2e-5)


def bent_strip(radius, thickness, opening, nu, count):
    """Return the constants of a circular arc around the y axis, `opening` (rad) from end to end."""
    strip = section_mesh(Rectangle(1.0, 1.0), (2, count))
    r = radius + thickness * strip.nodes[:, 0]
    angle = opening * strip.nodes[:, 1]
    nodes = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
    return section_constants(replace(strip, nodes=nodes), nu)


def slit_tube(radius, thickness):
    return bent_strip(radius, thickness, 2.0 * np.pi, 1.0 / 3.0, 40)


def test_open_tube_equals_pilkey():
    """Example B.4: mean radius 8, thickness 1.25, shear centre 15.903 from the centre."""
    computed = slit_tube(8.0, 1.25)
    assert computed.area == pytest.approx(62.83182, rel=PRINTED)
    assert computed.second_moment_y == pytest.approx(2022.889, rel=PRINTED)
    # The book closes the slit with a spline of its own: 0.1 %.
    assert abs(computed.shear_centre[0]) == pytest.approx(23.90306 - 8.0, rel=1e-3)
    assert computed.torsion_constant == pytest.approx(32.23967, rel=2e-3)
    assert computed.warping_constant == pytest.approx(331651.29, rel=2e-3)
    inverse = 1.0 / np.array(computed.shear_coefficients)
    assert inverse == pytest.approx((1.98015, 5.93977), rel=1e-3)


def test_circular_arc_equals_pilkey():
    """Example B.7: radius 16, thickness 0.5, opening 120°."""
    computed = bent_strip(16.0, 0.5, 2.0 * np.pi / 3.0, 1.0 / 3.0, 80)
    assert computed.area == pytest.approx(16.75516, rel=PRINTED)
    assert computed.second_moment_y == pytest.approx(1258.15764, rel=PRINTED)
    assert computed.second_moment_z == pytest.approx(98.18931, rel=PRINTED)
    assert computed.centroid[0] == pytest.approx(13.23297, rel=PRINTED)
    assert computed.shear_centre[0] == pytest.approx(17.83662, rel=1e-4)
    assert computed.torsion_constant == pytest.approx(1.38355, rel=1e-4)
    assert computed.warping_constant == pytest.approx(1046.49221, rel=1e-4)
    inverse = 1.0 / np.array(computed.shear_coefficients)
    assert inverse == pytest.approx((4.60034, 1.50823), rel=1e-3)


def test_square_box_equals_bredt():
    """Bredt: J = t b³ for middle lines of b, up to the square of t/b."""
    errors = []
    for t in (0.04, 0.02):
        computed = section_constants(section_mesh(HollowRectangle(1.0 + t, 1.0 + t, t), 4), 0.3)
        errors.append(computed.torsion_constant / t - 1.0)
    assert 2.0 * errors[1] - errors[0] == pytest.approx(0.0, abs=2e-3)


def lipped_channel(b, h, lip, t):
    """Return a channel with lips; b, h and `lip` are lengths of middle lines."""
    s = t / 2.0
    lower = [
        *((-s, -h / 2 - s), (b + s, -h / 2 - s), (b + s, lip - h / 2)),
        *((b - s, lip - h / 2), (b - s, s - h / 2), (s, s - h / 2)),
    ]
    return Polygon(tuple(lower + [(y, -z) for y, z in reversed(lower)]))


def test_lipped_channel_equals_roark():
    """Table 9.2: e and Γ of a channel with lips, as the walls become thin.

    e = b (3h²b + 6h²c − 8c³)/(h³ + 6h²b + 6h²c + 8c³ − 12hc²) from the web, for lips of length c.
    """
    b, h, c = 0.5, 1.0, 0.2
    e = b * (3 * h**2 * b + 6 * h**2 * c - 8 * c**3)
    e /= h**3 + 6 * h**2 * b + 6 * h**2 * c + 8 * c**3 - 12 * h * c**2
    flanges = h**2 * b**2 / 2 * (c + b / 3 - e - 2 * e * c / b + 2 * c**2 / h)
    web = h**2 * e**2 / 2 * (b + c + h / 6 - 2 * c**2 / h)
    gamma = flanges + web + 2 * c**3 / 3 * (b + e) ** 2
    centroid = (b**2 + 2.0 * b * c) / (h + 2.0 * b + 2.0 * c)
    values = []
    for t in (0.04, 0.02):
        computed = section_constants(section_mesh(lipped_channel(b, h, c, t), 4), 0.3)
        offset = np.subtract(computed.shear_centre, computed.centroid)
        values.append((-offset[0] - centroid, computed.warping_constant / t))
    # Linear in t: from 4 % and 2 % of the height to thin walls.
    thin = 2.0 * np.array(values[1]) - values[0]
    assert thin == pytest.approx((e, gamma), rel=4e-3)
