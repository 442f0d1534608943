"""Command `forces` of the command line.

Input: the name of a robot file and the options of the command. Output: text or JSON on stdout, and
the requested files.
"""

from typing import Annotated

from cyclopts import Parameter

from fem.machine import TO_COMPUTE, require_room
from lumped.model_choices import Ends
from validation.console.streams import write_results
from validation.console.typed import (
    DEFAULT_MODEL,
    DEFAULT_SOLVER,
    AsJson,
    Force,
    ModelChoices,
    PathArgument,
    RobotName,
    SolverChoice,
    require_distinct,
    require_writable,
    write,
)
from validation.models.options import ModelName

# Dots per inch of the picture.
_DOTS = 150


def forces(
    robot: RobotName,
    *,
    model: ModelName = "beam",
    load: tuple[str, ...] = (),
    pose: Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True)] = (),
    path: bool = False,
    options: ModelChoices = DEFAULT_MODEL,
    ends: Ends | None = None,
    csv: PathArgument | None = None,
    picture: PathArgument | None = None,
    vtu: PathArgument | None = None,
    solver: SolverChoice = DEFAULT_SOLVER,
    force: Force = False,
    json: AsJson = False,
) -> int:
    """Reactions of joints, forces of drives, member forces and stresses under the loads of a robot.

    Parameters
    ----------
    model
        The model to solve; beam if left out.
    load
        Name of a load in the robot file; all loads if left out. May be repeated.
    pose
        Pose of the tool, numbers separated by commas in the order of its moves; the reference
        posture if left out. May be repeated.
    path
        Compute all poses of [path] in the robot file.
    ends
        solid: end faces kept plane and rigid, or free to warp.
    csv
        Also write all numbers into this CSV file.
    picture
        Also draw the forces under the first load into this PNG file: along the legs in a single
        pose, or over several poses.
    vtu
        solid: also write displacements and stresses of all legs and CAD parts under one load in one
        pose into this VTU file, for ParaView.
    """
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.console.progress import stage  # noqa: PLC0415
    from validation.forces.analysis import forces as computed  # noqa: PLC0415
    from validation.forces.record import as_text  # noqa: PLC0415
    from validation.solve.question import Question  # noqa: PLC0415

    require_room(TO_COMPUTE)
    solver.request()
    require_writable(csv, ".csv", force=force)
    require_writable(picture, ".png", force=force)
    require_writable(vtu, ".vtu", force=force)
    require_distinct(csv, picture, vtu)
    robot_file = load_robot(robot)
    question = Question(robot_file, model, options.given(ends=ends), poses=pose)
    with stage(f"forces by the {model} model"):
        result = computed(question, load, on_path=path, solids=vtu is not None)
    write_results(result.json() if json else as_text(result))
    if csv is not None:
        write(csv, result.csv().encode(), ".csv")
    if picture is not None:
        from validation.drawing.plot import chart_png  # noqa: PLC0415

        write(picture, chart_png(result.chart(result.first_load), _DOTS), ".png")
    if vtu is not None:
        from validation.forces.solids import vtu_of  # noqa: PLC0415

        (under_load,) = result.poses[0].loads.values()
        fields = {} if under_load is None else under_load.solids
        write(vtu, vtu_of(fields.values()), ".vtu")
    return 0
