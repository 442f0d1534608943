"""Texts on a matrix and on comparisons, read back and compared with the numbers.

The tests parse sheets, cells, hints, CSV, curves with their axes, records, lines of the API, the
run's list and JUnit as a reader would. They detect a wrong factor, sign or unit, and the number of
another entry.
"""

import csv
import io
import re
from collections import defaultdict
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from msgspec import to_builtins
from support.pages.report_sample import measured, unmeasured
from support.random.random_subjects import MODES, subject

from lumped.acceptance.quantities import AXIS_LABELS, QuantityKind
from lumped.acceptance.requirement import Requirement
from validation import api
from validation.adequacy.judgement import verdict_matrix
from validation.case import Absolute, Relative
from validation.drawing import text
from validation.drawing.chart import chart_table
from validation.record_fields import plain_data
from validation.report.figures.adequacy import error_curves
from validation.report.first_screen import remedies_of
from validation.report.listing import junit_xml, outcome_line
from validation.report.table import csv_of_matrix, entry_line, table_of
from validation.run.outcome import Result, from_plain
from validation.run.records import stored_entries
from validation.run.results import standing_of
from validation.verdicts import Assessment

LIMITS = {"x": 0.011, "f1": 0.023, "phi_y": 0.37}
MARKS = {"adequate": "✓", "inadequate": "✗", "undecided": "?"}
UNITS = {"x": "m/N", "y": "m/N", "z": "m/N", "any_force": "m/N"}
UNITS |= dict.fromkeys(("phi_x", "phi_y", "phi_z"), "rad/(N m)")
SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
NUMBER = r"[+−]?[\d.]+(?:\s×\s10[⁻⁰-⁹¹²³]+)?"
# Printed digits: two of errors, six of values, four of poses.
TWO, FOUR, SIX = 0.051, 6e-4, 6e-6
# Of errors less than this is no error to anyone.
NOTHING = 5e-5
SUBJECTS = [subject(seed) for seed in (0, 1)]
MATRICES = [
    verdict_matrix(
        random_subject, Requirement(deflection=0.05, frequency=0.05, modes=MODES, limits=LIMITS)
    )
    for random_subject in SUBJECTS
]


def numbers(text):
    """All numbers in a text, also with printed powers of ten; percentages divided by 100."""
    values = []
    for match in re.finditer(rf"({NUMBER})(\s%)?", text):
        mantissa, _, power = re.sub(r"\s", "", match[1]).partition("×10")
        value = float(mantissa.replace("−", "-")) * 10.0 ** int(power.translate(SUPERSCRIPTS) or 0)
        values.append(value / 100.0 if match[2] else value)
    return values


def printed(number, digits=TWO):
    """Expected number in a text, with the tolerance of its printed `digits`."""
    return pytest.approx(number, rel=digits, abs=NOTHING if digits == TWO else 0.0)


def number_or_none(cell):
    return float(cell) if cell else None


def close(value):
    return pytest.approx(value, rel=1e-9) if isinstance(value, float) else value


def pose_of(matrix, text):
    """Index of the pose that a text contains."""
    names = [
        f"{AXIS_LABELS[coordinate.name]} = ({NUMBER}) {coordinate.unit}"
        for coordinate in matrix.coordinates
    ]
    values = numbers(" ".join(re.search(", ".join(names), text).groups()))
    (index,) = (
        p
        for p, pose in enumerate(matrix.poses)
        if values == [printed(value, FOUR) for value in pose]
    )
    return index


