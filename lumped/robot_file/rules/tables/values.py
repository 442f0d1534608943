"""Rules for values that occur in several tables of a robot file, and their limits.

Limits that only detect wrong units are wide. Values of robots that have been built lie inside, and
the usual mistakes lie outside: millimetres, gigapascals, a stiffness in place of a compliance.
"""

from dataclasses import replace
from typing import Literal, TypeAlias, TypeVar

from lumped.acceptance.quantities import MOST_MODES
from lumped.acceptance.requirement import SMALLEST_SHARE
from lumped.mechanism.length_unit import COORDINATES
from lumped.robot_file.rules.matrices import SquareMatrix
from lumped.robot_file.rules.rule import Number, Pose, Several, Text

# Three coordinates (m), or the components of a direction.
Triple: TypeAlias = tuple[float, float, float]
# A point, given by its name or by its coordinates (m).
Place: TypeAlias = str | Triple
# A stiffness, or none because the motion is impossible.
Spring: TypeAlias = float | Literal["rigid"]
_Value = TypeVar("_Value")

IN_MM, IN_GPA, DIAMOND = "is this in mm?", "is this in GPa or MPa?", "above diamond"
IN_PERCENT = "is this in percent?"
# 100 m is longer than any robot with rigid legs, and less than a leg of 10 cm typed in millimetres
# would be (100 "m"). 0.1 mm is shorter than the legs of flexure stages.
LENGTH = Number("m", above=0.0, most=100.0, high=IN_MM, slip=1e-4)
# 10 m is longer than any tool, and a tool of 1 cm typed in millimetres exceeds it.
OFFSET = Number("m", least=-10.0, most=10.0, low=IN_MM, high=IN_MM)
POINT = Several(Number("m", least=-100.0, most=100.0, low=IN_MM, high=IN_MM), 3)
# One limit for metres and radians. Poses out of reach are found when the loops are closed.
COORDINATE = Number(COORDINATES, least=-100.0, most=100.0, low=IN_MM, high=IN_MM)
POSE = Pose(COORDINATE)
# Directions may have any length, because they are normalised.
DIRECTION = Several(Number(least=-1e6, most=1e6), 3)
# 1e5 kg is a hundred tonnes in one leg or platform. 1 µg is less than the smallest silicon part.
MASS = Number("kg", above=0.0, most=1e5, high="is this in g?", slip=1e-9)
MASS_OR_NONE = Number("kg", least=0.0, most=1e5, high="is this in g?")
COMPLIANCE = SquareMatrix(6, "m/N, rad/N and rad/(N m)", compliance=True)
INERTIA = SquareMatrix(3, "kg m²", compliance=False)
# 1 is an error of 100 %.
SHARE = Number(least=SMALLEST_SHARE, most=1.0, high=IN_PERCENT, example="(0.05 is 5 %)")
# 1 is the loss factor of highly damped rubber.
LOSS = Number(least=0.0, most=1.0, high=IN_PERCENT)
# The loops of a hundred bodies and two hundred joints are closed in a second. No robot has as many.
MOST_BODIES, MOST_JOINTS, MOST_POSES = 100, 200, 10_000
COUNT = Number(least=1, most=MOST_POSES, whole=True)
MODES = Number(least=1, most=MOST_MODES, whole=True)
NUMBER, TEXT = Number(), Text()
# Control characters (C0, C1), line ends and marks that change the direction of text.
_UNPRINTED = r"\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069"
TITLE = Text(rf"[^{_UNPRINTED}]{{1,100}}", "a text of 1 to 100 characters on one line")
FILE = Text(rf"[^{_UNPRINTED}]{{1,1000}}", "the name of a file, 1 to 1000 characters")
NAME = Text(r"[\w-]{1,40}", "1 to 40 letters, digits, _ or -")
BODY_NAME, MATERIAL_NAME, POINT_NAME = (
    replace(NAME, among=table) for table in ("bodies", "materials", "points")
)


def given(value: _Value | None) -> _Value:
    """`value` itself, which is never None in an entry without faults.

    Raises TypeError if it is None. The function informs the type checker.
    """
    if value is None:
        raise TypeError("an entry with faults")
    return value
