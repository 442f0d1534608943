"""What is written of a comparison, read back: records, pages, tables, curves' data, JUnit."""

import csv
import io
import re
from collections.abc import Mapping
from xml.etree import ElementTree as ET

import numpy as np

from validation.case import Absolute, Allowance, Case, Measurement, Relation, Relative
from validation.cases.program.judgement.claims import claims, same
from validation.cases.program.judgement.rules import probe
from validation.context import Context
from validation.drawing import text
from validation.exhibits import Study, study_record
from validation.report import tables
from validation.report.listing import outcome_line, summary, tolerance_text
from validation.results.junit import junit_xml
from validation.results.outcome import Outcome, Result, judge
from validation.results.records import case_record, finite

_SOURCE = "every number that is shown, read back as a reader would"
_SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def _sample() -> Outcome:
    measured = Measurement(
        value=3.25,
        reference=3.0,
        value_uncertainty=0.003,
        reference_uncertainty=0.004,
        allowances=(Allowance("shear", 0.26, "by hand"),),
        table={"first": (1.0, 2.0), "second": (3.0, 4.0)},
    )
    return judge(probe(Relative(0.01)), measured, 1.5)


@claims("records", "Records hold what was measured, by name", _SOURCE)
def _records(_context: Context) -> Mapping[str, bool]:
    record = case_record(_sample())
    wanted = {
        "value": 3.25,
        "reference": 3.0,
        "error": 0.25,
        "unexplained": -0.01,
        "value_uncertainty": 0.003,
        "reference_uncertainty": 0.004,
        "numerical_uncertainty": 0.005,
        "tolerance": 0.03,
        "seconds": 1.5,
    }
    return {name: same(getattr(record, name), number, 1e-9) for name, number in wanted.items()} | {
        "verdict": record.verdict == "agree",
        "allowance": same(record.allowances[0]["amount"], 0.26),
        "table": record.table == {"first": (1.0, 2.0), "second": (3.0, 4.0)},
        "all digits": same(finite(1.23456789012345e-7), 1.23456789012345e-7, 1e-15),
        "NaN is none": finite(float("nan")) is None and finite(float("inf")) is None,
    }


@claims("records-random", "So do records of numbers at random", _SOURCE)
def _at_random(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(15)
    claims = {}
    for number in range(60):
        value, reference, part, own, other, judged = rng.uniform(0.5, 2.0, 6).tolist()
        stated = judged if number % 2 else None
        allowances = Allowance("a", part), Allowance("b", 0.1 * part)
        measured = Measurement(value, reference, own, other, stated, allowances)
        record = case_record(judge(probe(Absolute(0.1), Relation.AT_MOST), measured, 0.0))
        claims[f"record {number}"] = (
            same(record.value, value)
            and same(record.reference, reference)
            and same(record.error, value - reference, 1e-9)
            and same(record.unexplained, value - reference - 1.1 * part, 1e-9)
            and same(record.value_uncertainty, own)
            and same(record.reference_uncertainty, other)
            and same(record.numerical_uncertainty, stated or float(np.hypot(own, other)))
            and same(record.tolerance, 0.1)
        )
    return claims


@claims("texts", "Numbers are written as by hand", _SOURCE)
def _texts(_context: Context) -> Mapping[str, bool]:
    written = {
        text.number(0.4975): "0.4975",
        text.number(-2.5): "−2.5",
        text.number(1.0625e-6): "1.0625\u00a0×\u00a010⁻⁶",
        text.number(2.5e7): "2.5\u00a0×\u00a010⁷",
        text.number(123456.0): "123460",
        text.percent(0.013): "+1.3\u00a0%",
        text.percent(-0.715): "−72\u00a0%",
        text.percent(1.2, signed=False): "120\u00a0%",
        text.percent(0.0): "0\u00a0%",
        text.share_text(0.35): "35\u00a0%",
        text.share_text(2.5): "2.5 times",
        text.tolerance(Relative(0.01), "µm"): "±1\u00a0%",
        text.tolerance(Absolute(0.5), "µm"): "±0.5\u00a0µm",
        tolerance_text(Relative(0.02), "µm"): "±2 %",
        tolerance_text(Absolute(0.5), "µm"): "±0.5 µm",
    }
    return {f"{wanted!r} and not {shown!r}": shown == wanted for shown, wanted in written.items()}


def _read(written: str) -> float:
    """The number that a text shows."""
    plain = written.replace("−", "-").replace("+", "").replace("±", "").replace("\u00a0", "")
    plain = re.sub(r"[%a-zµ ]", "", plain)
    mantissa, _, power = plain.partition("×10")
    return float(mantissa) * 10.0 ** int(power.translate(_SUPERSCRIPTS) or 0)


@claims("texts-random", "Numbers at random are read back", _SOURCE)
def _read_back(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(16)
    claims = {}
    for _ in range(60):
        value = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-7.0, 7.0))
        claims[f"{value:.6g}"] = same(_read(text.number(value)), value, 1e-4)
        share = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-5.0, 1.0))
        claims[f"{share:.3g} in %"] = same(_read(text.percent(share)), 100.0 * share, 0.06)
        amount = float(10.0 ** rng.uniform(-4.0, 0.0))
        claims[f"tolerance {amount:.3g}"] = (
            same(_read(text.tolerance(Absolute(amount), "µm")), amount, 6e-3)
            and same(_read(text.tolerance(Relative(amount), "µm")), 100.0 * amount, 6e-3)
            and same(_read(tolerance_text(Relative(amount), "µm")), 100.0 * amount, 6e-3)
        )
        claims[f"share {amount:.3g}"] = same(_read(text.share_text(amount)), 100.0 * amount, 0.06)
    return claims


