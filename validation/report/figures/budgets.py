"""Plot of error budgets as stacked bars: difference, named causes and unexplained remainder.

Input: outcomes with allowances. Output: a figure. In the terms of ASME V&V 20, the comparison error
E = value − reference is the sum of allowances for named model differences and of an unexplained
remainder. The remainder is compared with numerical uncertainty and tolerance.
"""

from collections.abc import Sequence
from functools import partial
from itertools import cycle
from textwrap import fill

import numpy as np

from validation.case import Measurement
from validation.drawing.chart import Bars, Chart, Panel, Series, around_zero
from validation.drawing.figures import drawn_figure
from validation.run.outcome import Outcome
from validation.studies_and_figures import Figure

# Hatches distinguish the causes in black and white.
_HATCHES = ("", "//", "..", "\\\\", "xx", "++", "--")
# Characters in one line of a row's name, and of an entry of the legend.
_NAME_WIDTH, _CAUSE_WIDTH = 38, 46


def budget_figure(
    identifier: str, title: str, section: str, outcomes: Sequence[Outcome]
) -> Figure | None:
    """Figure of the error budgets of outcomes with named causes and a reference.

    None if there are no such outcomes.
    """
    budgeted = [
        (outcome, measurement)
        for outcome in outcomes
        if (measurement := outcome.measurement) and measurement.allowances and measurement.reference
        if np.isfinite(measurement.unexplained)
    ]
    if not budgeted:
        return None
    makers = tuple(dict.fromkeys(outcome.computed_by for outcome, _ in budgeted))
    return drawn_figure(budget_curves(budgeted), identifier, title, section, makers)


def budget_curves(budgeted: Sequence[tuple[Outcome, Measurement]]) -> Chart:
    """Chart of differences split into named causes (left), and of unexplained parts (right).

    The differences are in per cent of the reference, the unexplained parts in per cent of the
    tolerance.
    """
    measurements = [measurement for _, measurement in budgeted]
    causes = {
        allowance.cause: np.zeros(len(budgeted))
        for measurement in measurements
        for allowance in measurement.allowances
    }
    for row, measurement in enumerate(measurements):
        for allowance in measurement.allowances:
            causes[allowance.cause][row] += allowance.amount
    difference = np.array([measurement.difference for measurement in measurements])
    unexplained = np.array([measurement.unexplained for measurement in measurements])
    uncertainties = np.array(
        [measurement.numerical_uncertainty or 0.0 for measurement in measurements]
    )
    tolerance = np.array([outcome.tolerance for outcome, _ in budgeted])
    share = 100.0 / np.abs([measurement.reference for measurement in measurements])
    of_tolerance = 100.0 / tolerance
    rows, names = np.arange(float(len(budgeted))), _names([outcome for outcome, _ in budgeted])
    hatches = cycle(_HATCHES)
    bars = [
        Bars(fill(cause, _CAUSE_WIDTH), share * amounts, next(hatches))
        for cause, amounts in causes.items()
    ]
    panel = partial(Panel, names=names, levels=(0.0,), lying=True)
    differences = panel(
        [Series("difference", rows, share * difference)],
        bars=[*bars, Bars("unexplained", share * unexplained)],
        x_label="value − reference\n(% of the reference)",
    )
    spread = of_tolerance * uncertainties
    remainders = panel(
        [
            Series(
                "numerical uncertainty of model and reference",
                rows,
                of_tolerance * unexplained,
                bars=spread,
            )
        ],
        bars=[Bars("unexplained", of_tolerance * unexplained)],
        x_label="unexplained\n(% of the tolerance)",
        band=(-100.0, 100.0),
        band_label="tolerance",
        scale=partial(around_zero, least=115.0),
    )
    columns = {
        "difference": difference,
        **causes,
        "unexplained": unexplained,
        "numerical uncertainty": uncertainties,
        "tolerance": tolerance,
    }
    table = {
        f"{name} (% of the reference)": (share * values).tolist()
        for name, values in columns.items()
    }
    cases = {"case": [outcome.case.id for outcome, _ in budgeted]}
    return Chart([differences, remainders], "", 2, 0.0, cases | table).captioned(
        "One row for each comparison. Left: difference, model − reference, in percent of "
        "the reference (diamond), split into the named causes, each computed separately, "
        "and the unexplained remainder. Right: this remainder in percent of the "
        "tolerance; its error bar is the numerical uncertainty of model and reference; "
        "shaded band: the tolerance. A comparison agrees if its remainder ends inside the "
        "band.",
    )


def _names(outcomes: Sequence[Outcome]) -> list[str]:
    """Name of each outcome: its label or quantity, or its title if two names would be equal."""
    names = [outcome.case.label or outcome.case.quantity for outcome in outcomes]
    return [
        fill(outcome.case.title if names.count(name) > 1 else name, _NAME_WIDTH)
        for outcome, name in zip(outcomes, names, strict=True)
    ]
