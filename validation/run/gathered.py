"""What a run has gathered so far, and what it comes to: verdict, exit code, results.json."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec

from validation.adequacy.assessment import ADEQUACY, MEASURED, Assessed
from validation.adequacy.matrix import Matrix
from validation.case import Outcome
from validation.exhibits import Figure
from validation.report.detection import Power, comparisons, detection_power
from validation.results.compare import Comparison, compare
from validation.results.drift import Drift, drifts
from validation.results.freeze import frozen_values
from validation.results.records import (
    Done,
    Drawn,
    Record,
    Task,
    from_record,
    is_check,
    results,
    still_holding,
)
from validation.results.saved_run import SavedRun, parse_run
from validation.run.kept_checks import CHECKED, Kept
from validation.store.run_folder import RunFolder


@dataclass
class Results:
    """What has been finished so far, by id, in the order of the catalogue.

    `baseline` is the earlier run that the user names, `frozen` the one that drift is counted from:
    the baseline or, without one, what is kept of a built-in robot. `path` is where the report is:
    beside an earlier run's as long as this one is not finished. `remarks` say what was found in
    the folder that is not as it should be. `rely` names the models that must be adequate, `strict`
    tells whether undecided is not enough. `checked` tells when those checks of the program were
    made that are taken from an earlier run.
    """

    header: Mapping[str, Any]
    tasks: Sequence[Task]
    baseline: SavedRun | None = None
    frozen: SavedRun | None = None
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    drawn: dict[str, Drawn] = field(default_factory=dict)
    assessed: dict[str, Assessed] = field(default_factory=dict)
    path: Path = Path()
    remarks: Sequence[str] = ()
    rely: Sequence[str] = ()
    strict: bool = False
    checked: dict[str, str] = field(default_factory=dict)

    def add(self, record: Record) -> Task:
        """Take in a finished piece of work; the task that it was."""
        task = next(task for task in self.tasks if task.id == record["id"])
        self._take(task.id, from_record(task, record))
        return task

    def take_up(self, folder: RunFolder) -> None:
        """Take in what an earlier process finished in the folder, as far as it still holds."""
        for task in self.tasks:
            record = folder.record(task.id)
            done = still_holding(task, record) if record is not None else None
            if done is not None:
                self._take(task.id, done)

    def take_kept(self, kept: Kept) -> None:
        """Take in the checks of the program that an earlier run made, as far as they still hold."""
        records = kept.records()
        for task in self.tasks:
            if not is_check(task) or task.id in self.done or task.id not in records:
                continue
            done = still_holding(task, records[task.id])
            if done is not None:
                self._take(task.id, done)
                self.checked[task.id] = str(records[task.id].get(CHECKED, ""))

    @property
    def done(self) -> set[str]:
        """Ids of what is finished."""
        return {*self.outcomes, *self.drawn, *self.assessed}

    @property
    def selftest(self) -> Mapping[str, Any] | None:
        """The program's checks: how many are kept ones, how many this run's, since when they hold.

        None where this run has none of them.
        """
        checks = [task.id for task in self.tasks if is_check(task) and task.id in self.done]
        if not checks:
            return None
        kept = [self.checked[name] for name in checks if name in self.checked]
        own = [self.header["started"]] if len(kept) < len(checks) else []
        return {
            "checked": min([*kept, *own]),
            "kept": len(kept),
            "computed": len(checks) - len(kept),
        }

    def _take(self, identifier: str, done: Done) -> None:
        match done:
            case Outcome():
                self.outcomes[identifier] = done
            case Drawn():
                self.drawn[identifier] = done
            case Assessed():
                self.assessed[identifier] = done

    def in_order(self) -> list[Outcome]:
        """The outcomes in the order of the catalogue."""
        return [self.outcomes[task.id] for task in self.tasks if task.id in self.outcomes]

    def all_figures(self) -> list[Figure]:
        """The figures that were drawn, in the order of the catalogue."""
        drawn = [self.drawn[task.id] for task in self.tasks if task.id in self.drawn]
        return [one.figure for one in drawn if one.figure]

    def missing_figures(self) -> list[Drawn]:
        """The figures that were asked for and could not be drawn, or not as a picture."""
        return [drawn for drawn in self.drawn.values() if drawn.message]

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
        made = self.assessed.get(name)
        return made.matrix if made else None

    @property
    def drifts(self) -> dict[str, Drift]:
        """How far the values have moved from the frozen ones, by case id."""
        return drifts(self.in_order(), frozen_values(self.frozen)) if self.frozen else {}

    @property
    def power(self) -> Power | None:
        """What became of the faults, where the run injects any."""
        found = detection_power(self.in_order())
        return found if found.detections else None

    def compared_with(self, baseline: SavedRun) -> Comparison:
        """What changed since `baseline`, as far as its cases were to be run this time."""
        asked = {task.id for task in self.tasks}
        part = not {"only", "selftest"}.isdisjoint(self.header["options"])
        before = tuple(
            case
            for case in baseline.cases
            if case.id in self.outcomes or not (part or case.id in asked)
        )
        return compare(replace(baseline, cases=before), parse_run(self.as_json(), "results.json"))

    @property
    def matrices(self) -> tuple[Matrix, ...]:
        """What is known of the models, by computed references first, then by measured ones."""
        return tuple(matrix for matrix in (self.matrix, self.measured) if matrix)

    @property
    def refused(self) -> tuple[str, ...]:
        """Models relied on that are not adequate; all of them where strict and nothing is known."""
        if self.matrix is None:
            return tuple(self.rely) if self.strict and self.assessed else ()
        refused = {
            model
            for matrix in self.matrices
            for model in matrix.fails(self.rely, strict=self.strict)
        }
        return tuple(model for model in self.rely if model in refused)

    def exit_code(self) -> int:
        """0 nothing against it, 1 a case disagrees or a model relied on is inadequate, 3 a failure.

        A failure is a computation that failed or was interrupted. Where strict, undecided is 1 too.
        """
        verdicts = {outcome.verdict for outcome in self.outcomes.values()}
        failed = "failed" in verdicts or any(drawn.failed for drawn in self.drawn.values())
        failed = failed or any(one.failed for one in self.assessed.values())
        if failed or self.unfinished:
            return 3
        wrong = {"disagree", "undecided"} if self.strict else {"disagree"}
        return 1 if verdicts & wrong or self.refused else 0

    def as_json(self) -> str:
        """The text of results.json."""
        header = dict(self.header) | {"unfinished": self.unfinished, "selftest": self.selftest}
        content = results(header, comparisons(self.in_order()), self.drifts, self.matrices)
        if power := self.power:
            content["faults"] = power.records()
        # Written after every case: Python's own encoder would take longer than the cases.
        return msgspec.json.format(msgspec.json.encode(content), indent=1).decode() + "\n"
