"""A run from start to end: choose the cases, compute them, keep and publish what comes out."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter

from lumped.audit.finding import Finding
from lumped.audit.robot_audit import audit
from lumped.errors import ComputationError, InputError
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.adequacy.matrix import MEASURED
from validation.console.streams import mention
from validation.context import Context, Preset
from validation.paper.errata import paper_findings
from validation.report.page import Report, render
from validation.results.junit import junit_xml
from validation.results.records import RunRecord, load_run
from validation.results.tasks import Record, Task
from validation.run import provenance
from validation.run.cache import some_cache
from validation.run.executor import Executor, on_cores
from validation.run.folder import RunFolder
from validation.run.opening import Start, open_folder
from validation.selftest.record import last as last_selftest
from validation.session import progress, runner
from validation.session.gathered import Results
from validation.session.worker import Job

# How many times as long as results.json takes to write it is left alone.
_SPARING = 20.0
Catalogue = Callable[..., Sequence[Task]]


@dataclass(frozen=True)
class Request:
    """What the user asks for.

    `only` is a shell-style pattern of ids. `baseline` is the folder or results.json of an earlier
    run to be compared with. `exports`: whether meshes, fields and matrices are wanted as files.
    `variations` are numbers of the robot file with values that have been checked. `cluster` is the
    address of a Dask scheduler that computes the robots of these and parts. `asked` are options
    that changed the robot file, as typed; `measured` is the file of measured values named with
    them, of which `asked` has a digest; `strict`: undecided counts as inadequate.
    """

    robot_file: RobotFile
    preset: Preset
    out: Path
    jobs: int
    only: str | None = None
    start: Start = "afresh"
    baseline: Path | None = None
    exports: bool = False
    cluster: str | None = None
    asked: Mapping[str, str] = field(default_factory=dict)
    strict: bool = False
    variations: tuple[Variation, ...] = ()
    measured: Path | None = None

    @property
    def options(self) -> Mapping[str, str]:
        """What the header of the run says of all this."""
        only = {"only": self.only} if self.only else {}
        return {**only, **self.asked}


def validate(request: Request, catalogue: Catalogue) -> Results:
    """Run the chosen cases and write the run folder.

    Raises InputError before anything is written, StoreError where the disk refuses, and
    ComputationError where workers cannot start or the export fails.
    """
    robot_file = request.robot_file
    if request.cluster is not None and not (request.variations or robot_file.mechanism.parts):
        raise InputError(
            "--cluster: computes the robots of --vary and the parts of a mechanism; this run has "
            "neither"
        )
    if request.exports:
        _refuse_large_exports(request)
    if request.variations:
        catalogue = partial(catalogue, variations=request.variations)
    listed = catalogue(robot_file)
    # Whoever names measured values in the command wants to see them, whatever else is left out.
    always = (MEASURED,) if request.measured else ()
    tasks = runner.select(listed, request.preset, request.only, always)
    options = request.options
    header = provenance.header(robot_file, request.preset, options)
    # Before the run, so that after Ctrl-C only the page is left to be written.
    findings = (*audit(robot_file), *paper_findings(robot_file))
    # Read before anything is written: the folder may be the baseline's own.
    baseline = _baseline(request)
    with ExitStack() as stack:
        executor = None
        if request.cluster is not None:
            from validation.run.cluster import on_cluster  # noqa: PLC0415

            executor = stack.enter_context(on_cluster(request.cluster, mention))
        folder = stack.enter_context(open_folder(request.out, header, request.start))
        stack.enter_context(some_cache())
        job = Job(catalogue, robot_file, request.preset, options)
        header |= {"seconds": 0.0, "planned": len(tasks)} | folder.begun
        header |= {"selftest": last_selftest(header)}
        gathered = Results(
            header,
            tasks,
            baseline,
            path=folder.path,
            rely=robot_file.requirement.rely,
            strict=request.strict,
        )
        gathered.take_up(folder)
        gathered.remarks = folder.remarks
        if request.variations and (executor is not None or request.jobs > 1):
            with progress.stage("robots of --vary"):
                _vary(request, tasks, executor)
        if any(task.id not in gathered.done for task in tasks):
            _prepare(robot_file, request.preset, executor, request.jobs)
        _compute(job, gathered, folder, request.jobs)
        with progress.stage("writing the report"):
            publish(gathered, folder, findings)
        if request.exports and not gathered.unfinished:
            from validation.export.mechanism import export_mechanism  # noqa: PLC0415

            with (
                progress.stage("exporting meshes, modes and matrices"),
                folder.exporting() as target,
            ):
                export_mechanism(robot_file.mechanism, request.preset, target)
        folder.complete = not gathered.unfinished
    if folder.complete:
        gathered.path = request.out
    return gathered


def publish(gathered: Results, folder: RunFolder, findings: Sequence[Finding]) -> None:
    """Write junit.xml, figures/ (all that the report shows) and report.html."""
    outcomes = gathered.in_order()
    report = Report(
        outcomes=tuple(outcomes),
        figures=tuple(gathered.all_figures()),
        missing_figures=tuple(gathered.missing_figures()),
        findings=tuple(findings),
        provenance=gathered.header,
        matrix=gathered.matrix,
        measured=gathered.measured,
        unjudged=next(iter(gathered.unjudged()), ""),
        unfinished=gathered.unfinished,
        drifts=gathered.drifts,
        no_longer_compared=gathered.no_longer_compared,
        rely=gathered.rely,
    )
    figures = {
        f"figures/{name}": content
        for figure in report.shown
        for name, content in figure.files.items()
    }
    junit = junit_xml(outcomes, f"flexproof {gathered.header['robot']}")
    page = {"report.html": render(report)}
    folder.write({"results.json": gathered.as_json(), "junit.xml": junit, **figures, **page})


# What few runs ask for is imported where it is asked for: the others begin sooner.
@contextmanager
def _ahead(cluster: Executor | None, jobs: int) -> Iterator[Executor]:
    """The cluster, which raises where it is lost, else cores of this machine.

    What is lost on these is computed by whoever asks for it, who also says what is wrong.
    """
    if cluster is not None:
        yield cluster
        return
    with suppress(ComputationError, InputError), on_cores(jobs) as cores:
        yield cores


def _vary(request: Request, tasks: Sequence[Task], cluster: Executor | None) -> None:
    """Solve the robots that differ in one number, as far as their cases and figures are asked."""
    from validation.variations.curves import variation_study  # noqa: PLC0415

    groups = {task.group for task in tasks}
    for number, variation in enumerate(request.variations, start=1):
        if f"vary.{number}" in groups:
            with _ahead(cluster, request.jobs) as executor, suppress(InputError):
                variation_study(request.robot_file, variation, request.preset, executor)


def _baseline(request: Request) -> RunRecord | None:
    """The run to compare with; raises InputError where it is of another robot."""
    if request.baseline is None:
        return None
    baseline = load_run(request.baseline)
    other, name = baseline.run.get("robot"), request.robot_file.name
    if other and other != name:
        raise InputError(
            f'--baseline {request.baseline}: is of another robot, "{other}", and says nothing of '
            f'"{name}"; must be a run of the same robot'
        )
    return baseline


def _prepare(robot_file: RobotFile, preset: Preset, cluster: Executor | None, jobs: int) -> None:
    """Mesh and reduce the parts of a mechanism, and keep it."""
    if not robot_file.mechanism.parts:
        return
    # Meshes and solvers, of which most runs ask for none.
    from validation.session.parts_ahead import prepare_parts  # noqa: PLC0415

    with progress.stage("meshing and reducing parts"), _ahead(cluster, jobs) as executor:
        prepare_parts(Context(robot_file, preset), executor, carried=cluster is not None)


def _refuse_large_exports(request: Request) -> None:
    """Raise InputError for legs whose solids are too large to be written."""
    from validation.export.models import DIVISIONS  # noqa: PLC0415
    from validation.solids.size import too_large  # noqa: PLC0415

    legs = list(legs_of(request.robot_file.mechanism).values())
    reason = too_large(legs, len(legs) * (DIVISIONS[request.preset],), request.preset)
    if reason:
        raise InputError(f"--export: {reason}")


def _compute(job: Job, gathered: Results, folder: RunFolder, jobs: int) -> None:
    begun = perf_counter() - gathered.header["seconds"]
    due = 0.0

    def keep(record: Record) -> None:
        nonlocal due
        now = perf_counter()
        folder.keep(record, now - begun)
        gathered.add(record)
        gathered.header = dict(gathered.header) | {"seconds": now - begun}
        # All records are kept; this file is for who looks on, and grows with the run.
        if now >= due:
            folder.write({"results.json": gathered.as_json()})
            due = now + (perf_counter() - now) * _SPARING

    waiting = [task for task in gathered.tasks if task.id not in gathered.done]
    with progress.showing(waiting) as shown:
        runner.run(job, waiting, jobs=jobs, log=folder.log, keep=keep, progress=shown)
