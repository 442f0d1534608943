"""Tables of agreement on the page of a run, read back and compared with its results.json.

The reader of the tests shares no code with the page. It finds cells by row and column of the markup
and recomputes every number from the values of results.json.
"""

import json
import re
from html.parser import HTMLParser

import pytest
from support.robots.single_arm import ONE_ARM

from validation.cli import main

ROWS = {"VJM": "vjm", "Links": "links", "Segments (20)": "segments", "Beam FE (20)": "beam"}
CAUSES = ("held end faces", "section constants by formula", "distortion of the section")
# Sizes of prefixed units, by the unit of the case.
PREFIXES = {"": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}
UNITS = {"m/N": "m/N", "rad/(N m)": "rad/(N\N{NO-BREAK SPACE}m)", "Hz": "Hz"}
MARKS = {"✓": "agree", "✗": "disagree", "?": "undecided", "!": "failed"}
NUMBER = r"[+−]?\d+\.\d\d"


class Tables(HTMLParser):
    """Parser that collects the `tables` of agreement of a page: rows of texts of cells."""

    def __init__(self):
        super().__init__()
        self.tables, self.inside, self.cell = [], False, False

    def handle_starttag(self, tag, attrs):
        if tag == "table" and "agreement" in (dict(attrs).get("class") or "").split():
            self.inside = True
            self.tables.append([])
        elif self.inside and tag == "tr":
            self.tables[-1].append([])
        elif self.inside and tag in {"td", "th"}:
            self.cell = True
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag):
        if tag == "table":
            self.inside = False
        elif tag in {"td", "th"}:
            self.cell = False

    def handle_data(self, data):
        if self.inside and self.cell:
            self.tables[-1][-1][-1] += data


def misread(page, document):
    """Places where the tables of the page differ from the numbers of results.json."""
    reader = Tables()
    reader.feed(page)
    cases = {case["id"]: case for case in document["cases"]}
    wrong, cells_read = [], set()
    for (head, *columns), (_, *solid), *rows in reader.tables:
        subject = head.split(" ")[0]
        causes = [dict(zip(columns, cells, strict=True)) for name, *cells in rows if name in CAUSES]
        for name, *cells in rows:
            if name in CAUSES:
                continue
            for column, value, cell in zip(columns, solid, cells, strict=True):
                identifier = f"{subject}.agrees[{ROWS[name]}-solid-{column}]"
                case = cases.get(identifier)
                cells_read.add(identifier)
                if not agrees(case, value, cell, [amounts[column] for amounts in causes]):
                    wrong.append((identifier, value, cell))
    missed = {name for name, case in cases.items() if case["verdict"] != "skipped"} - cells_read
    return wrong, missed


def agrees(case, solid, cell, amounts):
    """True if the texts have the numbers of a case.

    Compared are value of the solid, difference, unexplained rest, half-width, mark and causes.
    """
    if case is None or case["verdict"] == "skipped":
        return cell.strip() == "–"
    value, reference = case["value"], case["reference"]
    number, unit = solid.split(" ")
    size = PREFIXES[unit.removesuffix(UNITS[case["unit"]])]
    percent = rf"({NUMBER})\N{{NO-BREAK SPACE}}%"
    cell_match = re.search(
        rf"^\s*(?:{percent}→\N{{NO-BREAK SPACE}})?{percent}\N{{NO-BREAK SPACE}}([✓✗?!])"
        rf"\s*(?:± {percent})?\s*$",
        cell,
    )
    if cell_match is None:
        return False
    total, unexplained, mark, half = cell_match.groups()
    allowed = sum(allowance["amount"] for allowance in case["allowances"]) / reference
    expected = [
        (total, (value - reference) / reference),
        (unexplained, (value - reference) / reference - allowed),
        (half, (case["numerical_uncertainty"] or 0.0) / reference),
    ]
    are_equal = [
        abs(share(text) - number) < 5.1e-5 for text, number in expected if text is not None
    ]
    # Amounts are rounded; those below half of the last digit are left out.
    listed = sum(share(text) for text in re.findall(percent, " ".join(amounts)))
    right_causes = (total is None and not listed) or abs(listed - allowed) < 5.1e-5 * len(CAUSES)
    right_solid = abs(float(number) * size / reference - 1.0) < 6e-4
    return all(are_equal) and right_causes and right_solid and MARKS[mark] == case["verdict"]


def share(text):
    return float(text.replace("−", "-")) / 100.0


@pytest.fixture(scope="module")
def run_of(tmp_path_factory):
    """Page and results of a run on a single arm with rigid end faces."""
    folder = tmp_path_factory.mktemp("agreement")
    robot, out = folder / "arm.toml", folder / "out"
    text = ONE_ARM.replace("nu = 0.0", "nu = 0.3").replace(
        'to = "P"\n', 'to = "P"\nends = "rigid"\n'
    )
    robot.write_text(f"{text}[path]\nposes = [[0.0]]\n", "utf-8")
    main(["run", str(robot), "--preset", "quick", "--only", "*.agrees*", "--out", str(out)])
    document = json.loads((out / "results.json").read_text("utf-8"))
    return (out / "report.html").read_text("utf-8"), document


def test_page_shows_numbers_of_results(run_of):
    """All cells of the tables of agreement."""
    page, document = run_of
    assert any(case["verdict"] == "agree" for case in document["cases"])
    assert misread(page, document) == ([], set())


def spoilt(document, change):
    return {**document, "cases": [change(case) for case in document["cases"]]}


# Mistakes of a page, as the numbers that it would show instead.
MISTAKES = {
    "ratio for percent": lambda c: {"value": c["reference"] * (1 + 100 * rel(c))},
    "sign": lambda c: {"value": c["reference"] * (1 - rel(c))},
    "relative to the model": lambda c: {"reference": c["value"], "value": c["reference"]},
    "allowances left out": lambda _: {"allowances": []},
    "verdict": lambda _: {"verdict": "disagree"},
}


def rel(case):
    return case["value"] / case["reference"] - 1.0


@pytest.mark.parametrize("mistake", MISTAKES)
def test_wrong_number_on_page_is_detected(run_of, mistake):
    """Each kind of number in results.json is changed; the reader of the page finds it."""
    page, document = run_of

    def change(case):
        if case["verdict"] == "skipped":
            return case
        return {**case, **MISTAKES[mistake](case)}

    assert misread(page, spoilt(document, change))[0]


def test_exchanged_columns_are_detected(run_of):
    """Each case is given the numbers of the next or previous one, as if columns were exchanged."""
    page, document = run_of
    measured = [case for case in document["cases"] if case["verdict"] != "skipped"]
    numbers = ("value", "reference", "allowances", "numerical_uncertainty")
    for shift in (1, -1):
        shifted = {
            case["id"]: {key: measured[(k + shift) % len(measured)][key] for key in numbers}
            for k, case in enumerate(measured)
        }
        other = spoilt(document, lambda case: {**case, **shifted.get(case["id"], {})})  # noqa: B023
        assert misread(page, other)[0]
