"""The first screen from a made-up matrix: the sentence, the table, sheets, the figure."""

import re
from dataclasses import replace

import pytest
from matrix_sample import POSES, entry, sample_matrix, undecided
from report_sample import sample_report

from validation.adequacy.matrix import ModelNote
from validation.drawing.text import anchor, number
from validation.exhibits import Figure
from validation.report.first_screen import first_screen
from validation.report.page import render
from validation.report.remedies import remedies_of
from validation.report.sections import LEGS
from validation.report.table import table_of
from validation.report.words import sentence

NO_BREAK = "\u00a0"


def plain(text):
    return text.replace(NO_BREAK, " ")


def flat(model, quantity, size, **fields):
    return entry(model, quantity, (size,) * len(POSES), **fields)


def matrix_of(*entries, **fields):
    notes = tuple(ModelNote(model, model) for model in dict.fromkeys(e.model for e in entries))
    return sample_matrix(models=notes, entries=entries, notes=(), **fields)


MIXED = (flat("beam", "x", 0.012), flat("beam", "z", -0.12), undecided("beam", "f1"))


@pytest.mark.parametrize(
    ("rely", "entries", "expected"),
    [
        (
            ["vjm"],
            [flat("vjm", q, 0.01) for q in "xyz"],
            "You rely on vjm: adequate for deflections and rotations (off by at most 1.1 %, you "
            "accept 5 %).",
        ),
        (
            ["beam"],
            MIXED,
            "You rely on beam: adequate for x (off by at most 1.3 %, you accept 5 %), inadequate "
            "for z (off by up to 12 %, you accept 5 %), undecided for f1.",
        ),
        # What is left open of what does not hold says nothing; a motion may be missing.
        (
            ["links"],
            [flat("links", "z", 0.0, error=None, verdict="inadequate")],
            "You rely on links: inadequate for z.",
        ),
        # The simplest model that holds for most, then what it takes for the rest.
        (
            [],
            [
                *(flat(m, q, 0.01) for m in ("vjm", "beam") for q in "xy"),
                flat("vjm", "z", 0.2),
                *(flat("beam", q, 0.01) for q in ("z", "f1")),
                flat("beam", "f2", 0.3),
            ],
            "For your limits use beam (deflections, rotations and f1), solid (f2).",
        ),
        ([], [flat(m, "x", 0.0) for m in ("vjm", "beam")], "For your limits use vjm (x)."),
        ([], MIXED, "For your limits use beam (x), solid (z); undecided: f1."),
        # There is no solid of what was measured; whom nobody judged is not relied on.
        (["vjm"], [flat("beam", "x", 0.3, measured=True)], "No model is adequate for x."),
        ([], [], "No model could be judged."),
    ],
)
def test_the_sentence_answers_what_was_asked(rely, entries, expected):
    assert plain(sentence(matrix_of(*entries), rely)) == expected


def test_what_verdicts_on_frequencies_suppose_stands_behind_them_and_nowhere_else():
    assert plain(sentence(sample_matrix())) == (
        "For your limits use vjm (deflections and rotations); undecided: frequencies."
    )
    supposed = "for every plausible distribution of the legs' mass"
    decided = sample_matrix(entries=(entry("beam", "f1", (0.3, 0.3, 0.3)),), supposed=supposed)
    assert sentence(decided).endswith(f". Frequencies are judged {supposed}.")
    assert supposed not in sentence(sample_matrix(supposed=supposed))
    # Solids of such legs are of other legs: they help nobody.
    assert "solid" not in sentence(decided)


def test_the_table_has_a_column_for_every_quantity_that_is_spoken_of():
    table = table_of(sample_matrix())
    assert table.headings == ("x", "y", "z", "f1", "f2")
    by_name = {row.name: row for row in table.rows}
    assert by_name["VJM with the legs as given"].cells[3:] == (None, None)
    # A thousandth of the reference is worth showing, what rounding leaves is nothing.
    assert plain(by_name["The simplified model"].cells[1].spread) == "± 0.1 %"
    small = table_of(matrix_of(flat("vjm", "x", 1e-9, uncertainty=1e-9)))
    assert [(plain(cell.text), cell.spread) for cell in small.cells] == [("0 %", "")]


def test_the_robots_own_numbers_are_those_of_the_reference():
    """At most 25 nm/N, a quarter too many, are 20 µm under 1000 N; 30 nrad/(N m) 3 µrad."""
    table = table_of(
        matrix_of(
            flat("beam", "x", 0.5, expected=9e-8),
            flat("vjm", "x", 0.25, expected=1e-8, values=(1e-8, 2.5e-8, 2e-8), uncertainty=0.01),
            flat("vjm", "phi_x", 0.0, expected=3e-8, uncertainty=1e-6),
            flat("beam", "f1", -0.2, expected=100.0, uncertainty=0.12),
            flat("beam", "order", 0.2, expected=100.0),
        )
    )
    assert [tuple(map(plain, one)) for one in table.robot] == [
        *(("20 µm", "± 0.8 %"), ("3 µrad", ""), ("100 Hz", "± 10 %"), ("", ""))
    ]


