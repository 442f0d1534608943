"""First screen of the report from a made-up matrix: sentence, table, detail sheets, figure."""

import re
from html import unescape

import numpy as np
import pytest
from msgspec.structs import replace
from support.pages.report_sample import entry, sample_matrix, sample_report

from validation.drawing.text import anchor, number
from validation.report.first_screen import first_screen, remedies_of
from validation.report.page import render
from validation.report.sections import LEGS
from validation.report.table import table_of
from validation.report.words import conditions, models_to_use, sentence
from validation.studies_and_figures import Figure
from validation.verdicts import Cause

pytestmark = pytest.mark.usefixtures("blank_charts")


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def matrix_of(*entries, **fields):
    return sample_matrix(entries=entries, notes=(), **fields)


MIXED = matrix_of(entry("beam", "x", 0.012), entry("beam", "z", -0.12), entry("beam", "f1"))
STATIC = matrix_of(*(entry("vjm", q, 0.01) for q in "xyz"))
# The simplest model that holds for most, then what it takes for the rest.
SEVERAL = matrix_of(
    *(entry(m, q, 0.01) for m in ("vjm", "beam") for q in "xy"),
    *(entry("vjm", "z", 0.2), entry("beam", "z", 0.01)),
    *(entry("beam", "f1", 0.01), entry("beam", "f2", 0.3)),
)
# A hexapod on thin struts had 72 words in five lines, and "off by up to 2130 %" for its order.
STRUTS = matrix_of(
    *(entry("simplified", q, 0.44) for q in "xy"),
    *(entry("simplified", "f1", verdict="inadequate"), entry("simplified", "order", 21.0)),
    *(entry(m, q, 0.002) for m in ("beam", "segments") for q in ("x", "y", "f1", "order")),
)
LOADS = ("load:weight", "load:tug")
# A 3-RRR relied on by links and segments had 47 words in four lines.
LOADED = matrix_of(
    *(entry(m, q, 0.01) for m in ("links", "segments") for q in (*"xyz", *LOADS)),
    *(entry("segments", q, 0.01, limit=0.03) for q in ("f1", "f2", "order")),
    quantities=(*"xyz", *LOADS, "f1", "f2", "order"),
)
# The largest error of a verdict is told, wherever it stands; of adequate ones all that is open.
SPREAD_OUT = matrix_of(
    *(entry("vjm", q, size) for q, size in zip("xyz", (0.01, 0.03, 0.02), strict=True)),
    *(entry("vjm", q, size) for q, size in (("f1", -0.2), ("f2", 0.07), ("phi_x", 0.06))),
    entry("vjm", "order", 0.015, uncertainty=0.02),
    quantities=("x", "y", "z", "phi_x", "f1", "f2", "order"),
)
ALIKE = matrix_of(*(entry(m, "x", 0.0) for m in ("vjm", "beam")))


@pytest.mark.parametrize(
    ("rely", "matrix", "expected"),
    [
        ("vjm", STATIC, "vjm: adequate for deflections and rotations (error at most 1.1 %)"),
        (
            "beam",
            MIXED,
            "beam: adequate for x (error at most 1.3 %), inadequate for z (error up to "
            "12 %), undecided for f1",
        ),
        (
            "simplified beam segments",
            STRUTS,
            "simplified: inadequate for all quantities (error up to 44 %); beam and segments: "
            "adequate for all quantities (error at most 0.3 %)",
        ),
        (
            "links segments",
            LOADED,
            "links: adequate for deflections, rotations and loads (error at most 1.1 %); "
            "segments: adequate for all quantities (error at most 1.1 %)",
        ),
        (
            "vjm",
            SPREAD_OUT,
            "vjm: adequate for x, y, z and the order of modes (error at most 3.1 %), inadequate "
            "for frequencies and φx (error up to 20 %)",
        ),
        # What is left open of what does not hold says nothing; a motion may be missing.
        ("links", matrix_of(entry("links", "z", verdict="inadequate")), "links: inadequate for z"),
        (
            "",
            SEVERAL,
            "Within the accepted errors, use beam (deflections, rotations and f1), solid (f2).",
        ),
        ("", ALIKE, "Within the accepted errors, use vjm (x)."),
        ("", MIXED, "Within the accepted errors, use beam (x), solid (z); undecided: f1."),
        # There is no solid of what was measured; whom nobody judged is not relied on.
        ("none", matrix_of(entry("beam", "x", 0.3, measured=True)), "No model is adequate for x."),
        ("", matrix_of(), "No verdict on any model."),
    ],
)
def test_summary_has_verdicts_on_relied_models(rely, matrix, expected):
    """One sentence: adequate, inadequate and undecided quantities, with the largest error."""
    accepted = "3 % to 5 %" if matrix is LOADED else "5 %"
    if rely.split()[:1] == [expected.partition(":")[0]]:
        expected = f"You rely on {expected}. Accepted error: {accepted}."
    assert plain(sentence(matrix, rely.split())) == expected


