"""A report from made-up outcomes, with everything that a report can show."""

import base64

import toy_catalogue
from matrix_sample import sample_matrix

from lumped.audit import Finding
from validation.adequacy.matrix import ADEQUACY, MEASURED, Assessment
from validation.case import Absolute, Allowance, Measurement, Relation, Relative
from validation.exhibits import Figure, PlannedFigure, Study
from validation.report.figures.studies import family_of, study_figure
from validation.report.page import Report
from validation.results.gathered import Results
from validation.results.outcome import Outcome, Result, judge

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


def never(_context):
    raise AssertionError("the report computes nothing")


def case(identifier="legs.a", **changes):
    fields = {
        "title": "Tip deflection of leg 1 along y",
        "quantity": "c22",
        "unit": "m/N",
        "citation": "Timoshenko & Gere, Table 1",
        "tolerance": Relative(0.01),
        "tolerance_reason": "shear is in both models",
        "compute": never,
        "section": "The legs",
        "subject": "leg",
    }
    return toy_catalogue.case(identifier, **fields | changes)


CONVERGENCE = Study(
    id="study.elements",
    title="Frequencies of leg 1 against the number of segments",
    x_label="elements per leg",
    y_label="bending frequencies",
    unit="Hz",
    x=(5.0, 10.0, 20.0, 40.0, 80.0, 160.0),
    series={
        f"mode {mode}": tuple(f * (1.0 - 0.65 * mode / n**2) for n in (5, 10, 20, 40, 80, 160))
        for mode, f in ((1, 186.8), (2, 1170.0), (3, 3278.0))
    },
    formal_order=2.0,
    orders={"mode 1": 2.0, "mode 2": 2.0, "mode 3": 1.99},
    uncertainties={"mode 1": 0.006, "mode 2": 0.07, "mode 3": 0.3},
    limits={"mode 1": 186.8, "mode 2": 1170.0, "mode 3": 3278.0},
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


def unmeasured(identifier, verdict, message, **changes):
    return Outcome(case(identifier, **changes), Result(identifier, verdict, 0.2, message))


# Drawn once for all tests of a page.
MATRIX = sample_matrix()
DRAWN = study_figure(family_of([CONVERGENCE]))


def sample_outcomes():
    agreeing = judge(
        case("legs.agrees", title="Agrees easily"),
        Measurement(1.001e-8, 1.0e-8, 1e-12, 2e-12, studies=(CONVERGENCE,)),
        0.8,
    )
    tight = judge(
        case("legs.tight", title="Agrees barely"), Measurement(1.0095e-8, 1.0e-8, exact=True), 0.1
    )
    disagreeing = judge(
        case(
            "robot.beam-vjm.planar[x=0.4975]",
            title="Planar deflection at the centre under fx, beam against VJM",
            quantity="planar deflection",
            unit="µm",
            tolerance=Absolute(0.05),
            section="The robot over its stroke",
        ),
        Measurement(
            8.97,
            8.81,
            exact=True,
            allowances=(Allowance("shear deformation", 0.02, "physics of the beam"),),
            notes=("A note.",),
            table={"x (m)": (0.145, 0.4975), "planar (µm)": (0.42, 8.81)},
        ),
        2.0,
    )
    bound = judge(
        case(
            "paper.deflection-bound",
            title="Simplified deflections stay below 1.1 µm",
            unit="µm",
            relation=Relation.AT_MOST,
            tolerance=Absolute(0.05),
            section="The paper's statements",
        ),
        Measurement(1.063, 1.1, exact=True),
        0.01,
    )
    failed = unmeasured("legs.failed", "failed", "leg 2: matrix is <singular>")
    skipped = unmeasured("legs.skipped", "skipped", "CalculiX is not installed")
    return (bound, agreeing, tight, failed, skipped, disagreeing)


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
FIG_5 = Figure("fig5", "Fig. 5", "Made up.", "The paper's statements", png=PIXEL, data="x\n1\n")


def sample_report(
    *,
    outcomes=None,
    figures=(DRAWN, FIG_5),
    missing=("fig7",),
    matrix=MATRIX,
    measured=None,
    unjudged=(),
    unfinished=0,
    findings=(FINDING,),
):
    """A report on these; `matrix` and `measured` are left out where None.

    `unjudged` has assessments that failed, and why.
    """
    outcomes = sample_outcomes() if outcomes is None else outcomes
    matrices = {name: one for name, one in ((ADEQUACY, matrix), (MEASURED, measured)) if one}
    done = {outcome.case.id: outcome.result for outcome in outcomes}
    made = {**{figure.id: figure for figure in figures}, **matrices}
    done |= {name: Result(name, "made", 0.1, found=found) for name, found in made.items()}
    done |= {name: Result(name, "failed", 0.1, "no OpenGL") for name in missing}
    done |= {name: Result(name, "failed", 0.1, why) for name, why in dict(unjudged).items()}
    left = [f"left.{number}" for number in range(unfinished)]
    planned = [*(figure.id for figure in figures), *missing, *left]
    tasks = [
        *(outcome.case for outcome in outcomes),
        *(PlannedFigure(name, "Fig. 7, mode shapes", never) for name in planned),
        *(Assessment(name, "", never) for name in (ADEQUACY, MEASURED) if name in done),
    ]
    return Report(Results(HEADER, tasks, done=done), findings)
