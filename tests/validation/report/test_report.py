"""The report from made-up outcomes: complete, self-contained, worst first."""

import base64
import csv
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from math import nan

import pytest
from report_sample import CONVERGENCE, DRAWN, PIXEL, case, never, sample_outcomes, sample_report

from validation.adequacy.matrix import ADEQUACY, MEASURED
from validation.case import Absolute, Allowance, Measurement, Relation
from validation.drawing import text
from validation.exhibits import Figure, InteractiveScene
from validation.report import sections
from validation.report.figures.budgets import budget_curves, budget_figure
from validation.report.figures.studies import families, family_of, study_figure
from validation.report.page import render
from validation.report.sections import LEGS, chapters_of, unexplained_share
from validation.results.outcome import judge

VOID = {"meta", "link", "img", "br", "hr", "input"}


class Page(HTMLParser):
    """Ids, links and sources of a page, and whether its elements are closed in order."""

    def __init__(self, markup):
        super().__init__()
        self.ids, self.links, self.sources, self.open, self.rows = [], [], [], [], []
        self.feed(markup)
        self.close()

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids += [values["id"]] if "id" in values else []
        self.links += [values[key] for key in ("href", "xlink:href") if key in values]
        self.sources += [values["src"]] if "src" in values else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def markup():
    return render(sample_report())


def test_the_page_is_well_formed_and_its_links_lead_somewhere(markup):
    page = Page(markup)
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    inner = {link[1:] for link in page.links if link.startswith("#")}
    assert inner <= set(page.ids)
    assert {"verdict", "adequacy", "audit", "provenance"} <= set(page.ids)


def test_the_page_needs_nothing_else(markup):
    page = Page(markup)
    assert all(link.startswith(("#", "data:")) for link in page.links)
    assert all(source.startswith("data:image/") for source in page.sources)
    references = set(re.findall(r"url\(([^)]*)\)", markup))
    assert all(reference.startswith(("#", "data:")) for reference in references)
    assert "<script src" not in markup
    assert "@import" not in markup
    assert "fetch(" not in markup


def test_the_answer_stands_at_the_top_and_the_checks_behind_it(markup):
    banner = markup[markup.index('id="verdict"') : markup.index("</header>")]
    answer = re.search(r"<strong>([^<]*)</strong>", banner)[1]
    assert answer.startswith("For your limits use vjm (deflections and rotations); ")
    assert "3 of 5 comparisons agree, 1 disagree, 1 failed, 1 skipped." in banner
    # What does not agree is named where nobody overlooks it.
    assert 'href="#robot.beam-vjm.planar_x_0.4975"' in banner


def test_the_page_says_why_there_is_no_matrix():
    page = render(sample_report(matrix=None, unjudged={ADEQUACY: "the sections are too thin"}))
    assert "No model was judged by finite elements: the sections are too thin." in page
    assert 'id="adequacy"' not in page
    assert "<strong>3 of 5 comparisons agree" in page
    # Where measured values alone are lost, the models were judged nevertheless.
    page = render(sample_report(unjudged={MEASURED: "no such pose"}))
    assert "No model was judged against measured values: no such pose." in page
    assert "No model was judged by" not in page
    assert "<strong>For your limits use" in page


def test_the_worst_comparisons_of_a_section_come_first():
    report = sample_report()
    assert [outcome.verdict for outcome in report.bad] == ["disagree", "failed"]
    (section,) = (
        one for chapter in report.chapters for one in chapter.sections if one.title == "The legs"
    )
    assert [outcome.case.id for outcome in section.worst_first] == [
        *("legs.failed", "legs.tight", "legs.agrees", "legs.skipped")
    ]


