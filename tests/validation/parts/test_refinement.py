"""What three meshes leave open: series whose limit is known, and parts at random."""

import numpy as np
import pytest
from prismatic_legs import STEEL
from random_parts import RandomPart, random_part, stated

from lumped.sections import HollowRectangle
from meshes.part.volume import RATIO
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty

H = np.array([RATIO**2, RATIO, 1.0])


@pytest.mark.parametrize(("order", "width"), [(1.0, 1.5), (1.42, 1.5), (2.0, 1.5), (4.0, 9.0)])
def test_a_series_of_one_order_is_held(order, width):
    values = 2.0 + np.outer(0.01 * H**order, [0.3, -0.1])
    found = refinement_uncertainty(*values)
    # Beyond the second order much wider than it would have to be: it is not believed.
    assert found / np.abs(values[-1] - 2.0) == pytest.approx([width, width], rel=1e-5)


def test_one_number_by_chance_is_no_order():
    # The second number hardly changed in the last step, the others say of which order meshes are.
    values = np.array([[1.04, 2.2], [1.02, 2.1], [1.01, 2.0999]])
    assert refinement_uncertainty(*values)[1] > 0.05
    # Where refinement brings nothing nearer, the first order is all that is granted.
    worse = refinement_uncertainty(*values[::-1])
    assert worse == pytest.approx(1.5 * np.array([0.02, 0.1]) / (RATIO - 1.0), rel=1e-6)


def test_entries_of_a_compliance_are_relative_to_the_diagonal():
    fine = np.diag([1e-8, 1e-6])
    change = np.array([[1e-10, 1e-10], [1e-10, 1e-8]])
    stated = compliance_uncertainty(fine + 2.0 * change, fine + change, fine)
    assert stated == pytest.approx(1.5 * change / (RATIO - 1.0), rel=1e-4)


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param([13], marks=pytest.mark.exhaustive),
        pytest.param(range(200), marks=pytest.mark.soak),
    ],
    ids=["one", "calibration"],
)
def test_parts_at_random_are_held(seeds, tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    parts = (random_part(np.random.default_rng([1, seed])) for seed in seeds)
    uncertainty, error = np.moveaxis([stated(part, tmp_path) for part in parts], 1, 0)
    held = np.mean(np.abs(error) <= uncertainty)
    print(f"held {held:.1%}, median stated {np.median(uncertainty):.2%}")  # noqa: T201
    assert held >= (1.0 if len(seeds) == 1 else 0.93)
    assert (uncertainty > 0.0).all()
    assert np.median(uncertainty) < 0.06


@pytest.mark.exhaustive
def test_torsion_of_a_tube_with_sharp_inner_corners(tmp_path, monkeypatch):
    """0.2 %, where meshes that are not cut there are 0.6 % too stiff at as many unknowns.

    The other five stay within 0.06 %: the edges of the held ends are singular, too.
    """
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    box = HollowRectangle(0.1, 0.16, 0.0125)
    part = RandomPart(box, 0.5, (1.0, 1.0), STEEL, "rigid", 60_000)
    uncertainty, errors = stated(part, tmp_path)
    assert (np.abs(errors) <= uncertainty).all()
    assert -2e-3 < errors[3] < 0.0
    assert np.abs(np.delete(errors, 3)).max() < 6e-4
