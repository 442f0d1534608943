"""Table and sentences on the formulations of each leg, read back and compared with the outcomes.

Outcomes are drawn at random. The tests parse each cell, value of the solid, explanation and
sentence as a reader would. They detect a wrong factor, sign or unit, and the number of another
outcome.
"""

import csv
import io
import re
from base64 import b64decode
from html import unescape

import msgspec
import numpy as np
import pytest
from support.pages.report_sample import measured, redeclared, sample_report, unmeasured

from validation.case import Allowance, Relative
from validation.comparisons.agreement_rows import agreement_rows
from validation.report.agreement import (
    agreement_sentence,
    agreement_tables,
    convergence_sentence,
)
from validation.report.page import render
from validation.studies_and_figures import AGREEMENT

MODELS = {"vjm": "VJM", "links": "Links", "segments": "Segments (20)", "beam": "Beam FE (20)"}
# Names of the formulations in a sentence.
IN_TEXT = {"vjm": "VJM", "links": "links", "segments": "segments", "beam": "Beam FE"}
QUANTITIES = {"x": "m/N", "φz": "rad/(N m)", "f2": "Hz"}
PREFIXES = {"": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}
MARKS = {"agree": "✓", "disagree": "✗", "undecided": "?", "failed": "!", "skipped": "–"}
CAUSES = ("held end faces", "distortion of the section")
TOLERANCE = 0.01
# Shares below a half of the last digit shown, 0.01 %, are not shown.
SHOWN = 5e-5
NUMBER = r"[+−]?\d+\.\d\d"


def drawn_outcomes(seed):
    """Outcomes of two legs: most agree, some are off, uncertain, skipped or failed."""
    draw = np.random.default_rng(seed)
    outcomes = []
    for body in ("leg1", "leg2"):
        for label, unit in QUANTITIES.items():
            reference = float(10.0 ** draw.uniform(-8.0, -5.0) if unit != "Hz" else 120.0)
            for model in MODELS:
                fields = {"kind": "agreement", "model": model, "label": label, "body": body}
                fields |= {"unit": unit, "tolerance": Relative(TOLERANCE)}
                fields |= {"elements": 20 if model in {"segments", "beam"} else 0}
                identifier = f"{body}.{model}.{label}"
                if draw.random() < 0.2:
                    verdict = str(draw.choice(["skipped", "failed"]))
                    lost = unmeasured(identifier, verdict, f"reason {draw.integers(2)}")
                    outcomes.append(redeclared(lost, **fields))
                    continue
                # The sum of all amounts is what value and reference differ by.
                parts = reference * draw.normal(size=len(CAUSES)) * draw.choice([1e-6, 0.02])
                unexplained = reference * float(draw.choice([1e-4, 0.004, 0.03])) * draw.normal()
                half = float(draw.choice([1e-6, 1e-3, 0.015]))
                outcome = measured(
                    identifier,
                    reference + float(parts.sum()) + unexplained,
                    reference,
                    half * reference,
                    exact=False,
                    allowances=tuple(
                        Allowance(cause, float(part))
                        for cause, part in zip(CAUSES, parts, strict=True)
                    ),
                    **fields,
                )
                outcomes.append(outcome)
    return outcomes


DRAWN = [drawn_outcomes(seed) for seed in range(8)]


def shares(text):
    """Numbers before percent signs in a text, divided by 100."""
    percentages = re.findall(rf"({NUMBER})\N{{NO-BREAK SPACE}}%", text)
    return [float(percentage.replace("−", "-")) / 100.0 for percentage in percentages]


def as_printed(share):
    """A share (1 is 100 %) rounded as it is printed, to a hundredth of a percent."""
    return pytest.approx(share, abs=SHOWN * 1.01)


def test_random_outcomes_have_every_verdict():
    """The drawn outcomes of this module contain each verdict, so that each kind of cell is read."""
    assert {outcome.verdict for outcomes in DRAWN for outcome in outcomes} == set(MARKS)


@pytest.mark.parametrize("outcomes", DRAWN)
def test_cells_match_their_comparisons(outcomes):
    """Each cell is at its leg, model and quantity, with the mark of its verdict."""
    by_place = {
        (outcome.case.body, outcome.case.model, outcome.case.label): outcome for outcome in outcomes
    }
    tables = agreement_tables(outcomes)
    assert [table.subject for table in tables] == ["leg1", "leg2"]
    for table in tables:
        assert table.quantities == tuple(QUANTITIES)
        assert [name for name, _ in table.rows] == list(MODELS.values())
        for model, (_, cells) in zip(MODELS, table.rows, strict=True):
            for label, cell in zip(QUANTITIES, cells, strict=True):
                outcome = by_place[table.subject, model, label]
                assert (cell.case, cell.verdict) == (outcome.case.id, outcome.verdict)
                assert cell.mark == MARKS[outcome.verdict]
                assert_cell(cell, outcome)


