"""Mistakes in what is shown: quantities and their units, records, pages, curves, end effects."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array
from validation.faults.fault import Fault, Faulty, around, instead, result
from validation.studies.quantities import Deflections


def _scaled(factor: float) -> Any:
    def changed(found: Deflections) -> Deflections:
        return Deflections(factor * found.planar_x, factor * found.planar_y, factor * found.along_z)

    return result(changed)


def _largest_component(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    scale = 1e9
    return replace(
        found,
        planar_x=np.abs(compliances[:, :2, 0]).max(axis=1) * scale,
        planar_y=np.abs(compliances[:, :2, 1]).max(axis=1) * scale,
    )


def _along_the_load(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    return replace(found, planar_x=compliances[:, 0, 0] * 1e9, planar_y=compliances[:, 1, 1] * 1e9)


def _axes_exchanged(found: Deflections) -> Deflections:
    return replace(found, planar_x=found.planar_y, planar_y=found.planar_x)


def _along_y(sound: Faulty, compliances: Array) -> Deflections:
    found: Deflections = sound(compliances)
    return replace(found, along_z=compliances[:, 1, 1] * 1e9)


def _mean(deflections: Deflections) -> float:
    return float(np.mean([deflections.planar_x.mean(), deflections.planar_y.mean()]))


def _of_x_alone(deflections: Deflections) -> float:
    return float(deflections.planar_x.max())


def _from_the_other_end(values: Array) -> Array:
    return values[::-1]


def _in_rad_per_second(values: Array) -> Array:
    return 2.0 * np.pi * values


def _at_one_fraction(
    sound: Faulty, model: Any, robot: Any, alphas: Any, _fraction: float, *rest: Any
) -> Any:
    return sound(model, robot, alphas, 0.5, *rest)


def _unweighted(shares: Mapping[str, Array]) -> dict[str, Array]:
    return {name: np.sqrt(np.abs(share)) for name, share in shares.items()}


def _field(name: str, other: str, factor: float = 1.0) -> Any:
    def changed(record: dict[str, Any]) -> dict[str, Any]:
        value = record[other]
        return record | {name: None if value is None else factor * value}

    return result(changed)


def _exchanged(record: dict[str, Any]) -> dict[str, Any]:
    return record | {"value": record["reference"], "reference": record["value"]}


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.3g}")


def _minus_lost(text: str) -> str:
    return text.replace("−", "")


def _power_lost(text: str) -> str:
    return text.partition("\u00a0×")[0]


def _two_digits(sound: Faulty, value: Any, digits: int = 5) -> Any:
    return sound(value, min(digits, 1))


def _no_percent(sound: Faulty, fraction: float, **signed: bool) -> Any:
    return sound(0.01 * fraction, **signed)


def _columns_moved(text: str) -> str:
    rows = list(csv.reader(io.StringIO(text)))
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(rows[0])
    writer.writerows([*row[1:], row[0]] for row in rows[1:])
    return buffer.getvalue()


def _series_exchanged(sound: Faulty, study: Any) -> Any:
    names = list(study.series)
    values = list(study.series.values())[::-1]
    return sound(replace(study, series=dict(zip(names, values, strict=True))))


def _study_sorted(record: dict[str, Any]) -> dict[str, Any]:
    return record | {
        "series": {name: sorted(v, reverse=True) for name, v in record["series"].items()}
    }


def _cells_exchanged(sound: Faulty, outcomes: Sequence[Any]) -> Any:
    made, rest = sound(outcomes)
    return (
        tuple(
            replace(grid, rows=tuple(replace(row, cells=row.cells[::-1]) for row in grid.rows))
            for grid in made
        ),
        rest,
    )


def _difference_share(outcome: Any) -> float | None:
    measured = outcome.measurement
    if measured is None or not measured.reference:
        return None
    return float(abs(measured.difference / measured.reference))


def _failures_skipped(text: str) -> str:
    return text.replace("<failure", "<skipped").replace("</failure", "</skipped")


def _words_exchanged(text: str) -> str:
    return text.replace("disagree", "AGREE").replace("agree", "disagree").replace("AGREE", "agree")


def _mean_difference(found: Array, reference: Array) -> float:
    unit = 1.0 / np.sqrt(np.diag(reference))
    return float(np.abs((found - reference) * unit[:, None] * unit).mean() * 1e-3)


def _half_of_it(change: Array) -> Array:
    return 0.5 * change


def _one_end_only(sound: Faulty, fields: Any, length: float) -> Any:
    return 0.5 * sound(fields, length)


def _slow_decay(found: tuple[Array, Array]) -> tuple[Array, Array]:
    return found[0], np.real(found[1]).astype(complex)


def _rates_doubled(found: tuple[Array, Array]) -> tuple[Array, Array]:
    rates, shapes = found
    return rates, np.vstack([2.0 * shapes[: len(shapes) // 3], shapes[len(shapes) // 3 :]])


def _without_middle(coefficients: list[Array]) -> list[Array]:
    return [0.0 * coefficients[0], *coefficients[1:]]


def _fault(name: str, title: str, place: str, change: Any, kind: Any = "data") -> Fault:
    return Fault(f"page.{name}", title, place, kind, change)


_QUANTITIES = "validation.studies.quantities:"
_TEXT = "validation.report.text:"
_TABLES = "validation.report.tables:"
_EFFECTS = "fem.sections.end_effects:"

FAULTS = (
    _fault("kilonewton", "Deflections at 1 N for 1 kN", f"{_QUANTITIES}deflections_of",
           _scaled(1e-3)),
    _fault("millimetre", "Deflections in mm for µm", f"{_QUANTITIES}deflections_of", _scaled(1e-3)),
    _fault("component-for-norm", "The largest component for the norm",
           f"{_QUANTITIES}deflections_of", around(_largest_component)),
    _fault("along-the-load", "Planar deflection along its load alone",
           f"{_QUANTITIES}deflections_of", around(_along_the_load)),
    _fault("axes-exchanged", "Deflections under fx and fy exchanged",
           f"{_QUANTITIES}deflections_of", result(_axes_exchanged)),
    _fault("z-along-y", "Deflection along y shown as along z", f"{_QUANTITIES}deflections_of",
           around(_along_y)),
    _fault("mean-for-largest", "The mean over the stroke for the largest",
           f"{_QUANTITIES}Deflections.largest_planar", instead(_mean)),
    _fault("largest-of-x", "The largest under one of both loads",
           f"{_QUANTITIES}Deflections.largest_planar", instead(_of_x_alone)),
    _fault("postures-reversed", "Postures from the other end of the stroke",
           f"{_QUANTITIES}stroke_compliances", result(_from_the_other_end)),
    _fault("rad-per-second", "Angular frequencies shown as Hz",
           f"{_QUANTITIES}stroke_frequencies", result(_in_rad_per_second)),
    _fault("family-posture", "Members of a family looked at in the middle alone",
           f"{_QUANTITIES}family_deflections", around(_at_one_fraction)),
    _fault("strain-roots", "Roots of energies shown as shares", f"{_QUANTITIES}strain_shares",
           result(_unweighted)),
    _fault("kinetic-roots", "Roots of kinetic energies shown as shares",
           f"{_QUANTITIES}kinetic_shares", result(_unweighted)),
    _fault("record-sign", "A record's error with the wrong sign", "validation.case:result_record",
           _field("error", "error", -1.0)),
    _fault("record-exchanged", "A record's value and reference exchanged",
           "validation.case:result_record", result(_exchanged)),
    _fault("record-uncertainty", "A record with the uncertainty of another number",
           "validation.case:result_record", _field("value_uncertainty", "numerical_uncertainty")),
    _fault("record-unexplained", "A record's error shown as unexplained",
           "validation.case:result_record", _field("unexplained", "error")),
    _fault("record-tolerance", "A record with twice its tolerance",
           "validation.case:result_record", _field("tolerance", "tolerance", 2.0)),
    _fault("rounded", "Three digits written for all", "validation.case:finite", result(_rounded)),
    _fault("minus", "Minus signs lost", f"{_TEXT}number", result(_minus_lost)),
    _fault("power", "Powers of ten lost", f"{_TEXT}number", result(_power_lost)),
    _fault("digits", "One digit shown", f"{_TEXT}number", around(_two_digits)),
    _fault("fraction", "Fractions shown as percent", f"{_TEXT}percent", around(_no_percent)),
    _fault("percent-sign", "The sign of an error lost", f"{_TEXT}percent", result(_minus_lost)),
    _fault("tolerance-text", "Tolerances shown in the wrong power", f"{_TEXT}tolerance",
           result(lambda text: text.replace("0.", "0.0"))),
    _fault("csv", "Columns of a CSV under the wrong heading",
           "validation.report.figures.style:csv_of", result(_columns_moved)),
    _fault("series", "A figure's series exchanged",
           "validation.report.figures.studies.family_plots:study_plot", around(_series_exchanged)),
    _fault("study", "A study's values sorted", "validation.exhibits:study_record",
           result(_study_sorted)),
    _fault("cells", "A table's models exchanged", f"{_TABLES}grids", around(_cells_exchanged)),
    _fault("difference-share", "Shares of the whole difference for the unexplained one",
           f"{_TABLES}unexplained_share", instead(_difference_share)),
    _fault("junit", "JUnit skips what disagrees", "validation.results.junit:junit_xml",
           result(_failures_skipped)),
    _fault("line", "A line with the opposite verdict", "validation.console.listing:outcome_line",
           result(_words_exchanged)),
    _fault("summary", "A summary with the opposite verdicts", "validation.console.listing:summary",
           result(_words_exchanged)),
    _fault("mean-entry", "The mean entry of a difference for the largest",
           "validation.cases.program.guards.robot:scaled_difference",
           instead(_mean_difference), "numerics"),
    _fault("one-held-face", "One held face for two", f"{_EFFECTS}_change", around(_one_end_only),
           "physics"),
    _fault("axial-decay", "Fields that decay with twice their warping", f"{_EFFECTS}_decays",
           result(_rates_doubled), "physics"),
    _fault("real-decay", "Only the real part of fields that decay", f"{_EFFECTS}_decays",
           result(_slow_decay), "physics"),
    _fault("section-state", "Saint-Venant's states without the section's own displacement",
           f"{_EFFECTS}_polynomial", result(_without_middle), "physics"),
)  # fmt: skip
