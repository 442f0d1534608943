"""Result record of `vary`: robots that differ in one number, and the best value by each model.

Input: curves of all models over the values of a number. Output: `Designs`, with the chosen value,
its loss by the reference, a table and a plot.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import InputError
from lumped.robot_file.variation import Variation
from validation.drawing.chart import Chart, few_ticks
from validation.drawing.style import plot_style
from validation.report.figures.curves import objective_panel
from validation.tables import ResultTable
from validation.variations.curves import VariedCurves
from validation.variations.decision import MEANING, UNITS, Decision, Objective

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        with plot_style():
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
