"""The parts of the report: which comparisons, plots and pictures stand together, in which order.

Chapters answer the reader's questions in turn.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

from validation.drawing.text import anchor
from validation.exhibits import FAMILY, PARAMETERS, PATH, SOLID_ROBOT, STROKE, Figure
from validation.report.figures.studies.budgets import budget_figure, budgeted
from validation.report.figures.studies.families import Family, families
from validation.report.figures.studies.family_plots import family_plot
from validation.report.figures.together import Draw, drawn_together
from validation.report.said import SaidTable
from validation.report.tables import Grid, grids, largest_unexplained
from validation.results.outcome import Outcome, Verdict
from validation.results.records import claims_of

# Chapters in their order, with their sections as they follow each other; sections that stand in no
# list go by the subject of their cases.
CHAPTERS: Mapping[str, tuple[str, ...]] = {
    "The robot": (STROKE, SOLID_ROBOT, PATH),
    "Its legs": (),
    "The decision": (PARAMETERS, FAMILY),
    "The paper": ("The paper's statements",),
}


@dataclass(frozen=True)
class Plot:
    """Studies in the same axes; no figure where the run was not finished."""

    family: Family
    figure: Figure | None


@dataclass(frozen=True)
class Section:
    """A group of cases with the figures that belong to it.

    `plots` are the studies behind the comparisons, by family, `budget` the error budget of those
    that allow for named causes.
    """

    title: str
    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    plots: tuple[Plot, ...] = ()
    budget: Figure | None = None

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

    @cached_property
    def said(self) -> SaidTable | None:
        """What a source says, as printed and as corrected; None where no case has a source's."""
        claims = claims_of(self.outcomes)
        return SaidTable(claims) if claims else None

    def count(self, verdict: Verdict) -> int:
        """How many comparisons have this verdict."""
        return sum(outcome.verdict == verdict for outcome in self.outcomes)

    @property
    def largest(self) -> Outcome | None:
        """The comparison with the largest unexplained difference, see `unexplained_share`."""
        return largest_unexplained(self.outcomes)

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """The family in which a study is shown, by the study's id."""
        return {study.id: plot.family.id for plot in self.plots for study in plot.family.studies}

    @property
    def shown(self) -> Iterator[Figure]:
        """Every figure of the section, those drawn from the outcomes among them."""
        yield from self.figures
        if self.budget:
            yield self.budget
        yield from (plot.figure for plot in self.plots if plot.figure)


@dataclass(frozen=True)
class Chapter:
    """Sections under one heading."""

    title: str
    sections: tuple[Section, ...]

    @property
    def anchor(self) -> str:
        """The chapter's id in the page."""
        return anchor(self.title)


def chapters_of(
    outcomes: Sequence[Outcome], figures: Sequence[Figure], *, plotted: bool, processes: int = 1
) -> tuple[Chapter, ...]:
    """The chapters that have anything to show.

    `plotted`: whether plots are to be drawn from the outcomes, by so many `processes`.
    """
    names = [outcome.case.section for outcome in outcomes] + [figure.section for figure in figures]
    sections = [
        Section(
            title=name or "Further comparisons",
            outcomes=tuple(outcome for outcome in outcomes if outcome.case.section == name),
            figures=tuple(figure for figure in figures if figure.section == name),
        )
        for name in dict.fromkeys(names)
    ]
    sections = _with_plots(sections, processes if plotted else 0)
    gathered = {
        chapter: tuple(section for section in sections if _home(section) == chapter)
        for chapter in CHAPTERS
    }
    return tuple(
        Chapter(title, tuple(sorted(found, key=lambda section: _place(title, section))))
        for title, found in gathered.items()
        if found
    )


def _home(section: Section) -> str:
    """The chapter that names the section, else that of what its first case says something of."""
    named = {title: chapter for chapter, titles in CHAPTERS.items() for title in titles}
    of_leg = section.outcomes and section.outcomes[0].case.subject == "leg"
    return named.get(section.title) or ("Its legs" if of_leg else "The robot")


def _place(chapter: str, section: Section) -> int:
    titles = CHAPTERS.get(chapter, ())
    return titles.index(section.title) if section.title in titles else len(titles)


def _with_plots(sections: Sequence[Section], processes: int) -> list[Section]:
    """The sections with what is drawn from their outcomes; without pictures by no process."""
    of_section = [families(section.outcomes) for section in sections]
    draws: list[Draw] = [partial(family_plot, one) for found in of_section for one in found]
    draws += [partial(_budget, section) for section in sections]
    drawn = iter(drawn_together(draws, processes) if processes else [None] * len(draws))
    plots = [tuple(Plot(family, next(drawn)) for family in found) for found in of_section]
    return [
        replace(section, plots=own, budget=next(drawn))
        for section, own in zip(sections, plots, strict=True)
    ]


def _budget(section: Section) -> Figure | None:
    allowing = budgeted(section.outcomes)
    if not allowing:
        return None
    title = f"{section.title}: error budget"
    return budget_figure(f"budget.{section.anchor}", title, allowing)
