"""Deflections and frequencies over the path by all models, and how far they are apart."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from lumped.acceptance.requirement import AXES, ROTATIONS
from lumped.arrays import Array
from validation.adequacy.compared import (
    Compared,
    compared_compliances,
    compared_frequencies,
    compared_statics,
)
from validation.adequacy.mechanism.path import coordinates, path_postures, robot_on_path
from validation.adequacy.response import UNSOLVED
from validation.case import Skip
from validation.context import Context
from validation.drawing.charts.chart import Chart, Column, Panel, Series
from validation.drawing.charts.scales import few_ticks, from_zero
from validation.exhibits import PATH
from validation.models.mechanism import JUDGED_MODES
from validation.report.figures.declared import FigureGroup, Shown, compared_with, curves
from validation.solids.legs import SHARED_SOLIDS

FORCE, MOMENT = 1000.0, 100.0
OWN_LOADS = f"under {FORCE:g} N along each axis or {MOMENT:g} N m about it"
HELD = (
    "Ends and interfaces of solids are held as the robot file says; where it does not, both limits "
    "are shown: rigid, and free to warp or averaged."
)
ONE_SHAPE = "In ascending order; differences compare modes of the same shape."
OF_THE_POINT = "Motion of the loaded point along the force or about the moment"
POSE = "pose"
_TITLE = "Deflection over the path"
figures = FigureGroup(PATH, SHARED_SOLIDS)


@figures.figure("mechanism.deflections", _TITLE, effort=3.0)
def deflections(context: Context) -> Shown:
    """A panel for each direction, under a force or a moment along it."""
    try:
        found = compared_compliances(*compared_statics(robot_on_path(context)))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = deflection_chart(found, *_path(context))
    said = (f"{OF_THE_POINT}. {HELD}", compared_with(found.against))
    return curves(chart, *said, title=f"{_TITLE} {OWN_LOADS}")


@figures.figure("mechanism.frequencies", "Natural frequencies over the path", effort=3.0)
def frequencies(context: Context) -> Shown:
    """A panel for each of the first frequencies, in ascending order at each pose."""
    try:
        found = compared_frequencies(robot_on_path(context))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    chart = frequency_chart(found, *_path(context))
    return curves(chart, ONE_SHAPE, compared_with(found.against))


def deflection_chart(
    found: Compared, x: Array, label: str, abscissa: Mapping[str, Column]
) -> Chart:
    """Compliances (p×6, SI) as deflections under `FORCE` and `MOMENT`, a panel each.

    Over x (p), which the table has with the columns of `abscissa`.
    """
    panels = []
    for place, name in enumerate(AXES):
        axis = ROTATIONS.get(name)
        title = f"about {axis} (µrad)" if axis else f"along {name} (µm)"
        factor = 1e6 * (MOMENT if axis else FORCE)
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
    ticks = partial(few_ticks, whole=label == POSE)
    return Chart(panels, label, columns, table=abscissa, x_scale=ticks)


def _panel(found: Compared, x: Array, place: int, title: str, factor: float) -> Panel:
    above, below = (
        [Series(name, x, times * values[:, place], title) for name, values in curves_of.items()]
        for curves_of, times in ((found.values, factor), (found.differences, 100.0))
    )
    return Panel(above, title, scale=from_zero, below=below)


def _path(context: Context) -> tuple[Array, str, Mapping[str, Column]]:
    """The only coordinate that changes along the path, or the poses' numbers along it."""
    named = [str(one) for one in coordinates(context.robot_file.mechanism)]
    poses = np.array([at.pose for at in path_postures(context)])
    columns = {name: poses[:, place].tolist() for place, name in enumerate(named)}
    changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0)
    if len(changing) == 1:
        return poses[:, changing[0]], named[changing[0]], columns
    return np.arange(1.0, len(poses) + 1.0), POSE, columns
