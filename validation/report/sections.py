"""The parts of the report: which comparisons, plots and pictures stand together, in which order.

Chapters answer the reader's questions in turn.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import isnan

from validation.case import Relation, Relative
from validation.drawing.figures import attempted
from validation.drawing.text import anchor
from validation.report.agreement import (
    AgreementTable,
    agreement_reservations,
    agreement_statement,
    agreement_tables,
)
from validation.report.agreement_parts import agreement_rows
from validation.report.element_counts import ElementCounts, element_counts
from validation.report.figures.budgets import budget_figure
from validation.report.figures.studies import Family, families, study_figure
from validation.report.published_statements import SaidTable
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

# Chapters in their order, with their sections as they follow each other; sections that stand in no
# list go by the subject of their cases.
LEGS = "Modes and legs in detail"
CROSS_VALIDATION = "Cross-validation"
CHAPTERS: Mapping[str, tuple[str, ...]] = {
    CROSS_VALIDATION: (AGREEMENT, CONVERGENCE, MESHES),
    "The robot": (PATH,),
    "The decision": (PARAMETERS,),
    LEGS: (MODES,),
    "The paper": ("The paper's statements", STROKE, FAMILY),
}
# What nobody needs to understand the answer: the page has it folded.
_APPENDIX = (LEGS, "The paper")
_GRAVEST: tuple[Verdict, ...] = ("disagree", "failed", "undecided", "agree", "skipped")


@dataclass(frozen=True)
class PageSection:
    """A group of cases with the figures that belong to it.

    `plotted`: whether the studies behind the comparisons, and the error budget of those that allow
    for named causes, are to be drawn; one that fails costs itself alone. `coordinates` of poses.
    """

    title: str
    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    plotted: bool
    coordinates: tuple[Coordinate, ...] = ()

    @cached_property
    def agreement(self) -> tuple[AgreementTable, ...]:
        """A table of all formulations for each leg, of cases that compare these."""
        return agreement_tables(self.outcomes, self.coordinates)

    @cached_property
    def agreement_csv(self) -> str:
        """The comparisons of all formulations as CSV; "" without any."""
        return agreement_rows(self.outcomes).csv() if self.agreement else ""

    @property
    def statement(self) -> str:
        """Agreement of all formulations in words; "" if they are not compared here."""
        return agreement_statement(self.outcomes)

    @property
    def reservations(self) -> str:
        """Amounts allowed for and missing comparisons in words; "" without any."""
        return agreement_reservations(self.outcomes)

    @cached_property
    def element_counts(self) -> ElementCounts | None:
        """Elements per leg for 1 %; None without studies of element counts."""
        return element_counts(self.figures)

    @property
    def worst_first(self) -> list[Outcome]:
        """Its comparisons: disagreements, failures, then by the share of the tolerance used."""
        return sorted(self.outcomes, key=_badness)

    @cached_property
    def plots(self) -> tuple[tuple[Family, Figure | None], ...]:
        """Studies by family; no figure where the run was not finished."""
        return tuple(
            (one, attempted(partial(study_figure, one)) if self.plotted else None)
            for one in families(self.outcomes)
        )

    @cached_property
    def budget(self) -> Figure | None:
        """The error budget if named causes are allowed for; agreement tables have it in rows."""
        if self.agreement:
            return None
        named = f"budget.{anchor(self.title)}", f"{self.title}: error budget", "budgets"
        draw = partial(budget_figure, *named, self.outcomes)
        return attempted(draw) if self.plotted else None

    @cached_property
    def said(self) -> SaidTable | None:
        """What a source says, as printed and as corrected; None where no case has a source's."""
        claims = claims_of(self.outcomes)
        return SaidTable(claims) if claims else None

    @property
    def skipped(self) -> tuple[str, ...]:
        """The reasons for skipping, with their bodies, if nothing at all was compared."""
        if any(outcome.verdict != "skipped" for outcome in self.outcomes):
            return ()
        bodies: dict[str, dict[str, None]] = {}
        for outcome in self.outcomes:
            bodies.setdefault(outcome.message, {})[outcome.case.body or "robot"] = None
        return tuple(f"{', '.join(names)}: {reason}" for reason, names in bodies.items())

    def count(self, verdict: Verdict) -> int:
        """How many comparisons have this verdict."""
        return sum(outcome.verdict == verdict for outcome in self.outcomes)

    @property
    def largest(self) -> float | None:
        """The largest unexplained difference over its reference, see `unexplained_share`."""
        shares = (unexplained_share(outcome) for outcome in self.outcomes)
        return max((share for share in shares if share is not None), default=None)

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """The family in which a study is shown, by the study's id."""
        return {curve.study.id: family.id for family, _ in self.plots for curve in family.curves}

    @property
    def shown(self) -> Iterator[Figure]:
        """Every figure of the section, those drawn from the outcomes among them."""
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
        """Whether it belongs to the appendix."""
        return self.title in _APPENDIX

    @property
    def leads(self) -> bool:
        """Whether it stands directly below the verdict, above the matrix of the models."""
        return self.title == CROSS_VALIDATION

    @property
    def of_legs(self) -> bool:
        """Whether what models say of single legs stands in it."""
        return self.title == LEGS


def chapters_of(
    outcomes: Sequence[Outcome],
    figures: Sequence[Figure],
    *,
    plotted: bool,
    coordinates: tuple[Coordinate, ...] = (),
) -> tuple[Chapter, ...]:
    """The chapters that have anything to show; `plotted` and `coordinates` as of `PageSection`."""
    names = [outcome.case.section for outcome in outcomes] + [figure.section for figure in figures]
    gathered: dict[str, list[PageSection]] = {chapter: [] for chapter in CHAPTERS}
    for name in dict.fromkeys(names):
        section = PageSection(
            title=name or "Further comparisons",
            outcomes=tuple(o for o in outcomes if o.case.section == name),
            figures=tuple(figure for figure in figures if figure.section == name),
            plotted=plotted,
            coordinates=coordinates,
        )
        gathered[_home(section)].append(section)
    return tuple(
        Chapter(title, tuple(sorted(found, key=partial(_place, title))))
        for title, found in gathered.items()
        if found
    )


def unexplained_share(outcome: Outcome) -> float | None:
    """|unexplained difference| over |reference|, None where that has no meaning.

    It has one where the case claims equality of two numbers of a kind, within a relative
    tolerance: orders, ranks, counts and bounds have amounts instead.
    """
    case, measurement = outcome.case, outcome.measurement
    if measurement is None or not measurement.reference:
        return None
    if case.relation is not Relation.EQUAL or not isinstance(case.tolerance, Relative):
        return None
    share = abs(measurement.unexplained / measurement.reference)
    return None if isnan(share) else share


def _badness(outcome: Outcome) -> tuple[int, float]:
    share = outcome.share
    return _GRAVEST.index(outcome.verdict), -share if not isnan(share) else float("-inf")


def _home(section: PageSection) -> str:
    """The chapter that names the section, else that of what its first case says something of."""
    named = {title: chapter for chapter, titles in CHAPTERS.items() for title in titles}
    of_leg = section.outcomes and section.outcomes[0].case.subject == "leg"
    return named.get(section.title) or (LEGS if of_leg else "The robot")


def _place(chapter: str, section: PageSection) -> int:
    titles = CHAPTERS[chapter]
    return titles.index(section.title) if section.title in titles else len(titles)
