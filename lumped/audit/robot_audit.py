"""The audit of a robot file: what its data say about themselves, as printed and as used."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from lumped.audit.data_checks import data_findings
from lumped.audit.finding import Finding, parts
from lumped.robot_file import RobotFile, as_printed
from lumped.robot_file.evidence import Correction


def audit(robot_file: RobotFile) -> tuple[Finding, ...]:
    """All findings, on the data as printed and on the data as used.

    A finding that the file's corrections remove tells the correction as `used`; one that stays
    tells "as printed" where the file corrects its source elsewhere, else "as given".
    """
    used = _data_audit(robot_file.tables)
    printed = _data_audit(as_printed(robot_file))
    findings = [
        replace(finding, used=_used(finding, robot_file.corrections, remains=key in used))
        for key, finding in printed.items()
    ]
    findings += [finding for key, finding in used.items() if key not in printed]
    return tuple(findings)


def _data_audit(tables: Mapping[str, Any]) -> dict[tuple[str, str], Finding]:
    findings = (finding for part in parts(tables) for finding in data_findings(part))
    return {(finding.where, finding.check): finding for finding in findings}


def _used(finding: Finding, corrections: Iterable[Correction], *, remains: bool) -> str:
    if remains:
        return "as printed" if corrections else "as given"
    return "; ".join(
        f"{c.key} = {c.used:g} in place of {c.printed:g}: {c.reason}"
        for c in corrections
        if c.key == finding.where or c.key.startswith(f"{finding.where}[")
    )
