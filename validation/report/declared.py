"""Figures declared where they are drawn: what they are called, and where they stand in the page."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, TypeAlias

from validation.context import PRESETS, Context
from validation.drawing.chart import Chart, chart_table
from validation.drawing.scene import Scene
from validation.drawing.style import WIDTH
from validation.drawing.turnable import turnable
from validation.exhibits import Figure, PlannedFigure


@dataclass(frozen=True)
class Shown:
    """What a figure shows, with its caption: a chart, or scenes with their data.

    Scenes stand in `columns`, `height` inches each, in a picture of so much `width` (see
    `rendering.pictured`); each can be turned if they are `turned`. `title` where it says more than
    that of the plan. `studies`: its entries in results.json.
    """

    caption: str
    chart: Chart | None = None
    scenes: Sequence[Scene] = ()
    columns: int = 1
    height: float | None = None
    width: float = WIDTH
    turned: bool = True
    data: str = ""
    title: str = ""
    studies: Sequence[Mapping[str, Any]] = ()

    def figure(
        self, identifier: str, title: str, section: str, computed_by: tuple[str, ...] = ()
    ) -> Figure:
        """As a figure of the page, drawn."""
        # Slow to import, and not for those who only list what could be drawn.
        from validation.drawing.plot import chart_svg  # noqa: PLC0415
        from validation.drawing.rendering import Picture, pictured  # noqa: PLC0415

        picture = Picture()
        if self.scenes:
            picture = pictured(self.scenes, self.columns, self.height, self.width)
        return Figure(
            id=identifier,
            title=self.title or title,
            caption=self.caption,
            section=section,
            svg=chart_svg(self.chart) if self.chart else "",
            png=picture.png,
            data=chart_table(self.chart) if self.chart else self.data,
            left_out=picture.left_out,
            scenes=tuple(map(turnable, self.scenes)) if self.turned else (),
            computed_by=computed_by,
            studies=tuple(self.studies),
        )


def curves(chart: Chart, *said: str, title: str = "") -> Shown:
    """A chart, and what is said of it."""
    return Shown(" ".join(text for text in said if text), chart, title=title)


def compared_with(against: str) -> str:
    """What the rows of differences are, in a caption."""
    return f"Lower panels: difference from {against} in percent."


def attempted(draw: Callable[[], Figure | None]) -> Figure | None:
    """The figure, or none: a plot that fails must not cost the report."""
    try:
        return draw()
    except Exception as error:  # noqa: BLE001  whatever it is, the numbers stand in the tables
        logging.getLogger(__name__).warning("a plot could not be drawn: %s", error)
        return None


Draw: TypeAlias = Callable[[Context], Shown]


class FigureGroup:
    """Figures of one section that are drawn in one process; `figures()` has them in order."""

    def __init__(self, section: str, group: str) -> None:
        self._section, self._group = section, group
        self._planned: list[PlannedFigure] = []

    def figure(
        self, identifier: str, title: str, *, effort: float = 1.0
    ) -> Callable[[Draw], Callable[[Context], Figure]]:
        """Declare a figure by what draws it."""

        def declare(draw: Draw) -> Callable[[Context], Figure]:
            @wraps(draw)
            def drawn(context: Context) -> Figure:
                return draw(context).figure(identifier, title, self._section)

            where = (self._section, self._group, effort)
            self._planned.append(PlannedFigure(identifier, title, drawn, PRESETS, *where))
            return drawn

        return declare

    def __call__(self) -> tuple[PlannedFigure, ...]:
        """All of them."""
        return tuple(self._planned)
