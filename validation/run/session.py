"""A run from start to end: choose the cases, compute them, keep and publish what comes out."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import msgspec

from fem.machine import usable_cores
from lumped.audit.finding import Finding
from lumped.audit.robot_audit import audit
from lumped.errors import InputError
from lumped.robot_file import RobotFile
from validation.adequacy.assessment import ADEQUACY, MEASURED, Assessed
from validation.adequacy.matrix import Matrix
from validation.case import Outcome
from validation.cases.sweep_results import FOLDER_OPTION, GROUP, studies_read
from validation.console.streams import complain
from validation.context import Preset
from validation.exhibits import Figure
from validation.export import export
from validation.faults.detection import Power, comparisons, detection_power
from validation.report.page import Report, render
from validation.results import provenance
from validation.results.compare import Comparison, compare
from validation.results.drift import Drift, drifts
from validation.results.freeze import built_in_frozen, frozen_values
from validation.results.junit import junit_xml
from validation.results.records import (
    Done,
    Drawn,
    Record,
    Task,
    from_record,
    results,
    still_holding,
)
from validation.results.saved_run import SavedRun, load_run, parse_run
from validation.run import progress, runner
from validation.run.worker import Job
from validation.store.opening import Start, open_folder
from validation.store.run_folder import RunFolder
from validation.sweeps.cluster import on_cluster
from validation.sweeps.studies import precompute

Catalogue = Callable[[RobotFile], Sequence[Task]]


@dataclass(frozen=True)
class Request:
    """What the user asks for.

    `only` is a shell-style pattern of ids. `baseline` is the folder or results.json of an earlier
    run to be compared with. `exports`: whether meshes, fields and matrices are wanted as files.
    `cluster` is the address of a Dask scheduler that computes the sweeps. `asked` are options that
    changed the robot file's requirement, as typed; `strict`: undecided counts as inadequate.
    """

    robot_file: RobotFile
    preset: Preset
    out: Path
    jobs: int
    only: str | None = None
    start: Start = "afresh"
    baseline: Path | None = None
    exports: bool = False
    faults: bool = False
    cluster: str | None = None
    asked: Mapping[str, str] = field(default_factory=dict)
    strict: bool = False


@dataclass
class Results:
    """What has been finished so far, by id, in the order of the catalogue.

    `baseline` is the earlier run that the user names, `frozen` the one that drift is counted from:
    the baseline or, without one, what is kept of a built-in robot. `path` is where the report is:
    beside an earlier run's as long as this one is not finished. `remarks` say what was found in
    the folder that is not as it should be. `rely` names the models that must be adequate, `strict`
    tells whether undecided is not enough.
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

    def add(self, record: Record) -> None:
        """Take in a finished piece of work."""
        task = next(task for task in self.tasks if task.id == record["id"])
        self._take(task.id, from_record(task, record))

    def take_up(self, folder: RunFolder) -> None:
        """Take in what an earlier process finished in the folder, as far as it still holds."""
        for task in self.tasks:
            record = folder.record(task.id)
            done = still_holding(task, record) if record is not None else None
            if done is not None:
                self._take(task.id, done)

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
        return len(self.tasks) - len(self.outcomes) - len(self.drawn) - len(self.assessed)

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
        part = "only" in self.header["options"]
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
        header = dict(self.header) | {"unfinished": self.unfinished}
        content = results(header, comparisons(self.in_order()), self.drifts, self.matrices)
        if power := self.power:
            content["faults"] = power.records()
        # Written after every case: Python's own encoder would take longer than the cases.
        return msgspec.json.format(msgspec.json.encode(content), indent=1).decode() + "\n"


