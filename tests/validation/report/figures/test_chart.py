"""Charts: differences, tables, scales, legends and line styles, compared with hand calculations."""

import csv
import io
from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.pages.report_sample import POSES, entry, sample_matrix

from lumped.acceptance.requirement import MODEL_KINDS
from lumped.robot_file import load_robot
from validation.adequacy.judged_models import JUDGED
from validation.drawing.chart import (
    Bars,
    Chart,
    Panel,
    Series,
    chart_table,
    compared,
    lettered,
    percent,
    power_ticks,
    short_number,
    with_zero,
)
from validation.drawing.plot import drawn_chart
from validation.drawing.style import LOOKS, OTHERS, look_key, marker_positions, plot_style
from validation.models.loads.leg_masses import MASSES
from validation.references.robot_on_path import holding
from validation.report.figures.adequacy import error_curves, measured_curves

X = np.array([0.0, 1.0, 2.0])


def series(label, values, quantity="deflection (µm)", **fields):
    return Series(label, X, np.array(values, dtype=float), quantity, **fields)


def test_differences_are_below_curves():
    """Panels below the curves show differences (%) from the reference curve."""
    turned = [series("a", [4, 4, np.nan], "turn"), series("b", [5, 4, 4], "turn")]
    panel = compared(Panel([series("a", [1, 2, 0]), series("b", [1.1, 1, 3]), *turned]), "a")
    assert compared(panel, "c").below == []
    above, other, below, second_below = drawn_chart(Chart([panel, panel], "x (m)", 2)).axes
    assert [len(axes.get_lines()) for axes in (above, other)] == [4, 4]
    first, second, zero = (line.get_ydata() for line in below.get_lines())
    np.testing.assert_allclose(first, [10.0, -50.0, np.nan], rtol=1e-12)
    np.testing.assert_allclose(second, [25.0, 0.0, np.nan], rtol=1e-12)
    assert set(np.atleast_1d(zero)) == {0.0}
    assert (below.get_ylabel(), second_below.get_ylabel()) == ("difference (%)", "")
    assert (below.get_xlabel(), above.get_xlabel()) == ("x (m)", "")


def test_csv_has_abscissa_and_finite_curves():
    """Curves without a finite value and marks are not in the table."""
    chart = Chart(
        [
            Panel([series("a", [1, 2, 3]), series("b", [np.nan] * 3)], column_prefix="left end"),
            Panel([series("a", [4, 5, 6]), series("mark", [0, 0, 0], quantity="")]),
        ],
        "x (m)",
        table={"x (m)": X.tolist()},
    )
    rows = list(csv.reader(io.StringIO(chart_table(chart))))
    assert rows[0] == ["x (m)", "left end: a: deflection (µm)", "a: deflection (µm)"]
    assert [[float(cell) for cell in row] for row in rows[1:]] == [[0, 1, 4], [1, 2, 5], [2, 3, 6]]


def test_equal_labels_share_a_legend_entry():
    """Curves of equal values are drawn one upon the other, the upper ones thinner."""
    first = Panel([*(series("a", [n, 2, 3]) for n in (1, 2)), series("b", [np.nan] * 3)], "first")
    second_series = [*(series(name, [1, 2, 3]) for name in "ac"), series("d", [1, 1, 1], best=2)]
    picture = drawn_chart(Chart(lettered([first, Panel(second_series, "2nd")]), "x (m)", 2))
    (legend,) = picture.legends
    assert [text.get_text() for text in legend.get_texts()] == ["a", "c", "d"]
    assert [axes.get_title(loc="left") for axes in picture.axes] == ["(a) first", "(b) 2nd"]
    first_lines, second_lines = (axes.get_lines() for axes in picture.axes)
    assert len(first_lines) == 2
    *lines, star = second_lines
    assert [line.get_linewidth() for line in lines] == [3.0, 2.0, 1.0]
    assert (star.get_marker(), star.get_xydata().tolist()) == ("*", [[2.0, 1.0]])


