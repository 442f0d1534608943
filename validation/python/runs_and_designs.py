"""Result records of `run` and `vary` in Python, with tables and figures.

Input: outcomes and matrix of a finished run; results of robots that differ in one number. Output:
`Run` with the path of the report, and `Designs` with the best value by each model.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import InputError
from lumped.robot_file.variation import Variation
from validation.drawing.chart import Chart, few_ticks
from validation.drawing.style import GREEN, VERMILLION, WIDTH, Look, plot_style
from validation.report.figures.curves import objective_panel
from validation.report.words import sentence
from validation.run.outcome import Outcome, Verdict
from validation.tables import Cell, ResultTable, html_paragraph, html_table
from validation.variations.curves import VariedCurves
from validation.variations.decision import MEANING, UNITS, Decision, Objective
from validation.verdicts import Matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Height of a row, and of the axis with legend (inches); characters per line of a row's name.
_ROW, _AROUND, _LETTERS = 0.36, 1.1, 38
# Smallest drawn ratio to the tolerance. Smaller ones, such as round-off and zero, are drawn there.
_SMALLEST = 1e-6
_LOOKS: Mapping[Verdict, Look] = {
    "agree": Look(GREEN, "o"),
    "disagree": Look(VERMILLION, "X"),
    "undecided": Look("#777777", "s"),
}


@dataclass(frozen=True, eq=False)
class Run:
    """A finished run: its folder, exit code, comparisons and the matrix of adequacy.

    `outcomes` are the comparisons. `matrix` is None if no model was judged. `seconds` is the
    duration of the run.

    Examples
    --------
    >>> finished = run(bar, out="report", preset="quick", only="bar.converged*")
    """

    out: Path
    exit_code: int
    outcomes: tuple[Outcome, ...]
    matrix: Matrix | None
    seconds: float

    @property
    def report(self) -> Path:
        """Page to open in a browser.

        Examples
        --------
        >>> finished.report.name
        'report.html'
        """
        return self.out / "report.html"

    @property
    def verdicts(self) -> Mapping[Verdict, int]:
        """Number of comparisons by verdict.

        Examples
        --------
        >>> dict(finished.verdicts)
        {'agree': 12}
        """
        return Counter(outcome.verdict for outcome in self.outcomes)

    def table(self) -> ResultTable:
        """Table of comparisons: value, reference, verdict, and difference over tolerance.

        Returns
        -------
        ResultTable
            The last column is the unexplained difference divided by the tolerance, in the pose
            or mode in which it is largest: above 1 the comparison disagrees.

        Examples
        --------
        >>> finished.table().headings[:4]
        ('comparison', 'unit', 'value', 'reference')
        """
        headings = ("comparison", "unit", "value", "reference", "verdict", "difference / tolerance")
        return ResultTable(headings, tuple(map(_row, self.outcomes)))

    def plot(self) -> "Figure":
        """Plot of the ratio of unexplained difference to tolerance of each comparison, by verdict.

        Beyond the line at 1 a comparison disagrees.

        Returns
        -------
        matplotlib.figure.Figure
            A row for each group of comparisons.

        Raises
        ------
        InputError
            If nothing was compared.

        Examples
        --------
        >>> finished.plot().savefig("comparisons.png")
        """
        compared = [outcome for outcome in self.outcomes if outcome.measurement]
        if not compared:
            raise InputError("plot: no comparison of the run was computed")
        return _drawn_outcomes(compared)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {verdict}" for verdict, count in self.verdicts.items())
        return f"Run({str(self.out)!r}: {counts or 'no comparisons'})"

    def _repr_html_(self) -> str:
        judged = html_paragraph(sentence(self.matrix)) if self.matrix else ""
        rows = [[verdict, str(count)] for verdict, count in self.verdicts.items()]
        return judged + html_table(("verdict", "comparisons"), rows)


def _row(outcome: Outcome) -> tuple[Cell, ...]:
    case, measurement = outcome.case, outcome.measurement
    if measurement is None:
        return case.id, case.unit, None, None, outcome.verdict, None
    numbers = measurement.value, measurement.reference
    return case.id, case.unit, *numbers, outcome.verdict, outcome.share


@plot_style()
def _drawn_outcomes(outcomes: Sequence[Outcome]) -> "Figure":
    """Plot with a row for each section, a marker for each comparison, a line at the tolerance."""
    # Imported here: only a picture needs the plotting library.
    from matplotlib.figure import Figure  # noqa: PLC0415

    sections = list(dict.fromkeys(outcome.case.section for outcome in outcomes))
    size = (WIDTH, _AROUND + _ROW * len(sections))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    for verdict, look in _LOOKS.items():
        group = [outcome for outcome in outcomes if outcome.verdict == verdict]
        if group:
            axes.plot(
                np.clip([outcome.share for outcome in group], _SMALLEST, None),
                [sections.index(outcome.case.section) for outcome in group],
                look.marker,
                color=look.colour,
                fillstyle="none",
                markersize=6.0,
                label=f"{verdict} ({len(group)})",
            )
    axes.axvline(1.0, color="black", linestyle="--", linewidth=1.0, label="tolerance")
    axes.set_xscale("log")
    axes.set_xlim(left=0.5 * _SMALLEST)
    axes.set_yticks(range(len(sections)), [fill(name, _LETTERS) for name in sections])
    axes.set_ylim(len(sections) - 0.5, -0.5)
    axes.set_xlabel(f"unexplained difference / tolerance (from {_SMALLEST:g})")
    figure.legend(loc="outside upper left", ncols=4)
    return figure


@dataclass(frozen=True, eq=False)
class Designs:
    """Robots that differ in one number, by all models and by the reference.

    `variation`: the varied number and its n values; `unit`: its unit, "" if it has none.
    `curves`: results of all models and of the reference for the n values, by objective. Objectives
    are the largest deflection (µm, under 1000 N) and smallest first frequency (Hz) over the path.

    Examples
    --------
    >>> designs = vary(bar, "bodies.bar.section.height=0.01:0.03:3", preset="quick")
    """

    robot: str
    variation: Variation
    unit: str
    curves: Mapping[Objective, VariedCurves]

    @property
    def decisions(self) -> Mapping[Objective, Decision]:
        """For each objective, the results of all designs, from which each model chooses the best.

        Examples
        --------
        >>> list(designs.decisions)
        ['deflection', 'frequency']
        """
        return {objective: curves.decision for objective, curves in self.curves.items()}

    def best(self, objective: Objective = "deflection", model: str | None = None) -> float:
        """Best value of the varied number by a model.

        Parameters
        ----------
        objective
            ``"deflection"`` (smallest) or ``"frequency"`` (largest).
        model
            A model, such as ``"beam"``. The reference if None.

        Returns
        -------
        float
            In the unit of the number.

        Raises
        ------
        InputError
            For a model that does not have a solution for every design.

        Examples
        --------
        >>> designs.best("frequency", "beam")
        0.03
        """
        decision = self.decisions[objective]
        if model is None:
            return self.variation.values[decision.best]
        return self.variation.values[self._choice(objective, model)]

    def loss(self, model: str, objective: Objective = "deflection") -> float:
        """Relative loss of the value that a model chooses, evaluated by the reference.

        Parameters
        ----------
        model
            A model, such as ``"beam"``.
        objective
            ``"deflection"`` or ``"frequency"``.

        Returns
        -------
        float
            Relative: 0.02 is a deflection 2 % larger than that of the best design, or a frequency
            2 % lower.

        Raises
        ------
        InputError
            For a model that does not have a solution for every design.

        Examples
        --------
        >>> designs.loss("beam", "frequency")
        0.0
        """
        self._choice(objective, model)
        return self.decisions[objective].choice(model).loss

    def table(self) -> ResultTable:
        """Table of designs: the varied value, then each objective by reference and models.

        Returns
        -------
        ResultTable
            Largest deflections in µm under 1000 N, smallest first frequencies in Hz.

        Examples
        --------
        >>> designs.table().headings[0]
        'bodies.bar.section.height (m)'
        """
        columns = {self._label: list(self.variation.values)}
        for objective, decision in self.decisions.items():
            for name, values in {**decision.references, **decision.models}.items():
                columns[f"{objective} by {name} ({UNITS[objective]})"] = np.ravel(values).tolist()
        return ResultTable(tuple(columns), tuple(zip(*columns.values(), strict=True)))

    def plot(self) -> "Figure":
        """Plot of the largest deflection and smallest first frequency over the varied number.

        Returns
        -------
        matplotlib.figure.Figure
            A curve for each model and the reference; stars mark the choice of each.

        Examples
        --------
        >>> designs.plot().savefig("designs.png")
        """
        # Imported here: plotting is slow to load, and only pictures need it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        x = np.array(self.variation.values)
        panels = [objective_panel(decision, x) for decision in self.decisions.values()]
        return drawn_chart(Chart(panels, self._label, 2, 3.2, {}, few_ticks))

    @property
    def _label(self) -> str:
        return f"{self.variation.key} ({self.unit})" if self.unit else self.variation.key

    def _choice(self, objective: Objective, model: str) -> int:
        decision = self.decisions[objective]
        if model not in decision.models:
            allowed = ", ".join(decision.models)
            raise InputError(
                f'model "{model}": has no {MEANING[objective]}; must be one of {allowed}'
            )
        return decision.choice(model).design

    def __repr__(self) -> str:
        return f"Designs({self.robot}: {len(self.variation.values)} values of {self._label})"

    def _repr_html_(self) -> str:
        return self.table().html()
