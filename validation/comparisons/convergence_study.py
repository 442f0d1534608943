"""Convergence study of a leg or robot: all its series, with tables, texts, data and plots.

Input: a `ConvergenceSeries` for each formulation. Output: errors, orders and half-widths by
quantity as text, table, JSON, CSV or picture, and AssertionError if an error exceeds its limit.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Literal

import msgspec
import numpy as np

from lumped.acceptance.requirement import DEFAULT_LIMITS, AgreementLimits
from lumped.errors import InputError
from lumped.mechanism.mechanism import UNITS_OF_MOVES
from lumped.model_choices import Layout, Theory
from validation.comparisons.convergence_chart import ErrorPanel, convergence_chart
from validation.comparisons.convergence_series import (
    TARGETS,
    ConvergenceSeries,
    SeriesRecord,
    series_cells,
    series_record,
    series_rows,
    short_summary,
    summary,
)
from validation.comparisons.discretisations import PARAMETERS
from validation.drawing.chart import Chart
from validation.drawing.style import csv_of
from validation.drawing.text import number, percent
from validation.models.options import RefinedModel
from validation.record_fields import json_text
from validation.studies_and_figures import ElementStudy
from validation.tables import ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class StudyRecord(msgspec.Struct, frozen=True, kw_only=True):
    """JSON document of `converge`. `body` is None for the whole robot."""

    schema: Literal[1] = 1
    kind: Literal["convergence"] = "convergence"
    robot: str
    body: str | None
    pose: Sequence[float]
    reference: str
    quantities: Sequence[str]
    units: Mapping[str, str]
    series: Sequence[SeriesRecord]


@dataclass(frozen=True, eq=False)
class ConvergenceStudy:
    """Convergence of a leg or of a robot with element count, or with the mesh of solids.

    `subject` is the body's name, or empty for the whole robot. The robot is in `pose`: its
    coordinates (m, rad) by name. `quantities` (q) are f1, f2, … (Hz) and x, y, z: the deflection of
    the tip or tool under a unit force along that axis (m/N). `reference` names the source of the
    limits. `agreement` contains the element count at which the error is judged, and the limit on
    this error.

    Examples
    --------
    >>> study = converge(bar, "beam", elements=[5, 10, 20])
    """

    robot: str
    subject: str
    pose: Mapping[str, float]
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    reference: str
    series: tuple[ConvergenceSeries, ...]
    agreement: AgreementLimits = DEFAULT_LIMITS

    @property
    def refined(self) -> str:
        """Parameter over which the errors are shown: "elements", or "divisions" of a mesh."""
        return self.series[0].discretisation.refined if self.series else "elements"

    @property
    def title(self) -> str:
        """Name of the leg and its end conditions, or the pose of the whole robot."""
        if self.subject:
            return f"{self.subject}, clamped–free"
        pose = ", ".join(
            f"{name} = {value:.4g} {UNITS_OF_MOVES[name]}" for name, value in self.pose.items()
        )
        return f"whole robot at {pose}" if pose else "whole robot"

    def of(
        self, model: RefinedModel, layout: Layout = "half", theory: Theory = "timoshenko"
    ) -> ConvergenceSeries:
        """Series of a formulation: values, errors, limits and orders.

        Parameters
        ----------
        model
            ``"segments"``, ``"beam"`` or ``"solid"``.
        layout
            Springs of segments: ``"half"`` with springs of half length at both ends, or
            ``"literal"`` as in the text of the paper (§3.2).
        theory
            ``"timoshenko"`` or ``"euler-bernoulli"``.

        Returns
        -------
        ConvergenceSeries
            ``counts``, ``values``, ``errors``, ``limits`` and ``orders``.

        Raises
        ------
        InputError
            If the formulation was not computed.

        Examples
        --------
        >>> study.of("beam").counts
        (5, 10, 20)
        """
        for series in self.series:
            discretisation = series.discretisation
            if (discretisation.model, discretisation.layout, discretisation.theory) == (
                model,
                layout,
                theory,
            ):
                return series
        labels = "; ".join(series.discretisation.label for series in self.series)
        raise InputError(
            f"model {model}, layout {layout}, theory {theory}: not computed; must be one of "
            f"{labels}"
        )

    def column(self, quantity: str) -> int:
        """Column of a quantity.

        Raises InputError for a quantity that the study does not contain.
        """
        if quantity not in self.quantities:
            names = ", ".join(self.quantities)
            raise InputError(f'quantity "{quantity}": must be one of {names}')
        return self.quantities.index(quantity)

    def assert_converged(
        self,
        quantity: str,
        elements: int | None = None,
        within: float | None = None,
        *,
        model: RefinedModel = "segments",
        layout: Layout = "half",
        theory: Theory = "timoshenko",
    ) -> None:
        """Raise AssertionError if the error at `elements` or at any finer count exceeds `within`.

        The half-width of the limit is added to the error.

        Parameters
        ----------
        quantity
            "f1", "f2", … or a deflection "x", "y", "z".
        elements
            Elements per leg, or divisions of a solid. Those of `agreement` if None (20 elements if
            the robot file does not change them), for solids the finest mesh.
        within
            Largest relative error. That of `agreement` if None (0.01 if the robot file does not
            change it).
        model, layout, theory
            The formulation, as in `of`.

        Raises
        ------
        AssertionError
            With error, order and the element counts that meet the limit.
        InputError
            For a quantity, a formulation or an element count that was not computed.

        Examples
        --------
        >>> study.assert_converged("f1", elements=20, within=0.01, model="beam")
        """
        series = self.of(model, layout, theory)
        count = self.stated_count(series) if elements is None else elements
        allowed = self.agreement.convergence if within is None else within
        if excess := self._excess(series, quantity, count, allowed):
            raise AssertionError(excess)

    def stated_count(self, series: ConvergenceSeries) -> int:
        """Element count at which the error is judged.

        For any other parameter, such as the divisions of a mesh, its largest value.
        """
        return self.agreement.elements if self.refined == "elements" else series.counts[-1]

    @property
    def _stated(self) -> int | None:
        """Element count at which texts state the error. None for meshes of solids."""
        return self.agreement.elements if self.refined == "elements" else None

    def short_summary(self, series: ConvergenceSeries, column: int) -> str:
        """Text: error at the judged element count; smallest counts for errors of 1, 0.1 and 0.01 %.

        Example: "+0.009 % (2, 6, 19)".
        """
        return short_summary(series, column, self._stated)

    def _excess(self, series: ConvergenceSeries, quantity: str, count: int, within: float) -> str:
        """Text on an error that exceeds `within` at `count` or a finer one. "" if none does.

        Raises InputError for a count that was not computed.
        """
        column = self.column(quantity)
        if count not in series.counts:
            computed_counts = ", ".join(map(str, series.counts))
            raise InputError(
                f"{self.refined} = {count}: not computed; must be one of {computed_counts}"
            )
        row = series.counts.index(count)
        bound = series.largest_errors[row, column] + series.limit_half_widths[column]
        if bound <= within:
            return ""
        reached, allowed = (percent(error, signed=False) for error in (bound, within))
        return (
            f"{series.discretisation.label}, {self.title}, {quantity}: the error reaches {reached} "
            f"with {count} {self.refined} or more, allowed {allowed}; {series.behaviour(column)}; "
            f"{summary(series, column, self._stated)}"
        ).replace("\N{NO-BREAK SPACE}", " ")

    def table(self, quantity: str = "f1") -> ResultTable:
        """Values, errors and orders of one quantity, a row for each formulation and element count.

        Parameters
        ----------
        quantity
            "f1", "f2", … or a deflection "x", "y", "z".

        Returns
        -------
        ResultTable
            Errors relative to the limit and half-widths, in per cent; order between each count and
            the one before.

        Raises
        ------
        InputError
            For a quantity that the study does not contain.

        Examples
        --------
        >>> study.table("f1").headings[:3]
        ('formulation', 'elements', 'f1 (Hz)')
        """
        column = self.column(quantity)
        return ResultTable(
            (
                *("formulation", self.refined, f"{quantity} ({self.units[column]})"),
                *("error (%)", "half-width (%)", "order"),
            ),
            tuple(
                (series.discretisation.label, *cells)
                for series in self.series
                for cells in series_cells(series, column)
            ),
        )

    def text(self, quantity: str = "f1") -> str:
        """Report of one quantity as the command ``converge`` prints it.

        Parameters
        ----------
        quantity
            "f1", "f2", … or a deflection "x", "y", "z".

        Returns
        -------
        str
            Values, errors, orders and limit by formulation, and for every other quantity a
            line with the smallest element counts for errors below 1 %, 0.1 % and 0.01 %.

        Raises
        ------
        InputError
            For a quantity that the study does not contain.

        Examples
        --------
        >>> print(study.text("f1").splitlines()[0])
        bar, whole robot: convergence with element count
        """
        column = self.column(quantity)
        lines = [
            f"{self.robot}, {self.title}: convergence with {PARAMETERS[self.refined].heading}",
            f"errors relative to the {self.reference}",
        ]
        for series in self.series:
            lines += [
                "",
                f"{series.discretisation.label}: {quantity}",
                series_rows(series, column, self.refined, self.units[column]),
            ]
            other_columns = [k for k in range(len(self.quantities)) if k != column]
            lines += [
                f"  {self.quantities[k]}: {series.behaviour(k)}; {summary(series, k, self._stated)}"
                for k in (column, *other_columns)
            ]
        return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")

    def studies(self) -> tuple[ElementStudy, ...]:
        """Entries of "studies" in results.json, one for each quantity."""
        counts = sorted({count for series in self.series for count in series.counts})
        by_label = {series.discretisation.label: series for series in self.series}
        parameter = PARAMETERS[self.refined]
        return tuple(
            ElementStudy(
                id=f"convergence.{self.subject or 'robot'}.{quantity}",
                body=self.subject or None,
                quantity=quantity,
                title=f"{self.title}: {quantity}, convergence with {parameter.heading}",
                x_label=parameter.axis,
                y_label=quantity,
                unit=self.units[k],
                x=tuple(counts),
                series={
                    label: tuple(
                        float(series.values[series.counts.index(count), k])
                        if count in series.counts
                        else None
                        for count in counts
                    )
                    for label, series in by_label.items()
                },
                formal_order={label: series.formal_order for label, series in by_label.items()},
                order={
                    label: float(series.orders[k])
                    for label, series in by_label.items()
                    if not np.isnan(series.orders[k])
                },
                uncertainty={
                    label: float(series.half_widths[-1, k] * abs(series.values[-1, k]))
                    for label, series in by_label.items()
                },
                limit={label: float(series.limits[k]) for label, series in by_label.items()},
                theory={label: series.discretisation.theory for label, series in by_label.items()},
                needed={
                    label: {
                        f"{target:g}": int(row[k]) or None
                        for target, row in zip(TARGETS, series.needed, strict=True)
                    }
                    for label, series in by_label.items()
                },
                stated=self.agreement.elements,
                notes=(self.reference,),
            )
            for k, quantity in enumerate(self.quantities)
        )

    def json(self) -> str:
        """The study as JSON text (schema 1).

        Returns
        -------
        str
            Values, errors, orders and limits by formulation and quantity.

        Examples
        --------
        >>> study.json()[:36]
        '{"schema": 1, "kind": "convergence",'
        """
        return json_text(
            StudyRecord(
                robot=self.robot,
                body=self.subject or None,
                pose=tuple(self.pose.values()),
                reference=self.reference,
                quantities=self.quantities,
                units=dict(zip(self.quantities, self.units, strict=True)),
                series=[series_record(series, self.quantities) for series in self.series],
            )
        )

    def missed(self, quantity: str, within: float | None = None) -> list[str]:
        """Lines of text on formulations whose error at the judged element count exceeds `within`.

        The judged count is that of `agreement`, or the finest mesh of solids. The literal layout of
        the paper is not judged.

        Parameters
        ----------
        quantity
            "f1", "f2", … or a deflection "x", "y", "z".
        within
            Largest relative error. The limit of `agreement` if None. That limit applies to segments
            and beam elements only, and only if its count was computed.

        Returns
        -------
        list of str
            Formulation, error, limit and the counts that meet it. Empty if none exceeds it.

        Raises
        ------
        InputError
            If `within` is given and the count was not computed.

        Examples
        --------
        >>> study.missed("f1", within=0.001)
        []
        """
        lines: list[str] = []
        if within is None and self.refined != "elements":
            return lines
        allowed = self.agreement.convergence if within is None else within
        for series in self.series:
            discretisation = series.discretisation
            if discretisation.layout == "literal":
                continue
            count = self.stated_count(series)
            if within is None and count not in series.counts:
                continue
            lines.append(self._excess(series, quantity, count, allowed))
        return [line for line in lines if line]

    def csv(self) -> str:
        """Values and relative errors of all quantities as CSV.

        Returns
        -------
        str
            A row for each formulation and element count.

        Examples
        --------
        >>> study.csv().splitlines()[0][:31]
        'model,layout,theory,body,elemen'
        """
        rows = [
            (series, row, count)
            for series in self.series
            for row, count in enumerate(series.counts)
        ]
        columns: dict[str, list[float | str | None]] = {
            "model": [series.discretisation.model for series, _, _ in rows],
            "layout": [series.discretisation.layout for series, _, _ in rows],
            "theory": [series.discretisation.theory for series, _, _ in rows],
            "body": [self.subject or "robot" for _ in rows],
            self.refined: [count for _, _, count in rows],
        }
        for column, (quantity, unit) in enumerate(zip(self.quantities, self.units, strict=True)):
            columns[f"{quantity} ({unit})"] = [float(s.values[k, column]) for s, k, _ in rows]
        for column, quantity in enumerate(self.quantities):
            columns[f"{quantity} relative error"] = [float(s.errors[k, column]) for s, k, _ in rows]
        return csv_of(columns)

    def plot(self, quantities: Sequence[str] = ("f1", "f2", "f3", "f4")) -> "Figure":
        """Errors over the element count on logarithmic axes, a panel for each quantity.

        Parameters
        ----------
        quantities
            "f1", "f2", … or deflections "x", "y", "z".

        Returns
        -------
        matplotlib.figure.Figure
            Formal orders stand in the legend, observed orders at the ends of the curves.

        Raises
        ------
        InputError
            For a quantity that the study does not contain.

        Examples
        --------
        >>> study.plot(["f1", "z"]).savefig("convergence.png")
        """
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        return drawn_chart(self.chart(quantities))

    def picture(self, kind: str, dots: int) -> bytes:
        """Picture of the errors of f1 to f4, as ".svg", or as ".png" with `dots` per inch."""
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import chart_png, chart_svg  # noqa: PLC0415

        chart = self.chart(("f1", "f2", "f3", "f4"))
        return chart_svg(chart).encode() if kind == ".svg" else chart_png(chart, dots)

    def chart(self, quantities: Sequence[str]) -> Chart:
        """Chart of the errors of quantities.

        Raises InputError for a quantity that the study does not contain.
        """
        panels = [self.panel(quantity) for quantity in quantities]
        return convergence_chart(panels, PARAMETERS[self.refined].axis, self.agreement)

    def panel(self, quantity: str) -> ErrorPanel:
        """Errors of one quantity by all formulations."""
        column = self.column(quantity)
        limit = self.series[0].limits[column]
        limit_text = (
            f"{limit:.4g} Hz" if self.units[column] == "Hz" else f"{number(1e9 * limit, 3)} µm/kN"
        )
        name = f"{self.subject or 'robot'}: {quantity}"
        return ErrorPanel(name, f"{name}, limit {limit_text}", self.series, column)

    def __repr__(self) -> str:
        labels = ", ".join(series.discretisation.label for series in self.series)
        return f"ConvergenceStudy({self.robot}, {self.title}: {labels})"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text())}</pre>"
