"""Robots that come with the program, one file each: the paper's, and one mechanism of each kind.

In: nothing. Out: robot files, read by `lumped.robot_file`.
"""

from typing import Literal, TypeAlias

# Mechanisms of which there is a commented file to start from.
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
# What one starts from where nothing is said.
FIRST_TYPE: RobotType = "biglide"
