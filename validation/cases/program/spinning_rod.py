"""A rod between ball joints that a crank leads round a cone: it goes along without spinning.

One ball joint is on the crank's axis, the other on its arm. The rod has a flywheel's inertia about
its own line, which nothing turns: what idles must take no part in the crank's swinging.
"""

from math import hypot, pi, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from validation.case import Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.program.mechanisms import SECTION
from validation.context import Context

# Arm and height of the cone (m); the drive's stiffness (N m/rad), and how far it has turned.
_ARM, _HEIGHT = 0.3, 0.4
_DRIVE, _TURN = 2e4, 0.7
# Crank about its axis; mass of the rod, its inertia across and along itself (kg, kg m²).
_CRANK, _MASS, _ACROSS, _ALONG = 0.05, 6.0, 0.5, 0.9

cases = CaseGroup(
    section=SECTION, group="program.mechanisms", reference_kind="closed-form", effort=0.1
)


def _robot() -> str:
    length = hypot(_ARM, _HEIGHT)
    along = np.array([_ARM, 0.0, _HEIGHT]) / length
    inertia = _ACROSS * np.eye(3) + (_ALONG - _ACROSS) * np.outer(along, along)
    return f"""
schema = 2
name = "cone"

[points]
O = [0.0, 0.0, 0.0]
M = [0.0, 0.0, {_HEIGHT}]
Q = [{_ARM}, 0.0, {_HEIGHT}]

[bodies.crank]
points = ["M", "Q"]
mass = 1.0
centre = [0.0, 0.0, {_HEIGHT}]
inertia = {np.diag([_CRANK] * 3).tolist()}

[bodies.rod]
points = ["O", "Q"]
mass = {_MASS}
centre = [{_ARM / 2.0}, 0.0, {_HEIGHT / 2.0}]
inertia = {inertia.tolist()}

[joints.motor]
type = "revolute"
between = ["ground", "crank"]
at = "M"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = {_DRIVE} }}

[joints.O]
type = "spherical"
between = ["ground", "rod"]
at = "O"

[joints.Q]
type = "spherical"
between = ["crank", "rod"]
at = "Q"

[tool]
body = "crank"
point = "Q"
moves = ["phi_z"]

[path]
from = [0.0]
to = [{_TURN}]
count = 2
"""


def swinging_frequency() -> float:
    """Frequency (Hz) of the crank on its drive, by the assembler."""
    with TemporaryDirectory(prefix="cone-") as folder:
        file = Path(folder) / "cone.toml"
        file.write_text(_robot(), encoding="utf-8")
        mechanism = load_robot(file).mechanism
    at = posture(mechanism, mechanism.poses[-1])
    return float(modes(solved(assembly(mechanism, {}).at(at)), 1).frequencies[0])


@cases.case(
    "program.mechanism.cone",
    "A rod between ball joints goes round a cone without spinning",
    quantity="frequency of the crank that leads it",
    unit="Hz",
    citation="I = I_crank + (I_across + m L²/4) sin²β, the rod's half angle β; a rod that spun "
    "with the crank would add I_along cos²β",
    tolerance=Relative(1e-9),
    tolerance_reason="rigid bodies: rounding",
    model="simplified",
)
def _cone(context: Context) -> Measurement:
    length = hypot(_ARM, _HEIGHT)
    led = (_ACROSS + _MASS * length**2 / 4.0) * (_ARM / length) ** 2
    expected = sqrt(_DRIVE / (_CRANK + led)) / (2.0 * pi)
    return Measurement(context.get(swinging_frequency), expected, exact=True)
