"""The first screen from a made-up matrix: the sentence by rules, the table, sheets, the figure."""

import csv
import io
import re
from dataclasses import replace

import numpy as np
import pytest
from matrix_sample import POSES, UNKNOWN, entry, sample_matrix, undecided
from report_sample import sample_report

from validation.adequacy.matrix import Coordinate, ModelNote
from validation.drawing.text import number
from validation.exhibits import Figure
from validation.report.figures.adequacy import error_figure
from validation.report.first_screen.remedies import remedies_of
from validation.report.first_screen.screen import first_screen
from validation.report.first_screen.sentence import sentence
from validation.report.first_screen.table import csv_of_matrix, table_of
from validation.report.page import render

NO_BREAK = "\u00a0"


def plain(text):
    return text.replace(NO_BREAK, " ")


def said_of(*entries):
    models = tuple(dict.fromkeys(one.model for one in entries))
    notes = tuple(ModelNote(model, model) for model in models)
    count = max((len(one.errors) for one in entries), default=0)
    poses = tuple((x,) for x in np.linspace(0.145, 0.85, count)) if count > 3 else POSES
    return plain(sentence(sample_matrix(models=notes, entries=entries, poses=poses)))


def flat(model, quantity, size, **fields):
    return entry(model, quantity, (size,) * len(POSES), **fields)


THEORIES = ("", "-euler-bernoulli")
ORDER = flat("beam", "order", -0.3, value=160.2, expected=244.1)
OFF = {"verdict": "inadequate", "value": None}
ACROSS = {"verdict": "inadequate"}
# Along x, rigid at both ends of the stroke and too soft between them.
CHANGING = (-1.0, -0.059, 0.53, 0.86, 0.98, 0.90, 0.59, 0.009, -1.0)
OVER_THE_PATH = {"pose": (0.145,), "spreads": (0.0,) * len(CHANGING)}


def test_the_sentence_says_what_holds_what_is_off_and_what_could_not_be_judged():
    assert plain(sentence(sample_matrix())) == (
        "VJM with the legs as given holds for deflections within 0.2 %; VJM on equivalent legs, "
        "segments and beams are 13 to 17 % too stiff; the simplified model is 6.7 to 8.3 times "
        "too stiff, does not move along x at x = 0.85 m and knows no motion along z; frequencies "
        f"cannot be judged: {UNKNOWN}."
    )


@pytest.mark.parametrize(
    ("entries", "expected"),
    [
        ([flat("beam", "x", 0.01)], "Beams hold for deflections within 1.1 %."),
        # Below a thousandth it simply holds.
        (
            [flat("simplified", "x", 8e-4, uncertainty=1e-4)],
            "The simplified model holds for deflections.",
        ),
        (
            [flat("beam", "x", 0.01), flat("beam", "z", -0.12)],
            "Beams hold along x but are 12 % too stiff along z.",
        ),
        # Twice as soft as the reference: told as a factor.
        ([flat("beam", "phi_x", 2.7)], "Beams are 3.7 times too soft in rotation."),
        (
            [flat("beam", "x", -0.1), flat("beam", "phi_x", -0.8)],
            "Beams are 10 % too stiff (5 times in rotation).",
        ),
        ([flat("beam", "x", -0.1), flat("beam", "phi_x", -0.1)], "Beams are 10 % too stiff."),
        (
            [flat("beam", "f1", 0.0), flat("beam", "f2", -0.27), ORDER],
            "Beams hold f1 but give f2 27 % too low and have the modes in another order (160 Hz "
            "where 244 Hz are due).",
        ),
        (
            [flat("simplified", "f1", 0.0), flat("simplified", "order", 0.0, error=None, **OFF)],
            "The simplified model holds f1 but has the modes in another order.",
        ),
        (
            [flat(m, f"f{n}", 0.01 * n) for m in ("segments", "beam") for n in (6, 7, 8)],
            "Segments and beams give f6 to f8 6 to 8 % too high.",
        ),
        (
            [
                flat(f"{m}{t}", "x", -0.2)
                for m in ("segments", "beam")
                for t in ("", "-euler-bernoulli")
            ],
            "Segments and beams of either theory are 20 % too stiff.",
        ),
        (
            [flat("beam", "x", 0.0), undecided("beam", "z"), flat("vjm", "x", 0.0)],
            "VJM with the legs as given holds for deflections within 0.1 %; "
            "beams hold along x but cannot be judged along z.",
        ),
        (
            [flat("simplified", q, -1.0) for q in ("z", "phi_y")],
            "The simplified model knows neither motion along z nor rotation.",
        ),
        (
            [flat("links", "z", 0.0, error=None, verdict="inadequate")],
            "Links move along z where the robot is rigid.",
        ),
        # Errors along the load over the path, of which one pose alone was told.
        (
            [entry("simplified", "x", CHANGING, **OVER_THE_PATH)],
            "The simplified model is from 100 % too stiff (x = 0.145, 0.85 m) to 98 % too soft "
            "(x = 0.4975 m) along x.",
        ),
        # What is off is the coupling: along the force next to nothing is.
        (
            [flat("beam", "x", -0.035, **{**ACROSS, "error": 0.148})],
            "Beams are 15 % off under a force along x (up to 3.5 % too stiff along it).",
        ),
        (
            [flat("beam", q, 0.001, **{**ACROSS, "error": 0.2}) for q in ("phi_x", "phi_z")],
            "Beams are 20 % off under moments about x and z (next to nothing about them).",
        ),
        (
            [flat("beam", "x", 0.01), flat("beam", "any_force", 0.12)],
            "Beams hold along x but are 12 % off under the worst direction of force.",
        ),
        # It is worse than the worst axis, or it is not told.
        (
            [flat("beam", "x", -0.2), flat("beam", "any_force", 0.21)],
            "Beams are 20 % too stiff.",
        ),
        (
            [flat("beam", "f2", 0.0, error=None, errors=(None,), verdict="inadequate")],
            "Beams lack the modes of f2.",
        ),
        # A coupling that was measured.
        (
            [flat("beam", "leg1.c26", -8.1)],
            "Beams give leg1.c26 the other sign.",
        ),
        ([], "No model could be judged."),
    ],
)
def test_every_rule_of_the_sentence(entries, expected):
    assert said_of(*entries) == expected


