"""report.html: one file that needs nothing else, from what a run found."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from lumped.finding import Finding
from validation.case import Outcome, Verdict
from validation.drift import Drift
from validation.exhibits import Figure, Study
from validation.listing import summary, tolerance_text
from validation.records import Drawn, studies_of
from validation.report import text

# How many comparisons the first table shows beside those that do not agree.
_FOREMOST = 10
_RANK: Mapping[Verdict, int] = {"disagree": 0, "failed": 1, "agree": 2, "skipped": 3}


@dataclass(frozen=True)
class Section:
    """A group of cases with the figures that belong to it."""

    title: str
    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]


@dataclass(frozen=True)
class Report:
    """What the page shows.

    `unfinished` counts the pieces of work that were not computed; `drifts` (by case id) are the
    moves from frozen values, which stand in a column of their own.
    """

    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    findings: tuple[Finding, ...]
    provenance: Mapping[str, Any]
    missing_figures: tuple[Drawn, ...] = ()
    unfinished: int = 0
    drifts: Mapping[str, Drift] = field(default_factory=dict)

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        return summary(self.outcomes, self.unfinished)

    @property
    def headline(self) -> str:
        """Where the comparisons are tightest, or which one is worst."""
        if not self.worst_first or isnan(self.worst_first[0].share):
            return ""
        worst = self.worst_first[0]
        how = "Largest disagreement" if worst.verdict == "disagree" else "Closest to its limit"
        return f"{how}: {worst.case.title} ({_of_tolerance(worst.share)})."

    @property
    def verdict(self) -> Verdict:
        """The verdict on the run: the worst of its cases; unfinished work has failed."""
        verdicts = {outcome.verdict for outcome in self.outcomes}
        if "disagree" in verdicts:
            return "disagree"
        if "failed" in verdicts or self.unfinished:
            return "failed"
        return "agree" if "agree" in verdicts else "skipped"

    @cached_property
    def worst_first(self) -> tuple[Outcome, ...]:
        """All outcomes: disagreements, failures, then by the share of the tolerance used."""
        return tuple(sorted(self.outcomes, key=_badness))

    @property
    def foremost(self) -> tuple[Outcome, ...]:
        """The comparisons that matter first."""
        tried = [outcome for outcome in self.worst_first if outcome.verdict != "skipped"]
        bad = sum(outcome.verdict != "agree" for outcome in tried)
        return tuple(tried[: bad + _FOREMOST])

    @cached_property
    def studies(self) -> tuple[Study, ...]:
        """The studies that came with the cases."""
        return tuple(studies_of(self.outcomes))

    def study_figure(self, study: Study) -> Figure | None:
        """The plot of a study."""
        return next((figure for figure in self.figures if figure.id == study.id), None)

    @property
    def sections(self) -> tuple[Section, ...]:
        """The groups in the order in which they appear, worst cases first in each."""
        plots = {study.id for study in self.studies}
        figures = [figure for figure in self.figures if figure.id not in plots]
        names = [outcome.case.section for outcome in self.outcomes]
        names += [figure.section for figure in figures]
        return tuple(
            Section(
                title=name or "Further comparisons",
                outcomes=tuple(o for o in self.worst_first if o.case.section == name),
                figures=tuple(figure for figure in figures if figure.section == name),
            )
            for name in dict.fromkeys(names)
        )

    @property
    def slowest_first(self) -> tuple[Outcome, ...]:
        """All outcomes by the time they took."""
        return tuple(sorted(self.outcomes, key=lambda outcome: -outcome.seconds))


def render(report: Report) -> str:
    """The page as HTML."""
    environment = Environment(
        loader=PackageLoader("validation.report"),
        autoescape=select_autoescape(("html", "j2")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "number": text.number,
        "percent": text.percent,
        "share_text": text.share_text,
        "seconds": text.seconds,
        "anchor": text.anchor,
        "function_name": text.function_name,
        "data_uri": text.data_uri,
        "inline_svg": lambda figure: Markup(text.inline_svg(figure)),  # noqa: S704  our own plots
        "amount": tolerance_text,
        "rows": lambda columns: zip(*columns.values(), strict=True),
    }
    environment.tests["nan"] = lambda value: isinstance(value, float) and isnan(value)
    return environment.get_template("report.html.j2").render(report=report)


def _badness(outcome: Outcome) -> tuple[int, float]:
    share = outcome.share
    return _RANK[outcome.verdict], -share if not isnan(share) else float("-inf")


def _of_tolerance(share: float) -> str:
    if share < 0.0:
        return "inside its bound"
    return f"{text.share_text(share)}{'' if share > 1.0 else ' of'} the tolerance"
