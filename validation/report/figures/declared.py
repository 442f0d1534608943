"""Figures declared where they are drawn: what they are called, and where they stand in the page."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import wraps
from typing import TypeAlias

from validation.context import PRESETS, Context, Preset
from validation.drawing.chart import Chart, chart_svg, chart_table
from validation.drawing.rendering import Picture
from validation.exhibits import Figure, InteractiveScene, PlannedFigure


@dataclass(frozen=True)
class Shown:
    """What a figure shows, with its caption and data (see `Figure`).

    `title` where it says more than that of the plan.
    """

    caption: str
    svg: str = ""
    picture: Picture = field(default_factory=Picture)
    data: str = ""
    scenes: tuple[InteractiveScene, ...] = ()
    title: str = ""

    def figure(self, identifier: str, title: str, section: str) -> Figure:
        """As a figure of the page."""
        return Figure(
            id=identifier,
            title=self.title or title,
            caption=self.caption,
            section=section,
            svg=self.svg,
            png=self.picture.png,
            data=self.data,
            left_out=self.picture.left_out,
            scenes=self.scenes,
        )


def curves(chart: Chart, *said: str, data: str = "", title: str = "") -> Shown:
    """A chart with its table, and what is said of it; `data` in place of its own table."""
    caption = " ".join(text for text in said if text)
    return Shown(caption, chart_svg(chart), data=data or chart_table(chart), title=title)


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