def assert_cell(cell, outcome):
    measurement = outcome.measurement
    if measurement is None:
        assert (cell.text, cell.raw, cell.spread) == (outcome.message, "", "")
        return
    value, reference = measurement.value, measurement.reference
    explained = [allowance.amount / reference for allowance in measurement.allowances]
    assert shares(cell.text) == [as_printed((value - reference) / reference - sum(explained))]
    has_causes = any(abs(share) >= SHOWN for share in explained)
    assert shares(cell.raw) == ([as_printed((value - reference) / reference)] if has_causes else [])
    half = measurement.value_uncertainty / reference
    assert cell.spread.startswith("± ") is bool(cell.spread)
    assert shares(cell.spread) == ([as_printed(half)] if half >= SHOWN else [])


@pytest.mark.parametrize("outcomes", DRAWN)
def test_solid_values_have_unit_and_prefix(outcomes):
    """Between 1 and 1000 times a prefix, to three digits."""
    for table in agreement_tables(outcomes):
        for label, text in zip(table.quantities, table.solid, strict=True):
            (first, *_) = [
                outcome.measurement.reference
                for outcome in outcomes
                if outcome.case.body == table.subject
                and outcome.case.label == label
                and outcome.measurement
            ]
            digits, printed = text.split(" ")
            unit = QUANTITIES[label].replace(" ", "\N{NO-BREAK SPACE}")
            assert printed.endswith(unit)
            factor = PREFIXES[printed.removesuffix(unit)]
            assert 1.0 <= float(digits) < 1000.0
            assert float(digits) * factor == pytest.approx(first, rel=6e-4)


def test_empty_quantity_has_no_column():
    """A quantity that no model was compared in has no column."""
    outcomes = [
        outcome for outcome in DRAWN[0] if outcome.case.label != "f2" or not outcome.measurement
    ]
    for table in agreement_tables(outcomes):
        assert "f2" not in table.quantities
        assert all(len(cells) == len(table.quantities) for _, cells in table.rows)


@pytest.mark.parametrize("outcomes", DRAWN)
def test_cause_rows_have_every_amount(outcomes):
    """Explained amounts in the rows of causes equal those of the comparisons."""
    for table in agreement_tables(outcomes):
        assert {cause for cause, _ in table.causes} <= set(CAUSES)
        printed = {
            (cause, label): sorted(shares(text))
            for cause, texts in table.causes
            for label, text in zip(table.quantities, texts, strict=True)
        }
        for label in table.quantities:
            compared = [
                outcome
                for outcome in outcomes
                if (outcome.case.body, outcome.case.label) == (table.subject, label)
            ]
            for cause in CAUSES:
                amounts = {
                    round(allowance.amount / outcome.measurement.reference, 4)
                    for outcome in compared
                    if outcome.measurement
                    for allowance in outcome.measurement.allowances
                    if allowance.cause == cause
                    and abs(allowance.amount) >= SHOWN * outcome.measurement.reference
                }
                assert printed.get((cause, label), []) == pytest.approx(sorted(amounts), abs=1e-9)


@pytest.mark.parametrize("outcomes", DRAWN)
def test_explanations_name_quantities(outcomes):
    """Reasons for missing comparisons begin with the quantities that they concern."""
    for table in agreement_tables(outcomes):
        compared = [outcome for outcome in outcomes if outcome.case.body == table.subject]
        reasons = {}
        for outcome in compared:
            if outcome.measurement is None:
                reasons.setdefault(outcome.message, {})[outcome.case.label] = None
        assert table.missing == tuple(
            f"{', '.join(quantities)}: {why}" for why, quantities in reasons.items()
        )
        explanations = {}
        for line in table.explanations:
            labels, _, text = line.partition(": ")
            for label in labels.split(", "):
                explanations.setdefault(label, []).append(text)
        for outcome in compared:
            shares_by_cause = {
                allowance.cause: allowance.amount / outcome.measurement.reference
                for allowance in (outcome.measurement.allowances if outcome.measurement else ())
                if abs(allowance.amount) >= SHOWN * outcome.measurement.reference
            }
            if not shares_by_cause:
                continue
            lines = [
                dict(
                    zip(re.findall(r"([a-z][a-z ]*[a-z]) [+−\d]", text), shares(text), strict=True)
                )
                for text in explanations[outcome.case.label]
            ]
            assert {cause: as_printed(share) for cause, share in shares_by_cause.items()} in lines


