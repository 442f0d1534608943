"""The command `flexproof`.

Exit codes: 0 success · 1 a case disagrees, or a model that is relied on is inadequate · 2 the input
is wrong · 3 a computation failed or was interrupted. Results go to stdout, everything else to
stderr. Packages that are slow to import are imported by the commands that need them, so that help
and messages come at once.
"""

import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from traceback import format_exception
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter, UnusedCliTokensError

from fem.extras import require_extra
from fem.machine import TO_COMPUTE, TO_READ, require_room, usable_cores
from lumped.errors import EXHAUSTED, ComputationError, InputError, ProgramError, remarks_to
from lumped.model_choices import Ends, Layout, ReductionBy, Release
from lumped.robots import FIRST_TYPE, RobotType
from lumped.solver_request import HOSTS_VARIABLE, RANKS_VARIABLE, VARIABLE
from lumped.text import shortened, visible
from validation.comparisons.command import converge
from validation.console import streams
from validation.console.docs import docs
from validation.console.extras import extras
from validation.console.streams import write_messages, write_results
from validation.console.typed import (
    DEFAULT_MODEL,
    DEFAULT_SOLVER,
    AsJson,
    Force,
    ModelChoices,
    PathArgument,
    ProcessCount,
    RobotName,
    SolverChoice,
    WholeNumber,
    require_distinct,
    require_writable,
)
from validation.export.command import export as export_model
from validation.forces import command as forces_command
from validation.kinematics import commands as kinematics
from validation.models.options import ModalModel, ModelName
from validation.selftest.command import selftest
from validation.solve import part_commands as commands

