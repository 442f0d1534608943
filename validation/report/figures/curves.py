"""Charts of deflections and frequencies by all models, over the path or a varied parameter.

Input: the context of a run, and a variation. Output: charts with differences from the reference.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.robot_file.places import unit_of
from lumped.robot_file.variation import Variation
from validation.adequacy.posture_errors import (
    Compared,
    compared_compliances,
    compared_frequencies,
)
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
from validation.models.robot_models import JUDGED_MODES
from validation.references.responses import UNSOLVED
from validation.references.robot_on_path import coordinates, path_postures, robot_on_path
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.studies_and_figures import PARAMETERS, PATH, PlannedFigure
from validation.variations.cases import varied_curves
from validation.variations.curves import VariedCurves
from validation.variations.decision import MEANING, UNITS, Decision, choice

_FORCE, _MOMENT = 1000.0, 100.0
_OWN_LOADS = f"under {_FORCE:g} N along each axis or {_MOMENT:g} N m about it"
_END_CONDITIONS = (
    "End conditions of legs and interfaces of parts are those of the robot file. If the "
    "file leaves them open, there are two curves for solids: rigid ends, and ends free "
    "to warp (legs) or averaged interfaces (CAD parts)."
)
_ONE_SHAPE = (
    "Natural frequencies of each model, in ascending order at each value of the abscissa. "
    "Differences are those between modes of the same shape, even if their numbers differ."
)
_OF_THE_POINT = (
    "Displacement of the loaded point along the force, or rotation about the moment, by each model"
)
_POSE = "pose"
_TITLE = "Deflection over the path"
_OBJECTIVES = {
    "deflection": "largest deflection (µm)",
    "frequency": "smallest first frequency (Hz)",
}
figures = FigureGroup(PATH, SHARED_SOLIDS)


@figures.figure("mechanism.deflections", _TITLE, effort=3.0)
def deflections(context: Context) -> Chart:
    """Chart with a panel for each axis: deflection under a force along it or a moment about it."""
    try:
        compared = compared_compliances(robot_on_path(context))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = deflection_chart(compared, *_path_abscissa(context))
    sentences = (f"{_OF_THE_POINT}. {_END_CONDITIONS}", compared_with(compared.against))
    return chart.captioned(*sentences, title=f"{_TITLE} {_OWN_LOADS}")


@figures.figure("mechanism.frequencies", "Natural frequencies over the path", effort=3.0)
def frequencies(context: Context) -> Chart:
    """Chart with a panel for each of the first frequencies, ascending in each pose."""
    try:
        compared = compared_frequencies(robot_on_path(context))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = frequency_chart(compared, *_path_abscissa(context))
    return chart.captioned(_ONE_SHAPE, compared_with(compared.against))


def deflection_chart(
    compared: Compared, x: Array, label: str, abscissa: Mapping[str, Column]
) -> Chart:
    """Chart of compliances (p×6, SI) over x (p), as deflections under `_FORCE` and `_MOMENT`.

    The columns of `abscissa` are added to the table. Shapes: p poses.
    """
    panels = []
    for direction, name in enumerate(AXES):
        axis = ROTATIONS.get(name)
        title = f"about {axis} (µrad)" if axis else f"along {name} (µm)"
        factor = 1e6 * (_MOMENT if axis else _FORCE)
        panels.append(_panel(compared, x, direction, title, factor))
    return _chart(panels, label, abscissa)


def frequency_chart(
    compared: Compared, x: Array, label: str, abscissa: Mapping[str, Column]
) -> Chart:
    """Chart of the first k frequencies of all models over `x` (p), one panel for each frequency.

    `label`: label of the x axis. The columns of `abscissa` are added to the table of the chart's
    values. There are p poses.
    """
    count = min(JUDGED_MODES, next(iter(compared.values.values())).shape[1])
    panels = [_panel(compared, x, mode, f"f{mode + 1} (Hz)", 1.0) for mode in range(count)]
    return _chart(panels, label, abscissa, columns=count)


def _chart(
    panels: Sequence[Panel], label: str, abscissa: Mapping[str, Column], columns: int = 3
) -> Chart:
    """Chart of panels over a path or a varied parameter. Pose numbers have integer ticks."""
    ticks = partial(few_ticks, whole=label == _POSE)
    return Chart(panels, label, columns, table=abscissa, x_scale=ticks)


def _panel(compared: Compared, x: Array, column: int, title: str, factor: float) -> Panel:
    value_series, difference_series = (
        [Series(name, x, scale * values[:, column], title) for name, values in curves.items()]
        for curves, scale in ((compared.values, factor), (compared.differences, 100.0))
    )
    return Panel(value_series, title, scale=from_zero, below=difference_series)


def _path_abscissa(context: Context) -> tuple[Array, str, Mapping[str, Column]]:
    """Abscissa (p), its label and its columns of data.

    If only one coordinate changes along the path, it is the abscissa, otherwise the pose number is.

    Shapes: p poses.
    """
    moves = coordinates(context.robot_file.mechanism)
    poses = np.array([posture.pose for posture in path_postures(context)])
    columns = {
        str(coordinate): poses[:, column].tolist() for column, coordinate in enumerate(moves)
    }
    changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0)
    if len(changing) == 1:
        return poses[:, changing[0]], moves[changing[0]].axis, columns
    return np.arange(1.0, len(poses) + 1.0), _POSE, columns


def figures_over(variations: Sequence[Variation]) -> tuple[PlannedFigure, ...]:
    """Figures of deflections, frequencies and chosen values over each varied parameter."""
    planned: list[PlannedFigure] = []
    for number, variation in enumerate(variations, start=1):
        group, effort = FigureGroup(PARAMETERS, f"vary.{number}"), float(len(variation.values))
        for name, (title, draw) in _FIGURES.items():
            identity = f"vary.{number}.{name}", f"{title} over {variation.key}"
            group.figure(*identity, effort=effort)(partial(draw, variation=variation))
        planned += group()
    return tuple(planned)


def _deflections(context: Context, variation: Variation) -> Chart:
    """Chart of deflections over the varied parameter, with a panel for each axis.

    The deflection is that under a force along the axis or a moment about it.
    """
    deflection = varied_curves(context, variation)["deflection"]
    return deflection_chart(deflection.compared, *_varied_abscissa(context, variation)).captioned(
        f"{_OF_THE_POINT}, {_location(context, deflection)}.",
        f"{_END_CONDITIONS}{_joint_change(variation)}",
        compared_with(deflection.compared.against),
        title=f"Deflection over {variation.key} {_OWN_LOADS}",
    )


def _frequencies(context: Context, variation: Variation) -> Chart:
    """Chart with a panel for each of the first frequencies, over the varied parameter.

    The frequencies ascend at each value of the parameter.
    """
    frequency = varied_curves(context, variation)["frequency"]
    location = _location(context, frequency)
    return frequency_chart(frequency.compared, *_varied_abscissa(context, variation)).captioned(
        f"{location[0].upper()}{location[1:]}.",
        f"{_ONE_SHAPE}{_joint_change(variation)}",
        compared_with(frequency.compared.against),
    )


def _decisions(context: Context, variation: Variation) -> Chart:
    """Chart with a panel for each objective over the varied parameter, best values starred."""
    objectives = varied_curves(context, variation)
    x, label, abscissa = _varied_abscissa(context, variation)
    panels = [objective_panel(varied.decision, x) for varied in objectives.values()]
    return Chart(panels, label, 2, 3.2, abscissa, few_ticks).captioned(
        *(_choices_sentence(varied, variation) for varied in objectives.values()),
        "Panels: largest deflection and smallest first frequency over the whole path, "
        "for each value of the parameter. Star: best computed value of a curve; values "
        "in between were not searched. Loss: relative difference between the value of the "
        "reference at the choice of a model and the best value of the reference. A model is "
        "a good basis for the choice if its star has the same abscissa as the star of the "
        "reference, or if its loss is small.",
    )


def objective_panel(decision: Decision, x: Array) -> Panel:
    """Panel of an objective for n designs, by each model and reference, over the parameter x (n).

    A star marks the best value of each model and of the first reference.
    """
    objective = decision.objective
    series = []
    for name, values in {**decision.models, **decision.references}.items():
        starred = name not in decision.references or values is decision.reference
        best = choice(values, decision.reference, objective).design if starred else None
        series.append(Series(name, x, values, f"{objective} ({UNITS[objective]})", best=best))
    return Panel(series, _OBJECTIVES[objective], scale=from_zero)


def _choices_sentence(varied: VariedCurves, variation: Variation) -> str:
    """Sentence on the value that each model chooses for an objective, and on this choice's loss."""
    decision, values = varied.decision, variation.values
    best = decision.best
    choices = []
    for model in decision.models:
        selection = decision.choice(model)
        equally_good = len(selection.equally_good)
        tie = f" (one of {equally_good} values that it rates as equal)" if equally_good > 1 else ""
        choices.append(
            f"{model} {values[selection.design]:.6g}{tie}, loss {100.0 * selection.loss:.2g} %"
        )
    return (
        f"By the {MEANING[decision.objective]}, the reference ({varied.compared.against}) "
        f"is best at {values[best]:.6g} ({decision.reference[best]:.4g} "
        f"{UNITS[decision.objective]}). Best values of the models, with the loss computed "
        f"by the reference: {', '.join(choices)}."
    )


def _location(context: Context, varied: VariedCurves) -> str:
    """Text on the pose in which the varied robots are compared: the middle of each robot's path.

    The pose is named unless it differs between the robots because their paths are varied.
    """
    pose = shown_pose(context.robot_file.mechanism, varied.poses[0])
    same_pose = pose and np.ptp(varied.poses, axis=0).max() == 0.0
    return f"with the tool at {pose}" if same_pose else "in the middle of the path"


def _varied_abscissa(
    context: Context, variation: Variation
) -> tuple[Array, str, Mapping[str, Column]]:
    unit = unit_of(context.robot_file.tables, variation.keys[0])
    label = f"{variation.key} ({unit})" if unit else variation.key
    values = np.array(variation.values)
    return values, label, {label: values.tolist()}


def _joint_change(variation: Variation) -> str:
    keys = len(variation.keys)
    return "" if keys == 1 else f" {keys} numbers change together."


# Title and function of each figure.
_FIGURES: Mapping[str, tuple[str, Callable[..., Chart]]] = {
    "deflections": ("Deflection", _deflections),
    "frequencies": ("Natural frequencies", _frequencies),
    "decision": ("Best value by each model", _decisions),
}
