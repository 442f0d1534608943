"""Published constants of thin-walled sections, from finite elements as the walls become thin.

Middle lines are b = 50 mm along y and h = 100 mm along z, walls have the thickness t. Values at 4,
2 and 1 mm are extrapolated to t = 0 by a parabola. Meshes have errors up to 1.6e-3 of the limit.
"""

import numpy as np
import pytest

from fem.sections.section_constants import section_constants
from lumped.sections import Angle, Channel, HollowRectangle, Polygon, Tee
from meshes.section.section_mesh import section_mesh

b, h = 0.05, 0.1
THICKNESSES = (4e-3, 2e-3, 1e-3)
# Flange of twice the width of the other, at the smaller z.
WIDE, NARROW = 0.06, 0.03
# Cells of the double box, along y.
LEFT, RIGHT = 0.03, 0.06


def rectangle(y0, y1, z0, z1):
    return (y0, z0), (y1, z0), (y1, z1), (y0, z1)


def zed(t):
    s, top = t / 2.0, h / 2.0 + t / 2.0
    half = ((-s, -top), (b, -top), (b, t - top), (s, t - top))
    return Polygon((*half, *((-y, -z) for y, z in half)))


def unequal_i(t):
    s, top = t / 2.0, h / 2.0 + t / 2.0
    right = (
        *((WIDE / 2.0, -top), (WIDE / 2.0, t - top), (s, t - top)),
        *((s, top - t), (NARROW / 2.0, top - t), (NARROW / 2.0, top)),
    )
    return Polygon((*right, *((-y, z) for y, z in reversed(right))))


def double_box(t):
    s, top = t / 2.0, h / 2.0
    cells = (
        rectangle(s - LEFT, -s, s - top, top - s),
        rectangle(s, RIGHT - s, s - top, top - s),
    )
    return Polygon(rectangle(-LEFT - s, RIGHT + s, -top - s, top + s), cells)


def limit(section, quantity):
    """Value of a quantity at t = 0. `quantity` is a function of constants and t."""
    coarse, middle, fine = (
        np.array(quantity(section_constants(section_mesh(section(t), 8), 0.3), t))
        for t in THICKNESSES
    )
    return (8.0 * fine - 6.0 * middle + coarse) / 3.0


def from_centroid(constants, _):
    return np.subtract(constants.shear_centre, constants.centroid)


def warping(power):
    return lambda constants, t: constants.warping_constant / t**power


def torsion(power):
    return lambda constants, t: constants.torsion_constant / t**power


def channel(t):
    return Channel(b + t / 2.0, h + t, t, t)


def angle(t):
    return Angle(b + t / 2.0, h + t / 2.0, t, t)


def tee(t):
    return Tee(b, h + t / 2.0, t, t)


def box(t):
    return HollowRectangle(b + t, h + t, t)


INERTIAS = WIDE**3 / 12.0, NARROW**3 / 12.0
I_SHARE = INERTIAS[1] / sum(INERTIAS)
# Perimeters of both cells, and areas.
ROUND = 2.0 * (LEFT + h), 2.0 * (RIGHT + h)
AREAS = LEFT * h, RIGHT * h
BATHO = (
    4.0
    * (AREAS[0] ** 2 * ROUND[1] + AREAS[1] ** 2 * ROUND[0] + 2.0 * AREAS[0] * AREAS[1] * h)
    / (ROUND[0] * ROUND[1] - h**2)
)
# Distances of the centroid: of channel and angle from the web, of angle and tee from the flange.
WEB, CORNER, FLANGE = b**2 / (2.0 * b + h), b**2 / (2.0 * (b + h)), h**2 / (2.0 * (b + h))
LOW = (NARROW * h + h**2 / 2.0) / (WIDE + NARROW + h)

I_WARPING = h**2 * INERTIAS[0] * INERTIAS[1] / sum(INERTIAS)
CHANNEL_CENTRE = -3.0 * b**2 / (6.0 * b + h) - WEB
CHANNEL_WARPING = b**3 * h**2 / 12.0 * (3.0 * b + 2.0 * h) / (6.0 * b + h)
ZED_WARPING = b**3 * h**2 / 12.0 * (b + 2.0 * h) / (2.0 * b + h)
BOX_WARPING = (b * h * (b - h)) ** 2 / (24.0 * (b + h))
# Table A.3 of S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability (1961).
CASES = {
    "Timoshenko-Gere channel e": (channel, from_centroid, (CHANNEL_CENTRE, 0.0)),
    "Timoshenko-Gere channel Cw": (channel, warping(1), CHANNEL_WARPING),
    "Timoshenko-Gere zed Cw": (zed, warping(1), ZED_WARPING),
    "Timoshenko-Gere I e": (unequal_i, from_centroid, (0.0, h * I_SHARE - LOW)),
    "Timoshenko-Gere I Cw": (unequal_i, warping(1), I_WARPING),
    "corner of an angle": (angle, from_centroid, (-CORNER, -FLANGE)),
    "Bleich angle Cw": (angle, warping(3), (b**3 + h**3) / 36.0),
    "flange of a tee": (tee, from_centroid, (0.0, FLANGE)),
    "Bleich tee Cw": (tee, warping(3), b**3 / 144.0 + h**3 / 36.0),
    "Vlasov box Cw": (box, warping(1), BOX_WARPING),
    "Bredt box J": (box, torsion(1), 2.0 * (b * h) ** 2 / (b + h)),
    "Bredt-Batho double box J": (double_box, torsion(1), BATHO),
    "Saint-Venant channel J": (channel, torsion(3), (2.0 * b + h) / 3.0),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_thin_section_has_published_constant(case):
    """Torsion and warping constants and shear centres of open and closed sections."""
    section, quantity, published = case
    size = np.abs(published).max()
    assert limit(section, quantity) == pytest.approx(np.array(published), abs=2e-3 * size)
