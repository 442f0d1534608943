"""The report from made-up outcomes: complete, self-contained, worst first."""

import base64
import re
import warnings
from html.parser import HTMLParser
from math import nan

import pytest

from lumped.finding import Finding
from validation.case import (
    Absolute,
    Allowance,
    Case,
    Measurement,
    Outcome,
    Relation,
    Relative,
    judge,
)
from validation.exhibits import Drawing, Figure, Study
from validation.records import Drawn
from validation.report import text
from validation.report.page import Report, render
from validation.report.style import canvas, csv_of, plot_style, study_plot, svg_of

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
VOID = {"meta", "link", "img", "br", "hr", "input"}


def never(_context):
    raise AssertionError("the report computes nothing")


def case(identifier="legs.a", **changes):
    fields = {
        "id": identifier,
        "title": "Tip deflection of leg 1 along y",
        "quantity": "c22",
        "unit": "m/N",
        "reference_kind": "closed-form",
        "citation": "Timoshenko & Gere, Table 1",
        "tolerance": Relative(0.01),
        "tolerance_reason": "shear is in both models",
        "compute": never,
        "section": "The legs",
    }
    return Case(**(fields | changes))


CONVERGENCE = Study(
    id="study.elements",
    kind="convergence",
    title="Frequencies of leg 1 against the number of segments",
    x_label="elements per leg",
    y_label="bending frequencies",
    unit="Hz",
    x=(5.0, 10.0, 20.0, 40.0, 80.0, 160.0),
    series={
        f"mode {mode}": tuple(f * (1.0 - 0.65 * mode / n**2) for n in (5, 10, 20, 40, 80, 160))
        for mode, f in ((1, 186.8), (2, 1170.0), (3, 3278.0))
    },
    formal_order=2.0,
    orders={"mode 1": 2.0, "mode 2": 2.0, "mode 3": 1.99},
    uncertainties={"mode 1": 0.006, "mode 2": 0.07, "mode 3": 0.3},
    limits={"mode 1": 186.8, "mode 2": 1170.0, "mode 3": 3278.0},
)
SWEEP = Study(
    id="study.stroke",
    kind="sweep",
    title="Deflection over the stroke, 1000 N along z",
    x_label="x (m)",
    y_label="deflection along z",
    unit="µm",
    x=(0.145, 0.32, 0.4975, 0.67, 0.85),
    series={
        "vjm": (26.1, 26.6, 27.2, 27.4, 27.6),
        "segments": (26.2, 26.7, 27.3, 27.5, 27.7),
        "beam": (26.3, 26.8, 27.4, 27.6, 27.8),
        "solid": (25.9, 26.3, 26.9, 27.1, 27.2),
    },
)
FINDING = Finding(
    where="foot.compliance",
    check="definiteness",
    printed="3.16e-09",
    wrong="the matrix is indefinite",
    evidence="smallest eigenvalue −3.5e-08",
    used="3.16e-07",
    kind="computed",
    severity="error",
)


def sample_report(**changes):
    agreeing = judge(
        case("legs.agrees", title="Agrees easily"),
        Measurement(1.001e-8, 1.0e-8, 1e-12, 2e-12, studies=(CONVERGENCE, SWEEP)),
        0.8,
    )
    tight = judge(case("legs.tight", title="Agrees barely"), Measurement(1.0095e-8, 1.0e-8), 0.1)
    disagreeing = judge(
        case(
            "robot.beam-vjm.planar[x=0.4975]",
            title="Planar deflection at the centre under fx, beam against VJM",
            quantity="planar deflection",
            unit="µm",
            tolerance=Absolute(0.05),
            section="The robot over its stroke",
        ),
        Measurement(
            8.97,
            8.81,
            allowances=(Allowance("shear deformation", 0.02, "physics of the beam"),),
            notes=("A note.",),
            table={"x (m)": (0.145, 0.4975), "planar (µm)": (0.42, 8.81)},
        ),
        2.0,
    )
    bound = judge(
        case(
            "paper.deflection-bound",
            title="Simplified deflections stay below 1.1 µm",
            unit="µm",
            relation=Relation.AT_MOST,
            tolerance=Absolute(0.05),
            section="The paper's statements",
        ),
        Measurement(1.063, 1.1),
        0.01,
    )
    failed = Outcome(case("legs.failed"), "failed", 0.2, message="leg 2: matrix is <singular>")
    skipped = Outcome(case("legs.skipped"), "skipped", 0.0, message="CalculiX is not installed")
    fields = {
        "outcomes": (bound, agreeing, tight, failed, skipped, disagreeing),
        "figures": (
            study_plot(CONVERGENCE),
            study_plot(SWEEP),
            Figure(
                "fig5", "Fig. 5", "Made up.", "The paper's statements", png=PIXEL, data="x\n1\n"
            ),
        ),
        "findings": (FINDING,),
        "provenance": {
            "robot": "IFW demonstrator",
            "robot_file": "ifw",
            "robot_sha256": "ab" * 32,
            "suite_sha256": "cd" * 32,
            "preset": "standard",
            "options": {},
            "started": "2026-01-02T03:04:05+00:00",
            "seconds": 75.2,
            "machine": "Linux x86_64, 2 cores",
            "versions": {"python": "3.11.7", "numpy": "2.4.6"},
        },
        "missing_figures": (
            Drawn(Drawing("fig7", "Fig. 7, mode shapes", never), 0.0, message="no OpenGL"),
        ),
    }
    return Report(**(fields | changes))


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
    assert {"verdict", "foremost", "studies", "audit", "provenance"} <= set(page.ids)