@pytest.mark.parametrize("outcomes", DRAWN)
def test_csv_matches_comparisons(outcomes):
    """Each row of the CSV file, recomputed from its comparison."""
    rows = list(csv.DictReader(io.StringIO(agreement_rows(outcomes).csv())))
    assert len(rows) == len(outcomes)
    for row, outcome in zip(rows, outcomes, strict=True):
        label = outcome.case.label.replace("φ", "phi_")
        assert (row["body"], row["model"], row["quantity"]) == (
            outcome.case.body,
            outcome.case.model,
            label,
        )
        assert (row["unit"], row["verdict"]) == (outcome.case.unit, outcome.verdict)
        numbers = list(row.values())[4:11]
        if outcome.measurement is None:
            assert numbers == [""] * 7
            continue
        value, reference = outcome.measurement.value, outcome.measurement.reference
        explained = sum(part.amount for part in outcome.measurement.allowances)
        shares = (value - reference, explained, value - reference - explained)
        half_width = outcome.measurement.value_uncertainty
        percentages = [100.0 * share / reference for share in (*shares, half_width)]
        # Percentages are rounded to six decimals.
        assert list(map(float, numbers)) == pytest.approx(
            [value, reference, *percentages, 100.0 * TOLERANCE], rel=1e-12, abs=5.1e-7
        )


def test_page_has_tables_and_csv_of_comparisons():
    """Cells of the page are those of the tables. The CSV in the page's link is in the folder."""
    outcomes = [redeclared(outcome, section=AGREEMENT, group="bodies") for outcome in DRAWN[0]]
    report = sample_report(outcomes=outcomes)
    markup = render(report)
    pages = re.findall(r'<table class="plain agreement".*?</table>', markup, re.DOTALL)
    for page, table in zip(pages, agreement_tables(outcomes), strict=True):
        (_, *headings), (_, *solid), *rows = (
            [
                re.sub("<[^>]+>", "", unescape(cell)).strip()
                for cell in re.findall(r"<t[dh].*?</t[dh]>", row, re.DOTALL)
            ]
            for row in re.findall("<tr.*?</tr>", page, re.DOTALL)
        )
        assert (tuple(headings), tuple(solid)) == (table.quantities, table.solid)
        models = [[name, *map(cell_text, cells)] for name, cells in table.rows]
        assert rows == [*models, *([cause, *amounts] for cause, amounts in table.causes)]
    encoded = re.search(r'download="cross-validation\.csv" href="data:[^,]*base64,([^"]+)"', markup)
    expected = agreement_rows(outcomes).csv()
    assert b64decode(encoded[1]).decode() == expected
    assert report.tables == {"cross-validation.csv": expected}
    assert sample_report().tables == {}


def cell_text(cell):
    if cell.verdict == "skipped":
        return "–"
    arrow = f"{cell.raw}→\N{NO-BREAK SPACE}" if cell.raw else ""
    return f"{arrow}{cell.text}\N{NO-BREAK SPACE}{cell.mark}{cell.spread}"


def relative(outcome):
    return abs(outcome.measurement.unexplained / outcome.measurement.reference)


def bound(outcome):
    """Unexplained difference plus half-width of a comparison, relative to the reference."""
    measurement = outcome.measurement
    return relative(outcome) + measurement.value_uncertainty / measurement.reference


def assert_worst(sentence, agreed, kind=""):
    """Assert that a sentence has the largest `bound` of the agreeing outcomes, and its place.

    `kind` is the text that names the kind of quantity, or "" for all.
    """
    percent = r"([\d.]+)\N{NO-BREAK SPACE}%"
    parts = rf"(?:: {percent} ± {percent})?"
    pattern = rf"within {percent} \((\w+ of \w+){parts}\){kind}"
    within, quantity, difference, spread = re.search(pattern, sentence).groups()
    worst = max(agreed, key=bound)
    assert float(within) / 100.0 == as_printed(bound(worst))
    assert quantity == f"{worst.case.label} of {worst.case.body}"
    half = bound(worst) - relative(worst)
    assert (float(spread) / 100.0 if spread else 0.0) == as_printed(half if half >= SHOWN else 0.0)
    if spread:
        assert float(difference) / 100.0 == as_printed(relative(worst))


