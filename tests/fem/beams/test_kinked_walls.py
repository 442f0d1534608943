"""Bending of walls at kinks of boxes and I-sections, against closed forms and solids."""

import numpy as np
import pytest

from fem.beams.kinked_walls import kink_compliances
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import HollowRectangle, ISection
from validation.solids.line_beams import computed_tip

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)
ROOT, TIP = HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.1, 0.056, 0.004)
WIDER = HollowRectangle(0.13, 0.056, 0.004)
FLANGED, LOWER = (ISection(0.08, height, 0.004, 0.004) for height in (0.1, 0.07))


def tube(*stations):
    tip = (stations[-1][0], 0.0, 0.0)
    return LineLeg(CentreLine((LinePiece((0.0, 0.0, 0.0), tip),), (0.0, 0.0, 1.0)), stations, ALLOY)


# Hermite elements across each wall.
ELEMENTS = 12


def frame_work(widths, plate, load):
    """Work of a line load on a box, whose four walls are long plates with common edges.

    At each wave number k along the box, the perimeter is a ring of Hermite elements with the energy
    ½ D ∫ (w″ − k² w)² ds. Edges of the box do not move, and turn with both walls. `load` is a
    function of the wall's number and of η from −1 to 1 across the wall.
    """
    points, weights = np.polynomial.legendre.leggauss(5)
    share = 0.5 * (points + 1.0)
    size = 2 * ELEMENTS * len(widths)
    terms, forces = np.zeros((3, size, size)), np.zeros(size)
    for number in range(ELEMENTS * len(widths)):
        wall, place = divmod(number, ELEMENTS)
        step = widths[wall] / ELEMENTS
        ends = (1.0 - 3.0 * share**2 + 2.0 * share**3, share**2 * (3.0 - 2.0 * share))
        turns = step * share * (1.0 - share) ** 2, step * share**2 * (share - 1.0)
        shapes = np.array([ends[0], turns[0], ends[1], turns[1]])
        slopes = 12.0 * share - 6.0, step * (6.0 * share - 4.0), step * (6.0 * share - 2.0)
        bent = np.array([slopes[0], slopes[1], -slopes[0], slopes[2]]) / step**2
        scaled = 0.5 * step * weights
        unknowns = (2 * number + np.arange(4)) % size
        mixed = (bent * scaled) @ shapes.T
        products = (bent * scaled) @ bent.T, -mixed - mixed.T, (shapes * scaled) @ shapes.T
        for term, product in zip(terms, products, strict=True):
            term[np.ix_(unknowns, unknowns)] += plate * product
        forces[unknowns] += shapes @ (scaled * load(wall, 2.0 * (place + share) / ELEMENTS - 1.0))
    free = np.setdiff1d(np.arange(size), 2 * ELEMENTS * np.arange(len(widths)))
    fractions = np.linspace(0.0, 0.98, 50)
    waves, rates = 30.0 * fractions / (1.0 - fractions), 30.0 / (1.0 - fractions) ** 2
    works = [
        forces[free] @ np.linalg.solve(stiffness[np.ix_(free, free)], forces[free])
        for stiffness in (terms[0] + k**2 * terms[1] + k**4 * terms[2] for k in waves)
    ]
    return np.trapezoid(works * rates, fractions) / np.pi


@pytest.mark.parametrize("tip", [TIP, HollowRectangle(0.07, 0.05, 0.004), WIDER])
def test_kink_bends_box_as_frame_of_plates(tip):
    """Works in tension and in bending about z: walls with common edges, by finite elements.

    The third box grows in width and shrinks in height: neighbouring walls bend in opposite senses.
    """
    leg = tube((0.0, ROOT), (0.3, ROOT), (0.6, tip))
    b, h, t = 0.096, 0.076, 0.004
    plate = ALLOY.E * t**3 / (12.0 * (1.0 - ALLOY.nu**2))
    side, flange = ((tip.width - 0.1) / 0.6, (tip.height - 0.08) / 0.6)
    angles = [side, flange, side, flange]

    def pulled(wall, _eta):
        return t * angles[wall] / ROOT.area * np.ones(5)

    def bent(wall, eta):
        y = [0.5 * b + 0.0 * eta, -0.5 * b * eta, -0.5 * b + 0.0 * eta, 0.5 * b * eta][wall]
        return t * angles[wall] * y / ROOT.second_moment_z

    expected = [frame_work((h, b, h, b), plate, load) for load in (pulled, bent)]
    assert kink_compliances(leg)[[0, 5]] == pytest.approx(expected, rel=1e-3)


def test_tapers_without_kinks_add_nothing():
    assert not kink_compliances(tube((0.0, ROOT), (0.6, TIP))).any()
    middle = HollowRectangle(0.1, 0.068, 0.004)
    assert not kink_compliances(tube((0.0, ROOT), (0.3, middle), (0.6, TIP))).any()


def test_kink_at_step_is_bounded_by_thinner_wall():
    """The bound is the same whether the wall is thicker before the kink or behind it."""
    thick = HollowRectangle(0.1, 0.08, 0.008)
    kinked = tube((0.0, ROOT), (0.3, ROOT), (0.6, TIP))
    stepped = tube((0.0, thick), (0.3, thick), (0.3, ROOT), (0.6, TIP))
    reverse = tube(
        (0.0, ROOT), (0.3, ROOT), (0.3, thick), (0.6, HollowRectangle(0.1, 0.056, 0.008))
    )
    tension = [kink_compliances(leg)[0] for leg in (kinked, stepped, reverse)]
    assert tension == pytest.approx([tension[0]] * 3, rel=1e-12)


def test_flange_bends_as_cantilevers_on_foundations():
    """Tension: the first cantilever mode across half a flange, λ = 1.8751, does 98 % of the work.

    Its share of a uniform load is 2σ/λ = 0.7830, σ = 0.7341. A beam of stiffness B on a foundation
    Bλ⁴/c⁴ deflects by P c³/(2√2 B λ³) under a force P.
    """
    leg = tube((0.0, FLANGED), (0.3, FLANGED), (0.6, LOWER))
    strip = 0.7 * 7.0e10 * 0.004**3 / (12.0 * 0.91)
    load = 0.004 / FLANGED.area * 0.5 * 0.03 / 0.3
    first = load**2 * 0.7830**2 * 0.04**4 / (2.0**1.5 * strip * 1.8751**3)
    assert kink_compliances(leg)[0] == pytest.approx(4.0 * first / 0.979, rel=2e-3)


@pytest.mark.parametrize(
    ("root", "tip", "softened", "share"),
    [
        (ROOT, TIP, [0, 2, 4], 0.5),
        (
            ISection(0.08, 0.1, 0.004, 0.004),
            ISection(0.08, 0.07, 0.004, 0.004),
            [0, 1, 2, 4, 5],
            0.25,
        ),
    ],
    ids=["box", "I"],
)
def test_solid_with_kinks_is_softer_within_bounds(root, tip, softened, share):
    """Solids are 2 to 30 % softer than their beams, by more than a quarter of the bounds.

    Of a box, whose neighbouring walls hold the edges of kinked ones, by more than half.
    """
    leg = tube((0.0, root), (0.12, root), (0.24, tip), (0.36, tip))
    solid = clamped_leg(solid_leg(leg, solid_mesh(leg, 4)), "free").compliance
    added = np.diagonal(solid - computed_tip(leg, 4))
    bounds = kink_compliances(leg)
    assert (added[softened] > 0.02 * np.diagonal(solid)[softened]).all()
    assert (added[softened] > share * bounds[softened]).all()
    assert (added[softened] < bounds[softened]).all()
