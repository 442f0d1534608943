"""All models over a number of the robot file, and how far they are apart."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.robot_file.places import unit_of
from lumped.robot_file.variation import Variation
from validation.context import Context
from validation.drawing.charts.chart import Chart, Column, Panel, Series
from validation.drawing.charts.scales import few_ticks, from_zero
from validation.exhibits import PARAMETERS, PlannedFigure
from validation.report.figures.declared import FigureGroup, Shown, compared_with, curves
from validation.report.figures.mechanism.curves import (
    HELD,
    OF_THE_POINT,
    ONE_SHAPE,
    OWN_LOADS,
    deflection_chart,
    frequency_chart,
)
from validation.variations.cases import varied_curves
from validation.variations.curves import VariedCurves
from validation.variations.decision import MEANING, UNITS, Decision, choice

_TITLES = {"deflection": "largest deflection (µm)", "frequency": "smallest first frequency (Hz)"}


def figures_over(variations: Sequence[Variation]) -> tuple[PlannedFigure, ...]:
    """Deflections, frequencies and what each model chooses, over each number that is varied."""
    planned: list[PlannedFigure] = []
    for number, variation in enumerate(variations, start=1):
        group, effort = FigureGroup(PARAMETERS, f"vary.{number}"), float(len(variation.values))
        for what, (title, shown) in _FIGURES.items():
            named = f"vary.{number}.{what}", f"{title} over {variation.key}"
            group.figure(*named, effort=effort)(partial(shown, variation=variation))
        planned += group()
    return tuple(planned)


def _deflections(context: Context, variation: Variation) -> Shown:
    """A panel for each direction, under a force or a moment along it."""
    found = varied_curves(context, variation)["deflection"]
    return curves(
        deflection_chart(found.compared, *_over(context, variation)),
        f"{OF_THE_POINT}, {_place(context, found)}.",
        f"{HELD}{_alike(variation)}",
        compared_with(found.compared.against),
        title=f"Deflection over {variation.key} {OWN_LOADS}",
    )


def _frequencies(context: Context, variation: Variation) -> Shown:
    """A panel for each of the first frequencies, in ascending order at each value."""
    found = varied_curves(context, variation)["frequency"]
    said = _place(context, found)
    return curves(
        frequency_chart(found.compared, *_over(context, variation)),
        f"{said[0].upper()}{said[1:]}.",
        f"{ONE_SHAPE}{_alike(variation)}",
        compared_with(found.compared.against),
    )


def _decisions(context: Context, variation: Variation) -> Shown:
    """A panel for each objective: all models over the values, what each finds best with a star."""
    found = varied_curves(context, variation)
    x, label, abscissa = _over(context, variation)
    panels = [_objective(one.decision, x) for one in found.values()]
    return curves(
        Chart(panels, label, 2, 3.2, abscissa, few_ticks),
        *(_verdict(one, variation) for one in found.values()),
        "Every robot over its whole path. Stars mark the best of the computed values by each "
        "curve; values between them were not searched.",
    )


def _objective(decision: Decision, x: Array) -> Panel:
    objective = decision.objective
    series = []
    for name, values in {**decision.models, **decision.references}.items():
        starred = name not in decision.references or values is decision.reference
        best = choice(values, decision.reference, objective).design if starred else None
        series.append(Series(name, x, values, f"{objective} ({UNITS[objective]})", best=best))
    return Panel(series, _TITLES[objective], scale=from_zero)


def _verdict(found: VariedCurves, variation: Variation) -> str:
    """What each model chooses by an objective, and what that costs."""
    decision, values = found.decision, variation.values
    best = decision.best
    told = []
    for model in decision.models:
        chosen = decision.choice(model)
        several = len(chosen.equally_good)
        among = f" (one of {several} that it finds equally good)" if several > 1 else ""
        told.append(
            f"{model} {values[chosen.design]:.6g}{among} with a loss of {100.0 * chosen.loss:.2g} %"
        )
    return (
        f"By the {MEANING[decision.objective]}, the reference ({found.compared.against}) chooses "
        f"{values[best]:.6g} ({decision.reference[best]:.4g} {UNITS[decision.objective]}); "
        f"{', '.join(told)}."
    )


def _place(context: Context, found: VariedCurves) -> str:
    """Where the robots are, which follow paths of their own where these are varied."""
    shown = shown_pose(context.robot_file.mechanism, found.poses[0])
    alike = shown and np.ptp(found.poses, axis=0).max() == 0.0
    return f"with the tool at {shown}" if alike else "in the middle of the path"


def _over(context: Context, variation: Variation) -> tuple[Array, str, Mapping[str, Column]]:
    unit = unit_of(context.robot_file.tables, variation.keys[0])
    label = f"{variation.key} ({unit})" if unit else variation.key
    values = np.array(variation.values)
    return values, label, {label: values.tolist()}


def _alike(variation: Variation) -> str:
    keys = len(variation.keys)
    return "" if keys == 1 else f" {keys} numbers change together."


# What each is called, and what it shows.
_FIGURES: Mapping[str, tuple[str, Callable[..., Shown]]] = {
    "deflections": ("Deflection", _deflections),
    "frequencies": ("Natural frequencies", _frequencies),
    "decision": ("What each model chooses", _decisions),
}