def test_the_page_shows_cases_data_findings_and_provenance(markup):
    cases = len(sample_outcomes())
    for shown in ("Timoshenko &amp; Gere, Table 1", "shear is in both models", ".never</code>"):
        assert markup.count(shown) >= cases
    for shown in (
        *("matrix is &lt;singular&gt;", "shear deformation", "CalculiX is not installed"),
        # Of the relative comparisons "Agrees barely" leaves most: (1.0095 − 1)/1 = 0.95 %.
        "comparisons agree, at most 0.95\u00a0% unexplained",
        *("the matrix is indefinite", "3.16e-07", "ab" * 32, "numpy 2.4.6", "no OpenGL"),
        "<dt>Self-test of this installation</dt><dd>passed on 2026-01-01</dd>",
    ):
        assert shown in markup
    links = re.findall(
        r'download="([^"]+)" href="data:text/csv;charset=utf-8;base64,([^"]+)"', markup
    )
    data = {name: base64.b64decode(content).decode() for name, content in links}
    assert data["fig5.csv"] == "x\n1\n"
    assert data["study.elements.csv"] == DRAWN.data


def test_an_empty_and_an_interrupted_run_have_a_page():
    empty = sample_report(outcomes=(), figures=(), findings=(), missing=(), matrix=None)
    assert "No comparison was made." in render(empty)
    part = sample_report(unfinished=4)
    assert "4 not computed" in render(part)
    assert sample_report(outcomes=(), unfinished=1).verdict == "failed"
    sections_of = [section for chapter in part.chapters for section in chapter.sections]
    assert not any(drawn for section in sections_of for _, drawn in section.plots)


def test_a_study_shared_by_several_cases_is_shown_once():
    outcomes = [
        judge(case(f"legs.{n}"), Measurement(1.0, 1.0, exact=True, studies=(CONVERGENCE,)), 0.1)
        for n in "ab"
    ]
    report = sample_report(outcomes=tuple(outcomes), figures=(DRAWN,))
    ((section,),) = (chapter.sections for chapter in report.chapters)
    ((family, _),) = section.plots
    assert family.computed_by == (f"{never.__module__}.never",)
    assert {curve.study.id for curve in family.curves} == {CONVERGENCE.id}
    assert section.figures == ()
    page = Page(render(report))
    assert len(page.ids) == len(set(page.ids))


def model_case(model, name, value, reference=2.0, allowances=(), studies=()):
    return judge(
        case(f"leg1.compliance.{model}[{name}]", quantity=f"compliance {name}", model=model),
        Measurement(value, reference, 1e-4, allowances=allowances, studies=studies),
        0.1,
    )


@pytest.mark.parametrize(
    ("changes", "reference", "share"),
    [
        ({}, 2.0, 0.005),
        ({"tolerance": Absolute(0.1)}, 2.0, None),
        ({"relation": Relation.AT_MOST}, 2.0, None),
    ],
)
def test_only_equal_numbers_have_an_unexplained_difference_in_per_cent(changes, reference, share):
    outcome = judge(
        case(**changes), Measurement(1.01 * reference, reference, exact=True, allowances=HALF), 0.1
    )
    assert unexplained_share(outcome) == (None if share is None else pytest.approx(share))


# Explains 0.01 of a difference of 0.02: half of it.
HALF = (Allowance("warping", 0.01),)


def test_a_budget_shows_what_is_measured_explained_and_left():
    outcome = model_case("solid", "c44", 1.9, allowances=(Allowance("warping", -0.096),))
    chart = budget_curves([(outcome, outcome.measurement)]).chart
    whole, rest = chart.panels
    # In % of the reference, and of the tolerance of 1 % of it.
    assert [(one.label, *one.y) for one in whole.bars] == [
        *(("warping", pytest.approx(-4.8)), ("unexplained", pytest.approx(-0.2)))
    ]
    assert whole.series[0].y == pytest.approx([-5.0])
    assert rest.bars[0].y == rest.series[0].y == pytest.approx([-20.0])
    assert rest.series[0].bars == pytest.approx([0.5])
    assert rest.band == (-100.0, 100.0)
    figure = budget_figure("budget.leg1", "Leg 1", "budgets", [outcome])
    (row,) = csv.DictReader(io.StringIO(figure.data))
    assert row.pop("case") == "leg1.compliance.solid[c44]"
    # Of the reference 2: E = −0.1, explained −0.096, left −0.004, uncertainty 1e-4, tolerance 1 %.
    shares = [-5.0, -4.8, -0.2, 0.005, 1.0]
    assert [float(value) for value in row.values()] == pytest.approx(shares)
    assert [name.partition(" (% of the ")[0] for name in row] == [
        *("difference", "warping", "unexplained", "numerical uncertainty", "tolerance")
    ]


