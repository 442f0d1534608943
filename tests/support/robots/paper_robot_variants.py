"""Variants of the paper's robot with other legs, feet or tool."""

from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.biglide import biglide
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, on_equivalent_legs
from lumped.robot_file import RobotFile, load_robot
from lumped.system.assembly import System, assemble

IFW = load_robot("ifw")
LEG1, LEG2 = legs_of(IFW.mechanism).values()
FOOT = np.array(IFW.tables["foot"]["compliance"])
DATA: dict[str, Any] = {
    "name": "IFW",
    "a": 0.92,
    "leg1": LEG1,
    "leg2": LEG2,
    "platform_mass": 46.0,
    "drive_stiffness": 1.0e9,
    "foot_compliance": FOOT,
}
EQUIVALENT = on_equivalent_legs(IFW.mechanism)


def variant_of_ifw(**changes: Any) -> Mechanism:
    """The paper's robot with some arguments of its constructor replaced."""
    return biglide(**DATA | changes)


def file_of(mechanism: Mechanism, **changes: Any) -> RobotFile:
    """Robot file of a mechanism that is not built in."""
    return replace(IFW, mechanism=mechanism, built_in=False, source="changed.toml", **changes)


def stations(mechanism: Mechanism, count: int) -> Array:
    """Positions x (m) of point B: `count` values from end to end of the stroke, equally spaced."""
    first, *_, last = mechanism.poses[:, 0]
    return np.linspace(first, last, count)


def placed_at(mechanism: Mechanism, *x: float) -> tuple[Posture, ...]:
    """Postures with B at each of the given x (m). Without any x, one in mid-stroke."""
    return tuple(
        posture(mechanism, np.array([position])) for position in x or stations(mechanism, 3)[1:2]
    )


def system_of(x: float, leg1: BodyModel, leg2: BodyModel) -> System:
    """System of the robot with B at `x` (m), from models of its two legs."""
    return assemble(*placed_at(EQUIVALENT, x), {"leg1": leg1, "leg2": leg2})