def assert_causes(sentence, agreed):
    """Assert that a sentence has the largest difference and the largest amount of each cause."""
    differences = {
        f"{outcome.case.label} of {outcome.case.body}": abs(outcome.measurement.difference)
        / outcome.measurement.reference
        for outcome in sorted(
            agreed,
            key=lambda outcome: abs(outcome.measurement.difference) / outcome.measurement.reference,
        )
    }
    largest = max(differences, key=differences.get)
    printed = re.search(r"reach ([\d.]+)\N{NO-BREAK SPACE}% \((\w+ of \w+)\)", sentence)
    assert (float(printed[1]) / 100.0, printed[2]) == (as_printed(differences[largest]), largest)
    for cause in CAUSES:
        amounts = {
            f"{outcome.case.label} of {outcome.case.body}": abs(part.amount)
            / outcome.measurement.reference
            for outcome in sorted(
                agreed,
                key=lambda outcome: (
                    abs(outcome.measurement.allowances[CAUSES.index(cause)].amount)
                    / outcome.measurement.reference
                ),
            )
            for part in outcome.measurement.allowances
            if part.cause == cause
        }
        largest = max(amounts, key=amounts.get)
        pattern = rf"{cause} \(up to ([\d.]+)\N{{NO-BREAK SPACE}}% in (\w+ of \w+)\)"
        printed = re.search(pattern, sentence)
        assert (float(printed[1]) / 100.0, printed[2]) == (as_printed(amounts[largest]), largest)


@pytest.mark.parametrize("outcomes", DRAWN)
def test_summary_separates_statics(outcomes):
    """Largest differences of compliances and of frequencies, with the models of each."""
    agreed = [outcome for outcome in outcomes if outcome.verdict == "agree"]
    sentence = agreement_sentence(agreed)
    for kind, outcomes_of_kind in (
        ("compliances", [outcome for outcome in agreed if outcome.case.unit != "Hz"]),
        ("frequencies", [outcome for outcome in agreed if outcome.case.unit == "Hz"]),
    ):
        assert (kind in sentence) is bool(outcomes_of_kind)
        if outcomes_of_kind:
            assert_worst(sentence, outcomes_of_kind, f" in {kind}")
            models = [
                name
                for model, name in IN_TEXT.items()
                if model in {o.case.model for o in outcomes_of_kind}
            ]
            who = " and ".join(filter(None, (", ".join(models[:-1]), models[-1])))
            assert f"{who} within" in sentence or sentence.startswith(
                f"{who[0].upper()}{who[1:]} agree with solid FE of the same legs within"
            )


@pytest.mark.parametrize("outcomes", DRAWN)
def test_summary_counts_decided_cases(outcomes):
    """Numbers of disagreeing, undecided and failed comparisons."""
    decided = [outcome for outcome in outcomes if outcome.verdict in {"agree", "disagree"}]
    sentence = agreement_sentence(outcomes)
    wrong = sum(outcome.verdict == "disagree" for outcome in decided)
    assert wrong
    models = [name for model, name in IN_TEXT.items() if model in {o.case.model for o in decided}]
    who = f"{', '.join(models[:-1])} and {models[-1]}"
    assert f"{wrong} of {len(decided)} comparisons of {who} with solid FE" in sentence
    agreed = [outcome for outcome in decided if outcome.verdict == "agree"]
    assert_worst(sentence, agreed)
    assert_causes(sentence, agreed)
    for verdict in ("undecided", "failed"):
        count = sum(outcome.verdict == verdict for outcome in outcomes)
        assert re.findall(rf"(\d+) {verdict}", sentence) == [str(count)] * bool(count)


@pytest.mark.parametrize("verdict", ["undecided", "failed"])
def test_summary_counts_undecided_cases(verdict):
    """One agreement and one case without a verdict, and one case without a verdict alone."""
    fields = {"kind": "agreement", "model": "beam", "tolerance": Relative(TOLERANCE)}
    good = measured("good", 1.0001, 1.0, **fields)
    start = "Beam FE agree with solid FE of the same legs within 0.01"
    assert agreement_sentence([good]).startswith(start)
    other = msgspec.structs.replace(good, verdict=verdict)
    sentence = agreement_sentence([good, other])
    assert sentence.endswith(f"; other comparisons: 1 {verdict}.")
    assert agreement_sentence([other]) == (
        "No formulation could be compared with solid FE of the same legs; "
        f"comparisons without a verdict: 1 {verdict}."
    )


def test_summary_uses_specified_elements():
    """Errors at the element count of [agree] only."""
    errors = {15: (0.002, 0.007), 0: (0.4,)}
    outcomes = [
        redeclared(outcome, kind="convergence", elements=elements)
        for elements, values in errors.items()
        for outcome in (measured(f"{elements}.{value}", value, 0.01) for value in values)
    ]
    sentence = convergence_sentence(outcomes)
    assert re.findall(r"([\d.]+)\N{NO-BREAK SPACE}%", sentence) == ["0.7"]
    assert sentence.startswith("15 elements:")
