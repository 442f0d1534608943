"""`solve --vary`: what is asked of which robots, and where they are computed."""

from contextlib import ExitStack
from dataclasses import dataclass

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import variations_of
from validation.console.streams import complain
from validation.run.cluster import on_cluster
from validation.run.executor import Executor, in_turn, on_cores
from validation.solve.question import Asked
from validation.solve.variations.robots import VariedAnswers, solve_varied


@dataclass(frozen=True)
class Spread:
    """What is varied, as typed, and by how many processes or which cluster.

    `drawn`: whether the answers are to be a picture, too.
    """

    typed: tuple[str, ...]
    jobs: int = 1
    cluster: str | None = None
    drawn: bool = False


def solve_spread(robot_file: RobotFile, spread: Spread, asked: Asked) -> VariedAnswers:
    """The answers for all robots.

    Raises InputError with one line per fault and ComputationError.
    """
    if not spread.typed:
        raise InputError("--jobs, --cluster, --csv, --picture: belong to --vary; leave them out")
    variations = variations_of(robot_file, spread.typed)
    if spread.drawn:
        from validation.solve.variations.picture import require_few_curves  # noqa: PLC0415

        require_few_curves(variations, max(1, len(asked.poses) + len(asked.x)))
    with ExitStack() as stack:
        executor = _executor(spread, stack)
        return solve_varied(robot_file, variations, asked, executor)


def _executor(spread: Spread, stack: ExitStack) -> Executor:
    if spread.cluster is not None:
        return stack.enter_context(on_cluster(spread.cluster, _mention))
    return stack.enter_context(on_cores(spread.jobs)) if spread.jobs > 1 else in_turn


def _mention(line: str) -> None:
    complain([line], 0)