@pytest.mark.timeout(60)  # It takes less than a second; a loop that finds no model is endless.
@pytest.mark.parametrize("seed", range(20))
def test_recommended_models_cover_all(seed):
    """Each added model covers most of the remaining quantities. The simplest one wins a tie."""
    draw = np.random.default_rng(seed)
    names = ("simplified", "vjm", "links", "segments", "beam")
    quantities = ("x", "y", "z", "phi_x", "f1", "f2", "order")
    adequate = draw.random((len(names), len(quantities))) < 0.3
    verdicts = np.where(adequate, "adequate", "inadequate")
    matrix = matrix_of(
        *(
            entry(model, quantity, 0.2, verdict=str(verdicts[m, q]))
            for m, model in enumerate(names)
            for q, quantity in enumerate(quantities)
        )
    )
    uncovered, expected = adequate.copy(), []
    while uncovered.any():
        best = int(uncovered.sum(axis=1).argmax())
        expected.append((names[best], {quantities[q] for q in np.flatnonzero(uncovered[best])}))
        uncovered[:, uncovered[best]] = False
    models = models_to_use(matrix)
    assert [
        (model, {quantity.name for quantity in reasons}) for model, reasons in models
    ] == expected


def test_inadequate_models_are_folded():
    """Rows of models without an adequate entry, and of a second beam theory, are folded."""
    theories = [entry(name, "x", 0.01) for name in ("beam", "beam-euler-bernoulli")]
    inadequate = [entry(name, "z", -1.0) for name in ("simplified", "links")]
    useful = [entry("simplified", "x", 0.5), entry("links", "x", 0.01)]
    useful.append(entry("simplified", "order", 0.0))
    rows = table_of(matrix_of(*theories, *inadequate, *useful)).rows
    assert {row.note.model for row in rows if row.folded} == {"beam-euler-bernoulli", "simplified"}
    inadequate = matrix_of(entry("simplified", "z", -1.0, along=-1.0), entry("beam", "z", 0.01))
    theory = matrix_of(entry("beam-euler-bernoulli", "f1", 0.01), entry("beam", "f1", 0.2))
    for matrix, rely, unfolded in (
        (inadequate, (), ["beam"]),
        (inadequate, ("simplified",), ["simplified", "beam"]),
        # A second theory that alone is adequate.
        (theory, (), ["beam-euler-bernoulli", "beam"]),
    ):
        rows = first_screen(matrix, plotted=False, rely=rely).table.rows
        assert [row.note.model for row in rows if not row.folded] == unfolded


def test_frequency_verdicts_state_assumption():
    """Decided verdicts on frequencies hold for every plausible mass distribution of the legs."""
    assert plain(sentence(sample_matrix())) == (
        "Within the accepted errors, use vjm (deflections and rotations); undecided: frequencies."
    )
    supposed = "for every plausible distribution of the legs' mass"
    decided = matrix_of(entry("beam", "f1", 0.3), supposed=supposed)
    assert conditions(decided) == f"Verdicts on frequencies hold {supposed}."
    assert not conditions(sample_matrix(supposed=supposed))
    # Those of the model relied on are open, whatever is decided of another.
    matrix = matrix_of(entry("beam", "f1", 0.3), entry("segments", "f1"), supposed=supposed)
    assert [conditions(matrix, [model]) for model in ("segments", "beam")] == [
        "",
        conditions(decided),
    ]
    assert conditions(decided) in unescape(render(sample_report(matrix=decided, figures=())))
    # Solids of such legs are of other legs: they help nobody.
    assert "solid" not in sentence(decided)


