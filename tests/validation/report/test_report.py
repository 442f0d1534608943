"""The report from made-up outcomes: complete, self-contained, worst first."""

import base64
import csv
import io
import re
from collections import defaultdict
from dataclasses import replace
from html.parser import HTMLParser
from math import nan

import numpy as np
import pytest
from support.pages.report_sample import (
    CONVERGENCE,
    PIXEL,
    measured,
    never,
    redeclared,
    sample_outcomes,
    sample_report,
    study_picture,
    unmeasured,
)

from validation.case import Absolute, Allowance, Relation
from validation.drawing import text
from validation.drawing.chart import Series
from validation.report import sections
from validation.report.figures.budgets import budget_curves, budget_figure
from validation.report.figures.studies import (
    _slopes,
    families,
    family_of,
    study_curves,
    study_figure,
)
from validation.report.page import render
from validation.report.sections import LEGS, PageSection, chapters_of, unexplained_share
from validation.studies_and_figures import (
    AGREEMENT,
    PATH,
    Figure,
    InteractiveScene,
    Study,
    study_record,
)
from validation.verdicts import ADEQUACY, MEASURED

# After the first page, whose charts are drawn.
pytestmark = pytest.mark.usefixtures("markup", "blank_charts")
VOID = {"meta", "link", "img", "br", "hr", "input"}


class Page(HTMLParser):
    """Parser of a page: values of all attributes by name; elements must be closed in order."""

    def __init__(self, markup):
        super().__init__()
        self.open, self.values = [], defaultdict(list)
        self.feed(markup)
        self.close()

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            self.values[name].append(value)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert tag in VOID or self.open.pop() == tag


@pytest.fixture(scope="module")
def markup():
    return render(sample_report())


def test_page_is_valid_and_self_contained(markup):
    """Closed elements, unique ids, links within the page, and no other files."""
    page = Page(markup)
    assert page.open == []
    ids = page.values["id"]
    assert len(ids) == len(set(ids))
    links = page.values["href"] + page.values["xlink:href"]
    assert {link[1:] for link in links if link.startswith("#")} <= set(ids)
    assert {"verdict", "adequacy", "audit", "provenance"} <= set(ids)
    assert all(link.startswith(("#", "data:")) for link in links)
    assert all(source.startswith("data:image/") for source in page.values["src"])
    references = re.findall(r"url\(([^)]*)\)", markup)
    assert all(reference.startswith(("#", "data:")) for reference in references)
    assert not re.search(r"<script src|@import|fetch\(", markup)


def test_verdict_is_at_top_of_page(markup):
    """The recommendation, then counts of comparisons with a link to the first that disagrees."""
    banner = markup[markup.index('id="verdict"') : markup.index("</header>")]
    answer = re.search(r"<strong>([^<]*)</strong>", banner)[1]
    assert answer.startswith("Within the accepted errors, use vjm (deflections and rotations); ")
    summary = "3 of 5 comparisons agree, 1 disagree, 1 failed, 1 skipped, 1 figure failed."
    assert summary in banner
    # What does not agree is named where nobody overlooks it.
    assert 'href="#robot.beam-vjm.planar_x_0.4975"' in banner


def test_inadequate_model_colours_the_banner():
    """The banner has another colour if a model named with --rely is inadequate."""
    for rely, colour in (("vjm", "answer"), ("simplified", "inadequate")):
        report = sample_report(outcomes=[])
        page = render(replace(report, results=replace(report.results, rely=(rely,))))
        assert f'<div class="banner {colour}" id="verdict">' in page


def test_missing_matrix_has_reason_on_page():
    """Without finite element references, or without measured poses."""
    page = render(sample_report(matrix=None, unjudged={ADEQUACY: "the sections are too thin"}))
    assert "No model was judged by finite elements: the sections are too thin." in page
    assert 'id="adequacy"' not in page
    assert "<strong>3 of 5 comparisons agree" in page
    # Where measured values alone are lost, the models were judged nevertheless.
    page = render(sample_report(unjudged={MEASURED: "no such pose"}, unfinished=1))
    assert "No model was judged against measured values: no such pose." in page
    assert "No model was judged by" not in page
    assert "<strong>Within the accepted errors, use" in page


