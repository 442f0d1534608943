"""Table of elements per leg, from made-up studies."""

import pytest

from validation.report.element_counts import ElementCount, element_counts
from validation.studies_and_figures import ElementStudy, Figure

LABELS = ("rigid segments", "beam elements", "beam elements, Euler–Bernoulli")
TIMOSHENKO = ("timoshenko", "timoshenko", "euler-bernoulli")


def figure(*studies):
    return Figure("convergence", "Convergence", "", "section", svg="<svg></svg>", studies=studies)


def study(needed, errors, *, body="leg1", quantity="f1", x=(10, 20, 40)):
    """Made-up study: `errors` at 20 elements and counts `needed` for 1 %, one per formulation."""
    at_twenty = [50.0 * (1.0 + error) for error in errors]
    return ElementStudy(
        id=f"convergence.{body}.{quantity}",
        body=body,
        quantity=quantity,
        x=x,
        stated=20,
        series={label: (0.0, value, 0.0) for label, value in zip(LABELS, at_twenty, strict=False)},
        limit=dict.fromkeys(LABELS, 50.0),
        theory=dict(zip(LABELS, TIMOSHENKO, strict=True)),
        needed={
            label: {"0.01": count, "0.001": 99} for label, count in zip(LABELS, needed, strict=True)
        },
    )


def rows(*studies):
    return element_counts([figure(*studies)]).rows


def test_rows_have_worst_quantity():
    """Of 5 and 8 elements the row has 8, of errors +0.05 % and −0.12 % it has 0.12 %.

    Formulations of another beam theory are excluded.
    """
    table = element_counts(
        [
            figure(
                study((5, 2, 60), (5e-4, 1e-6, 0.5)),
                study((8, 1, 70), (-1.2e-3, -2e-6, 0.5), body=None, quantity="f4"),
            )
        ]
    )
    assert table.stated == 20
    segments = ElementCount("rigid segments", "8", "0.12\N{NO-BREAK SPACE}%", "f4 of the robot")
    beams = ElementCount("beam elements", "2", "below 0.001\N{NO-BREAK SPACE}%", "")
    assert table.rows == (segments, beams)


def test_unreached_limit_needs_more_elements():
    """The largest count of the study is 40: "more than 40"."""
    first, second = rows(study((5, 2, 3), (0, 0, 0)), study((None, 2, 3), (0, 0, 0)))
    assert (first.needed, second.needed) == ("more than 40", "2")


def test_smallest_count_is_an_upper_bound():
    """If the smallest computed number of elements suffices, fewer might suffice too."""
    first, second = rows(study((10, 12, 3), (0, 0, 0)))
    assert (first.needed, second.needed) == ("at most 10", "12")
    (row, _) = rows(study((1, 1, 3), (0, 0, 0), x=(1, 20, 40)))
    assert row.needed == "1"


def test_error_is_empty_without_element_count():
    """The study has not computed the specified number of elements."""
    (first, _) = rows(study((5, 2, 3), (0, 0, 0), x=(10, 30, 40)))
    assert (first.error, first.worst) == ("", "")


@pytest.mark.parametrize("figures", [[], [figure()]])
def test_no_study_gives_no_table(figures):
    """A report without convergence studies."""
    assert element_counts(figures) is None