@pytest.mark.parametrize("names", [list(LOOKS), ["a much longer entry " * 3] * 9])
def test_legend_shows_all_entries_above_axes(names):
    """Long entries and many models fit into the picture."""
    labels = [f"{name} {number}" for number, name in enumerate(names)]
    picture = drawn_chart(Chart([Panel([series(name, X) for name in labels])], "x (m)", 1))
    (legend,), (axes,) = picture.legends, picture.axes
    assert [text.get_text() for text in legend.get_texts()] == labels
    box, below = legend.get_window_extent(), axes.get_tightbbox()
    assert box.x0 >= 0.0
    assert box.x1 <= picture.bbox.width
    assert below.y1 <= box.y0 + 2.0  # within the padding of the legend
    assert box.y1 <= picture.bbox.height


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_round_off_of_constant_force_is_not_magnified(sign):
    """An axial force of 500 N that varies by 1e-5 N: its axis begins at zero."""
    force = sign * np.array([500.0, 500.0 - 1e-5, 500.0])
    panel = Panel([series("arm", force, "N (N)")], scale=with_zero)
    (axes,) = drawn_chart(Chart([panel], "phi (rad)", 1)).axes
    low, high = sorted(np.abs(axes.get_ylim()))
    assert (low, high) == (0.0, pytest.approx(500.0, rel=1e-3))


def test_bars_stack_away_from_zero():
    """Negative parts of a difference to the left, positive ones to the right, a point as sum."""
    bars = [Bars("shear", np.array([1.0, -2.0])), Bars("unexplained", np.array([-3.0, -4.0]))]
    point = Series("difference", X[:2], np.array([-2.0, -6.0]), bars=np.array([0.1, 0.2]))
    fields = {"names": ["upper", "lower\nin two lines"], "band": (-1.0, 1.0)}
    lying = Panel([point], bars=bars, lying=True, band_label="tolerance", **fields)
    shares = [np.array([60.0, 3.0]), np.array([40.0, 97.0])]
    standing = Panel(
        bars=[Bars(str(k), heights) for k, heights in enumerate(shares)], names=["f1", "f2"]
    )
    picture = drawn_chart(Chart([lying, standing], "mode", 2))
    rows, columns = picture.axes
    starts_and_widths = [
        (box.get_x(), box.get_width()) for box in rows.patches if box.get_width() != 2.0
    ]
    assert starts_and_widths == [(0.0, 1.0), (0.0, -2.0), (0.0, -3.0), (-2.0, -4.0)]
    points = rows.get_lines()[0]
    assert points.get_xdata().tolist() == [-2.0, -6.0]
    np.testing.assert_allclose(points.get_ydata(), rows.get_yticks())
    upper, lower = rows.transData.transform([(0.0, y) for y in rows.get_yticks()])[:, 1]
    assert upper > lower
    assert [label.get_text() for label in rows.get_yticklabels()] == list(lying.names)
    assert [box.get_y() for box in columns.patches] == [0.0, 0.0, 60.0, 3.0]
    # Shares too small for their number have none.
    assert [text.get_text() for text in columns.texts] == ["60", "", "40", "97"]
    assert [label.get_text() for label in columns.get_xticklabels()] == ["f1", "f2"]
    faces = {box.get_facecolor() for box in (*rows.patches[1:], *columns.patches)}
    assert len(faces) == 4
    legend = [text.get_text() for text in picture.legends[0].get_texts()]
    assert set(legend) == {"shear", "unexplained", "difference", "tolerance", "0", "1"}


def test_percent_axis_has_tick_at_limit():
    """Ticks at 0, ± 1 % and ± 10 %; with a limit of 5 % at 5 %."""
    with plot_style():
        axes, finer = Figure().subplots(1, 2)
        axes.plot([0.0, 1.0], [0.5, -50.0])
        percent(axes)
        finer.plot([0.0, 1.0], [20.0, 0.0])
        percent(finer, limit=5.0, steps=(1.0, 3.0))
    assert sorted(axes.get_yticks()) == [-10.0, -1.0, 0.0, 1.0]
    assert axes.get_ylim() == (-80.0, 1.6)
    assert sorted(finer.get_yticks()) == [-5.0, 0.0, 5.0, 10.0, 30.0]