def test_worst_comparisons_come_first():
    """Order by verdict, then by share of the tolerance."""
    report = sample_report()
    assert [outcome.verdict for outcome in report.bad] == ["disagree", "failed"]
    sections_by_title = {
        section.title: section for chapter in report.chapters for section in chapter.sections
    }
    assert [outcome.case.id for outcome in sections_by_title["The legs"].worst_first] == [
        *("legs.failed", "legs.tight", "legs.agrees", "legs.skipped")
    ]


def test_page_has_cases_and_provenance(markup):
    """Source, tolerance reason, code, messages, versions and data of the figures."""
    cases = len(sample_outcomes())
    for html in ("Timoshenko &amp; Gere, Table 1", "shear is in both models", ".never</code>"):
        assert markup.count(html) >= cases
    for html in (
        *("matrix is &lt;singular&gt;", "shear deformation", "CalculiX is not installed"),
        # Of the relative comparisons "Agrees barely" leaves most: (1.0095 − 1)/1 = 0.95 %.
        "comparisons agree, at most 0.95\u00a0% unexplained",
        *("the matrix is indefinite", "3.16e-07", "ab" * 32, "numpy 2.4.6", "no OpenGL"),
        "<dt>Self-test of this installation</dt><dd>passed on 2026-01-01</dd>",
    ):
        assert html in markup
    links = re.findall(
        r'download="([^"]+)" href="data:text/csv;charset=utf-8;base64,([^"]+)"', markup
    )
    data = {name: base64.b64decode(content).decode() for name, content in links}
    assert data["fig5.csv"] == "x\n1\n"
    assert data["study.elements.csv"] == study_picture().data


def test_empty_and_interrupted_runs_have_page():
    """With the number of cases that were not computed."""
    empty = sample_report(outcomes=(), figures=(), findings=(), missing=(), matrix=None)
    assert "No comparison was made." in render(empty)
    part = sample_report(unfinished=4)
    assert "4 not computed" in render(part)
    assert sample_report(outcomes=(), unfinished=1).verdict == "failed"
    all_sections = [section for chapter in part.chapters for section in chapter.sections]
    assert not any(picture for section in all_sections for _, picture in section.plots)


def test_shared_study_is_shown_once():
    """Two cases of one convergence study have one chart."""
    outcomes = [measured(f"legs.{n}", 1.0, 1.0, studies=(CONVERGENCE,)) for n in "ab"]
    report = sample_report(outcomes=outcomes, figures=(study_picture(),), matrix=None)
    ((section,),) = (chapter.sections for chapter in report.chapters)
    ((family, _),) = section.plots
    assert family.computed_by == (f"{never.__module__}.never",)
    assert {curve.study.id for curve in family.curves} == {CONVERGENCE.id}
    assert section.figures == ()
    ids = Page(render(report)).values["id"]
    assert len(ids) == len(set(ids))


def test_only_equality_is_shown_in_percent():
    """The explained share of a difference is shown only for a claim that two values are equal."""
    for fields, share in (
        ({}, 0.005),
        ({"tolerance": Absolute(0.1)}, None),
        ({"relation": Relation.AT_MOST}, None),
    ):
        # A cause explains 0.01 of a difference of 0.02: half of it.
        outcome = measured("a", 2.02, 2.0, allowances=(Allowance("warping", 0.01),), **fields)
        assert unexplained_share(outcome) == (share and pytest.approx(share))


def test_budget_shows_causes_and_remainder():
    """−5 % of difference: −4.8 % warping, −0.2 % unexplained of a tolerance of 1 %."""
    allowances = (Allowance("warping", -0.096),)
    outcome = measured("solid", 1.9, 2.0, 1e-4, exact=False, allowances=allowances)
    total, remainder = budget_curves([(outcome, outcome.measurement)]).panels
    # In % of the reference, and of the tolerance of 1 % of it.
    assert [(bar.label, *bar.y) for bar in total.bars] == [
        *(("warping", pytest.approx(-4.8)), ("unexplained", pytest.approx(-0.2)))
    ]
    assert total.series[0].y == pytest.approx([-5.0])
    assert remainder.bars[0].y == remainder.series[0].y == pytest.approx([-20.0])
    assert remainder.series[0].bars == pytest.approx([0.5])
    assert remainder.band == (-100.0, 100.0)
    figure = budget_figure("budget.leg1", "Leg 1", "budgets", [outcome])
    (row,) = csv.DictReader(io.StringIO(figure.data))
    assert row.pop("case") == "solid"
    # Of the reference 2: E = −0.1, explained −0.096, left −0.004, uncertainty 1e-4, tolerance 1 %.
    labels = ("difference", "warping", "unexplained", "numerical uncertainty", "tolerance")
    shares = zip(labels, (-5.0, -4.8, -0.2, 0.005, 1.0), strict=True)
    assert {name: float(value) for name, value in row.items()} == {
        f"{name} (% of the reference)": pytest.approx(share) for name, share in shares
    }


