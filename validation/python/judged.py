"""Verdicts on models in Python: result records of `adequacy` and `compare_measured`.

Input: a matrix of verdicts against computed or measured references. Output: entries, assertions,
tables and figures. Measured values are compared by ASME V&V 20.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.mechanism.length_unit import UnitOfLength
from lumped.robot_file.evidence import with_options
from validation.adequacy.judgement import verdict_matrix
from validation.console.arguments import arguments_named, checked
from validation.references.reference import Subject
from validation.report.figures.adequacy import error_curves, measured_curves
from validation.report.table import entry_line, matrix_table, table_of
from validation.report.words import sentence
from validation.tables import ResultTable, html_paragraph, html_table
from validation.verdicts import Entry, Matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Adequacy:
    """Verdicts on the models of a robot.

    `matrix` has an entry for each model and quantity, `requirement` the limits, and `subject` the
    models with their references.

    Examples
    --------
    >>> judged = adequacy(bar, preset="quick")
    """

    matrix: Matrix
    requirement: Requirement
    subject: Subject

    @property
    def sentence(self) -> str:
        """Verdict in one sentence, as in the report.

        Examples
        --------
        >>> judged.sentence.startswith("Within the accepted errors, use")
        True
        """
        return sentence(self.matrix, self.requirement.rely)

    @checked
    def entry(self, model: str, quantity: str, within: float | None = None) -> Entry:
        """Error and verdict of a model for a quantity.

        Parameters
        ----------
        model
            A model of the matrix, such as ``"vjm"``.
        quantity
            "x", "phi_z", "any_force", "f1", "order", ``"load:NAME"``, …
        within
            Relative limit. That of `requirement` if None.

        Returns
        -------
        Entry
            ``error``, ``uncertainty`` and ``limit`` (relative), ``verdict``, ``causes`` and
            ``remedy``.

        Raises
        ------
        InputError
            If the model does not define the quantity.

        Examples
        --------
        >>> judged.entry("beam", "z", within=0.5).verdict
        'adequate'
        """
        matrix = self.matrix if within is None else self._within(model, quantity, within)
        return matrix.known_entry(model, quantity)

    @checked
    def assert_adequate(self, model: str, quantity: str, within: float | None = None) -> None:
        """Raise AssertionError unless the model is adequate for the quantity.

        Parameters
        ----------
        model, quantity, within
            As for `entry`.

        Raises
        ------
        AssertionError
            With error, pose, cause and remedy, if the model is inadequate or undecided.
        InputError
            If the model does not define the quantity.

        Examples
        --------
        >>> judged.assert_adequate("beam", "f1", within=0.05)
        """
        entry = self.entry(model, quantity, within)
        if entry.verdict != "adequate":
            raise AssertionError(self.describe(entry))

    @checked
    def accepting(self, accept: Mapping[str, float]) -> "Adequacy":
        """Judge the same errors by other limits.

        Parameters
        ----------
        accept
            Limits by name, as for `load`.

        Returns
        -------
        Adequacy
            The matrix with new verdicts. Nothing is solved again.

        Raises
        ------
        InputError
            For unknown names, and for more modes than were computed.

        Examples
        --------
        >>> strict = judged.accepting({"deflection": 1e-4})
        >>> strict.entry("simplified", "z").limit
        0.0001
        """
        requirement = with_limits(self.requirement, accept, self._lengths)
        if requirement.modes > self.requirement.modes:
            raise InputError(
                f"accept: modes = {requirement.modes}: must be at most "
                f"{self.requirement.modes}, the number of computed modes; request more "
                "with `adequacy`"
            )
        return Adequacy(verdict_matrix(self.subject, requirement), requirement, self.subject)

    def describe(self, entry: Entry) -> str:
        """Describe an entry in one line.

        Parameters
        ----------
        entry
            An entry of the matrix.

        Returns
        -------
        str
            Model, quantity, verdict, error, limit, cause and remedy.

        Examples
        --------
        >>> judged.describe(judged.entry("beam", "z"))[:17]
        'beam, z: adequate'
        """
        return entry_line(self.matrix, entry).replace("\N{NO-BREAK SPACE}", " ")

    @property
    def _lengths(self) -> UnitOfLength:
        """Unit of length of the robot file, for lengths and limits of displacements."""
        return self.subject.responses.robot.mechanism.lengths

    def _within(self, model: str, quantity: str, limit: float) -> Matrix:
        models = [candidate for candidate in self.subject.models if candidate.name == model]
        requirement = with_limits(self.requirement, {quantity: limit}, self._lengths)
        return verdict_matrix(replace(self.subject, models=models, parts=()), requirement)

    def table(self) -> ResultTable:
        """Verdicts, a row for each model and quantity.

        Returns
        -------
        ResultTable
            Errors, half-widths and limits in per cent.

        Examples
        --------
        >>> judged.table().headings[:4]
        ('model', 'quantity', 'verdict', 'error (%)')
        """
        return matrix_table(self.matrix)

    def plot(self) -> "Figure":
        """Errors of the deflections and of the first frequencies over the path, by model.

        Returns
        -------
        matplotlib.figure.Figure
            The shaded band is the limit.

        Raises
        ------
        InputError
            If no error could be computed.

        Examples
        --------
        >>> judged.plot().savefig("errors.png")
        """
        # Imported here: only a picture needs the plotting library.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        curves = error_curves(self.matrix)
        if curves is None:
            raise InputError("plot: there is no error of a deflection or a frequency to plot")
        return drawn_chart(curves)

    def __repr__(self) -> str:
        return f"Adequacy({self.matrix.robot}: {self.sentence})"

    def _repr_html_(self) -> str:
        table = table_of(self.matrix)
        rows = [
            [row.name, *("–" if cell is None else f"{cell.text} {cell.mark}" for cell in row.cells)]
            for row in table.rows
        ]
        verdicts = [
            [None, *(None if cell is None else cell.entry.verdict for cell in row.cells)]
            for row in table.rows
        ]
        headings = ("model", *table.headings)
        return html_paragraph(self.sentence) + html_table(headings, rows, verdicts)


def with_limits(
    requirement: Requirement, accept: Mapping[str, float], lengths: UnitOfLength
) -> Requirement:
    """Copy of a requirement with the limits in `accept`; lengths are in the unit `lengths`."""
    limits = [f"{name}={limit}" for name, limit in accept.items()]
    with arguments_named():
        return with_options(requirement, limits, (), lengths)


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
        # Imported here: only a picture needs the plotting library.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        chart = measured_curves(self.matrix)
        if chart is None:
            raise InputError("plot: the robot has no measured value")
        return drawn_chart(chart)

    def __repr__(self) -> str:
        quantities = ", ".join(quantity.name for quantity in self.matrix.quantities)
        return f"MeasuredComparison({self.matrix.robot}: {quantities})"

    def _repr_html_(self) -> str:
        return self.table().html()
