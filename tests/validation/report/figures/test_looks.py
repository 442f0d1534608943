"""Looks of curves: every model and reference has its own, in every panel that of the legend."""

import csv
import io
from itertools import combinations

import numpy as np
import pytest
from matrix_sample import POSES, entry, sample_matrix

from lumped.acceptance.requirement import MODEL_KINDS
from lumped.robot_file import load_robot
from validation.adequacy.mechanism.path import holding
from validation.adequacy.models import JUDGED
from validation.drawing.chart import chart_table
from validation.drawing.plot import drawn_chart
from validation.drawing.style import LOOKS, OTHERS, known_as, plot_style
from validation.models.loads.leg_masses import MASSES
from validation.report.figures.adequacy import error_curves, measured_curves

HELD = [
    ("ends as given",),
    ("interfaces as given",),
    ("ends rigid", "ends free"),
    ("interfaces rigid", "interfaces averaged"),
    ("ends and interfaces rigid", "ends and interfaces free"),
]


def test_every_model_has_a_look_that_no_other_curve_has():
    """Told apart without colours, too: by marker and dashes, and points alone by their markers."""
    assert set(MODEL_KINDS) | set(JUDGED) <= set(LOOKS)
    looks = [*LOOKS.values(), *OTHERS]
    assert len({(look.marker, look.line) for look in looks}) == len(looks)
    as_points = [LOOKS[name].marker for name in (*MODEL_KINDS, "measured", "solid", "solid, free")]
    assert len(set(as_points)) == len(as_points)


@pytest.mark.parametrize("names", HELD)
def test_alternatives_of_a_reference_have_looks_of_their_own(names):
    """As solids, and where legs are known by a 6×6 and a mass."""
    for curves in (
        [f"solid, {name}" for name in names],
        [f"{name}, {MASSES[0]}" for name in names],
        ["solid", "solid, ends free"],
    ):
        found = [LOOKS[known_as(name)] for name in curves]
        assert all(a != b for a, b in combinations(found, 2))


@pytest.mark.parametrize("name", ["five-bar", "examples/tapered-biglide/robot.toml"])
def test_names_of_alternatives_are_those_that_are_tested(name):
    assert tuple(holding(load_robot(name).mechanism).alternatives) in HELD


@pytest.mark.parametrize("declare", [error_curves, measured_curves], ids=["errors", "measured"])
def test_panels_legend_and_table_agree_on_every_model(declare):
    """Some models are missing in some panels; each curve is its model's numbers in its look."""
    quantities = {"x": MODEL_KINDS, "y": MODEL_KINDS[2:], "f1": MODEL_KINDS[4::2]}
    generator = np.random.default_rng(1)
    matrix = sample_matrix(
        quantities=tuple(quantities),
        entries=tuple(
            entry(model, quantity, tuple(generator.uniform(-0.3, 0.3, len(POSES))))
            for quantity, models in quantities.items()
            for model in models
        ),
    )
    chart = declare(matrix).chart
    (row, *_) = rows = list(csv.DictReader(io.StringIO(chart_table(chart))))
    with plot_style():
        drawn = drawn_chart(chart)
    for axes in (one for one in drawn.axes if one.axison):
        quantity = axes.get_title("left").removeprefix("force along ")
        lines = {line.get_label(): line for line in axes.lines if line.get_label()[0] != "_"}
        assert set(lines) - {"measured"} == set(quantities[quantity])
        for name, line in lines.items():
            look = LOOKS[name]
            assert (line.get_color(), line.get_marker()) == (look.colour, look.marker)
            if f"{name}: error of {quantity}" in row:
                column = [float(one[f"{name}: error of {quantity}"]) for one in rows]
                np.testing.assert_allclose(line.get_ydata(), 100.0 * np.array(column), rtol=1e-12)
    (legend,) = drawn.legends
    for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
        look = LOOKS[text.get_text()]
        assert (handle.get_color(), handle.get_marker()) == (look.colour, look.marker)
        assert handle.get_linestyle().lower() == look.line
