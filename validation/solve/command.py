"""Which of both kinds of robot files is solved, and what neither takes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from lumped.biglide import Biglide
from lumped.errors import InputError
from lumped.robot_file import RobotFile
from validation.models.options import ModelName
from validation.solve.answer import Solution
from validation.solve.biglide import BiglideQuestion, checked_biglide, solve_biglide
from validation.solve.cost import Cost
from validation.solve.mechanism import MechanismQuestion, checked_mechanism, solve_mechanism


@dataclass(frozen=True)
class Place:
    """Where a robot is solved, as typed: positions `x` (m) or `poses`, or one `leg` or `body`."""

    x: tuple[float, ...] = ()
    poses: tuple[str, ...] = ()
    leg: int | None = None
    body: str | None = None


Question: TypeAlias = BiglideQuestion | MechanismQuestion


def question(
    robot_file: RobotFile,
    model: ModelName,
    place: Place,
    modes: int | None,
    given: dict[str, Any],
    against: ModelName | None = None,
) -> Question:
    """What is asked of the robot; `given` are the options typed, `against` a model to pair with.

    Raises InputError where the kind of robot has no such place.
    """
    robot = robot_file.described
    if not isinstance(robot, Biglide):
        faults = ["--x: poses of a mechanism are typed as --pose"] if place.x else []
        if place.leg is not None:
            faults.append("--leg: bodies of a mechanism have names; take --body")
        if faults:
            raise InputError(faults)
        return MechanismQuestion(model, modes, given, robot, place.poses, place.body, against)
    if against is not None:
        raise InputError("--against: modes are paired by shape for robots of schema 2 alone")
    if place.body is not None:
        raise InputError("--body: the biglide has two legs; take --leg 1 or --leg 2")
    positions = (*place.x, *_positions(place.poses))
    return BiglideQuestion(model, modes, given, robot, positions, place.leg)


def checked(asked: Question) -> Cost:
    """What the answer will cost.

    Raises InputError, all faults of the question at once, or where it costs too much.
    """
    if isinstance(asked, BiglideQuestion):
        return checked_biglide(asked)
    return checked_mechanism(asked)


def solve(asked: Question) -> Solution:
    """The model's answers; raises InputError as `checked` does, ComputationError."""
    return solve_biglide(asked) if isinstance(asked, BiglideQuestion) else solve_mechanism(asked)


def _positions(poses: Sequence[str]) -> list[float]:
    """Poses of the biglide are positions x of B."""
    positions, faults = [], []
    for text in poses:
        try:
            positions.append(float(text))
        except ValueError:
            faults.append(f"--pose {text}: must be one number, the position x of B in m")
    if faults:
        raise InputError(faults)
    return positions
