"""What the sound tables of bodies describe: legs, of either schema, and what parts are held at.

A table is as it is read: a value for every key, None where left out.
"""

from dataclasses import replace

from lumped.legs import ConstantLeg, GivenLeg, Leg, Material
from lumped.mechanism.part import ByCylinder, ByFaces, ByName, ByPlane, PartInterface, Selection
from lumped.robot_file.rules.relations import Entry


def leg_of(table: Entry, name: str) -> Leg:
    """The leg of a table."""
    length, section, given, mass = (table[key] for key in ("length", "section", "material", "mass"))
    if table["compliance"] is not None:
        about = table["inertia"], table["mass_centre"]
        return GivenLeg(length, mass, table["compliance"], *about, name)
    density = given["rho"] if mass is None else mass / (section.area * length)
    material = isotropic_of(given | {"rho": density})
    if given["G"] is not None:
        material = replace(material, G=given["G"])
    return ConstantLeg(length, section, material, table["ends"], name)


def isotropic_of(material: Entry) -> Material:
    """The isotropic material of a table."""
    return Material.isotropic(material["E"], material["nu"], material["rho"])


def interface_of(table: Entry) -> PartInterface:
    """The interface of a part that a table describes."""
    selection: Selection
    if table["faces"] is not None:
        selection = ByFaces(table["faces"])
    elif table["name"] is not None:
        selection = ByName(table["name"])
    elif table["cylinder"] is not None:
        selection = ByCylinder(**table["cylinder"])
    else:
        selection = ByPlane(**table["plane"])
    return PartInterface(selection, table["coupling"])
