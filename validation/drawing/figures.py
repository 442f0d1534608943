"""Figures of the report, registered by the functions that compute their charts and scenes.

Input: a function that returns a `Chart` or a `SceneGrid`. Output: planned figures, and drawn ones
with picture, caption and data.
"""

import logging
from collections.abc import Callable
from functools import partial, wraps
from typing import TypeAlias

from validation.context import Context
from validation.drawing.chart import Chart, chart_table
from validation.drawing.scene import SceneGrid
from validation.drawing.turnable import turnable
from validation.studies_and_figures import Figure, PlannedFigure


def drawn_figure(
    contents: Chart | SceneGrid,
    identifier: str,
    title: str,
    section: str,
    computed_by: tuple[str, ...] = (),
) -> Figure:
    """Figure of the report, drawn from a chart or from scenes."""
    # Imported here: slow, and not needed to list the figures.
    from validation.drawing.plot import chart_svg  # noqa: PLC0415
    from validation.drawing.rendering import pictured  # noqa: PLC0415

    figure = partial(
        Figure,
        id=identifier,
        title=contents.title or title,
        caption=contents.caption,
        section=section,
        computed_by=computed_by,
    )
    if isinstance(contents, Chart):
        studies = tuple(contents.studies)
        return figure(svg=chart_svg(contents), data=chart_table(contents), studies=studies)
    picture = pictured(contents.scenes, contents.columns, contents.height, contents.width)
    scenes = tuple(map(turnable, contents.scenes)) if contents.turned else ()
    return figure(png=picture.png, data=contents.data, left_out=picture.left_out, scenes=scenes)


def attempted(draw: Callable[[], Figure | None]) -> Figure | None:
    """Figure that `draw` returns.

    None if it raises an exception, which must not prevent the report.
    """
    try:
        return draw()
    except Exception as error:  # noqa: BLE001  any error: the tables have the numbers
        logging.getLogger(__name__).warning("a plot could not be drawn: %s", error)
        return None


Draw: TypeAlias = Callable[[Context], Chart | SceneGrid]


class FigureGroup:
    """Figures of one section that are drawn in one process. A call returns them in order."""

    def __init__(self, section: str, group: str) -> None:
        self._section, self._group = section, group
        self._planned: list[PlannedFigure] = []

    def figure(
        self, identifier: str, title: str, *, effort: float = 1.0
    ) -> Callable[[Draw], Callable[[Context], Figure]]:
        """Decorator that registers a function returning the chart or the scenes of a figure.

        `effort`: expected computing time (s).
        """

        def declare(draw: Draw) -> Callable[[Context], Figure]:
            @wraps(draw)
            def drawn(context: Context) -> Figure:
                return drawn_figure(draw(context), identifier, title, self._section)

            self._planned.append(
                PlannedFigure(
                    identifier,
                    title,
                    drawn,
                    section=self._section,
                    group=self._group,
                    effort=effort,
                )
            )
            return drawn

        return declare

    def __call__(self) -> tuple[PlannedFigure, ...]:
        """Planned figures in the order of their registration."""
        return tuple(self._planned)
