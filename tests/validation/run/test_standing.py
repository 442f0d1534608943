"""Summary of a run: exit code and sentence are consistent for every kind of failure."""

from dataclasses import replace
from itertools import product

import pytest
from support.fakes.toy_catalogue import case
from support.pages.report_sample import HEADER, entry, never, sample_matrix, sample_report

from validation.case import Case
from validation.report.summary import adequacy, verdicts
from validation.run.outcome import Result, outcome_of
from validation.run.results import Results, standing_of
from validation.studies_and_figures import PlannedFigure
from validation.verdicts import ADEQUACY, MEASURED, Assessment

FIGURE = PlannedFigure("fig7", "Fig. 7", never)
MODELS = Assessment(ADEQUACY, "", never)
CASES = [case(f"toy[{k}]", never) for k in range(3)]


def result(task, verdict, message=""):
    """Result of a task with a verdict and no measurement."""
    if isinstance(task, Case):
        return outcome_of(task, verdict, 0.1, message)
    return Result(task.id, verdict, 0.1, message)


def results(tasks, *verdicts, **fields):
    """Results of tasks with these verdicts. Tasks beyond the last verdict are not computed."""
    done = {
        task.id: result(task, verdict, "why")
        for task, verdict in zip(tasks, verdicts, strict=False)
    }
    return Results(HEADER, tasks, done=done, **fields)


@pytest.mark.parametrize(
    ("tasks", "task_verdicts", "sentence", "code"),
    [
        (CASES, ["agree"] * 3, "All 3 comparisons agree.", 0),
        (CASES, ["agree", "skipped", "undecided"], "1 of 2 comparisons agree, 1 und", 0),
        (CASES, ["agree", "agree", "disagree"], "2 of 3 comparisons agree, 1 disagree.", 1),
        (CASES, ["agree", "agree", "failed"], "2 of 3 comparisons agree, 1 failed.", 3),
        (CASES, ["agree", "agree"], "All 2 comparisons agree, 1 not computed.", 3),
        # Figures and assessments fail, too.
        (
            [*CASES, FIGURE],
            [*["agree"] * 3, "failed"],
            "All 3 comparisons agree, 1 figure failed.",
            3,
        ),
        ([*CASES, FIGURE], [*["agree"] * 3, "skipped"], "All 3 comparisons agree.", 0),
        (
            [*CASES, MODELS],
            [*["agree"] * 3, "failed"],
            "All 3 comparisons agree, 1 assessment of the models failed.",
            3,
        ),
        ([MODELS], ["failed"], "No comparison was made, 1 assessment of the models failed.", 3),
    ],
)
def test_summary_of_run_matches_exit_code(tasks, task_verdicts, sentence, code):
    """0: all agree; 1: disagreement or an inadequate relied model; 3: failure."""
    run_results = results(tasks, *task_verdicts)
    assert run_results.standing.exit_code == code
    assert run_results.standing.sentence.startswith(sentence)
    # Terminal and page have it from there.
    assert run_results.standing.sentence in verdicts(run_results)
    assert sample_report().checks == sample_report().results.standing.sentence


def test_program_error_of_model_is_failure():
    """An error in a model of the robot or of a leg gives exit code 3.

    Its entries are undecided, which alone would give exit code 0.
    """
    leg = sample_matrix(robot="leg 1", faults=("beam",))
    matrix = sample_matrix(faults=("links", "beam"), parts=(leg,))
    for tasks, begin in ((CASES, "All 3 comparisons agree"), ([], "No comparison was made")):
        run_results = results([*tasks, MODELS], *["agree"] * len(tasks))
        done = run_results.done | {MODELS.id: Result(MODELS.id, "made", 0.1, found=matrix)}
        run_results = replace(run_results, done=done)
        assert run_results.standing.exit_code == 3
        assert (
            run_results.standing.sentence
            == f"{begin}, failed by an error of the program: links, beam."
        )
        assert run_results.standing.sentence in verdicts(run_results)
    done = {MODELS.id: Result(MODELS.id, "made", 0.1, found=sample_matrix(parts=(leg,)))}
    assert standing_of([MODELS], done).exit_code == 3


def test_failed_run_never_reports_success():
    """All combinations of agree, skipped, failed and missing over four kinds of tasks."""
    kinds = [CASES[0], CASES[1], FIGURE, MODELS]
    for task_verdicts in product(["agree", "skipped", "failed", None], repeat=len(kinds)):
        done = {
            task.id: result(task, verdict)
            for task, verdict in zip(kinds, task_verdicts, strict=True)
            if verdict
        }
        standing = standing_of(kinds, done)
        troubled = "failed" in task_verdicts or None in task_verdicts
        assert (standing.exit_code == 3) is troubled
        words = ("failed", "not computed")
        assert any(word in standing.sentence for word in words) is troubled


def test_equal_failures_share_a_line():
    """A missing library fails all comparisons with solids, for one reason."""
    run_results = results(CASES, "failed", "agree", "failed")
    lines = [line for line in verdicts(run_results) if line.startswith("failed")]
    assert lines == ["failed    toy[0] and 1 more: why"]
    # Another reason or verdict has a line of its own.
    other = run_results.done | {CASES[2].id: result(CASES[2], "failed", "another reason")}
    lines = verdicts(replace(run_results, done=other))
    assert lines[:2] == ["failed    toy[0]: why", "failed    toy[2]: another reason"]


def by_gauge(size):
    """Matrix in which the simplified model differs from a measured value by `size` (relative)."""
    of_gauge = entry("simplified", "z", size, measured=True, reference="measured: gauge")
    return sample_matrix(entries=(of_gauge,), quantities=("z",))


@pytest.mark.parametrize(("size", "code"), [(16.0, 1), (0.001, 0)])
def test_relied_model_off_measured_value_exits_with_1(size, code):
    """The simplified model is 16 times, or 0.1 %, off the measured value."""
    done = {MEASURED: Result(MEASURED, "made", 0.1, found=by_gauge(size))}
    tasks = [Assessment(MEASURED, "", never)]
    run_results = Results(HEADER, tasks, done=done, rely=("simplified",))
    assert run_results.standing.exit_code == code
    refused = "relied on but not adequate: simplified"
    assert (refused in adequacy(run_results)) is bool(code)
    # Either matrix refuses.
    two_matrices = {ADEQUACY: Result(ADEQUACY, "made", 0.1, found=sample_matrix()), **done}
    tasks.append(MODELS)
    assert replace(run_results, tasks=tasks, done=two_matrices).standing.exit_code == 1


def test_missing_verdict_fails_if_strict():
    """The assessment was skipped: the model of --rely has no verdict, a failure with --strict."""
    for strict in (False, True):
        run_results = results([MODELS], "skipped", rely=("beam",), strict=strict)
        assert run_results.refused == (("beam",) if strict else ())
        assert run_results.standing.exit_code == int(strict)
        # Nothing of the kind was to be judged.
        assert results(CASES, *["agree"] * 3, rely=("beam",), strict=strict).refused == ()
