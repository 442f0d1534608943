"""flexproof from Python: load a robot, solve a model, judge the models, run everything.

Results are frozen records with tables and plots, displayed by notebooks. Wrong input raises
`lumped.errors.InputError` with a line per fault, a failed computation `ComputationError`.

Examples of functions use built-in robots, or this clamped steel bar:

>>> steel = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
>>> square = {"shape": "rectangle", "width": 0.02, "height": 0.02}
>>> bar = {
...     "schema": 2,
...     "name": "bar",
...     "points": {"A": [0.0, 0.0, 0.0], "P": [0.3, 0.0, 0.0]},
...     "bodies": {"bar": {"from": "A", "to": "P", "section": square, "material": steel}},
...     "joints": {"clamp": {"type": "fixed", "between": ["ground", "bar"], "at": "A"}},
...     "tool": {"body": "bar", "point": "P", "moves": []},
... }
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from fem.machine import usable_cores
from lumped.errors import InputError
from lumped.model_choices import Theory
from lumped.robot_file import RobotFile, load_robot, robot_of
from lumped.robot_file.places import unit_of
from lumped.robot_file.written import toml_of, toml_value
from meshes.part.interfaces import find_interfaces
from validation.adequacy.robot_verdicts import judged_robot
from validation.case import Skip
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.element_convergence import storing
from validation.comparisons.requested import convergence
from validation.console.arguments import arguments_named, checked, faults_of
from validation.console.typed import MOST_PROCESSES, LengthUnit
from validation.context import Context, Preset
from validation.cross_validation import CrossValidation, cross_validation
from validation.export.command import Kind, write_export
from validation.forces.analysis import forces as computed_forces
from validation.forces.record import Forces
from validation.kinematics.poses import parsed_poses, postures_of, postures_on_path
from validation.maps.figure import WorkspaceMaps, workspace_maps
from validation.maps.workspace import directions
from validation.measured.matrix import measured_matrix
from validation.measured.modes import with_measured_file
from validation.models.options import ModelName, ModelOptions, RefinedModel
from validation.models.reduced_parts import free_body_part, identified
from validation.parts.free_modes import FreePart, free_entry
from validation.parts.identify import DEFAULT_MODES, DEFAULT_UNKNOWNS, Identified
from validation.parts.identify import identify as identified_between
from validation.parts.meshes import part_file
from validation.parts.request import (
    faults_of_numbers,
    interfaces_of,
    material_of,
    part_of,
)
from validation.python.judged import Adequacy, MeasuredComparison, with_limits
from validation.python.runs_and_designs import Designs, Run
from validation.run.executor import in_turn
from validation.solve.answer import Solution
from validation.solve.model_answers import solve as answered
from validation.solve.question import Question, split_ends
from validation.variations.curves import checked_variations, variation_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Robot = RobotFile | str | Path | Mapping[str, Any]


@checked
def load(
    robot: str | Path | Mapping[str, Any], *, accept: Mapping[str, float] | None = None
) -> RobotFile:
    """Read and check a robot.

    Parameters
    ----------
    robot
        Name of a built-in robot, path of a robot file, or a dictionary with the keys of a robot
        file (SI units). Files that a dictionary names are sought in the working folder.
    accept
        Limits that replace those of the file, such as ``{"deflection": 0.1}``: relative errors by
        the names of ``--accept``.

    Returns
    -------
    RobotFile
        The robot, for all functions of this module.

    Raises
    ------
    InputError
        With a line for every fault of the robot.

    Examples
    --------
    >>> robot = load("ifw", accept={"deflection": 0.1})
    >>> robot.name
    'IFW demonstrator'
    """
    loaded = _loaded(robot)
    return replace(
        loaded, requirement=with_limits(loaded.requirement, accept or {}, loaded.mechanism.lengths)
    )


@checked
def solve(
    robot: Robot,
    model: ModelName,
    *,
    poses: Sequence[float | Sequence[float]] = (),
    leg: int | None = None,
    body: str | None = None,
    modes: int | None = None,
    **options: Any,
) -> Solution:
    """Compliance and natural frequencies of one model.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    model
        ``"simplified"``, ``"vjm"``, ``"links"``, ``"segments"``, ``"beam"`` or ``"solid"``.
    poses
        Poses of the tool (m, rad), each in the order of its moves; a number if it has one move.
        The middle of the path if empty.
    leg, body
        One leg of a biglide (1 or 2) or one body alone, its root clamped.
    modes
        Number of natural frequencies. Six if None.
    **options
        Options of the model, as for ``flexproof solve``: ``elements``, ``theory``, ``divisions``, …
        ``ends="free-free"`` with `body`: frequencies of the body with free ends.

    Returns
    -------
    Solution
        An answer for each pose: ``compliance`` (6×6 at the loaded point, base axes, m/N, rad/N,
        rad/(N m)) and ``frequencies`` (Hz, ascending).

    Raises
    ------
    InputError
        With a line for each wrong argument.
    ComputationError
        If the model cannot be solved.

    Examples
    --------
    >>> answer = solve("ifw", "beam", poses=[0.4975], modes=2).answers[0]
    >>> print(f"{answer.frequencies[0]:.1f} Hz, {1e9 * answer.compliance[2, 2]:.1f} µm/kN")
    112.4 Hz, 23.4 µm/kN
    """
    fixed_options, free = split_ends(model, options)
    fixed_options = _model_options(fixed_options)
    with arguments_named():
        typed = _typed(poses)
        question = Question(
            _loaded(robot), model, fixed_options, modes, poses=typed, leg=leg, body=body, free=free
        )
        return answered(question)


@checked
def forces(
    robot: Robot,
    model: ModelName = "beam",
    *,
    poses: Sequence[float | Sequence[float]] = (),
    path: bool = False,
    loads: Sequence[str] = (),
    **options: Any,
) -> Forces:
    """Reactions of joints, forces of drives, member forces and stresses under the robot's loads.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`. It must have ``[[loads]]``.
    model
        Model as for `solve`.
    poses
        Poses as for `solve`.
    path
        True for all poses of the path.
    loads
        Names of loads. All of them if empty.
    **options
        Options of the model, as for ``flexproof forces``.

    Returns
    -------
    Forces
        Forces (N, N m) and stresses (Pa) with half-widths, for each pose and load.

    Raises
    ------
    InputError
        With a line for each wrong argument.
    ComputationError
        If the model cannot be solved.

    Examples
    --------
    >>> weight = {"name": "weight", "gravity": [0.0, 0.0, -9.81]}
    >>> clamp = forces({**bar, "loads": [weight]}).poses[0].loads["weight"].reactions[0]
    >>> print(f"{clamp.wrench[2]:.3f} N, {clamp.wrench[4]:.3f} N m")
    9.241 N, -1.386 N m
    """
    with arguments_named():
        question = Question(_loaded(robot), model, _model_options(options), poses=_typed(poses))
        return computed_forces(question, loads, on_path=path)


@checked
def converge(
    robot: Robot,
    model: RefinedModel | None = None,
    *,
    body: str | None = None,
    elements: Sequence[int] | None = None,
    divisions: Sequence[int] | None = None,
    theory: Theory | None = None,
) -> ConvergenceStudy:
    """Convergence with element count or mesh, of one leg or of the whole robot.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`. It stands in the middle of its path.
    model
        ``"segments"``, ``"beam"`` or ``"solid"``. Segments and beam elements if None.
    body
        A leg, clamped at its root. The whole robot if None.
    elements
        Elements per leg, each count at least 1. The usual counts from 1 to 80 if None.
    divisions
        For solids of a leg: quadratic elements across the smaller side of the section.
    theory
        ``"timoshenko"`` or ``"euler-bernoulli"``. Timoshenko's if None.

    Returns
    -------
    ConvergenceStudy
        Values, errors from the limit, orders, and the smallest counts below 1 % and 0.1 %.

    Raises
    ------
    InputError
        With a line for each wrong argument.
    ComputationError
        If the model cannot be solved.

    Examples
    --------
    >>> study = converge("ifw", "segments", body="leg1", elements=[5, 10, 20, 40])
    >>> study.assert_converged("f1", elements=20, within=0.01)
    """
    loaded = _loaded(robot)
    with arguments_named():
        return convergence(
            loaded,
            model=model,
            body=body,
            elements=elements,
            divisions=divisions,
            theory=theory,
            executor=storing(in_turn, loaded.mechanism),
        )


@checked
def cross_validate(robot: Robot, *, preset: Preset = "standard") -> CrossValidation:
    """Compare all formulations of the robot's legs with solids, and study their convergence.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    preset
        ``"quick"``, ``"standard"`` or ``"fine"``: fineness of the solids' meshes.

    Returns
    -------
    CrossValidation
        The numbers of the chapter "Cross-validation" of a report with this preset.

    Raises
    ------
    InputError
        With a line for each fault of the robot.
    ComputationError
        If a convergence study fails.

    Examples
    --------
    >>> crossed = cross_validate(bar, preset="quick")
    >>> crossed.assert_agrees("beam", with_="solid", quantity="z", within=0.01)
    >>> crossed.assert_converged("f1", elements=20, within=0.01)
    """
    return cross_validation(Context(_loaded(robot), preset))


@checked
def adequacy(
    robot: Robot, *, preset: Preset = "standard", accept: Mapping[str, float] | None = None
) -> Adequacy:
    """Judge every model of a robot for every quantity.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    preset
        ``"quick"``, ``"standard"`` or ``"fine"``: fineness of the references' meshes.
    accept
        Limits that replace those of the file, as for `load`.

    Returns
    -------
    Adequacy
        Errors, verdicts, causes and remedies. A quantity without a reference is undecided.

    Raises
    ------
    InputError
        With a line for each fault of the robot.
    ComputationError
        If a posture of the path cannot be computed.

    Examples
    --------
    >>> judged = adequacy(bar, preset="quick")
    >>> judged.assert_adequate("beam", "z", within=0.02)
    >>> judged.entry("simplified", "z").verdict
    'inadequate'
    """
    loaded = _loaded(robot)
    requirement = with_limits(loaded.requirement, accept or {}, loaded.mechanism.lengths)
    subject, matrix = judged_robot(Context(replace(loaded, requirement=requirement), preset))
    return Adequacy(matrix, requirement, subject)


@checked
def run(
    robot: Robot,
    *,
    out: str | Path = "report",
    preset: Preset = "standard",
    only: str | None = None,
    jobs: int | None = None,
    vary: Sequence[str] = (),
) -> Run:
    """Validate a robot and write a report, as ``flexproof run`` does.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    out
        Folder for ``report.html``, ``results.json``, ``junit.xml`` and ``figures/``.
    preset
        ``"quick"``, ``"standard"`` or ``"fine"``.
    only
        Compute only the comparisons whose id matches, with * and ? as in a shell.
    jobs
        Number of processes. As many as there are cores if None.
    vary
        Numbers of the robot file and their ranges, each ``"KEY=FROM:TO:COUNT"`` as for ``--vary``.

    Returns
    -------
    Run
        Folder, exit code, number of comparisons by verdict, and the matrix of adequacy.

    Raises
    ------
    InputError
        Before anything is written.
    ComputationError
        If the run cannot be continued.

    Examples
    --------
    >>> finished = run(bar, out="report", preset="quick", only="bar.converged*")
    >>> finished.exit_code, finished.report.name
    (0, 'report.html')
    """
    # These modules load every case; solving a model needs none of them.
    from validation.catalogue import catalogue  # noqa: PLC0415
    from validation.validate import Request, validate  # noqa: PLC0415

    if jobs is not None and not 1 <= jobs <= MOST_PROCESSES:
        raise InputError(f"jobs = {jobs}: must be a whole number from 1 to {MOST_PROCESSES}")
    cores = jobs or usable_cores()
    request = Request(_loaded(robot), preset, Path(out), cores, only, vary=vary)
    with arguments_named():
        gathered = validate(request, catalogue)
    return Run(
        out=gathered.path,
        exit_code=gathered.standing.exit_code,
        outcomes=tuple(gathered.outcomes),
        matrix=gathered.matrix,
        seconds=float(gathered.header["seconds"]),
    )


@checked
def identify(
    part: Robot,
    *,
    body: str | None = None,
    interfaces: Mapping[str, Any] | None = None,
    material: Mapping[str, Any] | None = None,
    unit: LengthUnit | None = None,
    unknowns: int = DEFAULT_UNKNOWNS,
    modes: int = DEFAULT_MODES,
) -> Identified:
    """Identify a CAD part: stiffness, mass and frequencies between its interfaces.

    Parameters
    ----------
    part
        A STEP or BREP file, a volume mesh, or with `body` a robot as for `load`.
    body
        A body of the robot that is a part from a file.
    interfaces
        For a file: interfaces (m) by name, each as in a robot file; the first one is clamped:
        ``{"A": {"cylinder": {"radius": 0.04}}, "B": {"cylinder": {"radius": 0.028}}}``.
    material
        For a file: ``{"E": 2.1e11, "nu": 0.3, "rho": 7850.0}`` (Pa, –, kg/m³).
    unit
        Unit of length if the file has none: ``"m"``, ``"mm"``, ``"cm"`` or ``"inch"``.
    unknowns
        Unknowns of the finest of the three meshes.
    modes
        Number of frequencies with the first interface clamped.

    Returns
    -------
    Identified
        Stiffness and mass (6m×6m for m interfaces), compliance (SI, axes of the file) and
        frequencies (Hz), with half-widths due to the meshes and to the condition of the interfaces.

    Raises
    ------
    InputError
        For wrong arguments, or if the part cannot be meshed.
    ComputationError
        If memory or a solver fails.

    Examples
    --------
    >>> found = identify(
    ...     "examples/tapered-biglide/leg1.step",
    ...     interfaces={"A": {"cylinder": {"radius": 0.040}}, "B": {"cylinder": {"radius": 0.028}}},
    ...     material={"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
    ...     unknowns=5000,
    ...     modes=1,
    ... )
    >>> found.compliance.shape, f"{found.total:.0f} kg"
    ((6, 6), '71 kg')
    """
    of_file = {"material": material, "interfaces": interfaces, "unit": unit}
    with arguments_named():
        if faults := _part_faults(part, body, of_file, unknowns, modes):
            raise InputError(faults)
        if body is not None:
            return identified(part_of(_loaded(part), body), unknowns, modes)
        texts = [toml_of({name: table}) for name, table in (interfaces or {}).items()]
        wanted, points = interfaces_of(texts)
        solid_material = material_of(toml_value(material))
        file = part_file(Path(str(part)), unit)
        faces = find_interfaces(file, wanted, points)
        return identified_between(file, faces, solid_material, unknowns, modes)


@checked
def identify_free(
    part: Robot,
    *,
    body: str | None = None,
    material: Mapping[str, Any] | None = None,
    unit: LengthUnit | None = None,
    unknowns: int = DEFAULT_UNKNOWNS,
    modes: int = DEFAULT_MODES,
) -> FreePart:
    """Frequencies of a CAD part without supports, as ``flexproof identify --free``.

    Parameters
    ----------
    part
        A STEP or BREP file, a volume mesh, or with `body` a robot as for `load`.
    body
        A body of the robot that is a part from a file.
    material
        For a file: ``{"E": 2.1e11, "nu": 0.3, "rho": 7850.0}`` (Pa, –, kg/m³).
    unit
        Unit of length if the file has none: ``"m"``, ``"mm"``, ``"cm"`` or ``"inch"``.
    unknowns
        Unknowns of the finest of the three meshes.
    modes
        Number of elastic frequencies; the six rigid-body motions are counted and left out.

    Returns
    -------
    FreePart
        Frequencies (Hz) with half-widths due to the meshes, and the mass properties.

    Raises
    ------
    InputError
        For wrong arguments, or if the part cannot be meshed.
    ComputationError
        If memory or a solver fails.

    Examples
    --------
    >>> found = identify_free(
    ...     "examples/tapered-biglide/leg1.step",
    ...     material={"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
    ...     unknowns=5000,
    ...     modes=1,
    ... )
    >>> found.rigid, found.frequencies.shape
    (6, (1,))
    """
    faults = _part_faults(part, body, {"material": material, "unit": unit}, unknowns, modes)
    if modes == 0:
        faults.append(
            "modes = 0: a part without supports has no results but frequencies; must be 1 or more"
        )
    with arguments_named():
        if faults:
            raise InputError(faults)
        if body is not None:
            return free_body_part(part_of(_loaded(part), body), unknowns, modes)
        solid_material = material_of(toml_value(material))
        return free_entry(part_file(Path(str(part)), unit), solid_material, unknowns, modes).value()


@checked
def draw(robot: Robot, *, poses: Sequence[float | Sequence[float]] = ()) -> "Figure":
    """Draw a robot: one posture in full with names of bodies and joints, the others as lines.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    poses
        Poses of the tool (m, rad), as for `solve`; the middle one is drawn in full. Those of the
        path if empty.

    Returns
    -------
    matplotlib.figure.Figure
        The picture. Without OpenGL a figure that states how to get it.

    Raises
    ------
    InputError
        For poses that the robot cannot reach.

    Examples
    --------
    >>> draw("five-bar", poses=[[0.0, 0.5]]).savefig("five-bar.png")
    """
    # Only a picture needs the libraries that draw it.
    from validation.drawing.rendering import drawn_scenes  # noqa: PLC0415
    from validation.kinematics.picture import scene  # noqa: PLC0415

    mechanism = _loaded(robot).mechanism
    with arguments_named():
        if len(poses):
            postures = postures_of(mechanism, parsed_poses(mechanism, _typed(poses)))
        else:
            postures = postures_on_path(mechanism, mechanism.poses)
        return drawn_scenes([scene(mechanism, postures)])


@checked
def workspace(robot: Robot, *, preset: Preset = "standard") -> WorkspaceMaps:
    """Map lowest stiffness, first frequency and error over the workspace of a robot.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`. Its path is a grid (``counts``) in two or
        three directions.
    preset
        ``"quick"``, ``"standard"`` or ``"fine"``: at most 81, 400 or 2500 poses of the grid.

    Returns
    -------
    WorkspaceMaps
        Lowest stiffness (N/µm), first frequency (Hz) and error (%) over the grid, each with its
        worst posture, which is also searched between the points of the grid. Stiffness and error
        are those of the first model on which the robot file relies, otherwise of the simplest model
        with an error within the limit, otherwise of the model with the smallest error.

    Raises
    ------
    InputError
        If the path is no grid, or fewer than four of its poses can be reached or solved.

    Examples
    --------
    >>> grid = {"from": [-0.2, 0.4], "to": [0.2, 0.5], "counts": [3, 2]}
    >>> maps = workspace({**load("five-bar").tables, "path": grid}, preset="quick")
    >>> maps.values("first frequency").shape
    (3, 2)
    """
    loaded = _loaded(robot)
    if not directions(loaded.mechanism):
        raise InputError(
            f"{loaded.source}: path: must be a grid of poses, counts = […] with two or "
            "three entries above 1"
        )
    try:
        return workspace_maps(Context(loaded, preset))
    except Skip as error:
        raise InputError(f"{loaded.source}: path: {error}") from error


@checked
def vary(robot: Robot, number: str, *, preset: Preset = "standard") -> Designs:
    """Compare designs that differ in one number: results, and the best design by each model.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    number
        ``"KEY=FROM:TO:COUNT"``, as for ``--vary``: ``"leg1.section.thickness=0.004:0.012:5"``.
    preset
        ``"quick"``, ``"standard"`` or ``"fine"``: fineness of the references' meshes.

    Returns
    -------
    Designs
        Largest deflection and smallest first frequency over the path of each design, by all models
        and by the reference.

    Raises
    ------
    InputError
        For a number that the file does not contain, or values that make an invalid robot.
    ComputationError
        If a design cannot be solved.

    Examples
    --------
    >>> designs = vary(bar, "bodies.bar.section.height=0.01:0.03:3", preset="quick")
    >>> designs.best("deflection"), designs.loss("beam")
    (0.03, 0.0)
    """
    loaded = _loaded(robot)
    with arguments_named():
        (variation,) = checked_variations(loaded, [number], preset)
        curves = variation_study(loaded, variation, preset)
    unit = unit_of(loaded.tables, variation.keys[0])
    return Designs(loaded.name, variation, unit, curves)


@checked
def compare_measured(robot: Robot, file: str | Path | None = None) -> MeasuredComparison:
    """Compare every model of a robot with measured values.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`. Values in its ``[[measured]]`` are
        compared, too.
    file
        Measured values (CSV), or a modal test (``.uff``, ``.unv``; needs the extra ``hammer``, and
        ``[hammer]`` in the robot file). None if all values are in the robot file.

    Returns
    -------
    MeasuredComparison
        Comparison error and validation uncertainty of each model and value, with a verdict.

    Raises
    ------
    InputError
        With a line per fault, and if nothing was measured.

    Examples
    --------
    >>> gauge = {"quantity": "z", "load": 100.0, "value": 3.25e-4, "uncertainty": 1e-6}
    >>> compared = compare_measured({**bar, "measured": [{**gauge, "source": "dial gauge"}]})
    >>> print(f"{compared.entry('beam', 'z').error:+.1%}")
    -0.8%
    """
    loaded = _loaded(robot)
    if file is not None:
        loaded = with_measured_file(loaded, Path(file))
    if not loaded.measured:
        raise InputError(
            f"{loaded.source}: has no [[measured]] values; give a file of measured values"
        )
    return MeasuredComparison(measured_matrix(Context(loaded)))


@checked
def export(
    robot: Robot,
    to: Kind,
    *,
    out: str | Path | None = None,
    pose: Sequence[float] | None = None,
    body: str | None = None,
    modes: int = 20,
    force: bool = False,
) -> Path:
    """Write a reduced model of a robot or of one body for another program.

    Parameters
    ----------
    robot
        The robot, as for `load`, or the result of `load`.
    to
        ``"npz"``, ``"exudyn"``, ``"statespace"``, ``"simscape"`` or ``"nastran"``; the last two
        take one `body`.
    out
        Path of the file. If None, a file in the working folder with the names of robot and body.
    pose
        Pose of the tool (m, rad) about which the robot is linearised. None: the reference posture.
    body
        A body without supports. The whole robot if None.
    modes
        Number of natural frequencies for which the reduced model is accurate.
    force
        Replace a file that flexproof did not write.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    InputError
        With a line for each wrong argument.
    ComputationError
        If the model cannot be computed.

    Examples
    --------
    >>> export(bar, "npz", out="bar.npz", modes=2).name
    'bar.npz'
    """
    typed = None if pose is None else ",".join(repr(float(number)) for number in pose)
    with arguments_named():
        return write_export(
            _loaded(robot),
            to,
            pose=typed,
            body=body,
            modes=modes,
            out=None if out is None else Path(out),
            force=force,
        )


def _model_options(options: dict[str, Any]) -> dict[str, Any]:
    """`options` unchanged. Raises InputError with a fault for each value of a wrong type."""
    types = get_type_hints(ModelOptions)
    if faults := [
        fault
        for name, value in options.items()
        if name in types
        for fault in faults_of(name, value, types[name])
    ]:
        raise InputError(faults)
    return options


def _part_faults(
    part: Robot, body: str | None, of_file: Mapping[str, object], unknowns: int, modes: int
) -> list[str]:
    """Faults of the arguments that select a CAD part.

    `of_file`: arguments by name, with the material, that belong to a file of a part, not to a body.
    """
    faults = faults_of_numbers(unknowns, modes)
    if body is not None and any(of_file.values()):
        *names, last = of_file
        faults.append(
            f"body: not with {', '.join(names)} or {last}, which are in the robot file for this "
            "body; leave them out"
        )
    if body is None and not isinstance(part, str | Path):
        faults.append("body: missing; name a part of the robot")
    if body is None and not of_file["material"]:
        faults.append(
            "material: missing; add it, for example {'E': 2.1e11, 'nu': 0.3, 'rho': 7850.0}"
        )
    return faults


def _typed(poses: Sequence[float | Sequence[float]]) -> tuple[str, ...]:
    """Poses as texts in the form of the command line."""
    return tuple(",".join(repr(float(number)) for number in np.atleast_1d(pose)) for pose in poses)


def _loaded(robot: Robot) -> RobotFile:
    if isinstance(robot, RobotFile):
        return robot
    return robot_of(robot) if isinstance(robot, Mapping) else load_robot(robot)
