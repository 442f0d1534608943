"""Half-widths from three meshes contain the limits of known series and of random parts."""

import numpy as np
import pytest
from support.random.random_parts import RandomPart, random_part, stated
from support.robots.paper_legs import STEEL

from lumped.sections import HollowRectangle
from meshes.part.volume import RATIO
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty

H = np.array([RATIO**2, RATIO, 1.0])


@pytest.mark.parametrize(("order", "width"), [(1.0, 1.5), (1.42, 1.5), (2.0, 1.5), (4.0, 9.0)])
def test_half_width_covers_series_of_known_order(order, width):
    """1.5 times the error for orders from 1 to 2, and 9 times for order 4."""
    values = 2.0 + np.outer(0.01 * H**order, [0.3, -0.1])
    half_widths = refinement_uncertainty(values)
    # Orders above two are not believed, so that the half-width is then wider than necessary.
    assert half_widths / np.abs(values[-1] - 2.0) == pytest.approx([width, width], rel=1e-5)


def test_half_width_uses_common_order():
    """All values share one order, so that a small last step by chance gives no small half-width."""
    # The second number hardly changed in the last step by chance. The first gives the order.
    values = np.array([[1.04, 2.2], [1.02, 2.1], [1.01, 2.0999]])
    assert refinement_uncertainty(values)[1] > 0.05
    # Without convergence the order is one.
    diverging = refinement_uncertainty(values[::-1])
    assert diverging == pytest.approx(1.5 * np.array([0.02, 0.1]) / (RATIO - 1.0), rel=1e-6)


def test_compliance_half_width_uses_diagonal():
    """Entries are compared relative to √(cᵢᵢ cⱼⱼ), so that units do not matter."""
    fine = np.diag([1e-8, 1e-6])
    change = np.array([[1e-10, 1e-10], [1e-10, 1e-8]])
    half_widths = compliance_uncertainty([fine + 2.0 * change, fine + change, fine])
    assert half_widths == pytest.approx(1.5 * change / (RATIO - 1.0), rel=1e-4)


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param([13], marks=pytest.mark.exhaustive),
        pytest.param(range(200), marks=pytest.mark.soak),
    ],
    ids=["one", "calibration"],
)
def test_half_widths_cover_random_parts(seeds, tmp_path, monkeypatch):
    """At least 93 % of the half-widths contain the error; their median is below 6 %."""
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    parts = (random_part(np.random.default_rng([1, seed])) for seed in seeds)
    uncertainty, error = np.moveaxis([stated(part, tmp_path) for part in parts], 1, 0)
    covered = np.mean(np.abs(error) <= uncertainty)
    print(f"covered {covered:.1%}, median half-width {np.median(uncertainty):.2%}")  # noqa: T201
    assert covered >= (1.0 if len(seeds) == 1 else 0.93)
    assert (uncertainty > 0.0).all()
    assert np.median(uncertainty) < 0.06


@pytest.mark.soak
def test_cornered_tube_torsion_is_accurate(tmp_path, monkeypatch):
    """The torsional error is below 0.2 %. Meshes not divided at the corners are 0.6 % too stiff.

    The other five compliances have errors below 0.06 %, which come from the singular edges of the
    rigid ends.
    """
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    box = HollowRectangle(0.1, 0.16, 0.0125)
    part = RandomPart(box, 0.5, (1.0, 1.0), STEEL, "rigid", 60_000)
    uncertainty, errors = stated(part, tmp_path)
    assert (np.abs(errors) <= uncertainty).all()
    assert -2e-3 < errors[3] < 0.0
    assert np.abs(np.delete(errors, 3)).max() < 6e-4
