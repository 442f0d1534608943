"""Outcomes as JUnit XML, which CI systems show."""

import re
from collections.abc import Sequence
from xml.etree import ElementTree as ET

from validation.results.outcome import Outcome


def junit_xml(outcomes: Sequence[Outcome], name: str) -> str:
    """One test suite with a test case per outcome.

    "disagree" is a failure, "failed" an error, "skipped" and "undecided" are skipped.
    """
    suite = ET.Element(
        "testsuite",
        name=name,
        tests=str(len(outcomes)),
        failures=str(sum(o.verdict == "disagree" for o in outcomes)),
        errors=str(sum(o.verdict == "failed" for o in outcomes)),
        skipped=str(sum(o.verdict in {"skipped", "undecided"} for o in outcomes)),
        time=f"{sum(o.seconds for o in outcomes):.3f}",
    )
    for outcome in outcomes:
        suite.append(_test_case(outcome))
    root = ET.Element("testsuites")
    root.append(suite)
    ET.indent(root)
    for element in root.iter():
        element.text = _allowed(element.text)
        element.attrib = {name: _allowed(value) or "" for name, value in element.attrib.items()}
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _test_case(outcome: Outcome) -> ET.Element:
    case = outcome.case
    element = ET.Element(
        "testcase",
        classname=f"flexproof.{case.section or 'cases'}",
        name=case.id,
        time=f"{outcome.seconds:.3f}",
    )
    match outcome.verdict:
        case "disagree":
            ET.SubElement(
                element, "failure", message=_comparison(outcome)
            ).text = f"{case.title}\n{case.citation}\n{case.tolerance_reason}\n{outcome.message}"
        case "failed":
            ET.SubElement(element, "error", message=outcome.message).text = case.title
        case "skipped" | "undecided":
            ET.SubElement(element, "skipped", message=outcome.message)
        case "agree":
            pass
    return element


def _comparison(outcome: Outcome) -> str:
    case, measurement = outcome.case, outcome.measurement
    if measurement is None:
        return outcome.message
    return (
        f"{case.quantity}: {measurement.value:.6g} {case.unit}, {case.relation.value} "
        f"{measurement.reference:.6g} expected, tolerance {outcome.tolerance:.3g}"
    )


def _allowed(text: str | None) -> str | None:
    """The text without control characters, which XML cannot carry."""
    return text and re.sub(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", text)
