"""Deflections and frequencies by all models, over the path or over a number of the robot file."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.robot_file.places import unit_of
from lumped.robot_file.variation import Variation
from validation.adequacy.compared import (
    Compared,
    compared_compliances,
    compared_frequencies,
    compared_statics,
)
from validation.adequacy.mechanism.path import coordinates, path_postures, robot_on_path
from validation.adequacy.responses import UNSOLVED
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import (
    Chart,
    Column,
    Panel,
    Series,
    compared_with,
    few_ticks,
    from_zero,
)
from validation.drawing.figures import FigureGroup
from validation.exhibits import PARAMETERS, PATH, PlannedFigure
from validation.models.mechanism import JUDGED_MODES
from validation.solids.legs import SHARED_SOLIDS
from validation.variations.cases import varied_curves
from validation.variations.curves import VariedCurves
from validation.variations.decision import MEANING, UNITS, Decision, choice

_FORCE, _MOMENT = 1000.0, 100.0
_OWN_LOADS = f"under {_FORCE:g} N along each axis or {_MOMENT:g} N m about it"
_HELD = (
    "Ends and interfaces of solids are held as the robot file says; where it does not, both limits "
    "are shown: rigid, and free to warp or averaged."
)
_ONE_SHAPE = "In ascending order; differences compare modes of the same shape."
_OF_THE_POINT = "Motion of the loaded point along the force or about the moment"
_POSE = "pose"
_TITLE = "Deflection over the path"
_OBJECTIVES = {
    "deflection": "largest deflection (µm)",
    "frequency": "smallest first frequency (Hz)",
}
figures = FigureGroup(PATH, SHARED_SOLIDS)


@figures.figure("mechanism.deflections", _TITLE, effort=3.0)
def deflections(context: Context) -> Chart:
    """A panel for each direction, under a force or a moment along it."""
    try:
        found = compared_compliances(*compared_statics(robot_on_path(context)))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = deflection_chart(found, *_path(context))
    said = (f"{_OF_THE_POINT}. {_HELD}", compared_with(found.against))
    return chart.captioned(*said, title=f"{_TITLE} {_OWN_LOADS}")


@figures.figure("mechanism.frequencies", "Natural frequencies over the path", effort=3.0)
def frequencies(context: Context) -> Chart:
    """A panel for each of the first frequencies, in ascending order at each pose."""
    try:
        found = compared_frequencies(robot_on_path(context))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = frequency_chart(found, *_path(context))
    return chart.captioned(_ONE_SHAPE, compared_with(found.against))


def deflection_chart(
    found: Compared, x: Array, label: str, abscissa: Mapping[str, Column]
) -> Chart:
    """Compliances (p×6, SI) as deflections under `_FORCE` and `_MOMENT`, a panel each.

    Over x (p), which the table has with the columns of `abscissa`.
    """
    panels = []
    for place, name in enumerate(AXES):
        axis = ROTATIONS.get(name)
        title = f"about {axis} (µrad)" if axis else f"along {name} (µm)"
        factor = 1e6 * (_MOMENT if axis else _FORCE)
        panels.append(_panel(found, x, place, title, factor))
    return _chart(panels, label, abscissa)


def frequency_chart(found: Compared, x: Array, label: str, abscissa: Mapping[str, Column]) -> Chart:
    """The first frequencies (p×k, Hz), a panel each."""
    count = min(JUDGED_MODES, next(iter(found.values.values())).shape[1])
    panels = [_panel(found, x, mode, f"f{mode + 1} (Hz)", 1.0) for mode in range(count)]
    return _chart(panels, label, abscissa, columns=count)


def _chart(
    panels: Sequence[Panel], label: str, abscissa: Mapping[str, Column], columns: int = 3
) -> Chart:
    """Panels over a path or a number of the file; numbers of poses have whole ticks."""
    ticks = partial(few_ticks, whole=label == _POSE)
    return Chart(panels, label, columns, table=abscissa, x_scale=ticks)


def _panel(found: Compared, x: Array, place: int, title: str, factor: float) -> Panel:
    above, below = (
        [Series(name, x, times * values[:, place], title) for name, values in curves_of.items()]
        for curves_of, times in ((found.values, factor), (found.differences, 100.0))
    )
    return Panel(above, title, scale=from_zero, below=below)


def _path(context: Context) -> tuple[Array, str, Mapping[str, Column]]:
    """The only coordinate that changes along the path, or the poses' numbers along it."""
    known = coordinates(context.robot_file.mechanism)
    poses = np.array([at.pose for at in path_postures(context)])
    columns = {str(one): poses[:, place].tolist() for place, one in enumerate(known)}
    changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0)
    if len(changing) == 1:
        return poses[:, changing[0]], known[changing[0]].axis, columns
    return np.arange(1.0, len(poses) + 1.0), _POSE, columns


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


def _deflections(context: Context, variation: Variation) -> Chart:
    """A panel for each direction, under a force or a moment along it."""
    found = varied_curves(context, variation)["deflection"]
    return deflection_chart(found.compared, *_over(context, variation)).captioned(
        f"{_OF_THE_POINT}, {_place(context, found)}.",
        f"{_HELD}{_alike(variation)}",
        compared_with(found.compared.against),
        title=f"Deflection over {variation.key} {_OWN_LOADS}",
    )


def _frequencies(context: Context, variation: Variation) -> Chart:
    """A panel for each of the first frequencies, in ascending order at each value."""
    found = varied_curves(context, variation)["frequency"]
    said = _place(context, found)
    return frequency_chart(found.compared, *_over(context, variation)).captioned(
        f"{said[0].upper()}{said[1:]}.",
        f"{_ONE_SHAPE}{_alike(variation)}",
        compared_with(found.compared.against),
    )


def _decisions(context: Context, variation: Variation) -> Chart:
    """A panel for each objective: all models over the values, what each finds best with a star."""
    found = varied_curves(context, variation)
    x, label, abscissa = _over(context, variation)
    panels = [objective_panel(one.decision, x) for one in found.values()]
    return Chart(panels, label, 2, 3.2, abscissa, few_ticks).captioned(
        *(_verdict(one, variation) for one in found.values()),
        "Every robot over its whole path. Stars mark the best of the computed values by each "
        "curve; values between them were not searched.",
    )


def objective_panel(decision: Decision, x: Array) -> Panel:
    """An objective of n designs over their values x, by models and references, the best starred."""
    objective = decision.objective
    series = []
    for name, values in {**decision.models, **decision.references}.items():
        starred = name not in decision.references or values is decision.reference
        best = choice(values, decision.reference, objective).design if starred else None
        series.append(Series(name, x, values, f"{objective} ({UNITS[objective]})", best=best))
    return Panel(series, _OBJECTIVES[objective], scale=from_zero)


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
_FIGURES: Mapping[str, tuple[str, Callable[..., Chart]]] = {
    "deflections": ("Deflection", _deflections),
    "frequencies": ("Natural frequencies", _frequencies),
    "decision": ("What each model chooses", _decisions),
}