def test_tick_labels_are_plain_numbers():
    """0.0125, 1250, 1.5 × 10⁵ and 10⁻⁶."""
    expected = {0.0: "0", 0.0125: "0.0125", -1000.0: "-1000", 1250.0: "1250", 150000.0: "1.5 × 10⁵"}
    expected |= {1e-6: "10⁻⁶", 2e-6: "2 × 10⁻⁶", 500.0: "500"}
    assert {value: short_number(value) for value in expected} == expected
    with plot_style():
        picture = Figure()
        axes = picture.subplots()
        axes.set(yscale="log", ylim=(0.8, 7.0))
        power_ticks(axes.yaxis)
        picture.draw_without_rendering()
    ticks = zip(axes.get_yticks(), axes.yaxis.get_ticklabels(), strict=True)
    texts = [label.get_text() for value, label in ticks if 0.8 <= value <= 7.0]
    assert texts == ["1", "2", "5"]


def test_every_line_has_a_marker():
    """Markers of lines in one panel are at different positions."""
    assert [marker_positions(1, rank, 3)[0] for rank in range(3)] == [0, 0, 0]
    assert [marker_positions(2, rank, 4)[0] for rank in range(4)] == [0, 1, 0, 1]
    assert [marker_positions(41, rank, 2) for rank in range(2)] == [(0, 10), (5, 10)]


def test_every_model_has_unique_line_style():
    """Lines differ by marker and dashes even without colours.

    Models shown as single points differ by markers.
    """
    assert set(MODEL_KINDS) | set(JUDGED) <= set(LOOKS)
    looks = [*LOOKS.values(), *OTHERS]
    assert len({(look.marker, look.line) for look in looks}) == len(looks)
    as_points = [LOOKS[name].marker for name in (*MODEL_KINDS, "measured", "solid", "solid, free")]
    assert len(set(as_points)) == len(as_points)


def test_references_have_unique_styles():
    """References: solids, and legs known by a 6×6 and a mass, under each end condition."""
    references = [(f"{condition} as in the robot file",) for condition in ("ends", "interfaces")]
    references += [("ends rigid", "ends free"), ("interfaces rigid", "interfaces averaged")]
    references.append(("ends and interfaces rigid", "ends and interfaces free"))
    curves = [[f"solid, {name}" for name in names] for names in references]
    curves += [[f"{name}, {MASSES[0]}" for name in names] for names in references]
    for labels in (*curves, ["solid", "solid, ends free"]):
        styles = [LOOKS[look_key(name)] for name in labels]
        assert all(a != b for a, b in combinations(styles, 2))
    for robot in ("five-bar", "examples/tapered-biglide/robot.toml"):
        assert tuple(holding(load_robot(robot).mechanism).alternatives) in references


@pytest.mark.parametrize("declare", [error_curves, measured_curves])
def test_panels_and_legend_share_styles(declare):
    """Each curve has the values and the style of its model, although panels lack some models."""
    quantities = {"x": MODEL_KINDS, "y": MODEL_KINDS[2:], "f1": MODEL_KINDS[4::2]}
    errors = np.random.default_rng(1).uniform(-0.3, 0.3, (99, len(POSES))).tolist()
    entries = [
        entry(model, q, *errors.pop()) for q, models in quantities.items() for model in models
    ]
    chart = declare(sample_matrix(quantities=tuple(quantities), entries=entries))
    picture = drawn_chart(chart)
    for axes, panel, models in zip(picture.axes, chart.panels, quantities.values(), strict=False):
        curves = {series.label: series.y for series in panel.series}
        assert set(curves) - {"measured"} == set(models)
        lines = [line for line in axes.lines if line.get_label()[0] != "_"]
        assert {line.get_label(): list(line.get_ydata()) for line in lines} == {
            name: list(values) for name, values in curves.items()
        }
        for line in lines:
            look = LOOKS[line.get_label()]
            assert (line.get_color(), line.get_marker()) == (look.colour, look.marker)
    (legend,) = picture.legends
    for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
        look = LOOKS[text.get_text()]
        assert (handle.get_color(), handle.get_marker()) == (look.colour, look.marker)
        assert handle.get_linestyle().lower() == look.line


def test_names_are_not_drawn_as_math():
    """A dollar sign in the name of a body."""
    with plot_style():
        picture = Figure()
        picture.suptitle("a $\\frac{1$")
        picture.savefig(io.BytesIO(), format="svg")
