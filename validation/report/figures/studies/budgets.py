"""The error budget as stacked bars: what is measured, what explains it, and what is left.

Vocabulary of ASME V&V 20: comparison error E = value − reference; allowances for named model
differences; the rest is unexplained and stands against numerical uncertainty and tolerance.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import cycle
from textwrap import fill

import numpy as np

from validation.case import Measurement
from validation.drawing.charts.chart import Bars, Chart, Column, Panel, Series
from validation.drawing.charts.scales import around_zero
from validation.drawing.text import function_name
from validation.exhibits import Figure
from validation.report.figures.declared import Shown, curves
from validation.results.outcome import Outcome

# Of the causes: the hatch tells them apart in black and white.
_HATCHES = ("", "//", "..", "\\\\", "xx", "++", "--")
# How many characters a row's name, and an entry of the legend, have room for in one line.
_NAME_WIDTH, _CAUSE_WIDTH = 38, 46


def budgeted(outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The comparisons that can be drawn: with allowances, and a reference to be relative to."""
    return tuple(
        outcome
        for outcome in outcomes
        if outcome.measurement
        and outcome.measurement.allowances
        and outcome.measurement.reference
        and np.isfinite(outcome.measurement.unexplained)
    )


def budget_figure(identifier: str, title: str, outcomes: Sequence[Outcome]) -> Figure:
    """The budget drawn, of at least one outcome that is `budgeted`."""
    makers = tuple(dict.fromkeys(function_name(one.case.compute) for one in outcomes))
    return budget_curves(outcomes).figure(identifier, title, "budgets", makers)


def budget_curves(outcomes: Sequence[Outcome]) -> Shown:
    """Left the difference and its named causes, right what is left over the tolerance."""
    names = [fill(name, _NAME_WIDTH) for name in _names(outcomes)]
    found = [_measured(outcome) for outcome in outcomes]
    causes = dict.fromkeys(one.cause for measured in found for one in measured.allowances)
    unexplained = np.array([_percent(one, one.unexplained) for one in found])
    bars = [
        Bars(fill(cause, _CAUSE_WIDTH), np.array([_amount(one, cause) for one in found]), hatch)
        for cause, hatch in zip(causes, cycle(_HATCHES), strict=False)
    ]
    rows = np.arange(float(len(names)))
    differences = np.array([_percent(one, one.difference) for one in found])
    # Of the tolerance.
    parts = 100.0 / np.array([outcome.tolerance for outcome in outcomes])
    left = parts * np.array([one.unexplained for one in found])
    uncertain = parts * np.array([one.numerical_uncertainty or 0.0 for one in found])
    whole = Panel(
        [Series("measured difference E", rows, differences)],
        bars=[*bars, Bars("unexplained", unexplained)],
        names=names,
        x_label="value − reference\n(% of the reference)",
        levels=(0.0,),
        lying=True,
    )
    rest = Panel(
        [Series("numerical uncertainty of both sides", rows, left, bars=uncertain)],
        bars=[Bars("unexplained", left)],
        names=names,
        x_label="unexplained\n(% of the tolerance)",
        levels=(0.0,),
        band=(-100.0, 100.0),
        band_label="tolerance",
        scale=partial(around_zero, least=115.0),
        lying=True,
    )
    return curves(
        Chart([whole, rest], "", 2, 0.0, _table(outcomes)),
        "Left: the measured difference (diamond) and the named causes that explain it, each "
        "computed on its own. Right: what no cause explains, with the numerical uncertainty "
        "of both sides; the shaded band is the tolerance.",
    )


def _measured(outcome: Outcome) -> Measurement:
    assert outcome.measurement is not None  # noqa: S101  budgeted outcomes were measured
    return outcome.measurement


def _amount(measurement: Measurement, cause: str) -> float:
    total = sum(a.amount for a in measurement.allowances if a.cause == cause)
    return _percent(measurement, total)


def _percent(measurement: Measurement, amount: float) -> float:
    return 100.0 * amount / abs(measurement.reference)


def _names(outcomes: Sequence[Outcome]) -> list[str]:
    """A name for each row: its label or quantity, or its title where two rows share it."""
    names = [outcome.case.label or outcome.case.quantity for outcome in outcomes]
    return [
        outcome.case.title if names.count(name) > 1 else name
        for outcome, name in zip(outcomes, names, strict=True)
    ]


def _table(outcomes: Sequence[Outcome]) -> Mapping[str, Column]:
    found = [_measured(outcome) for outcome in outcomes]
    shares = {"difference": [_percent(one, one.difference) for one in found]}
    for cause in dict.fromkeys(one.cause for measured in found for one in measured.allowances):
        shares[cause] = [_amount(one, cause) for one in found]
    shares |= {
        "unexplained": [_percent(one, one.unexplained) for one in found],
        "numerical uncertainty": [_percent(one, one.numerical_uncertainty or 0.0) for one in found],
        "tolerance": [
            _percent(one, outcome.tolerance) for one, outcome in zip(found, outcomes, strict=True)
        ],
    }
    named: dict[str, Column] = {"case": [outcome.case.id for outcome in outcomes]}
    return named | {f"{name} (% of the reference)": values for name, values in shares.items()}
