"""The error budget as stacked bars: what is measured, what explains it, and what is left.

Vocabulary of ASME V&V 20: comparison error E = value − reference; allowances for named model
differences; the rest is unexplained and stands against numerical uncertainty and tolerance.
"""

from collections.abc import Sequence
from functools import partial
from itertools import cycle
from textwrap import fill

import numpy as np

from validation.case import Measurement
from validation.drawing.chart import Bars, Chart, Panel, Series, around_zero
from validation.drawing.figures import drawn_figure
from validation.drawing.text import function_name
from validation.exhibits import Figure
from validation.run.outcome import Outcome

# Of the causes: the hatch tells them apart in black and white.
_HATCHES = ("", "//", "..", "\\\\", "xx", "++", "--")
# How many characters a row's name, and an entry of the legend, have room for in one line.
_NAME_WIDTH, _CAUSE_WIDTH = 38, 46


def budget_figure(
    identifier: str, title: str, section: str, outcomes: Sequence[Outcome]
) -> Figure | None:
    """The budget of what was measured with allowances and has a reference to be relative to."""
    found = [
        (outcome, own)
        for outcome in outcomes
        if (own := outcome.measurement) and own.allowances and own.reference
        if np.isfinite(own.unexplained)
    ]
    if not found:
        return None
    makers = tuple(dict.fromkeys(function_name(outcome.case.compute) for outcome, _ in found))
    return drawn_figure(budget_curves(found), identifier, title, section, makers)


def budget_curves(found: Sequence[tuple[Outcome, Measurement]]) -> Chart:
    """Left the difference and its named causes, right what is left over the tolerance."""
    measured = [one for _, one in found]
    causes = {one.cause: np.zeros(len(found)) for own in measured for one in own.allowances}
    for place, own in enumerate(measured):
        for one in own.allowances:
            causes[one.cause][place] += one.amount
    difference = np.array([one.difference for one in measured])
    left = np.array([one.unexplained for one in measured])
    uncertain = np.array([one.numerical_uncertainty or 0.0 for one in measured])
    tolerance = np.array([outcome.tolerance for outcome, _ in found])
    share = 100.0 / np.abs([one.reference for one in measured])
    of_tolerance = 100.0 / tolerance
    rows, names = np.arange(float(len(found))), _names([outcome for outcome, _ in found])
    hatches = cycle(_HATCHES)
    bars = [
        Bars(fill(cause, _CAUSE_WIDTH), share * amounts, next(hatches))
        for cause, amounts in causes.items()
    ]
    panel = partial(Panel, names=names, levels=(0.0,), lying=True)
    whole = panel(
        [Series("difference E", rows, share * difference)],
        bars=[*bars, Bars("unexplained", share * left)],
        x_label="value − reference\n(% of the reference)",
    )
    spread = of_tolerance * uncertain
    rest = panel(
        [Series("numerical uncertainty of both sides", rows, of_tolerance * left, bars=spread)],
        bars=[Bars("unexplained", of_tolerance * left)],
        x_label="unexplained\n(% of the tolerance)",
        band=(-100.0, 100.0),
        band_label="tolerance",
        scale=partial(around_zero, least=115.0),
    )
    columns = {
        "difference": difference,
        **causes,
        "unexplained": left,
        "numerical uncertainty": uncertain,
        "tolerance": tolerance,
    }
    table = {
        f"{name} (% of the reference)": (share * own).tolist() for name, own in columns.items()
    }
    cases = {"case": [one.case.id for one, _ in found]}
    return Chart([whole, rest], "", 2, 0.0, cases | table).captioned(
        "Left: the difference (diamond) and the named causes that explain it, each "
        "computed on its own. Right: what no cause explains, with the numerical uncertainty "
        "of both sides; the shaded band is the tolerance.",
    )


def _names(outcomes: Sequence[Outcome]) -> list[str]:
    """A name for each row: its label or quantity, or its title where two rows share it."""
    names = [outcome.case.label or outcome.case.quantity for outcome in outcomes]
    return [
        fill(outcome.case.title if names.count(name) > 1 else name, _NAME_WIDTH)
        for outcome, name in zip(outcomes, names, strict=True)
    ]
