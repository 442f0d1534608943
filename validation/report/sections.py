"""Chapters and sections of the report, in the order of the page.

Input: outcomes and figures of a run. Output: `Chapter` records with comparisons, plots and tables.
Rule: the table `CHAPTERS` assigns sections to chapters. Any other section belongs to the chapter
for the subject of its cases: robot or leg.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import isnan

from validation.case import Relation, Relative
from validation.comparisons.agreement_rows import agreement_rows
from validation.drawing.figures import attempted
from validation.drawing.text import anchor
from validation.report.agreement import (
    AgreementTable,
    agreement_reservations,
    agreement_statement,
    agreement_tables,
)
from validation.report.element_counts import ElementCounts, element_counts
from validation.report.figures.budgets import budget_figure
from validation.report.figures.studies import Family, families, study_figure
from validation.report.published_statements import StatementTable
from validation.run.outcome import Outcome, Verdict
from validation.run.records import claims_of
from validation.studies_and_figures import (
    AGREEMENT,
    CONVERGENCE,
    FAMILY,
    MESHES,
    MODES,
    PARAMETERS,
    PATH,
    STROKE,
    Figure,
)
from validation.verdicts import Coordinate

# Chapters with their sections, in the order of the page.
LEGS = "Modes and legs in detail"
CROSS_VALIDATION = "Cross-validation"
CHAPTERS: Mapping[str, tuple[str, ...]] = {
    CROSS_VALIDATION: (AGREEMENT, CONVERGENCE, MESHES),
    "The robot": (PATH,),
    "The decision": (PARAMETERS,),
    LEGS: (MODES,),
    "The paper": ("The paper's statements", STROKE, FAMILY),
}
# Folded chapters, which are not needed to understand the verdict.
_APPENDIX = (LEGS, "The paper")
_BY_SEVERITY: tuple[Verdict, ...] = ("disagree", "failed", "undecided", "agree", "skipped")


@dataclass(frozen=True)
class PageSection:
    """A group of cases with the figures that belong to it.

    `plotted`: True to draw the studies behind the comparisons, and error budgets. A plot that
    cannot be drawn is omitted, without an effect on the other plots. `coordinates`: coordinates of
    the tool that a pose prescribes.
    """

    title: str
    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    plotted: bool
    coordinates: tuple[Coordinate, ...] = ()

    @cached_property
    def agreement(self) -> tuple[AgreementTable, ...]:
        """Tables of all formulations for the robot and each leg, from agreement cases."""
        return agreement_tables(self.outcomes, self.coordinates)

    @cached_property
    def agreement_csv(self) -> str:
        """Comparisons of all formulations as CSV. "" if there are none."""
        return agreement_rows(self.outcomes).csv() if self.agreement else ""

    @property
    def statement(self) -> str:
        """Sentence on the agreement of all formulations.

        "" if the section does not compare them.
        """
        return agreement_statement(self.outcomes)

    @property
    def reservations(self) -> str:
        """Sentences on the differences due to named causes, and on skipped comparisons.

        "" if there are neither. Also "" if no comparison has the verdict "agree" or "disagree".
        """
        return agreement_reservations(self.outcomes)

    @cached_property
    def element_counts(self) -> ElementCounts | None:
        """Elements per leg for an error of 1 %.

        None if nothing was computed over the element count.
        """
        return element_counts(self.figures)

    @property
    def worst_first(self) -> list[Outcome]:
        """Comparisons by severity of the verdict, then by the ratio of difference to tolerance."""
        return sorted(self.outcomes, key=_severity)

    @cached_property
    def plots(self) -> tuple[tuple[Family, Figure | None], ...]:
        """Studies by family, each with its figure.

        The figure is None if the run is unfinished or if the figure cannot be drawn.
        """
        return tuple(
            (family, attempted(partial(study_figure, family)) if self.plotted else None)
            for family in families(self.outcomes)
        )

    @cached_property
    def budget(self) -> Figure | None:
        """Figure of the error budget of comparisons with named causes.

        None if there are no such comparisons, or if the section has agreement tables, whose rows
        contain the budget.
        """
        if self.agreement:
            return None
        identity = f"budget.{anchor(self.title)}", f"{self.title}: error budget", "budgets"
        draw = partial(budget_figure, *identity, self.outcomes)
        return attempted(draw) if self.plotted else None

    @cached_property
    def statements(self) -> StatementTable | None:
        """Statements of a source as printed and as corrected. None if no case has a statement."""
        claims = claims_of(self.outcomes)
        return StatementTable(claims) if claims else None

    @property
    def skipped(self) -> tuple[str, ...]:
        """Reasons why all comparisons of the section were skipped, with the names of bodies.

        () if any comparison was made.
        """
        if any(outcome.verdict != "skipped" for outcome in self.outcomes):
            return ()
        bodies: dict[str, dict[str, None]] = {}
        for outcome in self.outcomes:
            bodies.setdefault(outcome.message, {})[outcome.case.body or "robot"] = None
        return tuple(f"{', '.join(names)}: {reason}" for reason, names in bodies.items())

    def count(self, verdict: Verdict) -> int:
        """Number of comparisons with this verdict."""
        return sum(outcome.verdict == verdict for outcome in self.outcomes)

    @property
    def largest(self) -> float | None:
        """Largest `unexplained_share` of a comparison. None if no comparison has one.

        It is the difference from the reference, relative to the reference, without the effects of
        named causes.
        """
        shares = (unexplained_share(outcome) for outcome in self.outcomes)
        return max((share for share in shares if share is not None), default=None)

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """Id of the family of each study, by the study's id."""
        return {curve.study.id: family.id for family, _ in self.plots for curve in family.curves}

    @property
    def shown(self) -> Iterator[Figure]:
        """All figures of the section, including those drawn from the outcomes."""
        yield from self.figures
        if self.budget:
            yield self.budget
        yield from (figure for _, figure in self.plots if figure)