def test_page_figures_are_written_to_files(markup):
    """Picture and CSV data, with unique names."""
    figures = sample_report().shown
    in_page = set(re.findall(r'<figure id="([^"]+)"', markup))
    assert {text.anchor(figure.id) for figure in figures} == in_page
    names = [name for figure in figures for name in figure.files]
    assert len(names) == len(set(names))
    assert {"fig5.png", "fig5.csv", "study.elements.svg", "study.elements.csv"} <= set(names)


def test_failing_plot_affects_only_itself(monkeypatch):
    """The page is written without the chart."""
    monkeypatch.setattr(sections, "study_figure", lambda _: 1 / 0)
    assert "Agrees barely" in render(sample_report(matrix=None))


def test_chapter_order_is_fixed():
    """The robot, its legs (folded), the paper (folded)."""
    names = ("crank", "The paper's statements", "Leg 2", "The mechanism over its path")
    names += ("The robot over its stroke",)
    chapters = chapters_of([measured(n, 1.0, 1.0, section=n) for n in names], (), plotted=False)
    contents = [
        (chapter.title, chapter.folded, [section.title for section in chapter.sections])
        for chapter in chapters
    ]
    assert contents == [
        ("The robot", False, [names[3]]),
        (LEGS, True, ["crank", "Leg 2"]),
        ("The paper", True, [names[1], names[4]]),
    ]


def test_page_has_scenes_and_names_missing_pictures():
    """The viewer code is in the page once, and only if the page has a scene."""
    scene = InteractiveScene("(a) mode 1", b"PK state")
    first, second, left_out = (
        Figure(name, name, "", "The legs", data="x\n1\n", scenes=(scene,), **picture)
        for name, picture in (
            *(("one", {"png": PIXEL}), ("two", {"png": PIXEL})),
            ("robot.modes", {"left_out": "no usable OpenGL"}),
        )
    )
    assert set(left_out.files) == {"robot.modes.csv"}
    outcomes = (measured("nan", nan, 1.0),)
    page = render(sample_report(figures=(first, second, left_out), outcomes=outcomes, matrix=None))
    assert page.count(base64.b64encode(scene.state).decode()) == 3
    assert page.count("data-scene=") == 3
    assert page.count("const showScene =") == 1
    assert "Picture left out: no usable OpenGL" in page
    assert "not a number" in page


def test_curve_data_have_curve_names_and_values():
    """CSV data and record in results.json of a convergence study."""
    rows = list(csv.DictReader(io.StringIO(study_picture().data)))
    columns = {f"{name} (Hz)": values for name, values in CONVERGENCE.series.items()}
    assert {name: tuple(float(row[name]) for row in rows) for name in rows[0]} == {
        CONVERGENCE.x_label: CONVERGENCE.x,
        **columns,
    }
    record = study_record(CONVERGENCE)
    assert (record["x"], record["series"]) == (CONVERGENCE.x, CONVERGENCE.series)
    assert record["uncertainty"] == CONVERGENCE.uncertainties
    assert record["limit"] == CONVERGENCE.limits


def test_studies_of_a_family_share_axes():
    """Studies of one family, such as bending and torsion, are curves of one chart."""
    members = [
        replace(CONVERGENCE, id=name, family="cross", family_title="cross", variant=name)
        for name in ("bending", "torsion")
    ]
    study_families = families([measured("solid", 2.0, 2.0, studies=(*members, CONVERGENCE))])
    assert [
        (family.id, family.title, [curve.label for curve in family.curves])
        for family in study_families
    ] == [
        ("cross", "Cross", ["bending"] * 2 + ["torsion"] * 2),
        (CONVERGENCE.id, CONVERGENCE.title, list(CONVERGENCE.series)),
    ]


