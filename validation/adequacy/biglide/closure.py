"""Whether the postures that all models share are those of the drawing, from points alone.

Models and references take places and axes from one function, so that an error there is theirs
together and no comparison shows it. Here every leg is drawn between its ends, without angles.
"""

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.errors import ComputationError

# Rounding of places and axes, in leg lengths, with a margin; mistakes are of order one.
_CLOSED = 1e-9
_UP = np.array([0.0, 0.0, 1.0])


def require_closed(robot: Biglide, x: Array) -> None:
    """Raise ComputationError where a leg does not reach from its slide to B, at `x` (m, p values).

    A slides on x = 0, C on x = a, both below B; a leg's axes are the direction from its slide to B,
    the one at right angles in the plane, and z.
    """
    for station in x.tolist():
        posture = robot.posture(station)
        tip = np.array([station, 0.0, 0.0])
        for number, slide, root, rotation, length in (
            (1, 0.0, posture.root1, posture.rotation1, robot.leg1.length),
            (2, robot.a, posture.root2, posture.rotation2, robot.leg2.length),
        ):
            along = (tip - root) / length
            axes = np.column_stack([along, np.cross(_UP, along), _UP])
            gaps = {
                "its ends are not one length apart": abs(float(np.hypot.reduce(along)) - 1.0),
                "it does not start at its slide": float(
                    np.abs([(root[0] - slide) / length, max(root[1], 0.0) / length, root[2]]).max()
                ),
                "its axes do not point from slide to B": float(np.abs(rotation - axes).max()),
            }
            worst = max(gaps, key=lambda name: gaps[name])
            if not gaps[worst] <= _CLOSED:
                raise ComputationError(
                    f"{robot.name} at x = {station:g} m: the posture of leg {number} is wrong: "
                    f"{worst} (by {gaps[worst]:.2g})"
                )
