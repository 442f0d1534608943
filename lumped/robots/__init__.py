"""Built-in robots, one robot file each: that of the paper, and one mechanism of each kind.

Robot files are read by `lumped.robot_file`.
"""

from typing import Literal, TypeAlias

# Types of robots for which there is a commented robot file to start from.
RobotType: TypeAlias = Literal[
    "biglide",
    "five-bar",
    "5R",
    "3-rrr",
    "delta",
    "linear-delta",
    "orthoglide",
    "hexapod",
    "tricept",
    "scara",
    "gantry",
    "stage",
]
# Default type of a new robot file.
FIRST_TYPE: RobotType = "biglide"