def _outcome(model: str, quantity: str, value: float, tolerance: float = 0.5) -> Outcome:
    case = probe(Relative(tolerance))
    fields = {"id": f"{model}.{quantity}", "model": model, "quantity": quantity}
    return judge(
        Case(**{**vars(case), **fields}),
        Measurement(value, 2.0, exact=True, allowances=(Allowance("a", 0.25),)),
        0.0,
    )


@claims("tables", "Tables put each number where its heading says", _SOURCE)
def _tables(_context: Context) -> Mapping[str, bool]:
    outcomes = [
        _outcome(model, quantity, value)
        for quantity, start in (("one", 2.0), ("two", 2.4))
        for model, value in (("vjm", start), ("beam", start + 0.1), ("solid", start + 0.2))
    ]
    (grid,), rest = tables.grids(outcomes)
    cells = {
        (row.quantity, heading): cell.measurement.value
        for row in grid.rows
        for heading, cell in zip(grid.headings, row.cells, strict=True)
        if cell is not None and cell.measurement is not None
    }
    wanted = {
        ("one", "virtual joints"): 2.0,
        ("one", "beam FE"): 2.1,
        ("one", "solid FE"): 2.2,
        ("two", "virtual joints"): 2.4,
        ("two", "beam FE"): 2.5,
        ("two", "solid FE"): 2.6,
    }
    largest = tables.largest_unexplained(outcomes)
    return {f"{place}": same(cells.get(place), number) for place, number in wanted.items()} | {
        "nothing is left over": not rest,
        "the row's reference": same(grid.rows[0].reference, 2.0),
        "the largest unexplained": largest is outcomes[5],
        # 2.6 − 2 − 0.25 of 2.
        "its share": same(tables.unexplained_share(outcomes[5]), 0.175, 1e-9),
        "the smallest's share": same(tables.unexplained_share(outcomes[0]), 0.125, 1e-9),
        "a part is explained": tables.explained(
            outcomes[0].measurement or Measurement(0.0, 0.0, exact=True)
        ),
    }


@claims("lines", "Lines, sums and JUnit say the verdicts", _SOURCE)
def _lines(_context: Context) -> Mapping[str, bool]:
    agreed, wrong = _outcome("vjm", "one", 2.25), _outcome("beam", "one", 9.5)
    failed = Outcome(agreed.case, Result(agreed.case.id, "failed", 0.1, "it broke"))
    outcomes = [agreed, wrong, failed]
    written = junit_xml(outcomes, "made up")
    suite = ET.fromstring(written).find("testsuite")  # noqa: S314  our own text
    counts = {} if suite is None else suite.attrib
    line = outcome_line(wrong)
    sentence = summary(outcomes)
    return {
        "one of three agrees": sentence.startswith("1 of 3 comparisons agree"),
        "one disagrees, one failed": "1 disagree" in sentence and "1 failed" in sentence,
        "a line's verdict": line.startswith("disagree"),
        "a line's numbers": "one 9.5 µm, should be 2 µm (tolerance 1 µm)" in line,
        "JUnit's failure": counts.get("failures") == "1",
        "JUnit's error": counts.get("errors") == "1",
        "JUnit's tests": counts.get("tests") == "3",
        "JUnit says which": suite is not None
        and [len(element) for element in suite] == [0, 1, 1]
        and suite[1][0].tag == "failure"
        and "9.5 µm, equal 2 expected" in suite[1][0].attrib["message"],
    }