def test_plot_files_are_reproducible(blank_charts):
    """Equal bits for equal data, without dates; ids differ between figures of a page."""
    blank_charts.undo()
    first, repeated, second = (
        study_figure(family_of([replace(CONVERGENCE, id=name)])) for name in ("one", "one", "two")
    )
    assert first.svg == repeated.svg
    assert first.svg.startswith("<svg")
    assert "<dc:date>" not in first.svg
    ids = [set(re.findall(r'id="([^"]+)"', text.inline_svg(f))) for f in (first, second)]
    assert not ids[0] & ids[1]
    used = re.findall(r'(?:href="#|url\(#)([^")]+)', text.inline_svg(first))
    assert set(used) <= ids[0]


def test_cross_validation_is_first():
    """The section is directly below the verdict, above the matrix of the models, and unfolded."""
    outcome = measured("agrees", 1.0, 1.0, section=AGREEMENT)
    other = measured("robot", 1.0, 1.0, section=PATH)
    first, second = chapters_of([other, outcome], [], plotted=False)
    assert first.leads
    assert not first.folded
    assert first.title == "Cross-validation"
    assert not second.leads


def test_skipped_section_has_reasons():
    """Each reason appears once with its bodies. The section is absent if anything was compared."""
    skipped = tuple(
        redeclared(unmeasured(name, "skipped", "too large"), body=name) for name in ("rod", "crank")
    )
    section = PageSection("Convergence with mesh", skipped, (), plotted=False)
    assert section.skipped == ("rod, crank: too large",)
    compared = (*skipped, measured("other", 1.0, 1.0))
    assert PageSection("Convergence with mesh", compared, (), plotted=False).skipped == ()
    page = render(sample_report(outcomes=skipped, figures=(), matrix=None))
    assert "<summary>2 comparisons skipped</summary>" in page


@pytest.mark.parametrize(
    "x",
    # Divisions rise with refinement, mesh sizes fall.
    [[2.0, 4.0, 8.0], [0.4, 0.2, 0.1]],
    ids=["divisions", "mesh-size"],
)
def test_slope_line_has_formal_order(x):
    """Halving the mesh divides an error of second order by four."""
    x = np.array(x)
    (line,) = _slopes(x, [Series("solid", x, np.array([8.0, 2.0, 0.5]))], [2.0])
    np.testing.assert_allclose(line.y[:-1] / line.y[1:], 4.0)
    # Below the curves, so that it hides none.
    assert line.y[0] == pytest.approx(4.0)
    assert line.label == "slope 2"


def test_convergence_is_in_percent():
    """f = 200 (1 − 1/n²) Hz is 4 % below its limit at n = 5. A limit ± 0.5 Hz has ± 0.25 %."""
    x = (5.0, 10.0, 20.0)
    values = tuple(200.0 * (1.0 - 1.0 / n**2) for n in x)
    fields_of_study = {"limits": {"f1": 200.0}, "uncertainties": {"f1": 0.5}, "orders": {"f1": 2.0}}
    for fields, deviations in (
        (fields_of_study, [-4.0, -1.0, -0.25]),
        # From the finest value instead.
        ({}, [100.0 * (value / values[-1] - 1.0) for value in values]),
    ):
        study = Study("s", "Study", "divisions", "f", "Hz", x, {"f1": values}, 2.0, **fields)
        chart = study_curves(family_of([study]))
        deviation, decay = (panel.series[0] for panel in chart.panels)
        np.testing.assert_allclose(deviation.y, deviations, atol=1e-12)
        not_zero = np.array(deviations)[np.array(deviations) != 0.0]
        np.testing.assert_allclose(decay.y, np.abs(not_zero), atol=1e-12)
        assert deviation.label == ("f1: order 2.00" if fields else "f1: no order")
        if fields:
            np.testing.assert_allclose(deviation.bars, [np.nan, np.nan, 0.25])
            # Below its value it ends before zero, which no logarithmic axis has.
            np.testing.assert_allclose(decay.bars[:, -1], [0.225, 0.25])
        else:
            assert deviation.bars is None


def test_budget_bars_of_causes_are_hatched(blank_charts):
    """In the SVG, hatching consists of elements named `pattern`."""
    blank_charts.undo()
    allowances = tuple(Allowance(cause, -0.03) for cause in ("warping", "shear", "contraction"))
    outcome = measured("solid", 1.9, 2.0, 1e-4, exact=False, allowances=allowances)
    figure = budget_figure("budget.leg1", "Leg 1", "budgets", [outcome])
    assert figure is not None
    assert figure.svg.count("<pattern") == 2
