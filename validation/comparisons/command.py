"""Command `converge` of the command line.

Input: the name of a robot file, a body or the whole robot, and options. Output: errors and orders
of convergence as text on stdout, and the requested files.
"""

import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from lumped.errors import InputError
from lumped.model_choices import Theory
from validation.console.streams import write_messages, write_results
from validation.console.typed import (
    DEFAULT_SOLVER,
    AsJson,
    Force,
    PathArgument,
    RobotName,
    SolverChoice,
    require_distinct,
    require_writable,
    write,
)
from validation.models.options import RefinedModel

if TYPE_CHECKING:
    from collections.abc import Callable

    from lumped.robot_file import RobotFile
    from validation.comparisons.convergence_study import ConvergenceStudy
    from validation.run.provisions import Provisions

# Dots per inch of a PNG picture.
_DOTS = 150


def converge(
    robot: RobotName = "ifw",
    *,
    body: str | None = None,
    model: RefinedModel | None = None,
    elements: str | None = None,
    divisions: str | None = None,
    theory: Theory | None = None,
    quantity: str = "f1",
    within: float | None = None,
    json: AsJson = False,
    csv: PathArgument | None = None,
    picture: PathArgument | None = None,
    solver: SolverChoice = DEFAULT_SOLVER,
    cluster: str | None = None,
    force: Force = False,
) -> int:
    """Show how frequencies and deflections converge with element count or with the mesh.

    Parameters
    ----------
    body
        Leg that is solved alone, with its root clamped, and compared with the exact cantilever.
        Default: the whole robot in the middle of its path.
    model
        segments, beam, or solid (which needs --body). Default: segments and beam.
    elements
        Element counts per leg, separated by commas, such as 5,10,20,40.
    divisions
        solid: quadratic elements across the smaller side of the section, such as 2,4,8.
    theory
        segments and beam: euler-bernoulli or timoshenko; timoshenko if left out.
    quantity
        Quantity of the table: f1 to f4, or x, y, z, the deflection along a unit force.
    within
        Largest accepted relative error, for example 0.01, at the element count of [agree] in the
        robot file (20 by default); exit code 1 if the error is larger. Default: limit of [agree].
    csv
        Also write values and errors into this CSV file.
    picture
        Also draw the errors of f1 to f4 into this file (.png or .svg).
    cluster
        Address of a Dask scheduler (tcp://host:port) whose workers solve one element count or one
        mesh each; needs the extra "cluster".
    """
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.comparisons.element_convergence import (  # noqa: PLC0415
        QUANTITIES,
        storing,
    )
    from validation.comparisons.requested import convergence  # noqa: PLC0415
    from validation.run.cluster import requested_executor  # noqa: PLC0415
    from validation.run.executor import in_order  # noqa: PLC0415
    from validation.run.provisions import provisions  # noqa: PLC0415

    solver.request()
    require_writable(csv, ".csv", force=force)
    kind = _picture_kind(picture)
    require_writable(picture, kind, force=force)
    require_distinct(csv, picture)
    if within is not None and not 0.0 < within < 1.0:
        raise InputError(f"--within = {within:g}: must be above 0 and below 1 (1 % is 0.01)")
    if quantity not in QUANTITIES:
        raise InputError(f"--quantity {quantity}: must be one of {', '.join(QUANTITIES)}")
    robot_file = load_robot(robot)
    study_of = partial(
        convergence,
        model=model,
        body=body,
        elements=_counts("--elements", elements),
        divisions=_counts("--divisions", divisions),
        theory=theory,
    )
    with requested_executor(cluster) as executor:
        if cluster is not None and robot_file.mechanism.parts:
            # The machine that computes the study needs the files of the parts, to section them.
            sent = partial(_study_of_parts, study_of, provisions(robot_file), robot_file)
            (study,) = in_order(executor, [sent])
        else:
            study = study_of(robot_file, executor=storing(executor, robot_file.mechanism))
    missed = study.missed(quantity, within)
    write_results(study.json() if json else study.text(quantity))
    if csv is not None:
        write(csv, study.csv().encode(), ".csv")
    if picture is not None:
        write(picture, study.picture(kind, _DOTS), kind)
    return write_messages(missed, 1) if missed else 0


def _study_of_parts(
    study_of: "Callable[[RobotFile], ConvergenceStudy]",
    sent: "Provisions",
    robot_file: "RobotFile",
) -> "ConvergenceStudy":
    """Convergence study by `study_of`, on a machine that lacks the files of the CAD parts.

    `sent` contains these files, and cache entries that this machine may lack.
    """
    return study_of(sent.unpack(robot_file))


def _counts(option: str, typed: str | None) -> tuple[int, ...] | None:
    """Whole numbers in the text `typed` of an `option`, separated by commas.

    None if `typed` is None. Raises InputError for any other text.
    """
    if typed is None:
        return None
    numbers = [number.strip() for number in typed.split(",")]
    if not all(re.fullmatch(r"[1-9]\d{0,3}", number) for number in numbers):
        raise InputError(
            f"{option} = {typed}: must be whole numbers from 1 to 9999 separated by commas, "
            "such as 5,10,20,40"
        )
    return tuple(int(number) for number in numbers)


def _picture_kind(picture: Path | None) -> str:
    """Suffix of the picture's file name. Raises InputError for a kind that cannot be drawn."""
    kind = ".png" if picture is None else picture.suffix.lower()
    if kind not in {".png", ".svg"}:
        raise InputError(f"--picture {picture}: must end in .png or .svg")
    return kind
