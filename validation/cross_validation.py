"""Comparison of all formulations of a robot's legs with solids, and their convergence, in Python.

Input: the context of a robot. Output: `CrossValidation`, with the verdicts of the chapter
"Cross-validation" of a report. Rule: all formulations have the same legs of constant section, and
are compared with solids of these legs.
"""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

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
from validation.drawing.text import quantity_name
from validation.models.options import RefinedModel
from validation.report.agreement import agreement_sentence
from validation.run.outcome import Outcome
from validation.tables import ResultTable, html_paragraph

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLID = "solid"


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
        # Imported here: only a picture needs the plotting library.
        from validation.drawing.agreement_plot import Difference, agreement_plot  # noqa: PLC0415

        panels: dict[str, list[Difference]] = {}
        for outcome in self.agreement:
            if outcome.measurement:
                shares = agreement_row(outcome)
                title = outcome.case.body or f"{self.robot}, whole robot"
                panels.setdefault(title, []).append(
                    Difference(
                        outcome.case.label,
                        outcome.case.model,
                        100.0 * shares.difference,
                        100.0 * shares.unexplained,
                        100.0 * shares.half_width,
                        100.0 * shares.tolerance,
                    )
                )
        return agreement_plot(panels)

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