def on_its_legs(*entries):
    """A matrix whose models are 15 % too stiff, and what they are on solids of their own legs."""
    models = tuple(ModelNote(model, model) for model in dict.fromkeys(e.model for e in entries))
    total = [flat(one.model, one.quantity, -0.15) for one in entries]
    own = sample_matrix(models=models, entries=entries, notes=())
    return sample_matrix(models=models, entries=tuple(total), formulation=own)


def test_models_that_fail_by_their_legs_alone_are_told_so_with_a_bound_rounded_up():
    both = [
        flat(m, q, s) for m in ("segments", "beam") for q, s in (("z", 0.0191), ("phi_x", -0.03))
    ]
    assert plain(sentence(on_its_legs(*both))) == (
        "Segments and beams are 15 % too stiff; all models on equivalent legs are within 2.1 % "
        "(3.1 % in rotation) of solids of the same equivalent legs: the formulation holds, the "
        "idealisation of the legs does not."
    )


def test_a_model_that_is_off_on_its_own_legs_too_is_not_excused():
    one = plain(sentence(on_its_legs(flat("segments", "z", 0.01), flat("beam", "z", 0.2))))
    assert "; segments are within 1.1 % of solids of the same equivalent legs" in one
    assert "within" not in plain(sentence(on_its_legs(flat("beam", "z", 0.2))))


def test_what_verdicts_on_frequencies_suppose_stands_behind_them_and_nowhere_else():
    supposed = "for every plausible distribution of the legs' mass"
    decided = (entry("beam", "f1", (0.3, 0.3, 0.3)),)
    assert sentence(sample_matrix(entries=decided, supposed=supposed)).endswith(f" ({supposed}).")
    assert supposed not in sentence(sample_matrix(supposed=supposed))


def test_a_model_that_does_not_move_in_one_pose_alone_is_stiff_there():
    curve = (-0.8, -0.9, -1.0)
    assert said_of(entry("simplified", "x", curve)) == (
        "The simplified model is 5 to 10 times too stiff and does not move along x at x = 0.85 m."
    )


def test_the_table_has_a_column_for_every_quantity_that_is_spoken_of():
    table = table_of(sample_matrix())
    assert table.headings == ("x", "y", "z", "f1", "f2")
    by_name = {row.name: row for row in table.rows}
    simplified = by_name["The simplified model"].cells
    assert [plain(cell.text) for cell in simplified[:3]] == ["100 %", "87 %", "100 %"]
    assert [cell.mark for cell in simplified] == ["✗", "✗", "✗", "?", "?"]
    assert plain(simplified[1].hint).startswith("inadequate (limit 5 %); worst at x = 0.4975 m")
    assert by_name["VJM with the legs as given"].cells[3:] == (None, None)
    # A thousandth of the reference is worth showing, what rounding leaves is nothing.
    assert plain(simplified[1].spread) == "± 0.1 %"
    small = table_of(sample_matrix(entries=(flat("vjm", "x", 1e-9, uncertainty=1e-9),)))
    cell = next(row.cells[0] for row in small.rows if row.note.model == "vjm")
    assert (plain(cell.text), cell.spread) == ("0 %", "")