@dataclass(frozen=True)
class Chapter:
    """Sections under one heading."""

    title: str
    sections: tuple[PageSection, ...]

    @property
    def folded(self) -> bool:
        """True if the chapter belongs to the appendix, which is folded when the page is opened."""
        return self.title in _APPENDIX

    @property
    def leads(self) -> bool:
        """True if the chapter stands directly below the verdict, above the matrix of models."""
        return self.title == CROSS_VALIDATION

    @property
    def of_legs(self) -> bool:
        """True if the chapter contains the matrices of single legs."""
        return self.title == LEGS


def chapters_of(
    outcomes: Sequence[Outcome],
    figures: Sequence[Figure],
    *,
    plotted: bool,
    coordinates: tuple[Coordinate, ...] = (),
) -> tuple[Chapter, ...]:
    """Chapters with at least one section. See `PageSection` for `plotted` and `coordinates`."""
    names = [outcome.case.section for outcome in outcomes] + [figure.section for figure in figures]
    sections_by_chapter: dict[str, list[PageSection]] = {chapter: [] for chapter in CHAPTERS}
    for name in dict.fromkeys(names):
        section = PageSection(
            title=name or "Further comparisons",
            outcomes=tuple(o for o in outcomes if o.case.section == name),
            figures=tuple(figure for figure in figures if figure.section == name),
            plotted=plotted,
            coordinates=coordinates,
        )
        sections_by_chapter[_chapter_title(section)].append(section)
    return tuple(
        Chapter(title, tuple(sorted(sections, key=partial(_position, title))))
        for title, sections in sections_by_chapter.items()
        if sections
    )


def unexplained_share(outcome: Outcome) -> float | None:
    """|unexplained difference| over |reference|. None if this ratio is meaningless.

    The unexplained difference is the difference without the effects of named causes. The ratio has
    a meaning for cases that claim equality within a relative tolerance. It has none for orders,
    ranks, counts and bounds.
    """
    case, measurement = outcome.case, outcome.measurement
    if measurement is None or not measurement.reference:
        return None
    if case.relation is not Relation.EQUAL or not isinstance(case.tolerance, Relative):
        return None
    share = abs(measurement.unexplained / measurement.reference)
    return None if isnan(share) else share


def _severity(outcome: Outcome) -> tuple[int, float]:
    share = outcome.share
    return _BY_SEVERITY.index(outcome.verdict), -share if not isnan(share) else float("-inf")


def _chapter_title(section: PageSection) -> str:
    """Title of a section's chapter: from `CHAPTERS`, otherwise by the first case's subject."""
    chapters = {title: chapter for chapter, titles in CHAPTERS.items() for title in titles}
    is_leg = section.outcomes and section.outcomes[0].case.subject == "leg"
    return chapters.get(section.title) or (LEGS if is_leg else "The robot")


def _position(chapter: str, section: PageSection) -> int:
    titles = CHAPTERS[chapter]
    return titles.index(section.title) if section.title in titles else len(titles)
