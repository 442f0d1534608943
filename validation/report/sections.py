"""The parts of the report: which comparisons, plots and pictures stand together, in which order.

Chapters answer the reader's questions in turn.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

from validation.drawing.text import anchor
from validation.exhibits import FAMILY, PARAMETERS, PATH, SOLID_ROBOT, STROKE, Figure
from validation.report.figures.declared import attempted
from validation.report.figures.studies.budgets import budget_figure, budgeted
from validation.report.figures.studies.families import Family, families
from validation.report.figures.studies.family_plots import family_plot
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
    outcomes: Sequence[Outcome], figures: Sequence[Figure], *, plotted: bool
) -> tuple[Chapter, ...]:
    """The chapters that have anything to show.

    `plotted`: whether plots are to be drawn from the outcomes; one that fails costs itself alone.
    """
    names = [outcome.case.section for outcome in outcomes] + [figure.section for figure in figures]
    sections = []
    for name in dict.fromkeys(names):
        own = tuple(outcome for outcome in outcomes if outcome.case.section == name)
        section = Section(
            title=name or "Further comparisons",
            outcomes=own,
            figures=tuple(figure for figure in figures if figure.section == name),
            plots=tuple(
                Plot(one, attempted(partial(family_plot, one)) if plotted else None)
                for one in families(own)
            ),
        )
        budget = attempted(partial(_budget, section)) if plotted else None
        sections.append(replace(section, budget=budget))
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


def _budget(section: Section) -> Figure | None:
    allowing = budgeted(section.outcomes)
    if not allowing:
        return None
    title = f"{section.title}: error budget"
    return budget_figure(f"budget.{section.anchor}", title, allowing)
