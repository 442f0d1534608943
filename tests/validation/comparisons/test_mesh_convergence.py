"""Convergence with mesh: solid legs against the exact cantilever and against finer meshes."""

import numpy as np
import pytest
from support.fakes.toy_responses import NO_ROBOT

from lumped.beam_properties import tip_compliance
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from validation.comparisons.discretisations import Discretisation
from validation.comparisons.mesh_convergence import leg_mesh_convergence

LEG = ConstantLeg(0.25, Rectangle(0.05, 0.05), Material(E=2.1e11, G=8.0e10, nu=0.0, rho=7850.0))
FREE = Discretisation("solid", ends="free")


@pytest.fixture(scope="module")
def study():
    return leg_mesh_convergence(NO_ROBOT, "leg", LEG, divisions=(1, 2, 3, 4))


def test_solid_limit_is_timoshenko_beam(study):
    """With ν = 0 and ends free to warp, beam theory is exact in bending and tension."""
    series = next(
        candidate for candidate in study.series if candidate.discretisation.ends == "free"
    )
    expected = np.diag(tip_compliance(LEG.timoshenko, LEG.length))[:3]
    errors = np.abs(series.limits[4:] / expected - 1.0)
    # Shear of a rectangle with ν = 0: κ = 5/6 is exact.
    assert (errors <= series.limit_half_widths[4:]).all()
    assert (series.limit_half_widths[4:] < 1e-3).all()


def test_needed_divisions_are_smallest(study):
    """The needed divisions are the smallest ones within the target.

    0 if the finest mesh misses it.
    """
    all_needed = set()
    for series in study.series:
        sizes = np.abs(series.values / series.limits - 1.0)
        for target, row in zip((0.01, 0.001, 0.0001), series.needed, strict=True):
            for needed, errors in zip(row, sizes.T, strict=True):
                due = [
                    count
                    for index, count in enumerate(series.counts)
                    if (errors[index:] <= target).all()
                ]
                assert needed == (due[0] if due else 0)
                all_needed.add(needed)
    assert len(all_needed) >= 3


def test_half_width_contains_doubled_mesh():
    """Values for 4 divisions lie within the half-widths of 2."""
    coarse = leg_mesh_convergence(NO_ROBOT, "leg", LEG, [FREE], (1, 2)).series[0]
    fine = leg_mesh_convergence(NO_ROBOT, "leg", LEG, [FREE], (2, 4)).series[0]
    assert (np.abs(fine.values[-1] / coarse.values[-1] - 1.0) <= coarse.half_widths[-1]).all()


def test_orders_are_near_formal_ones(study):
    """Quadratic elements without restrained contraction (ν = 0): energies have order four."""
    for series in study.series:
        assert series.formal_order == pytest.approx(4.0)
        # Four meshes of up to four divisions reach half an order.
        assert series.orders[0] == pytest.approx(4.0, abs=0.6)


def random_leg(seed):
    """Random leg, side ratio 1 or 2: its cells are refined alike in both directions."""
    draw = np.random.default_rng(seed)
    width, nu = draw.uniform(0.03, 0.06), draw.uniform(0.0, 0.35)
    sides = Rectangle(width, float(draw.integers(1, 3)) * width)
    material = Material(E=2.1e11, G=2.1e11 / (2.0 * (1.0 + nu)), nu=nu, rho=7850.0)
    return ConstantLeg(draw.uniform(4.0, 6.0) * sides.height, sides, material)


@pytest.mark.parametrize("seed", range(4))
def test_random_free_legs_have_fourth_order(seed):
    """Errors of eigenvalues and energies fall as h⁴ (Strang and Fix 1973, chapters 1 and 6)."""
    orders = leg_mesh_convergence(NO_ROBOT, "leg", random_leg(seed), [FREE]).series[0].orders
    # f1 and f2 bend; y and z are deflections in bending. Four meshes of up to four divisions.
    assert orders[[0, 1, 5, 6]] == pytest.approx(4.0, abs=0.15)


def test_single_mesh_is_refused():
    """Convergence needs two different meshes."""
    with pytest.raises(InputError, match="two or more different"):
        leg_mesh_convergence(NO_ROBOT, "leg", LEG, divisions=(3, 3))
