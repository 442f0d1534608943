"""Figures of the page, registered where their charts and scenes are made."""

import logging
from collections.abc import Callable
from functools import partial, wraps
from typing import TypeAlias

from validation.context import PRESETS, Context
from validation.drawing.chart import Chart, chart_table
from validation.drawing.scene import SceneGrid
from validation.drawing.turnable import turnable
from validation.exhibits import Figure, PlannedFigure


def drawn_figure(
    shown: Chart | SceneGrid,
    identifier: str,
    title: str,
    section: str,
    computed_by: tuple[str, ...] = (),
) -> Figure:
    """Draw a chart or scenes as a figure of the page."""
    # Slow to import, and not for those who only list what could be drawn.
    from validation.drawing.plot import chart_svg  # noqa: PLC0415
    from validation.drawing.rendering import pictured  # noqa: PLC0415

    figure = partial(
        Figure,
        id=identifier,
        title=shown.title or title,
        caption=shown.caption,
        section=section,
        computed_by=computed_by,
    )
    if isinstance(shown, Chart):
        studies = tuple(shown.studies)
        return figure(svg=chart_svg(shown), data=chart_table(shown), studies=studies)
    picture = pictured(shown.scenes, shown.columns, shown.height, shown.width)
    scenes = tuple(map(turnable, shown.scenes)) if shown.turned else ()
    return figure(png=picture.png, data=shown.data, left_out=picture.left_out, scenes=scenes)


def attempted(draw: Callable[[], Figure | None]) -> Figure | None:
    """The figure, or none: a plot that fails must not cost the report."""
    try:
        return draw()
    except Exception as error:  # noqa: BLE001  whatever it is, the numbers stand in the tables
        logging.getLogger(__name__).warning("a plot could not be drawn: %s", error)
        return None


Draw: TypeAlias = Callable[[Context], Chart | SceneGrid]


class FigureGroup:
    """Figures of one section that are drawn in one process; `figures()` has them in order."""

    def __init__(self, section: str, group: str) -> None:
        self._section, self._group = section, group
        self._planned: list[PlannedFigure] = []

    def figure(
        self, identifier: str, title: str, *, effort: float = 1.0
    ) -> Callable[[Draw], Callable[[Context], Figure]]:
        """Register a function that returns the chart or the scenes of a figure."""

        def declare(draw: Draw) -> Callable[[Context], Figure]:
            @wraps(draw)
            def drawn(context: Context) -> Figure:
                return drawn_figure(draw(context), identifier, title, self._section)

            where = (self._section, self._group, effort)
            self._planned.append(PlannedFigure(identifier, title, drawn, PRESETS, *where))
            return drawn

        return declare

    def __call__(self) -> tuple[PlannedFigure, ...]:
        """All of them."""
        return tuple(self._planned)
