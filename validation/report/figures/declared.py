"""Figures declared where they are drawn: what they are called, and where they stand in the page."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import wraps
from typing import TypeAlias

from validation.context import PRESETS, Context, Preset
from validation.drawing.chart import Chart, chart_table
from validation.drawing.plot import chart_svg
from validation.drawing.rendering import Picture
from validation.exhibits import Figure, InteractiveScene, PlannedFigure


@dataclass(frozen=True)
class Shown:
    """What a figure shows, with its caption; a chart has its data (see `Figure`).

    `title` where it says more than that of the plan.
    """

    caption: str
    chart: Chart | None = None
    picture: Picture = field(default_factory=Picture)
    data: str = ""
    scenes: tuple[InteractiveScene, ...] = ()
    title: str = ""

    def figure(
        self, identifier: str, title: str, section: str, computed_by: tuple[str, ...] = ()
    ) -> Figure:
        """As a figure of the page, drawn."""
        return Figure(
            id=identifier,
            title=self.title or title,
            caption=self.caption,
            section=section,
            svg=chart_svg(self.chart) if self.chart else "",
            png=self.picture.png,
            data=chart_table(self.chart) if self.chart else self.data,
            left_out=self.picture.left_out,
            scenes=self.scenes,
            computed_by=computed_by,
        )


def curves(chart: Chart, *said: str, title: str = "") -> Shown:
    """A chart, and what is said of it."""
    return Shown(" ".join(text for text in said if text), chart, title=title)


def compared_with(against: str) -> str:
    """What the rows of differences are, in a caption."""
    return f"Below each: what the others differ from {against}, in percent."


Draw: TypeAlias = Callable[[Context], Shown]


class FigureGroup:
    """Figures of one section that are drawn in one process; `figures()` has them in order."""

    def __init__(self, section: str, group: str) -> None:
        self._section, self._group = section, group
        self._planned: list[PlannedFigure] = []

    def figure(
        self,
        identifier: str,
        title: str,
        *,
        effort: float = 1.0,
        presets: tuple[Preset, ...] = PRESETS,
    ) -> Callable[[Draw], Callable[[Context], Figure]]:
        """Declare a figure by what draws it."""

        def declare(draw: Draw) -> Callable[[Context], Figure]:
            @wraps(draw)
            def drawn(context: Context) -> Figure:
                return draw(context).figure(identifier, title, self._section)

            where = (self._section, self._group, effort)
            self._planned.append(PlannedFigure(identifier, title, drawn, presets, *where))
            return drawn

        return declare

    def __call__(self) -> tuple[PlannedFigure, ...]:
        """All of them."""
        return tuple(self._planned)
