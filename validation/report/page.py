"""report.html: one file that needs nothing else, from what a run found."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from lumped.audit.finding import Finding
from validation.case import Outcome, Verdict
from validation.cases.guards import SECTION as GUARDS
from validation.exhibits import Figure
from validation.faults.detection import Power
from validation.listing import summary
from validation.report import scene_viewer, text
from validation.report.second_ways import Agreement, agreements
from validation.report.sections import Section, sections_of
from validation.report.tables import Part, explained, largest_unexplained, unexplained_share
from validation.results.drift import Drift
from validation.results.records import Drawn, studies_of

# How many comparisons the first table shows beside those that do not agree.
_FOREMOST = 10
_RANK: Mapping[Verdict, int] = {
    "disagree": 0,
    "failed": 1,
    "undecided": 2,
    "agree": 3,
    "skipped": 4,
}


@dataclass(frozen=True)
class Report:
    """What the page shows.

    `unfinished` counts the pieces of work that were not computed; `drifts` (by case id) are the
    moves from frozen values, which stand in a column of their own; `power` what became of the
    faults, if any were injected.
    """

    outcomes: tuple[Outcome, ...]
    figures: tuple[Figure, ...]
    findings: tuple[Finding, ...]
    provenance: Mapping[str, Any]
    missing_figures: tuple[Drawn, ...] = ()
    unfinished: int = 0
    drifts: Mapping[str, Drift] = field(default_factory=dict)
    power: Power | None = None

    @property
    def sentence(self) -> str:
        """The verdict in one sentence, and one on the faults."""
        said = summary(self.outcomes, self.unfinished)
        return f"{said} {self.power.sentence}" if self.power else said

    @property
    def headline(self) -> str:
        """Where the largest unexplained difference is, and which comparison is tightest."""
        said = []
        if self.largest is not None:
            share = text.percent(unexplained_share(self.largest) or 0.0, signed=False)
            said.append(
                f"Largest unexplained difference: {share} of the reference, in "
                f"“{self.largest.case.title}”."
            )
        worst = next(iter(self.foremost), None)
        if worst is not None and not isnan(worst.share):
            how = "Largest disagreement" if worst.verdict == "disagree" else "Closest to its limit"
            said.append(f"{how}: “{worst.case.title}” ({_of_tolerance(worst.share)}).")
        return " ".join(said)

    @cached_property
    def largest(self) -> Outcome | None:
        """The comparison with the largest unexplained difference, in % of its reference.

        Guards are left out: they hold textbook formulas against sections of their own, and say
        nothing of this robot.
        """
        return largest_unexplained([o for o in self.outcomes if o.case.section != GUARDS])

    @property
    def parts(self) -> tuple[Part, ...]:
        """The sections in one line each, the largest unexplained difference first."""

        def size(part: Part) -> float:
            of_robot = part.largest is not None and part.largest.case.section != GUARDS
            return (unexplained_share(part.largest) or 0.0) if of_robot and part.largest else -1.0

        parts = [section.part for section in self.sections if section.outcomes]
        return tuple(sorted(parts, key=lambda part: -size(part)))

    @property
    def verdict(self) -> Verdict:
        """The verdict on the run: the worst of its cases; unfinished work has failed."""
        verdicts = {outcome.verdict for outcome in self.outcomes}
        if "disagree" in verdicts or (self.power and self.power.survivors):
            return "disagree"
        if "failed" in verdicts or self.unfinished:
            return "failed"
        if "undecided" in verdicts:
            return "undecided"
        return "agree" if "agree" in verdicts else "skipped"

    @cached_property
    def worst_first(self) -> tuple[Outcome, ...]:
        """All outcomes: disagreements, failures, then by the share of the tolerance used."""
        return tuple(sorted(self.outcomes, key=_badness))

    @property
    def foremost(self) -> tuple[Outcome, ...]:
        """The comparisons that matter first: what does not agree, then what nearly does not.

        Guards that agree are left out: they say nothing of this robot.
        """
        tried = [outcome for outcome in self.worst_first if outcome.verdict != "skipped"]
        bad = [outcome for outcome in tried if outcome.verdict != "agree"]
        others = [outcome for outcome in tried[len(bad) :] if outcome.case.section != GUARDS]
        return (*bad, *others[:_FOREMOST])

    @property
    def skipped(self) -> Mapping[str, tuple[Outcome, ...]]:
        """What was skipped, by the reason."""
        skipped = [outcome for outcome in self.outcomes if outcome.verdict == "skipped"]
        return {
            reason: tuple(outcome for outcome in skipped if outcome.message == reason)
            for reason in dict.fromkeys(outcome.message for outcome in skipped)
        }

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """The sections in the order in which they appear.

        An interrupted run goes without the plots of studies and budgets: whoever presses Ctrl-C
        waits for nothing.
        """
        studies = {study.id for study in studies_of(self.outcomes)}
        figures = [figure for figure in self.figures if figure.id not in studies]
        return sections_of(self.outcomes, figures, plotted=not self.unfinished)

    @property
    def shown(self) -> tuple[Figure, ...]:
        """Every figure of the page in its order, those drawn from the outcomes among them."""
        figures = [
            figure
            for section in self.sections
            for figure in (
                section.budget,
                *section.figures,
                *(plot.figure for plot in section.plots),
            )
        ]
        return tuple(figure for figure in figures if figure is not None)

    @cached_property
    def second_ways(self) -> tuple[Agreement, ...]:
        """The headline numbers and the ways in which they were obtained."""
        return agreements(self.outcomes)

    @property
    def viewer(self) -> str:
        """The viewer of the 3-D scenes, packed for the page; empty where there are none."""
        shown = any(figure.scenes for figure in self.figures)
        return scene_viewer.packed() if shown else ""

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
        "unexplained_share": unexplained_share,
        "share_text": text.share_text,
        "seconds": text.seconds,
        "anchor": text.anchor,
        "function_name": text.function_name,
        "data_uri": text.data_uri,
        "base64": text.base64,
        "inline_svg": lambda figure: Markup(text.inline_svg(figure)),  # noqa: S704  our own plots
        "amount": text.tolerance,
        "rows": lambda columns: zip(*columns.values(), strict=True),
    }
    environment.globals["explained"] = explained
    environment.globals["mark"] = {
        "agree": "✓",
        "disagree": "✗",
        "undecided": "?",
        "failed": "!",
        "skipped": "–",
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
