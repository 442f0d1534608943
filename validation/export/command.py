"""Command `export` of the command line.

Input: the name of a robot file, a pose or a body, and a format. Output: a file with a reduced
model.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, TypeAlias

from cyclopts import Parameter

from lumped.errors import InputError
from validation.console.typed import (
    DEFAULT_SOLVER,
    Force,
    PathArgument,
    RobotName,
    SolverChoice,
    WholeNumber,
    require_writable,
    write,
)

if TYPE_CHECKING:
    from lumped.mechanism.mechanism import Mechanism
    from lumped.robot_file import RobotFile

Kind: TypeAlias = Literal["exudyn", "simscape", "nastran", "statespace", "npz"]


class Format(NamedTuple):
    """Properties of an output format. Its content is in `validation.export.formats`.

    `endings`: allowed suffixes of the file, the first of which is the default. `subject`: what the
    format can contain. `extra`: optional extra of flexproof that it needs, "" if none.
    """

    endings: tuple[str, ...]
    subject: Literal["body", "robot", "body or robot"] = "body or robot"
    extra: str = ""


FORMATS: Mapping[Kind, Format] = {
    "exudyn": Format((".py",)),
    "simscape": Format((".mat",), "body"),
    "nastran": Format((".bdf",), "body", extra="nastran"),
    "statespace": Format((".npz", ".mat"), "robot"),
    "npz": Format((".npz",)),
}
# More modes than any reduction contains.
_MOST_MODES = 200


def export(
    robot: RobotName,
    *,
    to: Kind,
    pose: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    body: str | None = None,
    modes: WholeNumber = 20,
    solver: SolverChoice = DEFAULT_SOLVER,
    out: PathArgument | None = None,
    force: Force = False,
) -> int:
    """Write a body, or the robot about one pose, as a reduced model with a bound on its error.

    Legs with a section and CAD parts are solids. All numbers are in SI units.

    Parameters
    ----------
    to
        npz: matrices for numpy. exudyn: a Python script for EXUDYN. statespace: matrices A, B, C, D
        of a robot from drive forces and wrench at the tool to the tool's twist. simscape: a Reduced
        Order Flexible Solid (.mat) of a body. nastran: DMIG of a body (needs the extra "nastran").
    pose
        Pose of the tool, numbers separated by commas. Default: the reference posture.
    body
        A leg with a section, or a CAD part. Default: the whole robot.
    modes
        Number of frequencies of the robot for which the model is accurate.
    out
        File to write. Default: a file in this folder, named after robot and body, with the ending
        of its kind. The state space may be .npz or .mat.
    """
    solver.request()
    write_export(robot, to, pose=pose, body=body, modes=modes, out=out, force=force)
    return 0


def write_export(
    robot: "RobotFile | str",
    to: Kind,
    *,
    pose: str | None,
    body: str | None,
    modes: int,
    out: Path | None,
    force: bool,
) -> Path:
    """Write the reduced model of a robot or of its `body`. Returns the path of the file.

    Arguments are those of `export`. Raises InputError and ComputationError.
    """
    from fem.extras import require_extra  # noqa: PLC0415
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from meshes.processes import in_own_process  # noqa: PLC0415
    from validation.console.progress import stage  # noqa: PLC0415

    if not 1 <= modes <= _MOST_MODES:
        raise InputError(f"--modes {modes}: must be from 1 to {_MOST_MODES}")
    output = FORMATS[to]
    if body is None and output.subject == "body":
        raise InputError(f"--to {to}: exports one body; name it with --body")
    if body is not None and (output.subject == "robot" or pose is not None):
        option = f"--to {to}" if output.subject == "robot" else "--pose"
        raise InputError(
            f"--body: not with {option}, which exports the whole robot; leave --body out"
        )
    if output.extra:
        require_extra(output.extra, f"--to {to}")
    robot_file = load_robot(robot) if isinstance(robot, str) else robot
    mechanism = robot_file.mechanism
    if body is not None and body not in mechanism.bodies:
        raise InputError(f"--body {body}: must be one of {', '.join(mechanism.bodies)}")
    name_parts = [
        Path(robot_file.source).stem,
        *([body] if body else []),
        *([to] if output.subject == "robot" else []),
    ]
    path = out or Path(".".join(name_parts) + output.endings[0])
    ending = path.suffix
    if ending not in output.endings:
        raise InputError(f"--out {path}: must end in {' or '.join(output.endings)}")
    require_writable(path, ending, force=force)
    with stage("meshing and reducing", _seconds(mechanism, body, modes)):
        content = in_own_process(_content, robot_file, to, pose, body, modes, ending)
    write(path, content, ending)
    return path


def _seconds(mechanism: "Mechanism", body: str | None, modes: int) -> float:
    """Estimated computing time (s) of the solids. Legs specified by their 6×6 need none."""
    from lumped.legs import GivenLeg  # noqa: PLC0415
    from lumped.models.bodies import legs_of  # noqa: PLC0415
    from validation.models.options import DEFAULT_OPTIONS  # noqa: PLC0415
    from validation.solve.cost import PER_PART, solid_cost  # noqa: PLC0415

    legs = [leg for name, leg in legs_of(mechanism).items() if body in (None, name)]
    prisms = dict.fromkeys(leg for leg in legs if not isinstance(leg, GivenLeg))
    parts = sum(body in (None, name) for name in mechanism.parts)
    return solid_cost(tuple(prisms), DEFAULT_OPTIONS.divisions, modes).seconds + PER_PART * parts


def _content(
    robot_file: "RobotFile", to: str, pose: str | None, body: str | None, count: int, ending: str
) -> bytes:
    """Bytes of the exported file. Runs in a separate process.

    `to`, `pose` and `body` are options of `export`. `count`: number of frequencies for which the
    model is accurate. `ending`: suffix of the file, such as ".mat".
    """
    from lumped.mechanism.kinematics.postures import posture, reference_posture  # noqa: PLC0415
    from validation.export import formats, reduced  # noqa: PLC0415
    from validation.kinematics.poses import parsed_pose  # noqa: PLC0415
    from validation.models.robot_models import highest_frequency  # noqa: PLC0415

    mechanism = robot_file.mechanism
    robot_posture = reference_posture(mechanism)
    if pose is not None:
        robot_posture = posture(mechanism, parsed_pose(mechanism, pose))
    if body is not None:
        highest = highest_frequency([robot_posture], count)
        return formats.OF_BODIES[to](reduced.reduced_body(mechanism, body, highest))
    robot = reduced.reduced_robot(robot_posture, count)
    if to in formats.OF_ROBOTS:
        return formats.OF_ROBOTS[to](robot, ending)
    return formats.OF_BODIES[to](robot.matrices)
