"""Drawings of refinement studies and error budgets."""

import numpy as np
import pytest
from support.pages.report_sample import measured

from validation.case import Allowance
from validation.drawing.chart import Series
from validation.report.figures.budgets import budget_figure
from validation.report.figures.studies import _slopes, family_of, study_curves
from validation.studies_and_figures import Study


@pytest.mark.parametrize(
    "x",
    # Divisions rise with refinement, mesh sizes fall.
    [[2.0, 4.0, 8.0], [0.4, 0.2, 0.1]],
    ids=["divisions", "mesh-size"],
)
def test_slope_line_has_formal_order(x):
    """Halving the mesh divides an error of second order by four."""
    x = np.array(x)
    (line,) = _slopes(x, [Series("solid", x, np.array([8.0, 2.0, 0.5]))], [2.0])
    np.testing.assert_allclose(line.y[:-1] / line.y[1:], 4.0)
    # Below the curves, so that it hides none.
    assert line.y[0] == pytest.approx(4.0)
    assert line.label == "slope 2"


def test_convergence_is_in_percent():
    """f = 200 (1 − 1/n²) Hz is 4 % below its limit at n = 5. A limit ± 0.5 Hz has ± 0.25 %."""
    x = (5.0, 10.0, 20.0)
    values = tuple(200.0 * (1.0 - 1.0 / n**2) for n in x)
    fields_of_study = {"limits": {"f1": 200.0}, "uncertainties": {"f1": 0.5}, "orders": {"f1": 2.0}}
    for fields, deviations in (
        (fields_of_study, [-4.0, -1.0, -0.25]),
        # From the finest value instead.
        ({}, [100.0 * (value / values[-1] - 1.0) for value in values]),
    ):
        study = Study("s", "Study", "divisions", "f", "Hz", x, {"f1": values}, 2.0, **fields)
        chart = study_curves(family_of([study]))
        deviation, decay = (panel.series[0] for panel in chart.panels)
        np.testing.assert_allclose(deviation.y, deviations, atol=1e-12)
        not_zero = np.array(deviations)[np.array(deviations) != 0.0]
        np.testing.assert_allclose(decay.y, np.abs(not_zero), atol=1e-12)
        assert deviation.label == ("f1: order 2.00" if fields else "f1: no order")
        if fields:
            np.testing.assert_allclose(deviation.bars, [np.nan, np.nan, 0.25])
            # Below its value it ends before zero, which no logarithmic axis has.
            np.testing.assert_allclose(decay.bars[:, -1], [0.225, 0.25])
        else:
            assert deviation.bars is None


def test_budget_bars_of_causes_are_hatched():
    """In the SVG, hatching consists of elements named `pattern`."""
    allowances = tuple(Allowance(cause, -0.03) for cause in ("warping", "shear", "contraction"))
    outcome = measured("solid", 1.9, 2.0, 1e-4, exact=False, allowances=allowances)
    figure = budget_figure("budget.leg1", "Leg 1", "budgets", [outcome])
    assert figure is not None
    assert figure.svg.count("<pattern") == 2
