"""What is written of a comparison, read back: numbers, lines, the sum, JUnit, curves' data."""

import csv
import io
import re
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from toy_catalogue import agrees, case

from validation.case import Absolute, Measurement, Relative
from validation.drawing import text
from validation.exhibits import Study, study_record
from validation.report.figures.studies import family_of, study_figure
from validation.report.listing import junit_xml, outcome_line, summary
from validation.results.outcome import Outcome, Result, judge

SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
CASE = case("toy", agrees, quantity="deflection", unit="µm", tolerance=Relative(0.1))


def read(written: str) -> float:
    plain = re.sub(r"[+±%a-zµ \u00a0]", "", written.replace("−", "-"))
    mantissa, _, power = plain.partition("×10")
    return float(mantissa) * 10.0 ** int(power.translate(SUPERSCRIPTS) or 0)


def test_numbers_shares_and_tolerances_at_random_are_read_back():
    rng = np.random.default_rng(16)
    for _ in range(60):
        value, share = (
            float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(*powers))
            for powers in ((-7.0, 7.0), (-5.0, 1.0))
        )
        assert read(text.number(value)) == pytest.approx(value, rel=1e-4)
        assert read(text.percent(share)) == pytest.approx(100.0 * share, rel=0.06)
        amount = float(10.0 ** rng.uniform(-4.0, 0.0))
        assert read(text.share_text(amount)) == pytest.approx(100.0 * amount, rel=0.06)
        assert read(text.tolerance(Absolute(amount), "µm")) == pytest.approx(amount, rel=6e-3)
        told = text.tolerance(Relative(amount), "µm")
        assert read(told) == pytest.approx(100.0 * amount, rel=6e-3)


def test_lines_sum_and_junit_say_the_verdicts():
    values = np.random.default_rng(18).uniform(1.5, 2.5, 9).tolist()
    outcomes = [
        judge(replace(CASE, id=f"toy[{n}]"), Measurement(value, 2.0, exact=True), 0.0)
        for n, value in enumerate(values)
    ]
    wrong = [abs(value - 2.0) > 0.2 for value in values]
    assert 0 < sum(wrong) < 9
    assert [outcome_line(one).startswith("disagree") for one in outcomes] == wrong
    failed = Outcome(replace(CASE, id="broken"), Result("broken", "failed", 0.1, "it broke"))
    told = summary([*outcomes, failed])
    assert told.startswith(f"{9 - sum(wrong)} of 10 comparisons agree")
    assert f"{sum(wrong)} disagree" in told
    assert "1 failed" in told
    suite = ET.fromstring(junit_xml([*outcomes, failed], "toys")).find("testsuite")  # noqa: S314
    assert suite is not None
    assert [one.find("failure") is not None for one in suite] == [*wrong, False]
    counts = [suite.attrib[name] for name in ("tests", "failures", "errors")]
    assert counts == ["10", str(sum(wrong)), "1"]
    line = outcome_line(judge(CASE, Measurement(9.5, 2.0, exact=True), 0.0))
    assert "deflection 9.5 µm, should be 2 µm (tolerance 0.2 µm)" in line


def test_data_of_curves_belong_to_their_names():
    series = {"c22": (1.0, 2.0, 3.0), "c33": (1.5, 2.5, 3.5)}
    study = Study(
        id="toy",
        title="toy",
        x_label="elements",
        y_label="compliance",
        unit="m/N",
        x=(1.0, 2.0, 4.0),
        series=series,
        uncertainties={"c33": 0.01},
        limits={"c22": 4.0},
    )
    rows = list(csv.DictReader(io.StringIO(study_figure(family_of([study])).data)))
    columns = {name: tuple(float(row[name]) for row in rows) for name in rows[0]}
    named = {f"{name} (m/N)": values for name, values in series.items()}
    assert columns == {"elements": study.x} | named
    record = study_record(study)
    assert record["series"] == series
    assert (record["uncertainty"], record["limit"]) == ({"c33": 0.01}, {"c22": 4.0})
    assert record["x"] == study.x
