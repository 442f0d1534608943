"""What a run has gathered so far, and what it comes to: verdict, exit code, results.json."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from lumped.text import counted
from validation.case import Case
from validation.run.compare import RunComparison, compare, with_drift
from validation.run.outcome import (
    AnyResult,
    Outcome,
    Record,
    Task,
    Verdict,
    from_plain,
    still_holding,
)
from validation.run.records import CaseRecord, RunRecord, case_record, parse_run, run_record
from validation.studies_and_figures import Figure, PlannedFigure
from validation.verdicts import ADEQUACY, MEASURED, Matrix

_TROUBLED: tuple[Verdict, ...] = ("disagree", "undecided", "failed", "skipped")
_JUDGED = {ADEQUACY: "by finite elements", MEASURED: "against measured values"}


@dataclass(frozen=True)
class Standing:
    """What became of the tasks of a run.

    `comparisons`: how many have each verdict. `figures` and `assessments`: how many of them failed.
    `faults`: models, and other computations within an assessment, that ended with an error of the
    program.
    `refused`: models relied on that are not adequate. If `strict`, undecided is not enough.
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
        """0 nothing against it, 1 a case disagrees or a model relied on is inadequate, 3 a failure.

        A failure is anything that failed or was not computed. If strict, undecided is 1 too.
        """
        if self.failures:
            return 3
        wrong: tuple[Verdict, ...] = ("disagree", "undecided") if self.strict else ("disagree",)
        return 1 if self.refused or any(self.comparisons.get(one) for one in wrong) else 0

    @property
    def failures(self) -> int:
        """How many tasks, or models within one, failed or were not computed."""
        failed = self.comparisons.get("failed", 0) + len(self.faults)
        return failed + self.figures + self.assessments + self.unfinished

    @property
    def sentence(self) -> str:
        """The verdict on all comparisons, and what else failed."""
        agree = self.comparisons.get("agree", 0)
        judged = sum(self.comparisons.values()) - self.comparisons.get("skipped", 0)
        if judged == 0:
            sentence = "No comparison was made"
        elif agree == judged:
            sentence = f"All {judged} comparisons agree" if judged > 1 else "The comparison agrees"
        else:
            sentence = f"{agree} of {counted(judged, 'comparison')} agree"
        parts = [f"{count} {one}" for one in _TROUBLED if (count := self.comparisons.get(one))]
        assessments = ("assessment of the models", "assessments of the models")
        parts += [f"{counted(self.figures, 'figure')} failed"] if self.figures else []
        parts += [f"{counted(self.assessments, *assessments)} failed"] if self.assessments else []
        named = ", ".join(self.faults)
        parts += [f"failed by an error of the program: {named}"] if named else []
        parts += [f"{self.unfinished} not computed"] if self.unfinished else []
        return ", ".join([sentence, *parts]) + "."


def standing_of(
    tasks: Sequence[Task],
    done: Mapping[str, AnyResult],
    refused: tuple[str, ...] = (),
    *,
    strict: bool = False,
) -> Standing:
    """Where the tasks stand of which these are `done`, by id."""
    failed = [one for one in tasks if one.id in done and done[one.id].verdict == "failed"]
    matrices = [one.found for one in done.values() if isinstance(one.found, Matrix)]
    figures = sum(isinstance(one, PlannedFigure) for one in failed)
    cases = sum(isinstance(one, Case) for one in failed)
    return Standing(
        comparisons=Counter(
            done[one.id].verdict for one in tasks if isinstance(one, Case) and one.id in done
        ),
        figures=figures,
        assessments=len(failed) - figures - cases,
        unfinished=len(tasks) - len(done),
        faults=tuple(dict.fromkeys(fault for one in matrices for fault in one.all_faults)),
        refused=refused,
        strict=strict,
    )


