"""Report of artificial outcomes that contains every element of a report.

Its verdict matrix is like that of a robot with legs known by their 6×6.
"""

import base64
from dataclasses import replace
from functools import cache

import msgspec
import numpy as np
from support.fakes import toy_catalogue

from lumped.acceptance.quantities import measured_quantity, quantities
from lumped.audit import Finding
from validation.case import Absolute, Allowance, Measurement, Relation, Relative
from validation.report.figures.studies import family_of, study_figure
from validation.report.page import Report
from validation.run.outcome import Result, judge, outcome_of
from validation.run.results import Results
from validation.studies_and_figures import Figure, PlannedFigure, Study
from validation.verdicts import (
    ADEQUACY,
    MEASURED,
    Assessment,
    Cause,
    Coordinate,
    Entry,
    Matrix,
    ModelNote,
)

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
POSES = ((0.145,), (0.4975,), (0.85,))
# Names of loads that samples may have.
LOADS = ("weight", "tug")


def quantity_of(name, *, measured=False):
    """Quantity with the name `name`, of verdicts or of measured values."""
    if measured:
        return measured_quantity(name)
    return next(quantity for quantity in quantities(LOADS) if quantity.name == name)


def entry(model, name, *curve, **fields):
    """Entry judged by the largest error along `curve`. Undecided without a curve.

    The error of a displacement is equal to that of its component along the load, which has a sign.
    """
    quantity = quantity_of(name, measured=fields.get("measured", False))
    judged = {"error": None, "uncertainty": None, "verdict": "undecided", "pose": POSES[0]}
    if curve:
        errors = curve if len(curve) > 1 else curve * len(POSES)
        worst = max(errors, key=abs)
        judged = {
            "error": worst,
            "uncertainty": 0.001,
            "uncertainties": {"meshes": 0.001},
            "verdict": "adequate" if abs(worst) <= 0.05 else "inadequate",
            "pose": POSES[errors.index(worst)],
            "errors": errors,
            "value": 1e-8 * (1.0 + worst),
            "expected": 1e-8,
            "computed_by": (f"validation.models.robot_compliance({model!r})",),
        }
        if quantity.whole:
            judged |= {"error": abs(worst), "errors": tuple(map(abs, errors))}
            judged |= {"along": worst, "alongs": errors}
        half = fields.get("uncertainty", judged["uncertainty"])
        least = 0.0 if "along" in judged else -np.inf
        judged |= {"low": max(judged["error"] - half, least), "high": judged["error"] + half}
        judged["lows"] = tuple(max(error - half, least) for error in judged["errors"])
        judged["highs"] = tuple(error + half for error in judged["errors"])
    elif "verdict" not in fields:
        judged["reason"] = "say how the mass is distributed"
    judged |= {"limit": 0.05, "reference": "robot assembled from the legs' own 6×6"}
    return Entry(model=model, quantity=quantity, **judged | fields)


def sample_matrix(**fields):
    drives = Cause("drives only: legs and feet rigid", 1.2, "virtual joints")
    simple = {"causes": (drives,), "remedy": "use vjm", "error_with_remedy": 0.002}
    couplings = Cause("equivalent leg: couplings of the 6×6 left out", 0.9, "virtual joints")
    remedy = "take the 6×6 with its couplings"
    couplings_omitted = {"causes": (couplings,), "remedy": remedy, "error_with_remedy": 0.001}
    entries = [
        entry("simplified", "x", -0.85, -0.88, -1.0, **simple),
        entry("simplified", "y", -0.86, -0.87, -0.857, **simple),
        entry("simplified", "z", -1.0, reason="it knows no such motion"),
        *(entry("vjm", q, 0.0, 0.001, 0.0) for q in "xyz"),
        *(
            entry(model, q, -size, -size + 0.01, -size + 0.02, **couplings_omitted)
            for model in ("vjm-equivalent", "segments", "beam")
            for q, size in zip("xyz", (0.17, 0.15, 0.16), strict=True)
        ),
        *(entry(model, q) for model in ("simplified", "segments", "beam") for q in ("f1", "f2")),
    ]
    shown_entries = fields.get("entries", entries)
    models = dict.fromkeys(item.model for item in shown_entries)
    quantity_by_name = {item.quantity.name: item.quantity for item in shown_entries}
    names = fields.pop("quantities", ("x", "y", "z", "phi_x", "f1", "f2", "order"))
    silent = {"vjm": "static", "vjm-equivalent": "static"}
    return Matrix(
        **{
            "robot": "sample",
            "coordinates": (Coordinate("x", "m"),),
            "poses": POSES,
            "models": tuple(ModelNote(m, f"title of {m}", silent.get(m, "")) for m in models),
            "quantities": tuple(quantity_by_name.get(name) or quantity_of(name) for name in names),
            "entries": tuple(entries),
            "notes": ("f1 between 113 and 131 Hz",),
        }
        | fields
    )


def never(_context):
    raise AssertionError("the report computes nothing")


