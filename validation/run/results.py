"""Results of a run so far, with verdict on the run, exit code and results.json.

Input: records of finished tasks. Output: outcomes, figures and matrices in catalogue order. Rule:
exit code 3 if anything failed or was not computed, 1 if a case disagrees or a model relied on is
inadequate, otherwise 0.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from lumped.text import counted
from validation.run.compare import RunComparison, compare, with_drift
from validation.run.outcome import (
    AnyResult,
    Outcome,
    Record,
    Task,
    Verdict,
    from_plain,
    valid_result,
)
from validation.run.records import RunRecord, parse_run, run_json, run_record
from validation.studies_and_figures import Figure, PlannedFigure
from validation.verdicts import ADEQUACY, MEASURED, Assessment, Matrix

_NOT_AGREEING: tuple[Verdict, ...] = ("disagree", "undecided", "failed", "skipped")
_REFERENCE_TEXTS = {ADEQUACY: "by finite elements", MEASURED: "against measured values"}


@dataclass(frozen=True)
class Standing:
    """Verdict on the tasks of a run.

    `comparisons`: number of comparisons by verdict. `figures`, `assessments`: numbers of failed
    ones. `unfinished`: number of tasks that were not computed. `faults`: names of models, and of
    other computations within an assessment, that ended with an error of the program. `refused`:
    models relied on that are inadequate or, if `strict`, undecided.
    """

    comparisons: Mapping[Verdict, int]
    figures: int = 0
    assessments: int = 0
    unfinished: int = 0
    faults: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    strict: bool = False

    @property
    def exit_code(self) -> int:
        """0 for success, 1 if a case disagrees or a model relied on is inadequate, 3 for a failure.

        A failure is a task or model that failed or was not computed. If `strict`, the code is 1
        also for undecided verdicts.
        """
        if self.failures:
            return 3
        counted_verdicts: tuple[Verdict, ...] = (
            ("disagree", "undecided") if self.strict else ("disagree",)
        )
        return (
            1
            if self.refused or any(self.comparisons.get(verdict) for verdict in counted_verdicts)
            else 0
        )

    @property
    def failures(self) -> int:
        """Number of tasks, or models within a task, that failed or were not computed."""
        failed = self.comparisons.get("failed", 0) + len(self.faults)
        return failed + self.figures + self.assessments + self.unfinished

    @property
    def sentence(self) -> str:
        """Sentence with the verdict on all comparisons and counts of failures."""
        agree = self.comparisons.get("agree", 0)
        judged = sum(self.comparisons.values()) - self.comparisons.get("skipped", 0)
        if judged == 0:
            sentence = "No comparison was made"
        elif agree == judged:
            sentence = f"All {judged} comparisons agree" if judged > 1 else "The comparison agrees"
        else:
            sentence = f"{agree} of {counted(judged, 'comparison')} agree"
        parts = [
            f"{count} {verdict}"
            for verdict in _NOT_AGREEING
            if (count := self.comparisons.get(verdict))
        ]
        assessments = ("assessment of the models", "assessments of the models")
        parts += [f"{counted(self.figures, 'figure')} failed"] if self.figures else []
        parts += [f"{counted(self.assessments, *assessments)} failed"] if self.assessments else []
        faults = ", ".join(self.faults)
        parts += [f"failed by an error of the program: {faults}"] if faults else []
        parts += [f"{self.unfinished} not computed"] if self.unfinished else []
        return ", ".join([sentence, *parts]) + "."


def standing_of(
    tasks: Sequence[Task],
    done: Mapping[str, AnyResult],
    refused: tuple[str, ...] = (),
    *,
    strict: bool = False,
) -> Standing:
    """Verdict on the tasks. `done` contains results by id."""
    results = [done[task.id] for task in tasks if task.id in done]
    failed = [task for task in tasks if task.id in done and done[task.id].verdict == "failed"]
    matrices = [result.found for result in done.values() if isinstance(result.found, Matrix)]
    figures = sum(isinstance(task, PlannedFigure) for task in failed)
    return Standing(
        comparisons=Counter(result.verdict for result in results if isinstance(result, Outcome)),
        figures=figures,
        assessments=sum(isinstance(task, Assessment) for task in failed),
        unfinished=len(tasks) - len(done),
        faults=tuple(dict.fromkeys(fault for matrix in matrices for fault in matrix.all_faults)),
        refused=refused,
        strict=strict,
    )


@dataclass
class Results:
    """Results of finished tasks, by id in `done`.

    `baseline`: earlier run from which drift is computed, None if the user names none. `path`:
    folder of the report; until the run is finished, this is DIR.partial. `remarks`: faults found in
    this folder. `rely`: models that must be adequate. `strict`: True if undecided counts as
    inadequate.
    """

    header: Mapping[str, Any]
    tasks: Sequence[Task]
    baseline: RunRecord | None = None
    done: dict[str, AnyResult] = field(default_factory=dict)
    path: Path = Path()
    remarks: Sequence[str] = ()
    rely: Sequence[str] = ()
    strict: bool = False

    def add(self, record: Record) -> None:
        """Add the record of a finished task."""
        task = next(task for task in self.tasks if task.id == record["id"])
        self.done[task.id] = from_plain(task, record)

    def add_records(self, records: Mapping[str, Record]) -> None:
        """Add results from the records (by id) of an earlier process.

        Records that are not valid for a task of this run, by `valid_result`, are ignored.
        """
        for task in self.tasks:
            if task.id in records and (result := valid_result(task, records[task.id])):
                self.done[task.id] = result

    @property
    def outcomes(self) -> list[Outcome]:
        """Outcomes in catalogue order, with the drift from the baseline."""
        earlier = self.baseline.by_id if self.baseline else {}
        results = (self.done[task.id] for task in self.tasks if task.id in self.done)
        return [
            with_drift(result, earlier.get(result.id))
            for result in results
            if isinstance(result, Outcome)
        ]

    @property
    def figures(self) -> list[Figure]:
        """Figures that were drawn, in catalogue order."""
        contents = (self.done[task.id].found for task in self.tasks if task.id in self.done)
        return [content for content in contents if isinstance(content, Figure)]

    @property
    def missing_figures(self) -> list[tuple[PlannedFigure, str]]:
        """Planned figures that could not be drawn, each with the reason."""
        planned = [task for task in self.tasks if isinstance(task, PlannedFigure)]
        messages = [(task, self.done[task.id].message) for task in planned if task.id in self.done]
        return [(task, message) for task, message in messages if message]

    @property
    def unjudged(self) -> list[str]:
        """Sentences on references against which no model could be judged, each with the reason."""
        results = [(kind, self.done.get(name)) for name, kind in _REFERENCE_TEXTS.items()]
        return [
            f"No model was judged {kind}: {result.message}"
            for kind, result in results
            if result and result.message
        ]

    @property
    def unfinished(self) -> int:
        """Number of tasks that have not been computed."""
        return len(self.tasks) - len(self.done)

    @property
    def matrix(self) -> Matrix | None:
        """Verdicts on the robot's models against computed references. None if there are none."""
        return self._matrix(ADEQUACY)

    @property
    def measured(self) -> Matrix | None:
        """Verdicts on the robot's models against measured values. None if there are none."""
        return self._matrix(MEASURED)

    def _matrix(self, name: str) -> Matrix | None:
        content = self.done[name].found if name in self.done else None
        return content if isinstance(content, Matrix) else None

    @property
    def no_longer_compared(self) -> dict[str, str]:
        """Reasons, by id, of skipped comparisons that agreed in the baseline."""
        cases = self.baseline.cases if self.baseline else ()
        agreed = {case.id for case in cases if case.verdict == "agree"}
        return {
            outcome.case.id: outcome.message
            for outcome in self.outcomes
            if outcome.verdict == "skipped" and outcome.case.id in agreed
        }

    def compared_with(self, baseline: RunRecord) -> RunComparison:
        """Changes since `baseline`.

        Cases of the baseline that this run requests and has not computed yet are not compared. With
        `--only`, cases that this run does not request are not compared either. Without it, they
        count as removed.
        """
        requested = {task.id for task in self.tasks}
        is_partial = "only" in self.header["options"]
        before = tuple(
            case
            for case in baseline.cases
            if case.id in self.done or not (is_partial or case.id in requested)
        )
        after = parse_run(self.as_json(), "results.json")
        return compare(msgspec.structs.replace(baseline, cases=before), after)

    @property
    def matrices(self) -> tuple[Matrix, ...]:
        """Matrices of verdicts against computed references, then against measured values."""
        return tuple(matrix for matrix in (self.matrix, self.measured) if matrix)

    @property
    def refused(self) -> tuple[str, ...]:
        """Models relied on that are inadequate in some matrix, in the order of `rely`.

        If `strict`, models with undecided verdicts are included. If `strict` and the assessments
        gave no matrix, all models relied on are returned.
        """
        if not self.matrices:
            return tuple(self.rely) if self.strict and {ADEQUACY, MEASURED} & set(self.done) else ()
        refused = {
            model
            for matrix in self.matrices
            for model in matrix.fails(self.rely, strict=self.strict)
        }
        return tuple(model for model in self.rely if model in refused)

    @property
    def standing(self) -> Standing:
        """Verdict on the run, with its sentence and exit code."""
        return standing_of(self.tasks, self.done, self.refused, strict=self.strict)

    def as_json(self) -> str:
        """Text of results.json."""
        header = dict(self.header) | {"unfinished": self.unfinished}
        return run_json(run_record(header, self.outcomes, self.matrices, self.figures))
