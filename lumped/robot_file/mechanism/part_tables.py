"""Interfaces and material of a CAD part as they are typed, in a robot file or at a command line."""

from collections.abc import Callable
from typing import Any

from lumped.legs import Material
from lumped.mechanism.part import (
    ByCylinder,
    ByFaces,
    ByName,
    ByPlane,
    PartInterface,
    Selection,
)
from lumped.robot_file.mechanism.draft import Entry

_CHOICES: dict[str, Callable[[Any], Selection]] = {
    "faces": ByFaces,
    "name": ByName,
    "cylinder": lambda table: ByCylinder(**table),
    "plane": lambda table: ByPlane(**table),
}


def choice_faults(interface: Entry, key: str) -> list[str]:
    """The fault of an interface whose faces are said in no way or in several."""
    given = [choice for choice in _CHOICES if interface[choice] is not None]
    if len(given) == 1:
        return []
    said = f"has {' and '.join(given)}" if given else "does not say which faces"
    return [f"{key}: {said}; must have one of {', '.join(_CHOICES)}"]


def material_faults(material: Entry, path: str) -> list[str]:
    """Why a material is none of a part; `path` goes before each key."""
    faults = []
    if material["rho"] is None:
        faults.append(f"{path}rho: missing; a part's mass follows from its density")
    if material["G"] is not None:
        faults.append(f"{path}G: does not belong to a part; its material is isotropic")
    return faults


def interface_of(interface: Entry) -> PartInterface:
    """The interface of a table without faults."""
    (chosen,) = (choice for choice in _CHOICES if interface[choice] is not None)
    return PartInterface(_CHOICES[chosen](interface[chosen]), interface["coupling"])


def isotropic_of(material: Entry) -> Material:
    """The isotropic material of a table without faults."""
    return Material.isotropic(material["E"], material["nu"], material["rho"])