def unbroken(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def assert_error_is_printed(entry, text, spread):
    """Assert that texts have an entry's error in the form that the guide prescribes.

    Range over the readings of the file, upper bound, or error with its half-width.
    """
    text, spread = unbroken(text), unbroken(spread)
    ends = sorted(entry.readings.values())
    distance = ends[-1] - ends[0] if ends else 0.0
    half = entry.uncertainty if entry.uncertainty >= 5e-4 else 0.0
    reach = max(-entry.low, entry.high)
    if (
        distance <= entry.uncertainty
        and entry.low <= 0.0 <= entry.high
        and (reach - abs(entry.error) >= 5e-4)
    ):
        assert (text[:6], spread) == ("below ", "")
        assert numbers(text) == [printed(reach)]
        return
    beyond = max(entry.error - entry.low, entry.high - entry.error) - entry.uncertainty
    if beyond >= 5e-4 and (distance < 5e-4 or printed(ends[0]) == ends[-1]):
        assert spread == ""
        ends_shown = numbers(re.sub(r"(?<=\d) to ", " % to ", text))
        assert ends_shown == [printed(entry.low), printed(entry.high)]
        return
    assert numbers(spread) == ([printed(half)] if half else [])
    printed_ends = numbers(re.sub(r"(?<=\d) to ", " % to ", text))
    if len(printed_ends) == 2:
        assert printed_ends == [printed(ends[0]), printed(ends[-1])]
    else:
        assert printed_ends == [printed(entry.error)]
        # Both ends read alike.
        assert distance < 5e-4 or printed(ends[0]) == ends[-1]


def test_printed_numbers_are_read_back():
    """The reader of the tests understands powers of ten, minus signs and per cent."""
    assert numbers("−1.06 × 10⁻⁶ m/N, +12 %, 0 %") == pytest.approx([-1.06e-6, 0.12, 0.0])


@pytest.mark.parametrize("matrix", MATRICES)
def test_cells_and_sheets_match_entries(matrix):
    """Cells of the matrix and their detail sheets have the numbers of the entries."""
    table = table_of(matrix)
    cells = [
        (row.note.model, heading, cell)
        for row in table.rows
        for heading, cell in zip(table.headings, row.cells, strict=True)
        if cell
    ]
    assert len({cell.anchor for cell in table.cells}) == len(cells)
    for entry, (model, heading, cell) in zip(matrix.entries, cells, strict=True):
        assert (model, heading) == (entry.model, entry.quantity.label)
        assert cell.mark == MARKS[entry.verdict]
        # Read back in the test of the API's line.
        assert cell.hint == entry_line(matrix, entry)
        sheet = {word: text for word, text in cell.sheet if word != "Cause"}
        assert matrix.poses[pose_of(matrix, sheet["Pose with the largest error"])] == entry.pose
        assert sheet["Source"] == entry.reference
        if entry.error is None:
            assert cell.text == ("none" if entry.verdict == "inadequate" else "open")
            assert "Error" not in sheet
            continue
        assert_error_is_printed(entry, cell.text, cell.spread)
        assert numbers(sheet["Error"]) == [printed(entry.error), printed(entry.limit)]
        assert ("accepted ± " in sheet["Error"]) is entry.signed
        assert sheet["Error"].startswith("+") == (entry.signed and entry.error >= NOTHING)
        assert numbers(sheet["Range of the error"]) == [printed(entry.low), printed(entry.high)]
        readings = re.findall(
            rf"({NUMBER} %) with (ends [a-z]+)", unbroken(sheet.get("Readings", ""))
        )
        assert {name: numbers(error)[0] for error, name in readings} == {
            name: printed(error) for name, error in entry.readings.items()
        }
        assert numbers(sheet["Uncertainty"])[0] == printed(entry.uncertainty)
        detail = dict(
            re.findall(
                r"([a-z][a-z ]*[a-z]) ([^a-z,)]*\s%)", sheet["Uncertainty"].partition("(")[2]
            )
        )
        assert {name: numbers(size)[0] for name, size in detail.items()} == {
            name: printed(size) for name, size in entry.uncertainties.items()
        }
        unit = UNITS.get(entry.quantity.name, "Hz")
        for word, number in (("Value", entry.value), ("Reference", entry.expected)):
            assert re.search(rf"^{NUMBER} {re.escape(unit)}(, along the load)?$", sheet[word])
            assert numbers(sheet[word])[0] == printed(number, SIX)
        along = [] if entry.along is None else [printed(entry.along)]
        assert numbers(sheet.get("Error of the component along the load", "")) == along
        if entry.quantity.name == "any_force":
            assert numbers(sheet["Force with the largest error"]) == pytest.approx(
                entry.force, rel=TWO, abs=0.006
            )
        causes = [text for word, text in cell.sheet if word == "Cause"]
        assert [(text.partition(":")[0], numbers(text)[0]) for text in causes] == [
            (cause.cause, printed(cause.share)) for cause in entry.causes
        ]
        if entry.remedy:
            assert sheet["Remedy"].startswith(f"{entry.remedy}: ")
            assert numbers(sheet["Remedy"]) == [printed(entry.error_with_remedy)]


@pytest.mark.parametrize("matrix", MATRICES)
def test_csv_lines_match_entries(matrix):
    """Each column of the CSV file of a matrix."""
    rows = list(csv.DictReader(io.StringIO(csv_of_matrix(matrix))))
    assert {"error", "uncertainty", "limit", "value", "error with remedy"} <= rows[0].keys()
    fields = {"error along the load": "along", "reference value": "expected"}
    assert {"low", "high"} <= rows[0].keys()
    for row, entry in zip(rows, matrix.entries, strict=True):
        readings = re.findall(r"(?:^|; )(.*?) (-?[\d.e-]+)(?=;|$)", row.pop("readings"))
        assert {name: float(error) for name, error in readings} == pytest.approx(
            entry.readings, rel=1e-5
        )
        causes = re.findall(r"(?:^|; )(.*?) (-?[\d.e-]+)(?=;|$)", row.pop("causes"))
        assert {cause: float(share) for cause, share in causes} == {
            cause.cause: pytest.approx(cause.share, rel=6e-3) for cause in entry.causes
        }
        force = [float(component) for component in row.pop("worst force").split()]
        assert force == pytest.approx(entry.force, rel=6e-6)
        pose = [float(row.pop(name)) for name in ("x (m)", "phi_z (rad)")]
        assert pose == pytest.approx(entry.pose, rel=1e-9)
        assert row.pop("quantity") == entry.quantity.name
        for name, cell in row.items():
            value = getattr(entry, fields.get(name, name.replace(" ", "_")))
            assert (cell if isinstance(value, str) else number_or_none(cell)) == close(value), name


@pytest.mark.parametrize("matrix", MATRICES)
def test_curves_match_their_tables(matrix):
    """Errors, intervals and limits of the error curves."""
    chart = error_curves(matrix)
    # Two coordinates: the number of the pose, from 1.
    assert chart.x_label == "pose"
    for panel in chart.panels:
        quantity = panel.title.removeprefix("force along ")
        quantity = {"worst direction of force": "any_force"}.get(quantity, quantity)
        entries = [entry for entry in matrix.entries if entry.quantity.name == quantity]
        assert panel.y_label in ("relative error (%)", "")
        limit = 100.0 * entries[0].limit
        # Errors of whole displacements are never negative.
        assert panel.band == (-limit if entries[0].signed else 0.0, limit)
        curves = {series.label: series for series in panel.series}
        for entry in entries:
            if all(error is None for error in entry.errors):
                assert entry.model not in curves
                continue
            series = curves[entry.model]
            # None is NaN.
            errors, lows, highs = (
                100.0 * np.array(values, float)
                for values in (entry.errors, entry.lows, entry.highs)
            )
            down, up = errors - lows, highs - errors
            np.testing.assert_allclose(series.y, errors)
            np.testing.assert_array_equal(series.x, np.arange(1.0, len(matrix.poses) + 1.0))
            if series.bars is None:
                assert np.nanmax([down, up]) <= 0.02 * limit
            else:
                np.testing.assert_allclose(series.bars, [down, up], atol=1e-12)
    rows = list(csv.DictReader(io.StringIO(chart_table(chart))))
    for p, (row, pose) in enumerate(zip(rows, matrix.poses, strict=True)):
        assert (float(row["x (m)"]), float(row["phi_z (rad)"])) == pytest.approx(pose)
        for entry in matrix.entries:
            for column, errors in (
                ("error", entry.errors),
                ("lowest error", entry.lows),
                ("highest error", entry.highs),
            ):
                cell = row[f"{entry.model}: {column} of {entry.quantity}"]
                assert number_or_none(cell) == close(errors[p])


def assert_causes_are_printed(line, entries):
    """Assert that a line has the shares of the two largest causes of the entries' errors.

    If a cause has the opposite sign, each cause has its effect on the error instead.
    """
    interact = any(cause.share < -0.02 for entry in entries for cause in entry.causes)
    amounts, remainders = {}, []
    for entry in entries:
        for cause in entry.causes[:2]:
            if interact:
                amounts.setdefault(cause.cause, []).append(cause.share * entry.error)
            elif cause.share > 0.02:
                amounts.setdefault(cause.cause, []).append(min(cause.share, 1.0))
        remainders.append(sum(cause.share for cause in entry.causes[2:]))
    if not interact and max(remainders) > 0.02:
        amounts["all others"] = remainders
    assert [text.partition(":")[0] for text in line.causes] == list(amounts)
    assert line.causes[-1].endswith(" (they interact)") is interact
    for cause_text, values in zip(line.causes, amounts.values(), strict=True):
        ends = numbers(re.sub(r"(?<=\d) to ", " % to ", cause_text.partition(": ")[2]))
        by_size = sorted(values, key=abs)
        assert [ends[0], ends[-1]] == [printed(by_size[0]), printed(by_size[-1])], cause_text


def assert_sense_is_printed(line, entries):
    """Assert that a line has "too stiff" or "too soft" if errors along the load have one sign."""
    sense = {" too stiff": -1.0, " too soft": 1.0}
    (sign,) = [sign for end, sign in sense.items() if line.without.endswith(end)] or [0.0]
    mostly = [
        entry.along is not None and abs(entry.along) >= 0.8 * entry.error for entry in entries
    ]
    due = not entries[0].signed and all(mostly) and {np.sign(entry.along) for entry in entries}
    assert sign == (next(iter(due)) if due and len(due) == 1 else 0.0)


# Kinds of quantities that one word stands for if all that are judged are meant.
WORDS = {
    "deflections": {QuantityKind.DEFLECTION, QuantityKind.ANY_FORCE},
    "rotations": {QuantityKind.ROTATION},
    "frequencies": {QuantityKind.FREQUENCY},
    "loads": {QuantityKind.LOAD},
    "responses": {QuantityKind.PEAK, QuantityKind.PEAK_FREQUENCY, QuantityKind.SIZE},
}


def counted_quantities(matrix, text):
    """Number of judged quantities that a list of quantities and kinds of quantities stands for."""
    judged = {entry.quantity for entry in matrix.entries}
    return sum(
        sum(quantity.kind in WORDS[word] for quantity in judged) if word in WORDS else 1
        for word in re.split(", | and ", text)
    )


def test_remedy_line_has_range_of_errors():
    """Entries with the same two largest causes and the same remedy share a line."""
    for matrix in MATRICES:
        inadequate = [entry for entry in matrix.entries if entry.verdict == "inadequate"]
        groups = defaultdict(list)
        for entry in inadequate:
            foremost = frozenset(cause.cause for cause in entry.causes[:2])
            reason = "" if foremost else entry.reason
            groups[foremost, entry.remedy, reason, entry.signed].append(entry)
        lines = remedies_of(matrix, {entry.model for entry in inadequate})
        for line, ((foremost, remedy, reason, _), entries) in zip(
            lines, groups.items(), strict=True
        ):
            assert line.remedy == remedy
            assert_sense_is_printed(line, entries)
            if foremost:
                assert_causes_are_printed(line, entries)
            else:
                assert line.causes == (reason,)
            assert counted_quantities(matrix, line.quantities) == len(
                {entry.quantity for entry in entries}
            )
            for printed_range, errors in (
                (line.without, [entry.error for entry in entries]),
                (line.with_remedy, [entry.error_with_remedy for entry in entries]),
            ):
                # "3.1 to 12 %": the percent sign stands for both.
                ends = numbers(re.sub(r"(?<=\d) to ", " % to ", printed_range))
                by_size = sorted((error for error in errors if error is not None), key=abs)
                assert bool(ends) is bool(by_size), printed_range
                if by_size:
                    # One number for all stands for the smallest and for the largest.
                    assert [ends[0], ends[-1]] == [printed(by_size[0]), printed(by_size[-1])], (
                        printed_range
                    )


def test_matrix_record_round_trip_keeps_keys():
    """Keys of entries in results.json are fixed; a stored matrix is read back unchanged."""
    record = to_builtins(stored_entries(MATRICES[0])[0])
    keys = (
        "model quantity verdict error uncertainty low high limit along value expected reference "
        "mac remedy error_with_remedy reason probability force pose readings causes uncertainties "
        "measured probability_beyond input_shares value_spread assumed poses values"
    )
    assert list(record) == keys.split()
    assert {tuple(cause) for cause in record["causes"]} <= {("cause", "share")}
    assessment = Assessment("adequacy", "title", pytest.fail)
    for matrix in MATRICES:
        result = Result("adequacy", "made", 1.0, found=matrix)
        assert from_plain(assessment, plain_data(result)) == result


def test_api_line_matches_record():
    """One line of text per entry, and its record in results.json, have equal numbers."""
    for random_subject, matrix in zip(SUBJECTS, MATRICES, strict=True):
        records = stored_entries(matrix)
        adequacy = api.Adequacy(matrix, Requirement(), random_subject)
        for record, entry in zip(records, matrix.entries, strict=True):
            for name in (
                *("error", "uncertainty", "low", "high", "readings"),
                *("limit", "verdict", "pose", "along", "remedy"),
            ):
                assert getattr(record, name) == getattr(entry, name), name
            line = adequacy.describe(entry)
            assert line.startswith(f"{entry.model}, {entry.quantity}: {entry.verdict}")
            if entry.error is not None:
                error_text, _, accepted = line.partition("; error ")[2].partition(" at ")
                assert numbers(accepted.partition(";")[0])[-1] == printed(entry.limit)
                text, _, spread = error_text.partition(" ±")
                assert_error_is_printed(entry, text, spread)
                assert matrix.poses[pose_of(matrix, line)] == entry.pose
            along = re.search(rf"along the load(?: \(force along .*?\)\))? ({NUMBER} %)", line)
            assert bool(along) is (entry.along is not None)
            if along:
                assert numbers(along[1]) == [printed(entry.along)]
            if entry.causes:
                assert f"cause: {entry.causes[0].cause}" in line
            if entry.remedy:
                assert f"remedy: {entry.remedy}" in line


def test_numbers_and_tolerances_are_formatted():
    """Powers of ten, signs, infinities and dashes; random numbers are read back."""
    written = {1.06e-6: "1.06\u00a0×\u00a010⁻⁶", -123456.0: "−123460", 0.0: "0", None: "–"}
    written |= {"centre": "centre", float("inf"): "∞"}
    assert {value: text.number(value) for value in written} == written
    rng = np.random.default_rng(16)
    for _ in range(60):
        value = float(rng.normal() * 10.0 ** rng.uniform(-7.0, 7.0))
        amount = float(10.0 ** rng.uniform(-4.0, 0.0))
        for formatted, number, digits in (
            (text.number(value), value, 1e-4),
            (text.percent(-amount), -amount, 0.06),
            (text.share_text(amount), amount, 0.06),
            (text.tolerance(Absolute(amount), "µm"), amount, 6e-3),
            (text.tolerance(Relative(amount), "µm"), amount, 6e-3),
        ):
            assert numbers(formatted) == [pytest.approx(number, rel=digits)], formatted


def test_console_and_junit_verdicts_are_equal():
    """Values about 2 ± 10 %, a failed, a skipped and an undecided case."""
    values = (1.6, 2.19, 2.21, 1.79, 1.81, 2.0, 9.5)
    wrong = [True, False, True, True, False, False, True]
    fields = {"quantity": "deflection", "unit": "µm", "tolerance": Relative(0.1)}
    outcomes = [measured(f"toy[{value}]", value, 2.0, **fields) for value in values]
    assert [outcome_line(outcome).startswith("disagree") for outcome in outcomes] == wrong
    line = outcome_line(outcomes[-1])
    assert "deflection 9.5 µm, should be 2 µm (tolerance 0.2 µm)" in line
    outcomes.append(unmeasured("broken", "failed", "it broke"))
    outcomes.append(unmeasured("left out", "skipped", "nothing to compare"))
    outcomes.append(measured("open", 2.1, 2.0, 0.3, exact=False, **fields))
    assert outcomes[-1].verdict == "undecided"
    results = {outcome.id: outcome for outcome in outcomes}
    standing = standing_of([outcome.case for outcome in outcomes], results)
    assert standing.sentence == (
        "3 of 9 comparisons agree, 4 disagree, 1 undecided, 1 failed, 1 skipped."
    )
    suite = ET.fromstring(junit_xml(outcomes, "toys")).find("testsuite")  # noqa: S314
    assert suite is not None
    tags = [[child.tag for child in element] for element in suite]
    assert tags == [
        *(["failure"] * is_wrong for is_wrong in wrong),
        ["error"],
        ["skipped"],
        ["skipped"],
    ]
    for outcome, case in zip(outcomes, suite, strict=True):
        assert (case.attrib["name"], float(case.attrib["time"])) == (
            outcome.case.id,
            pytest.approx(outcome.seconds, abs=5e-4),
        )
        if (failure := case.find("failure")) is not None:
            due = [outcome.measurement.value, outcome.measurement.reference, outcome.tolerance]
            assert numbers(failure.attrib["message"]) == [
                printed(due[0]),
                printed(due[1]),
                printed(due[2]),
            ]
        elif outcome.measurement is None:
            assert case[0].attrib["message"] == outcome.message
    counts = {name: suite.attrib[name] for name in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "10", "failures": "4", "errors": "1", "skipped": "2"}