def test_second_theories_and_models_that_lack_motions_are_folded():
    found = table_of(matrix_of(
        *(flat(f"beam{theory}", "x", 0.01) for theory in ("", "-euler-bernoulli")),
        *(flat("simplified", q, size) for q, size in (("x", 0.5), ("z", -1.0))),
        *(flat("links", q, size) for q, size in (("x", 0.01), ("z", -1.0))),
    ))  # fmt: skip
    assert [row.note.model for row in found.rows if row.folded] == [
        *("beam-euler-bernoulli", "simplified")
    ]


def test_entries_of_the_same_cause_and_remedy_share_a_line():
    matrix = sample_matrix()
    lines = remedies_of(matrix, {entry.model for entry in matrix.entries})
    assert [(one.models, one.quantities, plain(one.without)) for one in lines] == [
        ("The simplified model", "x and y", "87 to 100 % too stiff"),
        ("The simplified model", "z", "100 % too stiff"),
        (
            "VJM on equivalent legs, segments and beams",
            "deflections and rotations",
            "15 to 17 % too stiff",
        ),
    ]
    assert (lines[2].remedy, plain(lines[2].with_remedy)) == (
        "take the 6×6 with its couplings",
        "0.1 %",
    )
    assert lines[1].causes == ("it knows no such motion",)
    # A model that is folded in the table has its lines folded, too; an unfinished run no figure.
    screen = first_screen(matrix, plotted=False)
    assert screen.errors is None
    assert first_screen(matrix, plotted=True).errors.svg
    assert (screen.remedies, screen.other_remedies) == (tuple(lines[2:]), tuple(lines[:2]))


def test_legs_and_measured_values_have_tables_and_sheets_of_their_own():
    by_gauge = tuple(
        flat(model, "z", size, measured=True, reference="measured: gauge", unit="m")
        for model, size in (("vjm", 0.01), ("segments", -0.2))
    )
    leg = sample_matrix(robot="leg 1", notes=())
    own = sample_matrix(robot="equivalent legs", notes=())
    figure = Figure("leg1.picture", "A leg", "", "Leg 1", svg="<svg ></svg>")
    report = sample_report(
        matrix=sample_matrix(parts=(leg,), formulation=own),
        measured=sample_matrix(entries=by_gauge, quantities=("z",), notes=()),
        figures=(figure,),
    )
    markup = render(report)
    assert markup.count('<table class="adequacy"') == 8
    links = re.findall(r'<td class="[a-z]+" title="[^"]+"><a href="#([^"]+)"', markup)
    assert len(links) == len(set(links)) == 3 * len(leg.entries) + len(by_gauge)
    assert all(markup.count(f'id="{link}"') == 1 for link in links)
    assert "measured: gauge" in markup
    assert markup.index('id="leg_1-matrix"') > markup.index(f'id="{anchor(LEGS)}"')
    assert markup.index("against solids of the same legs</h3>") > markup.index('id="leg_1-matrix"')
    assert "measured.values" in {figure.id for figure in report.shown}
    # By itself it is the answer.
    alone = render(sample_report(matrix=None, measured=report.results.measured))
    assert alone.count('<table class="adequacy"') == 2
    assert "For your limits use vjm (z)." in alone
    assert '<a href="#measured">' in alone
    assert f"<dd>{number(by_gauge[1].value, 6)} m</dd>" in alone


def test_uncertain_inputs_stand_beside_the_matrix_and_how_sure_a_verdict_is() -> None:
    uncertain = replace(
        entry("beam", "f1", (0.03, 0.03, 0.03)),
        probability=0.97,
        probability_beyond=0.01,
        input_shares={"leg1.material.E": 0.64, "platform.mass": 0.36},
        uncertainties={"inputs": 0.01},
    )
    screen = first_screen(sample_matrix(entries=(uncertain,)), plotted=False)
    (cell,) = screen.table.cells
    assert cell.spread.endswith("97\u00a0%\u00a0sure")
    assert screen.inputs == (
        "leg1.material.E ±0.8\u00a0% (f1 by beams)",
        "platform.mass ±0.6\u00a0% (f1 by beams)",
    )
    assert (
        "Shares of the inputs",
        "leg1.material.E 64\u00a0%, platform.mass 36\u00a0%",
    ) in cell.sheet
    certain = replace(uncertain, probability=1.0)
    (cell,) = first_screen(sample_matrix(entries=(certain,)), plotted=False).table.cells
    assert "sure" not in cell.spread