def test_tiny_half_width_is_hidden():
    """Half-widths below 0.05 % are not shown beside the error."""
    small = [1e-9, 4e-4, 6e-4]
    table = table_of(matrix_of(*(entry(f"m{u}", "x", u, uncertainty=u) for u in small)))
    texts = [(plain(cell.text), plain(cell.spread)) for cell in table.cells]
    assert texts == [("0 %", ""), ("0.04 %", ""), ("below 0.12 %", "")]
    # Of readings that disagree on the order the worst is told: "−11 % ± 0.1 %" beside "?" was not.
    (order,) = table_of(matrix_of(entry("beam", "order", -0.11, verdict="undecided"))).cells
    assert (plain(order.text), order.spread) == ("−11 %", "at most")


def test_reference_row_has_reference_values():
    """If a model's 25 nm/N is a quarter too large, the reference deflects by 20 µm at 1000 N.

    Each value is the middle of the reference's interval: 100 Hz between 95 and 115 Hz is shown as
    105 Hz with a half-width of 9.5 %.
    """

    def expected_fields(expected, low, high):
        return {"expected": expected, "expected_range": (low * expected, high * expected)}

    matrix = matrix_of(
        entry("beam", "x", 0.5, expected=9e-8),
        entry("vjm", "x", 0.25, values=(1e-8, 2.5e-8, 2e-8), **expected_fields(1e-8, 0.992, 1.008)),
        entry("vjm", "phi_x", 0.0, **expected_fields(3e-8, 1.0, 1.0)),
        entry("beam", "f1", -0.2, **expected_fields(100.0, 0.95, 1.15)),
        entry("beam", "order", 0.2, expected=100.0),
    )
    assert [tuple(map(plain, cell)) for cell in table_of(matrix).robot] == [
        *(("20 µm", "± 0.8 %"), ("3 µrad", ""), ("105 Hz", "± 9.5 %"), ("", ""))
    ]


def test_equal_remedies_share_a_line():
    """Models and quantities with one remedy, their errors without it, and causes with shares."""
    matrix = sample_matrix()
    *simple, last = lines = remedies_of(matrix, {entry.model for entry in matrix.entries})
    equivalent = "VJM on equivalent legs, segments and beams"
    assert [(line.models, line.quantities, plain(line.without)) for line in lines] == [
        ("The simplified model", "x and y", "87 to 100 % too stiff"),
        ("The simplified model", "z", "100 % too stiff"),
        (equivalent, "deflections and rotations", "15 to 17 % too stiff"),
    ]
    assert last.remedy == "take the 6×6 with its couplings"
    assert plain(last.with_remedy) == "0.1 %"
    assert simple[1].causes == ("it knows no such motion",)
    # What is left of the error has a name, too.
    shares = {"couplings": 0.9, "feet": 0.06, "shear": 0.04}
    beam = entry("beam", "x", 0.2, causes=tuple(Cause(*cause, "") for cause in shares.items()))
    (line,) = remedies_of(matrix_of(beam), ["beam"])
    assert plain("; ".join(line.causes)) == "couplings: 90 %; feet: 6 %; all others: 4 %"
    # A model that is folded in the table has its lines folded, too; an unfinished run no figure.
    screen = first_screen(matrix, plotted=False)
    assert screen.errors is None
    assert first_screen(matrix, plotted=True).errors.svg
    assert (screen.remedies, screen.other_remedies) == ((last,), tuple(simple))


def test_undecided_reasons_name_models():
    """Models of a second theory are folded, and so are the reasons of their verdicts."""
    theory = "beam-euler-bernoulli"
    reasons = {"beam": "say the ends", theory: "needs a finer reference"}
    matrix = matrix_of(
        *(entry(m, q, reason=why, verdict="undecided") for m, why in reasons.items() for q in "xy"),
        entry("beam", "f1", reason="say the ends", verdict="undecided"),
        entry("segments", "f1", reason="say the ends", verdict="undecided"),
    )
    screen = first_screen(matrix, plotted=False, rely=["beam", "segments"])
    assert screen.undecided == {
        "say the ends": "deflections, rotations and f1 by beams and segments"
    }
    assert screen.other_undecided == {
        "needs a finer reference": "deflections and rotations by Euler–Bernoulli beams"
    }


