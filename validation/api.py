"""flexproof from Python: load a robot, solve a model, judge the models, run everything.

Results are frozen dataclasses that show themselves in a notebook. Errors of input are
`lumped.errors.InputError` with a line per fault, failures of a computation `ComputationError`.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from fem.machine import usable_cores
from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.legs import Theory
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.evidence import with_options
from validation.adequacy.judgement import judged
from validation.adequacy.response import Subject
from validation.adequacy.robot import judged_robot
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.readings import RefinedModel
from validation.comparisons.requested import convergence
from validation.console.arguments import checked, faults_of
from validation.console.typed import MOST_PROCESSES
from validation.context import Context, Preset
from validation.cross_validation import CrossValidation, cross_validation
from validation.drawing.text import error_with_spread, percent
from validation.models.options import ModelName, ModelOptions
from validation.report.table import table_of
from validation.report.words import force_text, pose_text, sentence
from validation.solve.answer import Solution
from validation.solve.model_answers import solve as answered
from validation.solve.question import Question
from validation.tables import Cell, ResultTable, html_paragraph, html_table
from validation.verdicts import Entry, Matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Robot = RobotFile | str | Path


@checked
def load(robot: str | Path, *, accept: Mapping[str, float] | None = None) -> RobotFile:
    """A built-in robot by name, or that of a file; `accept` as in `--accept` overrides its limits.

    Raises InputError with every fault of the file.
    """
    loaded = load_robot(robot)
    return replace(loaded, requirement=_accepting(loaded.requirement, accept or {}))


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
    """What one model answers, where and with the options that `flexproof solve` takes.

    `poses` (m, rad) in the order of what the tool's pose prescribes, a number alone where that is
    one coordinate; the middle of the path if none is given. `leg` or `body` ask
    for one alone. Raises InputError, ComputationError.
    """
    types = get_type_hints(ModelOptions)
    if faults := [
        fault
        for name, value in options.items()
        if name in types
        for fault in faults_of(name, value, types[name])
    ]:
        raise InputError(faults)
    typed = tuple(",".join(repr(float(number)) for number in np.atleast_1d(one)) for one in poses)
    with _arguments_named():
        asked = Question(_loaded(robot), model, options, modes, poses=typed, leg=leg, body=body)
        return answered(asked)


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
    """Convergence with element count, of a `body` that is a leg or of the whole robot.

    `model`: "segments", "beam" or "solid" (with `divisions` across the section, for a body);
    segments and beam elements if None. `theory` of both: "timoshenko" if None, or
    "euler-bernoulli". The robot stands in the middle of its path.
    Raises InputError, ComputationError.
    """
    loaded = _loaded(robot)
    with _arguments_named():
        return convergence(
            loaded.mechanism,
            model=model,
            body=body,
            elements=elements,
            divisions=divisions,
            theory=theory,
            limits=loaded.agreement,
        )


@checked
def cross_validate(robot: Robot, *, preset: Preset = "standard") -> CrossValidation:
    """Compare all formulations of the robot's legs with solids, and study their convergence.

    The numbers are those of the chapter "Cross-validation" of a report with this preset.
    Raises InputError, and ComputationError if a convergence study fails.
    """
    return cross_validation(Context(_loaded(robot), preset))


@dataclass(frozen=True)
class Adequacy:
    """The models of a robot judged: `matrix` model × quantity, against what and by how much."""

    matrix: Matrix
    requirement: Requirement
    subject: Subject

    @property
    def sentence(self) -> str:
        """The answer in one sentence, as the report gives it."""
        return sentence(self.matrix, self.requirement.rely)

    @checked
    def entry(self, model: str, quantity: str, within: float | None = None) -> Entry:
        """What is known of a model and a quantity, judged by another limit where one is given.

        Raises InputError where the model says nothing of the quantity.
        """
        matrix = self.matrix if within is None else self._within(model, quantity, within)
        found = matrix.entry(model, quantity)
        if found is None:
            raise InputError(self._nothing_said(model, quantity))
        return found

    @checked
    def assert_adequate(self, model: str, quantity: str, within: float | None = None) -> None:
        """Nothing where the model is adequate, within its limit or the one given.

        Raises AssertionError with error, pose, cause and remedy where it is not, or undecided.
        """
        found = self.entry(model, quantity, within)
        if found.verdict != "adequate":
            raise AssertionError(self.told(found))

    @checked
    def accepting(self, accept: Mapping[str, float]) -> "Adequacy":
        """The same errors judged by other limits.

        Raises InputError for names there are not, and for more modes than were computed.
        """
        requirement = _accepting(self.requirement, accept)
        if requirement.modes > self.requirement.modes:
            raise InputError(
                f"accept: modes = {requirement.modes}: must be at most {self.requirement.modes}, "
                "as many as were computed; ask for more in `adequacy`"
            )
        return Adequacy(judged(self.subject, requirement), requirement, self.subject)

    def told(self, entry: Entry) -> str:
        """An entry in one line."""
        said = [f"{entry.model}, {entry.quantity}: {entry.verdict}"]
        if entry.error is not None:
            said.append(
                f"error {error_with_spread(entry)} at "
                f"{pose_text(self.matrix.coordinates, entry.pose)}, "
                f"accepted {percent(entry.limit, signed=False)}"
            )
        if entry.along is not None:
            worst = f" of a force along {force_text(entry)}" if entry.force else ""
            said.append(f"along the load{worst} {percent(entry.along)}")
        said += [f"cause: {entry.causes[0].cause}"] if entry.causes else []
        if entry.remedy:
            left = entry.error_with_remedy
            then = "" if left is None else f" ({percent(left, signed=entry.signed)} left)"
            said.append(f"remedy: {entry.remedy}{then}")
        said += [entry.reason] if entry.reason else []
        return "; ".join(said).replace("\N{NO-BREAK SPACE}", " ")

    def _within(self, model: str, quantity: str, limit: float) -> Matrix:
        candidates = [one for one in self.subject.candidates if one.model == model]
        asked = _accepting(self.requirement, {quantity: limit})
        return judged(replace(self.subject, candidates=candidates, parts=()), asked)

    def _nothing_said(self, model: str, quantity: str) -> str:
        models = [note.model for note in self.matrix.models]
        if model not in models:
            return f'model "{model}" is not judged; there are {", ".join(models)}'
        names = [one.name for one in self.matrix.quantities]
        if quantity not in names:
            return f'quantity "{quantity}" is not judged; there are {", ".join(names)}'
        return f'model "{model}" says nothing of "{quantity}"'

    def table(self) -> ResultTable:
        """A row for each model and quantity, errors and limits in per cent."""
        return ResultTable(
            _HEADINGS, tuple(_row(self.matrix, entry) for entry in self.matrix.entries)
        )

    def plot(self) -> "Figure":
        """Errors of the deflections and of the first frequencies over the path, by model.

        The shaded band is the limit. Raises InputError if no error could be computed.
        """
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415
        from validation.drawing.style import plot_style  # noqa: PLC0415
        from validation.report.figures.adequacy import error_curves  # noqa: PLC0415

        curves = error_curves(self.matrix)
        if curves is None or curves.chart is None:
            raise InputError("plot: no error of a deflection or a frequency was computed")
        with plot_style():
            return drawn_chart(curves.chart)

    def _repr_html_(self) -> str:
        shown = table_of(self.matrix)
        rows = [
            [row.name, *("–" if cell is None else f"{cell.text} {cell.mark}" for cell in row.cells)]
            for row in shown.rows
        ]
        verdicts = [
            [None, *(None if cell is None else cell.entry.verdict for cell in row.cells)]
            for row in shown.rows
        ]
        headings = ("model", *shown.headings)
        return html_paragraph(self.sentence) + html_table(headings, rows, verdicts)


_HEADINGS = (
    *("model", "quantity", "verdict", "error (%)", "half-width (%)", "low (%)", "high (%)"),
    *("limit (%)", "pose", "cause", "remedy"),
)


def _row(matrix: Matrix, entry: Entry) -> tuple[Cell, ...]:
    errors = entry.error, entry.uncertainty, entry.low, entry.high
    return (
        entry.model,
        str(entry.quantity),
        entry.verdict,
        *(None if share is None else 100.0 * share for share in errors),
        100.0 * entry.limit,
        pose_text(matrix.coordinates, entry.pose) if entry.pose else None,
        entry.causes[0].cause if entry.causes else None,
        entry.remedy or None,
    )


@checked
def adequacy(
    robot: Robot, *, preset: Preset = "standard", accept: Mapping[str, float] | None = None
) -> Adequacy:
    """Judge every model of a robot by every quantity, within `accept` or what its file accepts.

    What has no reference is undecided. Raises InputError, and ComputationError where a posture of
    the path cannot be computed.
    """
    loaded = _loaded(robot)
    requirement = _accepting(loaded.requirement, accept or {})
    subject, matrix = judged_robot(Context(replace(loaded, requirement=requirement), preset))
    return Adequacy(matrix, requirement, subject)


@dataclass(frozen=True)
class Run:
    """A finished run: its folder `out`, exit code, comparisons by verdict, the matrix if made."""

    out: Path
    exit_code: int
    verdicts: Mapping[str, int]
    matrix: Matrix | None
    seconds: float

    @property
    def report(self) -> Path:
        """The page to be opened in a browser."""
        return self.out / "report.html"

    def _repr_html_(self) -> str:
        said = html_paragraph(sentence(self.matrix)) if self.matrix else ""
        rows = [[verdict, str(count)] for verdict, count in self.verdicts.items()]
        return said + html_table(("verdict", "comparisons"), rows)


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
    """Everything that `flexproof run` does, into the folder `out`.

    `vary`: numbers of the robot file with their values, as `--vary` has them.
    Raises InputError before anything is written, ComputationError where the run cannot go on.
    """
    # The session loads every case; solving a model needs none of them.
    from validation.catalogue import catalogue  # noqa: PLC0415
    from validation.validate import Request, validate  # noqa: PLC0415

    if jobs is not None and not 1 <= jobs <= MOST_PROCESSES:
        raise InputError(f"jobs = {jobs}: must be a whole number from 1 to {MOST_PROCESSES}")
    cores = jobs or usable_cores()
    request = Request(_loaded(robot), preset, Path(out), cores, only, vary=vary)
    with _arguments_named():
        gathered = validate(request, catalogue)
    found = [outcome.verdict for outcome in gathered.outcomes]
    return Run(
        out=gathered.path,
        exit_code=gathered.standing.exit_code,
        verdicts={verdict: found.count(verdict) for verdict in dict.fromkeys(found)},
        matrix=gathered.matrix,
        seconds=float(gathered.header["seconds"]),
    )


_OPTION = re.compile(r"(?<!\S)--([a-z]+)")
# Arguments that are called otherwise than the options of the command line.
_ARGUMENTS = {"pose": "poses", "x": "poses"}


@contextmanager
def _arguments_named() -> Iterator[None]:
    """Faults of input name the arguments of these functions, not options of the command line."""

    def argument(option: re.Match[str]) -> str:
        return _ARGUMENTS.get(option[1], option[1])

    try:
        yield
    except InputError as error:
        raise InputError([_OPTION.sub(argument, fault) for fault in error.faults]) from error


def _loaded(robot: Robot) -> RobotFile:
    return robot if isinstance(robot, RobotFile) else load_robot(robot)


def _accepting(requirement: Requirement, accept: Mapping[str, float]) -> Requirement:
    with _arguments_named():
        return with_options(requirement, [f"{name}={limit}" for name, limit in accept.items()], ())
