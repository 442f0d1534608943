"""Robots as tests: a fixture that judges a robot's models, and robot files collected as tests.

A test function with the fixture `flexproof`:

    def test_robot(flexproof):
        flexproof("mine.toml").assert_adequate("segments", "f1", within=0.05)

Tests collected from a robot file, one for each model and quantity, and one for each comparison of
formulations with each other:

    pytest --flexproof mine.toml
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from lumped.robot_file import RobotFile
    from validation.comparisons.checks import Check
    from validation.context import Context
    from validation.python.judged import Adequacy

# Assessments of this session, by digest of the robot file, preset and number of modes.
_ASSESSMENTS = pytest.StashKey[dict[tuple[str, str, float | None], "Adequacy"]]()

# Contexts of this session's comparisons, by digest of the robot file and preset.
_CONTEXTS = pytest.StashKey[dict[tuple[str, str], "Context"]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the plugin."""
    group = parser.getgroup("flexproof")
    group.addoption(
        "--flexproof",
        action="append",
        default=[],
        metavar="ROBOT",
        help=(
            "collect a robot (file or built-in name) as tests: one per model and quantity "
            "for its adequacy, its agreement with solid FE and its convergence"
        ),
    )
    group.addoption(
        "--flexproof-preset",
        default="standard",
        choices=("quick", "standard", "fine"),
        help="mesh refinement of the references: quick, standard or fine",
    )
    group.addoption(
        "--flexproof-strict", action="store_true", help="undecided verdicts fail as well"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Create stores of results. Raises UsageError with the faults of a requested robot file.

    Workers of pytest-xdist do not check the files, because a fault ends the session before they
    start.
    """
    config.stash[_ASSESSMENTS] = {}
    config.stash[_CONTEXTS] = {}
    if not hasattr(config, "workerinput"):
        for robot in config.getoption("flexproof"):
            _robot_file(robot)


@pytest.fixture
def flexproof(request: pytest.FixtureRequest) -> Callable[..., "Adequacy"]:
    """Fixture `flexproof(robot, accept=…)`: adequacy of a robot's models, once per session.

    A relative path is sought first in the folder of the test.
    """

    def judge(robot: str | Path, accept: Mapping[str, float] | None = None) -> "Adequacy":
        path_beside_test = request.path.parent / robot
        return _assessment(
            request.config, path_beside_test if path_beside_test.is_file() else robot, accept
        )

    return judge


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(
    session: pytest.Session, config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Add tests for the requested robots."""
    for robot in config.getoption("flexproof"):
        collector = RobotCollector.from_parent(session, path=Path(robot).absolute(), robot=robot)
        items.extend(collector.collect())


class RobotCollector(pytest.File):
    """Collector that turns a robot file into tests."""

    def __init__(self, *, robot: str, **node: Any) -> None:
        super().__init__(**node)
        self.robot = robot

    def collect(self) -> Iterator[pytest.Item]:
        """Tests for each model and quantity, then for each comparison.

        Raises UsageError with the faults of the file.
        """
        from validation.adequacy.judged_models import judged_models  # noqa: PLC0415
        from validation.comparisons.checks import checks  # noqa: PLC0415

        robot_file = _robot_file(self.robot)
        for model in judged_models(robot_file.mechanism):
            for quantity in (entry.name for entry in robot_file.requirement.quantities):
                name = f"{model}.{quantity}"
                yield ModelItem.from_parent(self, name=name, model=model, quantity=quantity)
        for check in checks(robot_file):
            yield ComparisonItem.from_parent(self, name=check.name, check=check)


class _RobotItem(pytest.Item):
    """Test of a robot file. An undecided verdict is skipped, or fails with --flexproof-strict."""

    def conclude(self, verdict: str, text: str) -> None:
        """Skip or fail the test unless the verdict is "adequate" or "agree"."""
        if verdict == "undecided" and not self.config.getoption("flexproof_strict"):
            pytest.skip(text)
        if verdict not in {"adequate", "agree"}:
            pytest.fail(text, pytrace=False)

    def reportinfo(self) -> tuple[Path, None, str]:
        """File, line (None) and name of the test, for the reports of pytest."""
        return self.path, None, self.name


class ModelItem(_RobotItem):
    """Test of one model for one quantity. Passed if adequate, skipped if undefined or undecided."""

    def __init__(self, *, model: str, quantity: str, **node: Any) -> None:
        super().__init__(**node)
        self.model, self.quantity = model, quantity

    def runtest(self) -> None:
        """Judge the model for the quantity. The assessment is computed once per session."""
        assert isinstance(self.parent, RobotCollector)  # noqa: S101  for the type checker
        adequacy = _assessment(self.config, self.parent.robot, None)
        entry = adequacy.matrix.entry(self.model, self.quantity)
        if entry is None:
            pytest.skip(f"model {self.model} does not define {self.quantity}")
        if entry.error is None and self.model in adequacy.matrix.faults:
            pytest.fail(adequacy.describe(entry), pytrace=False)
        self.conclude(entry.verdict, adequacy.describe(entry))


class ComparisonItem(_RobotItem):
    """Test of agreement with a solid, or of convergence. Skipped if not compared, or undecided."""

    def __init__(self, *, check: "Check", **node: Any) -> None:
        super().__init__(**node)
        self.check = check

    def runtest(self) -> None:
        """Compute the comparison. Solids and studies are computed once per session."""
        from fem.machine import one_blas_thread  # noqa: PLC0415
        from lumped.errors import ComputationError, InputError  # noqa: PLC0415
        from validation.case import Skip  # noqa: PLC0415

        assert isinstance(self.parent, RobotCollector)  # noqa: S101  for the type checker
        try:
            with one_blas_thread():
                result = self.check.compute(_context(self.config, self.parent.robot))
        except Skip as reason:
            pytest.skip(str(reason))
        except (ComputationError, InputError) as error:
            pytest.fail(f"{self.name}: {error}", pytrace=False)
        self.conclude(result.verdict, result.text)


def _robot_file(robot: str) -> "RobotFile":
    """Robot file of a requested robot. Raises UsageError with the faults of the file."""
    from lumped.errors import InputError  # noqa: PLC0415  loaded only by sessions that need it
    from lumped.robot_file import load_robot  # noqa: PLC0415

    try:
        return load_robot(robot)
    except InputError as error:
        raise pytest.UsageError("\n".join(error.faults)) from error


def _context(config: pytest.Config, robot: str) -> "Context":
    from validation.context import Context  # noqa: PLC0415  loads the finite elements

    robot_file = _robot_file(robot)
    preset, contexts = config.getoption("flexproof_preset"), config.stash[_CONTEXTS]
    key = robot_file.sha256, preset
    if key not in contexts:
        contexts[key] = Context(robot_file, preset)
    return contexts[key]


def _assessment(
    config: pytest.Config, robot: str | Path, accept: Mapping[str, float] | None
) -> "Adequacy":
    from validation.api import adequacy, load  # noqa: PLC0415  loads the finite elements

    loaded = load(robot)
    preset = config.getoption("flexproof_preset")
    assessments = config.stash[_ASSESSMENTS]
    # New limits need no new computation, but a new number of modes does.
    modes = {"modes": accept["modes"]} if accept and "modes" in accept else {}
    key = loaded.sha256, preset, modes.get("modes")
    if key not in assessments:
        assessments[key] = adequacy(loaded, preset=preset, accept=modes)
    return assessments[key].accepting(accept) if accept else assessments[key]
