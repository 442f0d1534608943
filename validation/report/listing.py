"""Cases, outcomes and audit findings as lines of text, as JSON, and as JUnit XML.

Input: tasks, outcomes or findings. Output: text for the terminal, and files for CI systems.
"""

import json
import re
from collections.abc import Sequence
from xml.etree import ElementTree as ET

from lumped.audit import Finding
from lumped.mechanism.mechanism import Mechanism
from lumped.text import counted
from validation.case import Absolute, Case, Declaration, Measurement, Tolerance
from validation.drawing.text import tolerance
from validation.kinematics.listing import mobility_text
from validation.record_fields import json_object
from validation.run.outcome import Outcome, Task


def as_text(tasks: Sequence[Task]) -> str:
    """Cases as indented text, one paragraph each."""
    listed = "\n".join(
        f"{case.id}\n"
        f"    {case.title}\n"
        f"    {case.quantity}: {case.relation.value} reference, "
        f"tolerance {tolerance(case.tolerance, case.unit)} ({case.tolerance_reason})\n"
        f"    {case.reference_kind}: {case.citation}\n"
        f"    presets: {', '.join(case.presets)}"
        for case in tasks
        if isinstance(case, Case)
    )
    return listed.replace("\u00a0", " ")


def as_json(tasks: Sequence[Task]) -> str:
    """Cases as a JSON array."""
    return json.dumps(
        [
            {
                **json_object(case, "cases --json"),
                "relation": case.relation.value,
                **_tolerance(case.tolerance),
            }
            for case in tasks
            if isinstance(case, Case)
        ],
        indent=1,
    )


def audit_text(source: str, robot: Mechanism, findings: Sequence[Finding], reachable: int) -> str:
    """Findings of an audit of a robot file as text, after lines on validity, poses and mobility.

    `source`: name of the file. `reachable`: number of poses of the path within reach. Faults of a
    printed source that are corrected are listed separately from remaining doubts.
    """
    remaining = [finding for finding in findings if finding.used in _UNCORRECTED]
    removed = [finding for finding in findings if finding.used not in _UNCORRECTED]
    wrong = sum(finding.severity == "error" for finding in remaining)
    doubts = f"valid, {counted(len(remaining), 'doubt')}"
    state = doubts if remaining else "valid"
    if wrong:
        state = f"readable, but {counted(wrong, 'value is', 'values are')} wrong, see below"
    count = len(robot.poses)
    poses = f"all {count} poses" if count > 1 else "the one pose"
    if reachable < count:
        poses = f"{reachable} of the {count} poses"
    motion = f"{poses} of its path within reach\n{mobility_text(robot)}"
    lines = [f"{source}: {state}; {robot.name}, {motion}"]
    if remaining:
        lines += [
            "",
            f"doubts about the data that are used ({len(remaining)}):",
            *_finding_lines(remaining),
        ]
    if removed:
        heading = "misprints and errors of the printed source, corrected in the data that are used"
        lines += ["", f"{heading} ({len(removed)}):", *_finding_lines(removed)]
    return "\n".join(lines)


_UNCORRECTED = frozenset({"as printed", "as given"})


def _finding_lines(findings: Sequence[Finding]) -> list[str]:
    return [
        line
        for finding in findings
        for line in (
            f"  {finding.where} ({finding.severity}, {finding.check}): {finding.wrong} "
            f"({finding.evidence})",
            f"    {'given' if finding.used == 'as given' else 'printed'}: {finding.printed}",
            f"    used: {finding.used}",
        )
    ]


def outcome_line(outcome: Outcome, *further: Outcome) -> str:
    """Line on an outcome: verdict, id, and numbers or the reason why there are none.

    `further`: outcomes without numbers that have the same verdict and reason. The line gives their
    number: "and 3 more".
    """
    case, measurement = outcome.case, outcome.measurement
    if measurement is None:
        addition = f" and {len(further)} more" if further else ""
        return f"{outcome.verdict:9} {case.id}{addition}: {outcome.message}"
    remark = f"; {outcome.message}" if outcome.message else ""
    return (
        f"{outcome.verdict:9} {case.id}: {_numbers(case, measurement, outcome.tolerance)}{remark}"
    )


def _numbers(case: Declaration, measurement: Measurement, tolerance: float) -> str:
    unit = "" if case.unit == "1" else f" {case.unit}"
    claim = "" if case.relation.value == "equal" else f"{case.relation.value} "
    return (
        f"{case.quantity} {measurement.value:.6g}{unit}, should be {claim}"
        f"{measurement.reference:.6g}{unit} (tolerance {tolerance:.2g}{unit})"
    )


def _tolerance(allowed: Tolerance) -> dict[str, float | str]:
    if isinstance(allowed, Absolute):
        return {"tolerance": allowed.amount, "tolerance_kind": "absolute"}
    return {"tolerance": allowed.fraction, "tolerance_kind": "relative"}


def junit_xml(outcomes: Sequence[Outcome], name: str) -> str:
    """JUnit XML with one test suite and a test case per outcome.

    "disagree" is a failure, "failed" an error; "skipped" and "undecided" are skipped.
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
        element.text = _xml_text(element.text)
        element.attrib = {name: _xml_text(value) or "" for name, value in element.attrib.items()}
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
            measured = outcome.measurement
            numbers = _numbers(case, measured, outcome.tolerance) if measured else outcome.message
            ET.SubElement(
                element, "failure", message=numbers
            ).text = f"{case.title}\n{case.citation}\n{case.tolerance_reason}\n{outcome.message}"
        case "failed":
            ET.SubElement(element, "error", message=outcome.message).text = case.title
        case "skipped" | "undecided":
            ET.SubElement(element, "skipped", message=outcome.message)
        case "agree":
            pass
    return element


def _xml_text(text: str | None) -> str | None:
    """Text with "?" for control characters, which XML does not allow. None if `text` is None."""
    return text and re.sub(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", text)
