"""A run from start to end: select tasks, compute them, record the results and write the report.

Input: a `Request`, with robot file and options. Output: `Results`, and a folder with report.html,
results.json, junit.xml and figures.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from shlex import join
from time import perf_counter
from typing import TYPE_CHECKING

from lumped.acceptance.measured import digest
from lumped.acceptance.requirement import SMALLEST_SHARE
from lumped.audit import Finding, audit
from lumped.errors import ComputationError, InputError
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from lumped.robot_file.evidence import with_options
from lumped.robot_file.variation import Variation
from validation.console.progress import stage
from validation.console.streams import is_quiet, write_message
from validation.context import Context, Preset
from validation.paper.errata import paper_findings
from validation.report.listing import junit_xml
from validation.report.page import Report, render
from validation.report.words import sentence
from validation.run import progress, provenance, runner
from validation.run.cache import Arrays, available_cache
from validation.run.executor import Executor, on_cores
from validation.run.folder import RunFolder, Start, open_folder
from validation.run.outcome import Record, Task
from validation.run.provenance import last_selftest
from validation.run.provisions import Provisions, provisions
from validation.run.records import RunRecord, load_run
from validation.run.results import Results
from validation.solve.cost import PER_PART
from validation.uncertainty.refinement import accuracy_faults
from validation.verdicts import ADEQUACY, MEASURED, MEASURED_RESPONSE

if TYPE_CHECKING:
    from validation.run.cluster import Cluster

# Pause between two writes of results.json, as a multiple of the time of one write.
_WRITE_PAUSE = 20.0
# Time (s) of an idle core for one unit of effort.
_SECONDS_PER_EFFORT: Mapping[Preset, float] = {"quick": 0.25, "standard": 0.4, "fine": 1.5}
# Options that the command to resume a run repeats, besides --preset and --out.
_REPEATED_OPTIONS = (
    "only",
    "baseline",
    "export",
    "cluster",
    "accept",
    "rely",
    "vary",
    "accuracy",
    "inputs",
    "measured",
    "strict",
)


@dataclass(frozen=True)
class Request:
    """Request of the user for a run, with the options of the command.

    `only`: shell-style pattern of ids. `baseline`: folder or results.json of an earlier run for
    comparison. `export`: True if meshes, fields and matrices are written to files. `cluster`:
    address of a Dask scheduler whose workers compute everything. `accept`, `rely`, `accuracy`
    (see `Requirement`), `inputs` (see `RobotFile.supposed`) and the file of `measured` values
    extend the robot file. `strict`: undecided counts as inadequate.
    """

    robot: RobotFile
    preset: Preset
    out: Path
    jobs: int
    only: str | None = None
    start: Start = "afresh"
    baseline: Path | None = None
    export: bool = False
    cluster: str | None = None
    accept: Sequence[str] = ()
    rely: Sequence[str] = ()
    accuracy: float | None = None
    inputs: float | None = None
    measured: Path | None = None
    vary: Sequence[str] = ()
    strict: bool = False

    @cached_property
    def robot_file(self) -> RobotFile:
        """Robot file with the changes by the options. Raises InputError for invalid options."""
        robot_file = self.robot
        if self.measured:
            from validation.measured.modes import with_measured_file  # noqa: PLC0415

            robot_file = with_measured_file(robot_file, self.measured)
        faults = [] if self.accuracy is None else accuracy_faults(self.accuracy)
        if self.inputs is not None and not SMALLEST_SHARE <= self.inputs <= 0.5:
            faults.append(
                f"--inputs = {self.inputs:g}: must be from {SMALLEST_SHARE:g} to 0.5 (5 % is 0.05)"
            )
        if self.inputs is not None and robot_file.uncertain_inputs:
            faults.append(
                "--inputs: the robot file has [[input_uncertainty]] already; leave --inputs out"
            )
        if faults:
            raise InputError(faults)
        requirement = with_options(
            robot_file.requirement, self.accept, self.rely, robot_file.mechanism.lengths
        )
        if self.accuracy is not None:
            requirement = replace(requirement, accuracy=self.accuracy)
        supposed = robot_file.supposed if self.inputs is None else self.inputs
        return replace(robot_file, requirement=requirement, supposed=supposed)

    @cached_property
    def variations(self) -> tuple[Variation, ...]:
        """Variations of `vary`. Raises InputError if a varied robot is invalid."""
        if not self.vary:
            return ()
        from validation.variations.curves import checked_variations  # noqa: PLC0415

        return checked_variations(self.robot_file, self.vary, self.preset)

    @property
    def options(self) -> Mapping[str, str]:
        """Options as text, for the header of the run."""
        texts = {
            "only": self.only,
            "accept": " ".join(self.accept),
            "rely": " ".join(self.rely),
            "measured": digest(self.robot_file.measured) if self.measured else "",
            "vary": " ".join(self.vary),
            "accuracy": f"{self.accuracy:g}" if self.accuracy else "",
            "inputs": f"{self.inputs:g}" if self.inputs else "",
        }
        return {option: text for option, text in texts.items() if text}

    @property
    def resume_command(self) -> str:
        """Command that resumes an interrupted run of this request."""
        command = ["flexproof", "run", self.robot.source, "--preset", self.preset]
        for option in _REPEATED_OPTIONS:
            value = getattr(self, option)
            for entry in value if isinstance(value, list | tuple) else [value]:
                if entry is True:
                    command.append(f"--{option}")
                elif entry:
                    text = f"{entry:g}" if isinstance(entry, float) else str(entry)
                    command += [f"--{option}", text]
        return join([*command, "--out", str(self.out), "--resume"])


def validate(request: Request, catalogue: runner.Catalogue) -> Results:
    """Compute the selected tasks and write the run folder.

    Raises InputError before anything is written, StoreError if the disk cannot be written, and
    ComputationError if workers cannot start or the export fails.
    """
    robot_file, preset = request.robot_file, request.preset
    if request.export:
        _refuse_large_exports(request)
    if request.variations:
        catalogue = partial(catalogue, variations=request.variations)
    all_tasks = catalogue(robot_file)
    # Measured values of the command line are compared even if --only excludes them.
    always = (MEASURED, MEASURED_RESPONSE) if request.measured else ()
    tasks = runner.select(all_tasks, preset, request.only, always)
    header = provenance.header(robot_file, preset, request.options)
    # Computed before the run, so that after Ctrl-C only the page must be written.
    findings = (*audit(robot_file), *paper_findings(robot_file))
    # Read before anything is written, because the baseline can be in the same folder.
    baseline = _read_baseline(request)
    with ExitStack() as stack:
        executor: Cluster | None = None
        if request.cluster is not None:
            from validation.run.cluster import on_cluster  # noqa: PLC0415

            executor = stack.enter_context(on_cluster(request.cluster, write_message))
        folder = stack.enter_context(open_folder(request.out, header, request.start))
        stack.enter_context(available_cache())
        header |= {"seconds": 0.0, "planned": len(tasks)} | folder.begun
        header |= {"selftest": last_selftest(header)}
        results = Results(
            header,
            tasks,
            baseline,
            path=folder.path,
            rely=robot_file.requirement.rely,
            strict=request.strict,
        )
        results.add_records(folder.records)
        results.remarks = folder.remarks
        if request.variations and (executor is not None or request.jobs > 1):
            with stage("robots of --vary"):
                _solve_varied_robots(request, tasks, executor)
        if any(task.id not in results.done for task in tasks):
            _prepare_parts(request, executor)
        _compute_tasks(request, catalogue, results, folder, executor)
        with stage("writing the report"):
            publish(results, folder, findings)
        if request.export and not results.unfinished:
            from validation.export.files import export_mechanism  # noqa: PLC0415

            with (
                stage("exporting meshes, modes and matrices"),
                folder.exporting() as target,
            ):
                export_mechanism(robot_file.mechanism, preset, target)
        folder.complete = not results.unfinished
    if folder.complete:
        results.path = request.out
    return results


def publish(results: Results, folder: RunFolder, findings: Sequence[Finding]) -> None:
    """Write junit.xml, figures/ (figures and tables of the report) and report.html."""
    report = Report(results, findings)
    contents = [report.tables, *(figure.files for figure in report.shown)]
    figures = {f"figures/{name}": content for files in contents for name, content in files.items()}
    junit = junit_xml(report.outcomes, f"flexproof {results.header['robot']}")
    page = {"report.html": render(report)}
    folder.write({"results.json": results.as_json(), "junit.xml": junit, **figures, **page})


# Modules that few runs need are imported when needed, so that the other runs start sooner.
@contextmanager
def _executor(cluster: Executor | None, jobs: int) -> Iterator[Executor]:
    """Context manager that yields an executor: the `cluster`, or `jobs` processes on this machine.

    An error of the cluster is raised. An error of a local computation is suppressed, because the
    run computes a missing result again and then reports the error.
    """
    if cluster is not None:
        yield cluster
        return
    with suppress(ComputationError, InputError), on_cores(jobs) as cores:
        yield cores


def _solve_varied_robots(request: Request, tasks: Sequence[Task], cluster: Executor | None) -> None:
    """Solve the robots of --vary, if their cases or figures are among the tasks."""
    from validation.variations.curves import variation_study  # noqa: PLC0415

    groups = {task.group for task in tasks}
    for number, variation in enumerate(request.variations, start=1):
        if f"vary.{number}" in groups:
            with _executor(cluster, request.jobs) as executor, suppress(InputError):
                variation_study(request.robot_file, variation, request.preset, executor)


def _read_baseline(request: Request) -> RunRecord | None:
    """Earlier run for comparison. None if the request has no baseline.

    Raises InputError if it is a run of another robot.
    """
    if request.baseline is None:
        return None
    baseline = load_run(request.baseline)
    baseline_robot, name = baseline.run.get("robot"), request.robot_file.name
    if baseline_robot and baseline_robot != name:
        raise InputError(
            f'--baseline {request.baseline}: is a run of another robot, "{baseline_robot}"; '
            f'must be a run of "{name}"'
        )
    return baseline


def _prepare_parts(request: Request, cluster: Executor | None) -> None:
    """Mesh and reduce the CAD parts of a mechanism, and store the results in the cache."""
    if not request.robot_file.mechanism.parts:
        return
    # Imported here: loads meshers and solvers, which most runs do not need.
    from validation.references.part_preparation import prepare_parts  # noqa: PLC0415

    context = Context(request.robot_file, request.preset)
    parts = len(request.robot_file.mechanism.parts)
    progress_stage = stage("meshing and reducing parts", PER_PART * parts / request.jobs)
    with progress_stage, _executor(cluster, request.jobs) as executor:
        prepare_parts(context, executor, remote=cluster is not None)


def _provisions(request: Request, context: Context) -> Provisions:
    """Files and cache entries that tasks need on other machines: parts and robots of --vary."""
    entries: dict[str, Arrays] = {}
    if context.robot_file.mechanism.parts:
        from validation.references.part_preparation import prepared_entries  # noqa: PLC0415

        entries |= prepared_entries(context)
    if request.variations:
        from validation.variations.curves import stored_robots  # noqa: PLC0415

        for variation in request.variations:
            entries |= stored_robots(context.robot_file, variation, request.preset)
    return provisions(context.robot_file, entries)


def _refuse_large_exports(request: Request) -> None:
    """Raise InputError for legs whose solids are too large to be written."""
    from validation.export.files import DIVISIONS  # noqa: PLC0415
    from validation.solids.solid_size import too_large  # noqa: PLC0415

    legs = list(legs_of(request.robot_file.mechanism).values())
    reason = too_large(legs, len(legs) * (DIVISIONS[request.preset],), request.preset)
    if reason:
        raise InputError(f"--export: {reason}")


def _compute_tasks(
    request: Request,
    catalogue: runner.Catalogue,
    results: Results,
    folder: RunFolder,
    cluster: "Cluster | None",
) -> None:
    begun = perf_counter() - results.header["seconds"]
    due = 0.0

    def keep(record: Record) -> None:
        nonlocal due
        now = perf_counter()
        folder.keep(record, now - begun)
        results.add(record)
        if record["id"] == ADEQUACY and results.matrix and not is_quiet():
            # The verdict is known long before the report is complete.
            write_message(sentence(results.matrix, results.rely).replace("\N{NO-BREAK SPACE}", " "))
        results.header = dict(results.header) | {"seconds": now - begun}
        # The record is already stored. results.json is for readers during the run, and is written
        # less often as it grows.
        if now >= due:
            folder.write({"results.json": results.as_json()})
            due = now + (perf_counter() - now) * _WRITE_PAUSE

    waiting = [task for task in results.tasks if task.id not in results.done]
    context = Context(request.robot_file, request.preset, request.options)
    seconds = (
        _SECONDS_PER_EFFORT[request.preset] * sum(task.effort for task in waiting) / request.jobs
    )
    with progress.showing(waiting, seconds) as display:
        runner.run(
            catalogue,
            context,
            waiting,
            jobs=request.jobs,
            log=folder.log,
            cluster=cluster,
            sent=_provisions(request, context) if cluster else None,
            keep=keep,
            progress=display,
        )
