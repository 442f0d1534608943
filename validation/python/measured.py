"""Result record of `compare_measured`: models against measured values (ASME V&V 20).

Input: the matrix of verdicts against measured values. Output: `MeasuredComparison`, with a table
and a plot.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lumped.errors import InputError
from validation.drawing.style import plot_style
from validation.report.figures.adequacy import measured_curves
from validation.report.table import matrix_table
from validation.tables import ResultTable
from validation.verdicts import Entry, Matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class MeasuredComparison:
    """Every model compared with every measured quantity of a robot.

    An entry of `matrix` has the comparison error E = S − D of the model's value S, relative to the
    measured value D, and the half-width of its 95 % interval from numerics, uncertain inputs and
    measurement.

    Examples
    --------
    >>> gauge = {"quantity": "z", "load": 100.0, "value": 3.25e-4, "uncertainty": 1e-6}
    >>> compared = compare_measured({**bar, "measured": [{**gauge, "source": "dial gauge"}]})
    """

    matrix: Matrix

    def entry(self, model: str, quantity: str) -> Entry:
        """Comparison of a model with a measured quantity.

        Parameters
        ----------
        model
            A model of the matrix, such as ``"beam"``.
        quantity
            A measured quantity, such as ``"f1"`` or ``"z"``.

        Returns
        -------
        Entry
            ``error``, ``uncertainty`` and ``limit`` (relative), ``verdict``, ``causes`` and
            ``remedy``.

        Raises
        ------
        InputError
            If the quantity was not measured, or the model does not define it.

        Examples
        --------
        >>> compared.entry("beam", "z").verdict
        'adequate'
        """
        return self.matrix.known_entry(model, quantity)

    def table(self) -> ResultTable:
        """Table of comparisons, one row for each model and quantity.

        Returns
        -------
        ResultTable
            Errors, half-widths and limits in per cent.

        Examples
        --------
        >>> compared.table().headings[:4]
        ('model', 'quantity', 'verdict', 'error (%)')
        """
        return matrix_table(self.matrix)

    def plot(self) -> "Figure":
        """Plot of each model's value divided by the measured value, with 95 % intervals.

        Returns
        -------
        matplotlib.figure.Figure
            A panel for each measured quantity.

        Raises
        ------
        InputError
            If nothing was measured.

        Examples
        --------
        >>> compared.plot().savefig("measured.png")
        """
        # Loads the plotting library, which only pictures need.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        chart = measured_curves(self.matrix)
        if chart is None:
            raise InputError("plot: the robot has no measured value")
        with plot_style():
            return drawn_chart(chart)

    def __repr__(self) -> str:
        quantities = ", ".join(quantity.name for quantity in self.matrix.quantities)
        return f"MeasuredComparison({self.matrix.robot}: {quantities})"

    def _repr_html_(self) -> str:
        return self.table().html()
