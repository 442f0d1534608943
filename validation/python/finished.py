"""Result record of `run`: comparisons and adequacy as tables and figures, and the report's path.

Input: outcomes and matrix of a finished run. Output: `Run`.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from lumped.errors import InputError
from validation.report.words import sentence
from validation.run.outcome import Outcome, Verdict
from validation.tables import Cell, ResultTable, html_paragraph, html_table
from validation.verdicts import Matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        # Loads the plotting library, which only pictures need.
        from validation.python.finished_plot import finished_plot  # noqa: PLC0415

        compared = [outcome for outcome in self.outcomes if outcome.measurement]
        if not compared:
            raise InputError("plot: no comparison of the run was computed")
        return finished_plot(compared)

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