@dataclass
class Results:
    """What has been finished so far, by id.

    `baseline` is the earlier run that drift is counted from, where the user names one. `path` is
    where the report is: beside an earlier run's as long as this one is not finished. `remarks` say
    what was found in the folder that is not as it should be. `rely` names the models that must be
    adequate, `strict` tells whether undecided is not enough.
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
        """Take in a finished piece of work."""
        task = next(task for task in self.tasks if task.id == record["id"])
        self.done[task.id] = from_plain(task, record)

    def take_up(self, records: Mapping[str, Record]) -> None:
        """Take in, by id, what an earlier process finished, as far as it still holds."""
        for task in self.tasks:
            if task.id in records and (result := still_holding(task, records[task.id])):
                self.done[task.id] = result

    @property
    def outcomes(self) -> list[Outcome]:
        """The outcomes in the order of the catalogue."""
        return [
            Outcome(task, self.done[task.id])
            for task in self.tasks
            if isinstance(task, Case) and task.id in self.done
        ]

    @property
    def figures(self) -> list[Figure]:
        """The figures that were drawn, in the order of the catalogue."""
        found = (self.done[task.id].found for task in self.tasks if task.id in self.done)
        return [one for one in found if isinstance(one, Figure)]

    @property
    def missing_figures(self) -> list[tuple[PlannedFigure, str]]:
        """The figures that were asked for and could not be drawn, or not as a picture, and why."""
        planned = [task for task in self.tasks if isinstance(task, PlannedFigure)]
        said = [(task, self.done[task.id].message) for task in planned if task.id in self.done]
        return [(task, message) for task, message in said if message]

    @property
    def unjudged(self) -> list[str]:
        """Why the models could not be judged, by finite elements or against measured values."""
        made = [(by, self.done.get(name)) for name, by in _JUDGED.items()]
        return [
            f"No model was judged {by}: {one.message}" for by, one in made if one and one.message
        ]

    @property
    def unfinished(self) -> int:
        """How many tasks have not been computed."""
        return len(self.tasks) - len(self.done)

    @property
    def matrix(self) -> Matrix | None:
        """The adequacy of the robot's models, None where it was not, or could not be, assessed."""
        return self._matrix(ADEQUACY)

    @property
    def measured(self) -> Matrix | None:
        """The models against measured values, where there are any."""
        return self._matrix(MEASURED)

    def _matrix(self, name: str) -> Matrix | None:
        found = self.done[name].found if name in self.done else None
        return found if isinstance(found, Matrix) else None

    @property
    def records(self) -> list[CaseRecord]:
        """The outcomes with how far their values have moved from those of the baseline."""
        earlier = self.baseline.by_id if self.baseline else {}
        return [with_drift(case_record(o), earlier.get(o.case.id)) for o in self.outcomes]

    @property
    def no_longer_compared(self) -> dict[str, str]:
        """Comparisons that agreed in the baseline, are skipped now and protect nothing: why."""
        cases = self.baseline.cases if self.baseline else ()
        agreed = {case.id for case in cases if case.verdict == "agree"}
        return {
            outcome.case.id: outcome.message
            for outcome in self.outcomes
            if outcome.verdict == "skipped" and outcome.case.id in agreed
        }

    def compared_with(self, baseline: RunRecord) -> RunComparison:
        """What changed since `baseline`, as far as its cases were to be run this time."""
        asked = {task.id for task in self.tasks}
        part = "only" in self.header["options"]
        before = tuple(
            case
            for case in baseline.cases
            if case.id in self.done or not (part or case.id in asked)
        )
        after = parse_run(self.as_json(), "results.json")
        return compare(msgspec.structs.replace(baseline, cases=before), after)

    @property
    def matrices(self) -> tuple[Matrix, ...]:
        """What is known of the models, by computed references first, then by measured ones."""
        return tuple(matrix for matrix in (self.matrix, self.measured) if matrix)

    @property
    def refused(self) -> tuple[str, ...]:
        """Models relied on that are not adequate by any matrix there is.

        All of them if strict, and models were to be judged and no matrix came of it.
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
        """What the run comes to: the sentence on it and its exit code."""
        return standing_of(self.tasks, self.done, self.refused, strict=self.strict)

    def as_json(self) -> str:
        """The text of results.json."""
        # Written after every case: Python's own encoder would take longer than the cases.
        return msgspec.json.format(msgspec.json.encode(self._record()), indent=1).decode() + "\n"

    def _record(self) -> RunRecord:
        header = dict(self.header) | {"unfinished": self.unfinished}
        return run_record(header, self.records, self.outcomes, self.matrices, self.figures)