app = App(
    name="flexproof",
    help=(
        "Cross-validate lumped stiffness models of parallel robots against beam and solid "
        "finite elements."
    ),
    version="",
    result_action="return_value",
    # No option --empty-x for arguments that can be repeated, and no default in help if it is empty.
    default_parameter=Parameter(negative=(), show_default=lambda value: value or None),
)
_REPORT_REQUEST = "this is an error in flexproof itself; please report it with the lines above"
app.command(converge)
app.command(docs)
app.command(extras)
app.command(commands.faces)
app.command(kinematics.kinematics)
app.command(forces_command.forces)
app.command(export_model)
app.command(commands.identify)
app.command(selftest)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line (default: sys.argv) and return the exit code."""
    try:
        app.version = _version
        streams.prepare()
        if arguments is None:
            signal.signal(signal.SIGTERM, _interrupted)
        with (
            _home(),
            remarks_to(lambda remark: streams.write_message(str(remark))),
            _own_variables(VARIABLE, RANKS_VARIABLE, HOSTS_VARIABLE, streams.QUIET),
        ):
            return _run(list(sys.argv[1:] if arguments is None else arguments))
    except CycloptsError as error:
        return write_messages([shortened(_one_line(error))], 2)
    except InputError as error:
        return write_messages(error.faults, 2)
    except (ComputationError, KeyboardInterrupt) as error:
        return write_messages(_lines_of(error), 3)
    except MemoryError:
        return write_messages(["out of memory; choose a coarser mesh or a smaller preset"], 3)
    except Exception as error:  # noqa: BLE001  whatever it is, code 1 would pass for a disagreement
        lines = "".join(format_exception(error)).splitlines()
        return write_messages([*lines, _REPORT_REQUEST], 3)


def _lines_of(error: ComputationError | KeyboardInterrupt) -> list[str]:
    """Reason why a computation ended. For an error of the program, also the traceback."""
    if isinstance(error, ProgramError):
        return [*error.traceback, str(error), _REPORT_REQUEST]
    return [str(error) or "interrupted"]


@contextmanager
def _home() -> Iterator[None]:
    """Context with a home folder for libraries: a temporary one if HOME is not an absolute path.

    With an empty or relative HOME, libraries would write into the root of the file system or into
    the working folder.
    """
    home = os.environ.get("HOME")
    if home is None or Path(home).is_absolute():
        yield
        return
    with TemporaryDirectory(prefix="flexproof-home-") as folder:
        os.environ["HOME"] = folder
        try:
            yield
        finally:
            os.environ["HOME"] = home


@contextmanager
def _own_variables(*names: str) -> Iterator[None]:
    """Context that restores environment variables, which a command can set for its processes."""
    before = {name: os.environ.get(name) for name in names}
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})


def _interrupted(number: int, _frame: object) -> None:
    """Handler of SIGTERM: end the command as Ctrl-C does, and ignore further signals."""
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def _run(arguments: list[str]) -> int:
    require_room(TO_READ)
    command, bound, _ = app.parse_args(arguments, exit_on_error=False, print_error=False)
    code = 0
    try:
        returned = command(*bound.args, **bound.kwargs)
        code = returned if isinstance(returned, int) else 0
    except SystemExit:
        # rich, which prints help, raises SystemExit when the reader of a pipe has ended.
        pass
    except OSError as error:
        # Help and version are printed by cyclopts.
        if command.__module__.startswith("cyclopts"):
            streams.raise_lost_results(error)
        elif error.errno in EXHAUSTED:
            raise ComputationError(f"the operating system reports: {error.strerror}") from error
        elif not _in_a_folder():
            gone = "the current folder no longer exists; change to another one (cd)"
            raise InputError(gone) from error
        else:
            raise
    streams.flush()
    return code


def _in_a_folder() -> bool:
    try:
        Path.cwd()
    except FileNotFoundError:
        return False
    return True


# Computing time (s) beyond which a separate process computes, so that Ctrl-C ends it at once.
_PATIENCE = 2.0


@app.command
def run(
    robot: RobotName = "ifw",
    *,
    preset: Literal["quick", "standard", "fine"] = "standard",
    only: str | None = None,
    out: PathArgument = Path("report"),
    jobs: ProcessCount = None,
    resume: bool = False,
    baseline: PathArgument | None = None,
    export: bool = False,
    cluster: str | None = None,
    accept: tuple[str, ...] = (),
    rely: tuple[str, ...] = (),
    accuracy: float | None = None,
    inputs: float | None = None,
    strict: bool = False,
    measured: PathArgument | None = None,
    vary: tuple[str, ...] = (),
    solver: SolverChoice = DEFAULT_SOLVER,
    quiet: bool = False,
) -> int:
    """Validate a robot's lumped models and write a report.

    Parameters
    ----------
    preset
        Mesh refinement of the references and number of poses: quick (seconds), standard (a
        minute or two) or fine (longer).
    only
        Run only the cases with this id; * and ? are wildcards. `flexproof cases` lists the ids.
    out
        Folder for report.html, results.json, junit.xml and figures/.
    jobs
        Number of processes. Default: number of cores.
    resume
        Continue an interrupted run of the same input in the same folder.
    baseline
        Compare with this earlier run (folder or results.json): exit code 1 if a verdict
        worsened; changed values are reported as drift.
    export
        Also write export/: meshes, displacements and modes for ParaView, matrices as .npz and
        Matrix Market.
    cluster
        Address of a Dask scheduler (tcp://host:port) whose workers compute everything; needs the
        extra "cluster".
    accept
        Accepted relative error of the models, for example deflection=0.03; overrides
        [accept] of the robot file. Names: deflection, frequency, response, modes, or one
        quantity (x y z phi_x phi_y phi_z any_force f1 f2 … order, load:NAME,
        response:NAME).
    rely
        Model that you rely on: exit code 1 if it is inadequate. May be repeated.
    accuracy
        Refine the meshes of the references until the relative half-width of every value is
        at most this number, for example 0.002, within the limits of memory, of the finest
        preset and of 800 000 unknowns for a part.
    inputs
        Compute the probability of each verdict, with this relative standard uncertainty of
        all moduli, lengths and stiffnesses, for example 0.05; only for a robot file without
        [[input_uncertainty]].
    strict
        Exit code 1 also if a comparison, or a model relied on, is undecided.
    measured
        Measured values of the robot (CSV: quantity, pose, value, uncertainty, source), or a modal
        test (.uff, .unv; needs the extra "hammer", and [hammer] in the robot file), in addition to
        those of the robot file.
    vary
        Key of the robot file, and the range and count of its values, for example
        bodies.rod1.section.diameter=0.02:0.06:9. The report compares all models over this range,
        and the value that is best by each model. A * in the key stands for any part of a name.
        May be repeated for other keys.
    quiet
        Write only results and errors, no progress. FLEXPROOF_QUIET=1 has the same effect
        for all commands.
    """
    from lumped.files import StoreError  # noqa: PLC0415
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.catalogue import catalogue  # noqa: PLC0415
    from validation.report import summary  # noqa: PLC0415
    from validation.validate import Request, validate  # noqa: PLC0415

    require_room(TO_COMPUTE)
    solver.request()
    if quiet:
        os.environ[streams.QUIET] = "1"
    if cluster is not None:
        require_extra("cluster", "--cluster")
    request = Request(
        load_robot(robot),
        preset,
        out,
        jobs or usable_cores(),
        only,
        "resumed" if resume else "afresh",
        baseline,
        export,
        cluster,
        accept=accept,
        rely=rely,
        accuracy=accuracy,
        inputs=inputs,
        measured=measured,
        vary=vary,
        strict=strict,
    )
    go_on = f"finished results are kept; continue with: {request.resume_command}"
    try:
        gathered = validate(request, catalogue)
    except StoreError as error:
        return write_messages([str(error), go_on], 3)
    except ComputationError as error:
        return write_messages([*_lines_of(error), go_on], 3)
    except KeyboardInterrupt:
        return write_messages(["interrupted", go_on], 3)
    write_messages([*gathered.remarks, *summary.left_out(gathered)], 0)
    changes, worsened = summary.changes(gathered)
    if lines := [*summary.verdicts(gathered), *changes]:
        write_results("\n".join(lines))
    write_results(f"report: {visible(str(gathered.path / 'report.html'))}")
    decisions = summary.decision_sentences(gathered.outcomes)
    for line in (*summary.adequacy(gathered), *summary.cross_validation(gathered), *decisions):
        write_results(line)
    if gathered.unfinished:
        write_messages(["interrupted", go_on], 3)
    return max(gathered.standing.exit_code, int(worsened))


@app.command
def compare(before: PathArgument, after: PathArgument, *, json: AsJson = False) -> int:
    """List the changes between two runs; exit code 1 if a verdict worsened.

    Verdicts of two different robots (by name) are not compared: exit code 0.

    Parameters
    ----------
    before
        Run folder or results.json of the earlier run.
    after
        Run folder or results.json of the later run.
    """
    from json import dumps  # noqa: PLC0415

    from validation.run.compare import as_dict, as_text  # noqa: PLC0415
    from validation.run.compare import compare as compare_runs  # noqa: PLC0415
    from validation.run.records import load_run  # noqa: PLC0415

    runs = load_run(before), load_run(after)
    comparison = compare_runs(*runs)
    judged = any(change.before and change.after for change in comparison.adequacy)
    if not (comparison.seconds or judged or comparison.different_robots):
        raise InputError(f"{before} and {after} have no case in common, so nothing can be compared")
    if json:
        write_results(dumps(as_dict(comparison), indent=1))
    else:
        write_results(as_text(*runs, comparison))
    return 1 if comparison.worsened else 0


@app.command
def solve(
    robot: RobotName,
    *,
    model: ModelName,
    x: tuple[float, ...] = (),
    pose: Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True)] = (),
    leg: WholeNumber | None = None,
    body: str | None = None,
    modes: WholeNumber | None = None,
    options: ModelChoices = DEFAULT_MODEL,
    release: Release | None = None,
    layout: Layout | None = None,
    ends: Literal[Ends, "free-free"] | None = None,
    reduction: ReductionBy | None = None,
    accuracy: float | None = None,
    against: ModalModel | None = None,
    vary: tuple[str, ...] = (),
    minimise: str | None = None,
    maximise: str | None = None,
    where: tuple[str, ...] = (),
    jobs: ProcessCount = None,
    cluster: str | None = None,
    csv: PathArgument | None = None,
    picture: PathArgument | None = None,
    solver: SolverChoice = DEFAULT_SOLVER,
    force: Force = False,
    json: AsJson = False,
) -> int:
    """Solve one model of the robot, or of one leg: compliance and natural frequencies.

    Parameters
    ----------
    model
        The model to solve.
    x
        Biglide of schema 1: position of the point B along the stroke (m). Default: the middle. May
        be repeated.
    pose
        Pose of the tool: numbers separated by commas in the order of its moves, such as 0.25,0.6
        (m, rad, or the unit of the robot file). Default: the reference posture. May be repeated.
    leg
        Biglide of schema 1: number of a leg, 1 or 2, that is solved alone with its root clamped.
    body
        Name of a body that is solved alone, clamped at its first point.
    modes
        Number of natural frequencies. Default: 6.
    release
        segments: last spring of a leg with the revolute joint at its tip condensed, so that the
        joint turns freely (condensed), or by eq. (25) as printed in the paper (printed).
    layout
        segments: half springs at both ends of a leg (half), or springs between segments
        only, as printed in the paper (literal).
    ends
        solid: end faces kept plane and rigid, or free to warp. free-free: with --body,
        natural frequencies of the unsupported body without its six rigid-body motions.
    reduction
        solid: CAD parts by their modes with all interfaces fixed (Craig and Bampton), or free
        (MacNeal, Rubin).
    accuracy
        solid: refine the meshes until the relative half-width of every value is at most
        this number, for example 0.002, within the limits of memory and of an estimated ten
        minutes per mesh.
    against
        Another model, whose modes are paired by shape (MAC) with those of --model.
    vary
        Key of the robot file, and the range and count of its values, for example
        bodies.rod1.section.diameter=0.02:0.06:9. A * in the key stands for any part of a
        name. May be repeated: every combination is solved.
    minimise
        With --vary: quantity whose smallest value decides which robot is best: mass (kg), f1 f2 …
        (Hz), deflection.x … deflection.phi_z (m at 1000 N, rad at 100 N m), load:NAME (m).
    maximise
        With --vary: quantity whose largest value decides which robot is best, as in --minimise.
    where
        With --vary: condition that robots must meet, for example f1>=60 or
        deflection.x<=20e-6, in the units of --minimise; the worst pose counts. May be
        repeated. Exit code 1 if none meets all.
    jobs
        With --vary: number of processes; 1 if left out.
    cluster
        Address of a Dask scheduler (tcp://host:port) whose workers solve the model, or the models
        of --vary; needs the extra "cluster".
    csv
        With --vary: also write the table into this file.
    picture
        With --vary: draw deflections and frequencies over the first number into this PNG file, a
        curve for each combination of the others.
    """
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from meshes.processes import in_own_process  # noqa: PLC0415
    from validation.console.progress import stage  # noqa: PLC0415
    from validation.solve.answer_json import as_json  # noqa: PLC0415
    from validation.solve.answer_text import as_text  # noqa: PLC0415
    from validation.solve.model_answers import checked, checked_solution  # noqa: PLC0415
    from validation.solve.question import Question, split_ends  # noqa: PLC0415

    require_room(TO_COMPUTE)
    solver.request()
    if cluster is not None:
        require_extra("cluster", "--cluster")
    require_writable(csv, ".csv", force=force)
    require_writable(picture, ".png", force=force)
    require_distinct(csv, picture)
    robot_file = load_robot(robot)
    specified, free = split_ends(
        model, options.given(release=release, layout=layout, ends=ends, reduction=reduction)
    )
    question = Question(
        robot_file,
        model,
        specified,
        modes,
        x,
        pose,
        leg,
        body,
        against,
        accuracy=accuracy,
        free=free,
    )
    belongs_to_vary = (csv, jobs, picture, minimise, maximise, *where)
    if vary or any(option is not None for option in belongs_to_vary):
        from validation.solve.varied import write_varied  # noqa: PLC0415

        found = write_varied(
            question,
            vary,
            jobs or 1,
            cluster,
            csv,
            picture,
            json=json,
            minimise=minimise,
            maximise=maximise,
            where=where,
        )
        return 0 if found else 1
    cost = checked(question)
    # Unknowns of CAD parts are not counted.
    size = f", {cost.size}" if cost.unknowns else ""
    with stage(f"{model} model{size}", cost.seconds):
        if cluster is not None:
            from validation.solve.varied import solve_on_cluster  # noqa: PLC0415

            solution = solve_on_cluster(question, cluster)
        elif cost.seconds > _PATIENCE:
            solution = in_own_process(checked_solution, question)
        else:
            solution = checked_solution(question)
    write_results(as_json(solution) if json else as_text(solution))
    return 0


@app.command
def check(robot: RobotName) -> int:
    """List all errors and doubtful values of a robot file."""
    from lumped.audit import audit  # noqa: PLC0415
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.kinematics.poses import postures_on_path  # noqa: PLC0415
    from validation.models.plausibility import (  # noqa: PLC0415
        parts_text,
        robot_findings,
        warping_text,
    )
    from validation.paper.errata import paper_findings  # noqa: PLC0415
    from validation.report.listing import audit_text  # noqa: PLC0415

    robot_file = load_robot(robot)
    mechanism = robot_file.mechanism
    pose_count = len(postures_on_path(mechanism, mechanism.poses))
    of_parts = parts_text(mechanism)
    findings = (*audit(robot_file), *paper_findings(robot_file), *robot_findings(mechanism))
    write_results(audit_text(robot, mechanism, findings, pose_count))
    if of_parts:
        write_results(of_parts)
    if of_warping := warping_text(mechanism):
        write_results(of_warping)
    return 0


@app.command
def new(
    file: PathArgument,
    *,
    robot_type: Annotated[RobotType, Parameter(name="--type")] = FIRST_TYPE,
) -> int:
    """Write a commented robot file to start from.

    Parameters
    ----------
    file
        Name of the new file, which must not exist yet.
    robot_type
        Kind of mechanism.
    """
    from lumped.robot_file import write_template  # noqa: PLC0415

    write_template(file, robot_type)
    name = visible(str(file))
    write_results(f"{name} written; describe your robot in it, then: flexproof check {name}")
    return 0


@app.command
def schema() -> int:
    """Print the JSON schema of robot files, for editors."""
    from json import dumps  # noqa: PLC0415

    from lumped.robot_file.rules.published import json_schema  # noqa: PLC0415

    write_results(dumps(json_schema(), indent=1))
    return 0


@app.command
def cases(robot: RobotName = "ifw", *, json: AsJson = False) -> int:
    """List the validation cases of a robot with their sources and tolerances."""
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.catalogue import catalogue  # noqa: PLC0415
    from validation.report.listing import as_json, as_text  # noqa: PLC0415

    robot_file = load_robot(robot)
    tasks = catalogue(robot_file)
    write_results(as_json(tasks) if json else as_text(tasks))
    return 0


def _one_line(error: CycloptsError) -> str:
    if isinstance(error, UnusedCliTokensError):
        tokens = " ".join(error.unused_tokens or ())
        return f"unknown arguments: {tokens}; see flexproof --help"
    return " ".join(str(error).split())


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version  # noqa: PLC0415

    from fem.solvers.backends.choice import solver_name  # noqa: PLC0415

    try:
        program_version = version("flexproof")
    except PackageNotFoundError:
        program_version = "not installed"
    return f"{program_version}, linear solver: {solver_name()}"


if __name__ == "__main__":
    sys.exit(main())
