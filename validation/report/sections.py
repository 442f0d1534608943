"""The parts of the report: which comparisons, plots and pictures stand together, in which order."""

import logging
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from validation.case import Outcome
from validation.exhibits import Figure
from validation.report.figures.studies.budgets import budget_figure, budgeted
from validation.report.figures.studies.families import Family, families
from validation.report.figures.studies.family_plots import family_plot
from validation.report.tables import Grid, Part, grids
from validation.report.text import anchor

_FROM_PAPER = re.compile(r"\(as the paper's Fig\. (\d+)")
_NAMED_AFTER = re.compile(r"\s*\(as the paper's (Figs?\.? [^)]*)\)")


@dataclass(frozen=True)
class Entry:
    """A line of the table of contents."""

    anchor: str
    title: str


@dataclass(frozen=True)
class Plot:
    """Studies in the same axes; no figure where the run was not finished."""

    family: Family
    figure: Figure | None


@dataclass(frozen=True)
class Section:
    """A group of cases with the figures that belong to it.

    `plotted`: whether plots are to be drawn from the outcomes.
    """

    title: str
    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    plotted: bool = True

    @property
    def anchor(self) -> str:
        """The section's id in the page."""
        return anchor(self.title)

    @cached_property
    def _tables(self) -> tuple[tuple[Grid, ...], tuple[Outcome, ...]]:
        return grids(self.outcomes)

    @property
    def grids(self) -> tuple[Grid, ...]:
        """Tables of models side by side."""
        return self._tables[0]

    @property
    def rest(self) -> tuple[Outcome, ...]:
        """Comparisons with one model alone."""
        return self._tables[1]

    @property
    def part(self) -> Part:
        """The section in one line."""
        return Part(self.title, self.outcomes)

    @cached_property
    def budget(self) -> Figure | None:
        """The error budget of the comparisons that allow for named causes."""
        drawn = budgeted(self.outcomes) if self.plotted else ()
        if not drawn:
            return None
        title = f"{self.title}: error budget"
        return _attempted(lambda: budget_figure(f"budget.{self.anchor}", title, drawn))

    @cached_property
    def plots(self) -> tuple[Plot, ...]:
        """The studies behind the comparisons, by family."""
        return tuple(
            Plot(family, _attempted(partial(family_plot, family)) if self.plotted else None)
            for family in families(self.outcomes)
        )

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """The family in which a study is shown, by the study's id."""
        return {study.id: plot.family.id for plot in self.plots for study in plot.family.studies}

    @property
    def entries(self) -> Iterator[Entry]:
        """Lines of the table of contents below the section's own."""
        if self.budget:
            yield Entry(anchor(self.budget.id), "Error budget")
        # Numbers of the paper's figures mean something where its statements stand.
        from_paper = any(o.case.reference_kind == _PAPER for o in self.outcomes)
        brief = _numbered if from_paper else _brief
        for figure in self.figures:
            yield Entry(anchor(figure.id), brief(figure.title))
        if len(self.plots) == 1:
            yield Entry(anchor(self.plots[0].family.id), self.plots[0].family.title)
        elif self.plots:
            yield Entry(f"{self.anchor}-studies", "Studies")


def sections_of(
    outcomes: Sequence[Outcome], figures: Sequence[Figure], *, plotted: bool
) -> tuple[Section, ...]:
    """The sections in the order in which they appear.

    The figures that redraw the paper's stand together beside the paper's statements, in its
    order, if there are any statements.
    """
    paper = next((o.case.section for o in outcomes if o.case.reference_kind == _PAPER), None)
    homes = {figure.id: _home(figure, paper) for figure in figures}
    names = [outcome.case.section for outcome in outcomes]
    names += [homes[figure.id] for figure in figures]
    return tuple(
        Section(
            title=name or "Further comparisons",
            outcomes=tuple(outcome for outcome in outcomes if outcome.case.section == name),
            figures=tuple(
                sorted((f for f in figures if homes[f.id] == name), key=_number_in_paper)
            ),
            plotted=plotted,
        )
        for name in dict.fromkeys(names)
    )


_PAPER = "paper-statement"


def _attempted(draw: Callable[[], Figure]) -> Figure | None:
    """The figure, or none: a plot that fails must not cost the report."""
    try:
        return draw()
    except Exception as error:  # noqa: BLE001  whatever it is, the numbers stand in the tables
        logging.getLogger(__name__).warning("a plot could not be drawn: %s", error)
        return None


def _home(figure: Figure, paper: str | None) -> str:
    return paper if paper and _FROM_PAPER.search(figure.title) else figure.section


def _number_in_paper(figure: Figure) -> int:
    named = _FROM_PAPER.search(figure.title)
    return int(named[1]) if named else 1000


def _brief(title: str) -> str:
    """A title short enough for the table of contents."""
    plain = _NAMED_AFTER.sub("", title)
    return plain if len(plain) <= 46 else f"{plain[:45].rpartition(' ')[0]} …"


def _numbered(title: str) -> str:
    """The same with the number of the paper's figure first."""
    named = _NAMED_AFTER.search(title)
    return f"{named[1]}: {_brief(title)}" if named else _brief(title)
