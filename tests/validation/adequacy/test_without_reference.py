"""What solids cannot take leaves undecided what hangs on it, says why, and judges the rest."""

from pathlib import Path

import pytest
from written_robot import robot_of

from lumped.errors import ComputationError
from lumped.mechanism import biglide
from lumped.robot_file import load_robot
from validation.adequacy.robot import robot_adequacy
from validation.context import Context

FOIL = '{ shape = "tube", diameter = 0.12, thickness = 5e-5 }'
SOLID = '{ shape = "rectangle", width = 0.1, height = 0.06 }'
ROBOT = """schema = 1
name = "one sound leg"
type = "biglide"
geometry = {{ a = 0.9 }}
platform = {{ mass = 30.0 }}
actuators = {{ stiffness = 5.0e8 }}
[leg1]
length = 0.8
section = {sound}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
ends = "rigid"
[leg2]
length = 0.8
section = {section}
material = {{ E = 2.1e11, nu = {nu}, rho = 7850.0 }}
ends = "rigid"
"""


@pytest.mark.parametrize(
    ("section", "nu", "said"),
    [
        (FOIL, "0.3", "leg2: the coarsest section mesh of its tube has"),
        (SOLID, "0.4999999999999", "solid elements lose the softer in rounding"),
    ],
    ids=["walls too thin", "incompressible"],
)
def test_one_leg_without_solids_leaves_the_robot_undecided_and_the_other_judged(
    tmp_path: Path, section: str, nu: str, said: str
) -> None:
    robot = robot_of(ROBOT.format(sound=SOLID, section=section, nu=nu), tmp_path)
    matrix = robot_adequacy(Context(robot, "quick"))
    statics = [entry for entry in matrix.entries if entry.quantity in ("x", "z", "phi_x")]
    assert {entry.model for entry in statics} >= {"simplified", "vjm", "segments", "beam"}
    assert {entry.verdict for entry in matrix.entries} == {"undecided"}
    assert all(said in entry.reason for entry in statics)
    sound, other = matrix.parts
    assert {entry.verdict for entry in sound.entries} >= {"adequate"}
    assert {entry.verdict for entry in other.entries} == {"undecided"}


def test_postures_that_are_none_of_the_robot_are_not_left_undecided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sound = biglide.rotation_z
    monkeypatch.setattr(biglide, "rotation_z", lambda angle: sound(1.001 * angle))
    with pytest.raises(ComputationError, match="leaves the joints open"):
        robot_adequacy(Context(load_robot("ifw"), "quick"))