def test_remedy_error_range_is_sorted():
    """Frequencies 8 % too low and 20 % too high, each with a sign."""
    causes = (Cause("shear", 1.0),)
    entries = tuple(
        entry(
            "beam", f"f{k}", error, causes=causes, remedy="use solid", error_with_remedy=remaining
        )
        for k, (error, remaining) in enumerate(
            ((0.2, -0.003), (-0.3, 0.04), (-0.08, -0.02)), start=1
        )
    )
    (line,) = remedies_of(matrix_of(*entries), ["beam"])
    assert plain(line.without) == "−8 to −30 %"
    assert plain(line.with_remedy) == "−0.3 to +4 %"


def test_interacting_causes_have_amounts():
    """Of 20 % too soft, shear is +24 % and the feet are −4 %: shares beyond 100 % mean nothing."""
    causes = (Cause("shear", 1.2), Cause("feet", -0.2), Cause("couplings", 0.0))
    fields = {"causes": causes, "remedy": "use solid"}
    soft = [entry("beam", q, error, **fields) for q, error in (("x", 0.2), ("y", 0.25))]
    (line,) = remedies_of(matrix_of(*soft), ["beam"])
    assert plain(line.without) == "20 to 25 % too soft"
    expected = "shear: +24 to +30 %; feet: −4 to −5 % (they interact)"
    assert plain("; ".join(line.causes)) == expected
    # Errors of opposite sign along the load, and errors mainly across it, are neither.
    for along in (-0.25, 0.1):
        (line,) = remedies_of(matrix_of(soft[0], replace(soft[1], along=along)), ["beam"])
        assert plain(line.without) == "20 to 25 %"


def test_legs_and_measurements_have_tables():
    """Matrices of legs, of formulations and of measured values, with links to their sheets."""
    by_gauge = tuple(
        entry(model, "z", size, measured=True, reference="measured: gauge")
        for model, size in (("vjm", 0.01), ("segments", -0.2))
    )
    leg, formulation = (
        sample_matrix(robot=name, notes=()) for name in ("leg 1", "equivalent legs")
    )
    report = sample_report(
        matrix=sample_matrix(parts=(leg,), formulation=formulation),
        measured=matrix_of(*by_gauge, quantities=("z",), models=leg.models),
        figures=(Figure("leg1.picture", "A leg", "", "Leg 1", svg="<svg ></svg>"),),
    )
    markup = render(report)
    assert markup.count('<table class="adequacy"') == 8
    links = re.findall(r'<td class="[a-z]+" title="[^"]+"><a href="#([^"]+)"', markup)
    assert len(links) == len(set(links)) == 3 * len(leg.entries) + len(by_gauge)
    assert all(markup.count(f'id="{link}"') == 1 for link in links)
    assert "measured: gauge" in markup
    assert markup.index('id="leg_1-matrix"') > markup.index(f'id="{anchor(LEGS)}"')
    assert markup.index("compared with solids of the same legs</h3>") > markup.index(
        'id="leg_1-matrix"'
    )
    assert "measured.values" in {figure.id for figure in report.shown}
    # By itself it is the answer.
    alone = render(sample_report(matrix=None, measured=report.results.measured, figures=()))
    assert alone.count('<table class="adequacy"') == 2
    assert "Within the accepted errors, use vjm (z)." in alone
    assert '<a href="#measured">' in alone
    assert f"<dd>{number(by_gauge[1].value, 6)} m</dd>" in alone


def test_matrix_has_inputs_and_probabilities():
    """The cell has the words "97 % sure", the sheet the inputs with their shares."""
    uncertain = entry(
        *("beam", "f1", 0.03),
        probability=0.97,
        probability_beyond=0.01,
        input_shares={"leg1.material.E": 0.64, "platform.mass": 0.36},
        uncertainties={"inputs": 0.01},
    )
    screen = first_screen(matrix_of(uncertain), plotted=False)
    (cell,) = screen.table.cells
    assert plain(cell.spread).endswith("97 % sure")
    assert [plain(row) for row in screen.inputs] == [
        *("leg1.material.E ±0.8 % (f1 by beams)", "platform.mass ±0.6 % (f1 by beams)")
    ]
    sheet = {word: plain(text) for word, text in cell.sheet}
    assert (
        sheet["Shares of the uncertain inputs in the variance"]
        == "leg1.material.E 64 %, platform.mass 36 %"
    )
    assert sheet["Probability that the error is within the limit"] == "97 %"
    (cell,) = table_of(matrix_of(replace(uncertain, probability=1.0))).cells
    assert "sure" not in cell.spread
