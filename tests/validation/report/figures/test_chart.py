"""Declared charts: differences, tables, scales and legends against numbers by hand."""

import csv
import io
from functools import partial

import numpy as np
import pytest

from validation.drawing.chart import (
    Chart,
    Panel,
    Series,
    chart_table,
    compared,
    drawn_chart,
    lettered,
    tapered,
)
from validation.drawing.scales import largest, percent, up_to
from validation.drawing.style import LOOKS, OTHERS, Frame, canvas, marked, plot_style

X = np.array([0.0, 1.0, 2.0])
LOOK = LOOKS["beam"]


def series(label, values, quantity="deflection (µm)", look=LOOK):
    return Series(label, X, np.array(values, dtype=float), look, quantity=quantity)


def test_differences_are_in_percent_of_the_same_quantity():
    panel = compared(
        Panel(
            [
                series("a", [1.0, 2.0, 0.0]),
                series("b", [1.1, 1.0, 3.0]),
                series("a", [4.0, 4.0, np.nan], "rotation (µrad)"),
                series("b", [5.0, 4.0, 4.0], "rotation (µrad)"),
            ]
        ),
        "a",
    )
    first, second = panel.below
    assert [one.label for one in panel.below] == ["b", "b"]
    np.testing.assert_allclose(first.y, [10.0, -50.0, np.nan], rtol=1e-12)
    np.testing.assert_allclose(second.y, [25.0, 0.0, np.nan], rtol=1e-12)
    assert compared(panel, "c").below == []


def test_the_table_has_the_abscissa_and_every_curve_that_has_numbers():
    chart = Chart(
        [
            Panel([series("a", [1, 2, 3]), series("b", [np.nan] * 3)], place="left end"),
            Panel([series("a", [4, 5, 6]), series("mark", [0, 0, 0], quantity="")]),
        ],
        "x (m)",
        abscissa={"x (m)": X.tolist()},
    )
    rows = list(csv.reader(io.StringIO(chart_table(chart))))
    assert rows[0] == ["x (m)", "left end: a: deflection (µm)", "a: deflection (µm)"]
    assert [[float(cell) for cell in row] for row in rows[1:]] == [[0, 1, 4], [1, 2, 5], [2, 3, 6]]


@pytest.mark.parametrize("frame", [None, Frame(left=0.9, between=0.5, entries=1)])
def test_curves_of_one_label_have_one_entry_in_the_legend(frame):
    panels = [
        Panel([series("a", [1, 2, 3]), series("a", [2, 3, 4]), series("b", [np.nan] * 3)], "first"),
        Panel([series("a", [1, 2, 3]), series("c", [1, 1, 1], look=OTHERS[0])], "second"),
    ]
    with plot_style():
        picture = drawn_chart(Chart(lettered(panels), "x (m)", 2, frame=frame, legend_columns=2))
    (legend,) = picture.legends
    assert [text.get_text() for text in legend.get_texts()] == ["a", "c"]
    assert [axes.get_title(loc="left") for axes in picture.axes] == ["(a) first", "(b) second"]
    assert [len(axes.get_lines()) for axes in picture.axes] == [2, 2]


def test_rows_of_differences_stand_below_their_panels():
    panel = compared(Panel([series("a", [1, 2, 4]), series("b", [1, 1, 1])], "one"), "a")
    with plot_style():
        above, other, below, beside = drawn_chart(Chart([panel, panel], "x (m)", 2)).axes
    assert [len(axes.get_lines()) for axes in (above, other)] == [2, 2]
    (drawn, zero) = below.get_lines()
    np.testing.assert_allclose(drawn.get_ydata(), [0.0, -50.0, -75.0], rtol=1e-12)
    assert set(np.atleast_1d(zero.get_ydata())) == {0.0}
    assert (below.get_ylabel(), beside.get_ylabel()) == ("difference (%)", "")
    assert below.get_xlabel() == "x (m)"
    assert above.get_xlabel() == ""


def test_percent_has_ticks_at_the_limit_and_beyond_as_far_as_curves_go():
    with plot_style():
        _, (axes, finer) = canvas(columns=2)
        axes.plot([0.0, 1.0], [0.5, -50.0])
        percent(axes)
        finer.plot([0.0, 1.0], [20.0, 0.0])
        percent(finer, limit=5.0, steps=(1.0, 3.0))
    assert sorted(axes.get_yticks()) == [-10.0, -1.0, 0.0, 1.0]
    assert axes.get_ylim() == (-80.0, 1.6)
    assert sorted(finer.get_yticks()) == [-5.0, 0.0, 5.0, 10.0, 30.0]


def test_a_common_height_is_that_of_the_largest_finite_value():
    assert largest([np.array([1.0, np.inf]), np.array([[3.0, np.nan]])]) == 3.0
    assert largest([np.array([np.nan])]) == 1.0
    with plot_style():
        _, (axes,) = canvas()
        partial(up_to, top=10.0)(axes)
    assert axes.get_ylim() == (0.0, 11.5)


def test_every_line_has_a_marker_even_where_there_are_more_lines_than_points():
    assert [marked(1, rank, 3) for rank in range(3)] == [[0], [0], [0]]
    assert [marked(2, rank, 4) for rank in range(4)] == [[0], [1], [0], [1]]


def test_widths_fall_from_the_bottom_of_a_stack_to_its_top():
    assert [tapered(rank, 3) for rank in range(3)] == [3.0, 2.0, 1.0]
    assert tapered(0, 1) == 3.0