def test_the_page_needs_nothing_else(markup):
    page = Page(markup)
    assert all(link.startswith(("#", "data:")) for link in page.links)
    assert all(source.startswith("data:image/") for source in page.sources)
    references = set(re.findall(r"url\(([^)]*)\)", markup))
    assert all(reference.startswith(("#", "data:")) for reference in references)
    assert "<script" not in markup
    assert "@import" not in markup


def test_the_verdict_stands_at_the_top_in_one_sentence(markup):
    sentence = "3 of 5 comparisons agree, 1 disagree, 1 failed, 1 skipped."
    assert markup.index(sentence, markup.index("<body>")) < markup.index("<table")


def test_the_worst_comparisons_come_first():
    order = [outcome.case.id for outcome in sample_report().foremost]
    assert order == [
        "robot.beam-vjm.planar[x=0.4975]",
        "legs.failed",
        "legs.tight",
        "legs.agrees",
        "paper.deflection-bound",
    ]


def test_every_case_shows_its_source_tolerance_reason_and_function(markup):
    cases = len(sample_report().outcomes)
    for shown in ("Timoshenko &amp; Gere, Table 1", "shear is in both models", ".never</code>"):
        assert markup.count(shown) >= cases
    assert "matrix is &lt;singular&gt;" in markup
    assert "shear deformation" in markup
    assert "CalculiX is not installed" in markup


def test_the_data_of_a_figure_is_in_the_page(markup):
    links = re.findall(
        r'download="([^"]+)" href="data:text/csv;charset=utf-8;base64,([^"]+)"', markup
    )
    data = {name: base64.b64decode(content).decode() for name, content in links}
    assert data["fig5.csv"] == "x\n1\n"
    assert data["study.stroke.csv"].splitlines()[1] == "0.145,26.1,26.2,26.3,25.9"


def test_findings_and_provenance_are_shown(markup):
    for shown in ("the matrix is indefinite", "3.16e-07", "ab" * 32, "numpy 2.4.6", "no OpenGL"):
        assert shown in markup


def test_an_empty_and_an_interrupted_run_have_a_page():
    empty = sample_report(outcomes=(), figures=(), findings=(), missing_figures=())
    assert "No comparison was made." in render(empty)
    part = sample_report(unfinished=4)
    assert "4 not computed" in render(part)
    assert sample_report(outcomes=(), unfinished=1).verdict == "failed"


def test_a_study_shared_by_several_cases_is_shown_once():
    outcomes = [
        judge(case(f"legs.{n}"), Measurement(1.0, 1.0, studies=(CONVERGENCE,)), 0.1) for n in "ab"
    ]
    report = sample_report(outcomes=tuple(outcomes), figures=(study_plot(CONVERGENCE),))
    assert report.studies == (CONVERGENCE,)
    page = Page(render(report))
    assert len(page.ids) == len(set(page.ids))


def test_curves_that_are_errors_tend_to_zero():
    errors = Study(
        id="study.errors",
        kind="convergence",
        title="Errors",
        x_label="elements",
        y_label="relative error",
        unit="1",
        x=(5.0, 10.0, 20.0, 40.0),
        series={"half": (0.04, 0.01, 0.0025, 0.000625)},
        orders={"half": 2.0},
        limits={"half": 0.0},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert study_plot(errors).svg


def test_a_value_that_is_no_number_is_shown_as_such():
    outcome = judge(case(), Measurement(nan, 1.0), 0.1)
    assert "not a number" in render(sample_report(outcomes=(outcome,)))


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (1.06e-6, "1.06\u00a0×\u00a010⁻⁶"),
        (-2.5e12, "−2.5\u00a0×\u00a010¹²"),
        (-123456.0, "−123460"),
        (0.4975, "0.4975"),
        (186.81234, "186.81"),
        (0.0, "0"),
        (None, "–"),
        ("centre", "centre"),
        (float("inf"), "∞"),
    ],
)
def test_numbers_are_written_as_in_print(value, shown):
    assert text.number(value) == shown


def test_plots_of_one_page_have_ids_of_their_own():
    first, second = study_plot(CONVERGENCE), study_plot(SWEEP)
    ids = [set(re.findall(r'id="([^"]+)"', text.inline_svg(f))) for f in (first, second)]
    assert not ids[0] & ids[1]
    inlined = text.inline_svg(first)
    used = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', inlined))
    assert {a or b for a, b in used} <= ids[0]


def test_equal_studies_give_equal_files():
    assert study_plot(CONVERGENCE).svg == study_plot(CONVERGENCE).svg


def test_a_plot_has_neither_date_nor_machine():
    with plot_style():
        picture, (axes,) = canvas()
        axes.plot([0.0, 1.0], [1.0, 2.0])
        svg = svg_of(picture)
    assert svg.startswith("<svg")
    assert "<dc:date>" not in svg


def test_csv_keeps_every_digit():
    assert csv_of({"x": (0.1,), "f (Hz)": (1.0 / 3.0,)}) == "x,f (Hz)\n0.1,0.3333333333333333\n"
