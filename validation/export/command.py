"""The command `export`, as the command line takes it up."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from cyclopts import Parameter

from fem.solvers.backends.choice import request_solver
from lumped.errors import InputError
from validation.console.typed import (
    Force,
    PathArgument,
    RobotName,
    SolverName,
    WholeNumber,
    require_writable,
    write,
)

if TYPE_CHECKING:
    from lumped.mechanism.mechanism import Mechanism
    from lumped.robot_file import RobotFile

Kind: TypeAlias = Literal["exudyn", "simscape", "nastran", "statespace", "npz"]
_ENDINGS = {"exudyn": ".py", "nastran": ".bdf", "simscape": ".mat"}
# More than any reduction keeps.
_MOST_MODES = 200


def export(
    robot: RobotName,
    *,
    to: Kind,
    pose: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    body: str | None = None,
    modes: WholeNumber = 20,
    solver: SolverName = None,
    out: PathArgument | None = None,
    force: Force = False,
) -> int:
    """Write a body, or the robot about one pose, as a reduced model with a bound on its error.

    Legs with a section and CAD parts are solids. SI units throughout.

    Parameters
    ----------
    to
        npz: matrices for numpy. exudyn: a script that runs. statespace: A, B, C, D from drives and
        wrench at the tool to the tool's twist, of a robot. simscape: a Reduced Order Flexible Solid
        (.mat), nastran: DMIG (needs the extra "nastran"), both of a body.
    pose
        Pose of the tool, numbers separated by commas; the reference posture if left out.
    body
        A leg with a section, or a CAD part; the whole robot if left out.
    modes
        How many frequencies of the robot the model is good for.
    out
        The file; if left out named by robot and body, with the ending of its kind, in this folder.
        The state space takes .npz and .mat.
    """
    request_solver(solver)
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
    """Write the reduced model of a robot or of its `body`, and return the file's path.

    Arguments as of `export`. Raises InputError, ComputationError.
    """
    from fem.extras import require_extra  # noqa: PLC0415
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from meshes.processes import in_own_process  # noqa: PLC0415
    from validation.console.progress import stage  # noqa: PLC0415

    if not 1 <= modes <= _MOST_MODES:
        raise InputError(f"--modes {modes}: must be from 1 to {_MOST_MODES}")
    if body is None and to in {"simscape", "nastran"}:
        raise InputError(f"--to {to}: takes one body; name it with --body")
    if body is not None and (to == "statespace" or pose is not None):
        whole = "--to statespace" if to == "statespace" else "--pose"
        raise InputError(f"--body: must be left out with {whole}, which is of the whole robot")
    if to == "nastran":
        require_extra("nastran", "--to nastran")
    robot_file = load_robot(robot) if isinstance(robot, str) else robot
    mechanism = robot_file.mechanism
    if body is not None and body not in mechanism.bodies:
        raise InputError(f"--body {body}: must be one of {', '.join(mechanism.bodies)}")
    ending = _ENDINGS.get(to, ".npz")
    what = [
        Path(robot_file.source).stem,
        *([body] if body else []),
        *(["statespace"] if to == "statespace" else []),
    ]
    place = out or Path(".".join(what) + ending)
    if to == "statespace" and place.suffix == ".mat":
        ending = ".mat"
    if place.suffix != ending:
        raise InputError(f"--out {place}: must end in {ending}")
    require_writable(place, ending, force=force)
    with stage("meshing and reducing", _seconds(mechanism, body, modes)):
        content = in_own_process(_content, robot_file, to, pose, body, modes, ending)
    write(place, content, ending)
    return place


def _seconds(mechanism: "Mechanism", body: str | None, modes: int) -> float:
    """How long the solids take, a leg known by its 6×6 being none."""
    from lumped.legs import ConstantLeg  # noqa: PLC0415
    from lumped.models.bodies import legs_of  # noqa: PLC0415
    from validation.models.options import DEFAULT_OPTIONS  # noqa: PLC0415
    from validation.solve.cost import PER_PART, solid_cost  # noqa: PLC0415

    own = {name: leg for name, leg in legs_of(mechanism).items() if body in (None, name)}
    prisms = dict.fromkeys(leg for leg in own.values() if isinstance(leg, ConstantLeg))
    parts = sum(body in (None, name) for name in mechanism.parts)
    return solid_cost(tuple(prisms), DEFAULT_OPTIONS.divisions, modes).seconds + PER_PART * parts


def _content(
    robot_file: "RobotFile", to: str, pose: str | None, body: str | None, count: int, ending: str
) -> bytes:
    """What the file holds; computed in a process of its own."""
    from lumped.mechanism.kinematics.postures import posture, reference_posture  # noqa: PLC0415
    from validation.export import formats, reduced  # noqa: PLC0415
    from validation.kinematics.poses import parsed_pose  # noqa: PLC0415
    from validation.models.mechanism import highest_frequency  # noqa: PLC0415

    mechanism = robot_file.mechanism
    at = reference_posture(mechanism)
    if pose is not None:
        at = posture(mechanism, parsed_pose(mechanism, pose))
    if body is not None:
        one = reduced.reduced_body(mechanism, body, highest_frequency([at], count))
    else:
        robot = reduced.reduced_robot(at, count)
        if to == "statespace":
            return formats.as_statespace(robot, ending)
        one = robot.matrices
    write_as = {
        "npz": formats.as_npz,
        "exudyn": formats.as_exudyn,
        "simscape": formats.as_simscape,
        "nastran": formats.as_nastran,
    }
    return write_as[to](one)
