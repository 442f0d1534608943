"""Modes of robots in the poses of their path: refusal of systems that round-off dominates."""

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of

from validation.context import Context
from validation.models.options import ModelOptions
from validation.references.model_ladder import formulation
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_on_path
from validation.responses.statics_and_modes import Unsolved

# A block of 25 kg with a tool of 10 kg on a drive, along which it moves as a rigid body. Its beam
# elements are 1e16 times as stiff as the drive.
STAGE = """
schema = 2
name = "stage"
points = { A = [0.0, 0.0, 0.0], P = [1.0, 0.0, 0.0] }
[bodies.arm]
from = "A"
to = "P"
section = { shape = "rectangle", width = 0.5, height = 0.5 }
material = { E = 1.0e12, nu = 0.3, rho = 100.0 }
[joints.slide]
type = "prismatic"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 1.0, 0.0]
drive = { stiffness = STIFFNESS }
[tool]
body = "arm"
point = "P"
moves = ["y"]
mass = 10.0
[accept]
modes = 1
"""


@pytest.mark.parametrize("stiffness", [1.0e4, 1.0])
def test_frequency_lost_in_round_off_is_refused(stiffness, tmp_path):
    """f = √(k/m)/2π with m = 35 kg. At 1 N/m it was formerly off by 1.6e-3."""
    file = robot_of(STAGE.replace("STIFFNESS", str(stiffness)), tmp_path)
    robot = robot_on_path(Context(file, "quick"))
    model = formulation("segments", "segments", ModelOptions())
    modes = Responses(robot).modes(model, robot.first_reading)
    if stiffness == 1.0:
        assert isinstance(modes, Unsolved)
    else:
        by_hand = np.sqrt(stiffness / 35.0) / (2.0 * np.pi)
        assert modes.frequencies[0, 0] == pytest.approx(by_hand, rel=1e-5)