def test_pose_and_verdict_are_in_the_csv():
    rows = list(csv.DictReader(io.StringIO(csv_of_matrix(sample_matrix()))))
    assert len(rows) == len(sample_matrix().entries)
    found = next(row for row in rows if (row["model"], row["quantity"]) == ("simplified", "y"))
    assert (found["verdict"], found["x (m)"], found["error"]) == ("inadequate", "0.4975", "0.87")
    assert found["error along the load"] == "-0.87"
    assert found["error with remedy"] == "0.002"
    # Of distinct numbers each stands under its own heading.
    one = replace(
        sample_matrix().entries[0],
        error=-0.1,
        uncertainty=0.02,
        limit=0.05,
        value=9.0,
        expected=10.0,
    )
    (row,) = csv.DictReader(io.StringIO(csv_of_matrix(sample_matrix(entries=(one,)))))
    headings = ("error", "uncertainty", "limit", "value", "reference value")
    assert [row[name] for name in headings] == ["-0.1", "0.02", "0.05", "9.0", "10.0"]


def test_entries_of_the_same_cause_and_remedy_share_a_line():
    lines = remedies_of(sample_matrix())
    assert [(one.models, one.quantities, plain(one.without)) for one in lines] == [
        ("The simplified model", "x, y", "87 to 100 %"),
        ("The simplified model", "z", "100 %"),
        ("VJM on equivalent legs, segments and beams", "x, y, z", "15 to 17 %"),
    ]
    assert (lines[2].remedy, plain(lines[2].with_remedy)) == (
        "take the 6×6 with its couplings",
        "0.1 %",
    )
    assert lines[1].causes == ("it knows no such motion",)


def test_every_number_of_the_matrix_leads_to_its_sheet_with_source_uncertainty_and_function():
    markup = render(sample_report())
    table = markup[markup.index('<table class="adequacy"') :]
    links = re.findall(r'<td class="[a-z]+" title="[^"]+"><a href="#([^"]+)"', table)
    assert len(links) == len(sample_matrix().entries)
    for link in links:
        start = markup.index(f'id="{link}"')
        sheet = markup[start : markup.index("</article>", start)]
        for word in ("Source", "Computed by", "Worst at"):
            assert f"<dt>{word}</dt>" in sheet
        assert "<dt>Uncertainty</dt>" in sheet or UNKNOWN in sheet


def test_the_figure_shows_the_errors_of_every_model_and_an_unfinished_run_waits_for_none():
    figure = error_figure(sample_matrix())
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert [float(row["x (m)"]) for row in rows] == [pose[0] for pose in POSES]
    shown = [float(row["simplified: error of y"]) for row in rows]
    assert shown == [0.86, 0.87, 0.857]
    assert error_figure(sample_matrix(entries=(undecided("beam", "f1"),))) is None
    assert first_screen(sample_matrix(), plotted=False).errors is None


def test_poses_of_several_coordinates_are_drawn_by_their_number():
    poses = ((0.1, 0.5), (0.2, 0.6), (0.3, 0.7))
    matrix = sample_matrix(
        coordinates=(Coordinate("x", "m"), Coordinate("y", "m")),
        poses=poses,
        entries=(flat("links", "x", 0.1, pose=poses[1]),),
        models=(ModelNote("links", "links"),),
    )
    assert error_figure(matrix).svg
    (row,) = table_of(matrix).rows
    assert "worst at x = 0.2 m, y = 0.6 m" in row.cells[0].hint


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
    assert markup.count('<table class="adequacy"') == 4
    links = re.findall(r'<td class="[a-z]+" title="[^"]+"><a href="#([^"]+)"', markup)
    assert len(links) == len(set(links)) == 3 * len(leg.entries) + len(by_gauge)
    assert all(markup.count(f'id="{link}"') == 1 for link in links)
    assert "measured: gauge" in markup
    assert markup.index('id="leg_1-matrix"') > markup.index('id="Its_legs"')
    assert markup.index("against solids of the same legs</h3>") > markup.index('id="leg_1-matrix"')
    assert "measured.values" in {figure.id for figure in report.shown}
    # By itself it is the answer.
    alone = render(sample_report(matrix=None, measured=report.measured))
    assert alone.count('<table class="adequacy"') == 1
    assert "segments are 20" in alone[: alone.index("<main>")]
    assert '<a href="#measured">' in alone
    assert f"<dd>{number(by_gauge[1].value, 6)} m</dd>" in alone
