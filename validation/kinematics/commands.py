"""Command `kinematics` of the command line.

Input: the name of a robot file and poses. Output: mobility and joint coordinates on stdout, and a
picture if requested.
"""

from typing import Annotated

from cyclopts import Parameter

from validation.console.streams import write_messages, write_results
from validation.console.typed import AsJson, Force, PathArgument, RobotName, require_writable, write


def kinematics(
    robot: RobotName,
    *,
    pose: Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True)] = (),
    picture: PathArgument | None = None,
    force: Force = False,
    json: AsJson = False,
) -> int:
    """Close the loops of a mechanism; print mobility, redundant constraints and coordinates.

    Parameters
    ----------
    pose
        Pose of the tool in the order of its moves, for example 0.25,0.6 (m, rad). The option may
        be repeated. Default: the poses of the path in the robot file.
    picture
        Write a picture of the mechanism in these poses to this PNG file.
    """
    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.kinematics import listing  # noqa: PLC0415
    from validation.kinematics.poses import (  # noqa: PLC0415
        parsed_poses,
        postures_of,
        postures_on_path,
    )

    require_writable(picture, ".png", force=force)
    mechanism = load_robot(robot).mechanism
    if pose:
        postures = postures_of(mechanism, parsed_poses(mechanism, pose))
    else:
        postures = postures_on_path(mechanism, mechanism.poses)
    write_results((listing.as_json if json else listing.as_text)(mechanism, postures))
    if picture is not None:
        from validation.drawing.rendering import pictured  # noqa: PLC0415
        from validation.kinematics.picture import scene  # noqa: PLC0415

        drawn = pictured([scene(mechanism, postures)])
        if drawn.left_out:
            write_messages([drawn.left_out], 3)
        else:
            write(picture, drawn.png, ".png")
    return 0
