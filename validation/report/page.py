"""The page report.html, made from the results of a run.

Input: `Results` and findings of the audit of the robot file. Output: self-contained HTML, and its
tables as CSV.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import isnan

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape

from lumped.audit import Finding
from lumped.text import counted
from validation.drawing import text
from validation.drawing.turnable import viewer
from validation.report.agreement import MARKS
from validation.report.first_screen import FirstScreen, first_screen
from validation.report.sections import Chapter, chapters_of
from validation.report.summary import decision_sentences
from validation.run.outcome import Outcome, Verdict
from validation.run.records import studies_of
from validation.run.results import Results
from validation.studies_and_figures import PORTRAIT, Figure
from validation.verdicts import Matrix


@dataclass(frozen=True)
class Report:
    """Content of the page: results of a run, and findings of the audit of its data."""

    results: Results
    findings: Sequence[Finding] = ()

    @cached_property
    def outcomes(self) -> list[Outcome]:
        """Outcomes of all comparisons."""
        return self.results.outcomes

    @cached_property
    def drifts(self) -> Mapping[str, Outcome]:
        """Comparisons whose drift from the baseline is known, by id."""
        return {outcome.id: outcome for outcome in self.outcomes if outcome.drift is not None}

    @cached_property
    def first(self) -> FirstScreen | None:
        """First screen with computed references. None if no model was judged."""
        return self._screen(self.results.matrix)

    @cached_property
    def measurements(self) -> FirstScreen | None:
        """Summary at the top of the page, of the comparison with measured values.

        None if there are no measured values.
        """
        return self._screen(self.results.measured, measured=True)

    def _screen(self, matrix: Matrix | None, *, measured: bool = False) -> FirstScreen | None:
        if matrix is None:
            return None
        plotted, rely = not self.results.unfinished, self.results.rely
        return first_screen(matrix, plotted=plotted, measured=measured, rely=rely)

    @property
    def answered(self) -> FirstScreen | None:
        """First screen with the verdict of the page.

        It is `first` (computed references) if there is one, otherwise `measurements`. None if there
        is neither.
        """
        return self.first or self.measurements

    @property
    def sentence(self) -> str:
        """Sentence with the verdict on the models, or on the comparisons if no model was judged."""
        return self.answered.sentence if self.answered else self.checks

    @property
    def decisions(self) -> list[str]:
        """Sentences on the values of varied parameters that the models choose.

        [] if nothing is varied.
        """
        return decision_sentences(self.outcomes)

    @property
    def checks(self) -> str:
        """Sentence with the number of comparisons by verdict."""
        sentence, skipped_ids = self.results.standing.sentence, self.results.no_longer_compared
        if skipped_ids:
            sentence += (
                " Comparisons that agreed in the baseline and are skipped in this run: "
                f"{', '.join(skipped_ids)}."
            )
        return sentence

    @property
    def portrait(self) -> Figure | None:
        """Picture of the robot at rest. None if the run has none."""
        return next((figure for figure in self.results.figures if figure.id == PORTRAIT), None)

    @property
    def bad(self) -> tuple[Outcome, ...]:
        """Comparisons that disagree, then those that failed."""
        wrong = (o for o in self.outcomes if o.verdict in {"disagree", "failed"})
        return tuple(sorted(wrong, key=lambda outcome: outcome.verdict))

    @property
    def verdict(self) -> Verdict:
        """Verdict that determines the result of the run.

        It is the first of "disagree", "failed", "undecided" and "agree" that any comparison has,
        otherwise "skipped". An unfinished run counts as failed, unless a comparison disagrees.
        """
        verdicts = {outcome.verdict for outcome in self.outcomes}
        if "disagree" in verdicts:
            return "disagree"
        if "failed" in verdicts or self.results.unfinished:
            return "failed"
        if "undecided" in verdicts:
            return "undecided"
        return "agree" if "agree" in verdicts else "skipped"

    @cached_property
    def chapters(self) -> tuple[Chapter, ...]:
        """Chapters on the robot, its legs and the paper.

        An interrupted run has no plots of studies and budgets, so that Ctrl-C ends it at once.
        """
        drawn = {study.id for study in studies_of(self.outcomes)} | {PORTRAIT}
        figures = [figure for figure in self.results.figures if figure.id not in drawn]
        matrix = self.results.matrix or self.results.measured
        return chapters_of(
            self.outcomes,
            figures,
            plotted=not self.results.unfinished,
            coordinates=matrix.coordinates if matrix else (),
        )

    @property
    def shown(self) -> tuple[Figure, ...]:
        """All figures of the page in order, including those drawn from the outcomes."""
        screens = (self.first, self.measurements)
        first = (*(screen.errors for screen in screens if screen), self.portrait)
        sections = [section for chapter in self.chapters for section in chapter.sections]
        return (
            *(figure for figure in first if figure),
            *(figure for section in sections for figure in section.shown),
        )

    @property
    def tables(self) -> Mapping[str, str]:
        """Tables of the page as CSV by file name, without those of figures."""
        sections = [section for chapter in self.chapters for section in chapter.sections]
        tables = [section.agreement_csv for section in sections if section.agreement_csv]
        return {"cross-validation.csv": tables[0]} if tables else {}

    @cached_property
    def figure_ids(self) -> Mapping[str, str]:
        """Titles of the computed figures by id, for links from comparisons."""
        return {figure.id: figure.title for figure in self.results.figures}

    @property
    def viewer(self) -> str:
        """Script that displays 3-D scenes. "" if the page has no scenes."""
        return viewer() if any(figure.scenes for figure in self.results.figures) else ""


def render(report: Report) -> str:
    """HTML page of a report."""
    return _templates().get_template("report.html.j2").render(report=report)


# Compiled once, as this takes longer than filling a short page.
@lru_cache(maxsize=1)
def _templates() -> Environment:
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
        "data_uri": text.data_uri,
        "base64": text.base64,
        "inline_svg": lambda figure: Markup(text.inline_svg(figure)),  # noqa: S704  our own plots
        "amount": text.tolerance,
        "counted": counted,
        "unbroken": _unbroken,
        "rows": lambda columns: zip(*columns.values(), strict=True),
    }
    environment.globals["mark"] = MARKS
    environment.tests["nan"] = lambda value: isinstance(value, float) and isnan(value)
    return environment


def _unbroken(sentence: str) -> Markup:
    """Markup of a sentence without line breaks inside an option such as "--parts stepped"."""
    return Markup(re.sub(r"(--\w+ \w+)", r'<span class="data">\1</span>', str(escape(sentence))))  # noqa: S704