def test_the_figures_of_the_page_are_all_there_to_be_written(markup):
    shown = sample_report().shown
    in_page = set(re.findall(r'<figure id="([^"]+)"', markup))
    assert {text.anchor(figure.id) for figure in shown} == in_page
    names = [name for figure in shown for name in figure.files]
    assert len(names) == len(set(names))
    assert {"fig5.png", "fig5.csv", "study.elements.svg", "study.elements.csv"} <= set(names)


def test_a_plot_that_fails_costs_nothing_but_itself(monkeypatch):
    def fail(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(sections, "study_figure", fail)
    assert "Agrees barely" in render(sample_report())


def test_chapters_answer_in_turn_whatever_came_first():
    names = ("crank", "The paper's statements", "Leg 2", "The mechanism over its path")
    names += ("The robot over its stroke",)
    outcomes = [
        judge(case(f"c.{n}", section=n), Measurement(1.0, 1.0, exact=True), 0.1) for n in names
    ]
    found = chapters_of(outcomes, (), plotted=False)
    assert [(chapter.title, chapter.folded) for chapter in found] == [
        *(("The robot", False), (LEGS, True), ("The paper", True))
    ]
    assert [[section.title for section in chapter.sections] for chapter in found] == [
        *([names[3]], ["crank", "Leg 2"], [names[1], names[4]])
    ]


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (1.06e-6, "1.06\u00a0×\u00a010⁻⁶"),
        (-123456.0, "−123460"),
        (0.0, "0"),
        (None, "–"),
        ("centre", "centre"),
        (float("inf"), "∞"),
    ],
)
def test_numbers_are_written_as_in_print(value, shown):
    assert text.number(value) == shown


def test_scenes_missing_pictures_and_values_that_are_no_numbers_are_shown():
    """The viewer stands in the page once, and only where there is something to be turned."""
    scene = InteractiveScene("(a) mode 1", b"PK state")
    figures = [
        Figure(name, name, "", "The legs", png=PIXEL, scenes=(scene,)) for name in ("one", "two")
    ]
    left_out = {"data": "x\n1\n", "left_out": "no usable OpenGL", "scenes": (scene,)}
    figures.append(Figure("robot.modes", "Modes", "", "The legs", **left_out))
    assert set(figures[-1].files) == {"robot.modes.csv"}
    outcome = judge(case(), Measurement(nan, 1.0, exact=True), 0.1)
    shown = render(sample_report(figures=tuple(figures), outcomes=(outcome,)))
    assert shown.count(base64.b64encode(scene.state).decode()) == 3
    assert shown.count("data-scene=") == 3
    assert shown.count("const showScene =") == 1
    assert "Picture left out: no usable OpenGL" in shown
    assert "not a number" in shown


def test_plots_have_ids_of_their_own_and_equal_studies_give_equal_files():
    first, again, second = (
        study_figure(family_of([replace(CONVERGENCE, id=name)])) for name in ("one", "one", "two")
    )
    assert first.svg == again.svg
    assert first.svg.startswith("<svg")
    assert "<dc:date>" not in first.svg
    ids = [set(re.findall(r'id="([^"]+)"', text.inline_svg(f))) for f in (first, second)]
    assert not ids[0] & ids[1]
    used = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', text.inline_svg(first)))
    assert {a or b for a, b in used} <= ids[0]


def test_studies_of_a_family_share_their_axes_and_go_by_their_variants():
    members = [
        replace(CONVERGENCE, id=name, family="cross", family_title="cross", variant=name)
        for name in ("bending", "torsion")
    ]
    outcome = model_case("solid", "c22", 2.0, studies=(*members, CONVERGENCE))
    found = families([outcome])
    assert [(one.id, one.title) for one in found] == [
        *(("cross", "Cross"), (CONVERGENCE.id, CONVERGENCE.title))
    ]
    labels = ["bending"] * 3 + ["torsion"] * 3
    assert [[curve.label for curve in one.curves] for one in found] == [
        *(labels, list(CONVERGENCE.series))
    ]
