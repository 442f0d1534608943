"""Orders of edges and corners in closed form, and uncertainties that hold finer solutions."""

from collections import defaultdict
from itertools import chain

import numpy as np
import pytest
from calibration import ROUNDING, coverage, of_frequencies, of_robots, of_statics, random_leg
from extreme_robots import extreme_robots
from written_robot import robot_of

from lumped.legs import ConstantLeg, Material
from lumped.sections import HollowRectangle, ISection, Rectangle, Tube
from validation.agreement.convergence import pairwise_orders
from validation.catalogue import catalogue
from validation.context import Context
from validation.results.outcome import judge
from validation.solids.legs import edge_order, formal_order, leg_constants, solid_compliances


@pytest.mark.parametrize("nu", [0.2, 0.3, 0.45])
def test_orders_of_edges_are_williams(nu):
    """Energies of stresses r^(λ − 1) within r go as r^(2λ): λ by signs of Williams' equation.

    M. L. Williams (1952), clamped and free sides at 90°; λ = 0.711 for ν = 0.3.
    """
    exponents = np.linspace(0.5, 0.999, 200_001)
    misfit = np.sin(0.5 * np.pi * exponents) ** 2 - (4.0 * (1.0 - nu) ** 2 - exponents**2) / (
        3.0 - 4.0 * nu
    )
    (root,) = exponents[:-1][np.sign(misfit[:-1]) != np.sign(misfit[1:])]
    assert edge_order(nu) == pytest.approx(2.0 * root, abs=1e-5)


def test_edges_without_held_contraction_and_with_held_stretching():
    assert edge_order(0.0) == 4.0
    assert edge_order(0.01) == pytest.approx(2.0, abs=0.05)
    # Complex where stretching is held, near ν = 0 a real root just above 1.
    assert edge_order(-0.9) == pytest.approx(2.077, abs=1e-3)
    assert edge_order(-0.01) == pytest.approx(2.043, abs=1e-3)


def test_rigid_faces_that_hold_stretching_lower_the_order_as_edges_say():
    leg = ConstantLeg(0.2, Rectangle(0.05, 0.04), Material.isotropic(2.1e11, -0.9, 7850.0))
    found = solid_compliances(leg, (1, 2, 3, 4, 6))
    sizes = 1.0 / np.array([1, 2, 3, 4, 6])
    rigid, free = (found[ends].values for ends in ("rigid", "free"))
    # In tension free ends have no error at all.
    assert np.ptp(free[:, 0, 0]) < 1e-9 * free[-1, 0, 0]
    assert pairwise_orders(sizes, rigid[:, 0, 0])[-1] == pytest.approx(edge_order(-0.9), abs=0.2)


def test_the_order_of_elements_is_that_of_free_ends_where_shear_is_soft(tmp_path):
    # A leg known by its 6×6, stiff 26 times as much along it as in shear: with rigid faces, whose
    # edges hold the warping of shear, 1.95 and 1.92 were found.
    robot_file = robot_of(list(extreme_robots(41, 7))[40], tmp_path)
    context = Context(robot_file, "quick")
    for case in catalogue(robot_file):
        if case.id.startswith("refinement.leg2.solid.order"):
            assert judge(case, case.measure(context), 0.0).verdict == "agree", case.id


def test_walls_with_inward_corners_converge_as_the_laplacian_about_270_degrees():
    """λ = π/(3π/2), energies with twice that; the torsion constant of a thick box shows it.

    No inward corner: rectangle, circle, tube. Free ends, so that no held edge is there.
    """
    steel = Material.isotropic(2.1e11, 0.3, 7850.0)
    corner = 2.0 * np.pi / (1.5 * np.pi)
    sections = {
        HollowRectangle(0.1, 0.16, 0.008): corner,
        ISection(0.1, 0.1, 0.008, 0.006): corner,
        Rectangle(0.05, 0.04): 4.0,
        Tube(0.1, 0.01): 4.0,
    }
    for section, order in sections.items():
        assert formal_order(ConstantLeg(1.0, section, steel), "free") == pytest.approx(order)
    # Without corners, held faces alone lower it.
    held = ConstantLeg(1.0, Tube(0.1, 0.01), steel)
    assert formal_order(held, "rigid") == pytest.approx(edge_order(0.3))
    hollow = ConstantLeg(1.0, HollowRectangle(0.1, 0.16, 0.04), steel)
    sizes = 1.0 / np.array([4.0, 8.0, 16.0, 32.0])
    torsion = np.array([leg_constants(hollow, int(1.0 / h)).torsion_constant for h in sizes])
    # From above, for on these grids smooth terms are still seen beside the corner's.
    before, last = pairwise_orders(sizes, torsion)
    assert corner < last < min(before, corner + 0.2)


def random_numbers(seed):
    """Of a rectangular leg, of the robot of two more, every eighth time of frequencies."""
    rng = np.random.default_rng([1, seed])
    leg = random_leg(rng)
    yield from of_statics(leg)
    if seed % 8 == 0:
        yield from of_frequencies(leg)
    yield from of_robots(rng)
    if seed % 40 == 0:
        yield from of_statics(random_leg(np.random.default_rng([1, 1000 + seed]), walls=0.25))


@pytest.mark.parametrize(
    "legs", [1, pytest.param(200, marks=pytest.mark.soak)], ids=["one", "calibration"]
)
def test_stated_uncertainties_hold_the_finest_solution(legs):
    """Shares held and widths over errors, printed by quantity (-s)."""
    found = defaultdict(list)
    first = of_statics(random_leg(np.random.default_rng(5)))
    for one in first if legs == 1 else chain.from_iterable(map(random_numbers, range(legs))):
        found[one.quantity].append(one)
    numbers = [one for group in found.values() for one in group]
    assert sum(one.error > ROUNDING for one in numbers) > 4 * legs
    for quantity, group in sorted(found.items()):
        print(f"{quantity:32} {len(group):5} numbers: held, width {coverage(group)}")  # noqa: T201
    held, width = coverage(numbers)
    assert held >= 0.93
    assert width < 10.0
