"""Mistakes in what is shown: quantities and their units, records, pages, curves, end effects."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from msgspec import structs

from lumped.arrays import Array
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value
from validation.results.records import CaseRecord
from validation.studies.quantities import Deflections


def _scaled(factor: float) -> Any:
    def changed(found: Deflections) -> Deflections:
        return Deflections(factor * found.planar_x, factor * found.planar_y, factor * found.along_z)

    return changed


@fault_around(
    "page.component-for-norm",
    "The largest component for the norm",
    "validation.studies.quantities.deflections_of",
)
def _largest_component(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    scale = 1e9
    return replace(
        found,
        planar_x=np.abs(compliances[:, :2, 0]).max(axis=1) * scale,
        planar_y=np.abs(compliances[:, :2, 1]).max(axis=1) * scale,
    )


@fault_around(
    "page.along-the-load",
    "Planar deflection along its load alone",
    "validation.studies.quantities.deflections_of",
)
def _along_the_load(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    return replace(found, planar_x=compliances[:, 0, 0] * 1e9, planar_y=compliances[:, 1, 1] * 1e9)


@fault_in_value(
    "page.axes-exchanged",
    "Deflections under fx and fy exchanged",
    "validation.studies.quantities.deflections_of",
)
def _axes_exchanged(found: Deflections) -> Deflections:
    return replace(found, planar_x=found.planar_y, planar_y=found.planar_x)


@fault_around(
    "page.z-along-y",
    "Deflection along y shown as along z",
    "validation.studies.quantities.deflections_of",
)
def _along_y(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    return replace(found, along_z=compliances[:, 1, 1] * 1e9)


@fault(
    "page.mean-for-largest",
    "The mean over the stroke for the largest",
    "validation.studies.quantities.Deflections.largest_planar",
)
def _mean(deflections: Deflections) -> float:
    return float(np.mean([deflections.planar_x.mean(), deflections.planar_y.mean()]))


@fault(
    "page.largest-of-x",
    "The largest under one of both loads",
    "validation.studies.quantities.Deflections.largest_planar",
)
def _of_x_alone(deflections: Deflections) -> float:
    return float(deflections.planar_x.max())


@fault(
    "page.first-posture",
    "The first posture shown for the one that is farthest off",
    "validation.studies.quantities.farthest",
)
def _first(_found: Array, _reference: Array) -> int:
    return 0


@fault_in_value(
    "page.postures-reversed",
    "Postures from the other end of the stroke",
    "validation.studies.quantities.stroke_compliances",
)
def _from_the_other_end(values: Array) -> Array:
    return values[::-1]


@fault_in_value(
    "page.rad-per-second",
    "Angular frequencies shown as Hz",
    "validation.studies.quantities.stroke_frequencies",
)
def _in_rad_per_second(values: Array) -> Array:
    return 2.0 * np.pi * values


@fault_around(
    "page.family-posture",
    "Members of a family looked at in the middle alone",
    "validation.studies.quantities.family_deflections",
)
def _at_one_fraction(
    sound: Faulty, model: Any, robot: Any, alphas: Any, _fraction: float, *rest: Any
) -> Any:
    return sound(model, robot, alphas, 0.5, *rest)


@fault_in_value(
    "page.strain-roots",
    "Roots of energies shown as shares",
    "validation.studies.quantities.strain_shares",
)
@fault_in_value(
    "page.kinetic-roots",
    "Roots of kinetic energies shown as shares",
    "validation.studies.quantities.kinetic_shares",
)
def _unweighted(shares: Mapping[str, Array]) -> dict[str, Array]:
    return {name: np.sqrt(np.abs(share)) for name, share in shares.items()}


def _field(name: str, other: str, factor: float = 1.0) -> Any:
    def changed(record: CaseRecord) -> CaseRecord:
        value = getattr(record, other)
        return structs.replace(record, **{name: None if value is None else factor * value})

    return changed


@fault_in_value(
    "page.record-exchanged",
    "A record's value and reference exchanged",
    "validation.results.records.case_record",
)
def _exchanged(record: CaseRecord) -> CaseRecord:
    return structs.replace(record, value=record.reference, reference=record.value)


@fault_in_value("page.rounded", "Three digits written for all", "validation.results.records.finite")
def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.3g}")


@fault_in_value("page.minus", "Minus signs lost", "validation.drawing.text.number")
@fault_in_value("page.percent-sign", "The sign of an error lost", "validation.drawing.text.percent")
def _minus_lost(text: str) -> str:
    return text.replace("−", "")


@fault_in_value("page.power", "Powers of ten lost", "validation.drawing.text.number")
def _power_lost(text: str) -> str:
    return text.partition("\u00a0×")[0]


@fault_around("page.digits", "One digit shown", "validation.drawing.text.number")
def _two_digits(sound: Faulty, value: Any, digits: int = 5) -> Any:
    return sound(value, min(digits, 1))


@fault_around("page.fraction", "Fractions shown as percent", "validation.drawing.text.percent")
def _no_percent(sound: Faulty, fraction: float, **signed: bool) -> Any:
    return sound(0.01 * fraction, **signed)


@fault_in_value(
    "page.csv", "Columns of a CSV under the wrong heading", "validation.drawing.style.csv_of"
)
def _columns_moved(text: str) -> str:
    rows = list(csv.reader(io.StringIO(text)))
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(rows[0])
    writer.writerows([*row[1:], row[0]] for row in rows[1:])
    return buffer.getvalue()


@fault_around(
    "page.series",
    "A figure's series exchanged",
    "validation.report.figures.studies.family_plots.study_plot",
)
def _series_exchanged(sound: Faulty, study: Any) -> Any:
    names = list(study.series)
    values = list(study.series.values())[::-1]
    return sound(replace(study, series=dict(zip(names, values, strict=True))))


@fault_in_value("page.study", "A study's values sorted", "validation.exhibits.study_record")
def _study_sorted(record: dict[str, Any]) -> dict[str, Any]:
    return record | {
        "series": {name: sorted(v, reverse=True) for name, v in record["series"].items()}
    }


@fault_around("page.cells", "A table's models exchanged", "validation.report.tables.grids")
def _cells_exchanged(sound: Faulty, outcomes: Sequence[Any]) -> Any:
    made, rest = sound(outcomes)
    return (
        tuple(
            replace(grid, rows=tuple(replace(row, cells=row.cells[::-1]) for row in grid.rows))
            for grid in made
        ),
        rest,
    )


@fault(
    "page.difference-share",
    "Shares of the whole difference for the unexplained one",
    "validation.report.tables.unexplained_share",
)
def _difference_share(outcome: Any) -> float | None:
    measured = outcome.measurement
    if measured is None or not measured.reference:
        return None
    return float(abs(measured.difference / measured.reference))


@fault_in_value("page.junit", "JUnit skips what disagrees", "validation.results.junit.junit_xml")
def _failures_skipped(text: str) -> str:
    return text.replace("<failure", "<skipped").replace("</failure", "</skipped")


@fault_in_value(
    "page.line", "A line with the opposite verdict", "validation.report.listing.outcome_line"
)
@fault_in_value(
    "page.summary", "A summary with the opposite verdicts", "validation.report.listing.summary"
)
def _words_exchanged(text: str) -> str:
    return text.replace("disagree", "AGREE").replace("agree", "disagree").replace("AGREE", "agree")


@fault(
    "page.mean-entry",
    "The mean entry of a difference for the largest",
    "validation.agreement.differences.scaled_difference",
)
def _mean_difference(found: Array, reference: Array) -> float:
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((found - reference) * unit[:, None] * unit).mean() * 1e-3)


@fault_around("page.one-held-face", "One held face for two", "fem.couplings.end_effects._change")
def _one_end_only(sound: Faulty, fields: Any, length: float) -> Any:
    return 0.5 * sound(fields, length)


@fault_in_value(
    "page.real-decay",
    "Only the real part of fields that decay",
    "fem.couplings.end_effects._decays",
)
def _slow_decay(found: tuple[Array, Array]) -> tuple[Array, Array]:
    return found[0], np.real(found[1]).astype(complex)


@fault_in_value(
    "page.axial-decay",
    "Fields that decay with twice their warping",
    "fem.couplings.end_effects._decays",
)
def _rates_doubled(found: tuple[Array, Array]) -> tuple[Array, Array]:
    rates, shapes = found
    return rates, np.vstack([2.0 * shapes[: len(shapes) // 3], shapes[len(shapes) // 3 :]])


@fault_in_value(
    "page.section-state",
    "Saint-Venant's states without the section's own displacement",
    "fem.couplings.section_fields._polynomial",
)
def _without_middle(coefficients: list[Array]) -> list[Array]:
    return [0.0 * coefficients[0], *coefficients[1:]]


fault_in_value(
    "page.kilonewton", "Deflections at 1 N for 1 kN", "validation.studies.quantities.deflections_of"
)(_scaled(1e-3))
fault_in_value(
    "page.millimetre", "Deflections in mm for µm", "validation.studies.quantities.deflections_of"
)(_scaled(1e-3))
fault_in_value(
    "page.record-sign",
    "A record's error with the wrong sign",
    "validation.results.records.case_record",
)(_field("error", "error", -1.0))
fault_in_value(
    "page.record-uncertainty",
    "A record with the uncertainty of another number",
    "validation.results.records.case_record",
)(_field("value_uncertainty", "numerical_uncertainty"))
fault_in_value(
    "page.record-unexplained",
    "A record's error shown as unexplained",
    "validation.results.records.case_record",
)(_field("unexplained", "error"))
fault_in_value(
    "page.record-tolerance",
    "A record with twice its tolerance",
    "validation.results.records.case_record",
)(_field("tolerance", "tolerance", 2.0))
fault_in_value(
    "page.tolerance-text",
    "Tolerances shown in the wrong power",
    "validation.drawing.text.tolerance",
)(lambda text: text.replace("0.", "0.0"))
