"""The robot whose models meet the catalogue of faults, and which faults a computation meets."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.biglide import Biglide
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from validation.context import Context
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Change, Fault, Faulty, around, replaced

IFW = load_robot("ifw")
LIMIT = 0.05
# What is judged; what judges has comparisons of its own that notice it.
_JUDGED = ("lumped.", "meshes.", "fem.")


def robot_of(a: float, *lengths: float) -> Biglide:
    """Slender legs, ends free: beams and solids are one theory here."""
    steel = Material.isotropic(2.1e11, 0.3, 7850.0)
    legs = [ConstantLeg(length, Rectangle(0.05, 0.08), steel, ends="free") for length in lengths]
    return replace(IFW.robot, a=a, leg1=legs[0], leg2=legs[1], tool_offset=np.array([0, 0, 0.1]))


# Made once: a fault of data spoils what is judged, not the judgement.
ROBOT = robot_of(0.95, 0.9, 0.8)


def its_context(robot: Biglide) -> Context:
    robot_file = replace(IFW, described=robot, built_in=False, source="faulty.toml")
    return Context(robot_file, "quick")


def faults_met(compute: Callable[[], object]) -> list[Fault]:
    """The faults in what `compute` uses of models, references and their data."""
    used: set[str] = set()

    def listening(where: str) -> Change:
        def listen(sound: Faulty, *args: Any, **kwargs: Any) -> Any:
            used.add(where)
            return sound(*args, **kwargs)

        return around(listen)

    with replaced({fault.where: listening(fault.where) for fault in FAULTS}):
        compute()
    return [fault for fault in FAULTS if fault.where in used and fault.where.startswith(_JUDGED)]
