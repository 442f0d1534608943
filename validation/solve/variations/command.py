"""`solve --vary`: where the robots are computed and what is written of them."""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import variations_of
from validation.console.streams import complain
from validation.models.options import ModelName
from validation.solve import command
from validation.solve.variations.robots import as_csv, as_text, solve_varied
from validation.solve.variations.robots import as_json as json_of
from validation.sweeps.cluster import on_cluster
from validation.sweeps.cores import on_cores
from validation.sweeps.runner import Executor, in_turn


@dataclass(frozen=True)
class Spread:
    """What is varied, as typed, by how many processes or which cluster, and the table's file."""

    typed: tuple[str, ...]
    jobs: int = 1
    cluster: str | None = None
    csv: Path | None = None


def solve_spread(
    robot_file: RobotFile,
    spread: Spread,
    model: ModelName,
    place: command.Place,
    modes: int | None,
    given: dict[str, Any],
    *,
    as_json: bool,
) -> str:
    """The answers as text or JSON; the table goes to a file where one is asked for.

    Raises InputError with one line per fault and ComputationError.
    """
    if not spread.typed:
        raise InputError("--jobs, --cluster, --csv: belong to --vary; leave them out")
    variations = variations_of(robot_file, spread.typed)
    with ExitStack() as stack:
        found = solve_varied(
            robot_file, variations, model, place, modes, given, _executor(spread, stack)
        )
    if spread.csv is not None:
        _write(spread.csv, as_csv(found))
    return json_of(found) if as_json else as_text(found)


def _executor(spread: Spread, stack: ExitStack) -> Executor:
    if spread.cluster is not None:
        return stack.enter_context(on_cluster(spread.cluster, _mention))
    return stack.enter_context(on_cores(spread.jobs)) if spread.jobs > 1 else in_turn


def _mention(line: str) -> None:
    complain([line], 0)


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
