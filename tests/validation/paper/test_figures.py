"""The paper's figures: what their curves and data say."""

import csv
import io
import pickle

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation import paper
from validation.context import Context
from validation.paper.curves import (
    all_deflections,
    cosine_spaced,
    frequencies_over_the_stroke,
)
from validation.paper.robot import Places


@pytest.fixture(scope="module")
def context():
    return Context(load_robot("ifw"), preset="quick")


def test_stations_reach_both_ends_and_the_centre(context):
    x = cosine_spaced(0.145, 0.85, 21)
    assert (x[0], x[10], x[-1]) == pytest.approx((0.145, 0.4975, 0.85), rel=1e-12)
    assert (np.diff(x) > 0.0).all()
    # Every posture is one of the robot's: none is outside by rounding.
    assert [at.pose[0] for at in Places(context.robot_file.mechanism, x).postures] == pytest.approx(
        x
    )


def rows(data: str) -> list[dict[str, float]]:
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(io.StringIO(data))]


def test_the_data_of_the_simplified_figure_are_those_of_the_paper(context):
    """Fig. 3: below 1.1 µm, zero under a force along x at both ends, 1 µm under one along y."""
    data = rows(all_deflections(context).data)
    along_x = [row["simplified: deflection planar under 1000 N along x (µm)"] for row in data]
    along_y = [row["simplified: deflection planar under 1000 N along y (µm)"] for row in data]
    assert max(along_x + along_y) < 1.1
    assert (along_x[0], along_x[-1]) == pytest.approx((0.0, 0.0), abs=1e-6)
    # 1000 N on one drive of 1e9 N/m.
    assert (along_y[0], along_y[-1]) == pytest.approx((1.0, 1.0), abs=1e-6)


def test_the_printed_release_has_a_curve_of_its_own(context):
    figure = frequencies_over_the_stroke(context)
    centre = rows(figure.data)[10]
    assert centre["x (m)"] == pytest.approx(0.4975)
    # Orientation values of an independent computation: 184 Hz, and about 300 Hz as printed.
    assert centre["beam FE: frequency 2 (Hz)"] == pytest.approx(184.0, rel=0.005)
    assert centre["segments, eq. (25) as printed: frequency 2 (Hz)"] == pytest.approx(
        300.0, rel=0.02
    )
    assert figure.svg.startswith("<svg")


def test_the_figures_can_be_sent_to_another_process():
    found = paper.figures()
    assert len({figure.id for figure in found}) == len(found) == 4
    assert [figure.id for figure in pickle.loads(pickle.dumps(found))] == [  # noqa: S301  our own
        figure.id for figure in found
    ]
