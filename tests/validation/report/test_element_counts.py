"""The sentence on elements per leg, from made-up studies."""

import pytest

from validation.exhibits import Figure
from validation.report.element_counts import element_count_sentence

LABELS = ("rigid segments", "beam elements", "beam elements, Euler–Bernoulli")


def figure(*studies):
    return Figure("convergence", "Convergence", "", "section", svg="<svg></svg>", studies=studies)


def study(needed, errors, theory=("timoshenko", "timoshenko", "euler-bernoulli"), x=(10, 20, 40)):
    """`errors` at 20 of 40 elements and `needed` counts for 1 %, by formulation; limits are 50."""
    at_twenty = [50.0 * (1.0 + error) for error in errors]
    return {
        "x": list(x),
        "stated": 20,
        "series": {
            label: [0.0, value, 0.0] for label, value in zip(LABELS, at_twenty, strict=False)
        },
        "limit": dict.fromkeys(LABELS, 50.0),
        "theory": dict(zip(LABELS, theory, strict=True)),
        "needed": {
            label: {"0.01": count, "0.001": 99} for label, count in zip(LABELS, needed, strict=True)
        },
    }


def test_sentence_has_the_worst_quantity_of_each_formulation():
    """8 of 5 and 8 elements, 0.12 % of +0.05 % and −0.12 %; other theories stay out."""
    text = element_count_sentence(
        [figure(study((5, 2, 60), (5e-4, 1e-6, 0.5)), study((8, 1, 70), (-1.2e-3, -2e-6, 0.5)))]
    ).replace("\N{NO-BREAK SPACE}", " ")
    assert "8 by rigid segments (with 20: 0.12 %); 2 by beam elements (with 20: 0.0002 %)." in text
    assert "Bernoulli" not in text


def test_missed_limit_is_more_than_the_finest_count():
    text = element_count_sentence(
        [figure(study((5, 2, 3), (0, 0, 0)), study((None, 2, 3), (0, 0, 0)))]
    )
    assert "more than 40 by rigid segments" in text
    assert "2 by beam elements" in text


def test_error_is_left_out_without_twenty_elements():
    assert "(with 20" not in element_count_sentence(
        [figure(study((5, 2, 3), (0, 0, 0), x=(10, 30, 40)))]
    )


@pytest.mark.parametrize("figures", [[], [figure({"x": [1], "series": {}})]])
def test_no_study_gives_no_sentence(figures):
    assert element_count_sentence(figures) == ""
