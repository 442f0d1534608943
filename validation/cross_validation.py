"""Comparison of all formulations of a robot's legs with solids, and their convergence, in Python.

Input: the context of a robot. Output: `CrossValidation`, with the verdicts of the chapter
"Cross-validation" of a report. Rule: all formulations have the same legs of constant section, and
are compared with solids of these legs.
"""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from lumped.errors import InputError
from validation.case import Case, Skip
from validation.comparisons.agreement_rows import (
    AgreementRow,
    agreement_row,
    agreement_rows,
    percent,
)
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.context import Context
from validation.drawing.chart import percent as percent_scale
from validation.drawing.style import GREEN, WIDTH, looks_of, plot_style
from validation.drawing.text import quantity_name
from validation.models.options import RefinedModel
from validation.report.agreement import agreement_sentence
from validation.run.outcome import Outcome
from validation.tables import ResultTable, html_paragraph

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLID = "solid"
# Range around zero (%) in which the scale of a plot is linear; height of a panel (inches); fraction
# of a column's width over which markers are spread.
_LINEAR, _PANEL_HEIGHT, _SPREAD = 0.1, 2.2, 0.6


@dataclass(frozen=True, eq=False)
class CrossValidation:
    """All formulations of the same legs, compared with solids, and their convergence.

    `agreement` are the comparisons; their `case.body` is the name of a leg, "" for the whole robot.
    `convergence` are the studies over the element count, by leg, "" for the whole robot.

    Examples
    --------
    >>> crossed = cross_validate(bar, preset="quick")
    """

    robot: str
    agreement: tuple[Outcome, ...]
    convergence: Mapping[str, ConvergenceStudy]

    @property
    def sentence(self) -> str:
        """Sentence on the agreement of all formulations with solids.

        Examples
        --------
        >>> "solid FE" in crossed.sentence
        True
        """
        return agreement_sentence(self.agreement)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the compared legs, and ``""`` for the whole robot.

        Examples
        --------
        >>> crossed.bodies
        ('', 'bar')
        """
        return tuple(dict.fromkeys(outcome.case.body for outcome in self.agreement))

    def comparison(self, model: str, quantity: str, body: str | None = None) -> Outcome:
        """Comparison of a formulation with the solid.

        Parameters
        ----------
        model
            ``"vjm"``, ``"links"``, ``"segments"`` or ``"beam"``.
        quantity
            "x", "y", "z", "phi_x", "phi_y", "phi_z" (motion along or about an axis under a unit
            load along or about it), or "f1" to "f4".
        body
            A leg, with its root clamped. The whole robot if None.

        Returns
        -------
        Outcome
            ``verdict``, and ``measurement`` with both values and their half-widths.

        Raises
        ------
        InputError
            For a body, model or quantity that is not compared.

        Examples
        --------
        >>> crossed.comparison("beam", "z", body="bar").verdict
        'agree'
        """
        of_body = {
            (outcome.case.model, quantity_name(outcome.case.label)): outcome
            for outcome in self.agreement
            if outcome.case.body == (body or "")
        }
        if not of_body:
            raise InputError(_not_computed("body", str(body), self.bodies))
        models = dict.fromkeys(name for name, _ in of_body)
        if model not in models:
            raise InputError(_not_computed("model", model, models))
        if (model, quantity) not in of_body:
            quantities = [name for of_model, name in of_body if of_model == model]
            raise InputError(_not_computed("quantity", quantity, quantities))
        return of_body[model, quantity]

    def assert_agrees(
        self,
        model: str,
        with_: str = SOLID,
        *,
        quantity: str,
        within: float | None = None,
        body: str | None = None,
    ) -> None:
        """Raise AssertionError if two formulations of the same legs do not agree.

        Parameters
        ----------
        model, with_
            Formulations: "vjm", "links", "segments" or "beam"; `with_` can also be "solid". In a
            comparison with "solid", allowances for named causes are subtracted from the difference.
        quantity
            "x", "y", "z", "phi_x", "phi_y", "phi_z" (motion along or about an axis under a unit
            load along or about it), or "f1" to "f4".
        within
            Largest relative difference, half-width included. The tolerance of the comparison if
            None.
        body
            A leg, with its root clamped. The whole robot if None.

        Raises
        ------
        AssertionError
            With values, allowances and half-width, or with the reason why nothing was compared.
        InputError
            For names that are not compared.

        Examples
        --------
        >>> crossed.assert_agrees("beam", "segments", quantity="z", within=1e-6)
        """
        outcome = self.comparison(model, quantity, body)
        shares = _computed(outcome)
        allowed = shares.tolerance if within is None else within
        if with_ == SOLID:
            bound, detail = abs(shares.unexplained) + shares.half_width, shares.detail
        else:
            other = _computed(self.comparison(with_, quantity, body))
            difference = shares.value / other.value - 1.0
            bound = abs(difference)
            detail = f"{shares.value:.6g} against {other.value:.6g}, {percent(difference)}"
        if not bound <= allowed:
            raise AssertionError(
                f"{model} compared with {with_}, {quantity} of {body or 'the robot'}: "
                f"{detail}; allowed {percent(allowed).lstrip('+')}"
            )

    def assert_converged(
        self,
        quantity: str,
        elements: int = 20,
        within: float = 0.01,
        *,
        model: RefinedModel = "segments",
        body: str | None = None,
    ) -> None:
        """Raise AssertionError if the error with `elements` or more per leg exceeds `within`.

        Parameters
        ----------
        quantity
            "f1", "f2", … or a deflection "x", "y", "z".
        elements
            Elements per leg.
        within
            Largest relative error, half-width of the limit included.
        model
            ``"segments"`` or ``"beam"``.
        body
            A leg, with its root clamped. The whole robot if None.

        Raises
        ------
        AssertionError
            With error, order and the element counts that meet the limit.
        InputError
            For a body, a quantity or an element count that was not computed.

        Examples
        --------
        >>> crossed.assert_converged("f1", elements=10, within=0.02)
        """
        if (body or "") not in self.convergence:
            raise InputError(_not_computed("body", str(body), self.convergence))
        self.convergence[body or ""].assert_converged(quantity, elements, within, model=model)

    def table(self) -> ResultTable:
        """Table of comparisons, one row each.

        Returns
        -------
        ResultTable
            Values, difference from the solid, parts of this difference, tolerance, verdict.

        Examples
        --------
        >>> len(crossed.table().rows) == len(crossed.agreement)
        True
        """
        return agreement_rows(self.agreement)

    def plot(self) -> "Figure":
        """Plot of the differences from solids in per cent, by leg and for the whole robot.

        A marker with its half-width is the unexplained difference of a formulation, a grey diamond
        the whole difference. The shaded band is the tolerance. Beyond 0.1 % the scale is
        logarithmic.

        Returns
        -------
        matplotlib.figure.Figure
            Formulations have the colours and markers of the report.

        Examples
        --------
        >>> crossed.plot().savefig("agreement.png")
        """
        panels: dict[str, list[Outcome]] = {}
        for outcome in self.agreement:
            if outcome.measurement:
                title = outcome.case.body or f"{self.robot}, whole robot"
                panels.setdefault(title, []).append(outcome)
        return _drawn_differences(panels)

    def __repr__(self) -> str:
        return f"CrossValidation({self.robot}: {len(self.agreement)} comparisons)"

    def _repr_html_(self) -> str:
        return html_paragraph(self.sentence) + self.table().html()


def _computed(outcome: Outcome) -> AgreementRow:
    """Difference of a comparison and its parts, as a row of the table.

    Raises AssertionError if the comparison was skipped or failed.
    """
    if outcome.measurement is None:
        raise AssertionError(f"{outcome.case.id}: not compared, because {outcome.message}")
    return agreement_row(outcome)


def _not_computed(subject: str, name: str, known: Iterable[str]) -> str:
    listed = ", ".join(item or "None (the robot)" for item in known) or "none"
    return f"{subject} {name}: not computed; must be one of {listed}"


def cross_validation(context: Context) -> CrossValidation:
    """All formulations of the same legs, compared as in a run with this preset.

    A comparison that is skipped or fails is an outcome with its reason. A leg to which beam
    elements do not apply has no convergence study. Raises ComputationError or InputError if a study
    fails.
    """
    # Imported here: the cases are many modules, which tables do not need.
    from validation.catalogue import catalogue  # noqa: PLC0415
    from validation.comparisons.convergence_cases import study_of, subjects  # noqa: PLC0415
    from validation.run.runner import execute  # noqa: PLC0415

    comparisons = [
        outcome
        for task in catalogue(context.robot_file)
        if isinstance(task, Case) and task.kind == "agreement" and context.preset in task.presets
        if isinstance(outcome := execute(task, context), Outcome)
    ]
    studies = {}
    for body in subjects(context.robot_file.mechanism):
        with suppress(Skip):
            studies[body] = study_of(context, body)
    return CrossValidation(context.robot_file.name, tuple(comparisons), studies)


@plot_style()
def _drawn_differences(panels: Mapping[str, Sequence[Outcome]]) -> "Figure":
    """Plot of comparisons with a measurement: one panel for each title, a column for each quantity.

    Models stand side by side in a column.
    """
    # Imported here: only a picture needs the plotting library.
    from matplotlib.figure import Figure  # noqa: PLC0415

    models = list(dict.fromkeys(o.case.model for outcomes in panels.values() for o in outcomes))
    looks = looks_of(models)
    count = max(len(panels), 1)
    figure = Figure(figsize=(WIDTH, 0.5 + _PANEL_HEIGHT * count), layout="constrained")
    grid = figure.subplots(count, 1, squeeze=False)[:, 0]
    for axes, (title, outcomes) in zip(grid, panels.items(), strict=False):
        quantities = list(dict.fromkeys(outcome.case.label for outcome in outcomes))
        rows = [(outcome.case, agreement_row(outcome)) for outcome in outcomes]
        for column, quantity in enumerate(quantities):
            tolerance = 100.0 * max(row.tolerance for case, row in rows if case.label == quantity)
            sides = [column - 0.45, column + 0.45]
            band: dict[str, Any] = {"color": GREEN, "alpha": 0.12, "linewidth": 0.0}
            axes.fill_between(sides, -tolerance, tolerance, label="tolerance", **band)
        for rank, model in enumerate(models):
            of_model = [(case, row) for case, row in rows if case.model == model]
            if not of_model:
                continue
            offset = _SPREAD * ((rank + 0.5) / len(models) - 0.5)
            x = [quantities.index(case.label) + offset for case, _ in of_model]
            difference, unexplained, half_width = (
                [100.0 * getattr(row, name) for _, row in of_model]
                for name in ("difference", "unexplained", "half_width")
            )
            grey: dict[str, Any] = {"color": "#999999", "markersize": 3.0}
            axes.plot(x, difference, "D", label="total difference", **grey)
            look: dict[str, Any] = {"fmt": looks[model].marker, "color": looks[model].colour}
            label = f"{model}, unexplained"
            axes.errorbar(x, unexplained, half_width, capsize=2.5, label=label, **look)
        percent_scale(axes, limit=_LINEAR)
        axes.set_xticks(range(len(quantities)), quantities)
        axes.set_xlim(-0.5, len(quantities) - 0.5)
        axes.set_ylabel("difference from\nthe solid (%)")
        axes.set_title(title)
        axes.grid(visible=False, axis="x")
    labelled = (zip(*axes.get_legend_handles_labels(), strict=True) for axes in grid)
    handles = {label: handle for pairs in labelled for handle, label in pairs}
    columns = min(len(handles), 3)
    figure.legend(handles.values(), handles, loc="outside upper left", ncols=columns)
    return figure