def case(identifier, **changes):
    fields = {
        "citation": "Timoshenko & Gere, Table 1",
        "tolerance": Relative(0.01),
        "tolerance_reason": "shear is in both models",
        "section": "The legs",
        "subject": "leg",
    }
    return toy_catalogue.case(identifier, never, **fields | changes)


FREQUENCIES = {"mode 1": 186.8, "mode 2": 1170.0}
CONVERGENCE = Study(
    id="study.elements",
    title="Frequencies of leg 1 against the number of segments",
    x_label="elements per leg",
    y_label="bending frequencies",
    unit="Hz",
    x=(5.0, 10.0, 20.0, 40.0),
    series={
        name: tuple(limit * (1.0 - 0.65 / n**2) for n in (5, 10, 20, 40))
        for name, limit in FREQUENCIES.items()
    },
    formal_order=2.0,
    orders=dict.fromkeys(FREQUENCIES, 2.0),
    uncertainties={"mode 1": 0.006, "mode 2": 0.07},
    limits=FREQUENCIES,
)
FINDING = Finding(
    where="foot.compliance",
    check="definiteness",
    printed="3.16e-09",
    wrong="the matrix is indefinite",
    evidence="smallest eigenvalue −3.5e-08",
    used="3.16e-07",
    kind="computed",
    severity="error",
)
MATRIX = sample_matrix()
FIG_5 = Figure("fig5", "Fig. 5", "Made up.", "The paper's statements", png=PIXEL, data="x\n1\n")


@cache
def study_picture():
    """Figure of the study, drawn once for all tests of the page."""
    return study_figure(family_of([CONVERGENCE]))


def measured(identifier, value, reference, *spreads, exact=True, **case_fields):
    """Outcome of a comparison with these fields of its case and its measurement."""
    names = ("allowances", "studies", "table")
    of_measurement = {name: case_fields.pop(name) for name in names if name in case_fields}
    measurement = Measurement(value, reference, *spreads, exact=exact, **of_measurement)
    return judge(case(identifier, **case_fields), measurement, 0.1)


def redeclared(outcome, **case_fields):
    """Copy of the outcome with other fields of its case."""
    return msgspec.structs.replace(outcome, case=replace(outcome.case, **case_fields))


def unmeasured(identifier, verdict, message):
    return outcome_of(case(identifier), verdict, 0.2, message)


def sample_outcomes():
    disagreeing = measured(
        *("robot.beam-vjm.planar[x=0.4975]", 8.97, 8.81),
        unit="µm",
        tolerance=Absolute(0.05),
        section="The robot over its stroke",
        allowances=(Allowance("shear deformation", 0.02, "physics of the beam"),),
        table={"x (m)": (0.145, 0.4975), "planar (µm)": (0.42, 8.81)},
    )
    return (
        measured("legs.agrees", 1.001, 1.0, 1e-4, 2e-4, exact=False, studies=(CONVERGENCE,)),
        measured("legs.tight", 1.0095, 1.0, title="Agrees barely"),
        unmeasured("legs.failed", "failed", "leg 2: matrix is <singular>"),
        unmeasured("legs.skipped", "skipped", "CalculiX is not installed"),
        disagreeing,
        measured("paper.bound", 1.063, 1.1, relation=Relation.AT_MOST, section=FIG_5.section),
    )


HEADER = {
    "robot": "IFW demonstrator",
    "robot_file": "ifw",
    "robot_sha256": "ab" * 32,
    "suite_sha256": "cd" * 32,
    "preset": "standard",
    "options": {},
    "started": "2026-01-02T03:04:05+00:00",
    "seconds": 75.2,
    "machine": "Linux x86_64, 2 cores",
    "versions": {"python": "3.11.7", "numpy": "2.4.6", "flexproof": "1.2"},
    "selftest": "passed on 2026-01-01",
}


def sample_report(
    *,
    outcomes=None,
    figures=None,
    missing=("fig7",),
    matrix=MATRIX,
    measured=None,
    unjudged=None,
    unfinished=0,
    findings=(FINDING,),
):
    """Report on the given outcomes. `matrix` and `measured` are omitted if None.

    `unjudged` contains failed assessments with their reasons.
    """
    outcomes = sample_outcomes() if outcomes is None else outcomes
    figures = (study_picture(), FIG_5) if figures is None else figures
    contents = {figure.id: figure for figure in figures} | {ADEQUACY: matrix, MEASURED: measured}
    lost = dict.fromkeys(missing, "no OpenGL") | (unjudged or {})
    results = list(outcomes)
    results += [Result(name, "made", 0.1, found=value) for name, value in contents.items() if value]
    results += [Result(name, "failed", 0.1, why) for name, why in lost.items()]
    done = {result.id: result for result in results}
    planned = [*(figure.id for figure in figures), *missing, *map(str, range(unfinished))]
    tasks = [
        *(outcome.case for outcome in outcomes),
        *(PlannedFigure(name, "Fig. 7, mode shapes", never) for name in planned),
        *(Assessment(name, "", never) for name in (ADEQUACY, MEASURED) if name in done),
    ]
    return Report(Results(HEADER, tasks, done=done), findings)