def validate(request: Request, catalogue: Catalogue) -> Results:
    """Run the chosen cases and write the run folder.

    Raises InputError before anything is written, StoreError where the disk refuses, and
    ComputationError where workers cannot start or the export fails.
    """
    robot_file = request.robot_file
    if robot_file.is_mechanism:
        _refuse_what_biglides_have(request)
    tasks = runner.select(catalogue(robot_file), request.preset, request.only)
    options = {**({"only": request.only} if request.only else {}), **request.asked}
    header = provenance.header(robot_file, request.preset, options)
    # Before the run, so that after Ctrl-C only the page is left to be written.
    findings = audit(robot_file)
    # Read before anything is written: the folder may be the baseline's own.
    baseline = load_run(request.baseline) if request.baseline else None
    frozen = baseline or built_in_frozen(robot_file, request.preset)
    with ExitStack() as stack:
        executor = None
        if request.cluster is not None:
            executor = stack.enter_context(on_cluster(request.cluster, _mention))
        folder = stack.enter_context(open_folder(request.out, header, request.start))
        sweeps = folder.path / "sweeps"
        job = Job(catalogue, robot_file, request.preset, options | {FOLDER_OPTION: str(sweeps)})
        header |= {"seconds": 0.0, "planned": len(tasks)} | folder.begun()
        header |= {"frozen_from": _named(frozen)}
        gathered = Results(
            header,
            tasks,
            baseline,
            frozen,
            path=folder.path,
            rely=robot_file.requirement.rely,
            strict=request.strict,
        )
        gathered.take_up(folder)
        gathered.remarks = folder.remarks
        if executor is not None and any(task.group == GROUP for task in tasks):
            with progress.stage("sweeps on the cluster"):
                studies = studies_read(request.preset)
                precompute(robot_file.robot, request.preset, sweeps, executor, studies)
        _compute(job, gathered, folder, request.jobs)
        with progress.stage("writing the report"):
            publish(gathered, folder, findings)
        if request.exports and not gathered.unfinished:
            with (
                progress.stage("exporting meshes, modes and matrices"),
                folder.replacing("export") as target,
            ):
                export(robot_file.robot, request.preset, target)
        folder.complete = not gathered.unfinished
    if folder.complete:
        gathered.path = request.out
    return gathered


def default_jobs() -> int:
    """As many processes as this one may use cores."""
    return usable_cores()


def publish(gathered: Results, folder: RunFolder, findings: Sequence[Finding]) -> None:
    """Write junit.xml, figures/ (all that the report shows) and report.html."""
    outcomes = gathered.in_order()
    folder.write("results.json", gathered.as_json())
    folder.write("junit.xml", junit_xml(outcomes, f"flexproof {gathered.header['robot']}"))
    report = Report(
        outcomes=tuple(comparisons(outcomes)),
        figures=tuple(gathered.all_figures()),
        missing_figures=tuple(gathered.missing_figures()),
        findings=tuple(findings),
        provenance=gathered.header,
        matrix=gathered.matrix,
        measured=gathered.measured,
        unjudged=next((one.message for one in gathered.assessed.values() if one.message), ""),
        unfinished=gathered.unfinished,
        drifts=gathered.drifts,
        power=gathered.power,
    )
    for figure in report.shown:
        for name, content in figure.files.items():
            folder.write(f"figures/{name}", content)
    folder.write("report.html", render(report))


def _refuse_what_biglides_have(request: Request) -> None:
    """Raise InputError for options that have nothing to do for a mechanism."""
    refused = {
        "--export: the files for other programs are written for a biglide (schema 1) alone": (
            request.exports
        ),
        "--faults: the faults are those that a biglide's run has to catch; run one of schema 1": (
            request.faults
        ),
        "--cluster: a mechanism's run has no sweeps": request.cluster is not None,
    }
    if faults := [fault for fault, asked in refused.items() if asked]:
        raise InputError(faults)


def _mention(line: str) -> None:
    complain([line], 0)


def _named(frozen: SavedRun | None) -> str | None:
    if frozen is None:
        return None
    return f"run of {frozen.run['started']}" if "started" in frozen.run else "kept with the program"


def _compute(job: Job, gathered: Results, folder: RunFolder, jobs: int) -> None:
    begun = perf_counter() - gathered.header["seconds"]

    def keep(record: Record) -> None:
        folder.keep(record)
        gathered.add(record)
        gathered.header = dict(gathered.header) | {"seconds": perf_counter() - begun}
        folder.write("results.json", gathered.as_json())

    done = gathered.outcomes.keys() | gathered.drawn.keys() | gathered.assessed.keys()
    waiting = [task for task in gathered.tasks if task.id not in done]
    with progress.showing(waiting) as observer:
        runner.run(job, waiting, jobs=jobs, log=folder.log, keep=keep, observer=observer)
