"""Refinement studies and error budgets as they are drawn."""

import numpy as np
import pytest
from report_sample import measured

from validation.case import Allowance
from validation.drawing.chart import Series
from validation.report.figures.budgets import budget_figure
from validation.report.figures.studies import _slopes


@pytest.mark.parametrize(
    "x",
    # Divisions rise with refinement, mesh sizes fall.
    [[2.0, 4.0, 8.0], [0.4, 0.2, 0.1]],
    ids=["divisions", "mesh-size"],
)
def test_slope_line_falls_with_refinement_by_its_order(x):
    """Halving the mesh divides an error of second order by four."""
    x = np.array(x)
    (line,) = _slopes(x, [Series("solid", x, np.array([8.0, 2.0, 0.5]))], [2.0])
    np.testing.assert_allclose(line.y[:-1] / line.y[1:], 4.0)
    # Below the curves, so that it hides none.
    assert line.y[0] == pytest.approx(4.0)
    assert line.label == "slope 2"


def test_budget_with_several_causes_is_drawn_hatched():
    """Hatches are patterns, which a drawing may have."""
    allowances = tuple(Allowance(cause, -0.03) for cause in ("warping", "shear", "contraction"))
    outcome = measured("solid", 1.9, 2.0, 1e-4, exact=False, allowances=allowances)
    figure = budget_figure("budget.leg1", "Leg 1", "budgets", [outcome])
    assert figure is not None
    assert figure.svg.count("<pattern") == 2
