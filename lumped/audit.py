"""Consistency checks on the data of a robot file: as printed in its source, and as corrected.

Each check examines one part of the robot and yields findings with the number that proves them.
Consistent data yield no findings.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.robot_file import RobotFile, as_printed
from lumped.robot_file.mechanism.pattern import written_out
from lumped.robot_file.rules.matrices import asymmetries, is_positive_definite, smallest_eigenvalue
from lumped.robot_file.rules.tables.robots import Correction, length_unit_of

Kind: TypeAlias = Literal["computed", "read"]
Severity: TypeAlias = Literal["error", "warning", "note"]
# Moments of inertia are printed with three to four digits.
_TRIANGLE_ROUNDING = 1e-3
# Ratio |c_ij|/√(c_ii c_jj) below which a coupling term is insignificant. A straight beam has √3/2.
_COUPLING_THRESHOLD = 0.1
# Largest ratio of the tip rotation of a leg to that of a beam. Local compliance at an end adds
# rotation, but not tenfold.
_LARGEST_TIP_ROTATION = 10.0


@dataclass(frozen=True)
class Finding:
    """A fault of printed data or of a printed formula.

    `where` is the key in the robot file or the location in the paper. `check` is the name of the
    check. `printed` is the printed text, `wrong` describes the fault, `evidence` is a sentence with
    the computed `numbers` (SI, by name). `used` describes the value or formula that the models use
    instead, "as given" if it is the printed one. `kind` is "computed" if a computation detects the
    fault, and "read" if only a reader can detect it. `severity` is "error" if results with the data
    would be wrong or impossible, "warning" if the data are doubtful but usable, "note" if no result
    depends on them.
    """

    where: str
    check: str
    printed: str
    wrong: str
    evidence: str
    severity: Severity
    used: str = "as given"
    numbers: Mapping[str, float] = field(default_factory=dict)
    kind: Kind = "computed"


@dataclass(frozen=True)
class DescribedPart:
    """Data of one part of the robot as described in a robot file, SI units.

    `compliance` is 6×6. `inertia` is 3×3 about the mass centre. `length` (m) and `mass_centre` (m
    from the root along x) are those of a leg. A field is None if the file does not contain it.
    """

    name: str
    compliance: Array | None = None
    inertia: Array | None = None
    length: float | None = None
    mass_centre: float | None = None


def parts(tables: Mapping[str, Any]) -> tuple[DescribedPart, ...]:
    """Parts of a robot that are checked, from the tables of its robot file.

    The parts of a biglide are its foot, its legs and its tool. Those of any other mechanism are its
    bodies and joints.
    """
    tables = written_out(tables)
    per_metre = length_unit_of(tables).per_metre
    part_tables = {
        name: tables[name] for name in ("foot", "leg1", "leg2", "tool") if name in tables
    }
    if "bodies" in tables:
        kinds = ("bodies", "joints")
        part_tables = {
            f"{kind}.{name}": table for kind in kinds for name, table in tables[kind].items()
        }
    return tuple(
        DescribedPart(
            name=name,
            compliance=_matrix(table, "compliance"),
            inertia=_matrix(table, "inertia"),
            length=_in_metres(_length(tables, table), per_metre),
            mass_centre=_in_metres(table.get("mass_centre"), per_metre),
        )
        for name, table in part_tables.items()
    )


def _length(tables: Mapping[str, Any], table: Mapping[str, Any]) -> float | None:
    """Length of a leg, in the file's unit of length, from the `table` of a part.

    It is the value of the key `length`, or the distance between the points `from` and `to`. None if
    the part is not a leg.
    """
    if "from" not in table:
        return table.get("length")
    root, tip = (tables["points"][table[end]] for end in ("from", "to"))
    return float(np.linalg.norm(np.subtract(tip, root)))


def _in_metres(length: float | None, per_metre: float) -> float | None:
    return None if length is None else length / per_metre


def _matrix(table: Mapping[str, Any], key: str) -> Array | None:
    return np.array(table[key], dtype=float) if key in table else None


def audit(robot_file: RobotFile) -> tuple[Finding, ...]:
    """All findings on a robot file, both on the data as printed and on the data as corrected.

    If a correction in the file removes a finding on the printed data, the field `used` of the
    finding describes the correction. If the finding remains, `used` is "as printed" in a file that
    corrects other data, and "as given" in a file without corrections.
    """
    findings_used = _data_audit(robot_file.tables)
    findings_printed = _data_audit(as_printed(robot_file))
    findings = [
        replace(finding, used=_used(finding, robot_file.corrections, remains=key in findings_used))
        for key, finding in findings_printed.items()
    ]
    findings += [finding for key, finding in findings_used.items() if key not in findings_printed]
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


def data_findings(part: DescribedPart) -> tuple[Finding, ...]:
    """Findings of all checks on the data of one part of the robot."""
    checks = (
        _symmetry,
        _definiteness,
        _triangle_inequality,
        _slender_axis,
        _couplings,
        _tip_rotation,
        _mass_centre,
    )
    return tuple(finding for check in checks for finding in check(part))


def _symmetry(part: DescribedPart) -> Iterator[Finding]:
    """Check that compliance (Maxwell–Betti) and inertia (by definition) are symmetric."""
    matrices = (("compliance", part.compliance, "SI units"), ("inertia", part.inertia, "kg m²"))
    for key, matrix, unit in matrices:
        for a in () if matrix is None else asymmetries(matrix):
            difference = abs(a.lower - a.upper)
            yield Finding(
                f"{part.name}.{key}",
                "symmetry",
                printed=f"({a.row},{a.column}) = {a.lower:g}, ({a.column},{a.row}) = {a.upper:g}",
                wrong="the matrix is not symmetric",
                evidence=f"the two entries differ by {difference:.3g} {unit}",
                severity="error",
                numbers={"difference": difference},
            )


def _definiteness(part: DescribedPart) -> Iterator[Finding]:
    """Check that the compliance is positive definite, so that every load does positive work."""
    if part.compliance is None or is_positive_definite(part.compliance):
        return
    smallest = smallest_eigenvalue(part.compliance)
    diagonal = ", ".join(f"{entry:.3g}" for entry in np.diag(part.compliance))
    yield Finding(
        f"{part.name}.compliance",
        "definiteness",
        printed=f"diagonal {diagonal} (m/N, rad/(N m))",
        wrong="the compliance matrix is indefinite: some load would do negative work",
        evidence=f"smallest eigenvalue {smallest:.2g} in SI units",
        severity="error",
        numbers={"smallest eigenvalue": smallest},
    )


def _triangle_inequality(part: DescribedPart) -> Iterator[Finding]:
    """Check that no principal moment of inertia exceeds the sum of the other two."""
    if part.inertia is None:
        return
    moments = np.linalg.eigvalsh(0.5 * (part.inertia + part.inertia.T))
    excess = float(moments[2] - moments[0] - moments[1])
    if excess <= _TRIANGLE_ROUNDING * abs(moments[2]):
        return
    moments_text = ", ".join(f"{moment:.3f}" for moment in moments)
    Jxy, Jxz, Jyz = part.inertia[[0, 0, 1], [1, 2, 2]]
    yield Finding(
        f"{part.name}.inertia",
        "triangle inequality",
        printed=f"Jxy = {Jxy:g}, Jxz = {Jxz:g}, Jyz = {Jyz:g} kg m²",
        wrong="no body has this inertia: the largest principal moment exceeds the sum of the "
        "others",
        evidence=f"principal moments {moments_text} kg m²; {excess:.3f} kg m² too much",
        severity="error",
        numbers={f"moment {i + 1}": float(moment) for i, moment in enumerate(moments)},
    )


def _slender_axis(part: DescribedPart) -> Iterator[Finding]:
    """Check that the moment of inertia of a leg is smallest about its longitudinal axis x."""
    if part.inertia is None or part.length is None:
        return
    moments, axes = np.linalg.eigh(0.5 * (part.inertia + part.inertia.T))
    if (axis := int(np.argmax(np.abs(axes[:, 0])))) == 0:
        return
    diagonal = np.diag(part.inertia)
    yield Finding(
        f"{part.name}.inertia",
        "slender axis",
        printed=f"diagonal {', '.join(f'{moment:g}' for moment in diagonal)} kg m²",
        wrong=f"smallest moment of inertia about {'xyz'[axis]}, but x is the leg's direction; "
        "the inertia is probably given in the axes of the drawing",
        evidence=f"smallest principal moment {moments[0]:.3f} kg m² about {'xyz'[axis]}, "
        f"against {diagonal[0]:.3f} kg m² about x",
        severity="warning",
        numbers={"smallest moment": float(moments[0]), "about x": float(diagonal[0])},
    )


def _couplings(part: DescribedPart) -> Iterator[Finding]:
    """Check the signs of the coupling terms c26 (y with φz) and c35 (z with φy).

    Both follow from the lever arm along x between the loaded point and the point at which a force
    causes no rotation: c26 = arm · c66, c35 = −arm · c55. The arms of a leg clamped at its root are
    positive. The two arms of a part without a length, such as a foot, must have the same sign.
    """
    if part.compliance is None or part.name == "tool":
        return
    c = part.compliance
    c26, c35 = float(c[1, 5]), float(c[2, 4])
    significant26 = abs(c26) > _COUPLING_THRESHOLD * np.sqrt(abs(c[1, 1] * c[5, 5]))
    significant35 = abs(c35) > _COUPLING_THRESHOLD * np.sqrt(abs(c[2, 2] * c[4, 4]))
    numbers = {"c26": c26, "c35": c35}
    evidence = f"arms c26/c66 = {c26 / c[5, 5]:.3g} m and −c35/c55 = {-c35 / c[4, 4]:.3g} m"
    if part.length is None:
        doubtful = significant26 and significant35 and c26 * c35 > 0.0
        wrong = "c26 and c35 must have opposite signs, since both follow from the same lever arm"
    else:
        doubtful = (significant26 and c26 < 0.0) or (significant35 and c35 > 0.0)
        wrong = "a straight right-handed cantilever has c26 > 0 and c35 < 0"
        numbers["c26 of a beam"] = float(1.5 * c[1, 1] / part.length)
        numbers["c35 of a beam"] = float(-1.5 * c[2, 2] / part.length)
        evidence += (
            f"; a beam of the same c22 and c33 has c26 = {numbers['c26 of a beam']:+.3g}, "
            f"c35 = {numbers['c35 of a beam']:+.3g} rad/N"
        )
    if doubtful:
        yield Finding(
            f"{part.name}.compliance",
            "couplings",
            printed=f"c26 = {c26:.3g}, c35 = {c35:.3g} rad/N",
            wrong=wrong,
            evidence=evidence,
            severity="warning",
            numbers=numbers,
        )


def _tip_rotation(part: DescribedPart) -> Iterator[Finding]:
    """Check that the tip rotates at most ten times as far as a beam's tip at equal deflection.

    The beam has no shear deformation, so that c66 = 3 c22/L² and c55 = 3 c33/L².
    """
    if part.compliance is None or part.length is None:
        return
    diagonal = np.diag(part.compliance)
    for along, about in ((2, 6), (3, 5)):
        deflection, rotation = diagonal[along - 1], diagonal[about - 1]
        ratio = float(rotation * part.length**2 / (3.0 * deflection))
        if not 0.0 < ratio <= _LARGEST_TIP_ROTATION:
            yield Finding(
                f"{part.name}.compliance",
                f"tip rotation c{about}{about}",
                printed=f"c{along}{along} = {deflection:.3g} m/N, "
                f"c{about}{about} = {rotation:.3g} rad/(N m)",
                wrong="the tip turns far more than a beam with the same deflection; probably the "
                "interface deforms locally, which a leg of constant section cannot represent",
                evidence=f"{ratio:.3g} times a beam's 3 c{along}{along}/L²",
                severity="note",
                numbers={"ratio": ratio},
            )


def _mass_centre(part: DescribedPart) -> Iterator[Finding]:
    """Check that the mass centre of a leg lies between root and tip."""
    if part.mass_centre is None or part.length is None or 0.0 < part.mass_centre < part.length:
        return
    yield Finding(
        f"{part.name}.mass_centre",
        "mass centre",
        printed=f"{part.mass_centre:g} m",
        wrong="the mass centre lies outside the leg",
        evidence=f"the leg reaches from 0 to {part.length:g} m",
        severity="warning",
        numbers={"mass centre": part.mass_centre, "length": part.length},
    )