@claims("curves", "Curves' data belong to their names", _SOURCE)
def _curves(_context: Context) -> Mapping[str, bool]:
    study = Study(
        id="made-up",
        kind="sweep",
        title="made up",
        x_label="x (m)",
        y_label="deflection",
        unit="µm",
        x=(0.1, 0.2, 0.3),
        series={"vjm": (1.0, 2.0, 3.0), "solid": (1.5, 2.5, 3.5)},
        uncertainties={"solid": 0.01},
        limits={"vjm": 4.0},
    )
    # Only who computes the claims waits for the plots' library.
    from validation.drawing.style import csv_of  # noqa: PLC0415
    from validation.report.figures.studies.family_plots import study_plot  # noqa: PLC0415

    rows = list(csv.reader(io.StringIO(study_plot(study).data)))
    columns = dict(zip(rows[0], zip(*rows[1:], strict=True), strict=True))
    plain = csv_of({"a": (1.0, 2.0), "b": (3.0, 4.0)})
    record = study_record(study)
    data = {name: [float(value) for value in values] for name, values in columns.items()}
    of = {model: [v for name, v in data.items() if model in name.lower()] for model in ("solid",)}
    return {
        "x": data.get("x (m)") == [0.1, 0.2, 0.3],
        "solid": of["solid"] == [[1.5, 2.5, 3.5]],
        "the other is the virtual joints": [1.0, 2.0, 3.0] in data.values(),
        "CSV": plain == "a,b\n1.0,3.0\n2.0,4.0\n",
        "record": record["series"] == {"vjm": [1.0, 2.0, 3.0], "solid": [1.5, 2.5, 3.5]},
        "its uncertainty": record["uncertainty"] == {"solid": 0.01},
        "its limit": record["limit"] == {"vjm": 4.0},
        "its x": record["x"] == [0.1, 0.2, 0.3],
    }


@claims("shown-random", "So do tables, lines, curves at random", _SOURCE)
def _shown(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(18)
    values = rng.uniform(1.0, 3.0, (3, 3))
    models = ("vjm", "beam", "solid")
    outcomes = [
        _outcome(model, f"quantity {row}", value, 0.1)
        for row, cells in enumerate(values.tolist())
        for model, value in zip(models, cells, strict=True)
    ]
    (grid,), _ = tables.grids(outcomes)
    cells = [
        [cell.measurement.value for cell in row.cells if cell and cell.measurement]
        for row in grid.rows
    ]
    # 10 % of 2, a quarter explained.
    wrong = np.abs(values.ravel() - 2.25) > 0.2
    shares = [tables.unexplained_share(outcome) for outcome in outcomes]
    suite = ET.fromstring(junit_xml(outcomes, "made up")).find("testsuite")  # noqa: S314
    series = {name: tuple(rng.uniform(0.0, 1.0, 4).tolist()) for name in models}
    study = Study("random", "sweep", "made up", "x", "y", "µm", (1.0, 2.0, 3.0, 4.0), series)
    from validation.drawing.style import csv_of  # noqa: PLC0415
    from validation.report.figures.studies.family_plots import study_plot  # noqa: PLC0415

    written = csv_of({"x": study.x, **series})
    read = list(csv.reader(io.StringIO(written)))
    plotted = list(csv.DictReader(io.StringIO(study_plot(study).data)))
    of_solid = [
        float(value) for row in plotted for name, value in row.items() if "solid" in name.lower()
    ]
    return {
        "cells": cells == values.tolist(),
        "shares": all(
            same(share, abs(value - 2.25) / 2.0, 1e-9)
            for share, value in zip(shares, values.ravel().tolist(), strict=True)
        ),
        "JUnit": suite is not None
        and [element.find("failure") is not None for element in suite] == wrong.tolist(),
        "lines": [outcome_line(outcome).startswith("disagree") for outcome in outcomes]
        == wrong.tolist(),
        "sum": summary(outcomes).startswith(f"{int(np.sum(~wrong))} of 9 comparisons agree"),
        "CSV": all(
            [float(row[1 + place]) for row in read[1:]] == list(series[name])
            for place, name in enumerate(models)
        )
        and read[0] == ["x", *models],
        "plot": of_solid == list(series["solid"]),
        "record": study_record(study)["series"] == {n: list(v) for n, v in series.items()},
    }
